//! Families that are solved already, and a member that was solved anew.

use crate::error::ClientError;
use crate::output::files::{make_folder, write_file};
use crate::output::text::{Columns, Look, counted};
use cognate_kinematics::compile::families::{SOLVED, SolvedFamily};
use cognate_mechanism_solver::families::SolvedMember;
use num_complex::Complex64;
use serde_json::{Map, Value, json};
use std::path::Path;

/// All families, for people.
pub fn table(look: Look) -> String {
    let mut columns = Columns::new(&["family", ">positions", "source", "members"]);
    for family in SOLVED {
        columns.row(vec![
            family.name.into(),
            family.number.to_string(),
            family.source.into(),
            family.members.into(),
        ]);
    }
    columns.render(look)
}

/// All families, for programs.
pub fn json() -> String {
    let family = |family: SolvedFamily| {
        let equations = (family.equations)();
        json!({
            "name": family.name,
            "positions": family.number,
            "source": family.source,
            "members": family.members,
            "unknowns": equations.unknowns(),
            "parameters": equations.parameters,
        })
    };
    let families: Vec<Value> = SOLVED.into_iter().map(family).collect();
    format!("{:#}\n", json!({"families": families}))
}

/// Result of solving a member anew, for people.
pub fn prepared(family: &SolvedFamily, member: &SolvedMember) -> String {
    format!(
        "{}: {} of a general member by {}; published: {} ({}); {} solutions are no positions\n",
        family.name,
        counted(member.positions.len() as u64, "position"),
        counted(member.paths, "path"),
        family.number,
        family.source,
        member.others
    )
}

/// Writes `parameters.json` and `solutions.jsonl`, as they stand in `deploy/families`.
pub fn write(member: &SolvedMember, folder: &Path) -> Result<(), ClientError> {
    let pair = |z: &Complex64| json!([z.re, z.im]);
    let named = member.parameters.iter();
    let parameters: Map<String, Value> = named.map(|(n, z)| (n.clone(), pair(z))).collect();
    let line = |point: &Vec<Complex64>| {
        let values = member.variables.iter().zip(point);
        let values: Map<String, Value> = values.map(|(n, z)| (n.clone(), pair(z))).collect();
        format!("{}\n", json!({"variables": values}))
    };
    make_folder(folder)?;
    let text = format!("{:#}\n", Value::Object(parameters));
    write_file(folder, "parameters.json", &text)?;
    let lines: String = member.positions.iter().map(line).collect();
    write_file(folder, "solutions.jsonl", &lines)
}
