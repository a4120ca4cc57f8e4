//! Promises of the readers and writers of problem files.

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
mod written;
