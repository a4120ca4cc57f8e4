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

    /// Places of results that are not what these items give, or may not be: whoever made them is not believed.
    ///
    /// `results` are those of the items from `first` on, of this kind of work, made anywhere. Costs a small part of
    /// what [`Self::run`] does where results are right; empty where nothing can be told so cheaply.
    fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let _ = (first, results);
        Vec::new()
    }

    /// The same for items that are done again as cheaply as they are checked.
    fn not_the_same(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let right = self.run(first..first + results.len() as u64, self.preferred_width());
        let places = 0..results.len();
        places
            .filter(|&place| right[place] != results[place])
            .collect()
    }

    /// How many items are best done at a time.
    fn preferred_width(&self) -> usize {
        1
    }
}
