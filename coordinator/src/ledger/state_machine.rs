//! Any sequence of calls: a ledger and the oracle give the same answers and hold the same rows,
//! and after every call the counts add up and no chunk was accepted twice.

mod calls;

use self::calls::{Call, JobCall, LeaseCall, StageCall, VerdictCall, call};
use super::clock::{Clock, LedgerTime, ManualClock};
use super::conformance::*;
use super::identity::*;
use super::memory::MemoryLedger;
use super::rows::*;
use super::{Ledger, LedgerError};
use cognate_continuation::work::StageId;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::sync::Arc;
use tokio::runtime::Runtime;

/// No suspicion is later.
const EVER: LedgerTime = LedgerTime(i64::MAX);

/// Runs many sequences; `open` makes an empty ledger on this clock.
pub fn compare<L: Ledger, A>(open: impl Fn(Arc<ManualClock>) -> Option<(L, A)>, runtime: &Runtime) {
    let mut runner = TestRunner::new(ProptestConfig {
        cases: 48,
        failure_persistence: None,
        ..ProptestConfig::default()
    });
    let calls = proptest::collection::vec(call(), 1..90);
    let done = runner.run(&calls, |calls| {
        let clock = Arc::new(ManualClock::default());
        let oracle = MemoryLedger::new(clock.clone());
        let Some((ledger, _alive)) = open(clock.clone()) else {
            return Ok(());
        };
        let pair = Pair {
            oracle: &oracle,
            ledger: &ledger,
            clock,
        };
        runtime.block_on(pair.run(&calls));
        Ok(())
    });
    if let Err(failure) = done {
        panic!("{failure}");
    }
}

struct Pair<'a> {
    oracle: &'a MemoryLedger,
    ledger: &'a dyn Ledger,
    clock: Arc<ManualClock>,
}

/// Answers are compared by what they say; errors too.
fn same<T: Debug>(oracle: Result<T, LedgerError>, ledger: Result<T, LedgerError>) -> Option<T> {
    assert_eq!(format!("{oracle:?}"), format!("{ledger:?}"));
    ledger.ok()
}

macro_rules! both {
    ($pair:expr, $method:ident($($argument:expr),*)) => {
        same(
            $pair.oracle.$method($($argument),*).await,
            $pair.ledger.$method($($argument),*).await,
        )
    };
}

/// Leases and accepted items of the calls so far.
#[derive(Default)]
struct Course {
    /// All leases that were given out, in the order in which they were.
    leases: Vec<Lease>,
    /// Items of accepted chunks.
    accepted: BTreeSet<(StageOf, u64)>,
    /// Number of workers that were evicted.
    evicted: usize,
}

impl Course {
    /// One of the latest leases, counted from the end.
    fn lease(&self, index: usize) -> Option<&Lease> {
        self.leases.iter().rev().nth(index % 12)
    }
}

impl Pair<'_> {
    async fn run(&self, calls: &[Call]) {
        let mut course = Course::default();
        for call in calls {
            self.carry_out(call.clone(), &mut course).await;
            self.check(&course.accepted).await;
        }
    }

    /// The items of all accepted chunks.
    async fn accepted(&self) -> BTreeSet<(StageOf, u64)> {
        let mut accepted = BTreeSet::new();
        for job in both!(self, jobs(10)).unwrap_or_default() {
            for stage in both!(self, stages(job.job)).unwrap_or_default() {
                let finished = both!(self, finished_chunks(job.job, stage.stage, 0, 1000));
                for chunk in finished.unwrap_or_default() {
                    if let ChunkState::Accepted { .. } = chunk.state {
                        let items = chunk.items.first..chunk.items.last;
                        accepted.extend(items.map(|item| ((job.job, stage.stage), item)));
                    }
                }
            }
        }
        accepted
    }

    /// Deletes a job, if it has ended, or one that may have been deleted before.
    async fn delete(&self, index: usize, request_number: u8, course: &mut Course) {
        let job = match self.job(index).await {
            Some(row) => row.job,
            None => JobId::of_request(&request(&format!("r{request_number}"))),
        };
        if let Some(Deleted::Now { .. }) = both!(self, delete(job)) {
            course
                .accepted
                .retain(|((item_job, _), _)| *item_job != job);
        }
        both!(self, is_deleted(job));
        both!(self, job(job));
        both!(self, stages(job));
    }

    async fn job(&self, index: usize) -> Option<JobRow> {
        let jobs = both!(self, jobs(10)).unwrap_or_default();
        jobs.get(index).cloned()
    }

    async fn carry_out(&self, call: Call, course: &mut Course) {
        match call {
            Call::Job(call) => self.job_call(call, course).await,
            Call::Stage(call) => self.stage_call(call).await,
            Call::Lease(call) => self.lease_call(call, course).await,
            Call::Verdict(call) => self.verdict_call(call, course).await,
            Call::Wait { ms } => self.clock.advance_ms(ms),
            Call::Expire => {
                both!(self, expire());
            }
            Call::Seen { who, threads } => {
                both!(self, seen(seen(&format!("w{who}"), threads)));
            }
        }
    }

    async fn job_call(&self, call: JobCall, course: &mut Course) {
        match call {
            JobCall::Submit {
                name,
                tenant,
                content,
            } => {
                let tenant = format!("t{tenant}");
                let name = format!("r{name}");
                both!(self, submit(request(&name), new_job(&tenant, content)));
            }
            JobCall::Cancel { job } => {
                if let Some(row) = self.job(job).await {
                    both!(self, cancel(row.job, "test"));
                }
            }
            JobCall::Delete {
                job,
                again: request_number,
            } => self.delete(job, request_number, course).await,
            JobCall::Steward {
                job,
                who,
                duration_ms,
            } => {
                if let Some(row) = self.job(job).await {
                    let who = coordinator(&format!("c{who}"));
                    both!(self, steward(row.job, &who, duration_ms));
                }
            }
            JobCall::Finish { job, solved } => {
                if let Some(row) = self.job(job).await {
                    let end = if solved {
                        JobEnd::Solved {
                            solutions: digest_of(b"solutions"),
                            summary: digest_of(b"summary"),
                        }
                    } else {
                        JobEnd::Failed {
                            reason: "test".into(),
                        }
                    };
                    both!(self, finish(row.job, row.steward_epoch, end.clone()));
                }
            }
        }
    }

    async fn stage_call(&self, call: StageCall) {
        match call {
            StageCall::Open {
                job,
                old_epoch,
                items,
                chunk,
            } => {
                let Some(row) = self.job(job).await else {
                    return;
                };
                let stages = both!(self, stages(row.job)).unwrap_or_default();
                let step = Advance {
                    open: vec![stage(stages.len() as u32, items, chunk)],
                    ..Advance::default()
                };
                let epoch =
                    Epoch(row.steward_epoch.0 - u64::from(old_epoch && row.steward_epoch.0 > 0));
                both!(self, advance(row.job, epoch, step.clone()));
            }
            StageCall::Close { job } => {
                let Some(row) = self.job(job).await else {
                    return;
                };
                let stages = both!(self, stages(row.job)).unwrap_or_default();
                let open = stages.iter().filter(|s| !s.closed);
                let step = Advance {
                    close: open.take(1).map(|s| s.stage).collect(),
                    open: Vec::new(),
                    snapshot: Some(digest_of(&[job as u8])),
                };
                both!(self, advance(row.job, row.steward_epoch, step.clone()));
            }
            StageCall::Split {
                job,
                chunk,
                at,
                suspicions,
                alone,
            } => {
                let Some(row) = self.job(job).await else {
                    return;
                };
                let ready = both!(self, suspects(row.job, 0, EVER)).unwrap_or_default();
                let Some(chunk) = ready.get(chunk) else {
                    return;
                };
                let at = chunk.items.first + at;
                let piece = |first, last| Piece {
                    items: ItemRange { first, last },
                    suspicions,
                    alone,
                };
                let pieces = [piece(chunk.items.first, at), piece(at, chunk.items.last)];
                both!(self, split(chunk.chunk, row.steward_epoch, &pieces));
            }
            StageCall::FailItem { job, chunk } => {
                let Some(row) = self.job(job).await else {
                    return;
                };
                let ready = both!(self, suspects(row.job, 0, EVER)).unwrap_or_default();
                if let Some(chunk) = ready.get(chunk) {
                    let verdict = result(chunk.items, 9, 0);
                    let epoch = row.steward_epoch;
                    both!(self, fail_item(chunk.chunk, epoch, verdict.clone()));
                }
            }
        }
    }

    async fn lease_call(&self, call: LeaseCall, course: &mut Course) {
        match call {
            LeaseCall::Lease {
                who,
                name,
                slots,
                threads,
                limit,
                impatient,
            } => {
                let mut wanted = wants(&format!("w{who}"), &format!("r{name}"), slots);
                wanted.threads = threads;
                wanted.in_flight_limit = if limit == 0 { 2 } else { 100 };
                if impatient {
                    (wanted.speculation.times, wanted.speculation.least_ms) = (1, 100);
                }
                let leases = both!(self, lease(wanted.clone())).unwrap_or_default();
                course.leases.extend(leases);
            }
            LeaseCall::Renew { leases: positions } => {
                let ids: Vec<LeaseId> = positions
                    .iter()
                    .filter_map(|&i| course.leases.iter().rev().nth(i % 8))
                    .map(|l| l.lease)
                    .collect();
                both!(self, renew(&ids, 700));
            }
            LeaseCall::GiveBack { lease, failed } => {
                let Some(lease) = course.lease(lease) else {
                    return;
                };
                let reason = "test".to_owned();
                let why = if failed {
                    GiveBack::Failed { reason }
                } else {
                    GiveBack::Drained
                };
                both!(self, give_back(lease.lease, why.clone()));
            }
        }
    }

    async fn verdict_call(&self, call: VerdictCall, course: &mut Course) {
        match call {
            VerdictCall::Complete {
                lease,
                hash,
                cpu_micros,
                other_items,
                audited,
            } => {
                let Some(lease) = course.lease(lease) else {
                    return;
                };
                let mut items = lease.items;
                items.last += u64::from(other_items);
                let object = result(items, hash, cpu_micros);
                let why = match cpu_micros % 9 {
                    0 => Confirmation::Wrong,
                    1..5 => Confirmation::Audit,
                    _ => Confirmation::Doubt,
                };
                let done = if audited {
                    both!(self, confirm(lease.lease, object.clone(), why))
                } else {
                    both!(self, complete(lease.lease, object.clone()))
                };
                let workers = both!(self, workers(10)).unwrap_or_default();
                let others = workers.iter().filter(|worker| worker.evicted).count();
                // A worker that was never heard of is in no list.
                let is_wrong = audited && why == Confirmation::Wrong;
                if others > course.evicted || is_wrong {
                    // Chunks that only that worker has done are done again.
                    (course.evicted, course.accepted) = (others, self.accepted().await);
                    return;
                }
                if done == Some(Completion::Accepted) {
                    let ChunkId { job, stage, .. } = lease.lease.chunk;
                    for item in items.first..items.last {
                        let new = course.accepted.insert(((job, stage), item));
                        assert!(new, "item {item} was accepted twice");
                    }
                    if audited {
                        // One that was outvoted and never heard of.
                        course.accepted = self.accepted().await;
                    }
                }
            }
            VerdictCall::Strike { lease, wrong } => {
                let Some(lease) = course.lease(lease) else {
                    return;
                };
                let why = if wrong { Strike::Wrong } else { Strike::Lost };
                both!(self, disputes());
                both!(self, strike(lease.lease, why));
                let workers = both!(self, workers(10)).unwrap_or_default();
                course.evicted = workers.iter().filter(|worker| worker.evicted).count();
                course.accepted = self.accepted().await;
            }
        }
    }

    /// Everything that can be asked is the same, and the counts balance.
    async fn check(&self, accepted: &BTreeSet<(StageOf, u64)>) {
        assert_eq!(both!(self, now()), Some(self.clock.now()));
        both!(self, workers(10));
        both!(self, unfinished_jobs());
        let mut items = 0;
        for row in both!(self, jobs(10)).unwrap_or_default() {
            both!(self, job(row.job));
            both!(self, contributions(row.job));
            let ready = both!(self, suspects(row.job, 0, EVER)).unwrap_or_default();
            both!(self, suspects(row.job, 2, self.clock.now()));
            let before = LedgerTime(self.clock.now().0 - 500);
            both!(self, suspects(row.job, 1, before));
            for stage in both!(self, stages(row.job)).unwrap_or_default() {
                assert_eq!(stage.accounted(), stage.items, "{stage:?}");
                let finished =
                    both!(self, finished_chunks(row.job, stage.stage, 0, 1000)).unwrap_or_default();
                both!(self, finished_chunks(row.job, stage.stage, 7, 2));
                let sum = |rows: &[ChunkRow]| rows.iter().map(|r| r.items.len()).sum::<u64>();
                let done = stage.accepted.items + stage.failed.items;
                assert_eq!(sum(&finished), done);
                let here: Vec<_> = ready
                    .iter()
                    .filter(|r| r.chunk.stage == stage.stage)
                    .cloned()
                    .collect();
                assert_eq!(sum(&here), stage.ready.items);
                items += stage.accepted.items;
            }
        }
        assert_eq!(items, accepted.len() as u64, "what was accepted stays");
    }
}

type StageOf = (JobId, StageId);
