//! The commands, one file each.

pub mod cancel;
pub mod explain;
pub mod info;
pub mod jobs;
pub mod results;
pub mod submit;
pub mod watch;
pub mod workers;
