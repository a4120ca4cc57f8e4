//! Conformance of every ledger about late chunks: a second worker gets them, and the first result counts.

use super::*;
use crate::ledger::clock::ManualClock;

/// A result with an address that is the lease's own, as the store gives it.
fn found(lease: &Lease, hash: u8) -> ResultObject {
    let address = format!("object-{}", lease.lease);
    ResultObject {
        address,
        ..result(lease.items, hash, 5)
    }
}

/// A job of two chunks: one is done after 100 ms, and the other is with worker `v` since 2 s.
async fn late(ledger: &dyn Ledger, clock: &ManualClock) -> (JobId, Lease) {
    here(ledger, &["u", "v", "w"]).await;
    let (job, _) = running(ledger, "r", "t", 16, 8).await;
    let done = take(ledger, "w", "w.1").await;
    let held = take(ledger, "v", "v.1").await;
    clock.advance_ms(100);
    let completion = ledger.complete(done.lease, found(&done, 1)).await.unwrap();
    assert_eq!(completion, Completion::Accepted);
    clock.advance_ms(899);
    let early = ledger.lease(wants("w", "w.2", 1)).await.unwrap();
    assert!(early.is_empty(), "not before a second has passed");
    clock.advance_ms(1001);
    (job, held)
}

async fn speculative(ledger: &dyn Ledger, job: JobId) -> (u64, u64) {
    let stage = &ledger.stages(job).await.unwrap()[0];
    (stage.speculative_leases, stage.speculative_won)
}

pub async fn a_late_chunk_is_given_to_an_idle_worker(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, first) = late(ledger, clock).await;
    // Not to the one that is late; to one other, once.
    assert!(ledger.lease(wants("v", "v.2", 1)).await.unwrap().is_empty());
    let leases = ledger.lease(wants("w", "w.3", 2)).await.unwrap();
    let second = leases[0].clone();
    assert_eq!(leases.len(), 1);
    assert!(second.speculative && !first.speculative);
    assert_eq!(second.items, first.items);
    assert_eq!(second.lease.chunk, first.lease.chunk);
    assert!(second.lease.epoch > first.lease.epoch);
    assert!(ledger.lease(wants("u", "u.1", 1)).await.unwrap().is_empty());
    // It is no chunk more.
    assert_eq!(counts(ledger, job).await, (0, 8, 8, 0));
    // Both stand.
    let until = Renewal::Until(clock.now().after_ms(1000));
    let ids = [first.lease, second.lease];
    assert_eq!(ledger.renew(&ids, 1000).await.unwrap(), [until, until]);
    let repeated_leases = ledger.lease(wants("w", "w.3", 2)).await.unwrap();
    assert_eq!(repeated_leases[0].lease, second.lease, "the reply was lost");
    let object = found(&second, 1);
    let done = ledger.complete(second.lease, object.clone()).await.unwrap();
    assert_eq!(done, Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
    assert_eq!(speculative(ledger, job).await, (1, 1));
    // The first one hears that its lease is over, and what it reports is no error.
    assert_eq!(ledger.renew(&ids, 1000).await.unwrap(), [Renewal::Lost; 2]);
    for _ in 0..2 {
        let late = ledger.complete(first.lease, found(&first, 1)).await;
        assert_eq!(late.unwrap(), Completion::Overtaken);
        let repeated_report = ledger.complete(second.lease, object.clone()).await;
        assert_eq!(repeated_report.unwrap(), Completion::AlreadyAccepted);
    }
    let other = ledger.complete(first.lease, found(&first, 2)).await;
    assert_eq!(other.unwrap(), Completion::HashDiffers);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
    // A lease that is over and done expires no more.
    clock.advance_ms(100_000);
    assert!(ledger.expire().await.unwrap().is_empty());
    let by = ledger.contributions(job).await.unwrap();
    assert_eq!((by.len(), by[0].items), (1, 16), "the chunk is w's");
}

pub async fn who_is_late_may_still_be_first(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, first) = late(ledger, clock).await;
    let second = take(ledger, "w", "w.3").await;
    let object = found(&first, 1);
    let done = ledger.complete(first.lease, object.clone()).await.unwrap();
    assert_eq!(done, Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
    assert_eq!(speculative(ledger, job).await, (1, 0));
    let ids = [first.lease, second.lease];
    assert_eq!(ledger.renew(&ids, 1000).await.unwrap(), [Renewal::Lost; 2]);
    let late = ledger.complete(second.lease, found(&second, 1)).await;
    assert_eq!(late.unwrap(), Completion::Overtaken);
    // The answer to the first one was lost: its object is the one that counts.
    let repeated_report = ledger.complete(first.lease, object.clone()).await.unwrap();
    assert_eq!(repeated_report, Completion::AlreadyAccepted);
    let by = ledger.contributions(job).await.unwrap();
    assert_eq!(by.len(), 2, "the chunk is v's");
    let finished = ledger.finished_chunks(job, StageId(0), 8, 1).await.unwrap();
    let state = ChunkState::Accepted {
        worker: worker("v"),
        result: object,
    };
    assert_eq!(finished[0].state, state);
    let rows = ledger.workers(9).await.unwrap();
    assert!(rows.iter().all(|row| row.leased_chunks == 0));
}

pub async fn who_is_late_may_report_after_the_second_worker_is_lost(
    ledger: &dyn Ledger,
    clock: &ManualClock,
) {
    let (job, first) = late(ledger, clock).await;
    let second = ledger.lease(wants("w", "w.3", 1)).await.unwrap()[0].clone();
    clock.advance_ms(1000);
    let expired = ledger.expire().await.unwrap();
    let gone: Vec<_> = expired.iter().map(|e| (e.lease, e.suspicions)).collect();
    assert_eq!(gone, [(second.lease, 1)]);
    assert_eq!(counts(ledger, job).await, (8, 0, 8, 0));
    let done = ledger.complete(first.lease, found(&first, 1)).await;
    assert_eq!(done.unwrap(), Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
    assert_eq!(speculative(ledger, job).await, (1, 0));
    let late = ledger.complete(second.lease, found(&second, 1)).await;
    assert_eq!(late.unwrap(), Completion::Overtaken);
}

pub async fn what_is_suspected_or_not_late_is_not_given_twice(
    ledger: &dyn Ledger,
    clock: &ManualClock,
) {
    let (job, first) = late(ledger, clock).await;
    let mut never = wants("w", "w.3", 1);
    never.speculation.times = 0;
    assert!(ledger.lease(never).await.unwrap().is_empty());
    // 40 times the 100 ms that its equal took are more than 2 s.
    let mut patient = wants("w", "w.3", 1);
    patient.speculation.times = 40;
    assert!(ledger.lease(patient).await.unwrap().is_empty());
    // Both fall silent: each is a suspicion, and the second chance was the only one.
    let second = ledger.lease(wants("w", "w.3", 1)).await.unwrap()[0].clone();
    clock.advance_ms(60_000);
    let expired = ledger.expire().await.unwrap();
    let gone: Vec<_> = expired.iter().map(|e| (e.lease, e.suspicions)).collect();
    assert_eq!(gone, [(second.lease, 1), (first.lease, 2)]);
    let late = ledger.complete(first.lease, found(&first, 1)).await;
    assert_eq!(late.unwrap(), Completion::Stale);
    take(ledger, "u", "u.1").await;
    clock.advance_ms(30_000);
    assert!(ledger.lease(wants("w", "w.4", 1)).await.unwrap().is_empty());
    assert_eq!(counts(ledger, job).await, (0, 8, 8, 0));
    // A job that ends leaves no lease behind.
    ledger.cancel(job, "no").await.unwrap();
    clock.advance_ms(60_000);
    assert!(ledger.expire().await.unwrap().is_empty());
}

pub async fn an_audit_ends_both_leases(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, first) = late(ledger, clock).await;
    let second = take(ledger, "w", "w.3").await;
    let voted = ledger
        .confirm(first.lease, found(&first, 1), Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(voted, Completion::Unconfirmed);
    assert_eq!(counts(ledger, job).await, (8, 0, 8, 0));
    let over = ledger
        .confirm(second.lease, found(&second, 1), Confirmation::Doubt)
        .await;
    assert_eq!(over.unwrap(), Completion::Stale);
    let repeated_vote = ledger
        .confirm(first.lease, found(&first, 1), Confirmation::Doubt)
        .await;
    assert_eq!(repeated_vote.unwrap(), Completion::Unconfirmed);
    // Another one confirms; it is late, and nobody gets the chunk beside it.
    let third = take(ledger, "u", "u.1").await;
    assert!(!third.speculative);
    clock.advance_ms(30_000);
    assert!(ledger.lease(wants("w", "w.4", 1)).await.unwrap().is_empty());
    let done = ledger
        .confirm(third.lease, found(&third, 1), Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(done, Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
}
