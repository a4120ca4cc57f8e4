//! Local dimension: whether a singular endpoint is isolated, and how multiple it is.
//!
//! The dual space of a system at a point: all differential functionals that
//! vanish on the ideal. Its dimension up to order k grows with every k exactly
//! where the point lies on a positive-dimensional solution set, and stops at
//! the multiplicity where the point is isolated (Macaulay 1916; Bates,
//! Hauenstein, Peterson, Sommese: A numerical local dimension test for points
//! on the solution set of a system of polynomial equations, SIAM J. Numer. Anal.
//! 47, 2009; Dayton, Zeng: Computing the multiplicity structure in solving
//! polynomial systems, ISSAC 2005). Here in as many variables as the Jacobian's
//! null space has: the others are eliminated as power series, which changes no
//! dimension, since the local ring stays the same.

pub mod candidates;
mod dual_space;
mod moved_slice;
mod null_space;
mod precise_point;
pub mod prepared;
pub mod series;
mod split;

use crate::asked_system::AskedSystem;
use crate::chart::norm;
use crate::path_result::LocalDimension;
use dual_space::{DualSpace, Stop};
use moved_slice::{Around, Search, meets, meets_within};
use num_complex::Complex64;
use precise_point::regular_nearby;
use series::Monomials;
use split::{FARTHEST, Split};

/// Smallest relative error that is assumed of an endpoint: estimates of singular ones are no
/// better than this.
const LEAST_ERROR: f64 = 1e-11;
/// Most monomials that are handled: the matrix of more would take seconds.
const MOST_MONOMIALS: usize = 3000;
/// Below this margin nothing is asked any more.
const UNCLEAR: f64 = 1.5;
/// Dual spaces that do not stop growing up to this order do not contradict a set that slices meet; beyond this order
/// they may know a tangent of it.
const ORDER_ON_A_SET: u32 = 3;
/// Order from which slices are searched in more directions if dual spaces did not stop growing.
const ORDER_OF_DOUBT: u32 = 6;

/// A residual on a slice counts as 0 up to this many times the accuracy of the coefficients: changes of the
/// coefficients within this accuracy can make it 0.
const WITHIN_DATA: f64 = 100.0;

/// Parameters of the isolation test of one endpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Relative error of the point, at most.
    pub accuracy: f64,
    /// Bound of the multiplicity if the point is isolated: the number of paths that end there plus the number of paths
    /// with unknown ends. `u64::MAX` where no bound is known.
    pub bound: u64,
    /// Largest order of the functionals that are computed.
    pub depth: u32,
}

/// The tower of dual spaces at a point of the chart.
///
/// `data_accuracy`: relative accuracy to which the equations' coefficients are known, 0 where they are exact. Where
/// other coefficients within it have a set of positive dimension through the point no more orders are
/// asked: they would tell rounding errors.
pub fn local_dimension(
    system: &AskedSystem,
    target: u64,
    point: &[Complex64],
    question: Question,
    data_accuracy: f64,
) -> LocalDimension {
    let mut tower = LocalDimension {
        dual_dimensions: vec![1],
        bound: question.bound,
        margin: f64::INFINITY,
        moved_slices: Vec::new(),
    };
    let size = norm(point);
    let error = question.accuracy * size;
    if let Some(margin) = regular_nearby(system, target, point, FARTHEST * error) {
        tower.dual_dimensions.push(1);
        tower.margin = margin;
        return tower;
    }
    let Some(split) = Split::new(system, target, point, error, &mut tower) else {
        return tower;
    };
    let kernel = split.kernel.len();
    tower.dual_dimensions.push(1 + kernel as u32);
    if kernel == 0 {
        // A regular point to which Newton's method does not converge: that a solution is there is not known.
        tower.margin = 0.0;
        return tower;
    }
    let around = Around {
        system,
        target,
        split: &split,
        error,
    };
    tower.moved_slices = around.moved_slices(Search::default());
    let mut space = DualSpace::new(kernel);
    for order in 2..=question.depth {
        // One order more than asked tells how the coefficients move with the point.
        let expanded = order + 1;
        if Monomials::count_of(kernel, expanded) > MOST_MONOMIALS {
            break;
        }
        let monomials = Monomials::new(kernel, expanded);
        let Some(reduced) = split.reduce(system, target, &monomials) else {
            break;
        };
        let noise = reduced.noise(&monomials, order, error);
        let stop = space.extend(&monomials, &reduced.equations, noise, &mut tower.margin);
        if let Err(Stop::TooLarge | Stop::Noise) = stop {
            break;
        }
        tower.dual_dimensions.push(space.dimension() as u32);
        // Where values and noise cannot be told apart higher orders say nothing.
        if stop.is_err() || tower.margin < UNCLEAR {
            break;
        }
        if order >= ORDER_ON_A_SET && meets_within(&tower.moved_slices, WITHIN_DATA * data_accuracy)
        {
            break;
        }
        if order == ORDER_ON_A_SET || order == ORDER_OF_DOUBT {
            let tangent = space.tangent(&monomials, order);
            let along_tangent = around.moved_slices(Search {
                many: order == ORDER_OF_DOUBT,
                tangent: tangent.as_deref(),
            });
            if meets(&along_tangent) {
                tower.moved_slices = along_tangent;
                break;
            }
        }
    }
    // A point that low orders do not prove to be isolated gets a thorough search for other solutions nearby.
    let order = tower.dual_dimensions.len() as u32 - 1;
    let closed = tower.dual_dimensions.windows(2).any(|w| w[1] <= w[0]) && tower.margin >= UNCLEAR;
    let met = meets_within(&tower.moved_slices, WITHIN_DATA * data_accuracy);
    if order < ORDER_OF_DOUBT && !closed && !met {
        tower.moved_slices = around.moved_slices(Search {
            many: true,
            tangent: None,
        });
    }
    tower
}

#[cfg(test)]
mod tests;
