//! Listed: the solutions that are shown, one after the other, as rows of a table, lines of JSON or rows of CSV.

use super::summary::open_questions;
use super::text::counted;
use crate::arguments::AnswerFormat;
use crate::error::ClientError;
use crate::selection::{Presented, View};
use cognate_protocol::client_json::SolutionLine;
use cognate_solutions::critical::{CriticalCounts, CriticalPoint};
use cognate_solutions::selection::{SelectedCounts, Verdict};
use cognate_solutions::solution::Solution;
use cognate_summary::solve::Summary;
use num_complex::Complex64;
use std::io::{BufWriter, Write};

/// A solution that is shown.
#[derive(Clone, Debug)]
pub struct Listed {
    /// The solution.
    pub solution: Solution,
    /// Index of its target, where there are several.
    pub target: Option<u32>,
    /// Whether it meets the conditions; `None` without conditions.
    pub verdict: Option<Verdict>,
    /// Kind of critical point, if an objective was asked.
    pub critical: Option<CriticalPoint>,
}

impl Listed {
    /// Whether it meets the conditions with equality only: nothing without conditions, null where it is not known whether it
    /// meets them.
    fn on_border(&self) -> Option<Option<bool>> {
        let verdict = self.verdict?;
        Some((verdict != Verdict::Undecided).then_some(verdict == Verdict::OnBorder))
    }

    /// The line of solutions.jsonl, with its end.
    pub fn line(&self) -> String {
        let line = SolutionLine {
            solution: &self.solution,
            target: self.target,
            on_border: self.on_border(),
            critical: self.critical,
        };
        format!("{line}\n")
    }
}

/// Counts of the solutions that are wanted.
#[derive(Clone, Debug, Default)]
pub struct WantedCounts {
    /// The solutions that are selected, where conditions were asked.
    pub selected: Option<SelectedCounts>,
    /// The critical points, where an objective was asked.
    pub critical: Option<CriticalCounts>,
    /// Unknowns without multipliers of an objective.
    pub unknowns: usize,
}

impl WantedCounts {
    /// Number of points of which it is not known whether they meet the conditions.
    pub fn undecided(&self) -> u64 {
        self.selected.as_ref().map_or(0, |counts| counts.undecided)
    }

    /// Whether there is a positive-dimensional set of solutions, on which not only multipliers of an objective move.
    pub fn has_sets(&self, summary: &Summary) -> bool {
        let critical = self.critical.as_ref();
        let of_multipliers = critical.is_some_and(|critical| critical.sets_of_multipliers_only);
        summary.solutions.positive_dimensional == Some(true) && !of_multipliers
    }

    /// Doubts that keep the answer from being settled, in words: those of its counts and of the conditions.
    pub fn open_questions(&self, summary: &Summary) -> Vec<String> {
        let mut open = open_questions(summary);
        if self.undecided() > 0 {
            let points = counted(self.undecided(), "point");
            open.push(format!(
                "{points} of which it is not known whether they meet the condition"
            ));
        }
        open
    }
}

/// Selects and orders solutions, and hands on those that are shown.
pub struct Listing<'a> {
    view: &'a mut View,
    several: bool,
    selected: Option<SelectedCounts>,
    /// Solutions that wait for their turn, with the number by which they are sorted.
    waiting: Vec<(f64, Listed)>,
}

impl<'a> Listing<'a> {
    /// `several`: solutions at several targets come, and each says at which it is.
    pub fn new(view: &'a mut View, several: bool) -> Self {
        let selected = view.condition().map(SelectedCounts::of);
        Self {
            view,
            several,
            selected,
            waiting: Vec::new(),
        }
    }

    /// Whether every solution has to be seen: they are counted or sorted.
    pub fn selects(&self) -> bool {
        self.selected.is_some() || self.view.is_sorted()
    }

    /// Lists the critical points that no solution stands for, which the counts of the selection leave out; those that are to
    /// be shown now.
    pub fn single_critical_points(&mut self) -> Vec<Listed> {
        let points = self.view.single_critical_points().into_iter();
        let listed = points.filter_map(|point| {
            let presented = self.presented(point, 0);
            self.list(presented, 0)
        });
        listed.collect()
    }

    /// A solution at a target as it is shown.
    pub fn presented(&mut self, solution: Solution, target: u32) -> Presented {
        self.view.presented(solution, target)
    }

    /// Takes a solution at a target; the one that is to be shown now, if it is.
    pub fn take(&mut self, presented: Presented, target: u32) -> Option<Listed> {
        if let (Some(counts), Some(verdict)) = (&mut self.selected, presented.verdict) {
            counts.add(verdict);
        }
        self.list(presented, target)
    }

    /// Lists a solution if it is selected; the one that is to be shown now.
    fn list(&mut self, presented: Presented, target: u32) -> Option<Listed> {
        let key = self
            .view
            .is_sorted()
            .then(|| self.view.key(&presented, target));
        let Presented {
            solution,
            critical,
            verdict,
        } = presented;
        if verdict == Some(Verdict::Rejected) {
            return None;
        }
        let listed = Listed {
            solution,
            target: self.several.then_some(target),
            verdict,
            critical,
        };
        match key {
            None => Some(listed),
            Some(key) => {
                self.waiting.push((key, listed));
                None
            }
        }
    }

    /// The solutions that waited, in their order, and the counts.
    pub fn finish(mut self) -> (Vec<Listed>, Option<SelectedCounts>) {
        // Equal keys keep the order in which they came.
        self.waiting
            .sort_by(|(a, one), (b, other)| one.target.cmp(&other.target).then(a.total_cmp(b)));
        let listed = self.waiting.into_iter().map(|(_, listed)| listed);
        (listed.collect(), self.selected)
    }
}

/// Rows of CSV on standard output.
pub struct CsvRows {
    out: csv::Writer<std::io::Stdout>,
    /// The columns besides those of the unknowns.
    columns: Columns,
    /// The parameters, where there are several targets.
    parameters: Option<ParameterColumns>,
    /// The unknowns, where their names are to be written still.
    head: Option<Vec<String>>,
}

/// Which columns the rows have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Columns {
    /// Every solution is real, and coordinates have a real part only.
    are_real: bool,
    on_border: bool,
    target: bool,
    critical: bool,
}

/// The parameters as columns.
struct ParameterColumns {
    names: Vec<String>,
    /// Values of the parameters at each target.
    values: Vec<Vec<Complex64>>,
    /// Whether each parameter is real at every target: then it has one column.
    are_real: Vec<bool>,
}

impl ParameterColumns {
    fn new(view: &View) -> Self {
        let names = view.parameter_names().to_vec();
        let values = view.targets().to_vec();
        let is_real = |place: usize| values.iter().all(|target| target[place].im == 0.0);
        Self {
            are_real: (0..names.len()).map(is_real).collect(),
            names,
            values,
        }
    }

    fn head(&self) -> Vec<String> {
        let names = self.names.iter().zip(&self.are_real);
        let columns = names.map(|(name, is_real)| heads(name, *is_real));
        columns.collect::<Vec<_>>().concat()
    }

    fn cells(&self, target: u32) -> Vec<String> {
        let values = self.values.get(target as usize);
        let values = values.map_or(&[][..], Vec::as_slice);
        let cells = |(z, is_real): (&Complex64, &bool)| {
            let count = if *is_real { 1 } else { 2 };
            [z.re, z.im].into_iter().take(count).map(plain_number)
        };
        values.iter().zip(&self.are_real).flat_map(cells).collect()
    }
}

/// The columns of a number: one where it is real, else one for each part.
fn heads(name: &str, is_real: bool) -> Vec<String> {
    match is_real {
        true => vec![name.to_owned()],
        false => ["re", "im"].map(|part| format!("{name}_{part}")).to_vec(),
    }
}

impl CsvRows {
    /// For the solutions of this answer that a view shows.
    pub fn of_answer(summary: &Summary, view: &View) -> Self {
        let counts = &summary.solutions;
        let are_real = counts.undecided == 0 && counts.real == Some(counts.distinct);
        Self::new(view, are_real, !summary.targets.is_empty())
    }

    /// For the solutions at the targets of a sweep, of which it is not known before whether they are real.
    pub fn of_sweep(view: &View) -> Self {
        Self::new(view, false, true)
    }

    fn new(view: &View, are_real: bool, several: bool) -> Self {
        let selects = view.condition().is_some();
        Self {
            out: csv::Writer::from_writer(std::io::stdout()),
            columns: Columns {
                are_real: selects || are_real,
                on_border: selects,
                target: several,
                critical: view.is_critical(),
            },
            parameters: several.then(|| ParameterColumns::new(view)),
            head: Some(view.unknowns().to_vec()),
        }
    }

    /// Writes the names of the columns, unless they are written.
    fn write_head(&mut self) -> csv::Result<()> {
        let Some(unknowns) = self.head.take() else {
            return Ok(());
        };
        let columns = self.columns;
        let mut names = Vec::new();
        for name in unknowns {
            names.extend(heads(&name, columns.are_real));
        }
        names.extend(["multiplicity", "real", "singular"].map(String::from));
        names.extend(columns.on_border.then(|| "on_border".into()));
        names.extend(columns.target.then(|| "target".into()));
        names.extend(self.parameters.iter().flat_map(ParameterColumns::head));
        if columns.critical {
            names.extend(["objective", "kind"].map(String::from));
        }
        self.out.write_record(&names)
    }

    /// Writes a row.
    pub fn row(&mut self, listed: &Listed) -> csv::Result<()> {
        let solution = &listed.solution;
        if let Some(unknowns) = &mut self.head {
            let names = solution.variables.0.iter();
            *unknowns = names.map(|variable| variable.name.clone()).collect();
        }
        self.write_head()?;
        let mut cells = Vec::new();
        for variable in &solution.variables.0 {
            let parts = match &variable.digits {
                Some(digits) => digits.clone(),
                None => [variable.value.re, variable.value.im].map(plain_number),
            };
            let count = if self.columns.are_real { 1 } else { 2 };
            cells.extend(parts.into_iter().take(count));
        }
        cells.push(solution.multiplicity.to_string());
        let real = solution.real.map(|real| real.to_string());
        cells.push(real.unwrap_or_default());
        cells.push(solution.singular.to_string());
        let on_border = listed.on_border();
        cells.extend(on_border.map(|is| is.map_or(String::new(), |is| is.to_string())));
        if let Some(target) = listed.target {
            cells.push(target.to_string());
            let parameters = self.parameters.as_ref();
            cells.extend(parameters.map_or_else(Vec::new, |columns| columns.cells(target)));
        }
        if let Some(CriticalPoint { objective, kind }) = listed.critical {
            cells.push(plain_number(objective));
            cells.push(kind.map_or(String::new(), |kind| kind.name().to_owned()));
        }
        self.out.write_record(&cells)
    }

    /// Writes what waits.
    pub fn finish(mut self) -> csv::Result<()> {
        self.write_head()?;
        Ok(self.out.flush()?)
    }
}

/// A double with as many digits as tell it from others, without an exponent where it is short.
fn plain_number(x: f64) -> String {
    format!("{x:?}")
}

/// Where the solutions that are shown go on standard output.
pub enum Rows {
    /// Nowhere: the answer is a table or one object.
    None,
    /// Lines of JSON.
    Lines(BufWriter<std::io::Stdout>),
    /// Rows of CSV.
    Csv(Box<CsvRows>),
}

impl Rows {
    /// In the format that was asked.
    pub fn of(format: AnswerFormat, csv: impl FnOnce() -> CsvRows) -> Self {
        match format {
            AnswerFormat::Table | AnswerFormat::Json => Self::None,
            AnswerFormat::Jsonl => Self::Lines(BufWriter::new(std::io::stdout())),
            AnswerFormat::Csv => Self::Csv(Box::new(csv())),
        }
    }

    /// Whether solutions go nowhere.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Writes one solution.
    pub fn row(&mut self, listed: &Listed) -> Result<(), ClientError> {
        super::unless_gone(match self {
            Self::None => Ok(()),
            Self::Lines(out) => out.write_all(listed.line().as_bytes()),
            Self::Csv(rows) => rows.row(listed).map_err(std::io::Error::from),
        })
    }

    /// Writes what waits.
    pub fn finish(self) -> Result<(), ClientError> {
        super::unless_gone(match self {
            Self::None => Ok(()),
            Self::Lines(mut out) => out.flush(),
            Self::Csv(rows) => rows.finish().map_err(std::io::Error::from),
        })
    }
}
