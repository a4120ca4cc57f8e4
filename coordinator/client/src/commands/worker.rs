//! `cognate worker`: a process that tracks for a coordinator.

use crate::arguments::Worker;
use std::process::ExitCode;

/// Works until something ends it. It has a runtime of its own.
pub fn run(a: Worker) -> ExitCode {
    cognate_worker::log::to_standard_error(a.worker.log_format);
    ExitCode::from(cognate_worker::command::execute(a.worker))
}
