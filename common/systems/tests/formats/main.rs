//! What the readers and writers of problem files promise.

mod agreement;
mod algebra;
mod bad_input;
mod bertini;
mod json;
mod mutation;
mod phcpack;
mod plain;
mod points;
mod round_trip;
mod support;
