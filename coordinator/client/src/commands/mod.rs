//! The commands, one file each.

pub mod backup;
pub mod cancel;
pub mod completions;
pub mod convert;
pub mod coordinator;
pub mod decompose;
pub mod delete;
pub mod exceptional;
pub mod explain;
pub mod family;
pub mod fleet;
pub mod fsck;
pub mod info;
pub mod intersect;
pub mod jobs;
pub mod mechanism;
pub mod path;
pub mod question;
pub mod results;
mod sequence;
pub mod solve;
pub mod submit;
pub mod synthesize;
pub mod top;
pub mod watch;
pub mod worker;
pub mod workers;
