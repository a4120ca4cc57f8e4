//! Properties that hold for whole crates together.

mod tracking;
