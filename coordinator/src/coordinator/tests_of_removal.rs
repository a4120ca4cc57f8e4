//! Removal beside running jobs: what is named stays, what is not goes, and who is killed leaves nothing.

use super::removal::{Collected, Removed};
use super::simulation::*;
use super::tests_of_limits::family;
use super::*;
use crate::ledger::clock::{Clock, ManualClock, SystemClock};
use crate::ledger::faulty::FaultyLedger;
use crate::ledger::identity::{ChunkId, Epoch, LeaseId};
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::Completion;
use crate::ledger::sql::SqlLedger;
use crate::results::retention::Retention;
use crate::results::store::StoreError;
use crate::results::trash::Amount;
use std::path::Path;

const GRACE_MS: u64 = 5000;

/// A cluster of one coordinator and one worker without faults, and how long it keeps what.
fn tidy_cluster(keep_ms: u64) -> Cluster {
    let mut cluster = cluster(1000, 1);
    cluster.policy.retention = Retention {
        keep_ms,
        grace_ms: GRACE_MS,
        ..Retention::default()
    };
    cluster.start_coordinator();
    cluster.start_worker();
    cluster
}

/// Submits one more job and has it done, up to its end.
async fn solve(cluster: &mut Cluster, name: &str, problem: &NewProblem) -> JobId {
    let request = RequestId::new(name).unwrap();
    let tenant = Tenant::new("tenant").unwrap();
    let coordinator = cluster.coordinator(0);
    let accepted = coordinator.submit(request, tenant, problem.clone()).await;
    cluster.job = accepted.unwrap().job;
    // Items are counted by stage, of one job at a time.
    cluster.accepted.clear();
    for _ in 0..400 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
        if cluster.row().await.state.has_ended() {
            break;
        }
    }
    let row = cluster.row().await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
    cluster.job
}

/// Looks before and after the grace, so that what nothing names is gone.
async fn collect_all(cluster: &Cluster) -> Collected {
    let coordinator = cluster.coordinator(0);
    let mut total = coordinator.collect().await.unwrap();
    cluster.clock.advance_ms(GRACE_MS);
    let second = coordinator.collect().await.unwrap();
    assert_eq!(second.trashed, 0, "{second:?}");
    total.removed += second.removed;
    total.results += second.results;
    total
}

async fn has_nothing(store: &Store) {
    assert_eq!(store.objects().await.unwrap(), []);
    assert_eq!(store.in_trash().await.unwrap(), []);
    assert_eq!(store.jobs_with_results().await.unwrap(), []);
}

/// Every object that is left is named, and every one that is named can be read.
async fn is_tidy(cluster: &Cluster) {
    let store = &cluster.store;
    assert_eq!(store.in_trash().await.unwrap(), []);
    let objects = store.objects().await.unwrap();
    let digests = objects.into_iter().map(|(digest, _)| digest);
    let unnamed = cluster.coordinator(0).unnamed(digests.collect()).await;
    assert_eq!(unnamed.unwrap(), Default::default());
    for row in cluster.ledger.jobs(10).await.unwrap() {
        let named = [
            Some(row.asked.problem),
            row.snapshot,
            row.solutions,
            row.summary,
        ];
        for digest in named.into_iter().flatten() {
            store.get(digest).await.unwrap();
        }
        for stage in cluster.ledger.stages(row.job).await.unwrap() {
            let stage = store.stage(stage.definition).await.unwrap();
            let named = [stage.system, stage.start_points.object()];
            for digest in named.into_iter().flatten() {
                store.get(digest).await.unwrap();
            }
        }
    }
}

/// Two coordinators and three workers that fail, a ledger that fails at one write in thirty; and at any moment one
/// of them looks for what nothing names, whose grace is over soon.
#[tokio::test]
async fn what_is_removed_beside_a_running_job_changes_nothing() {
    let problems = [
        problem(),
        family(Some(30)),
        super::tests_of_decomposition::problem(),
    ];
    let (mut looks, mut trashed, mut removed) = (0, 0, 0);
    for (number, problem) in problems.iter().enumerate() {
        let (_, reference) = undisturbed(problem).await;
        for seed in 0..[12, 12, 3][number] {
            let clock = Arc::new(ManualClock::default());
            let memory = Arc::new(MemoryLedger::new(clock.clone()));
            let ledger = Arc::new(FaultyLedger::often(memory, seed, 30));
            let mut policy = policy([1, 3, 5, 16][seed as usize % 4]);
            policy.suspicion_limit = 1000;
            policy.retention.grace_ms = GRACE_MS;
            let mut cluster = Cluster::new(ledger, Store::in_memory(), clock, policy, seed);
            for _ in 0..2 {
                cluster.start_coordinator();
                cluster.start_worker();
            }
            cluster.start_worker();
            cluster.submit(problem).await;
            while !cluster.row().await.state.has_ended() {
                cluster.act().await;
                if let Ok(collected) = cluster.coordinator(looks % 2).collect().await {
                    trashed += collected.trashed;
                    removed += collected.removed.objects;
                }
                looks += 1;
            }
            let row = cluster.row().await;
            assert_eq!(row.state, JobState::Solved, "{seed}: {:?}", row.reason);
            assert_eq!(row.solutions, reference.solutions, "{number}, seed {seed}");
            collect_all(&cluster).await;
            is_tidy(&cluster).await;
            if number < 2 {
                let paths = cluster.coordinator(0).paths(cluster.job).await.unwrap();
                assert_eq!(paths.len(), 16);
            }
        }
    }
    println!("{looks} looks, {trashed} objects put into the trash, {removed} removed");
    assert!(trashed > removed && removed > 0, "{trashed} {removed}");
}

#[tokio::test]
async fn a_deleted_job_takes_what_only_it_needs() {
    let mut cluster = tidy_cluster(0);
    let first = solve(&mut cluster, "first", &family(None)).await;
    let second = solve(&mut cluster, "second", &family(None)).await;
    let other = solve(&mut cluster, "other", &problem()).await;
    let coordinator = Arc::clone(cluster.coordinator(0));
    collect_all(&cluster).await;
    is_tidy(&cluster).await;
    let answers = coordinator.paths(second).await.unwrap();
    let before = cluster.store.objects().await.unwrap().len();

    let removed = coordinator.delete(first, false).await.unwrap();
    assert!(
        removed.stages > 0 && removed.chunks > 0 && !removed.before,
        "{removed:?}"
    );
    assert!(removed.results.objects >= removed.chunks && removed.results.bytes > 0);
    let second_removal = coordinator.delete(first, false).await.unwrap();
    let expected = Removed {
        before: true,
        ..Removed::default()
    };
    assert_eq!(second_removal, expected);
    let collected = collect_all(&cluster).await;
    is_tidy(&cluster).await;
    // The summary of the first job has a time of its own; its other objects are named by the second job, too.
    let after = cluster.store.objects().await.unwrap().len();
    assert_eq!(collected.removed.objects, (before - after) as u64);
    assert!(before - after < before / 2, "{before} to {after}");
    assert_eq!(coordinator.paths(second).await.unwrap(), answers);
    assert!(matches!(
        coordinator.summary(first).await,
        Err(CoordinatorError::Ledger(LedgerError::UnknownJob(_)))
    ));

    coordinator.delete(second, false).await.unwrap();
    collect_all(&cluster).await;
    is_tidy(&cluster).await;
    assert_eq!(coordinator.paths(other).await.unwrap().len(), 16);
    coordinator.delete(other, false).await.unwrap();
    collect_all(&cluster).await;
    has_nothing(&cluster.store).await;
}

#[tokio::test]
async fn only_a_job_that_has_ended_is_deleted() {
    let mut cluster = tidy_cluster(0);
    cluster.submit(&problem()).await;
    cluster.drive(0).await;
    cluster.pull(0, 0).await;
    let coordinator = Arc::clone(cluster.coordinator(0));
    let refused = coordinator.delete(cluster.job, false).await;
    assert!(matches!(
        refused,
        Err(CoordinatorError::GoesOn {
            state: JobState::Running,
            ..
        })
    ));
    coordinator.delete(cluster.job, true).await.unwrap();
    // A worker that still has a chunk reports it in vain, and leaves nothing.
    let chunk = ChunkId {
        job: cluster.job,
        stage: StageId(0),
        first: 0,
    };
    let report = Report {
        by: speaker("w2"),
        lease: LeaseId {
            chunk,
            epoch: Epoch(1),
        },
        results: Vec::new(),
        cpu_micros: 1,
    };
    let late = coordinator.complete(report).await;
    assert!(
        matches!(
            late,
            Ok(Completion::Stale) | Err(CoordinatorError::Ledger(LedgerError::UnknownJob(_)))
        ),
        "{late:?}"
    );
    cluster.drive(0).await;
    collect_all(&cluster).await;
    has_nothing(&cluster.store).await;
}

#[tokio::test]
async fn what_a_client_uploads_stays_until_it_is_named() {
    let mut cluster = tidy_cluster(0);
    let coordinator = Arc::clone(cluster.coordinator(0));
    let mut wanted = family(None);
    let points = wanted.start_solutions.take().unwrap();
    let uploaded = coordinator.store().put(points.clone()).await.unwrap();
    let lost = Bytes::from_static(b"nobody wants this");
    let unwanted = coordinator.store().put(lost.clone()).await.unwrap();
    for _ in 0..3 {
        coordinator.collect().await.unwrap();
        cluster.clock.advance_ms(GRACE_MS / 4);
    }
    assert_eq!(cluster.store.in_trash().await.unwrap().len(), 2);
    assert_eq!(
        coordinator.object(uploaded).await.unwrap(),
        points,
        "it is read all the same"
    );
    // Named, and not written again: it comes back.
    let job = solve(&mut cluster, "named", &wanted).await;
    let collected = coordinator.collect().await.unwrap();
    assert_eq!(collected.taken_back, 1, "{collected:?}");
    cluster.clock.advance_ms(GRACE_MS);
    let collected = coordinator.collect().await.unwrap();
    assert!(collected.removed.bytes >= lost.len() as u64);
    assert!(matches!(
        coordinator.object(unwanted).await,
        Err(CoordinatorError::Store(StoreError::Missing(_)))
    ));
    assert_eq!(coordinator.paths(job).await.unwrap().len(), 16);
    is_tidy(&cluster).await;
    // An object that is written again while it is in the trash exists once.
    let rewritten_digest = coordinator.store().put(lost.clone()).await.unwrap();
    coordinator.collect().await.unwrap();
    assert_eq!(
        coordinator.store().put(lost.clone()).await.unwrap(),
        rewritten_digest
    );
    cluster.clock.advance_ms(GRACE_MS);
    coordinator.collect().await.unwrap();
    assert_eq!(coordinator.object(rewritten_digest).await.unwrap(), lost);
}

/// A ledger may take longer than the grace period to name what was written: nothing is removed that a writer has seen.
#[tokio::test]
async fn what_is_about_to_be_named_stays_however_long_it_takes() {
    let cluster = tidy_cluster(0);
    let coordinator = Arc::clone(cluster.coordinator(0));
    let store = &cluster.store;
    let bytes = Bytes::from_static(b"named late");
    let turn = store.naming().begin();
    let object = store.put(bytes.clone()).await.unwrap();
    for _ in 0..4 {
        coordinator.collect().await.unwrap();
        cluster.clock.advance_ms(GRACE_MS);
    }
    assert_eq!(store.get(object).await.unwrap(), bytes);
    // A writer that begins while the object is in the trash writes it anew, and does not stop its removal from the
    // trash.
    let later = store.naming().begin();
    drop(turn);
    let collected = coordinator.collect().await.unwrap();
    assert_eq!(collected.removed, Amount::one(bytes.len() as u64));
    assert!(matches!(
        store.get(object).await,
        Err(StoreError::Missing(_))
    ));
    assert_eq!(store.put(bytes.clone()).await.unwrap(), object);
    for _ in 0..4 {
        coordinator.collect().await.unwrap();
        cluster.clock.advance_ms(GRACE_MS);
    }
    assert_eq!(store.get(object).await.unwrap(), bytes);
    drop(later);
    coordinator.collect().await.unwrap();
    has_nothing(store).await;
}

/// The rows are gone, and the coordinator was killed before it had removed anything else.
#[tokio::test]
async fn who_is_killed_after_the_rows_leaves_nothing() {
    let mut cluster = tidy_cluster(0);
    let job = solve(&mut cluster, "killed", &problem()).await;
    cluster.ledger.delete(job).await.unwrap();
    let left = cluster.store.results_of(job).await.unwrap().len() as u64;
    assert!(left > 0);
    let collected = collect_all(&cluster).await;
    assert_eq!(collected.results.objects, left);
    has_nothing(&cluster.store).await;
    assert_eq!(
        cluster.coordinator(0).collect().await.unwrap(),
        Collected::default()
    );
}

#[tokio::test]
async fn jobs_that_ended_long_ago_are_deleted() {
    let mut cluster = tidy_cluster(100_000);
    let old = solve(&mut cluster, "old", &problem()).await;
    cluster.clock.advance_ms(60_000);
    let young = solve(&mut cluster, "young", &problem()).await;
    cluster.submit(&family(None)).await;
    cluster.clock.advance_ms(39_000);
    let coordinator = Arc::clone(cluster.coordinator(0));
    assert_eq!(coordinator.collect().await.unwrap().old_jobs, 0);
    cluster.clock.advance_ms(2_000);
    assert_eq!(coordinator.collect().await.unwrap().old_jobs, 1);
    let left = cluster.ledger.jobs(10).await.unwrap();
    let left: Vec<JobId> = left.iter().map(|row| row.job).collect();
    assert_eq!(left, [young, cluster.job]);
    assert!(cluster.ledger.is_deleted(old).await.unwrap());
    // A job that has not ended is never old.
    cluster.clock.advance_ms(1_000_000_000);
    assert_eq!(coordinator.collect().await.unwrap().old_jobs, 1);
    assert_eq!(cluster.ledger.jobs(10).await.unwrap().len(), 1);
}

async fn sqlite(folder: &Path, name: &str) -> Arc<dyn Ledger> {
    let clock: Arc<dyn Clock> = Arc::new(SystemClock::default());
    Arc::new(SqlLedger::sqlite(&folder.join(name), clock).await.unwrap())
}

/// A folder of results belongs to one ledger: another one, which knows none of its jobs, removes nothing.
#[tokio::test]
async fn results_of_another_ledger_are_left() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::folder(&folder.path().join("results"), true).unwrap();
    let clock = Arc::new(ManualClock::default());
    let mut policy = policy(1000);
    policy.retention.grace_ms = 0;
    let coordinator_of = |ledger: Arc<dyn Ledger>| {
        let who = CoordinatorId::new("c").unwrap();
        Coordinator::new(ledger, store.clone(), who, policy.clone())
    };
    let own_ledger = sqlite(folder.path(), "own.db").await;
    let mut cluster = Cluster::new(
        own_ledger.clone(),
        store.clone(),
        clock.clone(),
        policy.clone(),
        1,
    );
    cluster.start_coordinator();
    cluster.start_worker();
    let job = solve(&mut cluster, "job", &problem()).await;
    let objects = store.objects().await.unwrap();
    let other = coordinator_of(sqlite(folder.path(), "other.db").await);
    let passing = coordinator_of(Arc::new(MemoryLedger::new(clock)));
    // Nobody has said whose they are.
    let refused = other.collect().await;
    assert!(
        matches!(refused, Err(CoordinatorError::ForeignResults(1))),
        "{refused:?}"
    );
    let refused = passing.collect().await;
    assert!(matches!(
        refused,
        Err(CoordinatorError::Store(StoreError::Foreign(_)))
    ));
    assert_eq!(store.objects().await.unwrap(), objects);
    // Now they are said to be their ledger's.
    let collected = coordinator_of(own_ledger.clone()).collect().await.unwrap();
    assert!(
        collected.trashed > 0 && collected.results == Amount::default(),
        "{collected:?}"
    );
    let refused = other.collect().await;
    assert!(matches!(
        refused,
        Err(CoordinatorError::Store(StoreError::Foreign(_)))
    ));
    let later_coordinator = coordinator_of(own_ledger);
    later_coordinator.collect().await.unwrap();
    assert_eq!(later_coordinator.paths(job).await.unwrap().len(), 16);
    // Results of a job that this ledger never had: it may be an older copy of itself.
    let foreign = folder.path().join("results/jobs/0123456789abcdef");
    std::fs::create_dir(&foreign).unwrap();
    std::fs::write(foreign.join("0.0-1.1"), "results").unwrap();
    let before = store.objects().await.unwrap();
    later_coordinator
        .store()
        .put(Bytes::from_static(b"unnamed"))
        .await
        .unwrap();
    let refused = later_coordinator.collect().await;
    assert!(
        matches!(refused, Err(CoordinatorError::ForeignResults(1))),
        "{refused:?}"
    );
    assert_eq!(store.objects().await.unwrap().len(), before.len() + 1);
    let inspection = later_coordinator.inspect().await.unwrap();
    assert!(
        inspection.is_sound() && inspection.unknown_jobs.len() == 1,
        "{inspection:?}"
    );
    later_coordinator.repair(&inspection).await.unwrap();
    assert!(!foreign.exists());
    assert_eq!(store.objects().await.unwrap(), before);
    // A state of a job is lost: what it named is not known, and that is said.
    let row = later_coordinator.ledger().job(job).await.unwrap().unwrap();
    let state = row.snapshot.unwrap().to_string();
    let state = format!("results/objects/{}/{state}", &state[..2]);
    std::fs::write(folder.path().join(state), "damaged").unwrap();
    let inspection = later_coordinator.inspect().await.unwrap();
    assert_eq!(inspection.faults.len(), 1, "{inspection:?}");
    assert!(!inspection.faults[0].missing && inspection.faults[0].is == "the state");
    // The folder is away: nothing is taken for missing.
    std::fs::rename(folder.path().join("results"), folder.path().join("moved")).unwrap();
    let refused = later_coordinator.collect().await;
    assert!(matches!(
        refused,
        Err(CoordinatorError::Store(StoreError::Away(_)))
    ));
}
