//! Any sequence of calls: a ledger and the oracle give the same answers and hold the same rows,
//! and after every call the counts add up and no chunk was accepted twice.

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

#[derive(Clone, Debug)]
enum Call {
    Submit {
        name: u8,
        tenant: u8,
        content: u8,
    },
    Cancel {
        job: usize,
    },
    Delete {
        job: usize,
        again: u8,
    },
    Steward {
        job: usize,
        who: u8,
        duration_ms: u64,
    },
    Open {
        job: usize,
        old_epoch: bool,
        items: u64,
        chunk: u64,
    },
    Close {
        job: usize,
    },
    Split {
        job: usize,
        chunk: usize,
        at: u64,
        suspicions: u32,
        alone: bool,
    },
    FailItem {
        job: usize,
        chunk: usize,
    },
    Finish {
        job: usize,
        solved: bool,
    },
    Lease {
        who: u8,
        name: u8,
        slots: u32,
        threads: u32,
        limit: u32,
        impatient: bool,
    },
    Renew {
        leases: Vec<usize>,
    },
    Complete {
        lease: usize,
        hash: u8,
        cpu_micros: u64,
        other_items: bool,
        audited: bool,
    },
    GiveBack {
        lease: usize,
        failed: bool,
    },
    Strike {
        lease: usize,
        wrong: bool,
    },
    Expire,
    Seen {
        who: u8,
        threads: u32,
    },
    Wait {
        ms: u64,
    },
}

fn call() -> impl Strategy<Value = Call> {
    let job = 0..4usize;
    let lease = 0..1000usize;
    prop_oneof![
        2 => (0..4u8, 0..2u8, 0..8u8).prop_map(|(name, tenant, content)| Call::Submit {
            name, tenant, content: u8::from(content == 0)
        }),
        1 => (job.clone(), 0..4u8).prop_filter_map("rarely", |(job, dice)| {
            (dice == 0).then_some(Call::Cancel { job })
        }),
        1 => (job.clone(), 0..4u8).prop_map(|(job, again)| Call::Delete { job, again }),
        4 => (job.clone(), 0..6u8, 500..4000u64).prop_map(|(job, who, duration_ms)| {
            Call::Steward { job, who: who / 5, duration_ms }
        }),
        5 => (job.clone(), 0..8u8, 0..60u64, 1..40u64).prop_map(|(job, old, items, chunk)| {
            Call::Open { job, old_epoch: old == 0, items, chunk }
        }),
        2 => job.clone().prop_map(|job| Call::Close { job }),
        2 => (job.clone(), 0..9usize, 0..9u64, 0..4u32, any::<bool>()).prop_map(
            |(job, chunk, at, suspicions, alone)| Call::Split { job, chunk, at, suspicions, alone }
        ),
        1 => (job.clone(), 0..9usize).prop_map(|(job, chunk)| Call::FailItem { job, chunk }),
        1 => (job, 0..4u8, any::<bool>()).prop_filter_map("rarely", |(job, dice, solved)| {
            (dice == 0).then_some(Call::Finish { job, solved })
        }),
        10 => (0..3u8, 0..200u8, 0..4u32, 1..5u32, 0..9u32, any::<bool>()).prop_map(
            |(who, name, slots, threads, limit, impatient)| {
                Call::Lease { who, name, slots, threads, limit, impatient }
            }
        ),
        2 => proptest::collection::vec(lease.clone(), 0..4).prop_map(|leases| Call::Renew { leases }),
        10 => (lease.clone(), 0..9u8, 0..90_000u64, 0..12u8, 0..3u8).prop_map(
            |(lease, hash, cpu_micros, other, audited)| Call::Complete {
                lease, hash: u8::from(hash == 0), cpu_micros, other_items: other == 0,
                audited: audited == 0
            }
        ),
        2 => (lease, any::<bool>()).prop_map(|(lease, failed)| Call::GiveBack { lease, failed }),
        1 => (0..1000usize, 0..6u8).prop_map(|(lease, dice)| Call::Strike { lease, wrong: dice == 0 }),
        3 => Just(Call::Expire),
        2 => (0..3u8, 1..9u32).prop_map(|(who, threads)| Call::Seen { who, threads }),
        4 => (0..900u64).prop_map(|ms| Call::Wait { ms }),
    ]
}

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

impl Pair<'_> {
    async fn run(&self, calls: &[Call]) {
        let mut leases: Vec<Lease> = Vec::new();
        let mut accepted: BTreeSet<(StageOf, u64)> = BTreeSet::new();
        let mut evicted = 0;
        for call in calls {
            self.carry_out(call, &mut leases, &mut accepted, &mut evicted)
                .await;
            self.check(&accepted).await;
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
    async fn delete(&self, index: usize, again: u8, accepted: &mut BTreeSet<(StageOf, u64)>) {
        let job = match self.job(index).await {
            Some(row) => row.job,
            None => JobId::of_request(&request(&format!("r{again}"))),
        };
        if let Some(Deleted::Now { .. }) = both!(self, delete(job)) {
            accepted.retain(|((of, _), _)| *of != job);
        }
        both!(self, is_deleted(job));
        both!(self, job(job));
        both!(self, stages(job));
    }

    async fn job(&self, index: usize) -> Option<JobRow> {
        let jobs = both!(self, jobs(10)).unwrap_or_default();
        jobs.get(index).cloned()
    }

    async fn carry_out(
        &self,
        call: &Call,
        leases: &mut Vec<Lease>,
        accepted: &mut BTreeSet<(StageOf, u64)>,
        evicted: &mut usize,
    ) {
        match call.clone() {
            Call::Submit {
                name,
                tenant,
                content,
            } => {
                let tenant = format!("t{tenant}");
                let name = format!("r{name}");
                both!(self, submit(request(&name), new_job(&tenant, content)));
            }
            Call::Wait { ms } => self.clock.advance_ms(ms),
            Call::Expire => {
                both!(self, expire());
            }
            Call::Seen { who, threads } => {
                both!(self, seen(seen(&format!("w{who}"), threads)));
            }
            Call::Lease {
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
                leases.extend(both!(self, lease(wanted.clone())).unwrap_or_default());
            }
            Call::Renew { leases: which } => {
                let ids: Vec<LeaseId> = which
                    .iter()
                    .filter_map(|&i| leases.iter().rev().nth(i % 8))
                    .map(|l| l.lease)
                    .collect();
                both!(self, renew(&ids, 700));
            }
            Call::Complete {
                lease,
                hash,
                cpu_micros,
                other_items,
                audited,
            } => {
                let Some(lease) = leases.iter().rev().nth(lease % 12) else {
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
                // Of a worker that was never heard of no list says so.
                let is_wrong = audited && why == Confirmation::Wrong;
                if others > *evicted || is_wrong {
                    // What only that worker has found is done again.
                    (*evicted, *accepted) = (others, self.accepted().await);
                    return;
                }
                if done == Some(Completion::Accepted) {
                    let ChunkId { job, stage, .. } = lease.lease.chunk;
                    for item in items.first..items.last {
                        let new = accepted.insert(((job, stage), item));
                        assert!(new, "item {item} was accepted twice");
                    }
                    if audited {
                        // One that was outvoted and never heard of.
                        *accepted = self.accepted().await;
                    }
                }
            }
            Call::Strike { lease, wrong } => {
                let Some(lease) = leases.iter().rev().nth(lease % 12) else {
                    return;
                };
                let why = match wrong {
                    true => Strike::Wrong,
                    false => Strike::Lost,
                };
                both!(self, disputes());
                both!(self, strike(lease.lease, why));
                let workers = both!(self, workers(10)).unwrap_or_default();
                *evicted = workers.iter().filter(|worker| worker.evicted).count();
                *accepted = self.accepted().await;
            }
            Call::GiveBack { lease, failed } => {
                let Some(lease) = leases.iter().rev().nth(lease % 12) else {
                    return;
                };
                let reason = "test".to_owned();
                let why = match failed {
                    true => GiveBack::Failed { reason },
                    false => GiveBack::Drained,
                };
                both!(self, give_back(lease.lease, why.clone()));
            }
            Call::Cancel { job } => {
                if let Some(row) = self.job(job).await {
                    both!(self, cancel(row.job, "test"));
                }
            }
            Call::Delete { job, again } => self.delete(job, again, accepted).await,
            Call::Steward {
                job,
                who,
                duration_ms,
            } => {
                if let Some(row) = self.job(job).await {
                    let who = coordinator(&format!("c{who}"));
                    both!(self, steward(row.job, &who, duration_ms));
                }
            }
            Call::Open {
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
            Call::Close { job } => {
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
            Call::Split {
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
            Call::FailItem { job, chunk } => {
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
            Call::Finish { job, solved } => {
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
