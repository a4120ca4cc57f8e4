//! Boundary: what bounds the points in the plane that an output reaches, their area, and the largest number of postures.

use super::circle::{Arc, Circle};
use super::curves::{Curve, curves, size};
use super::most_postures::{most_postures, samples};
use super::points::workspace;
use super::reached_point::ReachedPoint;
use super::regions::{Area, Regions};
use crate::point_arm;
use crate::preparation::AnswerOptions;
use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::{Mechanism, MechanismError};
use num_complex::Complex64;

/// Degrees between points that draw an arc, at most.
const STEP: f64 = 5.0;
/// Points that draw an arc, at least.
const FEWEST: f64 = 20.0;

/// Boundary of the set of points that an output reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// All curves that can bound; an error says why they are not known.
    pub curves: Result<Vec<BoundaryCurve>, String>,
    /// The area of the points that are reached; an error says why it is not known.
    pub area: Result<f64, String>,
    /// The largest number of postures of a point that has finitely many, whatever the limits; an error says why it is not known.
    pub max_postures: Result<u64, String>,
    /// Reason for a doubt although the curves are known.
    pub doubt: Option<String>,
}

/// A curve that can bound.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryCurve {
    /// The curve with its cause.
    pub curve: Curve,
    /// Whether one of its arcs bounds; `None` where that is in doubt.
    pub on_boundary: Option<bool>,
    /// Points of the arcs that bound; of the whole curve where none does.
    pub samples: Vec<[f64; 2]>,
}

/// The boundary of the points that are reached, within limits where `within_limits`. Of a mechanism whose curves are not known,
/// the largest number of postures comes from `answers` for some points, and from points of an arm.
pub fn boundary(
    mechanism: &Mechanism,
    (orientation, within_limits): (Option<Angle>, bool),
    answers: &[ReachedPoint],
    options: &AnswerOptions,
) -> Result<Boundary, MechanismError> {
    let ask = |points: &[[f64; 3]]| workspace(mechanism, points, orientation, options);
    let curves = match curves(mechanism, orientation, within_limits) {
        Ok(curves) => curves,
        Err(reason) => {
            let of_arm = point_arm::most_postures(mechanism).and_then(|most| most.postures);
            let reached = answers.iter().filter_map(|answer| answer.postures).max();
            let max_postures = match of_arm.filter(|most| reached.is_none_or(|n| n <= *most)) {
                Some(most) => Ok(most),
                None => {
                    let answers = [answers, &ask(&samples(mechanism))?].concat();
                    most_postures(mechanism, &answers)
                }
            };
            return Ok(Boundary {
                area: Err(reason.clone()),
                curves: Err(reason),
                max_postures,
                doubt: None,
            });
        }
    };
    let circles: Vec<Circle> = curves.iter().map(|curve| curve.circle).collect();
    let in_plane = |places: &[Complex64]| {
        let points: Vec<[f64; 3]> = places
            .iter()
            .map(|place| [place.re, place.im, 0.0])
            .collect();
        ask(&points)
    };
    let regions = Regions::ask(&circles, size(&curves), within_limits, in_plane)?;
    let drawn = curves.into_iter().enumerate().map(|(number, curve)| {
        let bounding = regions.bounding_arcs(number);
        BoundaryCurve {
            on_boundary: bounding.as_ref().map(|arcs| !arcs.is_empty()),
            samples: drawn(&curve.circle, bounding.unwrap_or_default()),
            curve,
        }
    });
    let area = regions.area();
    Ok(Boundary {
        curves: Ok(drawn.collect()),
        max_postures: regions.most_postures(),
        doubt: match &area {
            Area::Doubtful(doubt) => Some(format!("area: {doubt}")),
            Area::Finite(_) | Area::Infinite => None,
        },
        area: match area {
            Area::Finite(area) => Ok(area),
            Area::Infinite => Err("points at any distance are reached".into()),
            Area::Doubtful(doubt) => Err(doubt),
        },
    })
}

/// Points of arcs of a circle, or of the whole circle where there is none.
fn drawn(circle: &Circle, arcs: Vec<Arc>) -> Vec<[f64; 2]> {
    let whole = Arc {
        start: 0.0,
        extent: 360.0,
    };
    let arcs = match arcs.is_empty() {
        true => vec![whole],
        false => arcs,
    };
    let points = arcs.iter().flat_map(|arc| {
        let steps = (arc.extent / STEP).ceil().max(FEWEST) as u32;
        (0..=steps).map(move |k| arc.start + arc.extent * f64::from(k) / f64::from(steps))
    });
    let points = points.map(|degrees| circle.point(degrees));
    points.map(|point| [point.re, point.im]).collect()
}
