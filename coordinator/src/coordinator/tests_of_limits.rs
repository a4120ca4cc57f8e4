//! Jobs larger than memory, and clocks that somebody sets.

use super::simulation::*;
use super::*;
use crate::chunks::sizing::Sizing;
use crate::ledger::clock::ManualClock;
use crate::ledger::conformance::seen;
use crate::ledger::faulty::FaultyLedger;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::{JobState, Lease, Renewal};
use cognate_continuation::start_points::StoredPoints;
use cognate_protocol::submission::{StartKind, StartSolutions};
use cognate_solutions::summary::{PathCounts, SolutionCounts};
use num_complex::Complex64;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

fn policy(most_items: u64, held_paths: u64) -> Policy {
    Policy {
        lease_ms: 3000,
        steward_ms: 2000,
        // Here workers die by chance, and no path is at fault.
        suspicion_limit: 1000,
        held_paths,
        sizing: Sizing {
            first_items: most_items,
            most_items,
            ..Sizing::default()
        },
        ..Policy::default()
    }
}

/// All that a job says, and how many of its paths were held if not all.
struct Said {
    sets: Vec<SolutionSet>,
    paths: Vec<ClassifiedPath>,
    counts: (PathCounts, SolutionCounts, Vec<String>),
    held: Option<usize>,
}

/// Runs a job on a cluster of which everything dies by chance; nothing dies with `faults` false.
async fn run(problem: &NewProblem, seed: u64, held_paths: u64, faults: bool) -> Said {
    let clock = Arc::new(ManualClock::default());
    let memory = Arc::new(MemoryLedger::new(clock.clone()));
    let ledger: Arc<dyn Ledger> = if faults {
        Arc::new(FaultyLedger::often(memory, seed, 30))
    } else {
        memory
    };
    let policy = policy([1, 3, 5, 16][seed as usize % 4], held_paths);
    let mut cluster = Cluster::new(ledger, Store::in_memory(), clock, policy, seed);
    cluster.start_coordinator();
    cluster.start_worker();
    if faults {
        cluster.start_coordinator();
        cluster.start_worker();
    }
    cluster.submit(problem).await;
    let row = if faults {
        cluster.run().await
    } else {
        for _ in 0..200 {
            cluster.drive(0).await;
            cluster.pull(0, 0).await;
            cluster.report(0, 0).await;
        }
        cluster.row().await
    };
    assert_eq!(row.state, JobState::Solved, "{seed}: {:?}", row.reason);
    // Another coordinator reads the answer.
    let who = CoordinatorId::new("reader").unwrap();
    let (ledger, store) = (cluster.ledger.clone(), cluster.store.clone());
    let reader = Coordinator::new(ledger, store, who, cluster.policy.clone());
    let (summary, _) = reader.summary(cluster.job).await.unwrap();
    let summary = summary.solve().expect("a solve");
    let large = reader.large(&row).await.unwrap();
    Said {
        sets: reader.solutions(cluster.job).await.unwrap().to_vec(),
        paths: reader.paths(cluster.job).await.unwrap(),
        counts: (summary.paths, summary.solutions, summary.warnings),
        held: large.map(|answer| answer.held.len()),
    }
}

/// From four solutions of a family to four members; at one of them they are double.
pub(super) fn family(max_steps: Option<u32>) -> NewProblem {
    let text = "variable_group x, y; parameter p, q; function f, g; f = x^2 - p; g = y^2 - q*x^2;";
    let real = |values: &[f64]| -> Vec<Complex64> {
        values.iter().map(|&re| Complex64::new(re, 0.0)).collect()
    };
    let mut problem = problem_of(text, max_steps);
    let points = StoredPoints {
        dimension: 2,
        coordinates: real(&[1.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0, -1.0]),
    };
    problem.options.start = StartKind::Given;
    problem.options.start_parameters = real(&[1.0, 1.0]);
    problem.options.target_parameters = [[4.0, 9.0], [-2.0, 3.0], [5.0, 0.0], [0.25, -7.0]]
        .iter()
        .map(|values| real(values))
        .collect();
    problem.options.start_solutions = Some(StartSolutions::Object(points.digest()));
    problem.start_solutions = Some(points.to_bytes().into());
    problem
}

#[tokio::test]
async fn a_job_that_is_not_held_in_memory_has_the_same_answer() {
    // Without a count of the solutions no path waits for others; where one may, all ends are held.
    let quartics = "variable_group x, y; parameter p; function f, g;
        f = x^4 + p*x*y^2 - 3*y + 1; g = y^4 - x^3*y + 2*x - 5;";
    // Two of its solutions are double, and some paths go to infinity.
    let double = "variable_group x, y; parameter p; function f, g;
        f = (x - 1)^2*(x + p*y - 3); g = y^3 - x*y + x - 2;";
    let member = |text, max_steps| {
        let mut problem = problem_of(text, max_steps);
        problem.options.closings.no_exact_count = true;
        problem.options.target_parameters = vec![vec![Complex64::new(2.0, 0.0)]];
        problem
    };
    let problems = [
        (member(quartics, None), "plain"),
        (member(quartics, Some(25)), "all tracked again"),
        (member(quartics, Some(33)), "some tracked again"),
        (member(double, None), "singular"),
        (member(double, Some(40)), "singular, tracked again"),
        (family(None), "several targets"),
        (family(Some(30)), "several targets, tracked again"),
    ];
    for (problem, what) in &problems {
        let expected = run(problem, 3, 1000, false).await;
        assert_eq!(expected.held, None);
        for seed in 0..8 {
            let answer = run(problem, seed, 3, seed > 0).await;
            let held = answer.held.expect("it is large");
            assert!(answer.sets == expected.sets, "{what}, seed {seed}");
            assert!(answer.paths == expected.paths, "{what}, seed {seed}");
            assert_eq!(answer.counts, expected.counts, "{what}, seed {seed}");
            assert!(*what != "plain" || held < 4, "{held} of 16 are held");
            assert!(
                *what != "several targets" || held < 6,
                "{held} of 16 are held"
            );
        }
    }
}

fn pull(name: &str, number: u32) -> Pull {
    Pull {
        worker: seen(name, cognate_numeric::NUMERICS_REVISION),
        request: RequestId::new(format!("{name}.{number}")).unwrap(),
        slots: 1,
        wait: Duration::ZERO,
    }
}

/// A coordinator that runs, on a clock that is set.
#[tokio::test]
async fn a_clock_that_is_set_forward_ends_no_lease() {
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock.clone()));
    let ledger_of = ledger.clone();
    let who = CoordinatorId::new("c").unwrap();
    let policy = Policy {
        lease_ms: 900,
        expiry_ms: 50,
        ..policy(4, 1000)
    };
    let coordinator = Coordinator::new(ledger, Store::in_memory(), who, policy);
    let stop = CancellationToken::new();
    let running = tokio::spawn(Arc::clone(&coordinator).run(stop.clone()));
    let pass = async |milliseconds: u64| {
        for _ in 0..milliseconds / 20 {
            tokio::time::sleep(Duration::from_millis(20)).await;
            clock.advance_ms(20);
        }
    };
    let request = RequestId::new("r").unwrap();
    let tenant = Tenant::new("t").unwrap();
    coordinator
        .submit(request, tenant, problem())
        .await
        .unwrap();
    let lease_of = async |name: &str| -> Lease {
        for number in 0..100 {
            let leases = coordinator.pull(pull(name, number)).await.unwrap();
            if let Some(lease) = leases.into_iter().next() {
                return lease;
            }
            pass(100).await;
        }
        panic!("{name} gets no chunk");
    };
    let lives = lease_of("lives").await;
    let dies = lease_of("dies").await;
    for round in 0..12 {
        pass(200).await;
        if round % 5 == 2 {
            clock.advance_ms(3_600_000);
            // Before the worker's next renewal: the coordinator looks meanwhile.
            tokio::time::sleep(Duration::from_millis(200)).await;
        }
        let renewed = coordinator
            .renew(&[lives.lease], &speaker("lives"))
            .await
            .unwrap();
        assert!(
            matches!(renewed[..], [Renewal::Until(_)]),
            "lost in round {round}"
        );
    }
    // A worker that has fallen silent loses its chunk all the same.
    for _ in 0..100 {
        pass(200).await;
        coordinator
            .renew(&[lives.lease], &speaker("lives"))
            .await
            .unwrap();
        let stages = ledger_of.stages(dies.lease.chunk.job).await.unwrap();
        if stages[0].leased.chunks == 1 {
            break;
        }
    }
    let gone = coordinator
        .renew(&[dies.lease], &speaker("dies"))
        .await
        .unwrap();
    assert_eq!(gone, [Renewal::Lost]);
    let new_lease = lease_of("another").await;
    assert_ne!(new_lease.lease, lives.lease);
    stop.cancel();
    running.await.unwrap();
}
