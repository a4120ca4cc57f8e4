//! Forty systems by every start that applies: the same regular solutions, point by point.
//!
//! Twenty of them are planted, so that the exact answer is known too. A start that is refused for a
//! system does not apply to it, and one that says that it is not settled is left out; regeneration and loops may say that they do not know whether they have
//! all, and then what they have must be among the others' solutions.

use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod::{
    self, Multihomogeneous, Polyhedral, Regeneration, TotalDegree,
};
use cognate_systems::formats;
use cognate_systems::named::{caprasse, cyclic, eco, katsura, noon, reimer};
use cognate_systems::system::System;
use cognate_tests::planted::kinds::planted;
use cognate_tests::planted::verdict::{Verdict, solve_within};
use cognate_tests::systems::shared;
use num_complex::Complex64;
use std::fmt::Write;
use std::time::Duration;

const STARTS: [SolveMethod; 6] = [
    TotalDegree,
    Multihomogeneous,
    SolveMethod::LINEAR_PRODUCT,
    Polyhedral,
    Regeneration,
    SolveMethod::MONODROMY,
];

/// Largest distance of one solution by two starts, relative to the largest coordinate or 1.
const NEAR: f64 = 1e-7;

/// Three of its nine points have y = 1e-11 and x up to 4e26, and look like points of a curve: the exact count says
/// that there is none, so that no start settles it.
const IN_DOUBT: &str = "planted 113, monomial map";

/// Kinds of planted systems whose solutions are regular and of moderate size.
const PLAIN: [&str; 3] = ["triangular", "forms", "monomial map"];

fn classical() -> Vec<(String, System)> {
    let mut systems = vec![("caprasse".to_string(), caprasse().system)];
    for n in 2..=6 {
        systems.push((format!("katsura-{n}"), katsura(n).system));
    }
    for n in [3, 5] {
        systems.push((format!("cyclic-{n}"), cyclic(n).system));
    }
    for n in [3, 4] {
        systems.push((format!("noon-{n}"), noon(n).system));
    }
    for n in [4, 5, 6] {
        systems.push((format!("eco-{n}"), eco(n).system));
    }
    for n in [2, 3, 4] {
        systems.push((format!("reimer-{n}"), reimer(n).system));
    }
    for name in [
        "three_rpr_real6",
        "burmester_five_poses_real4",
        "planar_3r_inverse_pose",
        "function_generation",
    ] {
        systems.push((name.to_string(), shared(name)));
    }
    systems
}

fn drawn(count: usize) -> Vec<(String, System)> {
    let plain = (0..).map(|number| (number, planted(11, number)));
    let plain = plain.filter(|(_, planted)| {
        let regular = planted.nonsingular() == planted.roots.len() as u64;
        PLAIN.contains(&planted.kind) && regular && planted.roots.len() > 1
    });
    let read = |(number, planted): (u64, cognate_tests::planted::Planted)| {
        let problem = formats::read("planted", planted.file("").as_bytes());
        let problem = problem.expect("it is written as it is read");
        (
            format!("planted {number}, {}", planted.kind),
            problem.system,
        )
    };
    plain.take(count).map(read).collect()
}

/// Most CPU time of one solve: longer ones are left out, and named on the error stream.
const LIMIT: Duration = Duration::from_secs(3);

/// Regular solutions, and whether the answer is settled; the verdict where there is no answer.
fn solved(system: &System, start: SolveMethod) -> Result<(Vec<Vec<Complex64>>, bool), Verdict> {
    let options = SolveOptions {
        method: start,
        seed: 1,
        ..SolveOptions::default()
    };
    let set = solve_within(system, &options, LIMIT)?;
    let regular = set.solutions.iter().filter(|solution| !solution.singular);
    let points = regular.map(|solution| solution.variables.values().collect());
    Ok((points.collect(), set.settled()))
}

fn near(a: &[Complex64], b: &[Complex64]) -> bool {
    let size = a.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr());
    apart.fold(0.0, f64::max) <= NEAR * NEAR * size
}

#[test]
fn the_same_solutions_by_every_start() {
    let mut systems = classical();
    systems.extend(drawn(40 - systems.len()));
    assert_eq!(systems.len(), 40);
    let mut wrong = String::new();
    for (name, system) in &systems {
        let mut reference: Option<(SolveMethod, Vec<Vec<Complex64>>)> = None;
        let mut applied = 0;
        for start in STARTS {
            let (points, settled) = match solved(system, start.clone()) {
                Ok(solved) => solved,
                Err(Verdict::NoEnd) => {
                    eprintln!("{name}: {} did not end", start.name());
                    continue;
                }
                Err(_) => continue,
            };
            if !settled {
                eprintln!("{name}: {} says that it is not settled", start.name());
                continue;
            }
            applied += 1;
            let Some((first, expected)) = &reference else {
                reference = Some((start, points));
                continue;
            };
            let missing = expected
                .iter()
                .filter(|e| !points.iter().any(|p| near(e, p)));
            let more = points
                .iter()
                .filter(|p| !expected.iter().any(|e| near(e, p)));
            let (missing, more) = (missing.count(), more.count());
            let may_miss = matches!(start, Regeneration | SolveMethod::Monodromy(_));
            if more > 0 || (missing > 0 && !may_miss) {
                writeln!(
                    wrong,
                    "{name}: {} lacks {missing} of the {} by {} and has {more} others",
                    start.name(),
                    expected.len(),
                    first.name()
                )
                .expect("text takes all");
            }
        }
        assert!(applied >= 2 || name == IN_DOUBT, "{name}: {applied} starts");
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}
