//! How many paths a solve may have.

/// Most paths of one solve where all results are held in memory, about 300 bytes a path.
pub const MAX_PATHS: u64 = 4_000_000;
/// ... and where those of streamed paths need not be (see `solutions::streamed`), of which 24 bytes are.
pub const MAX_STREAMED_PATHS: u64 = 40_000_000;
