//! Linkages with the smallest error for a task, as tables and JSON.

use super::view::mechanism_json;
use crate::output::text::{Columns, Look, count, counted, real};
use cognate_kinematics::mechanism::Mechanism;
use cognate_mechanism_solver::approximate::Stationary;
use cognate_mechanism_solver::approximate::angle_pairs::FunctionGenerators;
use cognate_mechanism_solver::approximate::dyads::Dyads;
use cognate_mechanism_solver::approximate::path_points::PathLinkages;
use num_complex::Complex64;
use serde_json::{Value, json};

/// Digits of numbers in tables.
const FIGURES: usize = 6;

/// The answer to one of the three tasks.
#[derive(Clone, Debug)]
pub enum Synthesized {
    /// For poses.
    Dyads(Dyads),
    /// For pairs of angles.
    FunctionGenerators(FunctionGenerators),
    /// For points of a path.
    PathLinkages(PathLinkages),
}

impl Synthesized {
    /// Why the answer is not settled.
    pub fn doubts(&self) -> Vec<String> {
        match self {
            Self::Dyads(answer) => answer.doubts.clone(),
            Self::FunctionGenerators(answer) => answer.doubts.clone(),
            Self::PathLinkages(answer) => match answer.linkages.is_empty() {
                true => vec!["no linkage was improved to a local minimum".into()],
                false => Vec::new(),
            },
        }
    }
}

/// For people.
pub fn table(answer: &Synthesized, degrees: bool, look: Look) -> String {
    let (line, columns) = match answer {
        Synthesized::Dyads(answer) => (stationary_line(answer.stationary), dyads(answer)),
        Synthesized::FunctionGenerators(answer) => {
            let mut line = stationary_line(answer.stationary);
            if answer.without_linkage > 0 {
                line += &format!(
                    ", {} of them without a real linkage",
                    count(answer.without_linkage)
                );
            }
            (line, function_generators(answer, degrees))
        }
        Synthesized::PathLinkages(answer) => (
            format!(
                "{} from {}, of which the best {} were brought to the curve; a better one may exist",
                counted(answer.linkages.len() as u64, "local minimum")
                    .replace("minimums", "minima"),
                counted(answer.starts, "random linkage"),
                count(answer.polished),
            ),
            path_linkages(answer),
        ),
    };
    format!("{}\n\n{}", look.bold(&line), columns.render(look))
}

fn stationary_line(stationary: Stationary) -> String {
    format!(
        "{}, {} real: all there are",
        counted(stationary.complex, "stationary point"),
        count(stationary.real)
    )
}

fn place(z: Complex64) -> String {
    format!("{} {}", real(z.re, FIGURES), real(z.im, FIGURES))
}

fn dyads(answer: &Dyads) -> Columns {
    let mut columns = Columns::new(&["kind", ">error", "pivot", "moving", ">length"]);
    for dyad in &answer.dyads {
        columns.row(vec![
            dyad.kind.name().into(),
            real(dyad.error, FIGURES),
            place(dyad.pivot),
            place(dyad.moving),
            real(dyad.length, FIGURES),
        ]);
    }
    columns
}

fn function_generators(answer: &FunctionGenerators, degrees: bool) -> Columns {
    let (unit, factor) = match degrees {
        true => ("deg", 180.0 / std::f64::consts::PI),
        false => ("rad", 1.0),
    };
    let offsets = ["crank", "rocker"].map(|side| format!(">{side} offset, {unit}"));
    let headings = [
        "kind",
        ">error",
        ">crank",
        ">coupler",
        ">rocker",
        &offsets[0],
        &offsets[1],
    ];
    let mut columns = Columns::new(&headings);
    for linkage in &answer.linkages {
        let numbers = [
            linkage.error,
            linkage.crank,
            linkage.coupler,
            linkage.rocker,
            linkage.crank_offset * factor,
            linkage.rocker_offset * factor,
        ];
        let cells = numbers.map(|x| real(x, FIGURES));
        columns.row(
            std::iter::once(linkage.kind.name().into())
                .chain(cells)
                .collect(),
        );
    }
    columns
}

fn path_linkages(answer: &PathLinkages) -> Columns {
    let mut columns = Columns::new(&[">error", "A0", "A", "B", "B0", "P"]);
    for each in &answer.linkages {
        let linkage = &each.linkage;
        let ([a0, b0], [a, b]) = (linkage.pivots, linkage.joints);
        let places = [a0, a, b, b0, linkage.point].map(place);
        columns.row(
            std::iter::once(real(each.error, FIGURES))
                .chain(places)
                .collect(),
        );
    }
    columns
}

/// For programs.
pub fn json(mechanism: &Mechanism, content: &[u8], answer: &Synthesized) -> String {
    let mut object = match answer {
        Synthesized::Dyads(answer) => dyads_json(answer),
        Synthesized::FunctionGenerators(answer) => function_generators_json(answer),
        Synthesized::PathLinkages(answer) => path_linkages_json(answer),
    };
    object["mechanism"] = mechanism_json(mechanism, content);
    let doubts = answer.doubts();
    object["settled"] = json!(doubts.is_empty());
    object["warnings"] = json!(doubts);
    format!("{object:#}\n")
}

fn pair(z: Complex64) -> Value {
    json!([z.re, z.im])
}

fn stationary_json(stationary: Stationary) -> Value {
    json!({"complex": stationary.complex, "real": stationary.real})
}

fn dyads_json(answer: &Dyads) -> Value {
    let dyads = answer.dyads.iter().map(|dyad| {
        json!({
            "pivot": pair(dyad.pivot),
            "moving": pair(dyad.moving),
            "length": dyad.length,
            "error": dyad.error,
            "kind": dyad.kind.name(),
        })
    });
    json!({
        "objective": "dyad",
        "method": "stationary",
        "stationary": stationary_json(answer.stationary),
        "dyads": dyads.collect::<Vec<_>>(),
    })
}

fn function_generators_json(answer: &FunctionGenerators) -> Value {
    let linkages = answer.linkages.iter().map(|linkage| {
        json!({
            "ground": 1,
            "crank": linkage.crank,
            "coupler": linkage.coupler,
            "rocker": linkage.rocker,
            "crank_offset": linkage.crank_offset,
            "rocker_offset": linkage.rocker_offset,
            "error": linkage.error,
            "kind": linkage.kind.name(),
        })
    });
    json!({
        "objective": "freudenstein",
        "method": "stationary",
        "stationary": stationary_json(answer.stationary),
        "without_linkage": answer.without_linkage,
        "linkages": linkages.collect::<Vec<_>>(),
    })
}

fn path_linkages_json(answer: &PathLinkages) -> Value {
    let linkages = answer.linkages.iter().map(|each| {
        let linkage = &each.linkage;
        json!({
            "A0": pair(linkage.pivots[0]),
            "A": pair(linkage.joints[0]),
            "B": pair(linkage.joints[1]),
            "B0": pair(linkage.pivots[1]),
            "P": pair(linkage.point),
            "error": each.error,
            "kind": each.kind.name(),
        })
    });
    json!({
        "objective": "distance",
        "method": "refined",
        "stationary": Value::Null,
        "linkages": linkages.collect::<Vec<_>>(),
        "starts": {
            "random": answer.starts,
            "polished": answer.polished,
            "not_stationary": answer.not_stationary,
        },
    })
}
