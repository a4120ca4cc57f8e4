//! The process that tracks.
#![forbid(unsafe_code)]
