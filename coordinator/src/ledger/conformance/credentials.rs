//! Conformance of every ledger about credentials: votes are told apart by them, and names belong to them.

use super::*;
use crate::ledger::clock::ManualClock;

async fn arrives(ledger: &dyn Ledger, who: &str, credential: &str) {
    let says = WorkerSeen {
        credential: Credential(credential.to_owned()),
        ..seen(who, 1)
    };
    ledger.seen(says).await.unwrap();
}

async fn votes(ledger: &dyn Ledger, lease: &Lease, hash: u8) -> Completion {
    let object = result(lease.items, hash, 5);
    let done = ledger.confirm(lease.lease, object, Confirmation::Doubt);
    done.await.unwrap()
}

pub async fn votes_are_told_apart_by_credential(ledger: &dyn Ledger, clock: &ManualClock) {
    arrives(ledger, "e1", "evil").await;
    arrives(ledger, "e2", "evil").await;
    arrives(ledger, "h", "honest").await;
    let (job, _) = running(ledger, "r", "t", 8, 8).await;
    let first = take(ledger, "e1", "1").await;
    assert_eq!(votes(ledger, &first, 7).await, Completion::Unconfirmed);
    // A second name with the same token confirms nothing while another token is here.
    assert!(ledger.lease(wants("e2", "1", 1)).await.unwrap().is_empty());
    let second = take(ledger, "h", "1").await;
    assert_eq!(votes(ledger, &second, 1).await, Completion::Unconfirmed);
    // They differ: nobody of these decides, however long it takes.
    for (who, number) in [("e1", "2"), ("e2", "2"), ("h", "2")] {
        let leases = ledger.lease(wants(who, number, 1)).await.unwrap();
        assert!(leases.is_empty(), "{who}");
    }
    let disputes = ledger.disputes().await.unwrap();
    assert_eq!(disputes.len(), 1);
    let said: Vec<_> = disputes[0]
        .votes
        .iter()
        .map(|vote| (vote.worker.as_str(), vote.credential.0.as_str()))
        .collect();
    assert_eq!(said, [("e1", "evil"), ("h", "honest")]);
    ledger.strike(first.lease, Strike::Wrong).await.unwrap();
    assert!(ledger.disputes().await.unwrap().is_empty());
    let rows = ledger.workers(9).await.unwrap();
    let evicted: Vec<_> = rows.iter().filter(|row| row.evicted).collect();
    assert_eq!(evicted.len(), 1);
    assert_eq!(evicted[0].says.worker, worker("e1"));
    // The other vote stands, and waits for somebody else's.
    let third = take(ledger, "e2", "3").await;
    assert_eq!(votes(ledger, &third, 1).await, Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 8, 0));
    // Struck again, or after the end: nothing changes.
    ledger.strike(first.lease, Strike::Wrong).await.unwrap();
    ledger.strike(second.lease, Strike::Wrong).await.unwrap();
    let rows = ledger.workers(9).await.unwrap();
    assert_eq!(rows.iter().filter(|row| row.evicted).count(), 1);
    clock.advance_ms(1);
}

pub async fn who_is_alone_is_not_audited(ledger: &dyn Ledger, clock: &ManualClock) {
    arrives(ledger, "v", "one").await;
    arrives(ledger, "w", "two").await;
    let (job, _) = running(ledger, "r", "t", 16, 8).await;
    let first = take(ledger, "v", "1").await;
    let object = result(first.items, 1, 5);
    let done = ledger.confirm(first.lease, object, Confirmation::Audit);
    assert_eq!(done.await.unwrap(), Completion::Unconfirmed);
    // The other has gone, and says so by its silence; nobody is waited for.
    clock.advance_ms(20_000);
    arrives(ledger, "v", "one").await;
    let repeated_lease = take(ledger, "v", "2").await;
    assert_eq!(repeated_lease.items, first.items);
    let object = result(first.items, 1, 5);
    let done = ledger.confirm(repeated_lease.lease, object, Confirmation::Audit);
    assert_eq!(done.await.unwrap(), Completion::Accepted);
    let second = take(ledger, "v", "3").await;
    let object = result(second.items, 1, 5);
    let done = ledger.confirm(second.lease, object, Confirmation::Audit);
    assert_eq!(done.await.unwrap(), Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 16, 0));
}

pub async fn a_lost_vote_accuses_nobody(ledger: &dyn Ledger, _: &ManualClock) {
    arrives(ledger, "v", "one").await;
    arrives(ledger, "w", "two").await;
    running(ledger, "r", "t", 8, 8).await;
    let first = take(ledger, "v", "1").await;
    votes(ledger, &first, 1).await;
    let second = take(ledger, "w", "1").await;
    votes(ledger, &second, 2).await;
    ledger.strike(second.lease, Strike::Lost).await.unwrap();
    let rows = ledger.workers(9).await.unwrap();
    assert!(rows.iter().all(|row| !row.evicted));
    let next_lease = take(ledger, "w", "2").await;
    assert_eq!(votes(ledger, &next_lease, 1).await, Completion::Accepted);
}

pub async fn a_name_belongs_to_its_credential(ledger: &dyn Ledger, clock: &ManualClock) {
    arrives(ledger, "w", "one").await;
    let thief = WorkerSeen {
        credential: Credential("two".to_owned()),
        ..seen("w", 1)
    };
    let refused = ledger.seen(thief.clone()).await;
    assert!(
        matches!(refused, Err(LedgerError::NameTaken(_))),
        "{refused:?}"
    );
    arrives(ledger, "w", "one").await;
    // Once its worker is gone the name is free: a token was replaced, for instance.
    clock.advance_ms(20_000);
    ledger.seen(thief).await.unwrap();
    let row = &ledger.workers(1).await.unwrap()[0];
    assert_eq!(row.says.credential.0, "two");
}
