//! The wire: any bytes, golden files, refusals and round trips. One program, so that it is linked once.

mod any_bytes;
mod golden_wire;
mod refusals;
mod round_trips;
mod support;
