//! What belongs to the command line but not to this version: refused with its name, before anything starts.

use super::arguments::{Command, Coordinator};
use super::error::ClientError;
use crate::intake::MOST_BITS;
use cognate_protocol::submission::PrecisionChoice;

/// Refuses the first thing asked for that this version does not have.
pub fn refuse(command: &Command) -> Result<(), ClientError> {
    let missing = match command {
        Command::Solve(c) => precision(c.problem.precision),
        Command::Path(c) => precision(c.problem.precision),
        Command::Decompose(c) => precision(c.precision),
        Command::Submit(c) => precision(c.problem.precision),
        Command::Coordinator(c) => coordinator(c),
        Command::Watch(_)
        | Command::Member(_)
        | Command::Sample(_)
        | Command::Project(_)
        | Command::Multidegree(_)
        | Command::Mobility(_)
        | Command::RealCurve(_)
        | Command::Certify(_)
        | Command::Explain(_)
        | Command::Cancel(_)
        | Command::Results(_)
        | Command::Jobs(_)
        | Command::Workers(_)
        | Command::Worker(_)
        | Command::Fleet(_)
        | Command::Mechanism(_)
        | Command::Info(_)
        | Command::Convert(_) => None,
        Command::Synthesize(c) => precision(c.common().precision),
    };
    match missing {
        Some(what) => Err(ClientError::NotInThisVersion { what }),
        None => Ok(()),
    }
}

fn precision(choice: PrecisionChoice) -> Option<String> {
    match choice {
        PrecisionChoice::Bits(bits) if bits > MOST_BITS => {
            Some(format!("--precision {bits} (at most {MOST_BITS} bits)"))
        }
        _ => None,
    }
}

fn coordinator(a: &Coordinator) -> Option<String> {
    let results = a.results.as_deref().unwrap_or_default();
    let remote = results.contains("://") && !results.starts_with("file://");
    remote.then(|| format!("--results {results} (only local folders)"))
}
