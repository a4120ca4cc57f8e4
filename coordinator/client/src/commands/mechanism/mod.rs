//! `cognate mechanism`: from a mechanism's file to its equations, postures, positions, branches and freedoms.

mod describe;
pub mod exceptional;
mod families;
mod follow;
mod free_numbers;
pub mod loci;
pub mod motion;
mod near;
mod open_numbers;
pub mod page;
pub mod read;
pub mod serve;
mod solve;
mod synthesize;
mod workspace;

use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismCommand;
use crate::output;

/// The JSON schema of a mechanism's file.
const SCHEMA: &str = include_str!("mechanism.schema.json");

/// Runs one of the commands.
pub fn run(command: &MechanismCommand) -> Result<Exit, ClientError> {
    match command {
        MechanismCommand::Info(a) => describe::info(a),
        MechanismCommand::Equations(a) => describe::equations(a),
        MechanismCommand::Convert(a) => describe::convert(a),
        MechanismCommand::Inverse(a) => solve::inverse(a),
        MechanismCommand::Forward(a) => solve::forward(a),
        MechanismCommand::Follow(a) => follow::run(a),
        MechanismCommand::Motion(_) | MechanismCommand::Exceptional(_) => {
            unreachable!("it talks to a service: `start` runs it")
        }
        MechanismCommand::Mobility(a) => near::mobility_of(a),
        MechanismCommand::Singularities(a) => near::singularities_of(a),
        MechanismCommand::Workspace(a) => workspace::run(a),
        MechanismCommand::Synthesize(a) => synthesize::run(a),
        MechanismCommand::Serve(a) => serve::run(a),
        MechanismCommand::Families(a) => families::run(a),
        MechanismCommand::Schema => {
            output::print(SCHEMA)?;
            Ok(Exit::Solved)
        }
    }
}
