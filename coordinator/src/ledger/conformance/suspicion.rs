//! Suspicion: failures of one worker say something about the worker, those of several about the chunk;
//! and what is lost of what was accepted is done again.

use super::*;

fn failed() -> GiveBack {
    GiveBack::Failed {
        reason: "it crashed".to_owned(),
    }
}

pub async fn one_worker_that_fails_is_one_suspicion(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 5, 5).await;
    for name in ["u", "v", "w"] {
        ledger.seen(seen(name, 1)).await.unwrap();
    }
    clock.advance_ms(2000);
    let lease = ledger.lease(wants("u", "u.1", 1)).await.unwrap()[0].clone();
    ledger.give_back(lease.lease, failed()).await.unwrap();
    // Others are here that have not tried it: it is theirs.
    let none = ledger.lease(wants("u", "u.2", 1)).await.unwrap();
    assert!(none.is_empty());
    // One that has just come, too, leaves it to them.
    ledger.seen(seen("new", 1)).await.unwrap();
    let none = ledger.lease(wants("new", "new.1", 1)).await.unwrap();
    assert!(none.is_empty());
    for (count, name) in [(2, "v"), (3, "w")] {
        let lease = ledger
            .lease(wants(name, &format!("{name}.1"), 1))
            .await
            .unwrap()[0]
            .clone();
        ledger.give_back(lease.lease, failed()).await.unwrap();
        let suspects = ledger.suspects(job, 1, EVER).await.unwrap();
        assert_eq!(suspects[0].suspicions, count, "{name}");
    }
}

pub async fn who_fails_again_counts_once(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 5, 5).await;
    ledger.seen(seen("u", 1)).await.unwrap();
    for number in 0..4 {
        let asked = wants("u", &format!("u.{number}"), 1);
        let lease = ledger.lease(asked).await.unwrap()[0].clone();
        if number == 2 {
            // From now on there is another one, which has not tried it yet.
            ledger.seen(seen("v", 1)).await.unwrap();
        }
        ledger.give_back(lease.lease, failed()).await.unwrap();
        let suspects = ledger.suspects(job, 1, EVER).await.unwrap();
        assert_eq!(suspects[0].suspicions, [1, 2, 2, 2][number]);
    }
    // It has gone for good, and the first one is alone with it.
    clock.advance_ms(100_000);
    ledger.seen(seen("u", 1)).await.unwrap();
    let lease = ledger.lease(wants("u", "u.9", 1)).await.unwrap()[0].clone();
    ledger.give_back(lease.lease, failed()).await.unwrap();
    let suspects = ledger.suspects(job, 1, EVER).await.unwrap();
    assert_eq!(suspects[0].suspicions, 3);
}

pub async fn lost_results_are_done_again(ledger: &dyn Ledger, _: &ManualClock) {
    let (job, epoch) = running(ledger, "r", "t", 10, 5).await;
    let mut leases = ledger.lease(wants("w", "w.1", 2)).await.unwrap();
    leases.sort_by_key(|lease| lease.items.first);
    let first = &leases[0];
    let completion = ledger
        .complete(first.lease, result(first.items, 7, 100))
        .await;
    assert_eq!(completion.unwrap(), Completion::Accepted);
    ledger
        .give_back(leases[1].lease, GiveBack::Drained)
        .await
        .unwrap();
    let given_up = result(leases[1].items, 8, 0);
    ledger
        .fail_item(leases[1].lease.chunk, epoch, given_up)
        .await
        .unwrap();
    assert_eq!(counts(ledger, job).await, (0, 0, 5, 5));
    let old = ledger.reopen(first.lease.chunk, Epoch(epoch.0 + 1)).await;
    assert!(matches!(old, Err(LedgerError::Fenced(_))));
    for lease in &leases {
        ledger.reopen(lease.lease.chunk, epoch).await.unwrap();
        // Done twice it is done once.
        ledger.reopen(lease.lease.chunk, epoch).await.unwrap();
    }
    assert_eq!(counts(ledger, job).await, (10, 0, 0, 0));
    let stage = ledger.stages(job).await.unwrap()[0].clone();
    assert_eq!((stage.cpu_micros, stage.outcomes), (0, Outcomes::default()));
    // The next lease has a place of its own for its results.
    let new_lease = ledger.lease(wants("w", "w.2", 1)).await.unwrap()[0].clone();
    assert!(new_lease.lease.epoch > first.lease.epoch);
    let completion = ledger
        .complete(new_lease.lease, result(new_lease.items, 7, 100))
        .await;
    assert_eq!(completion.unwrap(), Completion::Accepted);
    let rest = ledger.lease(wants("w", "w.3", 1)).await.unwrap()[0].clone();
    ledger
        .complete(rest.lease, result(rest.items, 8, 100))
        .await
        .unwrap();
    let close = Advance {
        close: vec![StageId(0)],
        ..Advance::default()
    };
    ledger.advance(job, epoch, close).await.unwrap();
    let closed = ledger.reopen(first.lease.chunk, epoch).await;
    assert!(matches!(closed, Err(LedgerError::StageOrder(..))));
}

pub async fn a_lease_stands_with_who_has_it(ledger: &dyn Ledger, clock: &ManualClock) {
    running(ledger, "r", "t", 5, 5).await;
    let lease = ledger.lease(wants("w", "s.1", 1)).await.unwrap()[0].clone();
    let standing = ledger.standing(lease.lease).await.unwrap();
    let by = |name: &str, session: &str| Speaker {
        worker: worker(name),
        session: session.to_owned(),
    };
    assert!(standing.is_of(&by("w", "s")));
    assert!(!standing.is_of(&by("w", "t")));
    assert!(!standing.is_of(&by("v", "s")));
    let mut ahead = lease.lease;
    ahead.epoch.0 += 1;
    assert_eq!(ledger.standing(ahead).await.unwrap(), Standing::Never);
    clock.advance_ms(1000);
    ledger.expire().await.unwrap();
    assert_eq!(ledger.standing(lease.lease).await.unwrap(), Standing::Ended);
    assert_eq!(ledger.standing(ahead).await.unwrap(), Standing::Never);
    let mut elsewhere = lease.lease;
    elsewhere.chunk.first += 1;
    assert_eq!(ledger.standing(elsewhere).await.unwrap(), Standing::Never);
}

pub async fn jobs_that_only_wait_want_no_look(ledger: &dyn Ledger, clock: &ManualClock) {
    let me = coordinator("c");
    let looks = async |suspicions: u32| ledger.attention(&me, suspicions).await.unwrap();
    let queued = ledger
        .submit(request("q"), new_job("t", 0))
        .await
        .unwrap()
        .job;
    // Nobody drives it, then it has no stage.
    assert_eq!(looks(3).await, [queued]);
    ledger.steward(queued, &me, 60_000).await.unwrap();
    assert_eq!(looks(3).await, [queued]);
    ledger.cancel(queued, "no").await.unwrap();
    let (job, epoch) = running(ledger, "r", "t", 5, 5).await;
    assert!(looks(3).await.is_empty());
    assert!(
        ledger
            .attention(&coordinator("d"), 3)
            .await
            .unwrap()
            .is_empty()
    );
    let lease = ledger.lease(wants("w", "w.1", 1)).await.unwrap()[0].clone();
    assert!(looks(3).await.is_empty());
    ledger.give_back(lease.lease, failed()).await.unwrap();
    assert!(looks(2).await.is_empty());
    assert_eq!(looks(1).await, [job]);
    let lease = ledger.lease(wants("w", "w.2", 1)).await.unwrap()[0].clone();
    ledger
        .complete(lease.lease, result(lease.items, 1, 1))
        .await
        .unwrap();
    assert_eq!(looks(3).await, [job]);
    // All rights are kept together, and those of others are left alone.
    clock.advance_ms(50_000);
    ledger.renew_stewardships(&me, 60_000).await.unwrap();
    clock.advance_ms(50_000);
    ledger
        .renew_stewardships(&coordinator("d"), 60_000)
        .await
        .unwrap();
    assert_eq!(
        ledger.steward(job, &coordinator("d"), 1000).await.unwrap(),
        None
    );
    assert_eq!(ledger.steward(job, &me, 1000).await.unwrap(), Some(epoch));
    // The right to drive a job that has ended is not renewed.
    clock.advance_ms(1000);
    ledger.renew_stewardships(&me, 60_000).await.unwrap();
    assert_eq!(ledger.attention(&coordinator("d"), 3).await.unwrap(), [job]);
}
