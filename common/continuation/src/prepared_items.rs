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

    /// How many items are best done at a time.
    fn preferred_width(&self) -> usize {
        1
    }
}
