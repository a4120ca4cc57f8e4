//! Storage that fails under a job: what was lost is tracked again, and the answer is the undisturbed one.

use super::simulation::*;
use super::*;
use crate::ledger::clock::ManualClock;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::{JobRow, JobState};
use crate::results::faulty_storage::{FaultyStorage, StorageFault};
use std::collections::BTreeMap;

/// Runs the job on storage that loses the results of one chunk in `one_in`.
async fn run(one_in: u64, seed: u64) -> (JobRow, Arc<FaultyStorage>) {
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock.clone()));
    let storage = Arc::new(FaultyStorage::new("jobs", one_in, seed));
    let store = Store::on(storage.clone());
    let mut policy = policy([1, 3, 5, 16][seed as usize % 4]);
    policy.suspicion_limit = 1000;
    let mut cluster = Cluster::new(ledger, store, clock, policy, seed);
    cluster.start_coordinator();
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.start_worker();
    cluster.lossy = true;
    cluster.submit(&problem()).await;
    (cluster.run().await, storage)
}

#[tokio::test]
async fn results_that_storage_loses_are_tracked_again() {
    let (_, reference) = undisturbed(&problem()).await;
    let mut happened: BTreeMap<StorageFault, u64> = BTreeMap::new();
    for seed in 0..40 {
        let (row, storage) = run([3, 8, 20][seed as usize % 3], seed).await;
        assert_eq!(row.state, JobState::Solved, "seed {seed}: {:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
        for (fault, times) in storage.happened() {
            *happened.entry(fault).or_default() += times;
        }
    }
    println!("{happened:?}");
    assert!(
        happened.len() == 4 && happened.values().all(|&times| times > 10),
        "{happened:?}"
    );
}

/// A job whose stage cannot be told to any worker says so.
#[tokio::test]
async fn what_storage_has_lost_is_named_where_the_job_stands_still() {
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock.clone()));
    let mut cluster = Cluster::new(ledger, Store::in_memory(), clock, policy(5), 1);
    cluster.start_coordinator();
    let problem = &problem();
    cluster.submit(problem).await;
    while cluster
        .ledger
        .stages(cluster.row().await.job)
        .await
        .unwrap()
        .is_empty()
    {
        cluster.drive(0).await;
    }
    let job = cluster.row().await.job;
    let stages = cluster.ledger.stages(job).await.unwrap();
    let explained = cluster.coordinator(0).explain(job).await.unwrap();
    assert!(!explained.text.contains("is lost"), "{}", explained.text);

    cluster.store.lose(stages[0].definition).await.unwrap();
    let explained = cluster.coordinator(0).explain(job).await.unwrap();
    let expected = "storage: the definition of stage 0 is lost, and the job waits";
    assert!(explained.text.contains(expected), "{}", explained.text);
}

/// Attack D of the third attack on the service (2026-11): whichever stage of a job storage loses, it is made again from
/// the job's first state and the results of the stages before it.
#[tokio::test]
async fn stages_that_storage_loses_are_made_again() {
    let (reference, expected) = undisturbed(&problem()).await;
    let stages = reference.ledger.stages(reference.job).await.unwrap();
    assert!(stages.len() > 1, "a job of several stages");
    for lost in &stages {
        let clock = Arc::new(ManualClock::default());
        let ledger = Arc::new(MemoryLedger::new(clock.clone()));
        let mut cluster = Cluster::new(ledger, Store::in_memory(), clock, policy(5), 1);
        cluster.start_coordinator();
        cluster.start_worker();
        cluster.lossy = true;
        cluster.submit(&problem()).await;
        let is_open =
            |rows: &[crate::ledger::rows::StageRow]| rows.iter().any(|row| row.stage == lost.stage);
        while !is_open(&cluster.ledger.stages(cluster.job).await.unwrap()) {
            cluster.drive(0).await;
            cluster.pull(0, 0).await;
            cluster.report(0, 0).await;
        }
        cluster.store.lose(lost.definition).await.unwrap();
        // Whatever was known of it is forgotten.
        cluster.crash(0);
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
        assert_eq!(row.solutions, expected.solutions);
        cluster
            .store
            .stage(lost.definition)
            .await
            .expect("it is there");
    }
}
