//! `cognate info`: what a file holds and what each start would cost.

use crate::arguments::{Format, Info};
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::text::{Look, count, counted, wrapped};
use crate::problem;
use cognate_algorithms::decomposition::{DecompositionCosts, DecompositionOptions};
use cognate_algorithms::start_costs::StartCosts;
use cognate_numeric::interruption::Interruption;
use cognate_systems::formats::Problem;
use cognate_systems::system::System;
use cognate_systems::typed_unknowns::HelperMeaning;
use num_complex::Complex64;
use serde::Serialize;
use std::fmt::Write as _;
use std::sync::mpsc;
use std::time::Duration;

/// How long is counted at most. Default 60 s: bounds by operations end nearly all before it.
const PATIENCE: Duration = Duration::from_secs(60);

/// Reads and counts; solves nothing.
pub fn run(a: &Info) -> Result<Exit, ClientError> {
    let read = problem::read_source(&a.system, a.groups.as_deref())?;
    for warning in &read.warnings {
        eprintln!("warning: {warning}");
    }
    let name = problem::source_name(&a.system);
    if a.decompose {
        return components(a, &name, &read);
    }
    let sets = problem::read_sets(a.sets.as_deref(), &read.system)?;
    let costs = within_time(|| StartCosts::with_sets(&read.system, sets.as_ref()));
    let costs = costs.map_err(|e| ClientError::Input {
        origin: name.clone(),
        message: e.to_string(),
    })?;
    let described = Described {
        became: Became::of(&read.system, &costs),
        costs: &costs,
    };
    show(a.format, &described, |look| {
        table(&name, &read, &costs, look)
    })
}

/// Costs, and the polynomial system that functions of unknowns became, where there are some.
#[derive(Serialize)]
struct Described<'a> {
    #[serde(flatten)]
    costs: &'a StartCosts,
    #[serde(skip_serializing_if = "Option::is_none")]
    became: Option<Became<'a>>,
}

/// The polynomial system that functions of unknowns became.
#[derive(Serialize)]
struct Became<'a> {
    helpers: Vec<HelperMeaning>,
    angles: Vec<&'a str>,
    degrees: &'a [u32],
}

impl<'a> Became<'a> {
    fn of(system: &'a System, costs: &'a StartCosts) -> Option<Self> {
        let helpers = system.helper_meanings();
        (!helpers.is_empty()).then(|| Self {
            helpers,
            angles: system.angle_unknowns().map(|a| a.name.as_str()).collect(),
            degrees: &costs.degrees,
        })
    }
}

/// Runs a count for at most [`PATIENCE`]; a count that is not finished by then reports that it takes too long.
fn within_time<T>(count: impl FnOnce() -> T) -> T {
    let sign = Interruption::default();
    let (ended, end) = mpsc::channel::<()>();
    let timer = {
        let sign = sign.clone();
        move || {
            if end.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                sign.interrupt();
            }
        }
    };
    std::thread::spawn(timer);
    let counted = sign.run(count);
    drop(ended);
    counted
}

/// Prints costs in the format that is asked for.
fn show(
    format: Format,
    costs: &impl Serialize,
    table: impl FnOnce(Look) -> String,
) -> Result<Exit, ClientError> {
    let text = match format {
        Format::Table => table(Look::of_standard_output()),
        Format::Json => {
            let json = serde_json::to_string_pretty(costs);
            format!(
                "{}\n",
                json.expect("counts and names can be written as JSON")
            )
        }
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// Prints the cost of each method that finds all components.
fn components(a: &Info, name: &str, read: &Problem) -> Result<Exit, ClientError> {
    let options = DecompositionOptions {
        parameters: vec![Complex64::new(1.0, 0.0); read.system.parameters.len()],
        ..DecompositionOptions::default()
    };
    let costs = DecompositionCosts::of(&read.system, &options);
    let costs = costs.map_err(|e| ClientError::Input {
        origin: name.to_owned(),
        message: e.to_string(),
    })?;
    show(a.format, &costs, |look| {
        table_of_components(name, &costs, look)
    })
}

fn table_of_components(name: &str, costs: &DecompositionCosts, look: Look) -> String {
    let [lowest, highest] = costs.dimensions;
    let mut text = format!(
        "{}: {}, {}; components have dimensions {lowest} to {highest}\n\n  {}\n",
        look.bold(name),
        counted(costs.variables, "variable"),
        counted(costs.equations, "equation"),
        look.bold(&format!("{:<LABEL$}paths at most", "method")),
    );
    for (method, paths) in &costs.paths {
        let paths = paths.map_or_else(|| "more than 2^64".into(), count);
        let _ = writeln!(text, "  {method:<LABEL$}{paths}");
    }
    text.push('\n');
    let why = format!("auto takes {}: {}", costs.choice, costs.why);
    for part in wrapped(&why, look.width - 2) {
        let _ = writeln!(text, "  {part}");
    }
    text
}

/// Width of the column of names.
const LABEL: usize = 18;

/// Contents of the file, for people.
pub fn table(name: &str, read: &Problem, costs: &StartCosts, look: Look) -> String {
    let mut text = format!(
        "{}: {}, {}\n\n",
        look.bold(name),
        counted(costs.variables as u64, "variable"),
        counted(costs.equations as u64, "equation"),
    );
    text.push_str(&contents(read, costs, look));
    text.push_str(&start_table(costs, look));
    let why = match costs.choice {
        Some(choice) => format!("auto takes {choice}: {}", costs.why),
        None => format!("cannot be solved: {}", costs.why),
    };
    text.push('\n');
    for part in wrapped(&why, look.width - 2) {
        let _ = writeln!(text, "  {part}");
    }
    text
}

/// Format, unknowns, parameters, degrees and symmetry of a file, one line each.
fn contents(read: &Problem, costs: &StartCosts, look: Look) -> String {
    let system = &read.system;
    let mut text = String::new();
    let mut line = |label: &str, content: &str| {
        let lines = wrapped(content, look.width.saturating_sub(2 + LABEL).max(20));
        for (i, part) in lines.iter().enumerate() {
            let label = if i == 0 { label } else { "" };
            let _ = writeln!(text, "  {label:<LABEL$}{part}");
        }
    };
    line("format", &read.format.to_string());
    for (g, group) in system.groups.iter().enumerate() {
        let names: Vec<&str> = group
            .variables
            .iter()
            .map(|&v| system.variables[v].as_str())
            .collect();
        let kind = if group.homogeneous {
            " (homogeneous)"
        } else {
            ""
        };
        let label = if g == 0 { "variable groups" } else { "" };
        line(label, &format!("{}{kind}", names.join(", ")));
    }
    for (number, helper) in system.helper_meanings().iter().enumerate() {
        let label = if number == 0 { "helper unknowns" } else { "" };
        line(label, &format!("{} is {}", helper.name, helper.is));
    }
    if !system.parameters.is_empty() {
        line("parameters", &system.parameters.join(", "));
    }
    if let Some(t) = system.path_variable {
        line("path variable", &system.parameters[t]);
    }
    line("degrees", &degrees(&costs.degrees));
    line(
        "symmetry",
        &match system.symmetry.len() {
            0 => String::new(),
            n => counted(n as u64, "generator"),
        },
    );
    text
}

/// The groups of variables of the multihomogeneous start: their number, or their names if they were searched for.
fn variable_groups(costs: &StartCosts) -> String {
    match (
        costs.multihomogeneous.groups.len(),
        costs.notes.get("groups"),
    ) {
        (1, _) => "one group".to_string(),
        (n, None) => format!("{n} groups"),
        (_, Some(how)) => {
            let names = costs.multihomogeneous.groups.iter();
            let names: Vec<String> = names.map(|g| format!("{{{}}}", g.join(", "))).collect();
            format!("{}; {how}", names.join(" "))
        }
    }
}

/// The number of paths of each start system, with a remark.
fn start_table(costs: &StartCosts, look: Look) -> String {
    let title = look.bold(&format!("{:<LABEL$}paths", "start"));
    let mut text = format!("\n  {title}\n");
    let groups = variable_groups(costs);
    let starts = [
        ("total-degree", costs.total_degree, "total_degree", ""),
        (
            "multihomogeneous",
            costs.multihomogeneous.number,
            "multihomogeneous",
            groups.as_str(),
        ),
        ("linear-product", costs.linear_product, "linear_product", ""),
        ("polyhedral", costs.mixed_volume, "mixed_volume", ""),
    ];
    let widest = starts
        .iter()
        .filter_map(|s| s.1)
        .map(|n| count(n).len())
        .max();
    let width = widest.unwrap_or(1).max("paths".len());
    for (start, number, field, remark) in starts {
        let reason = costs.notes.get(field).map_or(remark, String::as_str);
        let number = number.map_or_else(|| "-".into(), count);
        let room = look.width.saturating_sub(2 + LABEL + width + 2).max(20);
        let mut notes = wrapped(reason, room).into_iter();
        let first = notes.next().unwrap_or_default();
        let row = format!("  {start:<LABEL$}{number:>width$}  {first}");
        let _ = writeln!(text, "{}", row.trim_end());
        for more in notes {
            let _ = writeln!(text, "{}{more}", " ".repeat(2 + LABEL + width + 2));
        }
    }
    text
}

/// Degrees in the order of the equations, equal neighbours together: `2 x7, 3`.
fn degrees(degrees: &[u32]) -> String {
    let runs: Vec<String> = degrees
        .chunk_by(|a, b| a == b)
        .map(|run| match run.len() {
            1 => run[0].to_string(),
            n => format!("{} x{n}", run[0]),
        })
        .collect();
    runs.join(", ")
}
