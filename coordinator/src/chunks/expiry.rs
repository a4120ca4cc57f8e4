//! Expiry: a chunk that keeps losing its workers is split until the path at fault is found.
//!
//! A lost lease is a suspicion, not a verdict: the machine may have failed, or
//! another chunk beside it. At the limit a chunk is split, and its pieces are
//! leased alone; a piece needs one more suspicion to be split again, a single
//! path as many as a fresh chunk before it is named.

use super::leasing::Policy;
use crate::ledger::identity::ItemRange;
use crate::ledger::rows::{ChunkRow, Piece};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathIndex;
use cognate_continuation::work::Stage;

/// Action on a chunk under suspicion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SuspectAction {
    /// Cut the chunk into these pieces.
    Split(Vec<Piece>),
    /// The chunk is one path, and that path is reported as failed.
    FailItem,
}

/// Chooses the action on a ready chunk whose suspicions have reached the limit.
pub fn suspect_action(chunk: &ChunkRow, policy: &Policy) -> SuspectAction {
    let ItemRange { first, last } = chunk.items;
    let items = chunk.items.len();
    if items <= 1 {
        return SuspectAction::FailItem;
    }
    let pieces = policy.split_into.clamp(2, items);
    let cut = |k: u64| {
        let offset = u128::from(items) * u128::from(k) / u128::from(pieces);
        first + u64::try_from(offset).unwrap_or(items)
    };
    let piece = |k: u64| {
        let items = ItemRange {
            first: cut(k),
            last: if k + 1 == pieces { last } else { cut(k + 1) },
        };
        Piece {
            items,
            suspicions: match items.len() {
                1 => 0,
                _ => policy.suspicion_limit.saturating_sub(1),
            },
            alone: true,
        }
    };
    SuspectAction::Split((0..pieces).map(piece).collect())
}

/// The result of an item that no worker survived.
pub fn killed_its_worker(stage: &Stage, item: u64) -> ItemResult {
    ItemResult::killed_its_worker(stage.work, PathIndex(stage.origin(item)), stage.attempt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::identity::{ChunkId, Epoch, JobId};
    use crate::ledger::rows::ChunkState;
    use crate::ledger::rules::make_up;
    use cognate_continuation::work::StageId;

    fn chunk(first: u64, last: u64) -> ChunkRow {
        ChunkRow {
            chunk: ChunkId {
                job: JobId(1),
                stage: StageId(0),
                first,
            },
            items: ItemRange { first, last },
            state: ChunkState::Ready,
            epoch: Epoch(3),
            suspicions: 3,
            alone: false,
        }
    }

    #[test]
    fn pieces_make_up_the_chunk() {
        for items in [2, 3, 7, 8, 9, 64, 1001] {
            let whole = chunk(5, 5 + items);
            let SuspectAction::Split(pieces) = suspect_action(&whole, &Policy::default()) else {
                panic!("more than one path is split");
            };
            assert!(make_up(pieces.iter().map(|p| p.items), whole.items));
            assert_eq!(pieces.len() as u64, items.min(8));
            for piece in pieces {
                assert!(piece.alone);
                assert_eq!(piece.suspicions, if piece.items.len() == 1 { 0 } else { 2 });
            }
        }
        assert_eq!(
            suspect_action(&chunk(5, 6), &Policy::default()),
            SuspectAction::FailItem
        );
    }
}
