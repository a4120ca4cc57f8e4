//! Traces: a collector hears of a job's submission, of each lease and of each report, under one number.

use crate::support::{House, MANY_PATHS, text};
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress};
use cognate_coordinator::server::Server;
use opentelemetry_proto::tonic::collector::trace::v1::trace_service_server::{
    TraceService, TraceServiceServer,
};
use opentelemetry_proto::tonic::collector::trace::v1::{
    ExportTraceServiceRequest, ExportTraceServiceResponse,
};
use opentelemetry_proto::tonic::common::v1::any_value::Value;
use opentelemetry_proto::tonic::trace::v1::Span;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tonic::{Request, Response, Status};

/// A collector that keeps what it gets.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<Vec<ExportTraceServiceRequest>>>);

#[tonic::async_trait]
impl TraceService for Kept {
    async fn export(
        &self,
        request: Request<ExportTraceServiceRequest>,
    ) -> Result<Response<ExportTraceServiceResponse>, Status> {
        self.0.lock().unwrap().push(request.into_inner());
        Ok(Response::new(ExportTraceServiceResponse::default()))
    }
}

impl Kept {
    fn spans(&self) -> Vec<Span> {
        let kept = self.0.lock().unwrap();
        let resources = kept.iter().flat_map(|request| &request.resource_spans);
        let scopes = resources.flat_map(|resource| &resource.scope_spans);
        scopes.flat_map(|scope| scope.spans.clone()).collect()
    }

    async fn listen(&self) -> String {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = format!("http://{}", listener.local_addr().unwrap());
        let incoming = tokio_stream::wrappers::TcpListenerStream::new(listener);
        let server = tonic::transport::Server::builder()
            .add_service(TraceServiceServer::new(self.clone()))
            .serve_with_incoming(incoming);
        tokio::spawn(server);
        address
    }
}

fn said(span: &Span, key: &str) -> String {
    let attribute = span.attributes.iter().find(|a| a.key == key);
    let value = attribute.and_then(|a| a.value.clone()?.value);
    match value {
        Some(Value::StringValue(text)) => text,
        Some(Value::IntValue(number)) => number.to_string(),
        other => panic!("{key}: {other:?} in {span:?}"),
    }
}

async fn house(traces: &str) -> House {
    let folder = tempfile::tempdir().unwrap();
    let config = Config {
        listen: vec![ListenAddress::Unix(folder.path().join("c.sock"))],
        traces: Some(traces.to_owned()),
        ledger: LedgerPlace::Memory,
        results: None,
        shared_memory: None,
        ..Config::default()
    };
    let server = Server::start(config).await.expect("a coordinator starts");
    House { server, folder }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_followed_from_submission_to_its_last_report() {
    let collector = Kept::default();
    let house = house(&collector.listen().await).await;
    let mut client = house.client().await;
    let worker = house.worker("worker");
    let jobs = [
        client.submit("one", text(MANY_PATHS)).await.unwrap(),
        client
            .submit("two", text(crate::support::FOUR_POINTS))
            .await
            .unwrap(),
    ];
    for job in &jobs {
        client.watch(job).await;
    }
    worker.stop().await;
    house.server.shutdown().await;

    let spans = collector.spans();
    let mut traces = Vec::new();
    for job in &jobs {
        let of_job: Vec<&Span> = spans
            .iter()
            .filter(|span| said(span, "job") == *job)
            .collect();
        let named = |name: &str| of_job.iter().filter(|span| span.name == name).count();
        assert_eq!(named("submit"), 1, "{of_job:?}");
        assert!(named("lease") > 0 && named("report") > 0, "{of_job:?}");
        let root = of_job.iter().find(|span| span.name == "submit").unwrap();
        assert_eq!((root.trace_id.len(), root.span_id.len()), (16, 8));
        assert!(root.parent_span_id.is_empty());
        for span in &of_job {
            assert_eq!(span.trace_id, root.trace_id);
            assert!(span.start_time_unix_nano <= span.end_time_unix_nano);
            match span.name.as_str() {
                "submit" => {}
                "lease" => {
                    assert_eq!(span.parent_span_id, root.span_id);
                    assert!(said(span, "items").parse::<u64>().unwrap() > 0);
                }
                "report" => {
                    let lease = said(span, "lease");
                    let given = of_job
                        .iter()
                        .find(|s| s.name == "lease" && said(s, "lease") == lease);
                    assert_eq!(span.parent_span_id, given.unwrap().span_id);
                    assert_eq!(said(span, "verdict"), "VERDICT_ACCEPTED");
                }
                other => panic!("{other}"),
            }
        }
        traces.push(root.trace_id.clone());
    }
    assert_ne!(traces[0], traces[1]);
    let kept = collector.0.lock().unwrap();
    let resource = kept[0].resource_spans[0].resource.clone().unwrap();
    assert!(resource.attributes.iter().any(|a| a.key == "service.name"));
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_waits_for_a_collector_that_is_not_there() {
    // A port that was free a moment ago.
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    drop(listener);
    let house = house(&address).await;
    let mut client = house.client().await;
    let worker = house.worker("worker");
    let job = client.submit("one", text(MANY_PATHS)).await.unwrap();
    let watched = tokio::time::timeout(Duration::from_secs(60), client.watch(&job));
    watched.await.expect("the job ends");
    worker.stop().await;
    let stopped = tokio::time::timeout(Duration::from_secs(8), house.server.shutdown());
    stopped.await.expect("the service stops");
}
