//! Results: write-once objects, and what the summary of a finished job says of the job.

pub mod addresses;
pub mod answer;
pub mod bucket;
#[cfg(test)]
mod conformance;
#[cfg(test)]
pub(crate) mod faulty_storage;
pub mod finished;
pub mod marker;
pub mod naming;
pub mod place;
pub mod references;
pub mod retention;
pub mod store;
pub mod trash;
pub mod upload;
