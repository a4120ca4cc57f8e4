//! Which certified solutions are proved to be different from all others, in n log n.
//!
//! A random function of the point, enclosed for every box, orders the boxes;
//! only those whose enclosures meet are compared coordinate by coordinate.

use super::boxes::{self, Groups};
use cognate_continuation::certification::Certificate;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Interval, MultiplePrecision};

/// Whether one certified solution differs from all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distinctness {
    /// The solution differs from every other certified solution.
    Proved,
    /// The solution is the same as another one.
    Duplicate,
    /// The box of this solution meets the box of another one, and neither is certain to hold the solution of the other.
    Undecided,
}

/// Decides for each certificate whether its solution differs from all others.
pub fn judge(certificates: &[&Certificate], groups: &Groups, seed: u64) -> Vec<Distinctness> {
    let mut verdicts = vec![Distinctness::Proved; certificates.len()];
    let keys = keys(certificates, groups, seed);
    let mut order: Vec<usize> = (0..certificates.len()).collect();
    order.sort_by(|&a, &b| keys[a].0.total_cmp(&keys[b].0).then(a.cmp(&b)));
    for (place, &a) in order.iter().enumerate() {
        let later = order[place + 1..].iter();
        for &b in later.take_while(|&&b| keys[b].0 <= keys[a].1) {
            let verdict = compare(certificates[a], certificates[b], groups);
            for i in [a, b] {
                // A duplicate stays one, whatever else it meets.
                if verdict == Distinctness::Duplicate || verdicts[i] == Distinctness::Proved {
                    verdicts[i] = verdict;
                }
            }
        }
    }
    verdicts
}

/// An interval for each certificate that holds the value of one function at its solution. The
/// function does not see factors of homogeneous groups.
fn keys(certificates: &[&Certificate], groups: &Groups, seed: u64) -> Vec<(f64, f64)> {
    let mut random = RandomStream::new(seed, Purpose::Probe, 2);
    let mut linear = |variables: &[usize]| -> Vec<(usize, Complex<Interval<f64>>)> {
        let coefficient = |stream: &mut RandomStream| {
            let z = stream.unit();
            Complex::from_f64((), z.re, z.im)
        };
        let indices = variables.iter();
        indices.map(|&v| (v, coefficient(&mut random))).collect()
    };
    let affine = linear(&groups.affine);
    let ratios: Vec<_> = groups
        .homogeneous
        .iter()
        .map(|group| (linear(group), linear(group)))
        .collect();
    certificates
        .iter()
        .map(|certificate| {
            let values = certificate.lies_in::<f64>(());
            let at = |form: &[(usize, Complex<Interval<f64>>)]| {
                let mut sum = Complex::zero(());
                for (v, coefficient) in form {
                    sum.mul_add(coefficient, &values[*v]);
                }
                sum
            };
            let mut key = at(&affine);
            for (above, below) in &ratios {
                let mut ratio = at(above);
                ratio.div(&at(below));
                key.add(&ratio);
            }
            if key.re.is_valid() {
                (*key.re.lower(), *key.re.upper())
            } else {
                // It may be anything: it is compared with all.
                (f64::NEG_INFINITY, f64::INFINITY)
            }
        })
        .collect()
}

fn compare(a: &Certificate, b: &Certificate, groups: &Groups) -> Distinctness {
    let bits = boxes::bits(a).max(boxes::bits(b));
    let (in_a, in_b) = (
        a.lies_in::<MultiplePrecision>(bits),
        b.lies_in::<MultiplePrecision>(bits),
    );
    let b_in_chart_of_a = groups.to_chart_of(a, in_b.clone());
    if boxes::disjoint(&in_a, &b_in_chart_of_a) {
        Distinctness::Proved
    } else if boxes::inside(&b_in_chart_of_a, a) || boxes::inside(&groups.to_chart_of(b, in_a), b) {
        // In one box there is only one.
        Distinctness::Duplicate
    } else {
        Distinctness::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::rational::{ComplexRational, Rational};

    fn certificate(centre: &[f64], radius: f64, error: f64) -> Certificate {
        let exact = |x: &f64| ComplexRational::real(Rational::from_f64(*x).unwrap());
        Certificate {
            centre: centre.iter().map(exact).collect(),
            radius: centre.iter().map(|_| radius).collect(),
            error: centre.iter().map(|_| error).collect(),
            contraction: 0.1,
            precision_bits: 53,
        }
    }

    #[test]
    fn neighbours_touching_boxes_and_duplicates_are_told_apart() {
        let groups = Groups {
            homogeneous: vec![],
            affine: vec![0, 1],
        };
        let boxes = [
            certificate(&[0.0, 0.0], 1e-3, 1e-6),
            certificate(&[0.0, 1e-4], 1e-3, 1e-6), // its solution is in the first box, not the first's
            certificate(&[5.0, 0.0], 1e-3, 1e-4),
            certificate(&[5.0, 1.1e-4], 1e-3, 1e-4), // both boxes hold both
            certificate(&[7.0, 0.0], 1e-3, 0.9e-3),
            certificate(&[7.0, 1.5e-3], 1e-3, 0.9e-3), // they meet, and that is all
            certificate(&[9.0, 0.0], 1e-3, 1e-4),
            certificate(&[9.0, 2.5e-4], 1e-3, 1e-4), // near, but apart
        ];
        let certificates: Vec<&Certificate> = boxes.iter().collect();
        use Distinctness::{Duplicate, Proved, Undecided};
        for seed in 0..5 {
            let verdicts = judge(&certificates, &groups, seed);
            assert_eq!(
                verdicts,
                [
                    Proved, Proved, Duplicate, Duplicate, Undecided, Undecided, Proved, Proved
                ]
            );
        }
    }

    #[test]
    fn points_of_two_charts_are_compared_in_one() {
        let groups = Groups {
            homogeneous: vec![vec![0, 1]],
            affine: vec![],
        };
        let in_chart = |fixed: usize, other: f64| {
            let mut point = certificate(&[1.0, 1.0], 1e-6, 1e-9);
            point.radius[fixed] = 0.0;
            point.error[fixed] = 0.0;
            point.centre[1 - fixed] = ComplexRational::real(Rational::from_f64(other).unwrap());
            point
        };
        // (1 : 0.5), (2 : 1) again, (1 : -0.5), (-1 : 1).
        let points = [
            in_chart(0, 0.5),
            in_chart(1, 2.0),
            in_chart(0, -0.5),
            in_chart(1, -1.0),
        ];
        let certificates: Vec<&Certificate> = points.iter().collect();
        use Distinctness::{Duplicate, Proved};
        assert_eq!(
            judge(&certificates, &groups, 4),
            [Duplicate, Duplicate, Proved, Proved]
        );
    }

    #[test]
    fn a_hundred_thousand_boxes_take_no_time() {
        let groups = Groups {
            homogeneous: vec![],
            affine: vec![0],
        };
        let boxes: Vec<Certificate> = (0..100_000)
            .map(|k| certificate(&[f64::from(k)], 1e-9, 1e-12))
            .collect();
        let certificates: Vec<&Certificate> = boxes.iter().collect();
        assert!(
            judge(&certificates, &groups, 0)
                .iter()
                .all(|v| *v == Distinctness::Proved)
        );
    }
}
