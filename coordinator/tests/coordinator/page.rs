//! The page for browsers: what it answers, and whom it does not.

use crate::support::{FOUR_POINTS, House, durable_config};
use cognate_coordinator::api::security::{Security, Tls, Tokens};
use cognate_coordinator::config::Config;
use cognate_coordinator::page::mechanisms::{MechanismQuestion, Mechanisms};
use cognate_coordinator::server::{RunningServer, Server, ServerError};
use cognate_coordinator::transport::ListenError;
use cognate_numeric::interruption::is_interrupted;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::connect::{CredentialFiles, Credentials, Role};
use http_body_util::{BodyExt, Full};
use rcgen::{CertificateParams, KeyPair};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tonic::body::Body;
use tonic::transport::Channel;
use tower::ServiceExt;

/// A coordinator with a page on loopback, and a folder.
async fn house() -> House {
    let folder = tempfile::tempdir().unwrap();
    let config = Config {
        page: Some("127.0.0.1:0".to_owned()),
        ..durable_config(folder.path())
    };
    let server = Server::start(config).await.expect("a coordinator starts");
    House { server, folder }
}

/// Host and port of the page.
fn authority(server: &RunningServer) -> String {
    let url = server.page.as_deref().expect("it has a page");
    let rest = url.trim_start_matches("http://").trim_end_matches('/');
    rest.to_owned()
}

/// An answer: status, headers in small letters, body.
struct Answer {
    status: u16,
    head: String,
    body: String,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.body))
    }
}

/// One request, with the headers of the page's own script unless others are given.
async fn ask(at: &str, method: &str, path: &str, headers: &[&str], body: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(at).await.unwrap();
    let has_host = headers.iter().any(|h| h.starts_with("Host:"));
    let host = match has_host {
        true => String::new(),
        false => format!("Host: {at}\r\n"),
    };
    let more: String = headers.iter().map(|h| format!("{h}\r\n")).collect();
    let length = body.len();
    let head = format!(
        "{method} {path} HTTP/1.1\r\n{host}Connection: close\r\nContent-Length: {length}\r\n{more}\r\n"
    );
    stream.write_all(head.as_bytes()).await.unwrap();
    stream.write_all(body).await.unwrap();
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).await.unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").expect("an answer");
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    let head = head.to_lowercase();
    let body = match head.contains("transfer-encoding: chunked") {
        true => unchunked(body),
        false => body.to_owned(),
    };
    Answer { status, head, body }
}

fn unchunked(mut rest: &str) -> String {
    let mut whole = String::new();
    while let Some((size, after)) = rest.split_once("\r\n") {
        let size = usize::from_str_radix(size, 16).unwrap();
        if size == 0 {
            return whole;
        }
        whole.push_str(&after[..size]);
        rest = &after[size + 2..];
    }
    panic!("the answer was cut off");
}

const OWN: &str = "X-Cognate: page";

async fn get(at: &str, path: &str) -> Answer {
    ask(at, "GET", path, &[], b"").await
}

async fn submit(at: &str, name: &str, content: &str) -> String {
    let path = format!("/api/jobs?name={name}&seed=7");
    let made = ask(at, "POST", &path, &[OWN], content.as_bytes()).await;
    assert_eq!(made.status, 200, "{}", made.body);
    made.json()["job"].as_str().unwrap().to_owned()
}

/// Solves until nobody waits any more; counts what it began and what was interrupted.
#[derive(Debug, Default)]
struct Endless {
    begun: AtomicUsize,
    interrupted: AtomicUsize,
}

impl Mechanisms for Endless {
    fn describe(&self, _: &str, _: &str) -> Result<Value, String> {
        Ok(json!({}))
    }

    fn positions(&self, _: &MechanismQuestion) -> Result<Value, String> {
        self.begun.fetch_add(1, Ordering::Relaxed);
        while !is_interrupted() {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.interrupted.fetch_add(1, Ordering::Relaxed);
        Err("nobody waits for it any more".to_owned())
    }
}

/// Waits until a count is reached.
async fn reaches(count: &AtomicUsize, wanted: usize) {
    let reached = async {
        while count.load(Ordering::Relaxed) < wanted {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    let waited = tokio::time::timeout(Duration::from_secs(20), reached).await;
    waited.expect("it is reached");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_mechanism_is_solved_as_long_as_somebody_waits() {
    let folder = tempfile::tempdir().unwrap();
    let endless = Arc::new(Endless::default());
    let config = Config {
        page: Some("127.0.0.1:0".to_owned()),
        mechanisms: Some(endless.clone()),
        ..durable_config(folder.path())
    };
    let server = Server::start(config).await.expect("a coordinator starts");
    let at = authority(&server);
    let (path, body) = (
        "/api/mechanism/positions?name=a.json&given=inputs",
        br#"{"file": "{}", "targets": ""}"#,
    );
    for round in 1..=2 {
        let asked = ask(&at, "POST", path, &[OWN], body);
        tokio::select! {
            answer = asked => panic!("answered: {}", answer.body),
            () = reaches(&endless.begun, round) => {}
        }
        // The connection is closed; the next question finds the place free.
        reaches(&endless.interrupted, round).await;
        let described = ask(&at, "POST", "/api/mechanism?name=a.json", &[OWN], body).await;
        assert_eq!(described.status, 200, "{}", described.body);
    }
    server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_job_goes_from_a_dropped_file_to_its_solutions() {
    let house = house().await;
    let at = authority(&house.server);
    let job = submit(&at, "four%20points.bertini", FOUR_POINTS).await;
    let waiting = get(&at, &format!("/api/results/{job}")).await;
    assert_eq!(waiting.status, 409, "{}", waiting.body);
    let worker = house.worker("w");
    let events = get(&at, &format!("/api/events?job={job}")).await;
    assert_eq!(events.status, 200);
    assert!(events.head.contains("content-type: text/event-stream"));
    let told: Vec<&str> = events.body.lines().collect();
    assert!(told.contains(&"event: end"), "{}", events.body);
    let last = told
        .iter()
        .rfind(|line| line.starts_with("data: {\"elapsed"));
    let last: Value = serde_json::from_str(&last.unwrap()[6..]).unwrap();
    assert_eq!(last["state"], "solved");
    let progress = get(&at, &format!("/api/jobs/{job}/progress")).await.json();
    assert_eq!(
        progress["outcomes"],
        json!({"failed": 0, "regular": 4, "singular": 0})
    );
    let list = get(&at, "/api/jobs?limit=1").await.json();
    let submitted = list["jobs"][0]["submitted_unix_ms"].clone();
    let expected = json!({"from": 0, "more": false, "jobs": [{"job": job, "name": "four points.bertini",
        "tenant": "default", "state": "solved", "submitted_unix_ms": submitted, "paths_total": 4, "paths_accepted": 4}]});
    assert_eq!(list, expected);
    let explained = get(&at, &format!("/api/jobs/{job}")).await.json();
    assert_eq!(explained["seed"], 7);
    let summary = get(&at, &format!("/api/results/{job}")).await.json();
    assert_eq!(summary["solutions"]["real"], 4);
    let workers = get(&at, "/api/workers").await.json();
    assert_eq!(workers["workers"][0]["accepted_paths"], 4);
    results_are_given(&at, &job).await;
    worker.stop().await;
    house.server.shutdown().await;
}

async fn results_are_given(at: &str, job: &str) {
    let points = get(at, &format!("/api/results/{job}/points")).await.json();
    assert_eq!((&points["total"], &points["shown"]), (&json!(4), &json!(4)));
    assert_eq!(points["variables"], json!(["x", "y"]));
    let mut products: Vec<f64> = Vec::new();
    for point in points["points"].as_array().unwrap() {
        assert_eq!(point[2], "real");
        let real = |k: usize| point[5][k][0].as_f64().unwrap();
        products.push(real(0) * real(1));
    }
    assert!(
        products.iter().all(|p| (p - 2.0).abs() < 1e-5),
        "{products:?}"
    );
    let page = get(at, &format!("/api/results/{job}/solutions?from=1&limit=2")).await;
    let page = page.json();
    assert_eq!(page["solutions"].as_array().unwrap().len(), 2);
    assert_eq!(page["more"], true);
    let listing = get(at, &format!("/api/results/{job}/solutions.jsonl")).await;
    assert!(listing.head.contains("content-disposition: attachment"));
    let lines: Vec<Value> = listing
        .body
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[1]["variables"], page["solutions"][0]["variables"]);
    let failures = get(at, &format!("/api/results/{job}/failures"))
        .await
        .json();
    assert_eq!(
        failures,
        json!({"total": 0, "shown": 0, "reasons": {}, "failures": []})
    );
    let other = get(at, &format!("/api/results/{job}/decomposition.json")).await;
    assert_eq!(other.status, 409, "{}", other.body);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn lists_have_pages_and_jobs_are_cancelled() {
    let house = house().await;
    let at = authority(&house.server);
    let mut jobs = Vec::new();
    for k in 0..5 {
        jobs.push(submit(&at, &format!("job{k}"), FOUR_POINTS).await);
    }
    let names = |list: &Value| -> Vec<String> {
        let rows = list["jobs"].as_array().unwrap().iter();
        rows.map(|j| j["name"].as_str().unwrap().to_owned())
            .collect()
    };
    let first = get(&at, "/api/jobs?from=0&limit=2").await.json();
    assert_eq!(
        (names(&first), &first["more"]),
        (vec!["job4".into(), "job3".into()], &json!(true))
    );
    let last = get(&at, "/api/jobs?from=4&limit=2").await.json();
    assert_eq!(
        (names(&last), &last["more"]),
        (vec!["job0".into()], &json!(false))
    );
    let beyond = get(&at, "/api/jobs?from=99").await.json();
    assert_eq!((names(&beyond), &beyond["more"]), (vec![], &json!(false)));
    let cancelled = ask(
        &at,
        "DELETE",
        &format!("/api/jobs/{}", jobs[0]),
        &[OWN],
        b"",
    )
    .await;
    assert_eq!(
        cancelled.json(),
        json!({"job": jobs[0], "state": "cancelled"})
    );
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn wrong_requests_hear_what_is_wrong() {
    let house = house().await;
    let at = authority(&house.server);
    for (method, path, body, status, says) in [
        (
            "GET",
            "/api/jobs?limit=0",
            "",
            400,
            "limit is 0; expected 1 to 500",
        ),
        (
            "GET",
            "/api/jobs?from=-1",
            "",
            400,
            "from is `-1`; expected a whole number",
        ),
        (
            "GET",
            "/api/jobs?form=1",
            "",
            400,
            "`form` is no option here",
        ),
        ("GET", "/api/jobs/nobody", "", 400, "job"),
        ("GET", "/api/results/0123456789abcdef", "", 404, "job"),
        ("GET", "/api/nothing", "", 404, "nothing at this address"),
        ("GET", "/etc/passwd", "", 404, "nothing at this address"),
        ("PUT", "/api/jobs", "", 405, "PUT means nothing here"),
        ("POST", "/api/jobs?name=a", "", 400, "the file is empty"),
        (
            "POST",
            "/api/jobs?name=a&start=best",
            "x",
            400,
            "start is `best`; expected",
        ),
        (
            "POST",
            "/api/jobs?name=a&certify=1",
            "x",
            400,
            "certify is `1`; expected true or false",
        ),
        (
            "POST",
            "/api/jobs?name=a.bertini",
            "INPUT variable_group x; function f; f = x^2 - ; END;",
            400,
            "a.bertini:1:",
        ),
        ("POST", "/api/login", "x", 400, "asks for no token"),
    ] {
        let answer = ask(&at, method, path, &[OWN], body.as_bytes()).await;
        assert_eq!(answer.status, status, "{method} {path}: {}", answer.body);
        let error = answer.json()["error"].as_str().unwrap().to_owned();
        assert!(error.contains(says), "{method} {path}: {error}");
    }
    // More than a message may have is not taken into memory.
    let mut stream = TcpStream::connect(&at).await.unwrap();
    let head = format!(
        "POST /api/jobs?name=a HTTP/1.1\r\nHost: {at}\r\n{OWN}\r\nContent-Length: 99999999999\r\n\r\n"
    );
    stream.write_all(head.as_bytes()).await.unwrap();
    let mut begin = [0; 12];
    let answered =
        tokio::time::timeout(Duration::from_secs(60), stream.read_exact(&mut begin)).await;
    answered.expect("an answer").unwrap();
    assert_eq!(&begin, b"HTTP/1.1 413");
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn forged_hosts_and_requests_of_other_pages_are_refused() {
    let house = house().await;
    let at = authority(&house.server);
    let port = at.rsplit(':').next().unwrap();
    for path in ["/", "/api/jobs"] {
        let rebound = ask(&at, "GET", path, &["Host: evil.example"], b"").await;
        assert_eq!(rebound.status, 421, "{path}");
        let rebound = format!("Host: evil.example:{port}");
        assert_eq!(ask(&at, "GET", path, &[&rebound], b"").await.status, 421);
    }
    let body = FOUR_POINTS.as_bytes();
    for headers in [
        vec!["Origin: http://evil.example", OWN],
        vec!["Origin: null", OWN],
        vec!["Sec-Fetch-Site: cross-site", OWN],
        vec!["Sec-Fetch-Site: same-site", OWN],
        // A form of another page cannot send the header.
        vec!["Content-Type: text/plain"],
    ] {
        let refused = ask(&at, "POST", "/api/jobs?name=a", &headers, body).await;
        assert_eq!(refused.status, 403, "{headers:?}");
    }
    let foreign = ask(
        &at,
        "GET",
        "/api/jobs",
        &["Origin: http://evil.example"],
        b"",
    )
    .await;
    assert_eq!(foreign.status, 403);
    let preflight = ask(
        &at,
        "OPTIONS",
        "/api/jobs",
        &["Origin: http://evil.example"],
        b"",
    )
    .await;
    assert_eq!(preflight.status, 403);
    assert!(!preflight.head.contains("access-control"));
    let list = get(&at, "/api/jobs").await;
    assert_eq!(list.json()["jobs"], json!([]), "nothing was made");
    assert!(!list.head.contains("access-control") && !list.head.contains("set-cookie"));
    house.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn scripts_of_the_page_run_and_no_others() {
    let house = house().await;
    let at = authority(&house.server);
    let (one, two) = (get(&at, "/").await, get(&at, "/").await);
    let nonce = |answer: &Answer| {
        let policy = answer
            .head
            .lines()
            .find(|l| l.starts_with("content-security-policy"));
        let (_, rest) = policy.unwrap().split_once("script-src 'nonce-").unwrap();
        rest.split('\'').next().unwrap().to_owned()
    };
    assert_ne!(nonce(&one), nonce(&two));
    assert!(
        one.body
            .contains(&format!("<script nonce=\"{}\">", nonce(&one)))
    );
    assert!(!one.body.contains("{{nonce}}"));
    for header in [
        "x-content-type-options: nosniff",
        "x-frame-options: deny",
        "cache-control: no-store",
    ] {
        assert!(one.head.contains(header), "{header}");
    }
    assert!(!one.head.contains("unsafe-inline"));
    house.server.shutdown().await;
}

/// A certificate for localhost in two files.
fn tls(folder: &std::path::Path) -> Tls {
    let key = KeyPair::generate().unwrap();
    let parameters = CertificateParams::new(vec!["localhost".to_owned()]).unwrap();
    let signed = parameters.self_signed(&key).unwrap();
    let (certificate, secret) = (folder.join("own.pem"), folder.join("own.key"));
    std::fs::write(&certificate, signed.pem()).unwrap();
    std::fs::write(&secret, key.serialize_pem()).unwrap();
    Tls::read(&certificate, &secret, None).unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn beyond_this_machine_the_page_needs_tokens_and_tls() {
    let folder = tempfile::tempdir().unwrap();
    let tokens = folder.path().join("tokens");
    std::fs::write(&tokens, "client client-0123456789\n").unwrap();
    let start = async |security: Security, insecure: bool| {
        let config = Config {
            page: Some("0.0.0.0:0".to_owned()),
            security,
            insecure,
            ..durable_config(tempfile::tempdir().unwrap().path())
        };
        Server::start(config).await
    };
    let tokens = || Some(Tokens::read(&tokens).unwrap());
    for security in [
        Security::default(),
        Security {
            tokens: tokens(),
            ..Security::default()
        },
        Security {
            tokens: None,
            tls: Some(tls(folder.path())),
            ..Security::default()
        },
    ] {
        let refused = start(security, false).await.map(|_| ());
        let is = |e| {
            matches!(
                e,
                ServerError::Listener(ListenError::PageBeyondLoopback { .. })
            )
        };
        assert!(refused.is_err_and(is));
    }
    let both = Security {
        tokens: tokens(),
        tls: Some(tls(folder.path())),
        ..Security::default()
    };
    let server = start(both, false).await.unwrap();
    assert!(
        server
            .page
            .as_deref()
            .unwrap()
            .starts_with("https://0.0.0.0:")
    );
    server.shutdown().await;
}

/// A client's channel to the page of a server with the certificate of `tls`.
fn channel_over_tls(server: &RunningServer, folder: &std::path::Path) -> Channel {
    let url = server.page.as_deref().expect("it has a page");
    let port = url.trim_end_matches('/').rsplit(':').next().unwrap();
    let files = CredentialFiles {
        tls_ca: Some(folder.join("own.pem")),
        ..CredentialFiles::default()
    };
    let credentials = Credentials::read(&files, Role::Client).unwrap();
    let address = Address::Tls(format!("localhost:{port}"));
    credentials.channel(&address).unwrap()
}

/// The page of a server that asks for tokens.
struct GuardedPage(Channel);

/// An answer of a guarded page: status, the cookie that it sets, body.
struct GuardedAnswer {
    status: u16,
    set_cookie: Option<String>,
    body: String,
}

impl GuardedAnswer {
    /// Name and value of the cookie, as a browser sends them back.
    fn cookie(&self) -> String {
        let cookie = self.set_cookie.as_deref().expect("a cookie");
        cookie.split(';').next().unwrap().to_owned()
    }
}

impl GuardedPage {
    async fn ask(
        &self,
        method: &str,
        path: &str,
        cookie: Option<&str>,
        body: &'static str,
    ) -> GuardedAnswer {
        let mut request = http::Request::builder()
            .method(method)
            .uri(path)
            .header("x-cognate", "page");
        if let Some(cookie) = cookie {
            request = request.header("cookie", cookie);
        }
        let request = request.body(Body::new(Full::new(body.into()))).unwrap();
        let answer = self.0.clone().oneshot(request).await.unwrap();
        let (parts, body) = answer.into_parts();
        let set_cookie = parts.headers.get("set-cookie");
        let set_cookie = set_cookie.map(|value| value.to_str().unwrap().to_owned());
        let body = body.collect().await.unwrap().to_bytes();
        GuardedAnswer {
            status: parts.status.as_u16(),
            set_cookie,
            body: String::from_utf8(body.to_vec()).unwrap(),
        }
    }

    async fn log_in(&self, token: &'static str) -> GuardedAnswer {
        self.ask("POST", "/api/login", None, token).await
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_token_opens_the_page_by_a_cookie() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tokens");
    let content = "client client-0123456789\nworker worker-0123456789\nviewer viewer-0123456789\n";
    std::fs::write(&file, content).unwrap();
    let config = Config {
        page: Some("localhost:0".to_owned()),
        security: Security {
            tokens: Some(Tokens::read(&file).unwrap()),
            tls: Some(tls(folder.path())),
            ..Security::default()
        },
        ..durable_config(folder.path())
    };
    let server = Server::start(config).await.unwrap();
    let page = GuardedPage(channel_over_tls(&server, folder.path()));
    check_page_without_a_token(&page).await;
    let client = check_client_logs_in(&page).await;
    let viewer = check_viewer_only_looks(&page).await;

    let forged = format!("{client}00");
    let jobs = async |cookie: &str| page.ask("GET", "/api/jobs", Some(cookie), "").await.status;
    assert_eq!(jobs(&forged).await, 401);
    let logout = page.ask("POST", "/api/logout", Some(&client), "").await;
    assert!(logout.set_cookie.unwrap().contains("Max-Age=0"));
    // The session has ended here, too, even for a browser that has kept its cookie.
    assert_eq!(jobs(&client).await, 401);
    assert_eq!(jobs(&viewer).await, 200);
    server.shutdown().await;
}

/// The page itself holds nothing; all else asks for a token, which must be a client's.
async fn check_page_without_a_token(page: &GuardedPage) {
    assert_eq!(page.ask("GET", "/", None, "").await.status, 200);
    for path in ["/api/jobs", "/api/workers", "/api/info", "/api/events"] {
        let answer = page.ask("GET", path, None, "").await;
        assert_eq!(answer.status, 401, "{path}");
        assert!(answer.body.contains("asks for a token"), "{}", answer.body);
    }
    let submitted = page.ask("POST", "/api/jobs?name=a", None, "x").await;
    assert_eq!(submitted.status, 401);
    let answer = page.log_in("client-9876543210").await;
    let outcome = (answer.status, answer.set_cookie);
    assert_eq!(outcome, (401, None), "not this coordinator's");
    let answer = page.log_in("worker-0123456789").await;
    let outcome = (answer.status, answer.set_cookie);
    assert_eq!(outcome, (403, None), "a worker's");
}

/// A client's token gets a cookie that only this page sends back; the client's cookie.
async fn check_client_logs_in(page: &GuardedPage) -> String {
    let login = page.log_in("client-0123456789\n").await;
    assert_eq!(login.status, 200);
    let set_cookie = login.set_cookie.as_deref().expect("a cookie");
    for part in [
        "__Host-cognate=",
        "; Secure",
        "; HttpOnly",
        "; SameSite=Strict",
    ] {
        assert!(set_cookie.contains(part), "{set_cookie}");
    }
    let cookie = login.cookie();
    let answer = page.ask("GET", "/api/jobs", Some(&cookie), "").await;
    assert_eq!(
        (answer.status, answer.body.as_str()),
        (200, r#"{"from":0,"jobs":[],"more":false}"#)
    );
    cookie
}

/// A viewer sees the jobs, and changes nothing; the viewer's cookie.
async fn check_viewer_only_looks(page: &GuardedPage) -> String {
    let login = page.log_in("viewer-0123456789").await;
    let cookie = login.cookie();
    let viewer = Some(cookie.as_str());
    assert_eq!(login.status, 200);
    let info = page.ask("GET", "/api/info", viewer, "").await;
    assert!(
        info.status == 200 && info.body.contains(r#""reads_only":true"#),
        "{}",
        info.body
    );
    assert_eq!(page.ask("GET", "/api/jobs", viewer, "").await.status, 200);
    let system = "variable_group x; function f; f = x - 1; END;";
    for (method, path) in [
        ("POST", "/api/jobs?name=a"),
        ("DELETE", "/api/jobs/0123456789abcdef"),
        ("POST", "/api/mechanism"),
    ] {
        let answer = page.ask(method, path, viewer, system).await;
        assert_eq!(answer.status, 403, "{method} {path}: {}", answer.body);
    }
    cookie
}

/// Attack L of the third attack on the service (2026-11): bodies were gathered before anybody looked at the token.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_body_is_read_after_its_token() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tokens");
    std::fs::write(&file, "client client-0123456789\n").unwrap();
    let config = Config {
        page: Some("localhost:0".to_owned()),
        audit_log: Some(folder.path().join("audit.jsonl")),
        security: Security {
            tokens: Some(Tokens::read(&file).unwrap()),
            tls: Some(tls(folder.path())),
            ..Security::default()
        },
        ..durable_config(folder.path())
    };
    let server = Server::start(config).await.unwrap();
    let channel = channel_over_tls(&server, folder.path());
    // The page waits up to a minute for a body that never comes.
    let asks = (0..3).map(|_| {
        let body = http_body_util::StreamBody::new(futures::stream::pending::<
            Result<http_body::Frame<bytes::Bytes>, tonic::Status>,
        >());
        let request = http::Request::builder()
            .method("POST")
            .uri("/api/jobs?name=a")
            .header("x-cognate", "page")
            .header("authorization", "Bearer nobody-at-all")
            .body(Body::new(body))
            .unwrap();
        channel.clone().oneshot(request)
    });
    for answer in futures::future::join_all(asks).await {
        assert_eq!(answer.unwrap().status().as_u16(), 401);
    }
    let audit = std::fs::read_to_string(folder.path().join("audit.jsonl")).unwrap();
    let refused = audit
        .lines()
        .filter(|line| line.contains("none of this coordinator"));
    assert_eq!(refused.count(), 3, "{audit}");
    server.shutdown().await;
}
