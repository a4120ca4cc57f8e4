//! DimensionStart: where the paths to one dimension by itself begin.

use crate::degrees_or_bounds::degrees_or_bounds;
use crate::limits::CHOOSING_OPERATIONS;
use crate::start_costs::{cell_supports, polyhedral_is_cheaper};
use cognate_continuation::start_systems::polyhedral::mixed_cells::{MixedCellsError, mixed_cells};
use cognate_systems::system::System;

/// Most paths of total degree that are followed where mixed cells cannot be counted at once.
const FEW_PATHS: u64 = 5000;

/// The start of paths to all solutions of as many combinations of the equations as cut out a set of one dimension, on
/// its slices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum DimensionStart {
    /// Total-degree start: as many paths as the product of the degrees.
    TotalDegree {
        /// Degrees, one for each equation and each slice.
        degrees: Vec<u32>,
    },
    /// Paths from the mixed cells of the sliced system.
    MixedCells {
        /// The mixed volume; `None` where workers count it.
        count: Option<u64>,
    },
}

impl DimensionStart {
    /// Total-degree start by the degrees of the combinations and slices.
    pub fn of_degrees(sliced: &System) -> Self {
        let degrees = degrees_or_bounds(sliced);
        let degrees = degrees.expect("combinations of equations with degrees have degrees");
        Self::TotalDegree {
            degrees: degrees.total,
        }
    }

    /// The start with fewer paths of the system that is tracked in a dimension, with liftings of this seed.
    pub fn of(sliced: &System, seed: u64) -> Self {
        let by_degrees = Self::of_degrees(sliced);
        let product = by_degrees.paths();
        let fewer = |volume: u64| product.is_none_or(|count| polyhedral_is_cheaper(volume, count));
        // Where even one path would not be fewer, nothing is counted.
        if !fewer(1) {
            return by_degrees;
        }
        let Ok(supports) = cell_supports(sliced) else {
            return by_degrees;
        };
        match mixed_cells(&supports, seed, CHOOSING_OPERATIONS) {
            Ok(cells) if cells.mixed_volume > 0 && fewer(cells.mixed_volume) => Self::MixedCells {
                count: Some(cells.mixed_volume),
            },
            Err(MixedCellsError::TooLong) if product.is_none_or(|count| count > FEW_PATHS) => {
                Self::MixedCells { count: None }
            }
            _ => by_degrees,
        }
    }

    /// Number of paths; `None` if it is not counted yet or does not fit into 64 bits.
    pub fn paths(&self) -> Option<u64> {
        match self {
            Self::TotalDegree { degrees } => {
                let mut degrees = degrees.iter().map(|&degree| u64::from(degree));
                degrees.try_fold(1u64, u64::checked_mul)
            }
            Self::MixedCells { count } => *count,
        }
    }
}
