//! Branches along a path of targets as a table, JSON, and CSV.

use super::json::{mechanism, position_json, target_counts};
use super::view::{View, pose_columns, pose_numbers};
use crate::output::text::{Columns, Look, counted, real, seconds};
use cognate_mechanism_solver::follow::{Branch, BranchEnd, Path};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A path and how it is shown.
#[derive(Clone, Copy, Debug)]
pub struct ShownPath<'a> {
    /// How its positions are listed.
    pub view: View<'a>,
    /// The path.
    pub path: &'a Path,
    /// The bytes of the mechanism's file.
    pub content: &'a [u8],
    /// The only branches that are listed; `None` for all.
    pub chosen: Option<usize>,
    /// Time from reading the file to the answer, in seconds.
    pub wall_seconds: f64,
    /// CPU time of all threads for the answer, in seconds.
    pub cpu_seconds: f64,
}

impl ShownPath<'_> {
    /// The branches that are listed, with their numbers.
    pub(super) fn branches(&self) -> impl Iterator<Item = (usize, &Branch)> {
        let numbered_branches = self.path.branches.iter().enumerate();
        numbered_branches.filter(|(b, branch)| {
            self.chosen.is_none_or(|chosen| chosen == *b)
                && (!self.view.only_within_limits || branch.within_limits)
        })
    }

    fn end(&self, end: BranchEnd, sample: usize) -> String {
        match end {
            BranchEnd::Path => format!("sample {}", sample + 1),
            BranchEnd::Fold(fold) => format!("fold at {}", real(self.path.folds[fold].at + 1.0, 8)),
            BranchEnd::Unknown => format!("sample {}, in doubt", sample + 1),
        }
    }
}

/// Table of the branches, for people.
pub fn table(shown: &ShownPath<'_>, look: Look) -> String {
    let path = shown.path;
    let limits = !shown.view.mechanism.limits.is_empty();
    let mut text = format!(
        "{}: {}, {} along {}\n\n",
        look.bold(&shown.view.mechanism.name),
        shown.view.preparation.family.name,
        match path.branches.len() {
            1 => "1 branch".into(),
            n => format!("{n} branches"),
        },
        counted(path.samples.len() as u64, "sample"),
    );
    let mut headings = vec![">branch", "from", "to", ">samples"];
    if limits {
        headings.push("limits");
    }
    let mut columns = Columns::new(&headings);
    for (b, branch) in shown.branches() {
        let mut row = vec![
            (b + 1).to_string(),
            shown.end(branch.ends[0], branch.first),
            shown.end(branch.ends[1], branch.last()),
            branch.positions.len().to_string(),
        ];
        if limits {
            row.push(if branch.within_limits { "in" } else { "beyond" }.into());
        }
        columns.row(row);
    }
    text.push_str(&columns.render(look));
    if !path.folds.is_empty() {
        let mut columns = Columns::new(&[">fold at", "branches", "there", "proved"]);
        for fold in &path.folds {
            let names: Vec<String> = fold.branches.iter().map(|b| (b + 1).to_string()).collect();
            columns.row(vec![
                real(fold.at + 1.0, 8),
                names.join(" "),
                if fold.vanish {
                    "they vanish"
                } else {
                    "they appear"
                }
                .into(),
                if fold.error.is_some() { "yes" } else { "no" }.into(),
            ]);
        }
        text.push('\n');
        text.push_str(&columns.render(look));
    }
    if !path.limits.is_empty() {
        let mut columns = Columns::new(&["limit of", ">branch", ">after sample", "the joint"]);
        for limit in &path.limits {
            columns.row(vec![
                limit.joint.clone(),
                (limit.branch + 1).to_string(),
                (limit.sample + 1).to_string(),
                if limit.leaves {
                    "leaves its range"
                } else {
                    "comes back"
                }
                .into(),
            ]);
        }
        text.push('\n');
        text.push_str(&columns.render(look));
    }
    for [from, to] in &path.changes {
        let _ = writeln!(
            text,
            "\n  Closed path: posture {} becomes posture {} without a fold (cuspidal)",
            from + 1,
            to + 1
        );
    }
    let _ = writeln!(
        text,
        "\n  Time  {} for {}, {} of CPU",
        seconds(shown.wall_seconds),
        counted(path.samples.len() as u64, "sample"),
        seconds(shown.cpu_seconds)
    );
    if !path.settled {
        let words = "a branch is in doubt: see the warnings; no branch was changed in silence";
        let _ = writeln!(text, "  {}", look.warn(words));
    }
    text
}

fn end_json(end: BranchEnd, sample: usize) -> Value {
    match end {
        BranchEnd::Path => json!({"kind": "path", "sample": sample}),
        BranchEnd::Fold(fold) => json!({"kind": "fold", "sample": sample, "fold": fold}),
        BranchEnd::Unknown => json!({"kind": "unknown", "sample": sample}),
    }
}

/// The positions of a branch, each with its sample.
fn positions_json<'a>(
    shown: &'a ShownPath<'_>,
    branch: &'a Branch,
) -> impl Iterator<Item = Value> + 'a {
    let positions = branch.positions.iter().enumerate();
    positions.map(|(k, place)| {
        let sample = branch.first + k;
        let position = &shown.path.answers[sample].positions[*place];
        let mut value = position_json(&shown.view, position);
        value["sample"] = json!(sample);
        value
    })
}

/// Every position of every branch, a JSON object on a line.
pub fn lines(shown: &ShownPath<'_>) -> String {
    let branches = shown.path.branches.iter().enumerate();
    let lines = branches.flat_map(|(b, branch)| {
        positions_json(shown, branch).map(move |mut value| {
            value["branch"] = json!(b + 1);
            format!("{value}\n")
        })
    });
    lines.collect()
}

/// The path as one JSON object; angles in radians.
pub fn json(shown: &ShownPath<'_>) -> String {
    let (view, path) = (&shown.view, shown.path);
    let branch = |(b, branch): (usize, &Branch)| {
        let solutions = positions_json(shown, branch);
        json!({
            "id": b + 1,
            "from": end_json(branch.ends[0], branch.first),
            "to": end_json(branch.ends[1], branch.last()),
            "within_limits": branch.within_limits,
            "solutions": solutions.collect::<Vec<Value>>(),
        })
    };
    let ids = |list: &[usize]| list.iter().map(|b| b + 1).collect::<Vec<usize>>();
    let folds = path.folds.iter().map(|fold| {
        json!({
            "at_sample": fold.at,
            "error": fold.error,
            "certified": fold.error.is_some(),
            "branches": ids(&fold.branches),
            "kind": if fold.vanish { "vanish" } else { "appear" },
        })
    });
    let limits = path.limits.iter().map(|limit| {
        json!({
            "branch": limit.branch + 1,
            "after_sample": limit.sample,
            "joint": limit.joint,
            "leaves": limit.leaves,
        })
    });
    let samples = path.samples.iter().zip(&path.answers).enumerate();
    let samples = samples.map(|(i, (sample, answer))| {
        let mut value = target_counts(view, i as u64, answer);
        value["at"] = json!(sample.at);
        value
    });
    let value = json!({
        "mechanism": mechanism(view, shown.content),
        "problem": "follow",
        "angles": "rad",
        "samples": samples.collect::<Vec<Value>>(),
        "branches": shown.branches().map(branch).collect::<Vec<Value>>(),
        "branches_in_all": path.branches.len(),
        "folds": folds.collect::<Vec<Value>>(),
        "limits": limits.collect::<Vec<Value>>(),
        "posture_changes": path.changes,
        "settled": path.settled,
        "time": {"wall_seconds": shown.wall_seconds, "cpu_seconds": shown.cpu_seconds},
        "warnings": path.warnings,
    });
    format!("{value:#}\n")
}

/// A row for each position of each branch: a trajectory. Angles in the unit that is shown.
pub fn csv(shown: &ShownPath<'_>) -> String {
    let (view, path) = (&shown.view, shown.path);
    let mut text = String::new();
    for (b, branch) in shown.branches() {
        for (k, place) in branch.positions.iter().enumerate() {
            let sample = branch.first + k;
            let position = &path.answers[sample].positions[*place];
            let values = &position.configuration.values;
            if text.is_empty() {
                let mut names = vec!["branch".into(), "sample".into(), "at".into()];
                names.extend(values.iter().map(|(name, _)| super::csv::quoted(name)));
                names.extend(pose_columns(view).iter().map(|name| (*name).to_owned()));
                names.push("within_limits".into());
                let _ = writeln!(text, "{}", names.join(","));
            }
            let at = path.samples[sample].at;
            let mut row = vec![
                (b + 1).to_string(),
                (sample + 1).to_string(),
                at.to_string(),
            ];
            row.extend(values.iter().map(|(_, v)| view.value(v).to_string()));
            match &position.configuration.output {
                Some(pose) => row.extend(pose_numbers(view, pose).iter().map(f64::to_string)),
                None => row.extend(pose_columns(view).iter().map(|_| String::new())),
            }
            row.push(position.violated.is_empty().to_string());
            let _ = writeln!(text, "{}", row.join(","));
        }
    }
    text
}
