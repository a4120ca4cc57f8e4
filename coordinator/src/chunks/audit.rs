//! Audit: which chunks are executed twice, on two workers, before they are accepted.

use crate::ledger::identity::ChunkId;

/// Whether a chunk is audited where this many of a hundred are: by its name, so that every
/// coordinator says the same, and no worker knows beforehand.
pub fn is_audited(chunk: ChunkId, percent: u32) -> bool {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&chunk.job.0.to_le_bytes());
    hasher.update(&chunk.stage.0.to_le_bytes());
    hasher.update(&chunk.first.to_le_bytes());
    let hash = hasher.finalize();
    let head = hash.as_bytes().first_chunk::<8>();
    let head = u64::from_le_bytes(*head.expect("a BLAKE3 hash has 32 bytes"));
    head % 100 < u64::from(percent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::identity::JobId;
    use cognate_continuation::work::StageId;

    #[test]
    fn the_share_is_what_is_asked() {
        let chunk = |first| ChunkId {
            job: JobId(5),
            stage: StageId(1),
            first,
        };
        let audited = |percent| {
            (0..10_000)
                .filter(|&k| is_audited(chunk(k), percent))
                .count()
        };
        assert_eq!((audited(0), audited(100)), (0, 10_000));
        assert!((800..1200).contains(&audited(10)), "{}", audited(10));
    }
}
