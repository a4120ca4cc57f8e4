//! Candidates: the endpoints whose local dimension is asked, as the stored points of a stage.

use super::Question;
use crate::start_points::StoredPoints;
use num_complex::Complex64;

/// An endpoint whose local dimension is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Values of the system's variables.
    pub values: Vec<Complex64>,
    /// Index of the target at which the point is a solution; 0 where there is one target.
    pub target: u64,
    /// Accuracy, bound of the multiplicity and depth for the test of this point.
    pub question: Question,
}

/// Value of `bound` that stands for an unknown bound: 2^53.
const NO_BOUND: u64 = 1 << 53;

/// Numbers beside the variables in a stored row: accuracy and bound, target.
pub const EXTRA: usize = 2;

/// The candidates as rows of one object: the variables, `accuracy + i bound`, `target + i depth`.
pub fn to_stored(candidates: &[Candidate]) -> StoredPoints {
    let dimension = candidates.first().map_or(0, |c| c.values.len()) + EXTRA;
    let mut coordinates = Vec::with_capacity(candidates.len() * dimension);
    for candidate in candidates {
        assert_eq!(
            candidate.values.len() + EXTRA,
            dimension,
            "candidates are points of one space"
        );
        coordinates.extend_from_slice(&candidate.values);
        let Question {
            accuracy,
            bound,
            depth,
        } = candidate.question;
        // An unknown accuracy is as bad as can be. Bounds below 2^53 are exact, others are none.
        let accuracy = if accuracy.is_finite() { accuracy } else { 1.0 };
        coordinates.push(Complex64::new(accuracy, bound.min(NO_BOUND) as f64));
        coordinates.push(Complex64::new(candidate.target as f64, f64::from(depth)));
    }
    StoredPoints {
        dimension,
        coordinates,
    }
}

/// Reads one row of what [`to_stored`] wrote; `None` where the numbers beside the variables are none
/// of ours.
pub fn from_stored(points: &StoredPoints, index: usize) -> Option<Candidate> {
    let row = points.point(index);
    let (values, extra) = row.split_at_checked(row.len().checked_sub(EXTRA)?)?;
    let whole = |x: f64| (x >= 0.0 && x <= NO_BOUND as f64 && x == x.trunc()).then_some(x as u64);
    let bound = whole(extra[0].im)?;
    let accuracy = extra[0].re;
    Some(Candidate {
        values: values.to_vec(),
        target: whole(extra[1].re)?,
        question: Question {
            accuracy: (accuracy >= 0.0).then_some(accuracy)?,
            bound: if bound == NO_BOUND { u64::MAX } else { bound },
            depth: u32::try_from(whole(extra[1].im)?).ok()?,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_come_back() {
        let candidate = |k: u64| Candidate {
            values: vec![Complex64::new(k as f64, 0.5), Complex64::new(-1e9, 0.0)],
            target: k,
            question: Question {
                accuracy: 1e-9,
                bound: if k == 0 { u64::MAX } else { 16 },
                depth: 30,
            },
        };
        let candidates = [candidate(0), candidate(7)];
        let stored = to_stored(&candidates);
        assert_eq!((stored.len(), stored.dimension), (2, 4));
        for (k, expected) in candidates.iter().enumerate() {
            assert_eq!(from_stored(&stored, k).as_ref(), Some(expected));
        }
        let mut damaged = stored;
        damaged.coordinates[3].re = 0.5;
        assert_eq!(from_stored(&damaged, 0), None);
    }
}
