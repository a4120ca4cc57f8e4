//! The rules that give one path its verdict: pure functions of its own facts.
//!
//! Tolerances are arguments, so that a verdict can be decided again from
//! stored results. The first class that holds is the path's class.

use crate::point_shape::{PointShape, largest, modulus};
use cognate_continuation::path_result::{AskedFit, LocalDimension, MovedSlice, PathResult};
use cognate_continuation::tracker::outcome::PathOutcome;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Every number that decides a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerances {
    /// A homogenising coordinate of a singular endpoint is 0 within this many times its estimated error.
    pub infinity_factor: f64,
    /// A homogenising coordinate of a singular endpoint is 0 within this, whatever the estimate says: five hundred
    /// roundings of a coordinate of size 1.
    pub infinity_floor: f64,
    /// A homogenising coordinate of a regular endpoint far out has digits of its own and is 0 where they say so. Where
    /// these digits do not tell, it is not 0, but below this.
    pub regular_infinity_floor: f64,
    /// A homogenising coordinate of a singular endpoint that was seen to turn around 0 is 0 within this: errors of
    /// singular endpoints are estimated less well.
    pub singular_infinity_floor: f64,
    /// A verdict within this factor of the border on either side rests on the precision alone and is counted as such.
    pub infinity_band: f64,
    /// An endpoint solves the system when its residual is within this many times its
    /// estimated error. Endpoints of the shared mechanisms have at most 3 times; those
    /// that an endgame took from a circle around something else have 1000 times and more.
    pub residual_factor: f64,
    /// An endpoint solves the system when its residual is within this, all equations scaled to 1; an endgame may settle
    /// on such a point.
    pub residual_floor: f64,
    /// A regular endpoint of a randomised system is a solution of the system that is asked when a least-squares Newton
    /// step on all its equations would move it by at most this many times its estimated error.
    pub excess_factor: f64,
    /// A regular endpoint of a randomised system is a solution also when this step moves it by at most this. Points
    /// that solve only the combinations are generic: on system (35) the step is 1e-2 and more.
    pub excess_floor: f64,
    /// Two endpoints coincide within this many times the sum of their estimated errors.
    pub coincidence_factor: f64,
    /// Two endpoints coincide within this, whatever the estimates say. Two regular solutions this near have condition
    /// numbers above 1e9, past the limit of the tracker for regular points.
    pub coincidence_floor: f64,
    /// Two singular endpoints coincide within this many times the sum of their estimated errors, which are estimated
    /// less well.
    pub singular_coincidence_factor: f64,
    /// Two singular endpoints coincide within this, whatever the estimates say.
    pub singular_coincidence_floor: f64,
    /// The rank of a multiplicity matrix is believed when every singular value is this many times
    /// larger or smaller than the border between values and noise.
    pub rank_margin: f64,
    /// A moved slice meets a solution where the equations, scaled to 1, are at most this in
    /// double-doubles (see [`MovedSlice::are_met`]). Near a point of multiplicity m they are up to the distance to
    /// the power m; near a set of multiplicity 3 and more Newton's method in doubles comes to about 1e-22.
    pub slice_residual: f64,
    /// Above this residual nothing was found on a slice at all.
    pub slice_missed: f64,
    /// An expression of a degenerate set is 0 within this many times the error that
    /// the endpoint's estimated error makes in it.
    pub degenerate_factor: f64,
    /// Smallest relative error that is assumed for an endpoint there.
    pub degenerate_floor: f64,
    /// Relative error of the equations' coefficients; 0 where they are exact. A root of a radicand may be another where
    /// such an error can make it 0.
    #[serde(default)]
    pub data_accuracy: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            infinity_factor: 10.0,
            infinity_floor: 1e-13,
            regular_infinity_floor: 1e-300,
            singular_infinity_floor: 1e-10,
            infinity_band: 10.0,
            residual_factor: 100.0,
            residual_floor: 1e-9,
            excess_factor: 1e3,
            excess_floor: 1e-6,
            coincidence_factor: 10.0,
            coincidence_floor: 1e-10,
            singular_coincidence_factor: 50.0,
            singular_coincidence_floor: 1e-8,
            rank_margin: 3.0,
            slice_residual: 1e-20,
            slice_missed: 1e-8,
            degenerate_factor: 10.0,
            degenerate_floor: 1e-13,
            data_accuracy: 0.0,
        }
    }
}

/// Class of a path's end. The classes are tried in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Verdict {
    /// The path was not tracked to the end.
    Failed,
    /// The homogenising coordinate of an affine group is 0.
    AtInfinity,
    /// Finite, where a denominator of the given equations is 0 or a root is on a false branch: no solution of them. Not a
    /// fact of one path alone: [`classify`] does not say it.
    Removed,
    /// Finite, but a solution only of the combinations of equations that were tracked.
    ExcessSolution,
    /// Finite, on a curve, surface, ... of solutions.
    PositiveDimensional,
    /// Finite, with a singular Jacobian; isolated or not is not known.
    Undecided,
    /// Finite and isolated or at infinity, at a regular or a multiple point, depending on digits of the
    /// coefficients that were not given.
    WithinDataAccuracy,
    /// Finite and isolated, with a singular Jacobian.
    Singular,
    /// Finite, nonsingular and so isolated.
    Finite,
}

impl Verdict {
    /// True for a finite endpoint with a singular Jacobian that may be an isolated solution.
    pub fn may_be_multiple(self) -> bool {
        matches!(self, Self::Undecided | Self::Singular)
    }
}

/// A verdict and how it was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The class.
    pub verdict: Verdict,
    /// True when finite or infinite was decided only by the limit of the precision:
    /// too near the border, or two indications that disagree.
    pub by_precision_limit: bool,
}

/// The verdict of one path.
pub fn classify(result: &PathResult, shape: &PointShape, tolerances: &Tolerances) -> Decision {
    let point = result.endpoint.to_double();
    let singular = match result.outcome {
        PathOutcome::Failed(_) => return Decision::clear(Verdict::Failed),
        // A power sum that is not 0 is one within the accuracy of the data: other data have infinity.
        PathOutcome::Diverging if result.accuracy.is_finite() => {
            return Decision::clear(Verdict::WithinDataAccuracy);
        }
        PathOutcome::Diverging => return Decision::clear(Verdict::AtInfinity),
        // All solutions are known, or it would have been followed further: it has left for infinity, or for a solution of
        // combinations of the equations only.
        PathOutcome::PutAside => {
            return Decision::clear(match result.asked {
                Some(_) => Verdict::ExcessSolution,
                None => Verdict::AtInfinity,
            });
        }
        // A result that holds no point is as good as none.
        _ if !shape.holds(point) => return Decision::clear(Verdict::Failed),
        _ if !solves(result, tolerances) => return Decision::clear(Verdict::Failed),
        PathOutcome::Singular => true,
        PathOutcome::Regular => false,
    };
    let bound_above = |floor| error_bound(result.accuracy, tolerances.infinity_factor, floor);
    let mut at_infinity = false;
    let mut by_precision_limit = false;
    let affine = shape.spans().filter(|span| !span.group.homogeneous);
    for (k, span) in affine.enumerate() {
        let group = &point[span.range];
        let coordinate = modulus(group[0]) / largest(group);
        let turns = result.infinity_turns.get(k).filter(|_| singular);
        let bound = bound_above(match turns {
            Some(&turns) if turns > 0 => tolerances.singular_infinity_floor,
            _ => tolerances.infinity_floor,
        });
        let vanishes = coordinate <= bound;
        match turns {
            // How often the coordinate turns around 0 is a whole number: it says
            // without tolerance whether the coordinate vanishes, unless something
            // else lies within the radius. Both must agree for infinity, except
            // where the coordinate is rounding error and nothing was there to turn.
            Some(&turns) => {
                let nothing = coordinate <= tolerances.infinity_floor;
                at_infinity |= nothing || (vanishes && turns > 0);
                // Where turns show infinity a path ends without a point: one that has a point had
                // none that showed it.
                by_precision_limit |= vanishes != (turns > 0) || (vanishes && !nothing);
            }
            None if singular => {
                at_infinity |= vanishes;
                by_precision_limit |= coordinate > bound / tolerances.infinity_band
                    && coordinate < bound * tolerances.infinity_band;
            }
            None => {
                let zero = coordinate <= tolerances.regular_infinity_floor;
                at_infinity |= zero;
                by_precision_limit |= zero && group[0] != Complex64::default();
            }
        }
    }
    let verdict = match singular {
        _ if at_infinity => Verdict::AtInfinity,
        _ if !solves_what_is_asked(result, tolerances) => Verdict::ExcessSolution,
        true => match isolation(result, tolerances) {
            // With its digits the Jacobian is regular: other solutions are near, that is all.
            Isolation::Isolated { multiplicity: 1 } => Verdict::Finite,
            // A polynomial in one unknown, unless it is 0, has finitely many roots.
            _ if one_unknown(shape) => Verdict::Singular,
            Isolation::PositiveDimensional => Verdict::PositiveDimensional,
            Isolation::Isolated { .. } => Verdict::Singular,
            Isolation::Undecided => Verdict::Undecided,
        },
        false => Verdict::Finite,
    };
    Decision {
        verdict,
        by_precision_limit,
    }
}

/// Whether the points are those of one affine or projective line.
fn one_unknown(shape: &PointShape) -> bool {
    let mut spans = shape.spans();
    let first = spans.next().map(|span| span.range.len());
    first == Some(2) && spans.next().is_none()
}

/// Whether a singular endpoint is isolated, from dual spaces and moved slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Isolation {
    /// The endpoint is isolated: dual spaces stop growing.
    Isolated {
        /// Multiplicity of the endpoint as a solution of the system that is asked.
        multiplicity: u32,
    },
    /// Slices beside the endpoint meet solutions at every small distance, and dual spaces do not stop growing.
    PositiveDimensional,
    /// No test was asked for, or no test is clear, or dual spaces and slices contradict each other.
    Undecided,
}

/// Whether an endpoint is isolated, from its dual spaces.
pub fn isolation(result: &PathResult, tolerances: &Tolerances) -> Isolation {
    let dual_spaces = result.local_dimension.as_ref();
    dual_spaces.map_or(Isolation::Undecided, |dual_spaces| {
        isolation_by(dual_spaces, tolerances)
    })
}

/// Whether the endpoint of these dual spaces is isolated.
pub fn isolation_by(dual_spaces: &LocalDimension, tolerances: &Tolerances) -> Isolation {
    match (
        multiplicity(dual_spaces, tolerances),
        is_met(dual_spaces, tolerances),
    ) {
        (Some(multiplicity), false) => Isolation::Isolated { multiplicity },
        (None, true) => Isolation::PositiveDimensional,
        // No evidence, or two kinds that contradict each other.
        (None, false) | (Some(_), true) => Isolation::Undecided,
    }
}

/// Whether dual spaces are not clear about an endpoint's multiplicity, or find another than the number of `paths`
/// that end there (where all paths are there, so that the number says something), and no slice says
/// that the endpoint is one of many.
pub fn is_unconfirmed(result: &PathResult, paths: Option<u64>, tolerances: &Tolerances) -> bool {
    let Some(dual_spaces) = &result.local_dimension else {
        return false;
    };
    let other = match multiplicity(dual_spaces, tolerances) {
        Some(multiplicity) => paths.is_some_and(|paths| paths != u64::from(multiplicity)),
        None => dual_spaces.margin < tolerances.rank_margin,
    };
    other && !is_met(dual_spaces, tolerances)
}

/// The dimension at which the dual space clearly stops growing.
fn multiplicity(dual_spaces: &LocalDimension, tolerances: &Tolerances) -> Option<u32> {
    let [.., before, last] = dual_spaces.dual_dimensions.as_slice() else {
        return None;
    };
    (dual_spaces.margin >= tolerances.rank_margin && last <= before).then_some(*last)
}

/// Whether solutions were met on all slices that pass the endpoint at small distances.
fn is_met(dual_spaces: &LocalDimension, tolerances: &Tolerances) -> bool {
    MovedSlice::are_met(
        &dual_spaces.moved_slices,
        tolerances.slice_residual,
        tolerances.slice_missed,
    )
}

/// Whether the endpoint solves the system as well as its estimated error says.
pub fn solves(result: &PathResult, tolerances: &Tolerances) -> bool {
    result.residual
        <= error_bound(
            result.accuracy,
            tolerances.residual_factor,
            tolerances.residual_floor,
        )
}

/// Whether a finite endpoint solves all equations that are asked, where combinations of them were
/// tracked. At a singular endpoint only the residual is asked: a Newton step means little there.
fn solves_what_is_asked(result: &PathResult, tolerances: &Tolerances) -> bool {
    let Some(AskedFit {
        residual,
        correction,
    }) = result.asked
    else {
        return true;
    };
    let within = |value: f64, factor, floor| value <= error_bound(result.accuracy, factor, floor);
    let near = within(
        correction,
        tolerances.excess_factor,
        tolerances.excess_floor,
    );
    within(
        residual,
        tolerances.residual_factor,
        tolerances.residual_floor,
    ) && (near || result.outcome == PathOutcome::Singular)
}

/// Bound of the error of a coordinate of size 1, from an estimated error.
pub fn error_bound(accuracy: f64, factor: f64, floor: f64) -> f64 {
    // An unknown error (not a number, infinite) must not make everything 0.
    let estimate = if accuracy.is_finite() {
        factor * accuracy
    } else {
        0.0
    };
    estimate.max(floor).min(1e-3)
}

impl Decision {
    fn clear(verdict: Verdict) -> Self {
        Self {
            verdict,
            by_precision_limit: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::{affine_shape, failed, regular, singular};

    fn verdict(result: &PathResult) -> (Verdict, bool) {
        let shape = affine_shape(result.endpoint.to_double().len() - 1);
        let decision = classify(result, &shape, &Tolerances::default());
        (decision.verdict, decision.by_precision_limit)
    }

    #[test]
    fn a_root_of_a_polynomial_in_one_unknown_is_isolated() {
        let double = [(1.0, 0.0), (0.5, 0.0)];
        let expected = (Verdict::Singular, false);
        assert_eq!(verdict(&singular(0, &double, 2, &[0])), expected);
        let elsewhere = [(1.0, 0.0), (0.5, 0.0), (0.5, 0.0)];
        let expected = (Verdict::Undecided, false);
        assert_eq!(verdict(&singular(0, &elsewhere, 2, &[0])), expected);
    }

    #[test]
    fn size_alone_is_not_infinity() {
        for norm in [1.0, 1e4, 1e6, 1e8, 1e11, 1e19] {
            let result = regular(0, &[(1.0 / norm, 0.0), (1.0, 0.0), (0.3, -0.2)]);
            assert_eq!(verdict(&result), (Verdict::Finite, false), "norm {norm}");
        }
        let result = regular(0, &[(0.0, 0.0), (1.0, 0.0)]);
        assert_eq!(verdict(&result), (Verdict::AtInfinity, false));
    }

    #[test]
    fn what_diverges_is_at_infinity_wherever_it_was_left() {
        let mut result = singular(0, &[(0.05, 0.0), (1.0, 0.0)], 1, &[]);
        result.outcome = PathOutcome::Diverging;
        (result.residual, result.accuracy) = (f64::INFINITY, f64::INFINITY);
        assert_eq!(verdict(&result), (Verdict::AtInfinity, false));
        result.accuracy = 1e-13;
        assert_eq!(verdict(&result), (Verdict::WithinDataAccuracy, false));
    }

    #[test]
    fn near_the_border_the_precision_decides_and_says_so() {
        let result = regular(0, &[(f64::MIN_POSITIVE, 0.0), (1.0, 0.0)]);
        assert_eq!(verdict(&result), (Verdict::AtInfinity, true));
    }

    #[test]
    fn singular_endpoints_need_both_indications() {
        let point = |x0: f64| [(x0, 0.0), (1.0, 0.0), (0.0, 0.0)];
        assert_eq!(
            verdict(&singular(0, &point(1e-11), 2, &[1])),
            (Verdict::AtInfinity, true)
        );
        assert_eq!(
            verdict(&singular(0, &point(1e-11), 2, &[0])),
            (Verdict::Undecided, true)
        );
        assert_eq!(
            verdict(&singular(0, &point(1e-16), 3, &[0])),
            (Verdict::AtInfinity, true)
        );
        assert_eq!(
            verdict(&singular(0, &point(1e-3), 2, &[1])),
            (Verdict::Undecided, true)
        );
        assert_eq!(
            verdict(&singular(0, &point(0.5), 2, &[0])),
            (Verdict::Undecided, false)
        );
    }

    #[test]
    fn an_endpoint_that_solves_nothing_fails() {
        let point = [(1.0, 0.0), (0.5, 0.0), (0.0, 0.0)];
        let claimed = singular(0, &point, 1, &[0]);
        for (residual, expected) in [
            (1e-12, Verdict::Undecided),
            (1e-6, Verdict::Failed),
            (f64::NAN, Verdict::Failed),
        ] {
            let result = PathResult {
                residual,
                ..claimed.clone()
            };
            assert_eq!(verdict(&result), (expected, false), "{residual}");
        }
    }

    #[test]
    fn what_solves_only_the_combinations_is_excess() {
        let with = |base: PathResult, residual, correction| PathResult {
            asked: Some(AskedFit {
                residual,
                correction,
            }),
            ..base
        };
        let point = [(1.0, 0.0), (0.5, 0.0), (0.0, 0.0)];
        let expect = |result: PathResult, expected| assert_eq!(verdict(&result).0, expected);
        expect(with(regular(0, &point), 1e-16, 1e-15), Verdict::Finite);
        expect(with(regular(0, &point), 0.3, 0.2), Verdict::ExcessSolution);
        expect(
            with(regular(0, &point), 1e-10, 1e-3),
            Verdict::ExcessSolution,
        );
        expect(
            with(regular(0, &point), f64::INFINITY, 0.0),
            Verdict::ExcessSolution,
        );
        expect(
            with(singular(0, &point, 2, &[0]), 1e-9, 0.1),
            Verdict::Undecided,
        );
        expect(
            with(singular(0, &point, 2, &[0]), 1e-3, 0.1),
            Verdict::ExcessSolution,
        );
        let far = [(0.0, 0.0), (1.0, 0.0)];
        expect(with(regular(0, &far), 0.3, 0.2), Verdict::AtInfinity);
    }

    #[test]
    fn dual_spaces_and_moved_slices_say_whether_a_singular_endpoint_is_isolated() {
        let with = |dimensions: &[u32], residuals: &[f64], margin| {
            let slice = |(k, &residual): (usize, &f64)| MovedSlice {
                distance: 0.1 * 0.125f64.powi(k as i32),
                residual,
                reached: 0.1,
            };
            let result = PathResult {
                local_dimension: Some(LocalDimension {
                    dual_dimensions: dimensions.to_vec(),
                    bound: 1,
                    margin,
                    moved_slices: residuals.iter().enumerate().map(slice).collect(),
                }),
                ..singular(0, &[(1.0, 0.0), (0.5, 0.0), (0.0, 0.0)], 1, &[0])
            };
            (
                isolation(&result, &Tolerances::default()),
                verdict(&result).0,
            )
        };
        let isolated = |multiplicity| (Isolation::Isolated { multiplicity }, Verdict::Singular);
        let undecided = (Isolation::Undecided, Verdict::Undecided);
        let on_a_set = (Isolation::PositiveDimensional, Verdict::PositiveDimensional);
        let (met, missed) = ([1e-3, 1e-30, 1e-29], [1e-3, 1e-6, 1e-9]);
        assert_eq!(with(&[1, 2, 3, 3], &missed, 1e5), isolated(3));
        let simple = (Isolation::Isolated { multiplicity: 1 }, Verdict::Finite);
        assert_eq!(with(&[1, 1], &[], 1e5), simple);
        assert_eq!(with(&[1, 3, 5], &met, 1e5), on_a_set);
        assert_eq!(
            with(&[1, 3, 5], &met, 1.5),
            on_a_set,
            "ranks are not needed"
        );
        assert_eq!(
            with(&[1, 3, 5], &missed, 1e5),
            undecided,
            "more than paths end there"
        );
        assert_eq!(with(&[1, 3, 5], &[], 1e5), undecided);
        assert_eq!(with(&[1, 3, 5], &[1e-30], 1e5), undecided, "one slice only");
        assert_eq!(
            with(&[1, 3, 5], &[1e-9, 1e-12, 1e-30], 1e5),
            undecided,
            "the nearest only"
        );
        assert_eq!(with(&[1, 3, 3], &met, 1e5), undecided, "a contradiction");
        let high = [1e-12, 1e-23, 1e-30];
        assert_eq!(with(&[1, 2, 3], &high, 1e5), undecided, "the twelfth power");
        assert_eq!(with(&[1], &missed, 1.0), undecided);
        assert_eq!(with(&[1, 2, 2], &missed, f64::NAN), undecided);
    }

    #[test]
    fn failures_and_damaged_results_fail() {
        assert_eq!(verdict(&failed(0)), (Verdict::Failed, false));
        let result = regular(0, &[(f64::NAN, 0.0), (1.0, 0.0)]);
        assert_eq!(verdict(&result), (Verdict::Failed, false));
    }
}
