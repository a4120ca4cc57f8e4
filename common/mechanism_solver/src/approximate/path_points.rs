//! Four-bars whose coupler point passes more than nine points as nearly as it can.
//!
//! The error is the sum of the squared distances from the points to the whole real coupler curve, both circuits. (The
//! residual of the dyads' equations is no measure: it has infimum 0 for every set of points, where both dyads become one.)
//! Random linkages are improved with distances to first order, F / |grad F| of the curve's polynomial F; the best of them
//! with the nearest points of the curve, until the error is a local minimum.

use super::coupler_sextic::{NUMBERS, numbers, position, sextic};
use super::least_squares::{Residual, damped_step, improve};
use super::{Frame, kind_of};
use crate::parallel;
use cognate_kinematics::coupler_curve::circuits;
use cognate_kinematics::linkage::Linkage;
use cognate_kinematics::plane::modulus;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::critical::Kind;
use num_complex::Complex64;

/// Number of points that a coupler curve can pass exactly.
pub const EXACT_POINTS: usize = 9;
/// Random linkages that are improved.
pub const STARTS: usize = 10_000;

/// Steps for each random linkage.
const FIRST_STEPS: usize = 12;
/// Steps for the better quarter.
const MORE_STEPS: usize = 50;
/// Different linkages that are improved with distances to the curve.
const POLISHED: usize = 60;
/// Most steps for each of them.
const POLISHING_STEPS: usize = 400;
/// Errors nearer than this, relative, are of one curve.
const SAME_ERROR: f64 = 1e-6;
/// A local minimum moves by less than this, relative to the extent of the points, in one step of Newton's method.
const STATIONARY: f64 = 1e-5;
/// Step of differences for second derivatives, relative to the extent of the points.
const DIFFERENCE: f64 = 1e-5;
/// Linkages have their joints in a square about the points, whose half side is this many times their extent.
const SQUARE: f64 = 2.5;
/// Steps of Newton's method to the nearest point of the curve.
const NEWTON_STEPS: usize = 20;

/// A four-bar at a local minimum of the error, in one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLinkage {
    /// The linkage.
    pub linkage: Linkage,
    /// The sum of squared distances.
    pub error: f64,
    /// Kind of the stationary point by the second derivatives of the error.
    pub kind: Kind,
}

/// Local minima, by their error; cognates have one curve and are one.
#[derive(Clone, Debug, PartialEq)]
pub struct PathLinkages {
    /// The linkages.
    pub linkages: Vec<PathLinkage>,
    /// Random linkages that were improved.
    pub starts: u64,
    /// The best different ones, which were improved with distances to the curve.
    pub polished: u64,
    /// Linkages among the polished ones that are no local minimum after all steps.
    pub not_stationary: u64,
}

/// The linkages, by this number of threads; by all cores where it is 0.
///
/// # Errors
/// In words, where there are too few points or all are one.
pub fn path_linkages(
    points: &[Complex64],
    starts: usize,
    seed: u64,
    threads: usize,
) -> Result<PathLinkages, String> {
    if points.len() <= EXACT_POINTS {
        return Err(format!(
            "{} points are passed exactly; expected more than {EXACT_POINTS}, or type cognate synthesize nine-point",
            points.len()
        ));
    }
    let frame =
        Frame::of(points).ok_or("the points are one, or their distances are out of range")?;
    let scaled: Vec<Complex64> = points.iter().map(|point| frame.inside(*point)).collect();
    let threads = parallel::threads(threads);

    let chosen = best_starts(&scaled, starts, seed, threads);
    let polished = parallel::map(chosen.len(), threads, |k| polish(&scaled, chosen[k]));
    let mut linkages: Vec<PathLinkage> = Vec::new();
    for end in polished.iter().flatten() {
        let same =
            |other: &&mut PathLinkage| (other.error - end.error).abs() <= SAME_ERROR * end.error;
        match linkages.iter_mut().find(same) {
            Some(other) if other.error <= end.error => {}
            Some(other) => *other = *end,
            None => linkages.push(*end),
        }
    }
    linkages.sort_by(|a, b| a.error.total_cmp(&b.error));
    for each in &mut linkages {
        let place = |z: Complex64| frame.outside(z);
        each.linkage = Linkage {
            pivots: each.linkage.pivots.map(place),
            joints: each.linkage.joints.map(place),
            point: place(each.linkage.point),
        };
        each.error *= frame.unit * frame.unit;
    }
    Ok(PathLinkages {
        starts: starts as u64,
        polished: polished.len() as u64,
        not_stationary: polished.iter().filter(|end| end.is_none()).count() as u64,
        linkages,
    })
}

/// The best different ones among random linkages after steps with distances to first order.
fn best_starts(
    points: &[Complex64],
    starts: usize,
    seed: u64,
    threads: usize,
) -> Vec<[f64; NUMBERS]> {
    let first = |numbers: &[f64; NUMBERS]| first_order(points, numbers);
    let begin = |k: usize| improve(random_linkage(points, seed, k)?, FIRST_STEPS, first);
    let mut ends: Vec<_> = parallel::map(starts, threads, begin)
        .into_iter()
        .flatten()
        .collect();
    ends.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    ends.truncate(starts.div_ceil(4).max(POLISHED));
    let more = |k: usize| improve(ends[k].point, MORE_STEPS, first);
    let mut ends: Vec<_> = parallel::map(ends.len(), threads, more)
        .into_iter()
        .flatten()
        .collect();
    ends.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    ends.dedup_by(|a, b| (a.sum - b.sum).abs() <= SAME_ERROR * b.sum);
    ends.truncate(POLISHED);
    ends.into_iter().map(|end| end.point).collect()
}

/// A linkage with its coupler point at one of the points, and its joints anywhere about them.
fn random_linkage(points: &[Complex64], seed: u64, number: usize) -> Option<[f64; NUMBERS]> {
    /// Number of the stream of probes from which random linkages are drawn.
    const LINKAGES: u64 = 0x6c69_6e6b_0000_0000;
    let mut random = RandomStream::new(seed, Purpose::Probe, LINKAGES + number as u64);
    let mut place = || {
        let mut coordinate = || SQUARE * (2.0 * random.uniform() - 1.0);
        Complex64::new(coordinate(), coordinate())
    };
    numbers(&Linkage {
        pivots: [place(), place()],
        joints: [place(), place()],
        point: points[number % points.len()],
    })
}

/// Distances from the points to the curve, to first order; derivatives without those of |grad F|.
fn first_order(points: &[Complex64], numbers: &[f64; NUMBERS]) -> Option<Vec<Residual<NUMBERS>>> {
    let residual = |point: &Complex64| {
        let value = sextic(*point, numbers);
        let slope = modulus(value.by_place);
        (slope > 0.0 && slope.is_finite()).then(|| Residual {
            value: value.value / slope,
            gradient: value.by_numbers.map(|derivative| derivative / slope),
        })
    };
    points.iter().map(residual).collect()
}

/// Signed distances from the points to the nearest point of the whole curve. Their derivatives are those of the curve's
/// polynomial there over its slope; `None` where the linkage cannot be assembled.
fn distances(points: &[Complex64], numbers: &[f64; NUMBERS]) -> Option<Vec<Residual<NUMBERS>>> {
    let linkage = position(numbers)?;
    let curve = circuits(&linkage);
    let residual = |point: &Complex64| {
        let samples = curve.iter().flat_map(|circuit| &circuit.points);
        let nearest = samples.min_by(|a, b| {
            let distance = |place: &Complex64| (place - point).norm_sqr();
            distance(a).total_cmp(&distance(b))
        })?;
        let foot = foot(*point, *nearest, numbers);
        let value = sextic(foot, numbers);
        let slope = modulus(value.by_place);
        let normal = value.by_place / slope;
        let way = point - foot;
        // The point is beside the curve along its normal: F grows with the linkage as the curve comes nearer.
        (slope > 0.0).then(|| Residual {
            value: way.re * normal.re + way.im * normal.im,
            gradient: value.by_numbers.map(|derivative| derivative / slope),
        })
    };
    points.iter().map(residual).collect()
}

/// The point of the curve nearest to a point, from a point of the curve near to it: Newton's method for F = 0 with the way
/// to the point along the normal; the given one where that leads away.
fn foot(point: Complex64, near: Complex64, numbers: &[f64; NUMBERS]) -> Complex64 {
    let reach = modulus(point - near);
    let mut foot = near;
    for _ in 0..NEWTON_STEPS {
        let value = sextic(foot, numbers);
        let slope = modulus(value.by_place);
        if slope == 0.0 || !slope.is_finite() {
            return near;
        }
        let normal = value.by_place / slope;
        // Along the tangent to below the point, shortened by the curve's bend, then back onto the curve.
        let way = (point - foot) * normal.conj();
        let bend = curvature(foot, normal, slope, numbers);
        let shrink = 1.0 - bend * way.re;
        let along = if shrink > 0.2 {
            way.im / shrink
        } else {
            way.im
        };
        let step = normal * Complex64::new(-value.value / slope, along.clamp(-reach, reach));
        foot += step;
        if modulus(step) <= 1e-15 * (1.0 + modulus(foot)) {
            break;
        }
    }
    // A little farther than the sample by rounding is no other branch.
    match modulus(point - foot) <= reach * (1.0 + 1e-12) + 1e-15 {
        true => foot,
        false => near,
    }
}

/// The curvature towards the normal, by a difference of the normal along the tangent.
fn curvature(place: Complex64, normal: Complex64, slope: f64, numbers: &[f64; NUMBERS]) -> f64 {
    let tangent = normal * Complex64::i();
    let [more, less] =
        [DIFFERENCE, -DIFFERENCE].map(|d| sextic(place + tangent * d, numbers).by_place);
    let change = (more - less) / (2.0 * DIFFERENCE * slope);
    -(change.re * tangent.re + change.im * tangent.im)
}

/// The local minimum to which a linkage leads; `None` where all steps do not reach one.
fn polish(points: &[Complex64], start: [f64; NUMBERS]) -> Option<PathLinkage> {
    let residuals = |numbers: &[f64; NUMBERS]| distances(points, numbers);
    let end = improve(start, POLISHING_STEPS, residuals)?;
    let rows = second_derivatives(points, &end.point)?;
    let step = damped_step(&rows, &gradient(points, &end.point)?, 0.0)?;
    let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length < STATIONARY).then_some(PathLinkage {
        linkage: position(&end.point)?,
        error: end.sum,
        kind: kind_of(&rows),
    })
}

/// Half the gradient of the error.
fn gradient(points: &[Complex64], numbers: &[f64; NUMBERS]) -> Option<[f64; NUMBERS]> {
    let residuals = distances(points, numbers)?;
    Some(std::array::from_fn(|k| {
        residuals.iter().map(|r| r.value * r.gradient[k]).sum()
    }))
}

/// Half the second derivatives of the error, by differences of its gradient.
fn second_derivatives(
    points: &[Complex64],
    numbers: &[f64; NUMBERS],
) -> Option<[[f64; NUMBERS]; NUMBERS]> {
    let mut rows = [[0.0; NUMBERS]; NUMBERS];
    for (k, row) in rows.iter_mut().enumerate() {
        let mut moved = [*numbers; 2];
        moved[0][k] += DIFFERENCE;
        moved[1][k] -= DIFFERENCE;
        let [more, less] = moved.map(|numbers| gradient(points, &numbers));
        let (more, less) = (more?, less?);
        *row = std::array::from_fn(|j| (more[j] - less[j]) / (2.0 * DIFFERENCE));
    }
    Some(rows)
}
