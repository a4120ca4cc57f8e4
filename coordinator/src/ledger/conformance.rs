//! The suite that every ledger passes, and the state machine that compares it with the oracle.
//!
//! `ledger_conformance!(name, open)` runs all of it, where `open` makes an empty
//! ledger on a given clock, together with whatever must live as long.

use super::clock::{Clock, LedgerTime, ManualClock};
use super::identity::*;
use super::rows::*;
use super::rules::NEW_JOB_MICROS;
use super::{Ledger, LedgerError};
use crate::chunks::sizing::Sizing;
use crate::chunks::speculation::Speculation;
use cognate_continuation::work::StageId;
use cognate_numeric::NUMERICS_REVISION;

/// Runs the whole suite on one kind of ledger.
macro_rules! ledger_conformance {
    ($module:ident, $open:expr) => {
        ledger_conformance!(
            $module,
            |clock| async { Some($open(clock).await) },
            optional
        );
    };
    // `$open` gives `None` where this ledger cannot be had here; that is printed and skipped.
    ($module:ident, $open:expr, optional) => {
        mod $module {
            use super::*;
            use crate::ledger::clock::ManualClock;
            use crate::ledger::conformance;
            use std::sync::Arc;

            macro_rules! case {
                ($case:ident) => {
                    #[tokio::test]
                    async fn $case() {
                        let clock = Arc::new(ManualClock::default());
                        if let Some((ledger, _alive)) = ($open)(clock.clone()).await {
                            conformance::$case(&ledger, &clock).await;
                        }
                    }
                };
            }
            case!(a_request_sent_twice_is_one_job);
            case!(a_chunk_is_accepted_once);
            case!(silence_is_a_suspicion_and_a_drain_is_none);
            case!(who_speaks_again_is_not_dead);
            case!(suspects_are_split_and_fail);
            case!(an_old_steward_changes_nothing);
            case!(a_cancelled_job_gives_nothing_out);
            case!(tenants_and_jobs_take_turns);
            case!(who_waits_is_not_overtaken);
            case!(other_numerics_get_no_chunk);
            case!(a_lost_reply_to_a_lease_is_sent_again);
            case!(stages_open_and_close_in_order);
            case!(leases_are_cut_to_size);
            case!(an_audited_chunk_needs_two_that_agree);
            case!(what_an_outvoted_worker_found_is_done_again);
            case!(a_job_that_used_an_outvoted_worker_fails);
            case!(a_late_chunk_is_given_to_an_idle_worker);
            case!(who_is_late_may_still_be_first);
            case!(who_is_late_may_report_after_the_second_worker_is_lost);
            case!(what_is_suspected_or_not_late_is_not_given_twice);
            case!(an_audit_ends_both_leases);
            case!(one_worker_that_fails_is_one_suspicion);
            case!(who_fails_again_counts_once);
            case!(lost_results_are_done_again);
            case!(a_lease_stands_with_who_has_it);
            case!(jobs_that_only_wait_want_no_look);
            case!(a_job_that_has_ended_is_deleted_once);
            case!(what_is_deleted_stays_deleted);
            case!(votes_are_told_apart_by_credential);
            case!(who_is_alone_is_not_audited);
            case!(a_lost_vote_accuses_nobody);
            case!(a_name_belongs_to_its_credential);

            #[test]
            fn it_agrees_with_the_oracle() {
                let runtime = tokio::runtime::Builder::new_current_thread()
                    .enable_all()
                    .build()
                    .expect("a runtime starts");
                crate::ledger::state_machine::compare(
                    |clock| runtime.block_on(($open)(clock)),
                    &runtime,
                );
            }
        }
    };
}
pub(crate) use ledger_conformance;

mod credentials;
mod removal;
mod speculation;
mod suspicion;
pub use self::credentials::*;
pub use self::removal::*;
pub use self::speculation::*;
pub use self::suspicion::*;

/// No suspicion is later.
const EVER: LedgerTime = LedgerTime(i64::MAX);

/// A job of these properties.
pub fn new_job(tenant: &str, content: u8) -> NewJob {
    NewJob {
        tenant: Tenant::new(tenant).expect("tests use good names"),
        label: "test".into(),
        problem: digest_of(&[content]),
        options: vec![content, 255],
        numerics_revision: NUMERICS_REVISION,
    }
}

/// A request id.
pub fn request(name: &str) -> RequestId {
    RequestId::new(name).expect("tests use good names")
}

/// A worker's id.
pub fn worker(name: &str) -> WorkerId {
    WorkerId::new(name).expect("tests use good names")
}

/// A coordinator's id.
pub fn coordinator(name: &str) -> CoordinatorId {
    CoordinatorId::new(name).expect("tests use good names")
}

/// A request for chunks.
pub fn wants(who: &str, name: &str, slots: u32) -> LeaseRequest {
    LeaseRequest {
        worker: worker(who),
        request: request(name),
        numerics_revision: NUMERICS_REVISION,
        threads: 1,
        slots,
        duration_ms: 1000,
        sizing: Sizing::default(),
        speculation: Speculation::default(),
        suspicion_limit: 3,
        in_flight_limit: 1000,
        without: Vec::new(),
    }
}

/// A stage in chunks of equal size, the last one smaller.
pub fn stage(number: u32, items: u64, chunk: u64) -> NewStage {
    let cuts = (0..items.div_ceil(chunk)).map(|k| ItemRange {
        first: k * chunk,
        last: ((k + 1) * chunk).min(items),
    });
    NewStage {
        stage: StageId(number),
        definition: digest_of(&number.to_le_bytes()),
        items,
        chunks: cuts.collect(),
    }
}

/// A result for these items.
pub fn result(items: ItemRange, hash: u8, cpu_micros: u64) -> ResultObject {
    ResultObject {
        items,
        address: format!("object-{}-{hash}", items.first),
        hash: digest_of(&[hash]),
        cpu_micros,
        outcomes: Outcomes {
            regular: items.len(),
            ..Outcomes::default()
        },
    }
}

/// A running job with one open stage.
async fn running(
    ledger: &dyn Ledger,
    name: &str,
    tenant: &str,
    items: u64,
    chunk: u64,
) -> (JobId, Epoch) {
    let job = ledger
        .submit(request(name), new_job(tenant, 0))
        .await
        .unwrap()
        .job;
    let epoch = ledger
        .steward(job, &coordinator("c"), 60_000)
        .await
        .unwrap()
        .expect("nobody else drives it");
    let open = Advance {
        open: vec![stage(0, items, chunk)],
        ..Advance::default()
    };
    ledger.advance(job, epoch, open).await.unwrap();
    (job, epoch)
}

async fn counts(ledger: &dyn Ledger, job: JobId) -> (u64, u64, u64, u64) {
    let stages = ledger.stages(job).await.unwrap();
    for stage in &stages {
        assert_eq!(stage.accounted(), stage.items, "the counts must add up");
    }
    let s = &stages[0];
    (
        s.ready.items,
        s.leased.items,
        s.accepted.items,
        s.failed.items,
    )
}

pub async fn a_request_sent_twice_is_one_job(ledger: &dyn Ledger, _: &ManualClock) {
    let first = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
    let repeated_submission = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
    assert!(first.is_new && !repeated_submission.is_new);
    assert_eq!(first.job, repeated_submission.job);
    let other = ledger.submit(request("r"), new_job("t", 2)).await;
    assert!(matches!(other, Err(LedgerError::RequestReused(_))));
    let second = ledger.submit(request("s"), new_job("t", 1)).await.unwrap();
    let jobs = ledger.jobs(10).await.unwrap();
    let listed: Vec<_> = jobs.iter().map(|j| (j.job, j.number, j.state)).collect();
    let queued = JobState::Queued;
    assert_eq!(listed, [(first.job, 1, queued), (second.job, 2, queued)]);
    assert_eq!(jobs[0].asked, new_job("t", 1));
    assert_eq!(ledger.jobs(1).await.unwrap(), jobs[1..]);
}

pub async fn a_chunk_is_accepted_once(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 10, 10).await;
    let leases = ledger.lease(wants("w", "1", 1)).await.unwrap();
    let old = leases[0].clone();
    assert_eq!(old.items, ItemRange { first: 0, last: 8 });
    // It falls silent, and another takes the chunk.
    clock.advance_ms(1000);
    assert_eq!(ledger.expire().await.unwrap().len(), 1);
    let new = ledger.lease(wants("v", "1", 1)).await.unwrap()[0].clone();
    assert_eq!(new.lease.chunk, old.lease.chunk);
    assert!(new.lease.epoch > old.lease.epoch);
    let late = ledger.complete(old.lease, result(old.items, 1, 5)).await;
    assert_eq!(late.unwrap(), Completion::Stale);
    let renewals = ledger.renew(&[old.lease, new.lease], 1000).await.unwrap();
    assert_eq!(renewals[0], Renewal::Lost);
    assert_eq!(renewals[1], Renewal::Until(clock.now().after_ms(1000)));
    let object = result(new.items, 1, 5);
    let accepted = ledger.complete(new.lease, object.clone()).await.unwrap();
    assert_eq!(accepted, Completion::Accepted);
    let repeated_report = ledger.complete(new.lease, object.clone()).await.unwrap();
    assert_eq!(repeated_report, Completion::AlreadyAccepted);
    let late = ledger.complete(old.lease, object.clone()).await.unwrap();
    assert_eq!(late, Completion::Stale);
    let other = ledger.complete(new.lease, result(new.items, 2, 5)).await;
    assert_eq!(other.unwrap(), Completion::HashDiffers);
    assert_eq!(counts(ledger, job).await, (2, 0, 8, 0));
    let finished = ledger
        .finished_chunks(job, StageId(0), 0, 10)
        .await
        .unwrap();
    let state = ChunkState::Accepted {
        worker: worker("v"),
        result: object,
    };
    assert_eq!(finished.len(), 1);
    assert_eq!(finished[0].state, state);
}

pub async fn silence_is_a_suspicion_and_a_drain_is_none(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 5, 5).await;
    let lease = ledger.lease(wants("w", "1", 1)).await.unwrap()[0].clone();
    ledger
        .give_back(lease.lease, GiveBack::Drained)
        .await
        .unwrap();
    assert_eq!(counts(ledger, job).await, (5, 0, 0, 0));
    assert!(ledger.suspects(job, 1, EVER).await.unwrap().is_empty());
    let lease = ledger.lease(wants("w", "2", 1)).await.unwrap()[0].clone();
    let reason = "it crashed".to_owned();
    let failed = GiveBack::Failed { reason };
    ledger.give_back(lease.lease, failed.clone()).await.unwrap();
    // Said twice it counts once.
    ledger.give_back(lease.lease, failed).await.unwrap();
    assert_eq!(
        ledger.suspects(job, 1, EVER).await.unwrap()[0].suspicions,
        1
    );
    let lease = ledger.lease(wants("w", "3", 1)).await.unwrap()[0].clone();
    clock.advance_ms(999);
    assert!(ledger.expire().await.unwrap().is_empty());
    clock.advance_ms(1);
    let expired = ledger.expire().await.unwrap();
    let expected = Expired {
        lease: lease.lease,
        worker: worker("w"),
        suspicions: 2,
    };
    assert_eq!(expired, [expected]);
    assert_eq!(counts(ledger, job).await, (5, 0, 0, 0));
}

/// Workers that are here.
async fn here(ledger: &dyn Ledger, names: &[&str]) {
    for name in names {
        ledger.seen(seen(name, 1)).await.unwrap();
    }
}

/// The next chunk for this worker, whole.
async fn take(ledger: &dyn Ledger, who: &str, name: &str) -> Lease {
    let mut wanted = wants(who, name, 1);
    wanted.duration_ms = 60_000;
    ledger.lease(wanted).await.unwrap()[0].clone()
}

pub async fn an_audited_chunk_needs_two_that_agree(ledger: &dyn Ledger, _: &ManualClock) {
    here(ledger, &["u", "v", "w"]).await;
    let (job, _) = running(ledger, "r", "t", 8, 8).await;
    let first = take(ledger, "v", "1").await;
    let agreed_result = result(first.items, 1, 5);
    let done = ledger
        .confirm(first.lease, agreed_result.clone(), Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(done, Completion::Unconfirmed);
    assert_eq!(counts(ledger, job).await, (8, 0, 0, 0));
    // The answer was lost; and it does not change its mind.
    let repeated_vote = ledger
        .confirm(first.lease, agreed_result.clone(), Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(repeated_vote, Completion::Unconfirmed);
    let other = ledger
        .confirm(first.lease, result(first.items, 2, 5), Confirmation::Doubt)
        .await;
    assert_eq!(other.unwrap(), Completion::HashDiffers);
    // Not the same worker again, while there are others.
    assert!(ledger.lease(wants("v", "2", 1)).await.unwrap().is_empty());
    let second = take(ledger, "w", "1").await;
    assert_eq!(second.items, first.items, "the whole chunk");
    let done = ledger
        .confirm(
            second.lease,
            result(second.items, 2, 5),
            Confirmation::Doubt,
        )
        .await;
    assert_eq!(done.unwrap(), Completion::Unconfirmed);
    let third = take(ledger, "u", "1").await;
    let done = ledger
        .confirm(third.lease, agreed_result, Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(done, Completion::Accepted);
    assert_eq!(counts(ledger, job).await, (0, 0, 8, 0));
    let rows = ledger.workers(9).await.unwrap();
    let evicted: Vec<_> = rows.iter().filter(|row| row.evicted).collect();
    assert_eq!(evicted.len(), 1);
    assert_eq!(evicted[0].says.worker, worker("w"));
    let refused = ledger.lease(wants("w", "3", 1)).await;
    assert!(matches!(refused, Err(LedgerError::Evicted(_))));
    assert!(ledger.lease(wants("v", "3", 1)).await.unwrap().is_empty());
}

pub async fn what_an_outvoted_worker_found_is_done_again(ledger: &dyn Ledger, _: &ManualClock) {
    here(ledger, &["u", "v", "w"]).await;
    let (job, old) = running(ledger, "r", "t", 32, 8).await;
    // One chunk that nobody looks at, one that it has, one that is audited.
    let alone = take(ledger, "w", "1").await;
    let done = ledger
        .complete(alone.lease, result(alone.items, 7, 5))
        .await;
    assert_eq!(done.unwrap(), Completion::Accepted);
    let audited = take(ledger, "w", "2").await;
    let held = take(ledger, "w", "3").await;
    let done = ledger
        .confirm(
            audited.lease,
            result(audited.items, 7, 5),
            Confirmation::Doubt,
        )
        .await;
    assert_eq!(done.unwrap(), Completion::Unconfirmed);
    for who in ["u", "v"] {
        let lease = take(ledger, who, "1").await;
        assert_eq!(lease.items, audited.items);
        let right_result = result(lease.items, 1, 5);
        ledger
            .confirm(lease.lease, right_result, Confirmation::Doubt)
            .await
            .unwrap();
    }
    assert_eq!(counts(ledger, job).await, (24, 0, 8, 0));
    let late = ledger.complete(held.lease, result(held.items, 7, 5)).await;
    assert_eq!(late.unwrap(), Completion::Stale);
    let new_lease = take(ledger, "u", "2").await;
    assert_eq!(new_lease.items, alone.items);
    assert!(
        new_lease.lease.epoch > alone.lease.epoch,
        "its object has another place"
    );
    // The former steward has read results that were taken back.
    let refused = ledger.advance(job, old, Advance::default()).await;
    assert!(matches!(refused, Err(LedgerError::Fenced(_))));
    let new = ledger.steward(job, &coordinator("c"), 1000).await.unwrap();
    assert!(new > Some(old));
}

pub async fn a_job_that_used_an_outvoted_worker_fails(ledger: &dyn Ledger, _: &ManualClock) {
    here(ledger, &["u", "v", "w"]).await;
    let (job, epoch) = running(ledger, "r", "t", 8, 8).await;
    let used = take(ledger, "w", "1").await;
    ledger
        .complete(used.lease, result(used.items, 7, 5))
        .await
        .unwrap();
    let step = Advance {
        close: vec![StageId(0)],
        open: vec![stage(1, 8, 8)],
        ..Advance::default()
    };
    ledger.advance(job, epoch, step).await.unwrap();
    for (who, hash) in [("w", 7), ("u", 1), ("v", 1)] {
        let lease = take(ledger, who, "2").await;
        let object = result(lease.items, hash, 5);
        ledger
            .confirm(lease.lease, object, Confirmation::Doubt)
            .await
            .unwrap();
    }
    let row = ledger.job(job).await.unwrap().unwrap();
    assert_eq!(row.state, JobState::Failed);
    assert!(row.reason.unwrap().contains("worker w computed wrongly"));
}

pub async fn who_speaks_again_is_not_dead(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 5, 5).await;
    for round in 0..5 {
        // Every renewal comes too late, and the worker asks again.
        let wanted = wants("w", &format!("session.{round}"), 1);
        assert_eq!(
            ledger.lease(wanted).await.unwrap().len(),
            1,
            "round {round}"
        );
        clock.advance_ms(1000);
        assert_eq!(ledger.expire().await.unwrap()[0].suspicions, 1);
    }
    let ended = clock.now();
    let before = LedgerTime(ended.0 - 1);
    assert!(ledger.suspects(job, 1, before).await.unwrap().is_empty());
    assert_eq!(ledger.suspects(job, 1, ended).await.unwrap().len(), 1);
    // The process is another, though it has the same name: the first one is dead.
    let other = ledger.lease(wants("w", "other.0", 1)).await.unwrap();
    assert_eq!(other.len(), 1);
    clock.advance_ms(1000);
    assert_eq!(ledger.expire().await.unwrap()[0].suspicions, 2);
    assert!(!ledger.suspects(job, 2, EVER).await.unwrap().is_empty());
}

pub async fn suspects_are_split_and_fail(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, epoch) = running(ledger, "r", "t", 5, 5).await;
    for round in 0..3 {
        let wanted = wants("w", &format!("r{round}"), 1);
        assert_eq!(ledger.lease(wanted).await.unwrap().len(), 1);
        clock.advance_ms(1000);
        ledger.expire().await.unwrap();
    }
    assert!(ledger.lease(wants("w", "n", 1)).await.unwrap().is_empty());
    let suspect = ledger.suspects(job, 3, EVER).await.unwrap()[0].clone();
    let piece = |first, last| Piece {
        items: ItemRange { first, last },
        suspicions: if first == 2 { 3 } else { 0 },
        alone: true,
    };
    let gap = [piece(0, 2), piece(3, 5)];
    let refused = ledger.split(suspect.chunk, epoch, &gap).await;
    assert!(matches!(refused, Err(LedgerError::NotAPartition(_))));
    let pieces = [piece(0, 2), piece(2, 3), piece(3, 5)];
    ledger.split(suspect.chunk, epoch, &pieces).await.unwrap();
    let leases = ledger.lease(wants("w", "m", 5)).await.unwrap();
    assert_eq!(leases.len(), 1, "a chunk that is alone stays alone");
    assert_eq!(leases[0].items, piece(0, 2).items);
    assert!(ledger.lease(wants("w", "o", 5)).await.unwrap().is_empty());
    let suspect = ledger.suspects(job, 3, EVER).await.unwrap()[0].clone();
    let verdict = result(suspect.items, 0, 0);
    ledger
        .fail_item(suspect.chunk, epoch, verdict.clone())
        .await
        .unwrap();
    assert_eq!(counts(ledger, job).await, (2, 2, 0, 1));
    let twice = ledger.fail_item(suspect.chunk, epoch, verdict).await;
    assert!(matches!(twice, Err(LedgerError::NotAPartition(_))));
}

pub async fn an_old_steward_changes_nothing(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, old) = running(ledger, "r", "t", 5, 5).await;
    let (a, b) = (coordinator("c"), coordinator("d"));
    assert_eq!(ledger.steward(job, &b, 1000).await.unwrap(), None);
    assert_eq!(ledger.steward(job, &a, 1000).await.unwrap(), Some(old));
    clock.advance_ms(1000);
    let new = ledger.steward(job, &b, 1000).await.unwrap().unwrap();
    assert!(new > old);
    assert_eq!(ledger.steward(job, &a, 1000).await.unwrap(), None);
    let end = JobEnd::Failed { reason: "x".into() };
    for refused in [
        ledger.advance(job, old, Advance::default()).await,
        ledger.finish(job, old, end.clone()).await,
    ] {
        assert!(matches!(refused, Err(LedgerError::Fenced(_))));
    }
    ledger.finish(job, new, end.clone()).await.unwrap();
    let row = ledger.job(job).await.unwrap().unwrap();
    assert_eq!(
        (row.state, row.reason),
        (JobState::Failed, Some("x".into()))
    );
    assert_eq!(row.ended, Some(clock.now()));
    let twice = ledger.finish(job, new, end).await;
    assert!(matches!(twice, Err(LedgerError::Fenced(_))));
    assert_eq!(ledger.steward(job, &b, 1000).await.unwrap(), None);
    assert!(ledger.unfinished_jobs().await.unwrap().is_empty());
}

pub async fn a_cancelled_job_gives_nothing_out(ledger: &dyn Ledger, _: &ManualClock) {
    let (job, epoch) = running(ledger, "r", "t", 5, 1).await;
    let lease = ledger.lease(wants("w", "1", 1)).await.unwrap()[0].clone();
    assert_eq!(ledger.cancel(job, "no").await.unwrap(), Cancelled::Now);
    let state = JobState::Cancelled;
    assert_eq!(
        ledger.cancel(job, "no").await.unwrap(),
        Cancelled::HadEnded(state)
    );
    assert!(ledger.lease(wants("w", "2", 1)).await.unwrap().is_empty());
    let late = ledger
        .complete(lease.lease, result(lease.items, 1, 1))
        .await;
    assert_eq!(late.unwrap(), Completion::Stale);
    assert_eq!(counts(ledger, job).await, (5, 0, 0, 0));
    let refused = ledger.advance(job, epoch, Advance::default()).await;
    assert!(matches!(refused, Err(LedgerError::Fenced(_))));
    let unknown = ledger.cancel(JobId(7), "no").await;
    assert!(matches!(unknown, Err(LedgerError::UnknownJob(JobId(7)))));
}

pub async fn tenants_and_jobs_take_turns(ledger: &dyn Ledger, _: &ManualClock) {
    let (a, _) = running(ledger, "a", "t", 1000, 1).await;
    let (b, _) = running(ledger, "b", "t", 1000, 1).await;
    let (c, _) = running(ledger, "c", "u", 1000, 1).await;
    let mut got = std::collections::BTreeMap::new();
    for round in 0..40 {
        let lease = ledger
            .lease(wants("w", &format!("r{round}"), 1))
            .await
            .unwrap()[0]
            .clone();
        // Items of job `a` cost three times as much.
        let cost = if lease.lease.chunk.job == a {
            3000
        } else {
            1000
        };
        *got.entry(lease.lease.chunk.job).or_insert(0) += cost;
        ledger
            .complete(lease.lease, result(lease.items, 1, cost))
            .await
            .unwrap();
    }
    let (a, b, c) = (got[&a], got[&b], got[&c]);
    // The second began behind the first.
    let b_and_behind = b + NEW_JOB_MICROS.unsigned_abs();
    assert!(
        a.abs_diff(b_and_behind) <= 3000,
        "jobs of a tenant share: {a} {b}"
    );
    assert!((a + b).abs_diff(c) <= 3000, "tenants share: {a} {b} {c}");
}

pub async fn who_waits_is_not_overtaken(ledger: &dyn Ledger, _: &ManualClock) {
    // The item of this job is charged a millisecond, and takes a thousandth of it.
    running(ledger, "a", "t", 1, 1).await;
    let cheap = ledger.lease(wants("w", "1", 1)).await.unwrap()[0].clone();
    let (second, _) = running(ledger, "b", "t", 1, 1).await;
    let object = result(cheap.items, 1, 1);
    ledger.complete(cheap.lease, object).await.unwrap();
    let (third, _) = running(ledger, "c", "t", 1, 1).await;
    for (name, expected) in [("2", second), ("3", third)] {
        let lease = &ledger.lease(wants("w", name, 1)).await.unwrap()[0];
        assert_eq!(lease.lease.chunk.job, expected);
    }
}

pub async fn other_numerics_get_no_chunk(ledger: &dyn Ledger, _: &ManualClock) {
    running(ledger, "r", "t", 5, 5).await;
    let mut wanted = wants("w", "1", 1);
    wanted.numerics_revision = NUMERICS_REVISION + 1;
    assert!(ledger.lease(wanted.clone()).await.unwrap().is_empty());
    wanted.numerics_revision = NUMERICS_REVISION;
    assert_eq!(ledger.lease(wanted).await.unwrap().len(), 1);
}

pub async fn a_lost_reply_to_a_lease_is_sent_again(ledger: &dyn Ledger, clock: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 100, 10).await;
    let first = ledger.lease(wants("w", "1", 2)).await.unwrap();
    assert_eq!(first.len(), 2);
    clock.advance_ms(500);
    let repeated_leases = ledger.lease(wants("w", "1", 2)).await.unwrap();
    let ids = |leases: &[Lease]| leases.iter().map(|l| l.lease).collect::<Vec<_>>();
    assert_eq!(ids(&repeated_leases), ids(&first));
    assert_eq!(repeated_leases[0].until, clock.now().after_ms(1000));
    let next = ledger.lease(wants("w", "2", 1)).await.unwrap();
    assert!(!ids(&first).contains(&next[0].lease));
    let mut limited = wants("v", "1", 9);
    limited.in_flight_limit = 3;
    assert!(ledger.lease(limited).await.unwrap().is_empty());
    let stage = &ledger.stages(job).await.unwrap()[0];
    assert_eq!(stage.leased.chunks, 3);
    ledger.seen(seen("w", 1)).await.unwrap();
    let row = &ledger.workers(1).await.unwrap()[0];
    assert_eq!((row.leased_chunks, row.chunks_done), (3, 0));
}

/// Description of a worker, as it is sent with its calls.
pub fn seen(who: &str, threads: u32) -> WorkerSeen {
    WorkerSeen {
        worker: worker(who),
        version: "0.1.0".into(),
        numerics_revision: NUMERICS_REVISION,
        instruction_set: "avx2".into(),
        threads,
        lane_width: 8,
        host: "here".into(),
        transport: "grpc".into(),
        draining: false,
        credential: Credential(format!("token-of-{who}")),
    }
}

pub async fn stages_open_and_close_in_order(ledger: &dyn Ledger, _: &ManualClock) {
    let (job, epoch) = running(ledger, "r", "t", 5, 5).await;
    let step = |close: &[u32], open: Vec<NewStage>| Advance {
        close: close.iter().map(|&s| StageId(s)).collect(),
        open,
        snapshot: Some(digest_of(b"snapshot")),
    };
    let mut gap = stage(1, 5, 1);
    gap.chunks.remove(2);
    for wrong in [
        step(&[0], vec![]),
        step(&[7], vec![]),
        step(&[], vec![stage(0, 5, 5)]),
        step(&[], vec![stage(1, 5, 5), stage(1, 5, 5)]),
        step(&[], vec![gap]),
    ] {
        let refused = ledger.advance(job, epoch, wrong).await;
        assert!(matches!(refused, Err(LedgerError::StageOrder(..))));
    }
    assert_eq!(ledger.job(job).await.unwrap().unwrap().snapshot, None);
    let lease = ledger.lease(wants("w", "1", 1)).await.unwrap()[0].clone();
    ledger
        .complete(lease.lease, result(lease.items, 1, 1))
        .await
        .unwrap();
    let next = step(&[0], vec![stage(1, 0, 1), stage(2, 3, 2)]);
    ledger.advance(job, epoch, next).await.unwrap();
    let row = ledger.job(job).await.unwrap().unwrap();
    assert_eq!(row.snapshot, Some(digest_of(b"snapshot")));
    let stages = ledger.stages(job).await.unwrap();
    let closed: Vec<bool> = stages.iter().map(|s| s.closed).collect();
    assert_eq!(closed, [true, false, false]);
    assert!(stages[1].is_complete(), "a stage of no items is complete");
    assert_eq!(
        stages[2].ready,
        Count {
            items: 3,
            chunks: 2
        }
    );
    assert_eq!(stages[0].outcomes.regular, 5);
    let (other, _) = running(ledger, "another", "t", 2, 2).await;
    let row = |job| async move { ledger.job(job).await.unwrap().unwrap() };
    let overviews = [
        (row(job).await, stages),
        (row(other).await, ledger.stages(other).await.unwrap()),
    ];
    assert_eq!(ledger.overviews(10).await.unwrap(), overviews);
    assert_eq!(ledger.overviews(1).await.unwrap(), overviews[1..]);
}

pub async fn leases_are_cut_to_size(ledger: &dyn Ledger, _: &ManualClock) {
    let (job, _) = running(ledger, "r", "t", 128, 128).await;
    ledger.seen(seen("w", 1)).await.unwrap();
    ledger.seen(seen("v", 1)).await.unwrap();
    let mut sizes = Vec::new();
    for round in 0.. {
        let who = ["v", "w"][round % 2];
        let wanted = wants(who, &format!("r{round}"), 1);
        let Some(lease) = ledger.lease(wanted).await.unwrap().pop() else {
            break;
        };
        sizes.push(lease.items.len());
        ledger
            .complete(
                lease.lease,
                result(lease.items, 1, 3000 * lease.items.len()),
            )
            .await
            .unwrap();
    }
    assert_eq!(sizes.iter().sum::<u64>(), 128);
    assert_eq!(sizes[0], 16);
    assert!(sizes[1] > sizes[sizes.len() - 2], "they shrink: {sizes:?}");
    let by = ledger.contributions(job).await.unwrap();
    assert_eq!(by.iter().map(|c| c.items).sum::<u64>(), 128);
    assert_eq!(by[0].transport, "grpc");
    assert!(by.iter().all(|c| c.items > 40));
}
