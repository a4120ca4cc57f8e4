//! What the readers and writers of problem files promise.

mod agreement;
mod bertini;
mod json;
mod phcpack;
mod points;
mod support;
