//! Joints of a path of targets: which positions of two neighbouring samples are joined, and where the others end.

use super::fold::Fold;
use super::segment::Segment;
use super::trace::{End, trace};
use super::tube::{Located, located};
use num_complex::Complex64;

/// End of a position's path on the way to the neighbour.
#[derive(Clone, Debug, PartialEq)]
pub enum Link {
    /// The position leads to this position of the neighbour, with proof.
    Joined(usize),
    /// The position vanishes at a fold, by the fold's number in the joint.
    Fold(usize),
    /// In doubt, with the reason.
    Unknown(&'static str),
}

/// A fold between two samples.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldBetween {
    /// Place of the fold, as a part of the way between the two samples.
    pub s: f64,
    /// How far off that can be, where the fold is proved to be there.
    pub error: Option<f64>,
    /// Whether two positions vanish there; else they appear.
    pub vanish: bool,
    /// The variables there.
    point: Vec<Complex64>,
    /// How many positions of the two samples end there.
    count: usize,
    /// Other folds between the same two samples to which a branch without a sample leads from here.
    neighbours: Vec<usize>,
}

impl FoldBetween {
    /// Whether two branches end here.
    fn is_whole(&self) -> bool {
        self.count + self.neighbours.len() == 2
    }
}

/// The way from one sample to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// For each position of the first sample, where it leads in the second sample.
    pub onward: Vec<Link>,
    /// For each position of the second sample, the end of its path on the way back; `None` if a position of the first
    /// sample leads to it.
    pub back: Vec<Option<Link>>,
    /// The folds in between.
    pub folds: Vec<FoldBetween>,
}

const NO_SOLUTION: &str = "one of its positions is not shown to be one";
const NOT_LISTED: &str = "it arrives where no position was found";
const NO_FOLD: &str = "its solution cannot be followed, and no fold is found";
const HALF_FOLD: &str = "not two positions end at its fold";
const NOT_BACK: &str = "a position comes from one that does not lead to it";

/// Joins the positions, given as points, of two neighbouring samples.
pub fn join(segment: Segment<'_>, first: &[Vec<Complex64>], second: &[Vec<Complex64>]) -> Joint {
    let mut joint = Joint::default();
    for point in first {
        let link = one(&segment, point, [first, second], true, &mut joint.folds);
        joint.onward.push(link);
    }
    // Different solutions have different curves: two that arrive at one place cannot both be right.
    for k in 0..joint.onward.len() {
        if let Link::Joined(to) = joint.onward[k]
            && joint.onward[..k].contains(&Link::Joined(to))
        {
            joint.onward[k] = Link::Unknown(NO_SOLUTION);
        }
    }
    let back = segment.reversed();
    for (place, point) in second.iter().enumerate() {
        let back_link = if joint.onward.contains(&Link::Joined(place)) {
            None
        } else {
            Some(
                match one(&back, point, [second, first], false, &mut joint.folds) {
                    Link::Joined(_) => Link::Unknown(NOT_BACK),
                    link => link,
                },
            )
        };
        joint.back.push(back_link);
    }
    let is_half = |link: &Link| matches!(link, Link::Fold(fold) if !joint.folds[*fold].is_whole());
    let half: Vec<bool> = joint.onward.iter().map(is_half).collect();
    for (link, half) in joint.onward.iter_mut().zip(half) {
        if half {
            *link = Link::Unknown(HALF_FOLD);
        }
    }
    let half: Vec<bool> = joint
        .back
        .iter()
        .map(|l| l.as_ref().is_some_and(is_half))
        .collect();
    for (link, half) in joint.back.iter_mut().zip(half) {
        if half {
            *link = Some(Link::Unknown(HALF_FOLD));
        }
    }
    joint
}

/// Follows one position to the neighbour. `samples`: the points of its own sample and of the neighbour.
fn one(
    segment: &Segment<'_>,
    point: &[Complex64],
    samples: [&[Vec<Complex64>]; 2],
    onward: bool,
    folds: &mut Vec<FoldBetween>,
) -> Link {
    let chart = segment.chart(point);
    let Some(start) = segment.in_chart(&chart, point) else {
        return Link::Unknown(NO_SOLUTION);
    };
    let mut curve = segment.curve(&chart);
    let Some(followed) = trace(&mut curve, &start, segment.is_real()) else {
        return Link::Unknown(NO_SOLUTION);
    };
    let mut place_of = |there: &Located, points: &[Vec<Complex64>]| {
        curve.set_parameter(curve.place_of_s());
        let s = there.point[curve.place_of_s()];
        points.iter().position(|other| {
            let other = segment.in_chart(&chart, other);
            let other = other.and_then(|other| located(&mut curve, &[&other[..], &[s]].concat()));
            other.is_some_and(|other| other.holds(there, &curve))
        })
    };
    let place = match &followed.end {
        End::Returned(there) => place_of(there, samples[0]),
        End::Arrived(there) => place_of(there, samples[1]),
        End::Stopped(near) if followed.folds.is_empty() => {
            return match segment.folds(&chart).near(segment.ends(), near) {
                // Beyond the place where the curve stopped.
                Some(fold) if fold.s >= near.point[curve.place_of_s()].re => {
                    let fold = between(segment, fold, true, onward);
                    Link::Fold(number(folds, fold, 1))
                }
                _ => Link::Unknown(NO_FOLD),
            };
        }
        End::Stopped(_) => return Link::Unknown(NO_FOLD),
    };
    let Some(place) = place else {
        return Link::Unknown(NOT_LISTED);
    };
    if followed.folds.is_empty() {
        return Link::Joined(place);
    }
    let system = segment.folds(&chart);
    let near = followed.folds.iter();
    let passed: Option<Vec<Fold>> = near.map(|near| system.near(segment.ends(), near)).collect();
    passed.map_or(Link::Unknown(NO_FOLD), |passed| {
        Link::Fold(around(segment, passed, onward, folds))
    })
}

/// Lists the folds that a position's curve passes, one after the other; returns the number of the first.
fn around(
    segment: &Segment<'_>,
    passed: Vec<Fold>,
    onward: bool,
    folds: &mut Vec<FoldBetween>,
) -> usize {
    let mut numbers: Vec<usize> = Vec::new();
    for (k, fold) in passed.into_iter().enumerate() {
        let fold = between(segment, fold, k % 2 == 0, onward);
        numbers.push(number(folds, fold, usize::from(k == 0)));
    }
    for pair in numbers.windows(2) {
        for (fold, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            if !folds[fold].neighbours.contains(&other) {
                folds[fold].neighbours.push(other);
            }
        }
    }
    numbers[0]
}

/// A fold of a segment as one between two samples. `ahead`: the curve comes to it with growing s. The point is in one
/// chart, whichever the curve was in.
fn between(segment: &Segment<'_>, fold: Fold, ahead: bool, onward: bool) -> FoldBetween {
    let chart = segment.chart(&fold.point);
    let point = segment.in_chart(&chart, &fold.point);
    FoldBetween {
        s: if onward { fold.s } else { 1.0 - fold.s },
        error: fold.error,
        vanish: ahead == onward,
        point: point.unwrap_or(fold.point),
        count: 0,
        neighbours: Vec::new(),
    }
}

/// The number of a fold, at which so many more positions end; it may be there already.
fn number(folds: &mut Vec<FoldBetween>, new: FoldBetween, positions: usize) -> usize {
    let same = |fold: &FoldBetween| {
        let size: f64 = new.point.iter().map(|z| z.norm_sqr()).sum();
        let both = new.point.iter().zip(&fold.point);
        let apart: f64 = both.map(|(a, b)| (a - b).norm_sqr()).sum();
        fold.vanish == new.vanish && (fold.s - new.s).abs() < 1e-8 && apart < 1e-12 * size
    };
    let number = folds.iter().position(same).unwrap_or_else(|| {
        folds.push(new);
        folds.len() - 1
    });
    folds[number].count += positions;
    number
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::segment::Equations;
    use cognate_systems::formats::read;

    /// The real roots of x^3 - 3/4 x = p on the way from one p to another: three between the folds at p = -1/4 and 1/4.
    #[test]
    fn branches_between_two_samples_are_counted_at_their_folds() {
        let text = r#"{"variables": ["x"], "parameters": ["p"], "equations": ["x^3 - 3/4*x - p"]}"#;
        let system = read("test", text.as_bytes()).unwrap().system;
        let equations = Equations::of_square(system, Vec::new());
        let real = |v: f64| vec![Complex64::new(v, 0.0)];
        let p = |x: f64| x * x * x - 0.75 * x;
        let joined = |from: f64, to: f64, first: &[f64], second: &[f64]| {
            let points = |roots: &[f64]| roots.iter().map(|x| real(*x)).collect::<Vec<_>>();
            let segment = Segment::new(&equations, &real(from), &real(to));
            join(segment, &points(first), &points(second))
        };
        let joint = joined(p(-1.2), p(1.2), &[-1.2], &[1.2]);
        assert_eq!(joint.onward, [Link::Fold(0)]);
        assert_eq!(joint.back, [Some(Link::Fold(1))]);
        let [end, begin] = &joint.folds[..] else {
            panic!("two folds");
        };
        assert!(end.vanish && !begin.vanish && end.s > begin.s);
        // One of three goes on; of the others one is not listed, so that the fold is not whole.
        let middle = 0.5 * f64::sqrt(3.0);
        let whole = joined(0.0, p(1.2), &[-middle, 0.0, middle], &[1.2]);
        assert_eq!(
            whole.onward,
            [Link::Fold(0), Link::Fold(0), Link::Joined(0)]
        );
        assert_eq!(whole.back, [None]);
        let half = joined(0.0, p(1.2), &[-middle, middle], &[1.2]);
        assert!(matches!(
            half.onward[..],
            [Link::Unknown(_), Link::Joined(0)]
        ));
    }
}
