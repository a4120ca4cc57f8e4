//! PreparedItems: what every kind of work makes of a stage, so that its items can be done.

use crate::item_result::ItemResult;
use std::fmt::Debug;
use std::ops::Range;

/// The items of a stage, each of which can be done at any time and in any company.
pub trait PreparedItems: Debug + Send + Sync {
    /// Number of items.
    fn items(&self) -> u64;

    /// Does these items, where it can `width` at a time; results in item order, the same at
    /// every width and in every split.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    fn run(&self, items: Range<u64>, width: usize) -> Vec<ItemResult>;

    /// Places of results that are not what their items give, or may not be.
    ///
    /// `results` are those of the items from `first` on, reported by a worker that is not believed. Empty for work whose
    /// results cannot be checked (`Work::has_checkable_results`).
    fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let _ = (first, results);
        Vec::new()
    }

    /// Places of results that differ from what the items give, by doing the items again: for work of which a check
    /// costs about as much.
    fn different(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let right = self.run(first..first + results.len() as u64, self.preferred_width());
        let places = 0..results.len();
        places
            .filter(|&place| right[place] != results[place])
            .collect()
    }

    /// Number of items that are best done at a time.
    fn preferred_width(&self) -> usize {
        1
    }
}
