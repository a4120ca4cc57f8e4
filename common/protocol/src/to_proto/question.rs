//! Questions to components outwards.

use super::points;
use crate::submission::Asked;
use crate::v1;
use cognate_continuation::start_points::StoredPoints;
use cognate_solutions::witness::question::{GivenPoint, SampleWish};
use cognate_solutions::witness::{Question, WitnessSet};
use num_complex::Complex64;

/// A question with its components.
pub fn question(asked: &Asked) -> v1::Question {
    use v1::question::Kind;
    let kind = match &asked.question {
        // Components that were read are checked by the reader, so that no message asks for the check.
        Question::Check => None,
        Question::Member { points } => Some(Kind::Member(v1::MemberQuestion {
            points: Some(given(points)),
        })),
        Question::Sample(wish) => Some(Kind::Sample(sample(wish))),
        Question::Project { onto } => {
            Some(Kind::Project(v1::ProjectQuestion { onto: onto.clone() }))
        }
        Question::RealCurve(wish) => Some(Kind::RealCurve(v1::RealCurveQuestion {
            samples: wish.samples,
            projection: wish.projection,
            tolerance: wish.tolerance,
            within: wish.within.concat(),
            certify: wish.certify,
        })),
        Question::Intersect(second) => Some(Kind::Intersect(v1::IntersectQuestion {
            own: second.own,
            from: second.from,
            components: second.components.iter().map(witness_set).collect(),
        })),
        Question::SingularLocus => Some(Kind::SingularLocus(true)),
        Question::RealPoints => Some(Kind::RealPoints(true)),
        Question::RealSurface { samples } => Some(Kind::RealSurface(v1::RealSurfaceQuestion {
            samples: *samples,
        })),
        Question::Certify => Some(Kind::Certify(true)),
        Question::Multidegree => Some(Kind::Multidegree(true)),
        Question::Mobility { points, depth } => Some(Kind::Mobility(v1::MobilityQuestion {
            points: Some(given(points)),
            depth: *depth,
        })),
    };
    v1::Question {
        components: asked.components.iter().map(witness_set).collect(),
        kind,
    }
}

fn sample(wish: &SampleWish) -> v1::SampleQuestion {
    v1::SampleQuestion {
        count: wish.count,
        near: wish
            .near
            .as_ref()
            .map(|near| given(std::slice::from_ref(near))),
        real: wish.real,
        within: wish.within.concat(),
    }
}

fn given(list: &[GivenPoint]) -> v1::GivenPoints {
    let values: Vec<&[Complex64]> = list.iter().map(|p| p.values.as_slice()).collect();
    v1::GivenPoints {
        points: rows(&values),
        accuracies: list.iter().map(|p| p.accuracy).collect(),
    }
}

fn rows(rows: &[&[Complex64]]) -> Option<v1::Points> {
    let first = rows.first()?;
    let stored = StoredPoints {
        dimension: first.len(),
        coordinates: rows.concat(),
    };
    Some(points(&stored))
}

/// A component by its witness points.
pub fn witness_set(set: &WitnessSet) -> v1::WitnessSet {
    let slice: Vec<&[Complex64]> = set.slice.iter().map(Vec::as_slice).collect();
    let points: Vec<&[Complex64]> = set.points.iter().map(Vec::as_slice).collect();
    v1::WitnessSet {
        dimension: set.id.dimension,
        number: set.id.number,
        multiplicity: set.multiplicity.scheme,
        deflation: set.deflation.clone(),
        slice: rows(&slice),
        points: rows(&points),
    }
}
