//! A system in Bertini-classic notation.
//!
//! Bertini orders variables by their groups; conjugates, degenerate sets and
//! symmetry have no place in this notation and are left out.

use crate::expression::Dependence;
use crate::expression::display::Style;
use crate::expression::parse::Dialect;
use crate::expression::token::is_name;
use crate::formats::sharing::{self, WriteError};
use crate::formats::{FileSettings, Format, PrecisionHint};
use crate::system::System;
use std::collections::HashSet;
use std::fmt::Write;

const KEYWORDS: [&str; 12] = [
    "CONFIG",
    "INPUT",
    "END",
    "variable_group",
    "hom_variable_group",
    "variable",
    "function",
    "constant",
    "parameter",
    "pathvariable",
    "random",
    "random_real",
];

/// Writes a system and settings.
pub fn write(system: &System, settings: &FileSettings) -> Result<String, WriteError> {
    let mut taken: HashSet<String> = KEYWORDS.iter().map(|k| k.to_string()).collect();
    for name in system.variables.iter().chain(&system.parameters) {
        if let Some(meaning) = Dialect::BERTINI.reserved(name).or_else(|| {
            KEYWORDS
                .contains(&name.as_str())
                .then_some("a word of the notation")
        }) {
            let (name, format) = (name.clone(), Format::Bertini);
            return Err(WriteError::ReservedName {
                name,
                format,
                meaning,
            });
        }
        taken.insert(name.clone());
    }
    let mut functions = Vec::new();
    for i in 0..system.equations.len() {
        let given = system.equation_names.get(i).filter(|name| {
            is_name(name) && Dialect::BERTINI.reserved(name).is_none() && !taken.contains(*name)
        });
        let name = match given {
            Some(name) => name.clone(),
            None => {
                let free = |n: &usize| !taken.contains(&format!("f{n}"));
                let number = (i + 1..).find(free).expect("finitely many names are taken");
                format!("f{number}")
            }
        };
        taken.insert(name.clone());
        functions.push(name);
    }
    let style = Style::BERTINI;
    let roots = sharing::roots(system, true);
    let sharing = sharing::share(system, style, &roots, taken, &|_| true);
    let display = sharing::display(system, style, &sharing.names);

    let mut out = String::from("CONFIG\n");
    write_settings(settings, system, &mut out);
    out.push_str("END;\nINPUT\n");
    let homotopy = system.path_variable.is_some();
    for group in &system.groups {
        let word = match (group.homogeneous, homotopy && system.groups.len() == 1) {
            (true, _) => "hom_variable_group",
            (false, true) => "variable",
            (false, false) => "variable_group",
        };
        let members: Vec<&str> = group
            .variables
            .iter()
            .map(|&v| system.variables[v].as_str())
            .collect();
        line(&mut out, &format!("{word} {};", members.join(", ")));
    }
    for (i, name) in system.parameters.iter().enumerate() {
        let word = if system.path_variable == Some(i) {
            "pathvariable"
        } else {
            "parameter"
        };
        line(&mut out, &format!("{word} {name};"));
    }
    line(&mut out, &format!("function {};", functions.join(", ")));
    for node in &sharing.order {
        let name = &sharing.names[node];
        if system.expressions.dependence(*node) == Dependence::Constant {
            line(&mut out, &format!("constant {name};"));
        }
        line(&mut out, &format!("{name} = {};", display.text(*node)));
    }
    for (name, equation) in functions.iter().zip(&system.equations) {
        let text = match sharing.names.get(equation) {
            Some(shared) => shared.clone(),
            None => display.text(*equation),
        };
        line(&mut out, &format!("{name} = {text};"));
    }
    out.push_str("END;\n");
    Ok(out)
}

fn line(out: &mut String, text: &str) {
    out.push_str(text);
    out.push('\n');
}

fn write_settings(settings: &FileSettings, system: &System, out: &mut String) {
    let mut put = |name: &str, value: String| {
        writeln!(out, "{name}: {value};").expect("a string takes any text");
    };
    if let Some(seed) = settings.seed {
        put("RandomSeed", seed.to_string());
    }
    if let Some(digits) = settings.digits {
        put("SharpenDigits", digits.to_string());
    }
    match settings.precision {
        Some(PrecisionHint::Double) => put("MPType", "0".into()),
        Some(PrecisionHint::Bits(bits)) => {
            put("MPType", "1".into());
            put("Precision", bits.to_string());
        }
        Some(PrecisionHint::Adaptive) => put("MPType", "2".into()),
        None => {}
    }
    let tolerances = [
        ("FinalTol", settings.final_tolerance),
        ("TrackTolBeforeEG", settings.tracking_tolerance),
        ("TrackTolDuringEG", settings.endgame_tolerance),
    ];
    for (name, value) in tolerances {
        if let Some(value) = value {
            put(name, format!("{value:e}"));
        }
    }
    if let Some(steps) = settings.maximum_steps {
        put("MaxNumberSteps", steps.to_string());
    }
    if system.path_variable.is_some() {
        put("UserHomotopy", "1".into());
    }
    if let Some(kind) = settings.parameter_homotopy {
        put("ParameterHomotopy", kind.to_string());
    }
}
