//! The sheet for people: the end of every class, and the linkages worth looking at.

use super::{Sheet, word};
use crate::output::table::Lines;
use crate::output::text::{Columns, Look, count, counted, real, seconds, wrapped};
use cognate_kinematics::assessment::Grade;
use cognate_kinematics::drive::Drive;
use cognate_kinematics::nine_point::ClassEnd;
use cognate_kinematics::nine_point::family::CLASSES;
use std::fmt::Write as _;
use std::path::Path;

/// Linkages shown before the table says how many more there are.
const SHOWN: usize = 12;

/// Significant figures of a length.
const FIGURES: usize = 4;

/// The whole table; `files` is the folder with everything.
pub fn sheet(sheet: &Sheet, files: Option<&Path>, look: Look) -> String {
    let mut lines = Lines::new(look, 6);
    lines.raw(&headline(sheet, look));
    lines.blank();
    classes(&mut lines, sheet);
    lines.blank();
    linkages(&mut lines, sheet);
    work(&mut lines, sheet);
    for warning in &sheet.warnings {
        for (k, line) in wrapped(warning, look.width - 9).iter().enumerate() {
            let lead = if k == 0 { "warning: " } else { "         " };
            lines.raw(&format!("{}{line}\n", look.warn(lead)));
        }
    }
    if !sheet.curves.is_empty() {
        lines.blank();
        lines.raw(&list(sheet, files, look));
    }
    lines.finish()
}

/// One line for one set of a sweep: its counts, and its best linkage.
pub fn line(sheet: &Sheet) -> String {
    let ends: Vec<String> = sheet
        .classes
        .iter()
        .filter(|(_, n)| *n > 0)
        .map(|(end, n)| format!("{n} {}", word(*end).replace('_', " ")))
        .collect();
    let best = sheet.linkages().next().map(|(_, _, mechanism)| {
        let a = &mechanism.assessment;
        let angle = a.drive().transmission_degrees;
        format!("; best {} {}, {angle:.1} degrees", a.grade.name(), a.kind())
    });
    let real = match sheet.real {
        Some(n) => counted(n as u64, "real curve"),
        None => "complex points".into(),
    };
    format!(
        "{}: {}, {real}{}\n",
        sheet.name,
        ends.join(", "),
        best.unwrap_or_default()
    )
}

fn headline(sheet: &Sheet, look: Look) -> String {
    let failed = sheet.count(ClassEnd::Failed);
    let answer = match (sheet.real, failed) {
        (None, _) => "the points are complex: there is nothing to build".to_string(),
        (Some(0), 0) => "no four-bar linkage passes these points".to_string(),
        (Some(n), _) => {
            let linkages = sheet.linkages().count() as u64;
            let curves = counted(n as u64, "coupler curve");
            format!(
                "{curves} through the nine points, {}",
                counted(linkages, "linkage")
            )
        }
    };
    let answer = match failed {
        0 => look.good(&answer),
        _ => look.warn(&answer),
    };
    let mut text = format!("{}: {answer}\n", look.bold(&sheet.name));
    if failed > 0 {
        let open = match failed {
            1 => "1 class".to_string(),
            n => format!("{n} classes"),
        };
        let _ = writeln!(text, "{}{open} of {CLASSES}", look.warn("not settled: "));
    }
    text
}

fn classes(lines: &mut Lines, sheet: &Sheet) {
    lines.heading(
        "Classes",
        "",
        "each a curve with its three cognate linkages",
    );
    let meanings = [
        (ClassEnd::Failed, "failed", "a path was lost"),
        (ClassEnd::AtInfinity, "at infinity", "all three cognates"),
        (
            ClassEnd::Degenerate,
            "degenerate",
            "links without length, equal sides, or a whole family",
        ),
        (
            ClassEnd::Multiple,
            "multiple",
            "where classes meet, or singular",
        ),
        (ClassEnd::Finite, "finite", "regular"),
    ];
    for (end, name, meaning) in meanings {
        let n = sheet.count(end);
        lines.line(name, &count(n as u64), if n == 0 { "" } else { meaning });
    }
    lines.line("", &"-".repeat(5), "");
    lines.line(
        "total",
        &count(CLASSES as u64),
        "all there are (Wampler, Morgan, Sommese 1992)",
    );
    match sheet.real {
        Some(n) => lines.line("real", &count(n as u64), "can be built"),
        None => lines.line("real", "-", "the points are complex"),
    }
    if let Some(n) = sheet.certified {
        let proved = sheet.curves.iter().filter(|curve| curve.certified).count() as u64;
        let note = format!(
            "proved to be there and different; {} proved real",
            count(proved)
        );
        lines.line("certified", &count(n as u64), &note);
    }
    if sheet.derived > 0 {
        let note = "found as another's conjugate, or along other parameters";
        lines.line("derived", &count(sheet.derived as u64), note);
    }
}

fn linkages(lines: &mut Lines, sheet: &Sheet) {
    if sheet.curves.is_empty() {
        return;
    }
    let graded_linkages = |grade: Grade| {
        let linkages = sheet
            .linkages()
            .filter(|(_, _, m)| m.assessment.grade == grade);
        count(linkages.count() as u64)
    };
    lines.heading("Linkages", "", "by how they pass the points");
    let grades = [
        (
            Grade::InOrder,
            "in order",
            "driven through all nine, in their order",
        ),
        (
            Grade::OneBranch,
            "one branch",
            "driven through all nine, in another order",
        ),
        (
            Grade::OneCircuit,
            "one circuit",
            "a dead centre lies between",
        ),
        (
            Grade::TwoCircuits,
            "two circuits",
            "must be taken apart between points",
        ),
    ];
    for (grade, name, meaning) in grades {
        lines.line(name, &graded_linkages(grade), meaning);
    }
    lines.blank();
}

fn work(lines: &mut Lines, sheet: &Sheet) {
    let paths: u64 = sheet.rounds.iter().map(|r| r.summary.paths.total).sum();
    let rounds: Vec<String> = sheet
        .rounds
        .iter()
        .map(|r| format!("{} {}", count(r.summary.paths.total), r.purpose))
        .collect();
    lines.heading("Paths", &count(paths), &rounds.join(", "));
    let time = format!("{} of CPU tracking", seconds(sheet.tracking_seconds()));
    lines.heading("Time", &seconds(sheet.elapsed.as_secs_f64()), &time);
}

/// The order of the points, compactly.
pub(super) fn order(drive: &Drive) -> String {
    match &drive.order {
        None => "-".into(),
        Some(order) => order.iter().map(|k| (k + 1).to_string()).collect(),
    }
}

fn list(sheet: &Sheet, files: Option<&Path>, look: Look) -> String {
    let mut columns = Columns::new(&[
        "#", "passes", "type", ">angle", ">size", "order", ">ground", ">driver", ">coupler",
        ">driven", ">arm",
    ]);
    let mut shown = 0;
    for (name, _, mechanism) in sheet.linkages().take(SHOWN) {
        let a = &mechanism.assessment;
        let (driver, other) = (a.driver.index(), a.driver.other().index());
        let l = &a.lengths;
        let length = |x: f64| real(x, FIGURES);
        columns.row(vec![
            name,
            a.grade.name().into(),
            a.kind().into(),
            format!("{:.1}", a.drive().transmission_degrees),
            real(a.size, 3),
            order(a.drive()),
            length(l.ground),
            length(l.sides[driver]),
            length(l.coupler),
            length(l.sides[other]),
            length(l.arms[driver]),
        ]);
        shown += 1;
    }
    let mut text = columns.render(look);
    let more = sheet.linkages().count() - shown;
    let note = "angle: least transmission angle in degrees; size: of all, in extents of the points; \
                cognates a, b, c draw one curve";
    let rest = match (more, files) {
        (0, _) => String::new(),
        (n, None) => format!("{} more; --output DIR writes all of them", count(n as u64)),
        (n, Some(folder)) => format!("{} more; all in {}", count(n as u64), folder.display()),
    };
    for line in [rest.as_str(), note] {
        for line in wrapped(line, look.width - 2) {
            let _ = writeln!(text, "  {}", look.dim(&line));
        }
    }
    text
}
