//! Families whose numbers of solutions are known.

use super::counts::{Mixing, TraceForm, moving};
use super::graph::{Correspondence, Direction, FIRST, LoopPermutation, PathBatch};
use super::loop_limits::IDLE_PATHS;
use super::orbits::RegularSolution;
use super::warnings::probability_of_hiding;
use super::*;
use crate::any_algorithm::{AnyAlgorithm, AnySolve};
use crate::opening::Opening;
use crate::plan::{GivenStart, Plan, SolveMethod, SolveOptions, plan};
use crate::plan::{KnownSolutions, MonodromyOptions};
use crate::run_locally::{drive, run_locally};
use crate::solve::PathAlgorithm;
use crate::synthetic::written;
use cognate_continuation::homotopies::{HomotopyKind, way_back};
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::Stage;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::completeness::Completeness;
use std::collections::HashMap;
use std::sync::Arc;

/// Two general cubics: 9 solutions.
const CUBICS: &str = "CONFIG END; INPUT variable_group x, y;
    parameter a0, a1, a2, a3, a4, a5, b0, b1, b2, b3, b4, b5; function f, g;
    f = a0*x^3 + a1*x^2*y + a2*y^3 + a3*x*y + a4*y + a5;
    g = b0*x^3 + b1*x*y^2 + b2*y^3 + b3*x^2 + b4*x + b5; END;";

/// x^4 + p x^2 y^2 + y^4 = q, x y = r: 8 solutions, under signs and exchange 2 classes of 4.
fn symmetric(symmetry: &str) -> System {
    written(&format!(
        r#"{{"variables": ["x", "y"], "parameters": ["p", "q", "r"],
            "equations": ["x^4 + p*x^2*y^2 + y^4 - q", "x*y - r"], "symmetry": {symmetry}}}"#
    ))
}

const TRUE_SYMMETRY: &str =
    r#"[{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "-x", "y": "-y"}}]"#;

fn monodromy(system: &System, seed: u64) -> Plan {
    let options = SolveOptions {
        method: SolveMethod::MONODROMY,
        seed,
        ..SolveOptions::default()
    };
    match plan(system, &options) {
        Ok(plan) => plan,
        Err(error) => panic!("{error}"),
    }
}

fn solve(plan: &mut Plan) -> (SolutionSet, LoopCounts) {
    let sets = match run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8) {
        Ok(sets) => sets,
        Err(error) => panic!("{error}"),
    };
    assert_eq!(sets.len(), 1);
    let counts = plan
        .algorithm
        .loops()
        .expect("it is a monodromy solve")
        .clone();
    (sets.into_iter().next().expect("there is one"), counts)
}

#[test]
fn everything_is_found_from_one_point_that_is_found_too() {
    let system = written(CUBICS);
    for seed in 0..10 {
        let (set, counts) = solve(&mut monodromy(&system, seed));
        assert_eq!((set.paths.total, set.paths.finite), (9, 9), "seed {seed}");
        assert_eq!((set.counts.distinct, counts.solutions), (9, 9));
        assert_eq!(counts.stop, Some(Stop::IdleLoops));
        assert!(set.settled() && counts.idle_loops >= 5 && counts.lost == 0);
        let said = |w: &String| w.contains("no proof") || w.contains("no evidence");
        assert!(set.warnings.iter().any(said), "{:?}", set.warnings);
    }
}

/// A rule that looks at how often solutions were met again, for two families.
#[test]
fn loops_end_when_an_estimate_is_certain_enough() {
    let options = |seed: u64| SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                confidence: Some(0.9999),
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        seed,
        ..SolveOptions::default()
    };
    for (system, classes) in [(written(CUBICS), 9), (symmetric(TRUE_SYMMETRY), 2)] {
        for seed in 0..10 {
            let sure = options(seed);
            let (set, counts) = solve(&mut plan(&system, &sure).unwrap());
            assert_eq!((counts.classes, counts.lost), (classes, 0), "seed {seed}");
            assert_eq!(
                counts.stop,
                Some(Stop::Confidence),
                "seed {seed}: {counts:?}"
            );
            let estimate = counts.estimate.unwrap();
            assert_eq!(estimate.likeliest, Some(classes));
            assert!(estimate.confidence >= 0.9999, "{estimate:?}");
            let said = |w: &String| {
                w.contains("if loops permute all solutions at random") && w.contains("99.99")
            };
            assert!(set.warnings.iter().any(said), "{:?}", set.warnings);
        }
    }
}

#[test]
fn a_probability_is_written_with_its_nines() {
    use estimate::percent;
    assert_eq!(percent(0.5), "50.0 %");
    assert_eq!(percent(0.99892), "99.8 %");
    assert_eq!(percent(0.99995), "99.995 %");
    assert!(percent(1.0).starts_with("99.99999"));
}

/// Loops that permute three points in all ways fix one on average; loops that do nothing, or nearly, do not.
#[test]
fn mixing_is_seen_by_how_many_points_stay() {
    let symmetric_group = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let loops = |permutations: &[[u32; 3]]| -> Vec<LoopPermutation> {
        let numbered_images = permutations.iter().cycle().take(24).enumerate();
        numbered_images
            .map(|(edge, images)| LoopPermutation {
                edge,
                images: images.map(Some).to_vec(),
            })
            .collect()
    };
    let random = Mixing::of(&loops(&symmetric_group));
    assert_eq!(
        (random.loops, random.moving, random.fixed),
        (24, 20, Some(1.0))
    );
    assert!(random.is_shown(3) && !random.is_shown(1));
    let lazy = Mixing::of(&loops(&[
        symmetric_group[0],
        symmetric_group[0],
        symmetric_group[1],
    ]));
    assert_eq!(lazy.moving, 8);
    assert!(!lazy.is_shown(3));
    assert_eq!(
        moving(&loops(&[symmetric_group[0], symmetric_group[1]]), 20),
        2
    );
}

/// The case in which others stop too early: loops of three points are often trivial.
#[test]
fn few_solutions_get_many_loops() {
    let text = "CONFIG END; INPUT variable_group x; parameter p; function f; f = x^3 - p; END;";
    for seed in 0..10 {
        let (set, counts) = solve(&mut monodromy(&written(text), seed));
        assert_eq!(set.counts.distinct, 3, "seed {seed}: {counts:?}");
        assert!(counts.idle_loops >= MOST_IDLE);
    }
}

#[test]
fn a_known_count_ends_the_loops() {
    let options = |count| SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                count: Some(count),
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        ..SolveOptions::default()
    };
    let system = written(CUBICS);
    let (set, counts) = solve(&mut plan(&system, &options(9)).unwrap());
    assert_eq!((set.counts.distinct, counts.stop), (9, Some(Stop::Count)));
    assert_eq!(set.warnings, Vec::<String>::new());
    let (set, counts) = solve(&mut plan(&system, &options(10)).unwrap());
    assert_eq!(
        (set.counts.distinct, counts.stop),
        (9, Some(Stop::IdleLoops))
    );
    assert!(set.warnings[0].starts_with("10 solutions asked for"));
}

#[test]
fn one_of_each_orbit_is_tracked() {
    let system = symmetric(TRUE_SYMMETRY);
    let (set, counts) = solve(&mut monodromy(&system, 4));
    assert_eq!((set.counts.distinct, counts.solutions), (8, 8));
    assert_eq!((counts.group_order, counts.classes), (4, 2));
    let classes = &set.classes;
    assert_eq!((classes.count, classes.group_order), (Some(2), Some(4)));
    assert_eq!(classes.complete, Some(2));
    let class_size = |class| {
        set.solutions
            .iter()
            .filter(|s| s.class == Some(class))
            .count()
    };
    assert_eq!((class_size(0), class_size(1)), (4, 4));
    let (plain, plain_counts) = solve(&mut monodromy(&symmetric("[]"), 4));
    assert_eq!((plain.counts.distinct, plain_counts.classes), (8, 8));
}

#[test]
fn what_is_no_symmetry_is_not_believed() {
    let wrong = r#"[{"map": {"x": "-x"}}]"#;
    let (set, counts) = solve(&mut monodromy(&symmetric(wrong), 4));
    assert_eq!((set.counts.distinct, counts.group_order), (8, 1));
    let said = "the symmetry group is not used: of the 2 images of a solution only 1 are solutions";
    assert!(set.warnings.iter().any(|w| w == said), "{:?}", set.warnings);
}

/// A given start pair, other wanted parameters: x^4 = p from (2, 16) to p = 81 and p = 0.
#[test]
fn given_solutions_lead_to_given_parameters() {
    let system = crate::synthetic::system();
    let number = |re: f64| vec![Complex64::new(re, 0.0)];
    let solve_from = |x: f64| {
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: number(x),
        });
        let options = SolveOptions {
            method: SolveMethod::Monodromy(MonodromyOptions {
                known: KnownSolutions {
                    points: Some(GivenStart {
                        object: points.digest(),
                        count: 1,
                        dimension: 1,
                    }),
                    parameters: Some(number(16.0)),
                },
                ..MonodromyOptions::default()
            }),
            target_parameters: vec![number(81.0), number(0.0)],
            ..SolveOptions::default()
        };
        let mut plan = plan(&system, &options).unwrap();
        let find = |_: Digest| Some(Arc::clone(&points));
        let sets = run_locally(&plan.system, &mut plan.algorithm, &find, 8).unwrap();
        (sets, plan.algorithm.loops().unwrap().stop)
    };
    let (sets, _) = solve_from(2.0);
    assert_eq!((sets[0].counts.distinct, sets[0].counts.real), (4, Some(2)));
    assert_eq!(
        (sets[1].counts.singular, sets[1].counts.with_multiplicity),
        (1, 4)
    );
    let (sets, stop) = solve_from(3.0);
    assert_eq!((sets.len(), stop), (2, Some(Stop::NoStart)));
    assert_eq!((sets[0].paths.total, sets[0].paths.failed), (1, 1));
    assert!(!sets[0].settled());
}

#[test]
fn a_restored_solve_goes_on_to_the_same_answer() {
    let system = symmetric(TRUE_SYMMETRY);
    let expected = solve(&mut monodromy(&system, 9));
    // A new process before every step; stages are absorbed in the order of their numbers.
    let mut plan = monodromy(&system, 9);
    let mut objects = HashMap::new();
    let mut open = Vec::new();
    loop {
        let restored = AnyAlgorithm::restore(&plan.algorithm.snapshot()).unwrap();
        assert_eq!(restored, plan.algorithm);
        plan.algorithm = restored;
        match plan.algorithm.next() {
            Next::Open(opening) => {
                for points in &opening.objects {
                    objects.insert(points.digest(), Arc::clone(points));
                }
                open.push(opening.stage);
            }
            Next::Wait => {
                let stage = open.remove(0);
                let find = |digest: Digest| objects.get(&digest).cloned();
                let prepared = PreparedStage::new(&system, &stage, &find).unwrap();
                let results = prepared.track(0..prepared.items(), 1);
                let mut results = results.into_iter().map(ItemResult::from);
                plan.algorithm.absorb(stage.id, &mut results);
            }
            Next::Done => break,
        }
    }
    let sets = plan.algorithm.solution_sets(&system);
    assert_eq!(
        (sets[0].clone(), plan.algorithm.loops().unwrap().clone()),
        expected
    );
}

/// Whatever order the stages of a round come back in, the solve goes on the same way.
#[test]
fn the_order_of_stages_does_not_matter() {
    let system = written(CUBICS);
    let expected = solve(&mut monodromy(&system, 2));
    let mut plan = monodromy(&system, 2);
    let mut objects = HashMap::new();
    let mut open = Vec::new();
    loop {
        match plan.algorithm.next() {
            Next::Open(opening) => {
                for points in &opening.objects {
                    objects.insert(points.digest(), Arc::clone(points));
                }
                open.push(opening.stage);
            }
            Next::Wait => {
                // The last first.
                let stage = open.pop().unwrap();
                let find = |digest: Digest| objects.get(&digest).cloned();
                let prepared = PreparedStage::new(&system, &stage, &find).unwrap();
                let results = prepared.track(0..prepared.items(), 8);
                let mut results = results.into_iter().map(ItemResult::from);
                plan.algorithm.absorb(stage.id, &mut results);
            }
            Next::Done => break,
        }
    }
    let sets = plan.algorithm.solution_sets(&system);
    assert_eq!(
        (sets[0].clone(), plan.algorithm.loops().unwrap().clone()),
        expected
    );
}

/// Every pair of every edge is found from either end; another detour back leads elsewhere.
#[test]
fn an_edge_leads_back_to_where_it_came_from() {
    let system = written(CUBICS);
    let mut plan = monodromy(&system, 3);
    solve(&mut plan);
    let AnySolve::Monodromy(mut solved) = plan.algorithm.solve().clone() else {
        panic!("it is a monodromy solve")
    };
    let partners = |solved: &MonodromySolve, edge: usize, direction: Direction| -> Vec<usize> {
        let opening = solved.search_stages().batch(&PathBatch {
            edge,
            direction,
            attempt: 0,
            sources: (0..9).collect(),
        });
        let find = |_: Digest| opening.objects.first().cloned();
        let prepared = PreparedStage::new(&system, &opening.stage, &find).unwrap();
        let ends = prepared.track(0..9, 8).into_iter();
        let ends = ends.map(|result| solved.search.solution(&result).expect("it arrives"));
        let graph = &solved.search.graph;
        let there = &graph.vertices[graph.edges[edge].target(direction)].points;
        let distance = |a: &RegularSolution, b: &RegularSolution| -> f64 {
            let pairs = a.values.iter().zip(&b.values);
            pairs.map(|(a, b)| (a - b).norm_sqr()).sum()
        };
        let place = |end: RegularSolution| {
            there
                .iter()
                .position(|vertex_point| distance(vertex_point, &end) < 1e-16)
        };
        ends.map(|end| place(end).expect("it is known")).collect()
    };
    let edges = solved.search.graph.edges.len();
    let mut elsewhere = 0;
    for edge in FIRST + 1..edges {
        for (direction, correspondences) in [Direction::Ahead, Direction::Back].into_iter().zip(0..)
        {
            let correspondences =
                solved.search.graph.edges[edge].correspondences[correspondences as usize].iter();
            let pairs: Vec<usize> = correspondences
                .map(|correspondence| match correspondence {
                    Correspondence::To { point, .. } => *point as usize,
                    other => panic!("{other:?}"),
                })
                .collect();
            assert_eq!(
                partners(&solved, edge, direction),
                pairs,
                "{edge} {direction:?}"
            );
        }
        let ahead = partners(&solved, edge, Direction::Ahead);
        let seed = &mut solved.search.graph.edges[edge].seed;
        *seed = way_back(*seed);
        elsewhere += u32::from(partners(&solved, edge, Direction::Ahead) != ahead);
    }
    assert!(edges > 20 && elsewhere > 3, "{edges} {elsewhere}");
}

/// With the number known, half of what an edge costs is saved at least: 3 edges, not all of them whole.
#[test]
fn few_paths_are_tracked_where_the_number_is_known() {
    let system = written(CUBICS);
    let mut tracked = 0;
    for seed in 0..10 {
        let options = SolveOptions {
            method: SolveMethod::Monodromy(MonodromyOptions {
                limits: LoopLimits {
                    count: Some(9),
                    ..LoopLimits::default()
                },
                ..MonodromyOptions::default()
            }),
            seed,
            ..SolveOptions::default()
        };
        let (set, counts) = solve(&mut plan(&system, &options).unwrap());
        assert_eq!((set.counts.distinct, counts.stop), (9, Some(Stop::Count)));
        tracked += counts.tracked;
    }
    // Edges that were tracked one way only took 518.
    assert!(tracked < 450, "{tracked}");
}

/// A tracker that jumps now and then: every path of a leg's first attempt ends where the first
/// one does. Nothing is lost, and it is counted.
#[test]
fn jumps_are_seen_and_repaired() {
    let system = written(CUBICS);
    let mut plan = monodromy(&system, 1);
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let done: Result<(), std::convert::Infallible> =
        drive(&mut plan.algorithm, &mut |opening: &Opening| {
            for points in &opening.objects {
                objects.insert(points.digest(), Arc::clone(points));
            }
            let find = |digest: Digest| objects.get(&digest).cloned();
            let stage = &opening.stage;
            let prepared = PreparedStage::new(&system, stage, &find).unwrap();
            let mut results = prepared.track(0..prepared.items(), 8);
            // The last stage, to the wanted parameters, is known by its nine paths at once.
            if stage.attempt == 0 && results.len() < 9 {
                let first = results[0].endpoint.clone();
                for result in &mut results {
                    result.endpoint = first.clone();
                }
            }
            Ok(results)
        });
    assert_eq!(done, Ok(()));
    let counts = plan.algorithm.loops().unwrap();
    let sets = plan.algorithm.solution_sets(&system);
    assert_eq!((sets[0].counts.distinct, counts.lost), (9, 0));
    assert!(counts.crossings_found > 0);
    assert_eq!(counts.crossings_found, counts.crossings_resolved);
}

#[test]
fn what_has_no_family_is_refused() {
    let refused = |text: &str| {
        let options = SolveOptions {
            method: SolveMethod::MONODROMY,
            ..SolveOptions::default()
        };
        plan(&written(text), &options).unwrap_err().to_string()
    };
    let plain = "CONFIG END; INPUT hom_variable_group x, y; function f; f = x^3 - 2*y^3; END;";
    assert!(refused(plain).contains("no parameters"));
    let square = "CONFIG END; INPUT variable_group x; parameter p; function f; f = x^3 - p^2; END;";
    assert!(refused(square).contains("not linear in its parameters"));
}

fn traced(text: &str, seed: u64) -> Plan {
    let options = SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                trace_test: true,
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        seed,
        ..SolveOptions::default()
    };
    match plan(&written(text), &options) {
        Ok(plan) => plan,
        Err(error) => panic!("{error}"),
    }
}

/// A plane cubic on a line.
const SLICED: &str = "CONFIG END; INPUT variable_group x, y; parameter a, b, c; function f, g;
    f = x^3 + y^3 - 2*x*y + 1; g = a*x + b*y + c; END;";

/// Few loops are enough where the test says so; without a point it says the opposite.
#[test]
fn points_on_a_slice_are_complete_when_their_sum_moves_on_a_line() {
    for seed in 0..5 {
        // (-1, 0) is on the curve and on x + 2y + 1 = 0.
        let number = |re: f64| Complex64::new(re, 0.0);
        let start = Arc::new(StoredPoints {
            dimension: 2,
            coordinates: [-1.0, 0.0].map(number).to_vec(),
        });
        let options = SolveOptions {
            method: SolveMethod::Monodromy(MonodromyOptions {
                known: KnownSolutions {
                    points: Some(GivenStart {
                        object: start.digest(),
                        count: 1,
                        dimension: 2,
                    }),
                    parameters: Some([1.0, 2.0, 1.0].map(number).to_vec()),
                },
                limits: LoopLimits {
                    trace_test: true,
                    ..LoopLimits::default()
                },
            }),
            seed,
            ..SolveOptions::default()
        };
        let mut plan = plan(&written(SLICED), &options).unwrap();
        let find = |_: Digest| Some(Arc::clone(&start));
        let set = run_locally(&plan.system, &mut plan.algorithm, &find, 8).unwrap();
        let (set, counts) = (&set[0], plan.algorithm.loops().unwrap().clone());
        assert_eq!(
            (set.counts.distinct, counts.stop),
            (3, Some(Stop::TraceTest))
        );
        let said = counts.trace_test.as_ref().unwrap();
        assert_eq!(
            (said.form, said.points, said.complete),
            (TraceForm::Slices, 3, true)
        );
        assert!(
            counts.loops < MOST_IDLE && said.deviation < Some(1e-12),
            "{counts:?}"
        );
        assert_eq!(set.warnings, Vec::<String>::new());
        let AnySolve::Monodromy(mut solve) = plan.algorithm.solve().clone() else {
            panic!("it is a monodromy solve")
        };
        let search = &mut solve.search;
        let Some(TraceTest::Slices(pencil)) = &search.trace_test else {
            panic!("its parameters are those of a slice")
        };
        search.graph.vertices[BASE].points.pop();
        for edge in search
            .graph
            .edges
            .iter_mut()
            .filter(|edge| edge.ends[0] == BASE)
        {
            edge.correspondences[0].pop();
        }
        let slices = search.moved_slices.unwrap();
        let without = slices.result(pencil, &search.graph, &search.orbits);
        assert!(
            !without.complete && without.deviation > Some(1e-5),
            "{without:?}"
        );
    }
}

/// The curve of x^3 = p + lambda v has 4 points on a bilinear section; that of two cubics 9 and,
/// where a.x = 0, those of a polynomial of degree 6.
#[test]
fn a_family_is_complete_when_sections_of_its_curve_are() {
    let cube = "CONFIG END; INPUT variable_group x; parameter p; function f; f = x^3 - p; END;";
    let homogeneous = "CONFIG END; INPUT hom_variable_group x, y; parameter p, q; function f;
        f = x^4 - p*x*y^3 - q*y^4; END;";
    for (text, solutions, points) in [(CUBICS, 9, 15), (cube, 3, 4), (homogeneous, 4, 5)] {
        for seed in 0..3 {
            let (set, counts) = solve(&mut traced(text, seed));
            assert_eq!((set.counts.distinct, counts.lost), (solutions, 0));
            assert_eq!(counts.stop, Some(Stop::TraceTest), "{counts:?}");
            let said = counts.trace_test.unwrap();
            assert_eq!((said.form, said.points), (TraceForm::Sections, points));
            assert!(said.complete && said.deviation < Some(1e-11), "{said:?}");
            assert_eq!(set.warnings, Vec::<String>::new());
        }
    }
}

/// Solves with a tracker that fails on its way to some points: `hidden` says which results.
fn solve_without(
    plan: &mut Plan,
    hidden: &mut dyn FnMut(&Stage, &[Complex64]) -> bool,
) -> (SolutionSet, LoopCounts) {
    let system = plan.system.clone();
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let done: Result<(), std::convert::Infallible> =
        drive(&mut plan.algorithm, &mut |opening: &Opening| {
            for points in &opening.objects {
                objects.insert(points.digest(), Arc::clone(points));
            }
            let find = |digest: Digest| objects.get(&digest).cloned();
            let stage = &opening.stage;
            let prepared = PreparedStage::new(&system, stage, &find).unwrap();
            let mut results = prepared.track(0..prepared.items(), 8);
            for result in &mut results {
                if hidden(stage, result.endpoint.to_double()) {
                    result.outcome = PathOutcome::Failed(Failure::EndgameUnsettled);
                }
            }
            Ok(results)
        });
    assert_eq!(done, Ok(()));
    let counts = plan.algorithm.loops().unwrap().clone();
    (plan.algorithm.solution_sets(&system).remove(0), counts)
}

fn is_near(point: &[Complex64], other: &[Complex64]) -> bool {
    // Coordinates of a point of the plane, and lambda's: both as ratios to their first.
    let ratio = |p: &[Complex64]| -> Vec<Complex64> {
        let groups = p.chunks(3);
        groups.flat_map(|g| g.iter().map(|z| z / g[0])).collect()
    };
    let pairs = ratio(point).into_iter().zip(ratio(other));
    pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>() < 1e-12
}

/// The user expects one more than loops connect.
#[test]
fn fewer_solutions_than_expected_are_not_all() {
    let family =
        "CONFIG END; INPUT variable_group x; parameter a, b; function f; f = x^2 + a*x + b; END;";
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
    let mut plan = plan(&written(family), &options).expect("a family that is linear in a and b");
    let (set, counts) = solve(&mut plan);
    assert_eq!(
        (counts.solutions, set.counts.complete),
        (2, Completeness::No)
    );
    let reason = set.counts.complete_reason.unwrap_or_default();
    assert_eq!(reason, "3 solutions expected, and loops found 2");
}

/// x = 0 is a solution at all parameters, which no loop connects with the two others: the trace test says that these two are
/// all (a tester's find).
#[test]
fn a_reducible_family_is_not_complete() {
    let family = "CONFIG END; INPUT variable_group x; parameter a, b; function f;
        f = x*(x^2 + a*x + b); END;";
    for seed in 0..3 {
        let (set, counts) = solve(&mut traced(family, seed));
        assert_eq!((counts.solutions, counts.stop), (2, Some(Stop::TraceTest)));
        assert_eq!(
            (set.counts.complete, set.settled()),
            (Completeness::No, false)
        );
        let reason = set.counts.complete_reason.unwrap_or_default();
        assert!(
            reason.contains("has 3 solutions by an exact count"),
            "{reason}"
        );
    }
}

/// No loop in the space of parameters leads to one solution; sections have it all the same.
#[test]
fn what_loops_miss_the_trace_test_finds() {
    let mut plan = traced(CUBICS, 1);
    solve(&mut plan);
    let AnySolve::Monodromy(whole) = plan.algorithm.solve() else {
        panic!("it is a monodromy solve")
    };
    let base = whole.search.graph.vertices[BASE].parameters.clone();
    let missing = whole.search.graph.vertices[BASE].points[8].values.clone();
    let missing = [&[Complex64::new(1.0, 0.0)], missing.as_slice()].concat();
    let mut times = 0;
    let (set, counts) = solve_without(&mut traced(CUBICS, 1), &mut |stage, end| {
        let to_base = matches!(&stage.homotopy,
            HomotopyKind::Parameter { targets, .. } if targets[0] == base);
        let hidden = to_base && is_near(end, &missing);
        times += u32::from(hidden);
        hidden
    });
    assert!(times > 0 && counts.lost > 0);
    assert_eq!(
        (set.counts.distinct, counts.stop),
        (9, Some(Stop::TraceTest))
    );
}

/// One point is missing on every section: then the sum is on no line, and that is said.
#[test]
fn a_missing_point_makes_the_trace_test_fail() {
    let (mut base_points, mut missing) = (Vec::<Vec<Complex64>>::new(), None::<Vec<Complex64>>);
    let mut base = None;
    let (set, counts) = solve_without(&mut traced(CUBICS, 2), &mut |stage, end| {
        let HomotopyKind::Sections { target, .. } = &stage.homotopy else {
            return false;
        };
        let base = base.get_or_insert_with(|| target.clone());
        if base != target {
            return false;
        }
        // The first that loops find beside the nine is the missing one.
        let is_new = !base_points.iter().any(|point| is_near(point, end));
        if missing.is_none() && base_points.len() == 9 && is_new {
            missing = Some(end.to_vec());
        }
        base_points.push(end.to_vec());
        base_points.truncate(9);
        missing
            .as_ref()
            .is_some_and(|missing| is_near(missing, end))
    });
    let said = counts.trace_test.unwrap();
    assert_eq!((said.points, said.complete), (14, false));
    assert!(said.deviation > Some(1e-5), "{said:?}");
    assert_eq!(
        (set.counts.distinct, counts.stop),
        (9, Some(Stop::IdleLoops))
    );
    let failed = |w: &&String| w.contains("the trace test failed");
    assert_eq!(
        set.warnings.iter().filter(failed).count(),
        1,
        "{:?}",
        set.warnings
    );
    assert!(!set.warnings.iter().any(|w| w.contains("strong evidence")));
}

#[test]
fn what_cannot_be_traced_is_refused_by_name() {
    let options = SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                trace_test: true,
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        ..SolveOptions::default()
    };
    let text = "CONFIG END; INPUT hom_variable_group x, y; variable_group z; parameter p, q;
        function f, g; f = x^2 - p*y^2; g = z^2 - q; END;";
    let error = plan(&written(text), &options).unwrap_err().to_string();
    assert!(
        error.contains("no trace test") && error.contains("affine groups"),
        "{error}"
    );
}

/// Of ten thousand random permutations of five points, a fifth fix the last point.
#[test]
fn idle_loops_are_less_and_less_likely_to_hide_a_solution() {
    let mut random = RandomStream::new(1, Purpose::Test, 0);
    let mut alone = 0;
    for _ in 0..10_000 {
        let mut order = [0, 1, 2, 3, 4];
        for i in (1..5).rev() {
            order.swap(i, random.below(i as u64 + 1) as usize);
        }
        alone += u32::from(order[4] == 4);
    }
    let expected = probability_of_hiding(4, 1);
    assert!((f64::from(alone) / 10_000.0 - expected).abs() < 0.02);
    assert!((probability_of_hiding(4, 3) - 0.008).abs() < 1e-15);
    for known_count in 1..2000 {
        let loops = (IDLE_PATHS / known_count).clamp(5, MOST_IDLE);
        assert!(
            probability_of_hiding(known_count, loops) < 1e-9,
            "{known_count}"
        );
    }
    assert_eq!(probability_of_hiding(8652, 100), 0.0);
}
