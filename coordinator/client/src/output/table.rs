//! The answer for people: paths by verdict that add up, solutions, time, workers, warnings.

use super::listed::{Listed, WantedCounts};
use super::solution_list::solution_list;
use super::text::{Look, count, counted, rate, real, seconds, wrapped};
use cognate_algorithms::monodromy::counts::{LoopCounts, Stop};
use cognate_algorithms::monodromy::estimate::percent;
use cognate_solutions::approximate::ApproximatePoint;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::critical::CriticalCounts;
use cognate_solutions::selection::SelectedCounts;
use cognate_solutions::solution::NamedValue;
use cognate_solutions::summary::PathCounts;
use cognate_summary::solve::Summary;
use std::fmt::Write as _;
use std::path::Path;

/// Workers named in a table; `--format json` names all.
const WORKERS_SHOWN: usize = 8;

/// Points of least residual in a table.
const APPROXIMATE_SHOWN: usize = 20;

/// Significant figures of a point of least residual in a table.
const FIGURES: usize = 8;

/// Width of the column of names.
const LABEL: usize = 22;

/// The command that answers what sets of solutions there are.
pub(super) const DECOMPOSE: &str = "`cognate decompose FILE`";

/// Lines of a name, a number, and the meaning of the number.
pub(super) struct Lines {
    text: String,
    look: Look,
    number: usize,
}

impl Lines {
    /// An empty table whose numbers have this width.
    pub(super) fn new(look: Look, number: usize) -> Self {
        Self {
            text: String::new(),
            look,
            number,
        }
    }

    /// All lines.
    pub(super) fn finish(self) -> String {
        self.text
    }

    /// Lines that are made already.
    pub(super) fn raw(&mut self, text: &str) {
        self.text.push_str(text);
    }

    pub(super) fn heading(&mut self, title: &str, number: &str, note: &str) {
        let cell = format!("{number:>width$}", width = self.number);
        let title = self.look.bold(&format!("{title:<LABEL$}"));
        let line = format!("  {title}{}", self.look.bold(&cell));
        self.with_note(line, note);
    }

    pub(super) fn line(&mut self, name: &str, number: &str, note: &str) {
        let cell = format!("{number:>width$}", width = self.number);
        let line = format!("    {name:<width$}{cell}", width = LABEL - 2);
        self.with_note(line, note);
    }

    /// The note starts in its own column, and goes on below itself.
    fn with_note(&mut self, line: String, note: &str) {
        let column = 2 + LABEL + self.number + 2;
        let room = self.look.width.saturating_sub(column).max(20);
        let notes = wrapped(note, room);
        match notes.split_first() {
            None => {
                let _ = writeln!(self.text, "{}", line.trim_end());
            }
            Some((first, rest)) => {
                let _ = writeln!(self.text, "{line}  {}", self.look.dim(first));
                for more in rest {
                    let _ = writeln!(self.text, "{}{}", " ".repeat(column), self.look.dim(more));
                }
            }
        }
    }

    pub(super) fn blank(&mut self) {
        self.text.push('\n');
    }
}

/// The whole table; `solutions` are those that are listed, `files` is the folder with all of them.
pub fn summary(
    summary: &Summary,
    solutions: &[Listed],
    wanted: &WantedCounts,
    files: Option<&Path>,
    look: Look,
) -> String {
    let paths = &summary.paths;
    let mut lines = Lines {
        text: String::new(),
        look,
        number: (count(paths.total).len() + 1).max(6),
    };
    lines.text.push_str(&headline(summary, wanted, look));
    lines.blank();
    paths_block(&mut lines, summary);
    lines.blank();
    solutions_block(&mut lines, summary, wanted.has_sets(summary));
    if let Some(selected) = &wanted.selected {
        selected_lines(&mut lines, selected);
    }
    if let Some(points) = &summary.approximate {
        lines.blank();
        approximate_block(&mut lines, points, summary.approximate_reason.as_deref());
    }
    if let Some(critical) = &wanted.critical {
        lines.blank();
        critical_block(&mut lines, critical);
    }
    lines.blank();
    if let Some(block) = &summary.monodromy {
        loops_block(&mut lines, &block.loops);
        lines.blank();
    }
    time_block(&mut lines, summary);
    lines.text.push_str(&warnings(summary, look));
    if !solutions.is_empty() {
        lines.blank();
        let total = match &wanted.selected {
            Some(selected) => selected.count + selected.on_border + selected.undecided,
            None => summary.solutions.distinct + summary.solutions.undecided,
        };
        lines
            .text
            .push_str(&solution_list(solutions, total, files, look));
    }
    lines.text
}

/// The solutions that are selected.
fn selected_lines(lines: &mut Lines, selected: &SelectedCounts) {
    lines.line("selected", &count(selected.count), &selected.condition);
    if selected.on_border > 0 {
        let note = "meet the condition with equality, as far as their digits tell";
        lines.line("on the border", &count(selected.on_border), note);
    }
    if selected.undecided > 0 {
        let note = "of which it is not known whether they meet the condition";
        lines.line("not decided", &count(selected.undecided), note);
    }
}

/// The points of least residual, and why there are no others.
fn approximate_block(lines: &mut Lines, points: &[ApproximatePoint], reason: Option<&str>) {
    let title = "least residual near the excess ends: no solutions";
    lines.heading("Approximate points", &count(points.len() as u64), title);
    for (number, point) in (1..).zip(points.iter().take(APPROXIMATE_SHOWN)) {
        let coordinate = |v: &NamedValue| format!("{} = {}", v.name, real(v.value.re, FIGURES));
        let values: Vec<String> = point.variables.0.iter().map(coordinate).collect();
        let residual = real(point.residual, FIGURES);
        let paths = counted(point.paths.len() as u64, "path");
        let note = format!("residual {residual} at {} ({paths})", values.join(", "));
        lines.line(&number.to_string(), "", &note);
    }
    let more = points.len().saturating_sub(APPROXIMATE_SHOWN) as u64;
    if more > 0 {
        lines.line("more", &count(more), "`--format json` has all");
    }
    if let Some(reason) = reason {
        lines.line(
            if points.is_empty() {
                "none"
            } else {
                "incomplete"
            },
            "",
            reason,
        );
    }
}

/// The critical points of an objective.
fn critical_block(lines: &mut Lines, critical: &CriticalCounts) {
    lines.heading("Critical points", "", &critical.objective);
    lines.line("minima", &count(critical.minima), "strict local ones");
    lines.line("maxima", &count(critical.maxima), "strict local ones");
    lines.line("saddles", &count(critical.saddles), "");
    let note = "the second derivatives do not tell, or the equations are singular";
    lines.line("degenerate", &count(critical.degenerate), note);
    if let Some(outside) = critical.outside {
        let note = "real critical points that do not meet the conditions";
        lines.line("outside", &count(outside), note);
    }
    if let Some(points) = critical.with_sets_of_multipliers {
        let note = "of them, in no count of solutions: what holds with equality there has dependent gradients";
        lines.line("dependent", &count(points), note);
    }
    for (word, extreme) in critical.extremes() {
        let at = match extreme.points {
            0 => String::new(),
            points => format!(" at {}", counted(points, "point")),
        };
        let value = real(extreme.value, 12);
        let note = format!("{value}{at}: {}", critical.reason);
        lines.line(&format!("{word} value"), "", &note);
    }
    if critical.extremes().next().is_none() {
        lines.line(
            "extreme value",
            "",
            &format!("not known: {}", critical.reason),
        );
    }
}

/// One or two lines that answer the question.
fn headline(summary: &Summary, wanted: &WantedCounts, look: Look) -> String {
    let name = match summary.problem.name.as_str() {
        "" => summary.job.as_str(),
        name => name,
    };
    let open = wanted.open_questions(summary);
    let mut answer = answer(summary, wanted.has_sets(summary));
    for (word, extreme) in wanted.critical.iter().flat_map(CriticalCounts::extremes) {
        let _ = write!(answer, ", {word} value {}", real(extreme.value, 6));
    }
    if let Some(selected) = &wanted.selected {
        let _ = write!(answer, ", {} selected", count(selected.count));
        if selected.on_border > 0 {
            let _ = write!(answer, " and {} on the border", count(selected.on_border));
        }
    }
    let color = |line: &str| match (open.is_empty(), summary.paths.failed > 0) {
        (true, _) => look.good(line),
        (false, false) => look.warn(line),
        (false, true) => look.bad(line),
    };
    let mut text = format!("{}:", look.bold(name));
    if name.chars().count() + 2 + answer.chars().count() <= look.width {
        let _ = writeln!(text, " {}", color(&answer));
    } else {
        text.push('\n');
        for line in wrapped(&answer, look.width - 2) {
            let _ = writeln!(text, "  {}", color(&line));
        }
    }
    let p = &summary.problem;
    let what = format!(
        "{}, {}, {} start, seed {}",
        counted(p.variables, "variable"),
        counted(p.equations, "equation"),
        p.start,
        p.seed
    );
    for line in wrapped(&what, look.width) {
        let _ = writeln!(text, "{}", look.dim(&line));
    }
    for question in &open {
        for (i, line) in wrapped(question, look.width - 15).iter().enumerate() {
            let lead = if i == 0 {
                "not settled: "
            } else {
                "             "
            };
            let _ = writeln!(text, "{}{line}", look.warn(lead));
        }
    }
    text
}

/// The answer in one phrase; `also`: there is a positive-dimensional set as well.
pub fn answer(summary: &Summary, also: bool) -> String {
    let s = &summary.solutions;
    let mut answer = match s.singular {
        0 => counted(s.nonsingular, "solution"),
        n => format!("{}, {} singular", counted(s.distinct, "solution"), count(n)),
    };
    if also && s.distinct == 0 && s.undecided == 0 {
        return format!(
            "no isolated solution, but a positive-dimensional solution set: {DECOMPOSE} finds it"
        );
    }
    match s.real {
        Some(n) if n == s.distinct && n > 1 => answer.push_str(", all real"),
        Some(n) if s.distinct > 0 => {
            let _ = write!(answer, ", {} real", count(n));
        }
        _ => {}
    }
    if s.undecided > 0 {
        let points = counted(s.undecided, "singular point");
        let _ = write!(answer, ", and {points} that may not be isolated");
    }
    if also {
        answer.push_str(", and a positive-dimensional set");
    }
    answer
}

fn paths_block(lines: &mut Lines, summary: &Summary) {
    path_classes(lines, &summary.paths);
    further_path_counts(lines, summary);
}

/// The classes of paths and their sum, which is the number of paths.
fn path_classes(lines: &mut Lines, p: &PathCounts) {
    let undecided = "not decided; such paths are counted in the next class";
    let classes = [
        (
            "failed",
            Some(p.failed),
            "given up; `cognate explain` says why",
        ),
        ("at infinity", Some(p.at_infinity), "no solution there"),
        (
            "removed",
            Some(p.removed),
            "where a denominator is 0, or on a false branch: no solution there",
        ),
        ("excess", p.excess, "no solution before randomisation"),
        (
            "positive-dimensional",
            p.positive_dimensional,
            "on a curve, surface, ... of solutions",
        ),
        (
            "undecided",
            Some(p.undecided),
            "at a singular point; isolated or not is not known",
        ),
        (
            "within data accuracy",
            Some(p.within_data_accuracy),
            "other digits of the data would give another class",
        ),
        (
            "singular",
            Some(p.singular),
            "at an isolated multiple or otherwise singular point",
        ),
        (
            "finite",
            Some(p.finite),
            "at a nonsingular isolated solution",
        ),
    ];
    let shown_where_there_are_some = ["undecided", "within data accuracy", "removed"];
    lines.heading("Paths", "", "each in the first class that holds");
    for (name, number, meaning) in classes {
        match number {
            Some(0) if shown_where_there_are_some.contains(&name) => {}
            Some(0) => lines.line(name, "0", ""),
            Some(n) => lines.line(name, &count(n), meaning),
            None => lines.line(name, "-", undecided),
        }
    }
    let rule = "-".repeat(count(p.total).len().max(2));
    lines.line("", &rule, "");
    let sum: u64 = classes.iter().filter_map(|(_, n, _)| *n).sum();
    let note = if sum == p.total {
        String::new()
    } else {
        format!("the classes add up to {}: please report this", count(sum))
    };
    lines.line("total", &count(p.total), &note);
}

/// Counts of paths that are no classes: images, named sets, retracked paths, precision.
fn further_path_counts(lines: &mut Lines, summary: &Summary) {
    let p = &summary.paths;
    if p.images > 0 {
        let note = "not followed: images of others by the symmetry";
        lines.line("images", &count(p.images), note);
    }
    for (name, &n) in &p.degenerate {
        lines.line("on a named set", &count(n), name);
    }
    if p.retracked > 0 || p.crossings_found > 0 {
        let note = match p.crossings_found {
            0 => String::new(),
            crossings => format!(
                "{} found, {} resolved",
                counted(crossings, "path crossing"),
                count(p.crossings_resolved)
            ),
        };
        lines.line("tracked again", &count(p.retracked), &note);
    }
    if p.decided_by_precision_limit > 0 {
        let note = "verdicts that only the limit of precision gave";
        lines.line(
            "by precision limit",
            &count(p.decided_by_precision_limit),
            note,
        );
    }
    if p.decided_by_exact_count > 0 {
        let note = match summary.solutions.without_path {
            0 => "not followed to their ends: all solutions are known",
            _ => "counted as at infinity, though some may lead to solutions without path",
        };
        lines.line("by exact count", &count(p.decided_by_exact_count), note);
    }
    if p.by_precision.len() > 1 {
        let words: Vec<String> = p
            .by_precision
            .iter()
            .map(|(bits, n)| format!("{} with {bits} bits", count(*n)))
            .collect();
        lines.line("precision", "", &words.join(", "));
    }
}

fn solutions_block(lines: &mut Lines, summary: &Summary, has_sets: bool) {
    let s = &summary.solutions;
    lines.heading("Solutions", "", "isolated points, equal ones merged");
    lines.line("nonsingular", &count(s.nonsingular), "");
    lines.line("singular", &count(s.singular), "");
    let rule = "-".repeat(count(s.distinct).len().max(2));
    lines.line("", &rule, "");
    let note = if s.with_multiplicity == s.distinct {
        String::new()
    } else {
        format!("{} with multiplicity", count(s.with_multiplicity))
    };
    lines.line("distinct", &count(s.distinct), &note);
    if s.without_path > 0 {
        let note = "by the equations alone, exactly: no path was followed to them";
        lines.line("without path", &count(s.without_path), note);
    }
    if s.undecided > 0 {
        let note = "singular points, isolated or not: in no other count";
        lines.line("undecided", &count(s.undecided), note);
    }
    for (name, &n) in s.removed.iter().filter(|(_, n)| **n > 0) {
        let note = format!("{name}: no solutions, in no other count");
        lines.line("removed", &count(n), &note);
    }
    if s.complete != Completeness::Yes
        && let Some(reason) = &s.complete_reason
    {
        let note = format!("{}: {reason}", s.complete.name());
        lines.line("complete", "", &note);
    }
    match (s.real, &s.real_reason) {
        (Some(n), _) => lines.line("real", &count(n), ""),
        (None, reason) => lines.line("real", "-", reason.as_deref().unwrap_or("not asked")),
    }
    if let Some(n) = s.certified {
        let boxes = format!(
            "of {}: each alone in its box, no box meets another",
            count(s.nonsingular)
        );
        let note = match s.certified_real {
            Some(real) if n > 0 => format!("{boxes}; {} proved real", count(real)),
            _ => boxes,
        };
        lines.line("certified", &count(n), &note);
    }
    if let Some(sharpened) = &s.sharpened {
        let mut note = format!(
            "of {} brought to {} digits",
            count(s.distinct),
            sharpened.digits
        );
        if sharpened.by_deflation > 0 {
            note.push_str(&format!(", {} by deflation", count(sharpened.by_deflation)));
        }
        lines.line("sharpened", &count(sharpened.solutions), &note);
    }
    if has_sets {
        lines.line("and also", "", "a positive-dimensional solution set");
    }
    for (name, &n) in &s.degenerate {
        lines.line("degenerate", &count(n), name);
    }
    if let Some(n) = summary.classes.count {
        let note = summary
            .classes
            .group_order
            .map(|order| format!("of a group of {}", counted(order, "element")));
        lines.line("classes", &count(n), note.as_deref().unwrap_or(""));
    }
}

fn loops_block(lines: &mut Lines, loops: &LoopCounts) {
    lines.heading("Monodromy", "", "at generic parameters");
    let classes = match loops.group_order {
        0 | 1 => String::new(),
        order => {
            let noun = if loops.classes == 1 {
                "class"
            } else {
                "classes"
            };
            let group = counted(order, "element");
            format!(
                "in {} {noun} under a group of {group}",
                count(loops.classes)
            )
        }
    };
    lines.line("solutions", &count(loops.solutions), &classes);
    let idle = format!("the last {} without anything new", count(loops.idle_loops));
    lines.line("loops", &count(loops.loops), &idle);
    let crossings = match loops.crossings_found {
        0 => String::new(),
        crossing_count => format!(
            "{} seen, {} resolved",
            counted(crossing_count, "path crossing"),
            count(loops.crossings_resolved)
        ),
    };
    lines.line("paths for them", &count(loops.tracked), &crossings);
    if let Some(test) = &loops.trace_test {
        let off = test.deviation.map(|off| format!(", to {off:.0e}"));
        let off = off.unwrap_or_default();
        let said = match test.complete {
            true => format!("complete: the sum of so many points moves on a line{off}"),
            false => format!("not complete: the sum of so many points should move on a line{off}"),
        };
        lines.line("trace test", &count(test.points), &said);
    }
    if let (Some(Stop::Confidence), Some(estimate)) = (loops.stop, &loops.estimate) {
        let likeliest = estimate.likeliest.map_or("?".to_owned(), count);
        let sure = format!(
            "classes; no more with probability {}, if loops permute at random",
            percent(estimate.confidence)
        );
        lines.line("estimated", &likeliest, &sure);
    }
    if loops.lost > 0 {
        lines.line(
            "lost on loops",
            &count(loops.lost),
            "found again or not: see warnings",
        );
    }
}

fn time_block(lines: &mut Lines, summary: &Summary) {
    let t = &summary.time;
    let parts = [
        format!("{} of CPU", seconds(t.cpu_seconds)),
        format!("{} tracking", seconds(t.tracking_cpu_seconds)),
        format!("{} paths/s", rate(t.paths_per_second)),
    ];
    // Times are words, not counts: they may be wider than the column of numbers.
    let wall = seconds(t.wall_seconds);
    lines.heading("Time", &wall, &parts.join(", "));
    let mut workers: Vec<String> = summary
        .workers
        .iter()
        .take(WORKERS_SHOWN)
        .map(|w| format!("{} {} ({})", w.id, counted(w.paths, "path"), w.transport))
        .collect();
    let more = summary.workers.len().saturating_sub(WORKERS_SHOWN);
    if more > 0 {
        workers.push(format!("and {more} more"));
    }
    let number = count(summary.workers.len() as u64);
    lines.heading("Workers", &number, &workers.join(", "));
}

fn warnings(summary: &Summary, look: Look) -> String {
    let mut text = String::new();
    for warning in &summary.warnings {
        text.push('\n');
        for (i, line) in wrapped(warning, look.width.saturating_sub(9).max(20))
            .iter()
            .enumerate()
        {
            let lead = if i == 0 { "warning: " } else { "         " };
            let _ = writeln!(text, "{}{line}", look.warn(lead));
        }
    }
    text
}
