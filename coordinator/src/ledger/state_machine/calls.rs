//! Calls to a ledger, drawn at random; jobs, chunks and leases are named by their place in lists.

use proptest::prelude::*;

/// One call to a ledger, or time that passes.
#[derive(Clone, Debug)]
pub enum Call {
    Job(JobCall),
    Stage(StageCall),
    Lease(LeaseCall),
    Verdict(VerdictCall),
    Expire,
    Seen { who: u8, threads: u32 },
    Wait { ms: u64 },
}

/// A call that makes, ends or removes a job, or gives it a steward.
#[derive(Clone, Debug)]
pub enum JobCall {
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
    Finish {
        job: usize,
        solved: bool,
    },
}

/// A steward's call about a stage of a job or a chunk of it.
#[derive(Clone, Debug)]
pub enum StageCall {
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
}

/// A worker's call that takes, keeps or returns leases.
#[derive(Clone, Debug)]
pub enum LeaseCall {
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
    GiveBack {
        lease: usize,
        failed: bool,
    },
}

/// A call that accepts the result of a lease or counts against its worker.
#[derive(Clone, Debug)]
pub enum VerdictCall {
    Complete {
        lease: usize,
        hash: u8,
        cpu_micros: u64,
        other_items: bool,
        audited: bool,
    },
    Strike {
        lease: usize,
        wrong: bool,
    },
}

/// Draws a call.
pub fn call() -> impl Strategy<Value = Call> {
    let job = 0..4usize;
    let lease = 0..1000usize;
    prop_oneof![
        2 => (0..4u8, 0..2u8, 0..8u8).prop_map(|(name, tenant, content)| {
            Call::Job(JobCall::Submit { name, tenant, content: u8::from(content == 0) })
        }),
        1 => (job.clone(), 0..4u8).prop_filter_map("rarely", |(job, dice)| {
            (dice == 0).then_some(Call::Job(JobCall::Cancel { job }))
        }),
        1 => (job.clone(), 0..4u8).prop_map(|(job, request_number)| {
            Call::Job(JobCall::Delete { job, again: request_number })
        }),
        4 => (job.clone(), 0..6u8, 500..4000u64).prop_map(|(job, who, duration_ms)| {
            Call::Job(JobCall::Steward { job, who: who / 5, duration_ms })
        }),
        5 => (job.clone(), 0..8u8, 0..60u64, 1..40u64).prop_map(|(job, old, items, chunk)| {
            Call::Stage(StageCall::Open { job, old_epoch: old == 0, items, chunk })
        }),
        2 => job.clone().prop_map(|job| Call::Stage(StageCall::Close { job })),
        2 => (job.clone(), 0..9usize, 0..9u64, 0..4u32, any::<bool>()).prop_map(
            |(job, chunk, at, suspicions, alone)| {
                Call::Stage(StageCall::Split { job, chunk, at, suspicions, alone })
            }
        ),
        1 => (job.clone(), 0..9usize).prop_map(|(job, chunk)| {
            Call::Stage(StageCall::FailItem { job, chunk })
        }),
        1 => (job, 0..4u8, any::<bool>()).prop_filter_map("rarely", |(job, dice, solved)| {
            (dice == 0).then_some(Call::Job(JobCall::Finish { job, solved }))
        }),
        10 => (0..3u8, 0..200u8, 0..4u32, 1..5u32, 0..9u32, any::<bool>()).prop_map(
            |(who, name, slots, threads, limit, impatient)| {
                Call::Lease(LeaseCall::Lease { who, name, slots, threads, limit, impatient })
            }
        ),
        2 => proptest::collection::vec(lease.clone(), 0..4).prop_map(|leases| {
            Call::Lease(LeaseCall::Renew { leases })
        }),
        10 => (lease.clone(), 0..9u8, 0..90_000u64, 0..12u8, 0..3u8).prop_map(
            |(lease, hash, cpu_micros, other, audited)| Call::Verdict(VerdictCall::Complete {
                lease, hash: u8::from(hash == 0), cpu_micros, other_items: other == 0,
                audited: audited == 0
            })
        ),
        2 => (lease, any::<bool>()).prop_map(|(lease, failed)| {
            Call::Lease(LeaseCall::GiveBack { lease, failed })
        }),
        1 => (0..1000usize, 0..6u8).prop_map(|(lease, dice)| {
            Call::Verdict(VerdictCall::Strike { lease, wrong: dice == 0 })
        }),
        3 => Just(Call::Expire),
        2 => (0..3u8, 1..9u32).prop_map(|(who, threads)| Call::Seen { who, threads }),
        4 => (0..900u64).prop_map(|ms| Call::Wait { ms }),
    ]
}
