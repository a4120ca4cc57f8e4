//! The wire: generated messages, checked conversions, digests.
#![forbid(unsafe_code)]
