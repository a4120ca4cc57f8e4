//! Families whose loops do not permute at random: the number is right, or the answer says that it is
//! not known.

use crate::check::{SEEDS, seeds_of_slow_answers};
use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::monodromy::counts::Stop;
use cognate_algorithms::plan::{GivenStart, SolveMethod};
use cognate_algorithms::plan::{KnownSolutions, MonodromyOptions};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_solutions::completeness::Completeness;
use cognate_systems::formats;
use cognate_systems::formats::points::{read_parameters, read_solutions};
use std::path::Path;
use std::sync::Arc;

/// The inverse kinematics of all 6R arms as one family, from one posture whose hand is 60 arm's lengths
/// away and nearly isotropic. 16 postures (Raghavan and Roth 1990); loops whose parameters all had
/// the sizes of the start stopped at 4, 4 and 10 of them with seeds 1, 4 and 7.
#[test]
fn all_six_revolute_arms_from_one_far_posture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("families/six_revolute");
    let read = |file: &str| std::fs::read(folder.join(file)).expect("it stands beside the system");
    let problem = formats::read("family.json", &read("family.json"));
    let system = problem.expect("it can be read").system;
    let points = read_solutions("start", &read("start.jsonl"), &system.variables);
    let points = points.expect("it can be read");
    let parameters = read_parameters("start", &read("start_parameters.json"), &system.parameters);
    let parameters = parameters.expect("it can be read");
    let stored = Arc::new(StoredPoints {
        dimension: system.variables.len(),
        coordinates: points.into_iter().flatten().collect(),
    });
    for seed in seeds_of_slow_answers() {
        let options = SolveOptions {
            method: SolveMethod::Monodromy(MonodromyOptions {
                known: KnownSolutions {
                    points: Some(GivenStart {
                        object: stored.digest(),
                        count: 1,
                        dimension: stored.dimension,
                    }),
                    parameters: Some(parameters[0].clone()),
                },
                ..MonodromyOptions::default()
            }),
            seed,
            ..SolveOptions::default()
        };
        let mut plan = plan(&system, &options).expect("it can be planned");
        let find = |_: Digest| Some(Arc::clone(&stored));
        let sets = run_locally(&plan.system, &mut plan.algorithm, &find, 8);
        let sets = sets.expect("it can be solved");
        let loops = plan.algorithm.loops().expect("loops were made");
        assert_eq!(sets[0].counts.nonsingular, 16, "seed {seed}: {loops:?}");
        let said = plan.algorithm.completeness().expect("loops have ended");
        assert_eq!(said.complete, Completeness::NotKnown, "{}", said.reason);
    }
}

/// As many solutions as were asked for are complete.
#[test]
fn an_expected_number_makes_an_answer_complete() {
    let system = cognate_tests::systems::written(
        "variable_group x; parameter p, q; function f; f = x^3 + p*x + q;",
    );
    let options = SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                count: Some(3),
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        ..SolveOptions::default()
    };
    let mut plan = plan(&system, &options).expect("it can be planned");
    run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8).expect("it can be solved");
    let loops = plan.algorithm.loops().expect("loops were made");
    assert_eq!(loops.stop, Some(Stop::Count));
    let said = plan.algorithm.completeness().expect("loops have ended");
    assert_eq!(said.complete, Completeness::Yes);
}

/// x^7 = p has one branch point: loops turn the solutions in a circle or leave all where they are, more
/// often than random ones do. All are found; no confidence is claimed.
#[test]
fn no_confidence_where_loops_do_not_mix() {
    let system =
        cognate_tests::systems::written("variable_group x; parameter p; function f; f = x^7 - p;");
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::MONODROMY,
            seed,
            ..SolveOptions::default()
        };
        let mut plan = plan(&system, &options).expect("it can be planned");
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        let sets = sets.expect("it can be solved");
        let loops = plan.algorithm.loops().expect("loops were made");
        assert_eq!(sets[0].counts.nonsingular, 7, "seed {seed}: {loops:?}");
        let confidence = loops.estimate.as_ref().map_or(0.0, |e| e.confidence);
        assert!(confidence == 0.0, "seed {seed}: {loops:?}");
    }
}
