//! One suite for every transport: a worker sees no difference between them but the time.

use crate::support::{FakeWorker, House, LONG_WAIT, MANY_PATHS, WOKEN, text};
use cognate_coordinator::chunks::leasing::Policy;
use cognate_coordinator::chunks::sizing::Sizing;
use cognate_coordinator::config::Rules;
use cognate_protocol::v1;
use cognate_protocol::v1::Verdict;
use cognate_worker::config::TransportChoice;
use cognate_worker::transport::shared_memory::place::CALLS;
use std::time::{Duration, Instant};
use tonic::Code;

/// Chunks of 8 paths, leases and waits for work that are long enough for a test on any machine.
async fn house() -> House {
    let rules = Rules {
        long_poll: LONG_WAIT,
        policy: Policy {
            lease_ms: 600_000,
            sizing: Sizing {
                first_items: 8,
                most_items: 8,
                ..Sizing::default()
            },
            ..Policy::default()
        },
        ..Rules::default()
    };
    House::with(rules, tempfile::tempdir().unwrap(), false).await
}

async fn worker(house: &House, name: &str, choice: TransportChoice) -> FakeWorker {
    let worker = house.worker_api_by(name, choice).await;
    let wanted = choice == TransportChoice::SharedMemory;
    assert_eq!(
        worker.route.transport() == "shared-memory",
        wanted,
        "{choice:?}"
    );
    worker
}

/// Checks that a transport has the properties that a worker needs.
async fn conforms(choice: TransportChoice) {
    let house = house().await;
    let mut worker = worker(&house, "one", choice).await;

    // Nothing to do: the answer comes after the wait, not before.
    let begin = Instant::now();
    assert!(worker.pull(1, 300).await.leases.is_empty());
    assert!(begin.elapsed() >= Duration::from_millis(250));

    // Work that comes while a call waits is answered at once.
    let question = worker.question(2, LONG_WAIT.as_millis() as u32);
    let waiting = {
        let (mut api, question) = (worker.api.clone(), question.clone());
        tokio::spawn(async move { api.pull(question).await.unwrap().into_inner() })
    };
    tokio::time::sleep(Duration::from_millis(100)).await;
    let mut client = house.client().await;
    let begin = Instant::now();
    let job = client.submit("r", text(MANY_PATHS)).await.unwrap();
    let pulled = waiting.await.unwrap();
    assert!(begin.elapsed() < WOKEN, "{choice:?}");
    assert_eq!(pulled.leases.len(), 2);

    // A repeated request gets the same leases; the durations are counted from now.
    let repeated_answer = worker.api.pull(question).await.unwrap().into_inner();
    let ids = |r: &v1::PullResponse| r.leases.iter().map(|l| l.id.clone()).collect::<Vec<_>>();
    assert_eq!(ids(&repeated_answer), ids(&pulled));

    // Objects that a lease names can be fetched: system and stage.
    let lease = pulled.leases[0].clone();
    let id = lease.id.clone().unwrap();
    let digest = lease.problem.clone();
    let system = worker
        .api
        .get_problem(v1::GetProblemRequest { digest })
        .await;
    assert_eq!(system.unwrap().into_inner().variables.len(), 2);
    let asked = v1::GetStageRequest {
        job: job.clone(),
        stage: id.stage,
    };
    worker.api.get_stage(asked).await.unwrap();

    // Errors come with their code and their words.
    let nowhere = v1::GetStageRequest {
        job: job.clone(),
        stage: 999,
    };
    let error = worker.api.get_stage(nowhere).await.unwrap_err();
    assert_eq!(error.code(), Code::NotFound, "{choice:?}");
    assert!(error.message().contains("999"), "{error}");
    let error = worker.api.renew(v1::RenewRequest {
        identity: worker.identity(),
        leases: vec![v1::LeaseId {
            job: "no id".into(),
            ..id.clone()
        }],
    });
    assert_eq!(error.await.unwrap_err().code(), Code::InvalidArgument);
    let object = v1::GetObjectRequest {
        digest: vec![7; 32].into(),
    };
    let error = worker.api.get_object(object).await;
    let error = match error {
        Err(error) => error,
        Ok(mut pieces) => pieces.get_mut().message().await.unwrap_err(),
    };
    assert_eq!(error.code(), Code::NotFound, "{choice:?}");

    // Leases are renewed, results are accepted once, whatever is sent again.
    let renewed = worker.api.renew(v1::RenewRequest {
        identity: worker.identity(),
        leases: pulled.leases.iter().filter_map(|l| l.id.clone()).collect(),
    });
    let renewals = renewed.await.unwrap().into_inner().renewals;
    assert!(renewals.len() == 2 && renewals.iter().all(|r| r.held));
    let verdicts = [Verdict::Accepted, Verdict::AlreadyAccepted];
    for verdict in verdicts {
        let results = FakeWorker::results(&lease);
        assert_eq!(worker.report(&lease, results).await.verdict(), verdict);
    }
    let mut few = FakeWorker::results(&pulled.leases[1]);
    few.pop();
    let refused = worker.report(&pulled.leases[1], few).await;
    assert_eq!(refused.verdict(), Verdict::Stale, "{choice:?}");

    // A chunk that is given back goes to the next worker that asks.
    let given = v1::GiveBackRequest {
        identity: worker.identity(),
        leases: vec![pulled.leases[1].id.clone().unwrap()],
        reason: v1::GiveBackReason::Draining.into(),
        message: String::new(),
        leaving: false,
    };
    worker.api.give_back(given).await.unwrap();
    let next = worker.pull(1, 1000).await;
    assert_eq!(next.leases[0].first, pulled.leases[1].first);
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn grpc_conforms() {
    conforms(TransportChoice::Grpc).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn shared_memory_conforms() {
    conforms(TransportChoice::SharedMemory).await;
}

/// A call that nobody waits for any more leases nothing, once the coordinator knows of it. When it does
/// cannot be asked: the time for it doubles until it was enough, or is far more than any machine takes.
async fn called_off(choice: TransportChoice) {
    let mut time = Duration::from_millis(300);
    loop {
        let leased = leased_after_called_off(choice, time).await;
        assert!(leased <= 8, "no more than 64 paths, by {choice:?}");
        if leased == 8 {
            return;
        }
        time *= 2;
        assert!(time < WOKEN, "{leased} of 8 chunks are free, by {choice:?}");
    }
}

/// How many of 8 chunks are free for a second worker, where a first has called off its question so long before
/// they were made.
async fn leased_after_called_off(choice: TransportChoice, time: Duration) -> usize {
    let house = house().await;
    let mut gone = worker(&house, "gone", choice).await;
    let question = gone.question(8, 20_000);
    let waiting = {
        let mut api = gone.api.clone();
        tokio::spawn(async move { api.pull(question).await })
    };
    tokio::time::sleep(time).await;
    waiting.abort();
    let _ = waiting.await;
    tokio::time::sleep(time).await;
    let mut client = house.client().await;
    client.submit("r", text(MANY_PATHS)).await.unwrap();
    let mut other = worker(&house, "other", choice).await;
    // All chunks of a stage are there at once: what this one does not get, the first has.
    let leased = other.pull(8, 5000).await.leases.len();
    house.server.shutdown().await;
    leased
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn calls_are_called_off_by_grpc() {
    called_off(TransportChoice::Grpc).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn calls_are_called_off_by_shared_memory() {
    called_off(TransportChoice::SharedMemory).await;
}

/// A report of `bytes` bytes for a lease of nobody: decoded, then found to be stale or invalid.
fn large_report(worker: &FakeWorker, bytes: usize) -> v1::ReportRequest {
    v1::ReportRequest {
        identity: worker.identity(),
        chunks: vec![v1::ChunkReport {
            lease: Some(v1::LeaseId {
                job: "0".repeat(bytes),
                ..v1::LeaseId::default()
            }),
            ..v1::ChunkReport::default()
        }],
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn messages_of_any_size_go_through() {
    let house = house().await;
    let mut worker = worker(&house, "large", TransportChoice::SharedMemory).await;
    // From a part of the first slice to beyond what goes by shared memory.
    for bytes in [
        1,
        4000,
        5000,
        70_000,
        1 << 20,
        5 << 20,
        (16 << 20) - 500,
        17 << 20,
    ] {
        let report = large_report(&worker, bytes);
        let answer = worker.api.report(report).await.unwrap().into_inner();
        assert_eq!(answer.verdicts[0].verdict(), Verdict::Invalid, "{bytes}");
        assert!(
            worker.route.transport() == "shared-memory",
            "a call declined is no break"
        );
    }
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn many_calls_at_once_are_all_answered() {
    let house = house().await;
    let mut client = house.client().await;
    let job = client.submit("r", text(MANY_PATHS)).await.unwrap();
    let one = worker(&house, "one", TransportChoice::SharedMemory).await;
    let two = worker(&house, "two", TransportChoice::SharedMemory).await;
    let calls = (0..400).map(|k| {
        let (mut api, job) = (
            if k % 2 == 0 { &one } else { &two }.api.clone(),
            job.clone(),
        );
        tokio::spawn(async move {
            let stage = v1::GetStageRequest { job, stage: 0 };
            api.get_stage(stage).await.unwrap().into_inner()
        })
    });
    let mut stages = Vec::new();
    for call in calls.collect::<Vec<_>>() {
        stages.push(call.await.unwrap());
    }
    assert!(stages.iter().all(|stage| *stage == stages[0]));
    assert!(one.route.transport() == "shared-memory" && two.route.transport() == "shared-memory");
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn calls_that_take_the_places_of_called_off_ones_are_answered() {
    let house = house().await;
    let mut worker = worker(&house, "one", TransportChoice::SharedMemory).await;
    for _ in 0..20 {
        // As many as a worker may have open, none answered before it is called off.
        let waiting = (0..CALLS).map(|_| {
            let (mut api, question) = (worker.api.clone(), worker.question(1, 20_000));
            tokio::spawn(async move { api.pull(question).await.map(drop) })
        });
        let waiting = waiting.collect::<Vec<_>>();
        tokio::time::sleep(Duration::from_millis(20)).await;
        let next = (0..CALLS).map(|_| {
            let mut api = worker.api.clone();
            tokio::spawn(async move { api.get_shared_memory(v1::GetSharedMemoryRequest {}).await })
        });
        let next = next.collect::<Vec<_>>();
        waiting.iter().for_each(tokio::task::JoinHandle::abort);
        for call in next {
            call.await.unwrap().unwrap();
        }
        assert!(worker.route.transport() == "shared-memory");
    }
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn where_shared_memory_ends_calls_go_on_by_grpc() {
    let house = house().await;
    let mut worker = worker(&house, "one", TransportChoice::SharedMemory).await;
    // The listener in shared memory closes; the others stay open.
    house.server.close_shared_memory();
    let begin = Instant::now();
    while worker.route.transport() == "shared-memory" {
        assert!(begin.elapsed() < WOKEN, "it is noticed");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    assert!(worker.pull(1, 10).await.leases.is_empty());
    let job = house.client().await.submit("r", text(MANY_PATHS)).await;
    job.unwrap();
    assert_eq!(worker.pull(1, 60_000).await.leases.len(), 1);
    house.server.shutdown().await;
}

/// Measured, not asserted:
/// `cargo test --release -p cognate-coordinator --test coordinator transports -- --ignored --nocapture`.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn round_trips() {
    let house = house().await;
    for choice in [TransportChoice::Grpc, TransportChoice::SharedMemory] {
        let mut worker = worker(&house, &format!("{choice:?}"), choice).await;
        let small = v1::GetSharedMemoryRequest {};
        let rounds = 5000;
        let mut times = Vec::new();
        for _ in 0..rounds {
            let begin = Instant::now();
            worker.api.get_shared_memory(small).await.unwrap();
            times.push(begin.elapsed());
        }
        times.sort();
        println!("{choice:?}: small call, median {:?}", times[rounds / 2]);
        let megabyte = large_report(&worker, 1 << 20);
        let mut times = Vec::new();
        for _ in 0..200 {
            let report = megabyte.clone();
            let begin = Instant::now();
            worker.api.report(report).await.unwrap();
            times.push(begin.elapsed());
        }
        times.sort();
        println!("{choice:?}: report of 1 MiB, median {:?}", times[100]);
    }
    house.server.shutdown().await;
}
