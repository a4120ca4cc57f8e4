//! The coordinator behind real sockets, in this process: one program, so that it is linked once.

mod access;
mod hostile;
mod page;
mod security;
mod service;
mod support;
mod third_attack;
mod traces;
mod transports;
