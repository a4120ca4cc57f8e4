//! The process that tracks.
//!
//! The modules in the order of a chunk's life: [`config`] and [`machine`] say
//! where to ask and what this computer offers, [`session`] decides what to ask
//! (with [`retry`] for calls without an answer), [`transport`] carries the
//! calls, [`chunk_runner`] tracks, [`reports`] keeps results until they are
//! acknowledged.
#![forbid(unsafe_code)]

pub mod chunk_runner;
pub mod config;
pub mod machine;
pub mod reports;
pub mod retry;
pub mod session;
pub mod transport;
