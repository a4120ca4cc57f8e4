//! Joints of a path of targets: which positions of two neighbouring samples are joined, and where the others end.

use super::segment::Segment;
use super::tube::{Followed, follow, located};
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
    /// How many positions end there.
    count: usize,
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
        let link = one(&segment, point, second, true, &mut joint.folds);
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
            Some(match one(&back, point, first, false, &mut joint.folds) {
                Link::Joined(_) => Link::Unknown(NOT_BACK),
                link => link,
            })
        };
        joint.back.push(back_link);
    }
    let is_half = |link: &Link| matches!(link, Link::Fold(fold) if joint.folds[*fold].count != 2);
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

/// Follows one position to the neighbour.
fn one(
    segment: &Segment<'_>,
    point: &[Complex64],
    others: &[Vec<Complex64>],
    onward: bool,
    folds: &mut Vec<FoldBetween>,
) -> Link {
    let chart = segment.chart(point);
    let Some(start) = segment.in_chart(&chart, point) else {
        return Link::Unknown(NO_SOLUTION);
    };
    let mut curve = segment.curve(&chart);
    match follow(&mut curve, &start) {
        None => Link::Unknown(NO_SOLUTION),
        Some(Followed::Arrived(there)) => {
            for (place, other) in others.iter().enumerate() {
                let other = segment.in_chart(&chart, other);
                let other = other.and_then(|other| located(&mut curve, &other, 1.0));
                if other.is_some_and(|other| other.holds(&there, &curve)) {
                    return Link::Joined(place);
                }
            }
            Link::Unknown(NOT_LISTED)
        }
        Some(Followed::Stopped { s, point }) => {
            let fold = segment
                .folds(&chart)
                .near(&mut curve, segment.ends(), &point, s);
            match fold {
                // Beyond the place where the curve stopped, and not far.
                Some(fold) if fold.s >= s => {
                    let (s, error) = (if onward { fold.s } else { 1.0 - fold.s }, fold.error);
                    // In one chart, whichever the curve was in.
                    let chart = segment.chart(&fold.point);
                    let point = segment.in_chart(&chart, &fold.point).unwrap_or(fold.point);
                    Link::Fold(number(folds, s, error, onward, point))
                }
                _ => Link::Unknown(NO_FOLD),
            }
        }
    }
}

/// The number of a fold; it may be there already.
fn number(
    folds: &mut Vec<FoldBetween>,
    s: f64,
    error: Option<f64>,
    vanish: bool,
    point: Vec<Complex64>,
) -> usize {
    let same = |fold: &FoldBetween| {
        let size: f64 = point.iter().map(|z| z.norm_sqr()).sum();
        let apart: f64 = point
            .iter()
            .zip(&fold.point)
            .map(|(a, b)| (a - b).norm_sqr())
            .sum();
        fold.vanish == vanish && (fold.s - s).abs() < 1e-8 && apart < 1e-12 * size
    };
    if let Some(listed_fold) = folds.iter().position(same) {
        folds[listed_fold].count += 1;
        return listed_fold;
    }
    folds.push(FoldBetween {
        s,
        error,
        vanish,
        point,
        count: 1,
    });
    folds.len() - 1
}
