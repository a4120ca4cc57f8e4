//! Results: write-once objects, and the summary of a finished job.

pub mod decomposition;
pub mod store;
pub mod summary;
