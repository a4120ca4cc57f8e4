//! A decomposition for people: components by dimension, the sum of the paths, and the doubts; and the folder of
//! --output.

use super::bertini;
use super::files::{create, make_folder, write_file};
use super::json;
use super::table::Lines;
use super::text::{Columns, Look, count, counted, magnitude, seconds, wrapped};
use crate::error::{ClientError, Exit};
use cognate_solutions::witness::{Irreducible, Proof};
use cognate_summary::decomposition::{ComponentBlock, DecompositionSummary};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// Doubts shown before a table says how many more there are.
const DOUBTS_SHOWN: usize = 8;

/// The exit code that this answer has.
pub fn exit(summary: &DecompositionSummary) -> Exit {
    Exit::of_settled(summary.settled)
}

/// The whole table; `files` is the folder with the witness points.
pub fn table(summary: &DecompositionSummary, files: Option<&Path>, look: Look) -> String {
    let mut text = headline(summary, look);
    text.push('\n');
    if !summary.decomposition.components.is_empty() {
        text.push_str(&indented(&components(summary, look)));
        text.push('\n');
    }
    text.push_str(&indented(&dimensions(summary, look)));
    text.push('\n');
    text.push_str(&proofs(summary, look));
    let (paths, loops) = (&summary.paths.superset, &summary.paths.loops);
    let number = (count(paths.total.max(loops.total)).len() + 1).max(6);
    let mut lines = Lines::new(look, number);
    let note = format!(
        "{} tracked again, {} failed, {} of {} resolved",
        count(paths.retracked),
        count(paths.failed),
        count(paths.crossings_resolved),
        counted(paths.crossings_found, "crossing"),
    );
    lines.heading("Paths", &count(paths.total), &note);
    let note = match loops.failed {
        0 => String::new(),
        failed => format!("{} failed", count(failed)),
    };
    lines.line("of loops", &count(loops.total), &note);
    let time = &summary.time;
    let cpu = format!("{} of CPU", seconds(time.cpu_seconds));
    lines.heading("Time", &seconds(time.wall_seconds), &cpu);
    let workers = summary.workers.len();
    if workers > 0 {
        let items: u64 = summary.workers.iter().map(|worker| worker.paths).sum();
        let note = counted(items, "item");
        lines.heading("Workers", &workers.to_string(), &note);
    }
    text.push_str(&lines.finish());
    for warning in &summary.warnings {
        for (i, line) in wrapped(warning, look.width - 11).iter().enumerate() {
            let lead = if i == 0 { "  warning: " } else { "           " };
            let _ = writeln!(text, "{}{line}", look.warn(lead));
        }
    }
    let note = match files {
        Some(folder) => format!("witness points are in {}", folder.display()),
        None => "--output DIR writes the witness points".into(),
    };
    let _ = writeln!(text, "\n  {}", look.dim(&note));
    text
}

/// Two columns before each line.
pub(super) fn indented(text: &str) -> String {
    let line = |line: &str| match line {
        "" => "\n".to_owned(),
        line => format!("  {line}\n"),
    };
    text.lines().map(line).collect()
}

/// The answer in one phrase.
pub fn answer(summary: &DecompositionSummary) -> String {
    let components = summary.decomposition.components.iter();
    match components.map(|c| c.count).sum() {
        0 if summary.settled => "no components in the dimensions that were asked".into(),
        0 => "no components found".into(),
        n => counted(n, "component"),
    }
}

/// The answer in a line or two, with the parts that are not settled.
fn headline(summary: &DecompositionSummary, look: Look) -> String {
    let decomposition = &summary.decomposition;
    let answer = answer(summary);
    let answer = match summary.settled {
        true => look.good(&answer),
        false => look.warn(&answer),
    };
    let problem = &summary.problem;
    let mut text = format!("{}: {answer}\n", look.bold(&problem.name));
    let [lowest, highest] = decomposition.asked;
    let asked = match lowest == highest {
        true => format!("dimension {lowest}"),
        false => format!("dimensions {lowest} to {highest}"),
    };
    let what = format!(
        "{}, {}, {asked}, by {}, seed {}",
        counted(problem.variables, "variable"),
        counted(problem.equations, "equation"),
        problem.method,
        problem.seed
    );
    for line in wrapped(&what, look.width) {
        let _ = writeln!(text, "{}", look.dim(&line));
    }
    if let Some(second) = &decomposition.verification {
        let said = match (second.agrees, second.settled) {
            (true, true) => "finds the same",
            (true, false) => "finds the same, and leaves something in doubt",
            (false, _) => "finds something else",
        };
        let _ = writeln!(
            text,
            "{}",
            look.dim(&format!("verified: {} {said}", second.method.name()))
        );
    }
    for said in removed(summary) {
        for line in wrapped(&said, look.width) {
            let _ = writeln!(text, "{}", look.dim(&line));
        }
    }
    for doubt in decomposition.unsettled.iter().take(DOUBTS_SHOWN) {
        for (i, line) in wrapped(doubt, look.width - 15).iter().enumerate() {
            let lead = match i {
                0 => "not settled: ",
                _ => "             ",
            };
            let _ = writeln!(text, "{}{line}", look.warn(lead));
        }
    }
    let more = decomposition.unsettled.len().saturating_sub(DOUBTS_SHOWN);
    if more > 0 {
        let _ = writeln!(
            text,
            "{}and {} more",
            look.warn("not settled: "),
            count(more as u64)
        );
    }
    text
}

/// A line for each reason to remove components.
pub(super) fn removed(summary: &DecompositionSummary) -> impl Iterator<Item = String> {
    summary
        .decomposition
        .removed
        .iter()
        .map(|(reason, removed)| {
            let each = removed.iter().map(|c| {
                let (dimension, degree) = (c.dimension, count(c.degree));
                format!(
                    "{} of dimension {dimension} and degree {degree}",
                    count(c.count)
                )
            });
            let each = each.collect::<Vec<_>>().join(", ");
            format!("removed, in no other count: {each}; {reason} on all of it")
        })
}

/// Properties that components on one line of the table share.
fn likeness(c: &ComponentBlock) -> (u32, u64, Option<u64>, u64, Irreducible, &[u32]) {
    (
        c.dimension,
        c.degree,
        c.multiplicity,
        c.tracked_multiplicity,
        c.irreducible,
        &c.deflation,
    )
}

fn components(summary: &DecompositionSummary, look: Look) -> String {
    let mut columns = Columns::new(&[
        ">dimension",
        ">degree",
        ">multiplicity",
        ">count",
        "irreducible",
        "trace",
    ]);
    for alike in summary
        .decomposition
        .components
        .chunk_by(|a, b| likeness(a) == likeness(b))
    {
        let first = &alike[0];
        columns.row(vec![
            first.dimension.to_string(),
            count(first.degree),
            first.multiplicity.map_or_else(|| "?".into(), count),
            count(alike.iter().map(|c| c.count).sum()),
            match first.irreducible {
                Irreducible::Yes => "yes".into(),
                Irreducible::Unsettled => "unsettled".into(),
                Irreducible::NotAsked => "not asked".into(),
            },
            evidence(alike),
        ]);
    }
    columns.render(Look {
        width: look.width - 2,
        ..look
    })
}

/// The largest trace of these components, and the least of points that are none.
fn evidence(alike: &[ComponentBlock]) -> String {
    if alike[0].dimension == 0 {
        return "isolated".into();
    }
    let traces = alike.iter().filter_map(|c| c.evidence.trace_deviation);
    let trace = traces
        .reduce(f64::max)
        .map_or_else(|| "?".into(), magnitude);
    let wrong = alike.iter().filter_map(|c| c.evidence.smallest_wrong_union);
    match wrong.reduce(f64::min) {
        Some(least) => format!("{trace}, wrong {}", magnitude(least)),
        None => trace,
    }
}

/// Proofs, and the claims that have only evidence; empty if no proof was asked for.
fn proofs(summary: &DecompositionSummary, look: Look) -> String {
    let component_blocks = &summary.decomposition.components;
    let proved = component_blocks
        .iter()
        .filter_map(|c| Some((c, c.evidence.proof?)));
    let proved: Vec<(&ComponentBlock, Proof)> = proved.collect();
    let Some(mut total_proof) = proved.first().map(|(_, proof)| *proof) else {
        return String::new();
    };
    proved[1..]
        .iter()
        .for_each(|(_, proof)| total_proof.add(proof));
    let points: u64 = component_blocks.iter().map(|c| c.degree * c.count).sum();
    let counted_if = |is: &dyn Fn(&Proof) -> bool| -> u64 {
        let proved_blocks = proved.iter().filter(|(_, proof)| is(proof));
        proved_blocks.map(|(c, _)| c.count).sum()
    };
    let components: u64 = component_blocks.iter().map(|c| c.count).sum();
    let (given, whole) = (
        counted_if(&|proof| proof.all_equations),
        counted_if(&|proof| proof.irreducible),
    );
    let mut text = String::new();
    let mut say = |lead: &str, what: &str| {
        let blank = " ".repeat(lead.len());
        for (i, line) in wrapped(what, look.width - lead.len()).iter().enumerate() {
            let lead = if i == 0 { lead } else { &blank };
            let _ = writeln!(text, "{lead}{line}");
        }
    };
    say(
        "  proved:   ",
        &format!(
            "{} of {} witness points alone in boxes, {} of them in boxes that meet no other, as solutions of the \
             slices and, in {} of {} components, of the given equations, in the others of combinations of them; \
             {} of witness points proved to be no component",
            count(total_proof.points),
            count(points),
            count(total_proof.distinct),
            count(given),
            count(components),
            counted(total_proof.unions, "union")
        ),
    );
    say(
        "            ",
        &format!(
            "given that no witness point is missing, {} of {} components are irreducible",
            count(whole),
            count(components)
        ),
    );
    for (component, proof) in proved
        .iter()
        .filter(|(_, proof)| !proof.irreducible)
        .take(DOUBTS_SHOWN)
    {
        let (id, least) = (&component.id, proof.least_degree);
        say(
            "            ",
            &format!("{id}: none in it has a degree below {}", count(least)),
        );
    }
    say(
        "  evidence: ",
        "that no witness point is missing: traces and counts; what loops brought together; equations that are not among \
         the combinations",
    );
    text.push('\n');
    text
}

fn dimensions(summary: &DecompositionSummary, look: Look) -> String {
    let by_dimension = &summary.decomposition.by_dimension;
    let by_loops = by_dimension.values().any(|d| d.found_by_loops > 0);
    let mut names = vec![
        ">dimension",
        ">components",
        ">degree",
        ">paths",
        ">junk",
        ">excess",
        ">failed",
    ];
    let removed = by_dimension.values().any(|d| d.removed > 0);
    names.extend(removed.then_some(">removed"));
    names.extend(by_loops.then_some(">found by loops"));
    let by_orbits = by_dimension.values().any(|d| d.orbits.is_some());
    if by_orbits {
        names.push(">orbits");
    }
    names.push("complete");
    let mut columns = Columns::new(&names);
    for (number, d) in by_dimension.iter().rev() {
        let mut row = vec![
            number.to_string(),
            count(d.components),
            count(d.degree),
            count(d.superset),
            count(d.junk),
            count(d.excess),
            count(d.failed),
        ];
        row.extend(removed.then(|| count(d.removed)));
        row.extend(by_loops.then(|| count(d.found_by_loops)));
        row.extend(by_orbits.then(|| match (d.components, d.orbits) {
            (0, _) => "0".into(),
            (_, orbits) => orbits.map_or_else(|| "?".into(), count),
        }));
        row.push(d.complete.name().into());
        columns.row(row);
    }
    columns.render(Look {
        width: look.width - 2,
        ..look
    })
}

/// The folder of --output: `summary.json`; `decomposition.json` with slices and evidence; `system.json`; Bertini's files;
/// `witness_points.jsonl` with a point on each line. Numbers stay as they were written.
pub fn write(folder: &Path, summary: &str, mut decomposition: Value) -> Result<(), ClientError> {
    let strange = || ClientError::GaveUp("its components are not what was agreed".into());
    make_folder(folder)?;
    bertini::write(folder, &decomposition)?;
    let system = decomposition
        .as_object_mut()
        .and_then(|fields| fields.remove("system"));
    let system = system
        .as_ref()
        .and_then(Value::as_str)
        .ok_or_else(strange)?;
    write_file(folder, "system.json", system)?;
    let mut lines = create(folder, "witness_points.jsonl")?;
    let variables = decomposition["variables"]
        .as_array()
        .cloned()
        .ok_or_else(strange)?;
    let components = decomposition["components"]
        .as_array_mut()
        .ok_or_else(strange)?;
    for component in components {
        let fields = component.as_object_mut().ok_or_else(strange)?;
        let points = fields.remove("points");
        let id = &fields["id"];
        let id = format!("{}.{}", id["dimension"], id["number"]);
        for point in points
            .as_ref()
            .and_then(Value::as_array)
            .ok_or_else(strange)?
        {
            let coordinates = point.as_array().ok_or_else(strange)?;
            let mut values = Map::new();
            for (name, z) in variables.iter().zip(coordinates) {
                let name = name.as_str().ok_or_else(strange)?;
                values.insert(name.to_owned(), z.clone());
            }
            let line = json!({ "component": id, "variables": values });
            lines.write(&format!("{line}\n"))?;
        }
    }
    lines.finish()?;
    write_file(
        folder,
        "decomposition.json",
        &format!("{decomposition:#}\n"),
    )?;
    write_file(folder, "summary.json", &json::summary(summary))
}
