//! Solutions of a sweep that are shown: in the folder of --output and on standard output, in the order of the targets; and
//! how many of each target are selected.

use super::listed::{CsvRows, Listed, Listing, Rows};
use super::sweep::Sweep;
use super::sweep_folder::SweepFolder;
use crate::arguments::OutputArguments;
use crate::error::ClientError;
use crate::selection::View;
use cognate_solutions::selection::SelectedCounts;
use cognate_solutions::solution::Solution;
use std::collections::BTreeMap;

/// Everything that the solutions of a sweep are shown in.
pub struct SweepSolutions<'a> {
    view: &'a mut View,
    folder: Option<SweepFolder>,
    rows: Rows,
}

/// The solutions at one target that are shown, with their counts.
#[derive(Debug, Default)]
pub struct TargetSolutions {
    listed: Vec<Listed>,
    /// The solutions that are selected, where conditions were asked.
    pub selected: Option<SelectedCounts>,
}

impl<'a> SweepSolutions<'a> {
    /// For the view and the output that were asked.
    pub fn new(output: &OutputArguments, view: &'a mut View) -> Result<Self, ClientError> {
        let folder = output.output.as_deref().map(SweepFolder::create);
        Ok(Self {
            rows: Rows::of(output.format, || CsvRows::of_sweep(view)),
            folder: folder.transpose()?,
            view,
        })
    }

    /// Whether solutions have to be seen at all: they are written or counted.
    pub fn takes_any(&self) -> bool {
        self.folder.is_some() || !self.rows.is_none() || self.view.condition().is_some()
    }

    /// Solutions that are shown at the target of this index.
    pub fn at(&mut self, solutions: Vec<Solution>, index: usize) -> TargetSolutions {
        // The reader of targets allows no more than a million.
        let target = u32::try_from(index).unwrap_or(u32::MAX);
        let mut listing = Listing::new(self.view, true);
        let mut listed = Vec::new();
        for solution in solutions {
            let presented = listing.presented(solution, target);
            listed.extend(listing.take(presented, target));
        }
        let (sorted, selected) = listing.finish();
        listed.extend(sorted);
        TargetSolutions { listed, selected }
    }

    /// Writes the solutions at one target; those of targets before it are written.
    pub fn write(&mut self, solutions: &TargetSolutions) -> Result<(), ClientError> {
        for listed in &solutions.listed {
            if let Some(folder) = &mut self.folder {
                folder.line(listed)?;
            }
            self.rows.row(listed)?;
        }
        Ok(())
    }

    /// Completes all files.
    pub fn finish(self, sweep: &Sweep) -> Result<(), ClientError> {
        self.rows.finish()?;
        match self.folder {
            Some(folder) => folder.finish(sweep),
            None => Ok(()),
        }
    }
}

/// Solutions of a batch of targets on their way to where they are shown. Those of one job come in the order of the targets;
/// those of targets that were solved by themselves were put aside before.
pub struct BatchSolutions<'s, 'a> {
    shown: &'s mut SweepSolutions<'a>,
    aside: BTreeMap<usize, TargetSolutions>,
    /// The target of which solutions come.
    index: usize,
    waiting: Vec<Solution>,
    selected: Vec<Option<SelectedCounts>>,
}

impl<'s, 'a> BatchSolutions<'s, 'a> {
    /// From the first target of the batch on; `aside` are the solutions that take the place of those of the job.
    pub fn new(
        shown: &'s mut SweepSolutions<'a>,
        first: usize,
        aside: BTreeMap<usize, TargetSolutions>,
    ) -> Self {
        Self {
            shown,
            aside,
            index: first,
            waiting: Vec::new(),
            selected: Vec::new(),
        }
    }

    /// Takes a solution of the job at the target of this index.
    pub fn take(&mut self, solution: Solution, index: usize) -> Result<(), ClientError> {
        while self.index < index {
            self.close()?;
        }
        if !self.aside.contains_key(&index) {
            self.waiting.push(solution);
        }
        Ok(())
    }

    /// Writes the solutions at the target that they come of, and goes on to the next one.
    fn close(&mut self) -> Result<(), ClientError> {
        let waiting = std::mem::take(&mut self.waiting);
        let solutions = match self.aside.remove(&self.index) {
            Some(solutions) => solutions,
            None => self.shown.at(waiting, self.index),
        };
        self.shown.write(&solutions)?;
        self.selected.push(solutions.selected);
        self.index += 1;
        Ok(())
    }

    /// Writes the waiting solutions of the targets before index `end`; returns the counts of selected solutions of each
    /// target of the batch.
    pub fn finish(mut self, end: usize) -> Result<Vec<Option<SelectedCounts>>, ClientError> {
        while self.index < end {
            self.close()?;
        }
        Ok(self.selected)
    }
}
