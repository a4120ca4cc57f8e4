//! Answers: which address of the page gives what.
//!
//! | address | answer |
//! |---|---|
//! | `GET /` | the page |
//! | `GET /api/info` | versions, and whether a token is asked for |
//! | `POST /api/login`, `/api/logout` | the cookie of a session for the token in the body; the session ends |
//! | `GET /api/jobs?from=&limit=` | jobs, newest first, as `cognate jobs --format json` has them |
//! | `POST /api/jobs?name=&start=&seed=&certify=&decompose=&request=` | the body as a job |
//! | `GET /api/jobs/ID`, `/api/jobs/ID/progress` | as `cognate explain` and `cognate watch` have it |
//! | `DELETE /api/jobs/ID` | the job is cancelled |
//! | `GET /api/workers` | as `cognate workers --format json` has them |
//! | `GET /api/results/ID` and `.../summary.json` | the summary |
//! | `GET /api/results/ID/solutions?from=&limit=`, `.../solutions.jsonl` | some solutions, or all of them |
//! | `GET /api/results/ID/points` | the solutions as a picture has them |
//! | `GET /api/results/ID/failures` | paths that failed |
//! | `GET /api/results/ID/decomposition.json` | components with their witness points |
//! | `POST /api/mechanism?name=` | inputs and examples of the mechanism `file` of the body |
//! | `POST /api/mechanism/positions?name=&given=&follow=&certify=` | its positions at the body's `targets` |
//! | `GET /api/events?job=` or `?from=&limit=` | what changes |

use super::access::{self, Access, Refusal, Shown};
use super::caller::{Calls, Services, calls};
use super::events;
use super::mechanisms::{self, MechanismQuestion, Mechanisms};
use super::points::Sample;
use super::request::{Fault, Query, answer, download, fault, full, json_text, json_value};
use super::sessions::Sessions;
use crate::recent::Recent;
use bytes::Bytes;
use cognate_numeric::interruption::Interruption;
use cognate_protocol::limits::MESSAGE_BYTES;
use cognate_protocol::option_misfit::any_of;
use cognate_protocol::submission::{Decompose, Options, Source, StartKind, Submission};
use cognate_protocol::{client_json, from_proto, to_proto, v1};
use cognate_summary::AnySummary;
use cognate_summary::pictures::{MECHANISM, SCENE};
use futures::{Stream, StreamExt};
use http::header::{CONTENT_SECURITY_POLICY, SET_COOKIE};
use http::{HeaderValue, Method, Response, StatusCode};
use http_body::Frame;
use http_body_util::{BodyExt, LengthLimitError, Limited, StreamBody};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, SemaphorePermit};
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tonic::body::Body;
use tonic::{Code, Status};

const HTML: &str = include_str!("page.html");
/// Stands in the page where the number of one answer goes, without which no script of it runs.
const NONCE: &str = "{{nonce}}";
/// Rows of a list where no limit is given, and at most.
const ROWS: u32 = 100;
const MOST_ROWS: u32 = 500;
/// Failed paths that are named one by one.
const FAILURES: usize = 100;
/// Files that are taken at a time, each of which may have as many bytes as a message.
const UPLOADS: usize = 2;
/// Browsers that hear of changes at a time.
const LISTENERS: usize = 100;
/// How long a file waits for its turn.
const FILE_TURN: Duration = Duration::from_secs(20);
/// A file must have arrived after this time.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long a question about a mechanism waits for the one before it: one that was cancelled ends sooner.
const TURN: Duration = Duration::from_secs(3);
/// Pictures of jobs that were looked at lately.
const PICTURES: usize = 4;
/// Bytes of a token.
const TOKEN_BYTES: usize = 4096;
/// The type of a page's text.
const HTML_TYPE: &str = "text/html; charset=utf-8";
const JSON: &str = "application/json";

/// The page of a coordinator.
pub struct Page {
    access: Access,
    sessions: Sessions,
    services: Services,
    stopping: CancellationToken,
    uploads: Semaphore,
    listeners: Arc<Semaphore>,
    pictures: Recent<String, Bytes>,
    mechanisms: Option<Arc<dyn Mechanisms>>,
    /// One question about a mechanism at a time.
    solving: Arc<Semaphore>,
}

impl Page {
    /// In front of these services.
    pub fn new(
        access: Access,
        services: Services,
        mechanisms: Option<Arc<dyn Mechanisms>>,
        stopping: CancellationToken,
    ) -> Self {
        Self {
            access,
            sessions: Sessions::default(),
            services,
            stopping,
            uploads: Semaphore::new(UPLOADS),
            listeners: Arc::new(Semaphore::new(LISTENERS)),
            pictures: Recent::new(PICTURES),
            mechanisms,
            solving: Arc::new(Semaphore::new(1)),
        }
    }

    /// The answer to a request, whatever it is.
    pub async fn answer(&self, request: http::Request<Body>) -> Response<Body> {
        match self.answered(request).await {
            Ok(response) => response,
            Err(no) => fault(&no),
        }
    }

    async fn answered(&self, request: http::Request<Body>) -> Result<Response<Body>, Fault> {
        let (parts, body) = request.into_parts();
        let checked = self.access.check(&parts.method, &parts.uri, &parts.headers);
        checked.map_err(|refusal| {
            let path = parts.uri.path();
            tracing::warn!(method = %parts.method, path, why = %refusal, "a request for the page is refused");
            refused(&refusal)
        })?;
        let path = parts.uri.path().trim_start_matches('/');
        let path: Vec<&str> = path.split('/').collect();
        let reads = matches!(parts.method, Method::GET | Method::HEAD);
        let query = Query::read(parts.uri.query())?;
        match path.as_slice() {
            [""] if reads => return Ok(html()),
            ["api", "login"] if parts.method == Method::POST => return self.login(body).await,
            ["api", "logout"] if parts.method == Method::POST => {
                if let Some(session) = access::session(&parts.headers) {
                    self.sessions.end(&session);
                }
                return Ok(with_cookie(None));
            }
            _ => {}
        }
        let token = match access::shown(&parts.headers) {
            Some(Shown::Token(token)) => Some(token),
            Some(Shown::Session(session)) => self.sessions.token(&session),
            None => None,
        };
        let calls = self.calls(token.as_deref())?;
        match (path.as_slice(), &parts.method) {
            (["api", what @ ..], _) if reads => self.read(what, query, calls).await,
            (["api", "jobs"], &Method::POST) => self.submit(query, body, calls).await,
            (["api", "mechanism"], &Method::POST) => self.mechanism(query, body, calls).await,
            (["api", "mechanism", "positions"], &Method::POST) => {
                self.positions(query, body, calls).await
            }
            (["api", "jobs", job], &Method::DELETE) => cancel(job, calls).await,
            (["api", ..], _) => Err(Fault {
                status: StatusCode::METHOD_NOT_ALLOWED,
                message: format!("{} means nothing here", parts.method),
            }),
            _ => Err(Fault::not_found()),
        }
    }

    /// The service, called with this token.
    fn calls(&self, token: Option<&str>) -> Result<Calls, Fault> {
        match (self.access.asks_for_tokens(), token) {
            (true, None) => Err(refused(&Refusal::NoToken)),
            (true, token) => Ok(calls(&self.services, token)),
            // All callers of this page are the user of this machine: their credentials do not matter.
            (false, _) => Ok(calls(&self.services, None)),
        }
    }

    /// Everything that changes nothing.
    async fn read(
        &self,
        what: &[&str],
        query: Query,
        mut calls: Calls,
    ) -> Result<Response<Body>, Fault> {
        let wanted = match what {
            ["jobs"] | ["results", _, "solutions"] => query.only(&["from", "limit"])?,
            ["events"] => query.only(&["job", "from", "limit"])?,
            _ => query.only(&[])?,
        };
        match what {
            ["info"] => self.info(calls).await,
            ["jobs"] => {
                let (from, limit) = rows(&wanted)?;
                let list = events::jobs(&mut calls, from, limit).await?;
                Ok(json_value(&list))
            }
            ["workers"] => Ok(json_value(&events::workers(&mut calls).await?)),
            ["jobs", job] => {
                let job = (*job).to_owned();
                let explained = calls.explain(v1::ExplainRequest { job }).await?;
                Ok(json_text(explained.into_inner().json))
            }
            ["jobs", job, "progress"] => {
                let job = (*job).to_owned();
                let mut told = calls.watch(v1::WatchRequest { job }).await?.into_inner();
                let progress = told.message().await?.ok_or_else(Fault::not_found)?;
                Ok(json_value(&client_json::progress(&progress)))
            }
            ["results", job] => Ok(json_text(summary(&mut calls, job).await?)),
            ["results", job, "summary.json"] => {
                let text = summary(&mut calls, job).await?;
                Ok(download(&format!("{job}.summary.json"), JSON, full(text)))
            }
            ["results", job, "solutions"] => {
                let (from, limit) = rows(&wanted)?;
                some_solutions(&mut calls, job, from as usize, limit as usize).await
            }
            ["results", job, "solutions.jsonl"] => all_solutions(calls, job).await,
            ["results", job, "points"] => self.picture(calls, job).await,
            ["results", job, "failures"] => failures(calls, job).await,
            ["results", job, "decomposition.json"] => decomposition(calls, job).await,
            ["events"] => self.events(&wanted, calls).await,
            _ => Err(Fault::not_found()),
        }
    }

    async fn info(&self, mut calls: Calls) -> Result<Response<Body>, Fault> {
        let info = calls.get_server_info(v1::GetServerInfoRequest {}).await?;
        let info = info.into_inner();
        let starts = StartKind::ALL.iter();
        // Starts that need more than a file are for the command line.
        let starts = starts.filter(|start| **start != StartKind::Given);
        Ok(json_value(&json!({
            "version": info.version,
            "protocol_version": info.protocol_version,
            "numerics_revision": info.numerics_revision,
            "asks_for_tokens": self.access.asks_for_tokens(),
            "reads_only": info.reads_only,
            "mechanisms": self.mechanisms.is_some() && !info.reads_only,
            "starts": starts.map(|start| start.name()).collect::<Vec<_>>(),
            "most_bytes": MESSAGE_BYTES.value,
        })))
    }

    /// Gives the cookie for a token that opens something.
    async fn login(&self, body: Body) -> Result<Response<Body>, Fault> {
        if !self.access.asks_for_tokens() {
            return Err(Fault::of_request("this page asks for no token"));
        }
        let bytes = gather(body, TOKEN_BYTES).await?;
        let token = String::from_utf8_lossy(&bytes).trim().to_owned();
        let mut calls = self.calls(Some(&token))?;
        calls.get_server_info(v1::GetServerInfoRequest {}).await?;
        Ok(with_cookie(Some(&self.sessions.begin(&token))))
    }

    async fn submit(
        &self,
        query: Query,
        body: Body,
        mut calls: Calls,
    ) -> Result<Response<Body>, Fault> {
        let (request_id, options) = submission_options(query)?;
        may_change(&mut calls).await?;
        let turn = self.file_turn().await?;
        let most = usize::try_from(MESSAGE_BYTES.value).unwrap_or(usize::MAX);
        let content = gather(body, most).await?;
        if content.is_empty() {
            return Err(Fault::of_request("the file is empty"));
        }
        let submission = Submission {
            source: Source::Text {
                name: options.name.clone(),
                content: content.into(),
            },
            options,
        };
        let request = v1::SubmitRequest {
            request_id,
            problem: Some(to_proto::problem::submission(&submission)),
            tenant: String::new(),
        };
        drop(submission);
        let accepted = calls.submit(request).await?.into_inner();
        drop(turn);
        let answer = client_json::submitted(&accepted.job, &accepted.warnings);
        Ok(json_value(&answer))
    }

    /// Waits until the file of a request may be taken: the number of files in memory is limited.
    async fn file_turn(&self) -> Result<SemaphorePermit<'_>, Fault> {
        let turn = timeout(FILE_TURN, self.uploads.acquire()).await;
        turn.ok().and_then(Result::ok).ok_or_else(|| Fault {
            status: StatusCode::SERVICE_UNAVAILABLE,
            message: "others are sending files: try again".to_owned(),
        })
    }

    /// Inputs of a mechanism, and examples of its targets.
    async fn mechanism(
        &self,
        query: Query,
        body: Body,
        calls: Calls,
    ) -> Result<Response<Body>, Fault> {
        let query = query.only(&["name"])?;
        let name = query.get("name").unwrap_or("mechanism.json").to_owned();
        self.of_mechanisms(calls, body, move |mechanisms, sent| {
            mechanisms.describe(&name, &sent.file)
        })
        .await
    }

    /// Positions of a mechanism, or its branches.
    async fn positions(
        &self,
        query: Query,
        body: Body,
        calls: Calls,
    ) -> Result<Response<Body>, Fault> {
        let query = query.only(&["name", "given", "follow", "certify"])?;
        let poses = match query.get("given") {
            Some("poses") => true,
            Some("inputs") => false,
            given => {
                let given = given.unwrap_or_default();
                let message = format!("given is `{given}`; expected poses or inputs");
                return Err(Fault::of_request(message));
            }
        };
        let name = query.get("name").unwrap_or("mechanism.json").to_owned();
        let (follow, certify) = (query.flag("follow")?, query.flag("certify")?);
        self.of_mechanisms(calls, body, move |mechanisms, sent| {
            mechanisms.positions(&MechanismQuestion {
                name,
                file: sent.file,
                targets: sent.targets,
                poses,
                follow,
                certify,
            })
        })
        .await
    }

    /// Answers a question about the mechanism in the body.
    async fn of_mechanisms(
        &self,
        mut calls: Calls,
        body: Body,
        asked: impl FnOnce(&dyn Mechanisms, Sent) -> Result<Value, String> + Send + 'static,
    ) -> Result<Response<Body>, Fault> {
        may_change(&mut calls).await?;
        let Some(mechanisms) = self.mechanisms.clone() else {
            return Err(Fault::not_found());
        };
        let file_turn = self.file_turn().await?;
        let bytes = gather(body, mechanisms::MOST_BYTES).await?;
        drop(file_turn);
        let sent: Sent = serde_json::from_slice(&bytes)
            .map_err(|error| Fault::of_request(format!("the body is not as expected: {error}")))?;
        let solving = Arc::clone(&self.solving);
        let turn = timeout(TURN, solving.acquire_owned()).await;
        let turn = turn.ok().and_then(Result::ok).ok_or_else(|| Fault {
            status: StatusCode::SERVICE_UNAVAILABLE,
            message: "another mechanism is being solved: try again".to_owned(),
        })?;
        let sign = Interruption::default();
        // Dropped with this call: when the page closes, or is told to cancel.
        let _waits = sign.when_dropped();
        let solved = tokio::task::spawn_blocking(move || {
            let answer = sign.run(|| asked(mechanisms.as_ref(), sent));
            drop(turn);
            answer
        });
        match solved.await {
            Ok(Ok(value)) => Ok(json_value(&value)),
            Ok(Err(message)) => Err(Fault::of_request(message)),
            Err(error) => Err(Fault {
                status: StatusCode::INTERNAL_SERVER_ERROR,
                message: format!("solving ended: {error}"),
            }),
        }
    }

    /// The solutions as a picture has them; made once for those who look at the same job.
    async fn picture(&self, mut calls: Calls, job: &str) -> Result<Response<Body>, Fault> {
        // Asked first, so that nobody sees what is kept for another.
        summary(&mut calls, job).await?;
        if let Some(kept) = self.pictures.get(&job.to_owned()) {
            return Ok(answer(StatusCode::OK, JSON, full((*kept).clone())));
        }
        let mut sample = Sample::default();
        let mut stream = solutions(&mut calls, job, 0).await?;
        while let Some(solution) = stream.message().await? {
            sample.take(solution);
        }
        let text = Bytes::from(sample.json().to_string());
        self.pictures.keep(job.to_owned(), Arc::new(text.clone()));
        Ok(answer(StatusCode::OK, JSON, full(text)))
    }

    async fn events(&self, query: &Query, calls: Calls) -> Result<Response<Body>, Fault> {
        let listeners = Arc::clone(&self.listeners);
        let place = listeners.try_acquire_owned().map_err(|_| Fault {
            status: StatusCode::SERVICE_UNAVAILABLE,
            message: "as many pages are open as there may be: close one".to_owned(),
        })?;
        let stream = match query.get("job") {
            Some(job) => self.stream(place, events::of_job(calls, job).await?),
            None => {
                let (from, limit) = rows(query)?;
                self.stream(place, events::of_lists(calls, from, limit))
            }
        };
        Ok(answer(StatusCode::OK, "text/event-stream", stream))
    }

    /// A body that ends with the service, and holds its place until then.
    fn stream(
        &self,
        place: OwnedSemaphorePermit,
        pieces: impl Stream<Item = events::Piece> + Send + 'static,
    ) -> Body {
        let stopping = self.stopping.clone();
        let pieces = pieces
            .take_until(stopping.cancelled_owned())
            .map(move |piece| {
                let _held = &place;
                piece
            });
        Body::new(StreamBody::new(pieces))
    }
}

/// A mechanism's file and its targets, as the page sends them.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Sent {
    file: String,
    #[serde(default)]
    targets: String,
}

fn refused(refusal: &Refusal) -> Fault {
    Fault {
        status: refusal.status(),
        message: refusal.to_string(),
    }
}

/// The page itself. Its scripts and styles run by a number that is in no other answer.
fn html() -> Response<Body> {
    let nonce = uuid::Uuid::new_v4().simple().to_string();
    let scripts = HTML.replace("{{scene}}", SCENE);
    let scripts = scripts.replace("{{mechanism}}", MECHANISM);
    let page = scripts.replace(NONCE, &nonce);
    let mut response = answer(StatusCode::OK, HTML_TYPE, full(page));
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'; \
         img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        response
            .headers_mut()
            .insert(CONTENT_SECURITY_POLICY, policy);
    }
    response
}

fn with_cookie(token: Option<&str>) -> Response<Body> {
    let mut response = json_value(&json!({ "token": token.is_some() }));
    if let Ok(value) = HeaderValue::from_str(&access::cookie(token)) {
        response.headers_mut().insert(SET_COOKIE, value);
    }
    response
}

/// Reads a whole body of at most `most` bytes.
async fn gather(body: Body, most: usize) -> Result<Bytes, Fault> {
    let too_large = || Fault {
        status: StatusCode::PAYLOAD_TOO_LARGE,
        message: format!("more than {most} bytes are not taken here"),
    };
    // A body that is announced as too large is refused before it arrives.
    if http_body::Body::size_hint(&body).lower() > most as u64 {
        return Err(too_large());
    }
    let collected = tokio::time::timeout(PATIENCE, Limited::new(body, most).collect()).await;
    match collected {
        Ok(Ok(body)) => Ok(body.to_bytes()),
        Ok(Err(error)) if error.is::<LengthLimitError>() => Err(too_large()),
        Ok(Err(error)) => Err(Fault::of_request(format!(
            "the body did not arrive: {error}"
        ))),
        Err(_) => Err(Fault {
            status: StatusCode::REQUEST_TIMEOUT,
            message: "the body did not arrive in time".to_owned(),
        }),
    }
}

/// Refuses callers that are unknown or may only read; called before a body is read.
async fn may_change(calls: &mut Calls) -> Result<(), Fault> {
    let caller = calls.get_server_info(v1::GetServerInfoRequest {}).await?;
    match caller.into_inner().reads_only {
        true => Err(Status::permission_denied("who may only look may change nothing").into()),
        false => Ok(()),
    }
}

/// First row and number of rows of a page of a list.
fn rows(query: &Query) -> Result<(u32, u32), Fault> {
    let limit = query.number("limit")?.unwrap_or(ROWS);
    if limit == 0 || limit > MOST_ROWS {
        return Err(Fault::of_request(format!(
            "limit is {limit}; expected 1 to {MOST_ROWS}"
        )));
    }
    Ok((query.number("from")?.unwrap_or(0), limit))
}

/// Options that the page offers; the other options are for the command line.
fn submission_options(query: Query) -> Result<(String, Options), Fault> {
    let query = query.only(&["name", "start", "seed", "certify", "decompose", "request"])?;
    let start = match query.get("start") {
        None => StartKind::Auto,
        Some(name) => {
            let mut start_kinds = StartKind::ALL.into_iter();
            start_kinds
                .find(|start| start.name() == name)
                .ok_or_else(|| {
                    let expected = any_of(&StartKind::ALL);
                    Fault::of_request(format!("start is `{name}`; expected {expected}"))
                })?
        }
    };
    let mut options = Options {
        start,
        seed: query.number("seed")?,
        name: query
            .get("name")
            .unwrap_or("page")
            .chars()
            .take(60)
            .collect(),
        decompose: query.flag("decompose")?.then(Decompose::default),
        ..Options::default()
    };
    options.closings.certify = query.flag("certify")?;
    let misfit = options.check();
    misfit.map_err(|misfit| Fault::of_request(misfit.to_string()))?;
    let request_id = match query.get("request") {
        Some(id) => id.to_owned(),
        None => uuid::Uuid::new_v4().to_string(),
    };
    Ok((request_id, options))
}

async fn cancel(job: &str, mut calls: Calls) -> Result<Response<Body>, Fault> {
    let job = job.to_owned();
    let request = v1::CancelRequest { job: job.clone() };
    let state = calls.cancel(request).await?.into_inner().state();
    Ok(json_value(
        &json!({ "job": job, "state": client_json::state_name(state) }),
    ))
}

async fn summary(calls: &mut Calls, job: &str) -> Result<String, Status> {
    let job = job.to_owned();
    let summary = calls.get_summary(v1::GetSummaryRequest { job }).await?;
    Ok(summary.into_inner().json)
}

/// The solutions from one of them on.
async fn solutions(
    calls: &mut Calls,
    job: &str,
    from: usize,
) -> Result<tonic::Streaming<v1::Solution>, Status> {
    let (job, skip) = (job.to_owned(), from as u64);
    let request = v1::StreamSolutionsRequest { job, skip };
    Ok(calls.stream_solutions(request).await?.into_inner())
}

/// Whether each solution says at which target it is, and the seed and the start of the paths.
async fn solved(calls: &mut Calls, job: &str) -> Result<cognate_summary::solve::Summary, Fault> {
    let text = summary(calls, job).await?;
    let read = AnySummary::read(&text).ok().and_then(AnySummary::solve);
    read.ok_or_else(|| Fault {
        status: StatusCode::CONFLICT,
        message: "this job has no isolated solutions: it asked for something else".to_owned(),
    })
}

/// A solution as a line of `solutions.jsonl`.
fn line(solution: &v1::Solution, several: bool) -> Result<String, Status> {
    let target = several.then_some(solution.target);
    let solution = from_proto::solution::solution(solution)
        .map_err(|error| Status::new(Code::Internal, error.to_string()))?;
    Ok(client_json::solution_line(&solution, target))
}

async fn some_solutions(
    calls: &mut Calls,
    job: &str,
    from: usize,
    limit: usize,
) -> Result<Response<Body>, Fault> {
    let several = !solved(calls, job).await?.targets.is_empty();
    let mut stream = solutions(calls, job, from).await?;
    let (mut lines, mut more) = (Vec::new(), false);
    while let Some(solution) = stream.message().await? {
        if lines.len() == limit {
            more = true;
            break;
        }
        lines.push(line(&solution, several)?);
    }
    // The lines are JSON as they are, with all their digits.
    let list = lines.join(",");
    Ok(json_text(format!(
        "{{\"from\":{from},\"more\":{more},\"solutions\":[{list}]}}"
    )))
}

async fn all_solutions(mut calls: Calls, job: &str) -> Result<Response<Body>, Fault> {
    let several = !solved(&mut calls, job).await?.targets.is_empty();
    let stream = solutions(&mut calls, job, 0).await?;
    // An error cuts the answer off, so that no browser takes a part for the whole.
    let lines = stream.map(move |solution| {
        let line = line(&solution?, several)?;
        Ok::<_, Status>(Frame::data(Bytes::from(line + "\n")))
    });
    let name = format!("{job}.solutions.jsonl");
    let body = Body::new(StreamBody::new(lines));
    Ok(download(&name, "application/x-ndjson", body))
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}

async fn failures(mut calls: Calls, job: &str) -> Result<Response<Body>, Fault> {
    let summary = solved(&mut calls, job).await?;
    let wanted = usize::try_from(summary.paths.failed).unwrap_or(usize::MAX);
    let wanted = wanted.min(FAILURES);
    let mut failures = Vec::new();
    if wanted > 0 {
        let request = v1::StreamPathsRequest {
            job: job.to_owned(),
        };
        let mut paths = calls.stream_paths(request).await?.into_inner();
        while failures.len() < wanted
            && let Some(path) = paths.message().await?
        {
            if path.class() == v1::PathClass::Failed {
                failures.push(failure(&path.result.unwrap_or_default(), &summary.problem));
            }
        }
    }
    Ok(json_value(&json!({
        "total": summary.paths.failed,
        "shown": failures.len(),
        "reasons": summary.failures,
        "failures": failures,
    })))
}

/// A failed path, and the command that follows it again.
fn failure(path: &v1::EndedPath, problem: &cognate_summary::solve::ProblemBlock) -> Value {
    let outcome = path.outcome().as_str_name();
    let outcome = outcome.trim_start_matches("PATH_OUTCOME_");
    let t = path.t.unwrap_or_default();
    let command = format!(
        "cognate path {} --start {} --seed {} --index {} --trace",
        quoted(&problem.name),
        problem.start,
        problem.seed,
        path.origin
    );
    json!({
        "path": path.origin,
        "outcome": outcome.to_lowercase().replace('_', " "),
        "t": [client_json::number(t.re), client_json::number(t.im)],
        "steps": path.counts.map(|counts| counts.steps),
        "condition": client_json::number(path.condition),
        "precision_bits": path.precision_bits,
        "command": command,
    })
}

async fn decomposition(mut calls: Calls, job: &str) -> Result<Response<Body>, Fault> {
    let request = v1::GetDecompositionRequest {
        job: job.to_owned(),
    };
    let pieces = calls.get_decomposition(request).await?.into_inner();
    let pieces = pieces.map(|piece| Ok::<_, Status>(Frame::data(piece?.data)));
    let name = format!("{job}.decomposition.json");
    Ok(download(&name, JSON, Body::new(StreamBody::new(pieces))))
}
