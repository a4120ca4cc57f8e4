//! The service behind its sockets, in one process: from a submission to the result, and what it
//! refuses.

use crate::support::{Client, FOUR_POINTS, FakeWorker, House, LONG_WAIT, MANY_PATHS, WOKEN, text};
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress};
use cognate_coordinator::server::{Server, ServerError};
use cognate_coordinator::transport::ListenError;
use cognate_protocol::v1;
use std::time::{Duration, Instant};
use tonic::Code;
use tonic_types::StatusExt;

#[tokio::test(flavor = "multi_thread")]
async fn a_text_becomes_solutions() {
    let house = House::new().await;
    let (first, second) = (house.worker("first"), house.worker("second"));
    let mut client = house.client().await;
    let job = client.submit("a", text(FOUR_POINTS)).await.unwrap();
    let told = client.watch(&job).await;
    let last = told.last().unwrap();
    assert_eq!(last.state(), v1::JobState::Solved, "{}", last.message);
    assert_eq!(last.stages[0].accepted, 4);

    let request = v1::GetSummaryRequest { job: job.clone() };
    let summary = client.0.get_summary(request).await.unwrap().into_inner();
    let counts = summary.counts.unwrap();
    assert_eq!((counts.paths_total, counts.paths_finite), (4, 4));
    assert_eq!(counts.solutions_distinct, 4);
    let json: serde_json::Value = serde_json::from_str(&summary.json).unwrap();
    assert_eq!(json["paths"]["total"].to_string(), "4");

    let mut points: Vec<(i64, i64)> = Vec::new();
    for solution in client.solutions(&job).await {
        let [x, y] = &solution.variables[..] else {
            panic!("two variables");
        };
        assert_eq!((x.name.as_str(), y.name.as_str()), ("x", "y"));
        assert!(x.im.abs() < 1e-10 && y.im.abs() < 1e-10);
        assert!((x.re * y.re - 2.0).abs() < 1e-10);
        points.push((x.re.round() as i64, y.re.round() as i64));
    }
    points.sort_unstable();
    assert_eq!(points, [(-2, -1), (-1, -2), (1, 2), (2, 1)]);

    let paths = client.paths(&job).await;
    assert_eq!(paths.len(), 4);
    let mut ends: Vec<u64> = paths.iter().filter_map(|p| p.solution).collect();
    ends.sort_unstable();
    assert_eq!(ends, [0, 1, 2, 3]);
    assert!(paths.iter().all(|p| p.class() == v1::PathClass::Finite));

    let request = v1::ExplainRequest { job: job.clone() };
    let explained = client.0.explain(request).await.unwrap().into_inner();
    assert!(explained.text.contains("4 paths"), "{}", explained.text);
    let list = client.0.list_jobs(v1::ListJobsRequest::default()).await;
    let jobs = list.unwrap().into_inner().jobs;
    assert_eq!((jobs.len(), &jobs[0].job), (1, &job));
    let workers = client.0.list_workers(v1::ListWorkersRequest {}).await;
    let workers = workers.unwrap().into_inner().workers;
    assert_eq!(workers.len(), 2);
    assert_eq!(workers.iter().map(|w| w.accepted_paths).sum::<u64>(), 4);

    first.stop().await;
    second.stop().await;
    let workers = client.0.list_workers(v1::ListWorkersRequest {}).await;
    assert!(workers.unwrap().into_inner().workers.is_empty());
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn one_request_is_one_job() {
    let house = House::new().await;
    let mut client = house.client().await;
    let job = client.submit("same", text(FOUR_POINTS)).await.unwrap();
    assert_eq!(client.submit("same", text(FOUR_POINTS)).await.unwrap(), job);
    let other = FOUR_POINTS.replace('5', "6");
    let error = client.submit("same", text(&other)).await.unwrap_err();
    assert_eq!(error.code(), Code::AlreadyExists);
    let another = client.submit("other", text(FOUR_POINTS)).await.unwrap();
    assert_ne!(another, job);
    let list = client.0.list_jobs(v1::ListJobsRequest::default()).await;
    assert_eq!(list.unwrap().into_inner().jobs.len(), 2);
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_input_is_named_and_the_service_stays_up() {
    let house = House::new().await;
    let mut client = house.client().await;
    check_bad_texts(&mut client).await;
    check_bad_messages(&mut client).await;
    check_bad_jobs(&mut client).await;
    let job = client.submit("good", text(FOUR_POINTS)).await.unwrap();
    let request = v1::GetSummaryRequest { job };
    let error = client.0.get_summary(request).await.unwrap_err();
    assert_eq!(error.code(), Code::FailedPrecondition);
    house.server.shutdown().await;
}

/// Texts that are no systems, each refused with its place.
async fn check_bad_texts(client: &mut Client) {
    let cases: &[(&str, Code, &str)] = &[
        ("", Code::InvalidArgument, "test.bertini"),
        ("\0\u{1}\u{2}junk", Code::InvalidArgument, "test.bertini"),
        (
            "variable_group x; function f; f = x + z;",
            Code::InvalidArgument,
            "`z`",
        ),
        (
            "variable_group x; function f; f = (x;",
            Code::InvalidArgument,
            "test.bertini:1:",
        ),
        (
            "variable_group x; function f; f = 3;",
            Code::InvalidArgument,
            "f",
        ),
        ("variable_group x;", Code::InvalidArgument, "test.bertini"),
        (
            "variable_group x, y; function f; f = x^2 - y;",
            Code::Unimplemented,
            "cognate decompose",
        ),
        (
            "variable_group x; function f; f = x^1000000;",
            Code::InvalidArgument,
            "EXPONENT",
        ),
    ];
    for (content, code, said) in cases {
        let error = client.submit("bad", text(content)).await.unwrap_err();
        assert_eq!(error.code(), *code, "{content}: {error}");
        assert!(
            error.message().contains(said),
            "{content}: {}",
            error.message()
        );
    }
}

/// Messages with a wrong field, each refused with the field's name.
async fn check_bad_messages(client: &mut Client) {
    let no_problem = v1::SubmitRequest {
        request_id: "bad".to_owned(),
        ..v1::SubmitRequest::default()
    };
    let error = client.0.submit(no_problem).await.unwrap_err();
    assert_eq!(
        (error.code(), error.message()),
        (Code::InvalidArgument, "problem is missing")
    );
    let error = client.submit("", text(FOUR_POINTS)).await.unwrap_err();
    assert_eq!(error.code(), Code::InvalidArgument);
    let mut dangling = text("");
    dangling.source = Some(v1::problem::Source::System(v1::System {
        variables: vec!["x".to_owned()],
        nodes: vec![v1::Node {
            kind: Some(v1::node::Kind::Negate(5)),
        }],
        ..v1::System::default()
    }));
    let error = client.submit("bad", dangling).await.unwrap_err();
    assert_eq!(error.code(), Code::InvalidArgument);
    assert!(
        error
            .message()
            .starts_with("problem.system.nodes[0].negate is 5")
    );
    // Programs find the field by itself.
    let field = |error: &tonic::Status| -> Vec<String> {
        let details = error.get_details_bad_request();
        let violations = details.into_iter().flat_map(|bad| bad.field_violations);
        violations.map(|violation| violation.field).collect()
    };
    assert_eq!(field(&error), ["problem.system.nodes[0].negate"]);
    let error = client.submit("", text(FOUR_POINTS)).await.unwrap_err();
    assert_eq!(field(&error), ["request_id"]);
    let error = client.submit("bad", text("")).await.unwrap_err();
    assert_eq!(field(&error), ["problem.text"]);
    let mut misfit = text(FOUR_POINTS);
    misfit.options = Some(v1::Options {
        idle_loops: Some(3),
        ..v1::Options::default()
    });
    let error = client.submit("bad", misfit).await.unwrap_err();
    assert_eq!(field(&error), ["problem.options.idle_loops"]);
}

/// Names of jobs that are none, or of jobs that are not there.
async fn check_bad_jobs(client: &mut Client) {
    for job in ["", "x", "0123456789abcdef"] {
        let request = v1::WatchRequest {
            job: job.to_owned(),
        };
        let error = client.0.watch(request).await.unwrap_err();
        let expected = if job.len() == 16 {
            Code::NotFound
        } else {
            Code::InvalidArgument
        };
        assert_eq!(error.code(), expected, "{error}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn mutated_problems_end_in_a_job_or_a_clear_refusal() {
    use cognate_numeric::random::{Purpose, RandomStream};
    use prost::Message;
    let house = House::new().await;
    let mut client = house.client().await;
    let system = cognate_systems::formats::read("a", MANY_PATHS.as_bytes()).unwrap();
    let system = cognate_protocol::to_proto::problem::system(&system.system);
    let whole = v1::Problem {
        source: Some(v1::problem::Source::System(system)),
        options: Some(v1::Options {
            settings: Some(v1::Settings {
                max_steps: Some(500),
                ..v1::Settings::default()
            }),
            groups: vec![v1::NameList {
                names: vec!["x".to_owned(), "y".to_owned()],
            }],
            target_parameters: vec![v1::ParameterValues::default()],
            ..v1::Options::default()
        }),
    }
    .encode_to_vec();
    let (mut jobs, mut refusals) = (0, 0);
    for seed in 0..2000 {
        let mut draw = RandomStream::new(seed, Purpose::Test, 0);
        let mut bytes = whole.clone();
        for _ in 0..1 + draw.below(3) {
            let at = draw.below(bytes.len() as u64) as usize;
            // Lengths stay as they are: else most messages would not even decode.
            bytes[at] = match draw.below(2) {
                0 => bytes[at] ^ (1 << draw.below(8)),
                _ => draw.below(256) as u8,
            };
        }
        let Ok(problem) = v1::Problem::decode(bytes.as_slice()) else {
            continue;
        };
        let id = format!("mutated-{seed}");
        let answer = client.submit(&id, problem);
        let answer = tokio::time::timeout(Duration::from_secs(30), answer).await;
        match answer.unwrap_or_else(|_| panic!("problem {seed} takes too long")) {
            Ok(_) => jobs += 1,
            Err(status) => {
                refusals += 1;
                let clear = matches!(
                    status.code(),
                    Code::InvalidArgument | Code::ResourceExhausted | Code::Unimplemented
                );
                assert!(clear && !status.message().is_empty(), "{seed}: {status}");
            }
        }
    }
    assert!(
        jobs > 10 && refusals > 10,
        "{jobs} jobs, {refusals} refusals"
    );
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_message_past_the_limit_is_refused_and_the_service_stays_up() {
    let house = House::new().await;
    let mut client = house.client().await;
    let huge = "x".repeat(65 << 20);
    let error = client.submit("huge", text(&huge)).await.unwrap_err();
    assert_eq!(error.code(), Code::OutOfRange, "{error}");
    // Above gRPC's own limit of 4 MiB, below ours.
    let large = format!("{FOUR_POINTS} % {}", "x".repeat(5 << 20));
    client.submit("large", text(&large)).await.unwrap();
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn leases_and_reports_follow_the_rules() {
    let house = House::new().await;
    let mut client = house.client().await;
    let job = client.submit("a", text(MANY_PATHS)).await.unwrap();
    let mut worker = house.worker_api("fake").await;
    let lease = check_repeated_question(&mut worker).await;
    check_definitions(&mut worker, &job, &lease).await;
    check_renewal(&mut worker, &lease).await;
    check_bad_reports(&mut worker, &lease).await;
    check_reports_of_one_lease(&mut worker, &lease).await;
    // Given back, a chunk goes to the next who asks; a worker that contradicted itself gets none.
    assert!(worker.pull(1, 0).await.leases.is_empty());
    let mut worker = house.worker_api("another").await;
    let given = worker.pull(1, 5000).await.leases[0].clone();
    let request = v1::GiveBackRequest {
        identity: worker.identity(),
        leases: vec![given.id.clone().unwrap()],
        reason: v1::GiveBackReason::Draining.into(),
        message: String::new(),
        leaving: true,
    };
    worker.api.give_back(request).await.unwrap();
    let mut next = house.worker_api("next").await;
    let taken = next.pull(1, 5000).await.leases[0].clone();
    assert_eq!(taken.first, given.first);
    assert!(taken.id.unwrap().epoch > given.id.unwrap().epoch);

    let request = v1::CancelRequest { job: job.clone() };
    let cancelled = client.0.cancel(request).await.unwrap().into_inner();
    assert_eq!(cancelled.state(), v1::JobState::Cancelled);
    assert_eq!(
        client.watch(&job).await.last().unwrap().state(),
        v1::JobState::Cancelled
    );
    assert!(next.pull(1, 0).await.leases.is_empty());
    house.server.shutdown().await;
}

/// A question that is sent again gets the same answer; the lease in it.
async fn check_repeated_question(worker: &mut FakeWorker) -> v1::Lease {
    let question = worker.question(1, 10_000);
    let first = worker
        .api
        .pull(question.clone())
        .await
        .unwrap()
        .into_inner();
    let repeated_answer = worker.api.pull(question).await.unwrap().into_inner();
    assert_eq!(first.leases.len(), 1);
    assert_eq!(first.leases[0].id, repeated_answer.leases[0].id);
    let lease = first.leases[0].clone();
    assert!(lease.duration_ms > 1000);
    lease
}

/// A worker gets the problem and the stage of its lease, and none that is not there.
async fn check_definitions(worker: &mut FakeWorker, job: &str, lease: &v1::Lease) {
    let digest = lease.problem.clone();
    let problem = worker
        .api
        .get_problem(v1::GetProblemRequest { digest })
        .await;
    assert_eq!(problem.unwrap().into_inner().variables, ["x", "y"]);
    let request = v1::GetStageRequest {
        job: job.to_owned(),
        stage: 0,
    };
    let stage = worker.api.get_stage(request).await.unwrap().into_inner();
    assert!(cognate_protocol::from_proto::path::stage(&stage).is_ok());
    let nothing = v1::GetProblemRequest {
        digest: vec![0; 32].into(),
    };
    let error = worker.api.get_problem(nothing).await.unwrap_err();
    assert_eq!(error.code(), Code::NotFound);
}

/// Only a lease of the right epoch is renewed.
async fn check_renewal(worker: &mut FakeWorker, lease: &v1::Lease) {
    let request = v1::RenewRequest {
        identity: worker.identity(),
        leases: vec![
            lease.id.clone().unwrap(),
            v1::LeaseId {
                epoch: 99,
                ..lease.id.clone().unwrap()
            },
        ],
    };
    let renewed = worker.api.renew(request).await.unwrap().into_inner();
    let renewals_held: Vec<bool> = renewed.renewals.iter().map(|r| r.held).collect();
    assert_eq!(renewals_held, [true, false]);
}

/// Malformed reports, and reports of other leases, change nothing.
async fn check_bad_reports(worker: &mut FakeWorker, lease: &v1::Lease) {
    let good = FakeWorker::results(lease);
    let mut of_another_path = good.clone();
    of_another_path[0].origin += 1;
    let mut not_finite = good.clone();
    not_finite[0].endpoint[0] = f64::NAN;
    let mut too_many = good.clone();
    too_many.extend(vec![good[0].clone(); 10]);
    for bad in [of_another_path, not_finite, too_many, Vec::new()] {
        let verdict = worker.report(lease, bad).await;
        assert_eq!(verdict.verdict(), v1::Verdict::Invalid);
        assert!(!verdict.message.is_empty());
    }
    let mut old = lease.clone();
    old.id.as_mut().unwrap().epoch = 0;
    let verdict = worker.report(&old, good.clone()).await;
    assert_eq!(verdict.verdict(), v1::Verdict::Stale);
    let mut elsewhere = lease.clone();
    elsewhere.id.as_mut().unwrap().job = "0123456789abcdef".to_owned();
    let verdict = worker.report(&elsewhere, good.clone()).await;
    assert_eq!(verdict.verdict(), v1::Verdict::Stale);
}

/// A lease is reported once; the same results again do no harm, other results do.
async fn check_reports_of_one_lease(worker: &mut FakeWorker, lease: &v1::Lease) {
    let good = FakeWorker::results(lease);
    let verdict = worker.report(lease, good.clone()).await;
    assert_eq!(verdict.verdict(), v1::Verdict::Accepted);
    let verdict = worker.report(lease, good.clone()).await;
    assert_eq!(verdict.verdict(), v1::Verdict::AlreadyAccepted);
    let mut others = good;
    others[0].endpoint[2] = 0.75;
    let verdict = worker.report(lease, others).await;
    assert_eq!(verdict.verdict(), v1::Verdict::HashDiffers);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_of_another_revision_gets_no_work() {
    let house = House::new().await;
    let mut worker = house.worker_api("old").await;
    let mut question = worker.question(1, 0);
    question.machine.as_mut().unwrap().numerics_revision += 1;
    let answer = worker.api.pull(question).await.unwrap().into_inner();
    assert!(
        answer.refused.contains("numerics revision"),
        "{}",
        answer.refused
    );
    let mut question = worker.question(1, 0);
    question.machine.as_mut().unwrap().protocol_version += 1;
    let answer = worker.api.pull(question).await.unwrap().into_inner();
    assert!(
        answer.refused.contains("protocol version"),
        "{}",
        answer.refused
    );
    let mut client = house.client().await;
    let workers = client.0.list_workers(v1::ListWorkersRequest {}).await;
    let workers = workers.unwrap().into_inner().workers;
    assert!(workers[0].refused.contains("protocol version"));
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_waiting_worker_is_woken_by_work_and_by_the_end() {
    let house = House::of_long_waits().await;
    let wait = LONG_WAIT.as_millis() as u32;
    let mut worker = house.worker_api("waiting").await;
    let start = Instant::now();
    assert!(worker.pull(1, 200).await.leases.is_empty());
    assert!(start.elapsed() >= Duration::from_millis(200));

    let waiting = tokio::spawn(async move {
        let answer = worker.pull(1, wait).await;
        (worker, answer, Instant::now())
    });
    tokio::time::sleep(Duration::from_millis(100)).await;
    let mut client = house.client().await;
    let submitted = Instant::now();
    client.submit("a", text(FOUR_POINTS)).await.unwrap();
    let (mut worker, answer, woken) = waiting.await.unwrap();
    assert_eq!(answer.leases.len(), 1);
    let delay = woken - submitted;
    assert!(delay < WOKEN, "{delay:?}");

    // All is leased; this one waits until the coordinator stops.
    while !worker.pull(8, 0).await.leases.is_empty() {}
    let waiting = tokio::spawn(async move { worker.pull(1, wait).await });
    tokio::time::sleep(Duration::from_millis(100)).await;
    let start = Instant::now();
    house.server.shutdown().await;
    assert!(waiting.await.unwrap().draining);
    assert!(start.elapsed() < WOKEN);
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_begun_goes_on_after_a_restart() {
    let house = House::durable(tempfile::tempdir().unwrap()).await;
    let mut client = house.client().await;
    let job = client.submit("a", text(FOUR_POINTS)).await.unwrap();
    let mut gone = house.worker_api("gone").await;
    let lease = gone.pull(1, 10_000).await.leases[0].clone();
    let request = v1::GiveBackRequest {
        identity: gone.identity(),
        leases: vec![lease.id.unwrap()],
        reason: v1::GiveBackReason::Draining.into(),
        ..v1::GiveBackRequest::default()
    };
    gone.api.give_back(request).await.unwrap();
    let House { server, folder } = house;
    server.shutdown().await;

    let house = House::durable(folder).await;
    let worker = house.worker("real");
    let mut client = house.client().await;
    assert_eq!(
        client.watch(&job).await.last().unwrap().state(),
        v1::JobState::Solved
    );
    let restarted = client.solutions(&job).await;
    worker.stop().await;
    house.server.shutdown().await;

    let house = House::new().await;
    let worker = house.worker("real");
    let mut client = house.client().await;
    let job = client.submit("b", text(FOUR_POINTS)).await.unwrap();
    client.watch(&job).await;
    assert_eq!(client.solutions(&job).await, restarted, "bit for bit");
    worker.stop().await;
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn health_and_reflection_answer_over_tcp() {
    let house = House::new().await;
    let tcp = house
        .server
        .addresses
        .iter()
        .find_map(|address| match address {
            ListenAddress::Tcp(authority) => Some(authority.clone()),
            ListenAddress::Tls(_) | ListenAddress::Unix(_) => None,
        });
    let endpoint = tonic::transport::Endpoint::from_shared(format!("http://{}", tcp.unwrap()));
    let channel = endpoint.unwrap().connect().await.unwrap();
    let mut health = tonic_health::pb::health_client::HealthClient::new(channel.clone());
    for service in ["", "cognate.v1.ClientApi", "cognate.v1.WorkerApi"] {
        let request = tonic_health::pb::HealthCheckRequest {
            service: service.to_owned(),
        };
        let answer = health.check(request).await.unwrap().into_inner();
        assert_eq!(
            answer.status(),
            tonic_health::ServingStatus::Serving.into(),
            "{service}"
        );
    }
    use tonic_reflection::pb::v1 as reflection;
    use tonic_reflection::pb::v1::server_reflection_request::MessageRequest;
    use tonic_reflection::pb::v1::server_reflection_response::MessageResponse;
    let mut client =
        reflection::server_reflection_client::ServerReflectionClient::new(channel.clone());
    let ask = reflection::ServerReflectionRequest {
        host: String::new(),
        message_request: Some(MessageRequest::ListServices(String::new())),
    };
    let mut answers = client
        .server_reflection_info(futures::stream::iter([ask]))
        .await
        .unwrap()
        .into_inner();
    let answer = answers.message().await.unwrap().unwrap();
    let Some(MessageResponse::ListServicesResponse(list)) = answer.message_response else {
        panic!("a list of services");
    };
    let names: Vec<_> = list.service.iter().map(|s| s.name.as_str()).collect();
    assert!(names.contains(&"cognate.v1.ClientApi"), "{names:?}");
    let mut client = v1::client_api_client::ClientApiClient::new(channel);
    let info = client.get_server_info(v1::GetServerInfoRequest {}).await;
    assert!(!info.unwrap().into_inner().limits.is_empty());
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn uploaded_start_solutions_are_used() {
    let house = House::new().await;
    let worker = house.worker("real");
    let mut client = house.client().await;
    // x^2 = p from p = 1, where the solutions are 1 and -1, to p = 9 and p = 16.
    let points = cognate_continuation::start_points::StoredPoints {
        dimension: 1,
        coordinates: [1.0, -1.0]
            .map(|x| num_complex::Complex64::new(x, 0.0))
            .into(),
    };
    let bytes = points.to_bytes();
    let pieces: Vec<_> = bytes
        .chunks(10)
        .map(|piece| v1::ObjectPiece {
            data: piece.to_vec().into(),
        })
        .collect();
    let uploaded = client.0.upload(futures::stream::iter(pieces)).await;
    let uploaded = uploaded.unwrap().into_inner();
    assert_eq!(uploaded.size, bytes.len() as u64);
    let real = |re| v1::Complex { re, im: 0.0 };
    let mut problem = text("INPUT variable x; parameter p; function f; f = x^2 - p; END;");
    problem.options = Some(v1::Options {
        start: v1::StartKind::Given.into(),
        start_parameters: vec![real(1.0)],
        target_parameters: [9.0, 16.0]
            .map(|p| v1::ParameterValues {
                values: vec![real(p)],
            })
            .into(),
        start_solutions: Some(v1::StartSolutions {
            source: Some(v1::start_solutions::Source::Object(uploaded.digest)),
        }),
        ..v1::Options::default()
    });
    let job = client.submit("p", problem).await.unwrap();
    assert_eq!(
        client.watch(&job).await.last().unwrap().state(),
        v1::JobState::Solved
    );
    let mut target_roots: Vec<(u32, i64)> = Vec::new();
    for solution in client.solutions(&job).await {
        target_roots.push((solution.target, solution.variables[0].re.round() as i64));
    }
    target_roots.sort_unstable();
    assert_eq!(target_roots, [(0, -3), (0, 3), (1, -4), (1, 4)]);
    worker.stop().await;
    house.server.shutdown().await;
}

#[tokio::test]
async fn beyond_loopback_only_when_told_so() {
    let config = |insecure| Config {
        listen: vec![ListenAddress::Tcp("0.0.0.0:0".to_owned())],
        insecure,
        ledger: LedgerPlace::Memory,
        results: None,
        ..Config::default()
    };
    let refused = Server::start(config(false)).await.err().unwrap();
    assert!(matches!(
        &refused,
        ServerError::Listener(ListenError::BeyondLoopback { .. })
    ));
    assert!(refused.to_string().contains("--insecure"), "{refused}");
    Server::start(config(true)).await.unwrap().shutdown().await;
}

#[tokio::test]
async fn a_coordinator_starts_fast() {
    let mut folder = tempfile::tempdir().unwrap();
    let mut times = Vec::new();
    // 0.1 s is the goal; the fastest of many starts tells of the coordinator, the others of the machine.
    while times.len() < 50 && !times.iter().any(|time| *time < Duration::from_secs(1)) {
        let start = Instant::now();
        let House {
            server,
            folder: used,
        } = House::durable(folder).await;
        times.push(start.elapsed());
        server.shutdown().await;
        folder = used;
    }
    println!("starts: {times:?}");
    assert!(times.last().unwrap() < &Duration::from_secs(1), "{times:?}");
}
