//! Closings: what is done with the endpoints of a finished solve, one stage each, one after the other.

pub mod certificates;
pub mod digits;
mod stage;

use crate::finite_endpoints::FiniteEndpoints;
use crate::progress::Progress;
use crate::solve::{Next, StageNumbers};
use certificates::Certificates;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::StageId;
use cognate_solutions::approximate::approximate;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use digits::Digits;
use serde::{Deserialize, Serialize};

/// One of the things that may be done after any solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Closing {
    /// Solutions get more digits.
    Digits(Digits),
    /// Solutions are proved.
    Certificates(Certificates),
    /// Points of least residual are looked for, where there is no solution.
    Approximate,
}

impl Closing {
    /// Opens the stage for the endpoints of the solve.
    pub fn open(&mut self, endpoints: FiniteEndpoints, numbers: &mut StageNumbers) -> Next {
        match self {
            Self::Digits(closing) => closing.open(endpoints, numbers),
            Self::Certificates(closing) => closing.open(endpoints, numbers),
            Self::Approximate => Next::Done,
        }
    }

    /// Next step once the stage is open; `None` before.
    pub fn next(&self) -> Option<Next> {
        match self {
            Self::Digits(closing) => closing.next(),
            Self::Certificates(closing) => closing.next(),
            Self::Approximate => Some(Next::Done),
        }
    }

    /// True where its stage is open.
    pub fn is_open(&self) -> bool {
        self.next() == Some(Next::Wait)
    }

    /// Takes the results of the stage.
    pub fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match self {
            Self::Digits(closing) => closing.absorb(stage, results),
            Self::Certificates(closing) => closing.absorb(stage, results),
            Self::Approximate => unreachable!("points of least residual take no stage"),
        }
    }

    /// Progress of a solve with this closing.
    pub fn progress(&self, before: Progress) -> Progress {
        match self {
            Self::Digits(closing) => closing.progress(before),
            Self::Certificates(closing) => closing.progress(before),
            Self::Approximate => before,
        }
    }

    /// Adds what was found to the solutions, target by target.
    pub fn apply(&self, sets: &mut [SolutionSet], system: &System) {
        match self {
            Self::Digits(closing) => closing.apply(sets),
            Self::Certificates(closing) => closing.apply(sets, system),
            Self::Approximate => {
                for set in sets {
                    let approximate = approximate(&set.excess_ends, &set.counts, system);
                    set.approximate = Some(approximate);
                }
            }
        }
    }
}
