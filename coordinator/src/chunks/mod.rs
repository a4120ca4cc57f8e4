//! Chunks: who gets what, how large, until when.

pub mod sizing;
