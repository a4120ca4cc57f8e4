//! Beside rows of positions: lines on standard error for targets without a row, for sets of positions and for doubts.

use super::listing::{Finished, Listing};
use super::table::Table;
use super::view::View;
use crate::error::ClientError;
use crate::output::beside_rows::{Remarks, named_targets};
use crate::output::text::Look;
use cognate_mechanism_solver::postures::Postures;

/// Lines of a table that rows of CSV do not hold.
pub struct BesideRows<'a> {
    view: View<'a>,
    table: Table<'a>,
    look: Look,
    /// Numbers of the targets without a row, from 1 as in the rows.
    without: Vec<usize>,
}

impl<'a> BesideRows<'a> {
    /// For rows of real positions.
    pub fn new(view: View<'a>, look: Look) -> Self {
        let view = View {
            complex: false,
            ..view
        };
        Self {
            view,
            table: Table::new(view, look),
            look,
            without: Vec::new(),
        }
    }
}

impl Listing for BesideRows<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        if !answer.positions.iter().any(|p| self.view.lists(p)) {
            self.without.push(index as usize + 1);
        }
        self.table.target(index, answer)
    }

    fn finish(self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError> {
        let mut remarks = Remarks::new(self.look);
        let total = self.table.total();
        if self.without.len() as u64 == end.summary.targets {
            let reason = self.table.why_none(end);
            remarks.note(&format!("no position to show: {reason}"));
        } else if !self.without.is_empty() {
            remarks.note(&format!(
                "no real position at {}",
                named_targets(&self.without)
            ));
        }
        let sets = self.table.set_lines();
        for line in &sets {
            remarks.note(line);
        }
        if total.positive_dimensional > 0 && sets.is_empty() {
            let said = format!("{} of the paths end on sets", total.positive_dimensional);
            remarks.note(&format!("{said} of positions, of which no row is shown"));
        }
        if !end.summary.settled {
            remarks.not_settled(&match total.failed {
                0 => "see the warnings, or the counts without --format csv".to_owned(),
                failed => format!("{failed} failed; --format json has the counts"),
            });
        }
        remarks.print();
        Ok(())
    }
}
