//! Removal: a job that has ended is deleted with all its rows, once, and its id is never used again.

use super::*;

pub async fn a_job_that_has_ended_is_deleted_once(ledger: &dyn Ledger, _: &ManualClock) {
    let (job, epoch) = running(ledger, "r", "t", 6, 2).await;
    let (other, _) = running(ledger, "other", "t", 4, 4).await;
    let going = ledger.delete(job).await.unwrap();
    assert_eq!(going, Deleted::GoesOn(JobState::Running));
    let leases = ledger.lease(wants("w", "w.1", 2)).await.unwrap();
    let first = leases.iter().find(|lease| lease.lease.chunk.job == job);
    let first = first.expect("jobs take turns").lease;
    let items = ItemRange {
        first: first.chunk.first,
        last: first.chunk.first + 2,
    };
    let object = result(items, 1, 5);
    let done = ledger.complete(first, object.clone()).await.unwrap();
    assert_eq!(done, Completion::Accepted);
    let going = ledger.delete(job).await.unwrap();
    assert_eq!(going, Deleted::GoesOn(JobState::Running));
    assert_eq!(counts(ledger, job).await.2, 2, "nothing was changed");
    ledger.cancel(job, "test").await.unwrap();
    assert!(!ledger.is_deleted(job).await.unwrap());
    let gone = ledger.delete(job).await.unwrap();
    assert_eq!(
        gone,
        Deleted::Now {
            stages: 1,
            chunks: 3
        }
    );
    // A client that did not get the answer calls again.
    assert_eq!(ledger.delete(job).await.unwrap(), Deleted::Before);
    assert!(ledger.is_deleted(job).await.unwrap());
    let unknown = ledger.delete(JobId(7)).await;
    assert!(matches!(unknown, Err(LedgerError::UnknownJob(JobId(7)))));
    assert!(!ledger.is_deleted(JobId(7)).await.unwrap());
    // The other job has lost nothing.
    let rows = ledger.jobs(10).await.unwrap();
    assert_eq!(rows.iter().map(|r| r.job).collect::<Vec<_>>(), [other]);
    assert_eq!(ledger.stages(other).await.unwrap()[0].items, 4);
    // Late calls of a worker or a steward of the deleted job change nothing.
    let late = ledger.complete(first, object).await.unwrap();
    assert_eq!(late, Completion::Stale);
    assert_eq!(ledger.renew(&[first], 10).await.unwrap(), [Renewal::Lost]);
    assert_eq!(ledger.standing(first).await.unwrap(), Standing::Never);
    ledger.give_back(first, GiveBack::Drained).await.unwrap();
    let late = ledger.advance(job, epoch, Advance::default()).await;
    assert!(matches!(late, Err(LedgerError::UnknownJob(_))), "{late:?}");
}

pub async fn what_is_deleted_stays_deleted(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 6, 2).await;
    ledger.cancel(job, "test").await.unwrap();
    ledger.delete(job).await.unwrap();
    clock.advance_ms(1_000_000);
    assert!(ledger.job(job).await.unwrap().is_none());
    let stages = ledger.stages(job).await;
    assert!(matches!(stages, Err(LedgerError::UnknownJob(_))));
    assert!(ledger.lease(wants("w", "w.1", 9)).await.unwrap().is_empty());
    assert!(ledger.expire().await.unwrap().is_empty());
    // A submission that comes late makes no second job of this id; others have numbers of their own.
    let repeated_submission = ledger.submit(request("r"), new_job("t", 0)).await;
    assert!(matches!(
        repeated_submission,
        Err(LedgerError::RequestOfDeleted(_))
    ));
    let next = ledger.submit(request("next"), new_job("t", 0)).await;
    let third = ledger.submit(request("third"), new_job("t", 0)).await;
    ledger.cancel(next.unwrap().job, "test").await.unwrap();
    let third = third.unwrap().job;
    let fourth = ledger.submit(request("fourth"), new_job("t", 0)).await;
    let rows = ledger.jobs(10).await.unwrap();
    assert!(rows.windows(2).all(|two| two[0].number < two[1].number));
    assert_eq!(rows[1].job, third);
    assert_eq!(rows[2].job, fourth.unwrap().job);
}
