//! Conjugates: where conjugation leaves the equations as they are, the conjugate of each solution is one. Of a nonreal
//! solution without it one of both is wrong or missing, whatever else speaks for them.

use crate::involution::Involution;
use crate::solution::Solution;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// A conjugate is a solution where all coordinates differ by at most this part of the largest one: more than the error of any
/// nonsingular solution.
const SAME: f64 = 1e-6;

/// A point with the value of a real form there, by which conjugates are found.
struct Point {
    value: f64,
    coordinates: Vec<Complex64>,
}

/// Number of nonsingular solutions, not real, of which no conjugate is among the points.
pub(super) fn without_conjugate(
    solutions: &[Solution],
    undecided: &[Solution],
    involution: &Involution,
) -> u64 {
    let mut random = RandomStream::new(0, Purpose::Probe, 6);
    let weights: Vec<f64> = involution
        .partner
        .iter()
        .map(|_| 1.0 + random.unit().re / 2.0)
        .collect();
    let form = |coordinates: &[Complex64]| -> f64 {
        coordinates
            .iter()
            .zip(&weights)
            .map(|(z, weight)| z.re * weight)
            .sum()
    };
    let point = |solution: &Solution| {
        let coordinates: Vec<Complex64> = solution.variables.values().collect();
        Point {
            value: form(&coordinates),
            coordinates,
        }
    };
    let mut points: Vec<Point> = solutions.iter().chain(undecided).map(point).collect();
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    let has_conjugate = |solution: &&Solution| {
        let coordinates: Vec<Complex64> = solution.variables.values().collect();
        let image = involution.image(&coordinates);
        let error = SAME * size(&image);
        let (value, reach) = (form(&image), 2.0 * error * image.len() as f64);
        let first = points.partition_point(|point| point.value < value - reach);
        let mut near = points[first..]
            .iter()
            .take_while(|point| point.value <= value + reach);
        near.any(|point| {
            let mut both = point.coordinates.iter().zip(&image);
            both.all(|(a, b)| size(&[a - b]) <= error)
        })
    };
    let nonreal = solutions
        .iter()
        .filter(|s| !s.singular && s.real == Some(false));
    let alone = nonreal.filter(|solution| !has_conjugate(solution));
    alone.count() as u64
}

/// The largest real or imaginary part.
fn size(coordinates: &[Complex64]) -> f64 {
    coordinates
        .iter()
        .fold(0.0, |largest, z| largest.max(z.re.abs()).max(z.im.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solution::NamedValues;

    fn solution(path: u64, x: Complex64, y: Complex64) -> Solution {
        let values = [("x".to_string(), x), ("y".to_string(), y)];
        Solution {
            variables: values.into_iter().collect::<NamedValues>(),
            real: Some(x.im == 0.0 && y.im == 0.0),
            paths: vec![path],
            ..Solution::default()
        }
    }

    #[test]
    fn nonreal_solutions_have_conjugates() {
        let (a, b) = (Complex64::new(0.3, 2.0), Complex64::new(-10.0, 4.0));
        let real = solution(0, Complex64::from(1.0), Complex64::from(2.0));
        let involution = Involution {
            partner: vec![0, 1],
        };
        let pair = [solution(1, a, b), solution(2, a.conj(), b.conj()), real];
        assert_eq!(without_conjugate(&pair, &[], &involution), 0);
        assert_eq!(without_conjugate(&pair[..1], &pair[1..], &involution), 0);
        let wrong = solution(2, a.conj(), b.conj() * 1.001);
        assert_eq!(
            without_conjugate(&[pair[0].clone(), wrong], &[], &involution),
            2
        );
        // Variables that are exchanged.
        let exchange = Involution {
            partner: vec![1, 0],
        };
        let pair = [solution(1, a, b), solution(2, b.conj(), a.conj())];
        assert_eq!(without_conjugate(&pair, &[], &exchange), 0);
        assert_eq!(without_conjugate(&pair[..1], &[], &exchange), 1);
    }
}
