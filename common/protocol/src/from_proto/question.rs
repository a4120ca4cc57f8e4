//! Questions to components inwards. Whether points and slices fit the system is the planner's business.

use super::{points, required};
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::submission::Asked;
use crate::v1;
use cognate_solutions::witness::question::{CurveWish, GivenPoint, SampleWish, SecondSet};
use cognate_solutions::witness::witness_set::Multiplicity;
use cognate_solutions::witness::{ComponentId, Evidence, Irreducible, Question, WitnessSet};
use num_complex::Complex64;

/// Most components in one question.
const MOST_COMPONENTS: usize = 100_000;

/// A question with its components.
pub fn question(m: v1::Question) -> Result<Asked, ProtocolError> {
    asked(m).map_err(|e| e.within("question"))
}

fn asked(m: v1::Question) -> Result<Asked, ProtocolError> {
    let components = witness_sets(m.components)?;
    let question = match required("kind", m.kind)? {
        v1::question::Kind::Member(member) => Question::Member {
            points: given(required("member.points", member.points)?)?,
        },
        v1::question::Kind::Sample(sample) => Question::Sample(wish(sample)?),
        v1::question::Kind::Project(project) => Question::Project { onto: project.onto },
        v1::question::Kind::RealCurve(curve) => Question::RealCurve(CurveWish {
            samples: curve.samples,
            projection: curve.projection,
            tolerance: curve.tolerance,
            within: pairs("real_curve.within", &curve.within)?,
            certify: curve.certify,
        }),
        v1::question::Kind::Intersect(second) => Question::Intersect(SecondSet {
            own: second.own,
            from: second.from,
            components: witness_sets(second.components).map_err(|e| e.within("intersect"))?,
        }),
        v1::question::Kind::SingularLocus(_) => Question::SingularLocus,
        v1::question::Kind::RealPoints(_) => Question::RealPoints,
        v1::question::Kind::RealSurface(surface) => Question::RealSurface {
            samples: surface.samples,
        },
        v1::question::Kind::Certify(_) => Question::Certify,
        v1::question::Kind::Multidegree(_) => Question::Multidegree,
        v1::question::Kind::Mobility(mobility) => Question::Mobility {
            points: given(required("mobility.points", mobility.points)?)?,
            depth: mobility.depth,
        },
    };
    Ok(Asked {
        components,
        question,
    })
}

fn wish(m: v1::SampleQuestion) -> Result<SampleWish, ProtocolError> {
    let near = match m.near {
        None => None,
        Some(near) => Some(one("sample.near", given(near)?)?),
    };
    Ok(SampleWish {
        count: m.count,
        near,
        real: m.real,
        within: pairs("sample.within", &m.within)?,
    })
}

/// Lower and upper bounds in turn.
fn pairs(field: &'static str, numbers: &[f64]) -> Result<Vec<[f64; 2]>, ProtocolError> {
    if !numbers.len().is_multiple_of(2) {
        return Err(ProtocolError::invalid(
            field,
            format!("{} numbers", numbers.len()),
            "a lower and an upper number for each variable",
        ));
    }
    let pairs = numbers.chunks_exact(2);
    Ok(pairs.map(|pair| [pair[0], pair[1]]).collect())
}

fn one(field: &str, mut points: Vec<GivenPoint>) -> Result<GivenPoint, ProtocolError> {
    match (points.pop(), points.len()) {
        (Some(point), 0) => Ok(point),
        (_, others) => Err(ProtocolError::invalid(
            field,
            format!("{} more points", others),
            "one point",
        )),
    }
}

fn given(m: v1::GivenPoints) -> Result<Vec<GivenPoint>, ProtocolError> {
    let rows = rows(&required("points", m.points)?)?;
    if rows.len() != m.accuracies.len() {
        return Err(ProtocolError::invalid(
            "accuracies",
            format!("{} numbers", m.accuracies.len()),
            format!("one for each of {} points", rows.len()),
        ));
    }
    let pairs = rows.into_iter().zip(m.accuracies);
    Ok(pairs
        .map(|(values, accuracy)| GivenPoint { values, accuracy })
        .collect())
}

fn rows(m: &v1::Points) -> Result<Vec<Vec<Complex64>>, ProtocolError> {
    let stored = points(m)?;
    let rows = stored.coordinates.chunks(stored.dimension);
    Ok(rows.map(<[Complex64]>::to_vec).collect())
}

/// Components by their witness points.
pub fn witness_sets(list: Vec<v1::WitnessSet>) -> Result<Vec<WitnessSet>, ProtocolError> {
    if list.len() > MOST_COMPONENTS {
        return Err(ProtocolError::invalid(
            "components",
            list.len(),
            format!("at most {MOST_COMPONENTS} components"),
        ));
    }
    let sets = list.into_iter().enumerate().map(|(i, set)| {
        let set = witness_set(set);
        set.map_err(|e| e.within(format!("components[{i}]")))
    });
    sets.collect()
}

fn witness_set(m: v1::WitnessSet) -> Result<WitnessSet, ProtocolError> {
    within_limit("deflation", m.deflation.len(), limits::COORDINATES)?;
    let slice = match &m.slice {
        None => Vec::new(),
        Some(slice) => rows(slice).map_err(|e| e.within("slice"))?,
    };
    let points = rows(&required("points", m.points)?).map_err(|e| e.within("points"))?;
    Ok(WitnessSet {
        id: ComponentId {
            dimension: m.dimension,
            number: m.number,
        },
        degree: points.len() as u64,
        multiplicity: Multiplicity {
            scheme: m.multiplicity,
            tracked: 1,
            dual_dimensions: Vec::new(),
        },
        irreducible: Irreducible::Yes,
        deflation: m.deflation,
        self_conjugate: None,
        orbit: None,
        slice: slice.into(),
        points,
        evidence: Evidence::default(),
    })
}
