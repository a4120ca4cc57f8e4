//! Hostile callers: what they send is bounded before it is believed, and the service stays up.

use crate::support::{House, MANY_PATHS, WOKEN, text};
use cognate_coordinator::config::Rules;
use cognate_protocol::v1;
use std::time::{Duration, Instant};
use tonic::Code;

/// The most memory that this process has had, in MiB.
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap();
    let kib: u64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kib / 1024
}

/// `x_i - c` a thousand times, or its square: 26 KB that once took 15 GiB to plan.
fn thousand_variables(power: u32) -> String {
    let names = |letter: &str| {
        let names: Vec<String> = (0..1000).map(|i| format!("{letter}{i}")).collect();
        names.join(", ")
    };
    let equations: String = (0..1000)
        .map(|i| format!("f{i} = x{i}^{power} - {};\n", i + 2))
        .collect();
    format!(
        "INPUT\nvariable_group {};\nfunction {};\n{equations}END;\n",
        names("x"),
        names("f")
    )
}

#[tokio::test(flavor = "multi_thread")]
async fn a_thousand_trivial_equations_are_planned_at_once_and_in_little_memory() {
    let house = House::new().await;
    let mut client = house.client().await;
    let before = peak_mib();
    let begin = Instant::now();
    let job = client.submit("linear", text(&thousand_variables(1))).await;
    job.expect("one path");
    let refused = client
        .submit("quadratic", text(&thousand_variables(2)))
        .await;
    let refused = refused.expect_err("2^1000 paths");
    assert_eq!(refused.code(), Code::Unimplemented, "{refused}");
    assert!(
        begin.elapsed() < Duration::from_secs(300),
        "{:?}",
        begin.elapsed()
    );
    let more = peak_mib() - before;
    assert!(more < 1024, "{more} MiB");
}

#[tokio::test(flavor = "multi_thread")]
async fn messages_of_empty_parts_are_refused_before_they_are_made() {
    let house = House::new().await;
    let mut worker = house.worker_api("evil").await;
    let before = peak_mib();
    // Made once here, so that what is measured is the coordinator's and not twice that.
    let request = v1::ReportRequest {
        identity: worker.identity(),
        chunks: vec![v1::ChunkReport {
            results: vec![v1::PathResult::default(); 400_000],
            ..v1::ChunkReport::default()
        }],
    };
    let made = peak_mib() - before;
    let refused = worker.api.report(request).await.expect_err("too much");
    assert_eq!(refused.code(), Code::ResourceExhausted, "{refused}");
    let more = peak_mib() - before;
    assert!(more < made + 200, "{more} MiB, {made} of them the test's");
    assert!(worker.pull(1, 0).await.leases.is_empty());
}

#[tokio::test(flavor = "multi_thread")]
async fn malformed_messages_are_the_callers_fault() {
    let house = House::new().await;
    let mut answers = Vec::new();
    for body in [
        &b"\xff\xff\xff"[..],
        b"\x0a\x05ab",
        b"\x08\x01",
        b"\x0a\x02\xc3\x28",
    ] {
        let mut grpc = tonic::client::Grpc::new(house.channel().await);
        grpc.ready().await.unwrap();
        let request = tonic::Request::new(bytes::Bytes::copy_from_slice(body));
        let path = http::uri::PathAndQuery::from_static("/cognate.v1.ClientApi/Cancel");
        let answer = grpc.unary(request, path, raw::Raw).await;
        answers.push(answer.map(drop).map_err(|status| status.code()));
    }
    assert_eq!(answers, [Err(Code::InvalidArgument); 4]);
}

/// A worker that gives back each chunk is put aside by name, and an honest one loses no path by it.
#[tokio::test(flavor = "multi_thread")]
async fn a_black_hole_condemns_no_path_and_is_put_aside() {
    let mut rules = Rules::default();
    // Longer than the test: the worker stays aside until the job ends, on a slow machine, too.
    rules.policy.conduct.first_ms = 3_600_000;
    rules.policy.conduct.longest_ms = 3_600_000;
    let house = House::with(rules, tempfile::tempdir().unwrap(), false).await;
    let mut client = house.client().await;
    let mut hole = house.worker_api("hole").await;
    let job = client.submit("job", text(MANY_PATHS)).await.unwrap();
    let mut refusal = String::new();
    while refusal.is_empty() {
        for lease in hole.pull(4, 1000).await.leases {
            hole.give_back(&lease, "it cannot be").await;
        }
        refusal = client.refusal("hole").await;
    }
    assert!(refusal.contains("in a row"), "{refusal:?}");
    assert!(hole.pull(4, 20).await.leases.is_empty());
    let honest = house.worker("honest");
    let told = client.watch(&job).await;
    let last = told.last().unwrap();
    assert_eq!(
        last.state,
        i32::from(v1::JobState::Solved),
        "{}",
        last.message
    );
    let lost: u64 = last.stages.iter().map(|stage| stage.failed).sum();
    assert_eq!(lost, 0, "paths were given up");
    assert!(client.refusal("hole").await.contains("in a row"));
    honest.stop().await;
}

/// Reports under leases that others have, or nobody, are kept nowhere and disturb nobody.
#[tokio::test(flavor = "multi_thread")]
async fn leases_belong_to_who_has_them() {
    let house = House::durable(tempfile::tempdir().unwrap()).await;
    let mut client = house.client().await;
    let job = client.submit("job", text(MANY_PATHS)).await.unwrap();
    let mut honest = house.worker_api("honest").await;
    let lease = loop {
        if let Some(lease) = honest.pull(1, 1000).await.leases.pop() {
            break lease;
        }
    };
    let mut thief = house.worker_api("thief").await;
    let mut forger = house.worker_api("honest").await;
    forger.session = "another".to_owned();
    let before = files(&house);
    for evil in [&mut thief, &mut forger] {
        // Another's lease, and ones that nobody had.
        for ahead in 0..20 {
            let mut forged = lease.clone();
            forged.id.as_mut().unwrap().epoch += ahead;
            let verdict = evil
                .report(&forged, crate::support::FakeWorker::results(&forged))
                .await;
            assert_eq!(verdict.verdict(), v1::Verdict::Stale);
        }
        evil.give_back(&lease, "mine").await;
        let request = v1::RenewRequest {
            identity: evil.identity(),
            leases: vec![lease.id.clone().unwrap()],
        };
        let renewed = evil.api.renew(request).await.unwrap().into_inner();
        assert!(!renewed.renewals[0].held);
    }
    assert_eq!(files(&house), before, "something forged is kept");
    let results = crate::support::FakeWorker::results(&lease);
    let verdict = honest.report(&lease, results).await;
    assert_eq!(
        verdict.verdict(),
        v1::Verdict::Accepted,
        "{}",
        verdict.message
    );
    let cancel = v1::CancelRequest { job };
    client.0.cancel(cancel).await.unwrap();
}

/// How many files the results have.
fn files(house: &House) -> usize {
    fn count(folder: &std::path::Path) -> usize {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries
            .map(|entry| match entry.path() {
                path if path.is_dir() => count(&path),
                _ => 1,
            })
            .sum()
    }
    count(&house.folder.path().join("data/results"))
}

/// The results' folder goes away for some seconds, as one that is mounted late: nothing is lost, and
/// health says so meanwhile.
#[tokio::test(flavor = "multi_thread")]
async fn results_that_are_away_for_a_while_cost_nothing() {
    let house = House::durable(tempfile::tempdir().unwrap()).await;
    let mut client = house.client().await;
    let results = house.folder.path().join("data/results");
    let away = house.folder.path().join("away");
    let job = client.submit("job", text(MANY_PATHS)).await.unwrap();
    std::fs::rename(&results, &away).unwrap();
    let worker = house.worker("worker");
    let mut probe = tonic_health::pb::health_client::HealthClient::new(house.channel().await);
    let mut said = Vec::new();
    for _ in 0..15 {
        tokio::time::sleep(Duration::from_millis(200)).await;
        for service in ["", "ready"] {
            let request = tonic_health::pb::HealthCheckRequest {
                service: service.to_owned(),
            };
            let status = probe.check(request).await.unwrap().into_inner().status;
            said.push((service, status));
        }
    }
    assert!(said.contains(&("ready", 2)), "not ready");
    assert!(!said.contains(&("", 2)), "alive all the time");
    assert!(!results.exists(), "nobody makes the folder anew");
    std::fs::rename(&away, &results).unwrap();
    let told = client.watch(&job).await;
    let last = told.last().unwrap();
    assert_eq!(
        last.state,
        i32::from(v1::JobState::Solved),
        "{}",
        last.message
    );
    let lost: u64 = last.stages.iter().map(|stage| stage.failed).sum();
    assert_eq!(lost, 0, "paths were given up");
    worker.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn no_start_over_missing_results() {
    let mut house = House::durable(tempfile::tempdir().unwrap()).await;
    let mut client = house.client().await;
    client.submit("job", text(MANY_PATHS)).await.unwrap();
    drop(client);
    let folder = std::mem::replace(&mut house.folder, tempfile::tempdir().unwrap());
    house.server.shutdown().await;
    std::fs::remove_dir_all(folder.path().join("data/results")).unwrap();
    let config = crate::support::durable_config(folder.path());
    let refused = cognate_coordinator::server::Server::start(config).await;
    let Err(refused) = refused.map(drop) else {
        panic!("it starts");
    };
    let said = refused.to_string();
    assert!(
        said.contains("data/results") && said.contains("mounted"),
        "{said}"
    );
}

/// Random ends with small residuals are not believed: the coordinator follows the first one itself, the liar gets
/// no more, an honest worker does its chunks again, and the answer is right.
#[tokio::test(flavor = "multi_thread")]
async fn ends_that_solve_no_equation_are_done_again() {
    let house = House::new().await;
    let mut client = house.client().await;
    let job = client.submit("job", text(MANY_PATHS)).await.unwrap();
    let mut liar = house.worker_api("liar").await;
    let mut lies = 0;
    loop {
        let pulled = liar.pull(1, 1000).await;
        if !pulled.refused.is_empty() {
            break;
        }
        for lease in pulled.leases {
            let mut results = crate::support::FakeWorker::results(&lease);
            for result in &mut results {
                result.outcome = v1::PathOutcome::Regular.into();
                let at = |k: u64| ((result.origin * 37 + k * k * 11 + k) % 19) as f64 / 9.5 - 1.0;
                result.endpoint = (0..6).map(at).collect();
            }
            liar.report(&lease, results).await;
            lies += 1;
        }
    }
    assert_eq!(lies, 1, "the first lie is the last");
    let honest = house.worker("honest");
    let told = client.watch(&job).await;
    assert_eq!(told.last().unwrap().state, i32::from(v1::JobState::Solved));
    for solution in client.solutions(&job).await {
        assert!(solution.residual < 1e-8, "{solution:?}");
        let value = |name: &str| {
            let variable = solution.variables.iter().find(|v| v.name == name).unwrap();
            num_complex::Complex64::new(variable.re, variable.im)
        };
        let power = |z: num_complex::Complex64, n: u32| (1..n).fold(z, |power, _| power * z);
        let (x, y) = (value("x"), value("y"));
        let f = power(x, 8) + power(y, 2) - 3.0;
        let g = power(y, 8) - x * y + 1.0;
        assert!(f.norm_sqr() + g.norm_sqr() < 1e-12, "{solution:?}");
    }
    let refusal = client.refusal("liar").await;
    assert!(refusal.contains("computed wrongly"), "{refusal:?}");
    honest.stop().await;
}

/// Connections that say nothing are closed, and a few of them block nobody.
#[tokio::test(flavor = "multi_thread")]
async fn silent_connections_are_closed() {
    use cognate_coordinator::config::{ListenAddress, Rules};
    use cognate_coordinator::transport::introduction::ConnectionLimits;
    use tokio::io::AsyncReadExt;
    let rules = Rules {
        connections: ConnectionLimits {
            most: 8,
            patience: Duration::from_secs(2),
            ..ConnectionLimits::default()
        },
        ..Rules::default()
    };
    let house = House::with(rules, tempfile::tempdir().unwrap(), false).await;
    let ListenAddress::Tcp(address) = &house.server.addresses[1] else {
        panic!("the second address is TCP");
    };
    let mut silent = Vec::new();
    for _ in 0..20 {
        silent.push(tokio::net::TcpStream::connect(address).await.unwrap());
    }
    let begin = Instant::now();
    let answered = async {
        let mut client = house.client().await;
        client
            .0
            .list_jobs(v1::ListJobsRequest::default())
            .await
            .unwrap();
    };
    let answered = tokio::time::timeout(WOKEN, answered).await;
    answered.expect("a call is answered beside silent connections");
    for stream in &mut silent {
        // Settings of the server may come first; then it closes the connection.
        let closed = async { while stream.read(&mut [0; 64]).await.is_ok_and(|read| read > 0) {} };
        let closed = tokio::time::timeout(WOKEN, closed).await;
        closed.expect("a silent connection is closed");
    }
    println!("all are closed after {:?}", begin.elapsed());
}

/// A name that would move the cursor of a terminal is shown as it is written.
#[tokio::test(flavor = "multi_thread")]
async fn names_are_shown_without_control_characters() {
    let house = House::new().await;
    let mut client = house.client().await;
    let mut problem = text(MANY_PATHS);
    problem.options = Some(v1::Options {
        name: "\u{1b}]0;owned\u{7}\nforged".to_owned(),
        ..v1::Options::default()
    });
    client.submit("job", problem).await.unwrap();
    let jobs = client
        .0
        .list_jobs(v1::ListJobsRequest::default())
        .await
        .unwrap();
    let name = &jobs.into_inner().jobs[0].name;
    assert_eq!(name, "\\u{1b}]0;owned\\u{7}\\nforged");
}

/// Messages that are sent as they are.
mod raw {
    use bytes::{Buf, BufMut, Bytes};
    use tonic::Status;
    use tonic::codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder};

    pub struct Raw;

    impl Codec for Raw {
        type Encode = Bytes;
        type Decode = Bytes;
        type Encoder = Self;
        type Decoder = Self;

        fn encoder(&mut self) -> Self {
            Self
        }

        fn decoder(&mut self) -> Self {
            Self
        }
    }

    impl Encoder for Raw {
        type Item = Bytes;
        type Error = Status;

        fn encode(&mut self, item: Bytes, to: &mut EncodeBuf<'_>) -> Result<(), Status> {
            to.put(item);
            Ok(())
        }
    }

    impl Decoder for Raw {
        type Item = Bytes;
        type Error = Status;

        fn decode(&mut self, from: &mut DecodeBuf<'_>) -> Result<Option<Bytes>, Status> {
            Ok(Some(from.copy_to_bytes(from.remaining())))
        }
    }
}
