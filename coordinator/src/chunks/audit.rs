//! Audit: which chunks are executed twice, on two workers, before they are accepted.
//!
//! Drawn once a chunk is reported, by a keyed hash of its name. The key is made with the ledger, stays there and in the
//! memory of its coordinators, and is in no message: whoever has a lease, or has both executions, knows nothing of
//! any other chunk.

use crate::ledger::identity::ChunkId;
use std::fmt;

/// Secret of a ledger's audits; all coordinators of a ledger have the same.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct AuditKey([u8; 32]);

/// A key is not shown.
impl fmt::Debug for AuditKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("AuditKey")
    }
}

/// What a draw is for: the same chunk is drawn for one and not for the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Chunks of any results.
    Audit,
    /// Chunks with an end that is no regular finite point.
    Losses,
}

/// What tells ranks from draws.
const RANK: u8 = 255;

impl AuditKey {
    /// The key that stands for this text of a ledger.
    pub fn of(text: &str) -> Self {
        Self(blake3::derive_key(
            "cognate 2026-11-27 audits of a ledger",
            text.as_bytes(),
        ))
    }

    /// A key that nobody has had: 244 bits of the system's random numbers, as text.
    pub fn fresh_text() -> String {
        let part = || uuid::Uuid::new_v4().simple().to_string();
        part() + &part()
    }

    /// Whether a chunk is drawn where this many of a hundred are; the same in every coordinator.
    pub fn draws(&self, draw: Draw, chunk: ChunkId, percent: u32) -> bool {
        self.number(draw as u8, chunk, 0) % 100 < u64::from(percent)
    }

    /// A number by which the items of a chunk come into an order that nobody else knows.
    pub fn rank(&self, chunk: ChunkId, place: usize) -> u64 {
        self.number(RANK, chunk, place as u64)
    }

    fn number(&self, purpose: u8, chunk: ChunkId, place: u64) -> u64 {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        hasher.update(&[purpose]);
        hasher.update(&place.to_le_bytes());
        hasher.update(&chunk.job.0.to_le_bytes());
        hasher.update(&chunk.stage.0.to_le_bytes());
        hasher.update(&chunk.first.to_le_bytes());
        let hash = hasher.finalize();
        let head = hash.as_bytes().first_chunk::<8>();
        u64::from_le_bytes(*head.expect("a BLAKE3 hash has 32 bytes"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::identity::JobId;
    use cognate_continuation::work::StageId;

    fn drawn(key: AuditKey, draw: Draw, percent: u32) -> Vec<u64> {
        let chunk = |first| ChunkId {
            job: JobId(5),
            stage: StageId(1),
            first,
        };
        let drawn = |first: &u64| key.draws(draw, chunk(*first), percent);
        (0..10_000).filter(drawn).collect()
    }

    #[test]
    fn the_share_is_what_is_asked() {
        let audited = |percent| drawn(AuditKey::of("secret"), Draw::Audit, percent).len();
        assert_eq!((audited(0), audited(100)), (0, 10_000));
        assert!((800..1200).contains(&audited(10)), "{}", audited(10));
    }

    #[test]
    fn who_has_not_the_key_knows_nothing() {
        let tenth = |text: &str, draw| drawn(AuditKey::of(text), draw, 10);
        let audited = tenth("secret", Draw::Audit);
        for guess in [
            tenth("another", Draw::Audit),
            tenth("", Draw::Audit),
            tenth("secret", Draw::Losses),
        ] {
            let both = audited.iter().filter(|first| guess.contains(first)).count();
            // A hundredth by chance, of 10,000.
            assert!((50..200).contains(&both), "{both}");
        }
        assert_ne!(AuditKey::fresh_text(), AuditKey::fresh_text());
        assert_eq!(format!("{:?}", AuditKey::of("secret")), "AuditKey");
    }
}
