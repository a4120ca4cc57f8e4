//! Ill-conditioned solutions: other digits of the data in the last place of a double may make one solution of two.

use crate::solution::Solution;
use num_complex::Complex64;

/// Condition number from which on a change in the last place of a double may make one solution of two: they are then
/// some 1e-8 apart.
const ILL_CONDITIONED: f64 = 1e7;
/// Part of their size by which roots of one equation are apart that such a change makes one, at most: three of them are
/// as far apart as the cube root of that change.
const NEAR: f64 = 1e-5;

/// Number of nonsingular solutions with a large condition number. The condition number of a root of one equation is 1;
/// in its place stands the distance to other roots.
pub(super) fn ill_conditioned(solutions: &[Solution]) -> u64 {
    let one_unknown = |s: &Solution| s.variables.0.len() == 1;
    match solutions.iter().all(one_unknown) {
        true => near_roots(solutions),
        false => {
            let is_ill = |s: &&Solution| !s.singular && s.condition > ILL_CONDITIONED;
            solutions.iter().filter(is_ill).count() as u64
        }
    }
}

/// Number of nonsingular roots that are near another root.
fn near_roots(solutions: &[Solution]) -> u64 {
    let mut roots: Vec<(Complex64, bool)> = solutions
        .iter()
        .flat_map(|s| s.variables.values().map(|z| (z, s.singular)))
        .collect();
    roots.sort_by(|(a, _), (b, _)| a.re.total_cmp(&b.re));
    let is_near = |k: usize| {
        let root = roots[k].0;
        let radius = NEAR * root.norm_sqr().sqrt();
        let beside = |other: &&(Complex64, bool)| (other.0.re - root.re).abs() <= radius;
        let after = roots[k + 1..].iter().take_while(beside);
        let before = roots[..k].iter().rev().take_while(beside);
        let mut others = after.chain(before);
        others.any(|(other, _)| (other - root).norm_sqr().sqrt() <= radius)
    };
    (0..roots.len())
        .filter(|&k| !roots[k].1 && is_near(k))
        .count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solution(values: &[f64], condition: f64) -> Solution {
        let value = |re: &f64| ("x".to_owned(), Complex64::new(*re, 0.0));
        Solution {
            variables: values.iter().map(value).collect(),
            condition,
            ..Solution::default()
        }
    }

    #[test]
    fn near_roots_and_large_condition_numbers_count() {
        let roots = [1.0, 3.0, 1.0 + 1e-8, -2.0].map(|x| solution(&[x], 1.0));
        assert_eq!(ill_conditioned(&roots), 2);
        let points = [1e8, 10.0].map(|condition| solution(&[1.0, 2.0], condition));
        assert_eq!(ill_conditioned(&points), 1);
        assert_eq!(ill_conditioned(&[]), 0);
    }
}
