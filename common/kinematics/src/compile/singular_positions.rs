//! Singular positions: those in which something moves while the inputs are held, or while the output is, as the solutions of
//! equations in the unknowns of the motion.
//!
//! To those of the motion comes that the first-order motions with the inputs (the output) held are not only 0: a determinant,
//! or several minors where there are more conditions than velocities (survey, section 3.4.1).

use super::formulation::{Problem, Question, overdriven};
use super::minors::{Minors, add_minors, largest_minors};
use super::planar::velocities::{Held, VelocityMatrix};
use super::{motion, planar, platform_lines};
use crate::mechanism::exact::Angle;
use crate::mechanism::{Body, Linkage, Mechanism, MechanismError, Space};

pub use super::singular_kind::{Extent, SingularKind, SingularPositions};

/// Equations of the singular positions, at a held orientation of the output where one is given.
///
/// # Errors
/// When the question is not supported; the message says what to type instead.
pub fn singular_positions(
    mechanism: &Mechanism,
    kind: &SingularKind,
    orientation: Option<&Angle>,
) -> Result<SingularPositions, MechanismError> {
    match (&mechanism.body, mechanism.space) {
        (Body::Platform(platform), Space::Planar) => {
            platform_lines::singular_positions(mechanism, platform, kind, orientation)
        }
        _ if orientation.is_some() => Err(mechanism.error(
            "--orientation holds the platform of a planar mechanism with legs; leave it out, or ask about positions with --at FILE",
        )),
        (Body::Linkage(linkage), Space::Planar) => of_linkage(mechanism, linkage, kind),
        _ => Err(mechanism.error(
            "not in this version: all singular positions of a mechanism that is no planar linkage and no planar platform on legs; ask about single ones with --at FILE",
        )),
    }
}

fn of_linkage(
    mechanism: &Mechanism,
    linkage: &Linkage,
    kind: &SingularKind,
) -> Result<SingularPositions, MechanismError> {
    let question = Question::of(Problem::Motion);
    let formulated = planar::formulated(mechanism, linkage, &question, Vec::new())?;
    let held = match kind {
        SingularKind::Inputs(names) if names.is_empty() => {
            return Err(mechanism.error("no inputs: name the joints that drive it with --input"));
        }
        SingularKind::Inputs(names) => Held::Joints(names),
        SingularKind::Outputs => {
            let output = mechanism.output.as_ref();
            let none = || {
                mechanism.error("the file names no output: add \"output\", a link or a point of it")
            };
            Held::Output(output.ok_or_else(none)?)
        }
    };
    let matrix = formulated
        .velocities(&held)
        .map_err(|e| mechanism.error(e))?;
    refuse_misfits(mechanism, kind, &matrix)?;
    let mut motion = motion::motion(mechanism, None)?;
    let closing = motion.equations.equations.len();
    let has_too_few_rows = matrix.rows.len() < matrix.columns;
    let extent = match matrix.columns {
        // As many inputs as freedoms, and some of them are in loops that others hold already.
        _ if has_too_few_rows && matches!(kind, SingularKind::Inputs(_)) => Extent::Everywhere,
        // Everything is held.
        0 => Extent::Nowhere,
        columns => match largest_minors(&matrix.rows, columns, &mut motion.equations) {
            Minors::Zeros(zeros) => add_minors(mechanism, zeros, &mut motion)?,
            Minors::Everywhere => Extent::Everywhere,
            Minors::TooMany => {
                return Err(mechanism.error(format!(
                    "not in this version: all singular positions with {} conditions on {columns} velocities; ask about single ones with --at FILE",
                    matrix.rows.len()
                )));
            }
        },
    };
    let held = u32::try_from(matrix.held).unwrap_or(u32::MAX);
    let freedoms = u32::try_from(matrix.freedoms.max(1)).unwrap_or(1);
    // As many conditions as velocities: where a mode has more freedoms than are held, all of it is singular.
    let is_square = matrix.rows.len() == matrix.columns;
    let whole_from = if is_square {
        freedoms
    } else {
        held.max(freedoms)
    };
    Ok(SingularPositions {
        motion,
        extent,
        closing,
        whole_from,
        maybe_whole_from: freedoms.min(whole_from),
    })
}

/// Refuses inputs and outputs whose number does not fit the freedoms.
fn refuse_misfits(
    mechanism: &Mechanism,
    kind: &SingularKind,
    matrix: &VelocityMatrix,
) -> Result<(), MechanismError> {
    let has_too_few_rows = matrix.rows.len() < matrix.columns;
    match kind {
        SingularKind::Inputs(names) => {
            // A linkage that moves by its dimensions has more freedoms than counting says.
            if names.len() > 1 {
                overdriven(mechanism, names)?;
            }
            let lacking = matrix.freedoms - names.len() as i64;
            if has_too_few_rows && lacking > 0 {
                return Err(mechanism.error(format!(
                    "too few inputs for {} freedoms: {} given ({}), {lacking} more are needed; name all of them with --input",
                    matrix.freedoms,
                    names.len(),
                    names.join(", ")
                )));
            }
        }
        SingularKind::Outputs if has_too_few_rows && matrix.has_loops => {
            return Err(mechanism.error(format!(
                "not in this version: all positions in which an output of {} coordinates is singular where closed loops have {} freedoms; ask about single ones with --at FILE",
                matrix.held, matrix.freedoms
            )));
        }
        SingularKind::Outputs => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{ReadOptions, read};

    const FOUR_BAR: &str = r#"{"name": "four-bar", "space": "planar", "links": ["ground", "crank", "coupler", "rocker"],
        "joints": [
            {"name": "A0", "type": "R", "links": ["ground", "crank"], "point": [0, 0]},
            {"name": "A", "type": "R", "links": ["crank", "coupler"], "point": [1, 2]},
            {"name": "B", "type": "R", "links": ["coupler", "rocker"], "point": [5, 3]},
            {"name": "B0", "type": "R", "links": ["ground", "rocker"], "point": [4, 0]}],
        "inputs": ["A0"], "output": "rocker"}"#;

    fn positions(kind: &SingularKind) -> Result<SingularPositions, MechanismError> {
        let options = ReadOptions::default();
        let mechanism = read("four_bar.json", FOUR_BAR.as_bytes(), &options).expect("a mechanism");
        singular_positions(&mechanism, kind, None)
    }

    fn added(kind: &SingularKind) -> usize {
        let positions = positions(kind).expect("equations");
        assert_eq!(
            (positions.extent, positions.whole_from),
            (Extent::Solutions, 1)
        );
        positions.motion.equations.equations.len() - 5
    }

    #[test]
    fn a_four_bar_has_one_determinant_for_its_input_and_one_for_its_output() {
        assert_eq!(added(&SingularKind::Inputs(vec!["A0".into()])), 1);
        assert_eq!(added(&SingularKind::Outputs), 1);
    }

    #[test]
    fn inputs_that_do_not_fit_the_freedoms_are_refused() {
        for (names, said) in [
            (vec![], "--input"),
            (vec!["A0", "B0"], "too many inputs"),
            (vec!["C0"], "no such joint"),
        ] {
            let names = names.into_iter().map(String::from).collect();
            let refused = positions(&SingularKind::Inputs(names));
            let error = refused.err().expect("an error").to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
