//! Properties that hold for whole crates together.

mod purity;
mod subject;
