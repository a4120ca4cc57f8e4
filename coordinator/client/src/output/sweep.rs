//! A family at many values of its parameters, for people and for programs: counts at each target, and where the number of
//! real solutions changes.

use super::beside_rows::{Remarks, named_targets};
use super::text::{Columns, Look, complex, count, counted, seconds, wrapped};
use crate::selection::View;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::selection::SelectedCounts;
use cognate_solutions::summary::SolutionCounts;
use cognate_summary::about::TimeBlock;
use cognate_summary::solve::{ProblemBlock, Summary, TargetBlock};
use num_complex::Complex64;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Parameters whose values the table shows.
const PARAMETERS_SHOWN: usize = 4;
/// Rows of a table that goes to no terminal.
const ROWS_SHOWN: usize = 1000;
/// Lines of a terminal that are left for the text around the rows.
const LINES_AROUND: usize = 10;

/// Where the solutions come from that are followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum FamilySource {
    /// From a solve at general values.
    #[serde(rename = "solved")]
    Solved,
    /// From the cache folder.
    #[serde(rename = "cache")]
    Cache,
    /// The user has given them.
    #[serde(rename = "given")]
    Given,
    /// Loops through the values of the parameters have found them.
    #[serde(rename = "monodromy")]
    Loops,
    /// None are followed.
    #[default]
    #[serde(rename = "each target by itself")]
    EachTarget,
}

/// The family at general values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Family {
    /// Number of its solutions; `None` where it was not solved.
    pub solutions: Option<u64>,
    /// Where the solutions come from.
    pub source: FamilySource,
    /// Whether these are all solutions.
    pub settled: bool,
    /// Why they cannot be followed, or are not known to be all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The answer at one target.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The solutions, counted.
    pub solutions: SolutionCounts,
    /// The solutions that are selected, where conditions were asked.
    pub selected: Option<SelectedCounts>,
    /// Whether every path is accounted for and every count is settled.
    pub settled: bool,
    /// Whether the target was solved by itself.
    pub by_itself: bool,
}

impl Row {
    /// A target that was refused for this reason.
    pub fn unanswered(reason: &str) -> Self {
        Self {
            solutions: SolutionCounts {
                complete_reason: Some(reason.to_owned()),
                ..SolutionCounts::default()
            },
            selected: None,
            settled: false,
            by_itself: true,
        }
    }

    /// Adds the counts of the selected solutions, which are settled where none is undecided.
    pub fn select(&mut self, selected: Option<SelectedCounts>) {
        self.settled &= selected.as_ref().is_none_or(|counts| counts.undecided == 0);
        self.selected = selected;
    }

    /// Whether there is a set of solutions beside those that are counted.
    fn has_set(&self) -> bool {
        self.solutions.positive_dimensional == Some(true)
    }

    /// The number of real solutions, or of those that are selected; `None` where it is not known.
    fn counted(&self) -> Option<u64> {
        match &self.selected {
            Some(selected) if selected.on_border + selected.undecided > 0 => None,
            Some(selected) => Some(selected.count),
            None => self.solutions.real,
        }
    }
}

/// The family at all targets.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Name of the problem.
    pub name: String,
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// The conditions by which solutions are selected, where there are some.
    pub condition: Option<String>,
    /// The problem, as its first job has it.
    pub problem: Option<ProblemBlock>,
    /// The family at general values.
    pub family: Family,
    /// Values of the parameters at each target.
    pub targets: Vec<Vec<Complex64>>,
    /// The answers, in the order of the targets.
    pub rows: Vec<Row>,
    /// Whether every row is settled.
    pub settled: bool,
    /// Time of all jobs.
    pub time: TimeBlock,
    /// Paths of all jobs.
    pub paths: u64,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl Sweep {
    /// A sweep without answers.
    pub fn new(name: &str, parameters: Vec<String>, warnings: Vec<String>) -> Self {
        Self {
            name: name.to_owned(),
            parameters,
            condition: None,
            problem: None,
            family: Family::default(),
            targets: Vec::new(),
            rows: Vec::new(),
            settled: false,
            time: TimeBlock::new(0, 0, 0),
            paths: 0,
            warnings,
        }
    }

    /// The targets of one job, whose paths begin at solutions that are given or that loops have found. `selected` holds the
    /// counts of the selected solutions of each target, where conditions were asked.
    pub fn of_job(summary: &Summary, view: &View, selected: Vec<SelectedCounts>) -> Self {
        let blocks = &summary.targets;
        let counts = &summary.solutions;
        let settled = counts.complete == Completeness::Yes;
        let (source, solutions) = match &summary.monodromy {
            Some(block) => (FamilySource::Loops, Some(block.loops.solutions)),
            None => {
                let paths = blocks.first().map(|block| block.paths.total);
                (FamilySource::Given, paths)
            }
        };
        let mut selected = selected.into_iter();
        let row = |block: &TargetBlock| {
            let mut row = Row {
                solutions: block.solutions.clone(),
                selected: None,
                settled: block.settled,
                by_itself: false,
            };
            row.select(selected.next());
            row
        };
        let parameters = view.parameter_names().to_vec();
        let mut sweep = Self {
            condition: view.condition(),
            family: Family {
                solutions,
                source,
                settled,
                reason: counts.complete_reason.clone().filter(|_| !settled),
            },
            rows: blocks.iter().map(row).collect(),
            ..Self::new(
                &summary.problem.name,
                parameters,
                once_each(&summary.warnings),
            )
        };
        // Values are at hand where this program has submitted the job.
        let values = match view.parameter_names() {
            [] => vec![Vec::new(); blocks.len()],
            _ => view.targets().to_vec(),
        };
        sweep.finish(&values, summary.time.wall_seconds);
        sweep
    }

    /// The summary of the one job that has all targets, with the family and the fields of each target.
    pub fn added_to(&self, summary: &str) -> String {
        let Ok(mut value) = serde_json::from_str::<Value>(summary) else {
            return summary.to_owned();
        };
        self.add_to(&mut value);
        format!("{value:#}\n")
    }

    fn add_to(&self, summary: &mut Value) {
        summary["family"] = json!(self.family);
        let lines = json!(TargetLines(self));
        let lines = lines.as_array().into_iter().flatten();
        let blocks = summary["targets"].as_array_mut().into_iter().flatten();
        for (block, line) in blocks.zip(lines) {
            if let (Some(block), Some(line)) = (block.as_object_mut(), line.as_object()) {
                block.extend(line.clone());
            }
        }
    }

    /// Adds what a job of targets took; the first one has the problem.
    pub fn add_job(&mut self, summary: &Summary) {
        self.problem.get_or_insert_with(|| summary.problem.clone());
        self.add_time(&summary.time, summary.paths.total);
    }

    /// Adds what a job took.
    pub fn add_time(&mut self, time: &TimeBlock, paths: u64) {
        self.time.cpu_seconds += time.cpu_seconds;
        self.time.tracking_cpu_seconds += time.tracking_cpu_seconds;
        self.paths += paths;
    }

    /// Closes the sweep, which took `wall_seconds` seconds.
    pub fn finish(&mut self, targets: &[Vec<Complex64>], wall_seconds: f64) {
        self.targets = targets.to_vec();
        self.settled = self.rows.len() == targets.len() && self.rows.iter().all(|row| row.settled);
        self.time.wall_seconds = wall_seconds;
        self.time.paths_per_second = self.paths as f64 / wall_seconds.max(0.001);
    }

    /// Whether the number of real solutions, or of those that are selected, is another than at the target before; not where
    /// one of them is not known.
    fn changes(&self, index: usize) -> bool {
        let counted = |index: usize| self.rows.get(index).and_then(Row::counted);
        let before = index.checked_sub(1).and_then(counted);
        before
            .zip(counted(index))
            .is_some_and(|(before, here)| before != here)
    }

    /// Kind of solutions whose number is compared from target to target.
    fn counted_kind(&self) -> &'static str {
        match self.condition {
            Some(_) => "selected",
            None => "real",
        }
    }

    /// Lines for standard error beside rows of solutions.
    pub fn beside_rows(&self, look: Look) -> Remarks {
        let mut remarks = Remarks::new(look);
        let rows = self.rows.iter().enumerate();
        let unsettled = rows.clone().filter(|(_, row)| !row.settled);
        let unsettled: Vec<usize> = unsettled.map(|(index, _)| index).collect();
        if !unsettled.is_empty() {
            remarks.not_settled(&named_targets(&unsettled));
        }
        let with_sets = rows.filter(|(_, row)| row.has_set());
        remarks.sets_at_targets(with_sets.map(|(index, _)| index));
        let mut removed: BTreeMap<&str, u64> = BTreeMap::new();
        for (name, n) in self.rows.iter().flat_map(|row| &row.solutions.removed) {
            *removed.entry(name).or_default() += n;
        }
        remarks.removed(removed.into_iter());
        let selected = self.rows.iter().filter_map(|row| row.selected.as_ref());
        remarks.undecided(selected.map(|selected| selected.undecided).sum());
        for warning in &self.warnings {
            remarks.warning(warning);
        }
        remarks
    }

    /// The rows as CSV, with a header.
    pub fn csv(&self) -> impl Iterator<Item = String> {
        let mut header: Vec<String> = self.parameters.iter().map(|name| quoted(name)).collect();
        let counts = [
            "distinct",
            "nonsingular",
            "singular",
            "real",
            "selected",
            "settled",
        ];
        header.extend(counts.map(str::to_owned));
        let rows = self.targets.iter().zip(&self.rows).map(|(values, row)| {
            let solutions = &row.solutions;
            let mut cells: Vec<String> = values.iter().map(|z| exact(*z)).collect();
            cells.extend([
                solutions.distinct.to_string(),
                solutions.nonsingular.to_string(),
                solutions.singular.to_string(),
                solutions
                    .real
                    .map_or(String::new(), |real| real.to_string()),
                row.selected
                    .as_ref()
                    .map_or(String::new(), |selected| selected.count.to_string()),
                row.settled.to_string(),
            ]);
            cells
        });
        std::iter::once(header)
            .chain(rows)
            .map(|cells| format!("{}\n", cells.join(",")))
    }

    /// The table; `files` is the folder with all rows and solutions.
    pub fn table(&self, files: Option<&Path>, look: Look) -> String {
        let mut text = self.headline(look);
        let mut headings = vec![">#"];
        let shown = self.parameters.len().min(PARAMETERS_SHOWN);
        headings.extend(self.parameters[..shown].iter().map(String::as_str));
        headings.extend([">solutions", ">real", ">singular"]);
        headings.extend(self.condition.as_ref().map(|_| ">selected"));
        headings.push("");
        let mut columns = Columns::new(&headings);
        let rows = self.rows_shown(room());
        for &index in &rows {
            columns.row(self.cells(index, shown));
        }
        text.push_str(&columns.render(look));
        let left_out = self.rows.len() - rows.len();
        let mut notes = Vec::new();
        if left_out > 0 {
            notes.push(format!(
                "{} left out; shown are the first ones and those where the number of {} solutions changes",
                counted(left_out as u64, "row"),
                self.counted_kind()
            ));
        }
        notes.push(match files {
            Some(folder) => format!("all rows and solutions are in {}", folder.display()),
            None => "--output DIR writes all rows and solutions".to_owned(),
        });
        for line in wrapped(&notes.join("; "), look.width - 2) {
            let _ = writeln!(text, "  {}", look.dim(&line));
        }
        text
    }

    /// The lines above the rows.
    fn headline(&self, look: Look) -> String {
        let changes = (0..self.rows.len()).filter(|k| self.changes(*k)).count() as u64;
        let unsettled = self.rows.iter().filter(|row| !row.settled).count() as u64;
        let targets = counted(self.rows.len() as u64, "target");
        let mut answer = match self.rows.iter().any(|row| row.counted().is_some()) {
            true => format!(
                "{targets}; the number of {} solutions changes {}",
                self.counted_kind(),
                counted(changes, "time")
            ),
            false => targets,
        };
        if unsettled > 0 {
            let _ = write!(answer, "; {} not settled", counted(unsettled, "target"));
        }
        let answer = match self.settled {
            true => look.good(&answer),
            false => look.warn(&answer),
        };
        let lone = self.rows.iter().filter(|row| row.by_itself).count() as u64;
        let solutions = counted(self.family.solutions.unwrap_or(0), "solution");
        let because = match &self.family.reason {
            Some(reason) => format!(": {reason}"),
            None => String::new(),
        };
        let mut source = match (self.family.source, &self.family.reason) {
            (FamilySource::Given, _) => {
                let starts = counted(self.family.solutions.unwrap_or(0), "start solution");
                format!("{starts}, followed to each target{because}")
            }
            (FamilySource::Loops, _) => {
                format!("{solutions} by loops at general values, followed to each target{because}")
            }
            (FamilySource::EachTarget, Some(reason)) => {
                format!("each target by itself: {reason}")
            }
            (FamilySource::Cache, _) => {
                format!("{solutions} at general values (from the cache), followed to each target")
            }
            _ => format!("{solutions} at general values, followed to each target"),
        };
        if lone > 0 && self.family.settled {
            let _ = write!(source, "; {} solved by themselves", counted(lone, "target"));
        }
        let _ = write!(source, "; {}", seconds(self.time.wall_seconds));
        let mut text = format!("{}: {answer}\n", look.bold(&self.name));
        for line in wrapped(&source, look.width) {
            let _ = writeln!(text, "{}", look.dim(&line));
        }
        if let Some(condition) = &self.condition {
            for line in wrapped(&format!("selected: {condition}"), look.width) {
                let _ = writeln!(text, "{}", look.dim(&line));
            }
        }
        for warning in &self.warnings {
            for line in wrapped(&format!("warning: {warning}"), look.width) {
                let _ = writeln!(text, "{}", look.warn(&line));
            }
        }
        text.push('\n');
        text
    }

    /// The cells of a row.
    fn cells(&self, index: usize, shown: usize) -> Vec<String> {
        let row = &self.rows[index];
        let values = self.targets.get(index).map_or(&[][..], Vec::as_slice);
        let mut cells = vec![count(index as u64)];
        let values = values.iter().take(shown);
        cells.extend(values.map(|&z| complex(z, 6, 1e-12)));
        let solutions = &row.solutions;
        cells.push(count(solutions.distinct));
        cells.push(solutions.real.map_or("-".to_owned(), count));
        cells.push(count(solutions.singular));
        let mut words = Vec::new();
        if let Some(selected) = &row.selected {
            cells.push(count(selected.count));
            if selected.on_border > 0 {
                words.push(format!("{} on the border", count(selected.on_border)));
            }
            if selected.undecided > 0 {
                words.push(format!("{} not decided", count(selected.undecided)));
            }
        } else if self.condition.is_some() {
            cells.push("-".to_owned());
        }
        if !row.settled {
            words.push("not settled".to_owned());
        }
        if self.changes(index) {
            words.push("changes".to_owned());
        }
        if row.by_itself && self.family.settled {
            words.push("by itself".to_owned());
        }
        if row.has_set() {
            words.push("and a positive-dimensional set".to_owned());
        }
        cells.push(words.join(", "));
        cells
    }

    /// Indices of at most `most` rows: rows where the number of real solutions changes, and the first ones.
    fn rows_shown(&self, most: usize) -> Vec<usize> {
        let count = self.rows.len();
        if count <= most {
            return (0..count).collect();
        }
        // Half of the rows at least are for changes, where there are as many.
        let changes: Vec<usize> = (0..count).filter(|k| self.changes(*k)).collect();
        let kept = changes.len().min(most - most / 4);
        let mut rows = changes[..kept].to_vec();
        let firsts = (0..count).filter(|k| rows.binary_search(k).is_err());
        let firsts: Vec<usize> = firsts.take(most - kept).collect();
        rows.extend(firsts);
        rows.sort_unstable();
        rows
    }
}

/// How many rows a table shows.
fn room() -> usize {
    let lines = console::Term::stdout().size_checked();
    lines.map_or(ROWS_SHOWN, |(lines, _)| {
        usize::from(lines).saturating_sub(LINES_AROUND).max(10)
    })
}

/// A value with all its digits, as targets are read.
fn exact(z: Complex64) -> String {
    match z.im == 0.0 {
        true => z.re.to_string(),
        false if z.im < 0.0 => format!("{}-{}*I", z.re, -z.im),
        false => format!("{}+{}*I", z.re, z.im),
    }
}

/// A name as a cell of CSV.
fn quoted(name: &str) -> String {
    match name.contains([',', '"']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}

/// A target in JSON.
#[derive(Serialize)]
struct TargetLine<'a> {
    #[serde(serialize_with = "by_name", skip_serializing_if = "is_without_names")]
    parameters: (&'a [String], &'a [Complex64]),
    solutions: &'a SolutionCounts,
    selected: Option<&'a SelectedCounts>,
    changes: bool,
    settled: bool,
    by_itself: bool,
}

/// Whether the names of the parameters are not at hand.
fn is_without_names((names, _): &(&[String], &[Complex64])) -> bool {
    names.is_empty()
}

/// Values by name, each as `[re, im]`.
fn by_name<S: Serializer>(
    (names, values): &(&[String], &[Complex64]),
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(names.iter().zip(values.iter().map(|z| [z.re, z.im])))
}

/// The answer in JSON.
#[derive(Serialize)]
struct Whole<'a> {
    problem: Option<&'a ProblemBlock>,
    family: &'a Family,
    targets: TargetLines<'a>,
    settled: bool,
    time: &'a TimeBlock,
    warnings: &'a [String],
}

/// Warnings of which some stand for several targets: each text once, with the number of its targets.
fn once_each(warnings: &[String]) -> Vec<String> {
    let mut texts: Vec<(&str, Vec<&str>)> = Vec::new();
    for warning in warnings {
        let of_target = warning
            .strip_prefix("target ")
            .and_then(|rest| rest.split_once(": "));
        let (target, text) = of_target.unwrap_or(("", warning));
        match texts.iter_mut().find(|(other, _)| *other == text) {
            Some((_, targets)) => targets.push(target),
            None => texts.push((text, vec![target])),
        }
    }
    let words = |(text, targets): (&str, Vec<&str>)| match targets[..] {
        [""] => text.to_owned(),
        [target] => format!("target {target}: {text}"),
        _ => format!("{}: {text}", counted(targets.len() as u64, "target")),
    };
    texts.into_iter().map(words).collect()
}

/// The targets of a sweep in JSON.
struct TargetLines<'a>(&'a Sweep);

impl Serialize for TargetLines<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let sweep = self.0;
        let rows = sweep.targets.iter().zip(&sweep.rows).enumerate();
        serializer.collect_seq(rows.map(|(index, (values, row))| TargetLine {
            parameters: (&sweep.parameters, values),
            solutions: &row.solutions,
            selected: row.selected.as_ref(),
            changes: sweep.changes(index),
            settled: row.settled,
            by_itself: row.by_itself,
        }))
    }
}

impl Serialize for Sweep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let whole = Whole {
            problem: self.problem.as_ref(),
            family: &self.family,
            targets: TargetLines(self),
            settled: self.settled,
            time: &self.time,
            warnings: &self.warnings,
        };
        whole.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sweep whose targets have these numbers of real solutions.
    fn sweep(real: &[Option<u64>]) -> Sweep {
        let mut sweep = Sweep::new("f", vec!["p".to_owned(), "x[1,2]".to_owned()], vec![]);
        sweep.rows = real
            .iter()
            .map(|real| Row {
                solutions: SolutionCounts {
                    distinct: 4,
                    nonsingular: 4,
                    real: *real,
                    ..SolutionCounts::default()
                },
                selected: None,
                settled: true,
                by_itself: false,
            })
            .collect();
        let values =
            (0..real.len()).map(|k| vec![Complex64::new(k as f64, 0.0), Complex64::new(0.5, -1.0)]);
        let values: Vec<Vec<Complex64>> = values.collect();
        sweep.finish(&values, 2.0);
        sweep
    }

    #[test]
    fn json_and_csv_are_as_agreed() {
        let sweep = sweep(&[Some(2), Some(4), None, Some(2)]);
        let json = serde_json::to_value(&sweep).expect("names and numbers");
        let text = json["targets"][1]["parameters"].to_string();
        assert_eq!(text, r#"{"p":[1.0,0.0],"x[1,2]":[0.5,-1.0]}"#);
        let changes: Vec<bool> = (0..4)
            .map(|k| json["targets"][k]["changes"] == true)
            .collect();
        assert_eq!(changes, [false, true, false, false]);
        assert_eq!(json["targets"][0]["solutions"]["distinct"], 4);
        assert!(json["targets"][0]["selected"].is_null());
        assert_eq!(
            (&json["settled"], &json["family"]["settled"]),
            (&true.into(), &false.into())
        );
        let lines: Vec<String> = sweep.csv().collect();
        assert_eq!(
            lines[0],
            "p,\"x[1,2]\",distinct,nonsingular,singular,real,selected,settled\n"
        );
        assert_eq!(lines[2], "1,0.5-1*I,4,4,0,4,,true\n");
        assert_eq!(lines[3], "2,0.5-1*I,4,4,0,,,true\n");
    }

    /// The summary of a job with given start solutions named no values at its targets (2026-11-30).
    #[test]
    fn a_warning_of_several_targets_stands_once() {
        let warnings = [
            "target 0: loops end",
            "alone",
            "target 1: loops end",
            "target 2: other",
        ];
        let once = once_each(&warnings.map(str::to_owned));
        assert_eq!(once, ["2 targets: loops end", "alone", "target 2: other"]);
    }

    #[test]
    fn the_summary_of_one_job_gets_the_fields_of_a_sweep() {
        let mut summary = json!({"targets": [{"paths": 4}, {"paths": 5}], "settled": true});
        let mut sweep = sweep(&[Some(2), Some(4)]);
        sweep.add_to(&mut summary);
        assert_eq!(summary["family"]["source"], "each target by itself");
        let target = &summary["targets"][1];
        assert_eq!(
            (&target["paths"], &target["solutions"]["real"]),
            (&json!(5), &json!(4))
        );
        assert_eq!(
            (&target["changes"], &target["settled"]),
            (&json!(true), &json!(true))
        );
        assert_eq!(target["parameters"]["p"], json!([1.0, 0.0]));
        assert!(target["selected"].is_null());
        sweep.parameters.clear();
        let mut summary = json!({"targets": [{}, {}]});
        sweep.add_to(&mut summary);
        assert!(summary["targets"][1].get("parameters").is_none());
    }

    #[test]
    fn rows_that_do_not_fit_are_left_out_but_for_changes() {
        let mut real = vec![Some(2); 100];
        real[70] = Some(4);
        let sweep = sweep(&real);
        assert_eq!(sweep.rows_shown(5), [0, 1, 2, 70, 71]);
        assert_eq!(sweep.rows_shown(100).len(), 100);
        let look = Look {
            width: 100,
            color: false,
        };
        let table = sweep.table(None, look);
        assert!(
            table.contains("100 targets; the number of real solutions changes 2 times"),
            "{table}"
        );
    }
}
