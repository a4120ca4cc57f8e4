//! Workers that compute wrongly, beside honest ones and alone, under names and credentials of their own and of
//! others: the answer is the undisturbed one, and every wrong one is named.

use super::simulation::*;
use crate::ledger::rows::{JobRow, JobState};

/// A cluster in which so many chunks of a hundred are audited; workers are known to it before there is work.
async fn audited(percent: u32, workers: usize, seed: u64) -> Cluster {
    let mut cluster = cluster([1, 3, 5, 16][seed as usize % 4], seed);
    cluster.policy.audit_percent = percent;
    cluster.policy.suspicion_limit = 1000;
    cluster.start_coordinator();
    for _ in 0..workers {
        cluster.start_worker();
    }
    for worker in 0..workers {
        cluster.pull(0, worker).await;
    }
    cluster
}

/// With so many workers at work the job ends solved, as it does undisturbed.
async fn solves_as(cluster: &mut Cluster, workers: usize, undisturbed: &JobRow, seed: u64) {
    for _ in 0..4000 {
        cluster.drive(0).await;
        for worker in 0..workers {
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
    assert_eq!(row.state, JobState::Solved, "seed {seed}: {:?}", row.reason);
    assert_eq!(row.solutions, undisturbed.solutions, "seed {seed}");
}

#[tokio::test]
async fn nobody_waits_for_an_audit_where_one_worker_is_alone() {
    let (_, reference) = undisturbed(&problem()).await;
    let mut cluster = audited(100, 1, 1).await;
    cluster.submit(&problem()).await;
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
    assert_eq!(row.solutions, reference.solutions);
    let stages = cluster.ledger.stages(cluster.job).await.unwrap();
    let items: u64 = stages.iter().map(|stage| stage.items).sum();
    assert_eq!(cluster.tracked, items, "each once");
}

#[tokio::test]
async fn where_two_differ_the_coordinator_decides() {
    let (_, reference) = undisturbed(&problem()).await;
    let mut found = 0;
    for seed in 0..16 {
        let mut cluster = audited(100, 2, seed).await;
        cluster.break_worker(seed as usize % 2, Fault::LastBit);
        cluster.submit(&problem()).await;
        // Nobody dies here: neither can be outvoted by a third.
        solves_as(&mut cluster, 2, &reference, seed).await;
        let workers = cluster.ledger.workers(100).await.unwrap();
        found += workers.iter().filter(|worker| worker.evicted).count();
    }
    assert_eq!(found, 16, "the wrong one each time, and nobody else");
}

#[tokio::test]
async fn many_names_of_one_credential_are_one_voice() {
    let (_, reference) = undisturbed(&problem()).await;
    for seed in 0..16 {
        let mut cluster = audited(100, 4, seed).await;
        // Three names with one token, against one honest worker with its own.
        for worker in 0..3 {
            cluster.break_worker(worker, Fault::LastBit);
            cluster.give_credential(worker, "evil");
        }
        for worker in 0..4 {
            cluster.pull(0, worker).await;
        }
        cluster.submit(&problem()).await;
        solves_as(&mut cluster, 4, &reference, seed).await;
        for worker in cluster.ledger.workers(100).await.unwrap() {
            let honest = worker.says.credential.0 != "evil";
            assert!(!(honest && worker.evicted), "seed {seed}: {worker:?}");
        }
    }
}

#[tokio::test]
async fn a_liar_that_is_alone_is_found_by_the_equations() {
    // Nothing is audited: what is found, the coordinator's own doubt finds.
    let mut cluster = audited(0, 1, 3).await;
    cluster.break_worker(0, Fault::Gross);
    cluster.submit(&problem()).await;
    for _ in 0..50 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
    }
    let workers = cluster.ledger.workers(100).await.unwrap();
    assert!(workers.iter().any(|worker| worker.evicted));
}
