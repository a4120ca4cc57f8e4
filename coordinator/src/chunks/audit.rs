//! Audit: which chunks are executed twice, on two workers, before they are accepted.
//!
//! A chunk is drawn after it is reported, by a keyed hash of its job, stage and first item. The key is made with the
//! ledger. It stays there and in the memory of the ledger's coordinators, and is in no message, so that no worker can
//! compute the draws.

use crate::ledger::identity::ChunkId;
use std::fmt;

/// Secret of a ledger's audits; all coordinators of a ledger have the same.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct AuditKey([u8; 32]);

/// Without the key, which is secret.
impl fmt::Debug for AuditKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("AuditKey")
    }
}

/// Purpose of a draw. Draws of different purposes are independent of one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Among all chunks.
    Audit,
    /// Among chunks with results that the coordinator cannot check.
    Unchecked,
}

/// Purpose of ranks, beside those of `Draw`.
const RANK: u8 = 255;

impl AuditKey {
    /// The key that a ledger's secret text stands for.
    pub fn from_text(text: &str) -> Self {
        Self(blake3::derive_key(
            "cognate 2026-11-27 audits of a ledger",
            text.as_bytes(),
        ))
    }

    /// Text of a new key: 244 random bits of the operating system.
    pub fn new_text() -> String {
        let part = || uuid::Uuid::new_v4().simple().to_string();
        part() + &part()
    }

    /// Whether a chunk is among the `percent` of a hundred that are drawn; the same in every coordinator of a ledger.
    pub fn draws(&self, draw: Draw, chunk: ChunkId, percent: u32) -> bool {
        self.number(draw as u8, chunk, 0) % 100 < u64::from(percent)
    }

    /// Key by which places in a chunk are sorted into a secret order.
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
        let audited = |percent| drawn(AuditKey::from_text("secret"), Draw::Audit, percent).len();
        assert_eq!((audited(0), audited(100)), (0, 10_000));
        assert!((800..1200).contains(&audited(10)), "{}", audited(10));
    }

    #[test]
    fn draws_of_different_keys_and_purposes_are_independent() {
        let tenth = |text: &str, draw| drawn(AuditKey::from_text(text), draw, 10);
        let audited = tenth("secret", Draw::Audit);
        for guess in [
            tenth("another", Draw::Audit),
            tenth("", Draw::Audit),
            tenth("secret", Draw::Unchecked),
        ] {
            let both = audited.iter().filter(|first| guess.contains(first)).count();
            // A hundredth by chance, of 10,000.
            assert!((50..200).contains(&both), "{both}");
        }
        assert_ne!(AuditKey::new_text(), AuditKey::new_text());
        assert_eq!(format!("{:?}", AuditKey::from_text("secret")), "AuditKey");
    }
}
