//! Beside rows: lines on standard error for everything that rows of CSV and lines of JSON cannot say.

use super::decomposition;
use super::listed::WantedCounts;
use super::table::DECOMPOSE;
use super::text::{Look, count, counted, wrapped};
use cognate_solutions::completeness::Completeness;
use cognate_summary::decomposition::DecompositionSummary;
use cognate_summary::question::QuestionSummary;
use cognate_summary::question_answer::QuestionAnswer;
use cognate_summary::solve::Summary;
use std::fmt::Write as _;

/// Targets that a line names before it says how many more there are.
const TARGETS_NAMED: usize = 10;

/// Lines, each with a word before it that says of which kind it is.
pub struct Remarks {
    text: String,
    look: Look,
}

impl Remarks {
    /// No lines yet.
    pub fn new(look: Look) -> Self {
        Self {
            text: String::new(),
            look,
        }
    }

    /// Writes the lines to standard error.
    pub fn print(&self) {
        eprint!("{}", self.text);
    }

    /// The lines.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A part of the answer that has no row.
    pub fn note(&mut self, said: &str) {
        self.line("note: ", said);
    }

    /// A doubt.
    pub fn not_settled(&mut self, said: &str) {
        self.line("not settled: ", said);
    }

    /// A warning.
    pub fn warning(&mut self, said: &str) {
        self.line("warning: ", said);
    }

    fn line(&mut self, lead: &str, said: &str) {
        let blank = " ".repeat(lead.len());
        for (i, line) in wrapped(said, self.look.width - lead.len())
            .iter()
            .enumerate()
        {
            let lead = if i == 0 { lead } else { &blank };
            let _ = writeln!(self.text, "{}{line}", self.look.warn(lead));
        }
    }

    /// Points that are no solutions, by reason.
    pub fn removed<'a>(&mut self, reasons: impl Iterator<Item = (&'a str, u64)>) {
        for (name, n) in reasons.filter(|(_, n)| *n > 0) {
            let points = counted(n, "point");
            self.note(&format!("{points} removed ({name}): no solutions"));
        }
    }

    /// Solutions at several targets of which it is not known whether they meet the condition.
    pub fn undecided(&mut self, solutions: u64) {
        if solutions > 0 {
            let solutions = counted(solutions, "solution");
            self.not_settled(&format!(
                "{solutions} of which it is not known whether they meet the condition"
            ));
        }
    }

    /// Sets of solutions at some of several targets.
    pub fn sets_at_targets(&mut self, targets: impl Iterator<Item = usize>) {
        let targets: Vec<usize> = targets.collect();
        if !targets.is_empty() {
            let named = named_targets(&targets);
            self.note(&format!(
                "and a positive-dimensional solution set at {named}: {DECOMPOSE} finds it"
            ));
        }
    }
}

/// The numbers of targets, the first of them only where they are many.
pub fn named_targets(targets: &[usize]) -> String {
    let numbers = targets.iter().take(TARGETS_NAMED).map(usize::to_string);
    let numbers = numbers.collect::<Vec<String>>().join(", ");
    let noun = if targets.len() == 1 {
        "target"
    } else {
        "targets"
    };
    match targets.len().saturating_sub(TARGETS_NAMED) {
        0 => format!("{noun} {numbers}"),
        more => format!("{noun} {numbers} and {} more", count(more as u64)),
    }
}

/// Lines beside the solutions of a system.
pub fn of_solve(summary: &Summary, wanted: &WantedCounts, look: Look) -> Remarks {
    let mut remarks = Remarks::new(look);
    for question in wanted.open_questions(summary) {
        remarks.not_settled(&question);
    }
    let s = &summary.solutions;
    if summary.targets.is_empty() && wanted.has_sets(summary) {
        let points = match s.distinct + s.undecided {
            0 => "no isolated solution, but",
            _ => "and also",
        };
        remarks.note(&format!(
            "{points} a positive-dimensional solution set: {DECOMPOSE} finds it"
        ));
    }
    let targets = summary.targets.iter().enumerate();
    let with_sets = targets.filter(|(_, t)| t.solutions.positive_dimensional == Some(true));
    remarks.sets_at_targets(with_sets.map(|(index, _)| index));
    let removed = s.removed.iter();
    remarks.removed(removed.map(|(name, n)| (name.as_str(), *n)));
    if let (Completeness::NotKnown, Some(reason)) = (s.complete, &s.complete_reason) {
        remarks.note(&format!("not known whether these are all: {reason}"));
    }
    if let Some(critical) = &wanted.critical
        && critical.extremes().next().is_none()
    {
        remarks.note(&format!("extreme value not known: {}", critical.reason));
    }
    for warning in &summary.warnings {
        remarks.warning(warning);
    }
    remarks
}

/// Lines beside components.
pub fn of_components(summary: &DecompositionSummary, look: Look) -> Remarks {
    let mut remarks = Remarks::new(look);
    let decomposition = &summary.decomposition;
    if decomposition.components.is_empty() {
        remarks.note(&decomposition::answer(summary));
    }
    for removed in decomposition::removed(summary) {
        remarks.note(&removed);
    }
    for doubt in &decomposition.unsettled {
        remarks.not_settled(doubt);
    }
    for warning in &summary.warnings {
        remarks.warning(warning);
    }
    remarks
}

/// Lines beside the answer to a question about components.
pub fn of_question(summary: &QuestionSummary, look: Look) -> Remarks {
    let mut remarks = Remarks::new(look);
    match &summary.answer {
        QuestionAnswer::RealPoints(answer) => {
            for component in answer.components.iter().filter(|c| c.points == 0) {
                let id = &component.id;
                remarks.note(&match component.has_real_points {
                    Some(_) => format!("component {id} has no real points"),
                    None => format!("component {id}: not known whether it has real points"),
                });
            }
        }
        QuestionAnswer::Sample(answer) => {
            for component in answer.components.iter().filter(|c| c.count < c.wanted) {
                let (id, number) = (&component.id, component.count);
                let wanted = counted(component.wanted, "point");
                remarks.note(&format!("component {id}: {number} of {wanted}"));
            }
        }
        _ => {}
    }
    for doubt in &summary.unsettled {
        remarks.not_settled(doubt);
    }
    for warning in &summary.warnings {
        remarks.warning(warning);
    }
    remarks
}
