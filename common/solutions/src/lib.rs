//! What the endpoints mean.
#![forbid(unsafe_code)]
