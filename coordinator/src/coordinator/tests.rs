//! Whole clusters: any process may die at any moment, and the job ends with the same solutions, bit for bit.

use super::simulation::*;
use super::*;
use crate::chunks::speculation::Speculation;
use crate::ledger::clock::{Clock, ManualClock};
use crate::ledger::faulty::{FaultyLedger, Side};
use crate::ledger::identity::Speaker;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::{ChunkState, JobRow};
use crate::ledger::sql::SqlLedger;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_protocol::submission::StartKind;
use cognate_solutions::failed_path::FailureReason;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// The reference: one coordinator, one worker, nothing happens.
async fn quiet(problem: &NewProblem) -> (JobRow, Vec<SolutionSet>) {
    let (cluster, row) = undisturbed(problem).await;
    let sets = cluster.coordinator(0).solutions(cluster.job).await.unwrap();
    (row, sets.to_vec())
}

#[tokio::test]
async fn the_reference_is_right() {
    let (_, sets) = quiet(&problem()).await;
    assert_eq!(sets.len(), 1);
    assert_eq!((sets[0].paths.total, sets[0].paths.finite), (16, 16));
    assert_eq!(sets[0].counts.distinct, 16);
    assert!(sets[0].paths.retracked > 0, "the test needs several stages");
}

#[tokio::test]
async fn any_cluster_finds_the_same() {
    let (reference, _) = quiet(&problem()).await;
    check_any_cluster(&problem(), &reference, &[1, 3, 5, 16], 40).await;
}

/// Two coordinators, three workers; every fault that the simulation has, and a ledger that fails at one write in
/// thirty. `COGNATE_SIMULATION_SEEDS=1000` runs 1000 seeds instead of a few.
#[tokio::test]
async fn whatever_fails_the_same_is_found() {
    let seeds = std::env::var("COGNATE_SIMULATION_SEEDS");
    let number = |n: String| n.parse().expect("COGNATE_SIMULATION_SEEDS is a number");
    let seeds: u64 = seeds.map_or(24, number);
    let (reference, _) = quiet(&problem()).await;
    let (mut tracked, mut heard_again, mut overtaken) = (0, 0, 0);
    let (mut late, mut won) = (0, 0);
    for seed in 0..seeds {
        let clock = Arc::new(ManualClock::default());
        let memory = Arc::new(MemoryLedger::new(clock.clone()));
        let ledger = Arc::new(FaultyLedger::often(memory, seed, 30));
        let policy = Policy {
            // Here workers die by chance, and no path is at fault.
            suspicion_limit: 1000,
            // Nobody is patient, so that many chunks are with two workers.
            speculation: Speculation {
                times: 1,
                least_ms: 100,
            },
            ..policy([1, 3, 5, 16][seed as usize % 4])
        };
        let mut cluster = Cluster::new(ledger, Store::in_memory(), clock, policy, seed);
        for _ in 0..2 {
            cluster.start_coordinator();
        }
        for _ in 0..3 {
            cluster.start_worker();
        }
        cluster.submit(&problem()).await;
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{seed}: {:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
        tracked += cluster.tracked;
        heard_again += cluster.heard_again;
        overtaken += cluster.overtaken;
        for stage in cluster.ledger.stages(cluster.job).await.unwrap() {
            late += stage.speculative_leases;
            won += stage.speculative_won;
        }
    }
    println!(
        "{seeds} seeds: {tracked} paths tracked, {heard_again} lost replies heard again; {late} chunks \
         given to a second worker, {won} of them done by it first, {overtaken} reports overtaken"
    );
    assert!(late > won && won > 0 && overtaken > 0);
    assert!(
        heard_again > 0,
        "some replies are lost, and answered when asked again"
    );
}

/// A worker takes chunks of the first stage and stands still. Its lease lasts ten minutes, and the job
/// ends within seconds; what the worker reports after that, or before the second one does, changes
/// nothing.
#[tokio::test]
async fn a_worker_that_stands_still_does_not_hold_up_the_end() {
    let (reference, _) = quiet(&problem()).await;
    let (mut won, mut overtaken) = (0, 0);
    for seed in 0..40 {
        let mut cluster = cluster([1, 2, 3, 5][seed as usize % 4], seed);
        cluster.policy.lease_ms = 600_000;
        // With audits by a second worker, the job would wait for the worker that stands still.
        cluster.policy.unchecked_audit_percent = 0;
        cluster.start_coordinator();
        for _ in 0..2 + seed % 2 {
            cluster.start_worker();
        }
        cluster.submit(&problem()).await;
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        let begin = cluster.clock.now();
        // Of every third it wakes up in between.
        let wakes = (seed % 3 == 0).then(|| cluster.dice.roll(60));
        for step in 0..1000 {
            for worker in 1..2 + seed as usize % 2 {
                cluster.pull(0, worker).await;
                cluster.clock.advance_ms(50);
                cluster.report(0, worker).await;
            }
            if wakes == Some(step) {
                cluster.report(0, 0).await;
            }
            cluster.drive(0).await;
            cluster.expire(0).await;
            if cluster.row().await.state.has_ended() {
                break;
            }
        }
        let row = cluster.row().await;
        assert_eq!(row.state, JobState::Solved, "seed {seed}: {:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
        let took = row.ended.expect("it has ended").since_ms(begin);
        assert!(took < 10_000, "seed {seed}: {took} ms, a lease has 600,000");
        for _ in 0..2 {
            cluster.report(0, 0).await;
        }
        overtaken += cluster.overtaken;
        let stages = cluster.ledger.stages(cluster.job).await.unwrap();
        won += stages.iter().map(|s| s.speculative_won).sum::<u64>();
        let explained = cluster.coordinator(0).explain(cluster.job).await.unwrap();
        let late: u64 = stages.iter().map(|s| s.speculative_leases).sum();
        let says = explained
            .text
            .contains(&format!("late: {late} chunks were"));
        assert_eq!(says, late > 0, "{}", explained.text);
    }
    println!("{won} chunks done by a second worker, {overtaken} reports overtaken");
    assert!(won > 30 && overtaken > 30, "{won}, {overtaken}");
}

#[tokio::test]
async fn a_worker_that_computes_wrongly_is_outvoted() {
    let (reference, _) = quiet(&problem()).await;
    let (mut solved, mut failed) = (0, 0);
    for seed in 0..24 {
        let mut cluster = cluster([1, 3, 5, 16][seed as usize % 4], seed);
        // Of every second cluster only a part is audited: what the worker did is done again.
        let is_full = seed % 2 == 0;
        cluster.policy.audit_percent = if is_full { 100 } else { 50 };
        cluster.policy.suspicion_limit = 1000;
        cluster.start_coordinator();
        for _ in 0..4 {
            cluster.start_worker();
        }
        cluster.break_worker(seed as usize % 4, Fault::Gross);
        for worker in 0..4 {
            cluster.pull(0, worker).await;
        }
        cluster.submit(&problem()).await;
        let row = cluster.run().await;
        let workers = cluster.ledger.workers(100).await.unwrap();
        let evicted = workers.iter().filter(|worker| worker.evicted).count();
        assert!(evicted <= 1, "seed {seed}: only one computes wrongly");
        // A worker that died before it was outvoted leaves what it did.
        if is_full || evicted == 1 {
            match row.state {
                JobState::Solved => {
                    assert_eq!(row.solutions, reference.solutions, "seed {seed}");
                    solved += evicted;
                }
                _ => {
                    let reason = row.reason.unwrap_or_default();
                    assert!(!is_full, "seed {seed}: {reason}");
                    assert!(reason.contains("computed wrongly"), "{reason}");
                    failed += 1;
                }
            }
        }
    }
    println!("outvoted: {solved} jobs solved, {failed} failed");
    assert!(solved > 6, "of those that were not killed first: {solved}");
}

#[tokio::test]
async fn a_coordinator_killed_at_any_write_loses_nothing() {
    survives_a_kill_at_any_write(&problem()).await;
}

/// A problem whose stages start at points that the job itself found. The steward writes these points as objects
/// before the row of the stage.
fn monodromy() -> NewProblem {
    let mut problem = problem_of(
        "variable_group x; parameter p; function f; f = x^3 - p;",
        None,
    );
    problem.options.start = StartKind::Monodromy;
    problem.options.expected_solutions = Some(3);
    problem
}

#[tokio::test]
async fn a_kill_between_start_points_and_their_stage_does_no_harm() {
    let (_, sets) = quiet(&monodromy()).await;
    assert_eq!(sets[0].counts.distinct, 3);
    survives_a_kill_at_any_write(&monodromy()).await;
}

#[tokio::test]
async fn any_cluster_makes_the_same_loops() {
    let (reference, _) = quiet(&monodromy()).await;
    for seed in 0..10 {
        let mut cluster = cluster([1, 2][seed as usize % 2], seed);
        cluster.policy.suspicion_limit = 1000;
        for _ in 0..=seed % 2 {
            cluster.start_coordinator();
            cluster.start_worker();
        }
        cluster.submit(&monodromy()).await;
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
    }
}

async fn survives_a_kill_at_any_write(problem: &NewProblem) {
    let (reference, _) = quiet(problem).await;
    for side in [Side::Before, Side::After] {
        for fail_at in 0.. {
            let clock = Arc::new(ManualClock::default());
            let memory = Arc::new(MemoryLedger::new(clock.clone()));
            let faulty = Arc::new(FaultyLedger::new(memory, fail_at, side));
            let store = Store::in_memory();
            let mut cluster =
                Cluster::new(faulty.clone(), store, clock.clone(), policy(6), fail_at);
            cluster.start_coordinator();
            cluster.start_worker();
            cluster.submit(problem).await;
            for _ in 0..400 {
                cluster.drive(0).await;
                cluster.pull(0, 0).await;
                cluster.report(0, 0).await;
                // A new steward waits for the old one's right to end; a lost lease to expire.
                clock.advance_ms(700);
                cluster.expire(0).await;
                if cluster.row().await.state.has_ended() {
                    break;
                }
            }
            let row = cluster.row().await;
            let place = format!("killed {side:?} write {fail_at}");
            assert_eq!(row.state, JobState::Solved, "{place}: {:?}", row.reason);
            assert_eq!(row.solutions, reference.solutions, "{place}");
            let items: u64 = cluster
                .ledger
                .stages(cluster.job)
                .await
                .unwrap()
                .iter()
                .map(|s| s.items)
                .sum();
            assert!(
                cluster.tracked <= items + 12,
                "{place}: a lost lease at most"
            );
            if !faulty.has_failed() {
                assert!(fail_at > 20, "there are many writes to fail at");
                break;
            }
        }
    }
}

#[tokio::test]
async fn a_ledger_and_store_on_disk_are_all_that_a_restart_needs() {
    let (reference, _) = quiet(&problem()).await;
    let folder = tempfile::tempdir().unwrap();
    let clock = Arc::new(ManualClock::default());
    let mut tracked = 0;
    let mut replayed: Option<Vec<u8>> = None;
    let mut accepted_before = None;
    for round in 0..100 {
        let path = folder.path().join("ledger");
        let ledger = Arc::new(SqlLedger::sqlite(&path, clock.clone()).await.unwrap());
        let store = Store::folder(&folder.path().join("results"), true).unwrap();
        let mut cluster = Cluster::new(ledger.clone(), store, clock.clone(), policy(3), round);
        cluster.start_coordinator();
        cluster.start_worker();
        cluster.submit(&problem()).await;
        let finished = cluster.finished().await;
        if let Some(before) = accepted_before.take() {
            assert_eq!(finished, before, "what was accepted is as it was");
        }
        // A new steward may drive once the old one's right has ended.
        clock.advance_ms(2000);
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
        cluster.drive(0).await;
        let row = cluster.row().await;
        if let (Some(state), Some(live)) = (row.snapshot, cluster.live_state(0)) {
            let kept: Vec<u8> = cluster
                .store
                .record(&crate::jobs::planning::STATE, state)
                .await
                .unwrap();
            assert_eq!(kept, live, "replayed state is live state");
            replayed = Some(kept);
        }
        tracked += cluster.tracked;
        accepted_before = Some(cluster.finished().await);
        clock.advance_ms(5000);
        cluster.expire(0).await;
        drop(cluster);
        ledger.close().await;
        if row.state.has_ended() {
            assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
            assert_eq!(row.solutions, reference.solutions);
            let items: u64 = accepted_before
                .unwrap()
                .values()
                .flatten()
                .map(|chunk| chunk.items.len())
                .sum();
            assert_eq!(tracked, items, "what was accepted is not tracked again");
            assert!(round > 5, "the job was interrupted often");
            assert!(replayed.is_some());
            return;
        }
    }
    panic!("the job does not end");
}

#[tokio::test]
async fn a_path_that_kills_workers_is_named_and_the_rest_is_solved() {
    let mut cluster = cluster(16, 5);
    cluster.deadly = Some(11);
    cluster.start_coordinator();
    cluster.start_worker();
    let mut problem = problem();
    // Without paths the equations have the solution that is lost.
    problem.options.closings.no_exact_count = true;
    cluster.submit(&problem).await;
    for _ in 0..400 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
        cluster.clock.advance_ms(500);
        cluster.expire(0).await;
    }
    let row = cluster.row().await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
    let coordinator = cluster.coordinator(0);
    let sets = coordinator.solutions(cluster.job).await.unwrap();
    assert_eq!((sets[0].paths.finite, sets[0].paths.failed), (15, 1));
    let failed = &sets[0].failed[0];
    let killed = FailureReason::Tracking(Failure::KilledItsWorker);
    assert_eq!((failed.path, failed.reason), (11, killed));
    let (summary, _) = coordinator.summary(cluster.job).await.unwrap();
    let summary = summary.solve().expect("a solve");
    assert_eq!(summary.failures[Failure::KilledItsWorker.describe()], 1);
    assert!(!summary.settled);
    let stages = cluster.ledger.stages(cluster.job).await.unwrap();
    assert_eq!(stages[0].failed.items, 1);
    let paths = coordinator.paths(cluster.job).await.unwrap();
    assert_eq!(paths.len(), 16);
    assert_eq!(
        paths[11].result.outcome,
        PathOutcome::Failed(Failure::KilledItsWorker)
    );
    assert_eq!(paths[11].solution, None);
    assert!(paths.iter().filter(|p| p.solution.is_some()).count() == 15);
}

#[tokio::test]
async fn a_damaged_or_missing_object_is_found_again() {
    let (reference, _) = quiet(&problem()).await;
    let folder = tempfile::tempdir().unwrap();
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock.clone()));
    let store = Store::folder(folder.path(), true).unwrap();
    let mut cluster = Cluster::new(ledger, store, clock, policy(4), 3);
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.submit(&problem()).await;
    cluster.drive(0).await;
    for _ in 0..8 {
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
    }
    let finished = cluster.finished().await;
    let place = |chunk: usize| {
        let ChunkState::Accepted { result, .. } = &finished[&0][chunk].state else {
            panic!("the chunk is accepted");
        };
        folder.path().join(&result.address)
    };
    assert!(finished[&0].len() >= 4);
    std::fs::write(place(0), b"nonsense").unwrap();
    std::fs::remove_file(place(2)).unwrap();
    let mut flipped = std::fs::read(place(3)).unwrap();
    *flipped.last_mut().unwrap() ^= 1;
    std::fs::write(place(3), flipped).unwrap();
    cluster.drive(0).await;
    let stages = cluster.ledger.stages(cluster.job).await.unwrap();
    assert_eq!(stages[0].ready.chunks, 3, "{stages:?}");
    // Chunks that were counted as accepted are accepted again.
    cluster.accepted.clear();
    let row = cluster.run().await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
    assert_eq!(row.solutions, reference.solutions);
}

#[tokio::test]
async fn a_report_of_other_paths_is_refused() {
    let mut cluster = cluster(4, 3);
    cluster.start_coordinator();
    cluster.submit(&problem()).await;
    cluster.drive(0).await;
    let coordinator = Arc::clone(cluster.coordinator(0));
    let pull = Pull {
        worker: crate::ledger::conformance::seen("w", 1),
        request: RequestId::new("1").unwrap(),
        slots: 1,
        wait: Duration::ZERO,
    };
    let lease = coordinator.pull(pull).await.unwrap()[0].clone();
    let stage = coordinator
        .stage(cluster.job, lease.lease.chunk.stage)
        .await
        .unwrap();
    let result = |item| crate::chunks::expiry::killed_its_worker(&stage, item);
    for results in [
        vec![],
        vec![result(0), result(2), result(1), result(3)],
        (0..17).map(result).collect(),
    ] {
        let report = Report {
            by: Speaker {
                worker: crate::ledger::conformance::worker("w"),
                session: "1".into(),
            },
            lease: lease.lease,
            results,
            cpu_micros: 1,
        };
        let refused = coordinator.complete(report).await;
        assert!(matches!(refused, Err(CoordinatorError::Report { .. })));
    }
    // Fewer items than leased are not the chunk.
    let report = Report {
        by: Speaker {
            worker: crate::ledger::conformance::worker("w"),
            session: "1".into(),
        },
        lease: lease.lease,
        results: vec![result(0)],
        cpu_micros: 1,
    };
    let stale = coordinator.complete(report).await.unwrap();
    assert_eq!(stale, crate::ledger::rows::Completion::Stale);
}

/// The worker's call for chunks may be under way while it leaves; the call is no sign of life.
#[tokio::test]
async fn a_worker_that_left_is_gone_though_it_is_still_asking() {
    let mut cluster = cluster(4, 3);
    cluster.start_coordinator();
    let coordinator = Arc::clone(cluster.coordinator(0));
    let by = Speaker {
        worker: crate::ledger::conformance::worker("w"),
        session: "life".into(),
    };
    let pull = |request: &str, slots| Pull {
        worker: crate::ledger::conformance::seen("w", 1),
        request: RequestId::new(request).unwrap(),
        slots,
        wait: Duration::from_secs(3),
    };
    let asks = {
        let (coordinator, pull) = (Arc::clone(&coordinator), pull("life.1", 1));
        tokio::spawn(async move { coordinator.pull(pull).await })
    };
    while coordinator.workers(9).await.unwrap().is_empty() {
        tokio::task::yield_now().await;
    }
    let is_leaving = async || coordinator.workers(9).await.unwrap()[0].says.draining;
    coordinator.worker_leaves(&by).await.unwrap();
    assert!(is_leaving().await);
    assert!(asks.await.unwrap().unwrap().is_empty());
    assert!(is_leaving().await);
    let late = coordinator.pull(pull("life.2", 1)).await.unwrap();
    assert!(late.is_empty() && is_leaving().await);
    coordinator.pull(pull("another.1", 0)).await.unwrap();
    assert!(!is_leaving().await, "it is back");
}

/// The shell: real clock, its own tasks, two workers that poll.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_running_coordinator_needs_nobody_to_drive_it() {
    let (reference, _) = quiet(&problem()).await;
    let clock = Arc::new(crate::ledger::clock::SystemClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock));
    let who = CoordinatorId::new("c").unwrap();
    let coordinator = Coordinator::new(ledger, Store::in_memory(), who, policy(4));
    let stop = CancellationToken::new();
    let running = tokio::spawn(Arc::clone(&coordinator).run(stop.clone()));
    for name in ["v", "w"] {
        let (coordinator, stop) = (Arc::clone(&coordinator), stop.clone());
        tokio::spawn(async move {
            let mut pulls = 0;
            while !stop.is_cancelled() {
                pulls += 1;
                let pull = Pull {
                    worker: crate::ledger::conformance::seen(name, 1),
                    request: RequestId::new(format!("{name}.{pulls}")).unwrap(),
                    slots: 1,
                    wait: Duration::from_secs(5),
                };
                let by = speaker(name);
                for lease in coordinator.pull(pull).await.unwrap() {
                    let id = lease.lease;
                    let system = coordinator.problem(lease.problem).await.unwrap();
                    let stage = coordinator
                        .stage(id.chunk.job, id.chunk.stage)
                        .await
                        .unwrap();
                    let prepared = cognate_continuation::prepared_work::PreparedWork::new(
                        &system,
                        &stage,
                        &|_| None,
                    )
                    .unwrap();
                    let report = Report {
                        by: by.clone(),
                        lease: id,
                        results: prepared.run(lease.items.first..lease.items.last, 8),
                        cpu_micros: 1000,
                    };
                    coordinator.complete(report).await.unwrap();
                }
            }
        });
    }
    let begin = std::time::Instant::now();
    let accepted = coordinator
        .submit(
            RequestId::new("r").unwrap(),
            Tenant::new("t").unwrap(),
            problem(),
        )
        .await
        .unwrap();
    let mut watched = coordinator.watch(accepted.job);
    let mut last = None;
    while let Some(progress) = watched.recv().await {
        last = Some(progress.unwrap());
    }
    let last = last.expect("progress is said at least once");
    assert_eq!(last.state, JobState::Solved, "{}", last.message);
    assert!(begin.elapsed() < Duration::from_secs(300));
    let row = coordinator
        .ledger()
        .job(accepted.job)
        .await
        .unwrap()
        .unwrap();
    assert_eq!(row.solutions, reference.solutions);
    let explained = coordinator.explain(accepted.job).await.unwrap();
    assert!(explained.text.contains("16 paths"), "{}", explained.text);
    let (summary, text) = coordinator.summary(accepted.job).await.unwrap();
    let summary = summary.solve().expect("a solve");
    assert_eq!(
        summary.workers.iter().map(|w| w.paths).sum::<u64>(),
        last.stages.iter().map(|s| s.accepted).sum::<u64>()
    );
    assert!(text.contains("\"highest_precision_bits\": "));
    stop.cancel();
    running.await.unwrap();
}

#[tokio::test]
async fn what_cannot_be_solved_is_refused_at_the_door() {
    let mut cluster = cluster(4, 3);
    cluster.start_coordinator();
    let submit = |text: &str| {
        let coordinator = Arc::clone(cluster.coordinator(0));
        let problem = problem_of(text, None);
        async move {
            let request = RequestId::new("r").unwrap();
            let tenant = Tenant::new("t").unwrap();
            coordinator.submit(request, tenant, problem).await
        }
    };
    let fewer = "variable_group x, y; function f; f = x^2 - y;";
    let refused = submit(fewer).await.expect_err("too few equations");
    assert!(
        refused.to_string().contains("cognate decompose"),
        "{refused}"
    );
    assert!(coordinator_is_empty(cluster.coordinator(0)).await);
    let accepted = submit("variable_group x; function f; f = x^2 - 2;").await;
    assert!(accepted.unwrap().is_new);
    let other = submit("variable_group x; function f; f = x^2 - 3;").await;
    let reused = other.expect_err("one request, two problems");
    assert!(matches!(
        reused,
        CoordinatorError::Ledger(LedgerError::RequestReused(_))
    ));
    let jobs = cluster.coordinator(0).jobs(0, 10, None).await.unwrap();
    assert_eq!(jobs.len(), 1);
}

async fn coordinator_is_empty(coordinator: &Coordinator) -> bool {
    coordinator.jobs(0, 10, None).await.unwrap().is_empty()
}

/// Results that no worker can have reported: a broken invariant, so that the algorithm panics.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_panic_ends_the_job_and_not_the_service() {
    let clock = Arc::new(crate::ledger::clock::SystemClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock));
    let who = CoordinatorId::new("c").unwrap();
    let coordinator = Coordinator::new(ledger, Store::in_memory(), who, policy(1000));
    let stop = CancellationToken::new();
    let running = tokio::spawn(Arc::clone(&coordinator).run(stop.clone()));
    let request = RequestId::new("r").unwrap();
    let accepted = coordinator
        .submit(request, Tenant::new("t").unwrap(), problem())
        .await
        .unwrap();
    let mut watched = coordinator.watch(accepted.job);
    let pull = Pull {
        worker: crate::ledger::conformance::seen("w", 1),
        request: RequestId::new("w-1").unwrap(),
        slots: 1,
        wait: Duration::from_secs(5),
    };
    let lease = coordinator.pull(pull).await.unwrap()[0].clone();
    let stage = coordinator
        .stage(accepted.job, lease.lease.chunk.stage)
        .await
        .unwrap();
    let results = (lease.items.first..lease.items.last)
        .map(|_| crate::chunks::expiry::killed_its_worker(&stage, 3))
        .collect();
    let (store, ledger) = (coordinator.store(), coordinator.ledger());
    let object = store
        .put_results(lease.lease, lease.items, results, 1)
        .await
        .unwrap();
    ledger.complete(lease.lease, object).await.unwrap();
    let mut last = None;
    while let Some(progress) = watched.recv().await {
        last = Some(progress.unwrap());
    }
    let last = last.expect("progress is said at least once");
    assert_eq!(last.state, JobState::Failed);
    assert!(
        last.message.starts_with("internal error: "),
        "{}",
        last.message
    );
    stop.cancel();
    running.await.unwrap();
}
