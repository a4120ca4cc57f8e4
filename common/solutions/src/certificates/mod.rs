//! Facts that the certificates of all solutions prove together: which solutions differ, which are real, how many there
//! are.
//!
//! A worker proves that a box holds one solution; two disjoint boxes then hold
//! two, and where the system is invariant under its involution, a box that the
//! image of its solution cannot leave holds a fixed point. All of it by exact
//! comparisons or outward-rounded intervals; what is not proved is not counted.

mod boxes;
mod distinct;
mod line;
mod reality;

pub use boxes::Groups;
pub use distinct::{Distinctness, judge};
pub use line::{Attempt, CertifiedCoordinate, CertifiedSystem, SolutionCertificate};
pub use reality::judge as judge_reality;

use crate::involution::Involution;
use crate::solution_set::SolutionSet;
use cognate_continuation::certification::{Certificate, certified_system};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Adds to a finished set what was certified of its solutions.
///
/// `attempt` gives, for a path, what was found at its endpoint; outer `None` where nothing was
/// asked. `parameters` are the system's at this target.
pub fn certify<'a>(
    set: &mut SolutionSet,
    system: &System,
    parameters: &[Complex64],
    attempt: &dyn Fn(u64) -> Option<&'a Attempt>,
    seed: u64,
) {
    // Combinations of invariant equations need not be invariant; what is proved is about them.
    let square = certified_system(system, seed).ok();
    let involution = square
        .as_ref()
        .and_then(|square| Involution::of(square, parameters).ok());
    let groups = Groups::of(system);
    let attempts: Vec<Option<&Attempt>> = set
        .solutions
        .iter()
        .map(|solution| {
            let mut of_paths = solution.paths.iter().map(|&path| attempt(path));
            of_paths.find(Option::is_some).flatten()
        })
        .collect();
    let certificates: Vec<(usize, &Certificate)> = attempts
        .iter()
        .enumerate()
        .filter_map(|(place, attempt)| {
            let certificate = attempt.as_ref()?.as_ref()?.certificate()?;
            (certificate.is_sound() && certificate.dimension() == system.variable_count())
                .then_some((place, certificate))
        })
        .collect();
    let only: Vec<&Certificate> = certificates
        .iter()
        .map(|(_, certificate)| *certificate)
        .collect();
    let distinct = distinct::judge(&only, &groups, seed);
    let (mut certified, mut certified_real, mut unproved) = (0, 0, 0);
    let mut lines: Vec<SolutionCertificate> = set
        .solutions
        .iter()
        .zip(&attempts)
        .map(|(solution, attempt)| SolutionCertificate::refused(solution.singular, *attempt))
        .collect();
    for ((place, certificate), distinctness) in certificates.iter().zip(&distinct) {
        let real = involution
            .as_ref()
            .and_then(|involution| reality::judge(certificate, &groups, involution));
        lines[*place] = SolutionCertificate::proved(certificate, system, *distinctness, real);
        let counted = *distinctness == Distinctness::Proved;
        certified += u64::from(counted);
        certified_real += u64::from(counted && real == Some(true));
        unproved += u64::from(!counted);
        if real.is_some() {
            set.solutions[*place].real = real;
        }
    }
    for (solution, line) in set.solutions.iter_mut().zip(lines) {
        solution.certificate = Some(line);
    }
    set.counts.certified = Some(certified);
    if involution.is_some() {
        set.counts.certified_real = Some(certified_real);
        let reals = set.solutions.iter().filter(|s| s.real == Some(true));
        set.counts.real = Some(reals.count() as u64);
    }
    let left = set.counts.nonsingular.saturating_sub(certified + unproved);
    if left > 0 {
        set.warnings.push(format!(
            "{left} nonsingular solution{} not certified; solutions.jsonl says why for each",
            if left == 1 { " is" } else { "s are" },
        ));
    }
    if unproved > 0 {
        set.warnings.push(format!(
            "{unproved} certified boxes overlap another: these solutions may be one and the same, \
             and are not counted as certified"
        ));
    }
    if system.equation_count() > system.dimension() {
        set.warnings.push(
            "the certificates are of the squared-up system: they prove solutions of combinations \
             of the equations, not that the equations themselves vanish"
                .to_string(),
        );
    }
    let invariant = involution.is_some();
    let combinations = square.filter(|_| system.equation_count() > system.dimension());
    set.certified_system = Some(CertifiedSystem::of(
        system,
        parameters,
        invariant,
        combinations.as_deref(),
    ));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::Tolerances;
    use crate::solution_set::History;
    use crate::test_results::{isolated, regular};
    use cognate_continuation::certification::{Certification, Krawczyk, Uncertified};
    use cognate_systems::formats::read;
    use std::collections::HashMap;

    /// x^2 = 2 and y = x (1 + i)/2, y = 0 twice: with a singular end that is made up.
    fn system() -> System {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f, g; \
                    f = x^2 - 0.1; g = y^2 + x;\nEND;\n";
        read("test", text.as_bytes()).unwrap().system
    }

    fn solve(duplicate: bool, lost: bool) -> SolutionSet {
        let system = system();
        let root = 0.1f64.sqrt();
        let side = root.sqrt();
        let mut points = vec![
            [(1.0, 0.0), (root, 0.0), (0.0, side)],
            [(1.0, 0.0), (root, 0.0), (0.0, -side)],
            [(1.0, 0.0), (-root, 0.0), (side, 0.0)],
            [(1.0, 0.0), (-root, 0.0), (-side, 0.0)],
        ];
        if duplicate {
            // Not near enough to be merged, but Newton's method brings it to the first one.
            points.push([(1.0, 0.0), (root, 0.0), (1e-6, side)]);
        }
        let mut results: Vec<_> = (0..).zip(&points).map(|(k, p)| regular(k, p)).collect();
        results.push(isolated(
            points.len() as u64,
            &[(1.0, 0.0), (0.0, 0.0), (0.0, 0.0)],
            1,
            &[0],
            2,
        ));
        let mut set = SolutionSet::new(
            &system,
            &[],
            &results,
            &History::default(),
            &Tolerances::default(),
            1,
        );
        let krawczyk = Krawczyk::new(&system);
        let attempts: HashMap<u64, Attempt> = (0..)
            .zip(&points)
            .map(|(k, p)| {
                let values: Vec<_> = p[1..].iter().map(|&(a, b)| Complex64::new(a, b)).collect();
                let attempt = Some(krawczyk.certify(&[], &values));
                (k, if lost && k == 1 { None } else { attempt })
            })
            .collect();
        certify(&mut set, &system, &[], &|path| attempts.get(&path), 3);
        set
    }

    fn certificate(set: &SolutionSet, k: usize) -> &SolutionCertificate {
        set.solutions[k].certificate.as_ref().unwrap()
    }

    #[test]
    fn regular_solutions_are_certified_distinct_and_real_or_not() {
        let set = solve(false, false);
        assert_eq!(
            (set.counts.certified, set.counts.certified_real),
            (Some(4), Some(2))
        );
        for (k, real) in [(0, false), (1, false), (2, true), (3, true)] {
            let proof = certificate(&set, k);
            assert!(proof.certified && proof.distinct == Some(true));
            assert_eq!(proof.real, Some(real));
            assert_eq!(proof.coordinates.len(), 2);
        }
        // The singular one is told why, and is not counted.
        let refused = certificate(&set, 4);
        assert!(!refused.certified && refused.reason.as_deref().unwrap().contains("singular"));
        assert!(
            set.warnings.iter().all(|w| !w.contains("certif")),
            "{:?}",
            set.warnings
        );
    }

    #[test]
    fn two_boxes_around_one_solution_are_not_two_solutions() {
        let set = solve(true, false);
        assert_eq!(set.counts.nonsingular, 5);
        assert_eq!(set.counts.certified, Some(3));
        for k in [0, 4] {
            assert_eq!(certificate(&set, k).distinct, Some(false));
        }
        assert!(set.warnings.iter().any(|w| w.contains("overlap")));
    }

    #[test]
    fn an_attempt_that_was_lost_is_no_certificate() {
        let set = solve(false, true);
        assert_eq!(set.counts.certified, Some(3));
        let lost = certificate(&set, 1);
        assert!(!lost.certified && lost.reason.as_deref().unwrap().contains("worker"));
        assert!(
            set.warnings
                .iter()
                .any(|w| w.contains("1 nonsingular solution is not certified"))
        );
        let refused = SolutionCertificate::refused(
            false,
            Some(&Some(Certification::Uncertified(Uncertified::NewtonLeaves))),
        );
        assert_eq!(refused.reason.as_deref(), Some("Newton's method leaves it"));
    }
}
