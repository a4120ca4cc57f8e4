//! Denominators: what an answer about components says without the points where a denominator of the given equations
//! is 0.
//!
//! Components are closures and stay. Components of a locus, real points, and points of a real curve through which no
//! real branch passes are answers by themselves: where a denominator is 0 they are none.

use crate::decomposition::{ordered, remove_zero_denominators};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::denominators::{AskedPoint, Denominator, Denominators};
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::RealPoints;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Errors of points that are known to all digits of a double, and of others, relative to their largest coordinates.
const REGULAR: f64 = 1e-13;
const SINGULAR: f64 = 1e-10;
/// Said where a real point was taken away from a component that may have others beside it.
const BESIDE: &str = "a denominator is 0 at a real point, which is no solution: whether others are beside it is not searched";
const NOT_CLEAR: &str = "whether a denominator is 0 at a real point is not clear";

/// Takes away what is no solution; `system` is without parameters.
pub(super) fn without_zero_denominators(answer: &mut Answer, system: &System, seed: u64) {
    let tolerances = Tolerances::default();
    let Some(denominators) = Denominators::of(system, &[], &tolerances, seed) else {
        return;
    };
    match answer {
        Answer::Components(found) => {
            remove_zero_denominators(found, system, seed);
            **found = ordered((**found).clone());
        }
        Answer::RealPoints(components) => {
            for of in components {
                keep_real_points(of, &denominators);
            }
        }
        Answer::RealCurve(curves) => {
            for curve in curves {
                keep_isolated_points(curve, &denominators);
            }
        }
        Answer::Check(_)
        | Answer::Certify(_)
        | Answer::Member(_)
        | Answer::Sample(_)
        | Answer::Project(_)
        | Answer::Multidegree { .. }
        | Answer::Mobility(_)
        | Answer::RealSurface(_) => {}
    }
}

fn keep_real_points(of: &mut RealPoints, denominators: &Denominators<'_>) {
    let doubts = &mut of.doubts;
    let before = of.points.len();
    of.points.retain(|point| {
        let asked = asked(&point.point, point.regular);
        match denominators.at(asked) {
            Denominator::Nonzero => true,
            Denominator::Zero => false,
            Denominator::Doubtful => {
                doubts.push(NOT_CLEAR.into());
                true
            }
        }
    });
    if of.points.len() < before && of.id.dimension > 0 {
        doubts.push(BESIDE.into());
    }
}

/// Vertices that are the end of no arc are points of the real curve by themselves.
fn keep_isolated_points(curve: &mut RealCurve, denominators: &Denominators<'_>) {
    let mut is_end = vec![false; curve.vertices.len()];
    for place in curve.edges.iter().flat_map(|edge| edge.ends).flatten() {
        is_end[place] = true;
    }
    let mut place_of = Vec::with_capacity(is_end.len());
    let vertices = std::mem::take(&mut curve.vertices);
    for (vertex, is_end) in vertices.into_iter().zip(is_end) {
        place_of.push(curve.vertices.len());
        let decision = match is_end {
            true => Denominator::Nonzero,
            false => denominators.at(asked(&vertex.point, !vertex.is_singular())),
        };
        if decision == Denominator::Doubtful {
            curve.doubts.push(NOT_CLEAR.into());
        }
        if decision != Denominator::Zero {
            curve.vertices.push(vertex);
        }
    }
    for end in curve.edges.iter_mut().flat_map(|edge| &mut edge.ends) {
        *end = end.map(|place| place_of[place]);
    }
}

/// A point of a component: no isolated solution of the equations.
fn asked(values: &[Complex64], regular: bool) -> AskedPoint<'_> {
    AskedPoint {
        values,
        accuracy: if regular { REGULAR } else { SINGULAR },
        singular: !regular,
        isolated: false,
    }
}
