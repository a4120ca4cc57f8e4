//! Positions of a mechanism as a table for people.

use super::shown::{Shown, pose_columns, pose_numbers};
use crate::mechanism::target_answer::Position;
use crate::output::text::{Columns, Look, counted, magnitude, real, seconds};
use cognate_kinematics::compile::Problem;
use std::fmt::Write as _;

/// So many positions are listed in a table at most.
const MOST_LISTED: usize = 64;

/// What became of targets, and the positions of the first of them.
pub fn table(shown: &Shown<'_>, look: Look) -> String {
    let (answer, view) = (shown.answer, &shown.view);
    let prepared = view.preparation;
    let family = &prepared.family;
    let number = match (prepared.here, family.expected) {
        (Some(here), Some(expected)) if here == expected => {
            format!("{here} for every target  ({})", family.source)
        }
        (Some(_), Some(_)) if !prepared.reason.is_empty() => prepared.reason.clone(),
        (Some(here), _) => format!("{here} for a general target"),
        (None, Some(expected)) => format!("at most {expected}  ({})", family.source),
        (None, None) => "no number is known beforehand".into(),
    };
    let mut text = format!(
        "{}: {}: {number}\n\n",
        look.bold(&view.mechanism.name),
        family.name
    );
    let certified = answer
        .targets
        .iter()
        .any(|t| t.counts.certified_real.is_some());
    let limits = !view.mechanism.limits.is_empty();
    let mut headings = vec![">target", ">complex", ">real"];
    if certified {
        headings.push(">proved");
    }
    if limits {
        headings.push(">within limits");
    }
    headings.extend([
        ">singular",
        ">at infinity",
        ">on sets",
        ">no position",
        ">failed",
    ]);
    let mut columns = Columns::new(&headings);
    for (i, target) in answer.targets.iter().enumerate() {
        let counts = &target.counts;
        let mut row = vec![i as u64 + 1, counts.complex, counts.real];
        row.extend(counts.certified_real);
        if limits {
            row.push(counts.within_limits);
        }
        row.extend([
            counts.singular,
            counts.at_infinity,
            counts.positive_dimensional,
            counts.degenerate,
            counts.failed,
        ]);
        columns.row(row.iter().map(u64::to_string).collect());
    }
    text.push_str(&columns.render(look));
    let each = shown.cpu_seconds / answer.targets.len().max(1) as f64;
    let kept = if prepared.from_cache {
        "  prepared before"
    } else {
        ""
    };
    let _ = writeln!(
        text,
        "\n  Time  {} for {}, {} of CPU each{kept}\n",
        seconds(shown.wall_seconds),
        counted(answer.targets.len() as u64, "target"),
        seconds(each)
    );
    text.push_str(&positions_table(shown, look));
    if !answer.settled {
        let _ = writeln!(
            text,
            "  {}",
            look.warn("not everything is settled: see the counts and warnings")
        );
    }
    text
}

fn positions_table(shown: &Shown<'_>, look: Look) -> String {
    let (answer, view) = (shown.answer, &shown.view);
    let numbered = answer.targets.iter().enumerate().flat_map(|(i, target)| {
        let listed = target
            .positions
            .iter()
            .filter(|p| view.lists(p))
            .enumerate();
        listed.map(move |(k, position)| (i, k, position))
    });
    let listed: Vec<(usize, usize, &Position)> = numbered.collect();
    let Some((_, _, first)) = listed.first() else {
        return "  no position to show\n".into();
    };
    let limits = !view.mechanism.limits.is_empty();
    let forward = view.problem != Problem::Inverse;
    let mut headings: Vec<String> = vec![">#".into()];
    let values = &first.configuration.values;
    headings.extend(values.iter().map(|(name, _)| format!(">{name}")));
    if forward && first.configuration.output.is_some() {
        headings.extend(pose_columns(view).iter().map(|h| format!(">{h}")));
    }
    if limits {
        headings.push("limits".into());
    }
    headings.push(">condition".into());
    let names: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut columns = Columns::new(&names);
    for (i, k, position) in listed.iter().take(MOST_LISTED) {
        let mut row = vec![format!("{}.{}", i + 1, k + 1)];
        let values = &position.configuration.values;
        row.extend(values.iter().map(|(_, v)| real(view.value(v), 6)));
        if forward && let Some(pose) = &position.configuration.output {
            row.extend(pose_numbers(view, pose).iter().map(|x| real(*x, 6)));
        }
        if limits {
            row.push(match position.violated.is_empty() {
                true => "in".into(),
                false => position.violated.join(" "),
            });
        }
        row.push(magnitude(position.condition));
        columns.row(row);
    }
    let mut text = columns.render(look);
    if listed.len() > MOST_LISTED {
        let _ = writeln!(
            text,
            "  {} more; all of them with --format json",
            listed.len() - MOST_LISTED
        );
    }
    text
}
