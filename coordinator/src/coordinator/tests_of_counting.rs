//! Counting: mixed cells are counted by workers even if some of them die, and only outcomes of paths are counted as
//! outcomes.

use super::simulation::*;
use super::*;
use crate::ledger::clock::ManualClock;
use crate::ledger::faulty::FaultyLedger;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::{JobRow, Outcomes};
use cognate_continuation::start_systems::polyhedral::branches::BRANCHES;
use cognate_continuation::work::Work;
use cognate_protocol::submission::StartKind;

/// Paths fail at first, so that some of any branch are tracked again; their equations alone are not asked.
fn polyhedral() -> NewProblem {
    let mut problem = problem();
    problem.options.closings.no_exact_count = true;
    problem.options.start = StartKind::Polyhedral;
    problem
}

fn policy(most_items: u64) -> Policy {
    Policy {
        counting_operations: 10,
        ..super::simulation::policy(most_items)
    }
}

fn cluster(policy: Policy, seed: u64, faults: bool) -> Cluster {
    let clock = Arc::new(ManualClock::default());
    let memory = Arc::new(MemoryLedger::new(clock.clone()));
    let ledger: Arc<dyn Ledger> = match faults {
        true => Arc::new(FaultyLedger::often(memory, seed, 30)),
        false => memory,
    };
    Cluster::new(ledger, Store::in_memory(), clock, policy, seed)
}

/// One coordinator and one worker, who live.
async fn quiet(cluster: &mut Cluster) -> JobRow {
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.submit(&polyhedral()).await;
    cluster.drive(0).await;
    let explained = cluster.coordinator(0).explain(cluster.job).await.unwrap();
    let (text, json) = (explained.text, explained.json);
    assert!(text.contains("; an unknown number of paths, "), "{text}");
    assert!(json.contains("\"paths\":null"), "{json}");
    run_alone(cluster).await
}

/// The only coordinator and its only worker go on; enough steps for every job here.
async fn run_alone(cluster: &mut Cluster) -> JobRow {
    for _ in 0..400 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
        cluster.clock.advance_ms(500);
        cluster.expire(0).await;
    }
    cluster.row().await
}

/// A finished job's progress counts the end of every tracked path, and of nothing else.
async fn check_outcomes(cluster: &Cluster) -> Vec<Work> {
    let stages = cluster.ledger.stages(cluster.job).await.unwrap();
    let (mut kinds, mut tracked) = (Vec::new(), 0);
    for row in &stages {
        let work = cluster.store.stage(row.definition).await.unwrap().work;
        let Outcomes {
            regular,
            singular,
            failed,
        } = row.outcomes;
        let expected = if work == Work::Track { row.items } else { 0 };
        assert_eq!(regular + singular + failed, expected, "{work:?}");
        tracked += expected;
        kinds.push(work);
    }
    let progress = cluster.coordinator(0).progress(cluster.job).await;
    let outcomes = progress.unwrap().outcomes;
    let ended = outcomes.regular + outcomes.singular + outcomes.failed;
    assert_eq!(ended, tracked);
    kinds
}

/// Two solutions are double, one path goes to infinity; the others are certified and sharpened. Questions
/// of isolation were counted as singular paths once, sharpened points as regular ones.
#[tokio::test]
async fn only_tracked_paths_have_outcomes() {
    let double = "variable_group x, y; function f, g;
        f = (x - 1)^2*(x + 2*y - 3); g = y^3 - x*y + x - 2;";
    let mut problem = problem_of(double, None);
    problem.options.closings.certify = true;
    problem.options.closings.digits = Some(30);
    let mut lone = cluster(policy(1000), 1, false);
    lone.start_coordinator();
    lone.start_worker();
    lone.submit(&problem).await;
    let row = run_alone(&mut lone).await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
    let kinds = check_outcomes(&lone).await;
    for kind in [
        Work::Track,
        Work::Certify,
        Work::LocalDimension,
        Work::Sharpen { digits: 30 },
    ] {
        assert!(kinds.contains(&kind), "no stage of {kind:?} in {kinds:?}");
    }
}

#[tokio::test]
async fn mixed_cells_are_counted_whoever_dies() {
    let mut lone = cluster(policy(1000), 1, false);
    let reference = quiet(&mut lone).await;
    assert_eq!(reference.state, JobState::Solved, "{:?}", reference.reason);
    let coordinator = lone.coordinator(0);
    let sets = coordinator.solutions(lone.job).await.unwrap();
    assert_eq!((sets[0].paths.total, sets[0].paths.finite), (16, 16));
    assert!(sets[0].paths.retracked > 0, "the test needs several stages");
    let progress = coordinator.progress(lone.job).await.unwrap();
    let counting = &progress.stages[0];
    assert_eq!(counting.purpose, "counting mixed cells");
    assert_eq!((counting.total, counting.accepted), (BRANCHES, BRANCHES));
    let cells = counting.mixed_cells.expect("it counts them");
    assert!((1..=16).contains(&cells), "{cells}");
    assert!(progress.stages[1..].iter().all(|s| s.mixed_cells.is_none()));
    check_outcomes(&lone).await;
    let explained = coordinator.explain(lone.job).await.unwrap();
    assert!(
        explained.text.contains("; 16 paths, "),
        "{}",
        explained.text
    );
    for seed in 0..8 {
        let policy = Policy {
            // Here workers die by chance, and no branch is at fault.
            suspicion_limit: 1000,
            ..policy([40, 100, 300][seed as usize % 3])
        };
        let mut cluster = cluster(policy, seed, true);
        for _ in 0..2 {
            cluster.start_coordinator();
            cluster.start_worker();
        }
        cluster.submit(&polyhedral()).await;
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{seed}: {:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
    }
}

#[tokio::test]
async fn a_branch_that_no_worker_survives_ends_the_job_by_name() {
    let mut cluster = cluster(policy(400), 1, false);
    cluster.deadly = Some(700);
    let row = quiet(&mut cluster).await;
    assert_eq!(row.state, JobState::Failed);
    let reason = row.reason.expect("a reason");
    assert!(reason.contains("branch 700 of the mixed cells"), "{reason}");
    let explained = cluster.coordinator(0).explain(cluster.job).await.unwrap();
    assert!(explained.text.contains(&reason), "{}", explained.text);
}

/// A worker that says that branches have no mixed cells takes away the solutions of their start points (third attack, H).
/// A branch is counted by two credentials, and where they differ the coordinator decides.
#[tokio::test]
async fn a_liar_about_mixed_cells_changes_no_answer() {
    let (honest, reference) = {
        let mut lone = cluster(policy(1000), 1, false);
        let row = quiet(&mut lone).await;
        (lone.tracked, row)
    };
    for beside in [1, 2] {
        let mut tracked = 0;
        for seed in 0..4 {
            let policy = Policy {
                audit_percent: 0,
                check_results: true,
                suspicion_limit: 1000,
                ..policy([100, 300][seed as usize % 2])
            };
            let mut cluster = cluster(policy, seed, false);
            cluster.start_coordinator();
            for _ in 0..=beside {
                cluster.start_worker();
            }
            // Workers of several credentials are known before there is work.
            for worker in 0..=beside {
                cluster.pull(0, worker).await;
            }
            let liar = seed as usize / 2 % (beside + 1);
            let name = cluster.name_of(liar);
            cluster.break_worker(liar, Fault::NoCells);
            cluster.submit(&polyhedral()).await;
            for _ in 0..2000 {
                cluster.drive(0).await;
                for worker in 0..=beside {
                    cluster.pull(0, worker).await;
                    cluster.report(0, worker).await;
                }
                cluster.clock.advance_ms(100);
                cluster.expire(0).await;
                if cluster.row().await.state.has_ended() {
                    break;
                }
            }
            let row = cluster.row().await;
            assert_eq!(row.state, JobState::Solved, "{seed}: {:?}", row.reason);
            assert_eq!(row.solutions, reference.solutions, "seed {seed}");
            let workers = cluster.ledger.workers(100).await.unwrap();
            let evicted = workers.iter().filter(|worker| worker.evicted);
            let evicted: Vec<&str> = evicted.map(|w| w.says.worker.as_str()).collect();
            assert_eq!(evicted, [name], "seed {seed}");
            tracked += cluster.tracked;
        }
        println!(
            "beside {beside}: {:.2} of the work",
            tracked as f64 / (4 * honest) as f64
        );
    }
}
