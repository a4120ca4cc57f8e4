//! The process that tracks.
//!
//! The modules in the order of a chunk's life: [`config`] and [`machine`] say
//! where to ask and what this computer offers; [`session`] decides what to ask
//! (with [`retry`] for calls without an answer) and [`shell`] carries it out;
//! [`transport`] makes the calls, [`problem_cache`] compiles the stage,
//! [`chunk_runner`] tracks, [`reports`] keeps results until they are
//! acknowledged. [`command`] is all of that as a process.
#![forbid(unsafe_code)]

pub mod chunk_runner;
pub mod command;
pub mod config;
pub mod log;
pub mod machine;
pub mod problem_cache;
pub mod reports;
pub mod retry;
pub mod session;
pub mod shell;
pub mod transport;
