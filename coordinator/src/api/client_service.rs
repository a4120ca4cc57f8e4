//! gRPC for clients: decode, one call inwards, encode.

use super::audit_log::Entry;
use super::caller::Caller;
use super::error::ApiError;
use super::visible::visible;
use super::{Answers, Context, guarded, json_pieces};
use crate::coordinator::submission_limits::SubmissionLimits;
use crate::coordinator::{Answered, ClassifiedPath, CoordinatorError};
use crate::intake;
use crate::jobs::planning::Planned;
use crate::jobs::progress::JobProgress;
use crate::ledger::LedgerError;
use crate::ledger::identity::{JobId, RequestId, Tenant};
use crate::ledger::rows::{JobRow, JobState, StageRow, WorkerRow};
use cognate_numeric::NUMERICS_REVISION;
use cognate_protocol::error::{ProtocolError, within_limit};
use cognate_protocol::limits::{self, OBJECT_BYTES};
use cognate_protocol::v1::client_api_server::ClientApi;
use cognate_protocol::{PROTOCOL_VERSION, from_proto, to_proto, v1};
use cognate_solutions::witness::Decomposition;
use cognate_summary::AnySummary;
use futures::future::ready;
use futures::{StreamExt, stream};
use prost::Message;
use std::sync::Arc;
use std::time::{Instant, SystemTime};
use tokio::sync::mpsc::Receiver;
use tokio::time::timeout;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Request, Response, Status, Streaming};

/// Tenant of jobs that are submitted without one.
const DEFAULT_TENANT: &str = "default";
/// Jobs in a list where no limit is given.
const JOBS_LISTED: u32 = 100;
/// Most jobs in a list.
const JOBS_LIMIT: u32 = 10_000;
/// Bytes above which a problem is read in the slow lane.
const LARGE_PROBLEM: usize = 1 << 20;
/// Most workers in a list.
const WORKERS_LIMIT: u32 = 10_000;

/// A decomposition with what it is of.
#[derive(serde::Serialize)]
struct WithSystem {
    #[serde(flatten)]
    found: Decomposition,
    /// The system, as JSON that is read as a problem.
    system: String,
    seed: u64,
}

/// The service for clients.
pub struct ClientService {
    context: Arc<Context>,
}

impl ClientService {
    /// In front of this coordinator.
    pub fn new(context: Arc<Context>) -> Self {
        Self { context }
    }
}

impl ClientService {
    /// Id of a job that the caller may see; a job of another tenant is reported as unknown.
    async fn job(&self, caller: &Caller, text: &str) -> Result<JobId, ApiError> {
        let job: JobId = text.parse()?;
        if caller.tenant.is_none() {
            return Ok(job);
        }
        let row = self.context.coordinator.ledger().job(job).await;
        match row.map_err(CoordinatorError::from)? {
            Some(row) if !caller.may_see(&row.asked.tenant) => {
                Err(CoordinatorError::Ledger(LedgerError::UnknownJob(job)).into())
            }
            _ => Ok(job),
        }
    }

    /// Tenant of a submission: the tenant that the request names, unless the token is bound to another tenant.
    fn tenant(caller: &Caller, asked: String) -> Result<Tenant, ApiError> {
        match &caller.tenant {
            None if asked.is_empty() => Ok(Tenant::new(DEFAULT_TENANT)?),
            None => Ok(Tenant::new(asked)?),
            Some(caller_tenant) if asked.is_empty() || asked == caller_tenant.as_str() => {
                Ok(caller_tenant.clone())
            }
            Some(caller_tenant) => Err(ApiError::OtherTenant {
                own: caller_tenant.to_string(),
                asked: visible(&asked),
            }),
        }
    }

    /// Writes down what a caller asked for and what became of it.
    fn record<T>(&self, caller: &Caller, call: &str, job: Option<&str>, done: &Result<T, Status>) {
        let refusal = done.as_ref().err();
        let job = job.map(visible);
        let entry = Entry {
            call,
            job: job.as_deref(),
            code: refusal.map_or(Code::Ok, Status::code),
            why: refusal.map(Status::message),
        };
        self.context.accounting.audit.record(caller, entry);
    }

    /// The request id as the ledger has it. A caller of one tenant has ids of its own, unless an earlier version took
    /// this one for a job of the tenant.
    async fn request_id(&self, caller: &Caller, asked: &RequestId) -> Result<RequestId, ApiError> {
        let Some(tenant) = &caller.tenant else {
            return Ok(asked.clone());
        };
        let ledger = self.context.coordinator.ledger();
        let before = ledger.job(JobId::of_request(asked)).await;
        let before = before.map_err(CoordinatorError::from)?;
        Ok(
            match before.is_some_and(|row| row.asked.tenant == *tenant) {
                true => asked.clone(),
                false => asked.within(tenant),
            },
        )
    }

    async fn make_job(
        &self,
        caller: &Caller,
        m: v1::SubmitRequest,
    ) -> Result<v1::SubmitResponse, Status> {
        let asked_id = RequestId::new(m.request_id).map_err(ApiError::from)?;
        let tenant = Self::tenant(caller, m.tenant)?;
        let id = self.request_id(caller, &asked_id).await?;
        let problem = m
            .problem
            .ok_or_else(|| ApiError::from(ProtocolError::missing("problem")))?;
        let bytes = problem.encoded_len();
        let quota = &self.context.accounting.quota;
        quota.bytes(caller, bytes as u64, Instant::now())?;
        let is_large = bytes > LARGE_PROBLEM;
        let submission = from_proto::problem::submission(problem)
            .map_err(|e| ApiError::from(e.within("problem")))?;
        let coordinator = self.context.coordinator.clone();
        let limits = SubmissionLimits {
            jobs: caller.limits.jobs,
            paths: caller.limits.paths,
        };
        let accepted = guarded(async move {
            // Reading a large file takes long; it must hold up neither the runtime nor small ones.
            let reading = coordinator.planning();
            let problem = reading.read(is_large, || intake::take(submission)).await;
            let problem = problem.map_err(CoordinatorError::from)??;
            let submitted = coordinator.submit_within(id, tenant, problem, limits);
            Ok(submitted.await?)
        });
        let accepted = accepted.await.map_err(|error| match error {
            // By the name that the caller gave it.
            ApiError::Coordinator(CoordinatorError::Ledger(LedgerError::RequestReused(_))) => {
                CoordinatorError::from(LedgerError::RequestReused(asked_id)).into()
            }
            other => other,
        })?;
        Ok(v1::SubmitResponse {
            job: accepted.job.to_string(),
            warnings: accepted.warnings,
        })
    }

    async fn delete_job(
        &self,
        caller: &Caller,
        m: &v1::DeleteRequest,
    ) -> Result<v1::DeleteResponse, Status> {
        let job = self.job(caller, &m.job).await?;
        let coordinator = self.context.coordinator.clone();
        let cancel_first = m.cancel_first;
        // Once begun it is done, also where the client leaves.
        let removed = guarded(async move { Ok(coordinator.delete(job, cancel_first).await?) });
        let removed = removed.await?;
        let grace_ms = self.context.coordinator.policy().retention.grace_ms;
        Ok(v1::DeleteResponse {
            stages: removed.stages,
            chunks: removed.chunks,
            objects: removed.results.objects,
            bytes: removed.results.bytes,
            deleted_before: removed.before,
            grace_seconds: grace_ms as f64 / 1000.0,
        })
    }

    /// Keeps an object that comes in pieces. Its digest is told when all of it is in the store.
    async fn keep_upload(
        &self,
        caller: &Caller,
        pieces: Streaming<v1::ObjectPiece>,
    ) -> Result<v1::UploadResponse, Status> {
        let _place = self.context.uploads.place(caller).await?;
        let longest = self.context.uploads.limits().longest;
        let uploaded = timeout(longest, self.take_pieces(caller, pieces)).await;
        uploaded.unwrap_or_else(|_| {
            Err(Status::deadline_exceeded(format!(
                "an upload lasts {} s at most",
                longest.as_secs()
            )))
        })
    }

    async fn take_pieces(
        &self,
        caller: &Caller,
        mut pieces: Streaming<v1::ObjectPiece>,
    ) -> Result<v1::UploadResponse, Status> {
        let quota = &self.context.accounting.quota;
        let patience = self.context.uploads.limits().patience;
        let upload = self.context.coordinator.begin_upload().await;
        let mut upload = upload.map_err(ApiError::from)?;
        let mut size = 0;
        loop {
            let piece = timeout(patience, pieces.message()).await;
            let piece = piece.map_err(|_| Status::deadline_exceeded("no piece came in time"))??;
            let Some(piece) = piece else {
                break;
            };
            size += piece.data.len();
            within_limit("data", size, OBJECT_BYTES).map_err(ApiError::from)?;
            quota.bytes(caller, piece.data.len() as u64, Instant::now())?;
            let taken = upload.take(&piece.data).await;
            taken
                .map_err(CoordinatorError::from)
                .map_err(ApiError::from)?;
        }
        let digest = upload.finish().await;
        let digest = digest
            .map_err(CoordinatorError::from)
            .map_err(ApiError::from)?;
        Ok(v1::UploadResponse {
            digest: to_proto::digest(digest),
            size: size as u64,
        })
    }

    /// Warnings of the planner about a job, which must exist.
    async fn warnings(&self, job: JobId) -> Result<Vec<String>, ApiError> {
        let row = self.context.coordinator.ledger().job(job).await;
        let row = row.map_err(CoordinatorError::from)?;
        let row = row.ok_or(CoordinatorError::Ledger(LedgerError::UnknownJob(job)))?;
        let planned = Planned::from_bytes(&row.asked.options).map_err(CoordinatorError::from)?;
        Ok(planned.warnings)
    }
}

fn state(state: JobState) -> v1::JobState {
    match state {
        JobState::Queued => v1::JobState::Queued,
        JobState::Running => v1::JobState::Running,
        JobState::Solved => v1::JobState::Solved,
        JobState::Failed => v1::JobState::Failed,
        JobState::Cancelled => v1::JobState::Cancelled,
    }
}

fn progress(progress: JobProgress, warnings: Vec<String>) -> v1::JobProgress {
    let count = |name: &str, count| v1::NamedCount {
        name: name.to_owned(),
        count,
    };
    let outcomes = progress.outcomes;
    v1::JobProgress {
        job: progress.job.to_string(),
        state: state(progress.state).into(),
        stages: progress
            .stages
            .into_iter()
            .map(|stage| v1::StageProgress {
                stage: stage.stage.0,
                total: stage.total,
                ready: stage.ready,
                leased: stage.leased,
                accepted: stage.accepted,
                failed: stage.failed,
                purpose: stage.purpose,
                mixed_cells: stage.mixed_cells,
            })
            .collect(),
        outcomes: vec![
            count("regular", outcomes.regular),
            count("singular", outcomes.singular),
            count("failed", outcomes.failed),
        ],
        warnings,
        message: progress.message,
        elapsed_seconds: progress.elapsed_ms as f64 / 1000.0,
    }
}

fn overview((row, stages): (JobRow, Vec<StageRow>)) -> v1::JobOverview {
    v1::JobOverview {
        job: row.job.to_string(),
        // Names that an earlier version took were kept as they came.
        name: visible(&row.asked.label),
        tenant: row.asked.tenant.to_string(),
        state: state(row.state).into(),
        submitted_unix_ms: row.submitted.0,
        items_total: stages.iter().map(|stage| stage.items).sum(),
        items_accepted: stages
            .iter()
            .map(|stage| stage.accepted.items + stage.failed.items)
            .sum(),
    }
}

fn classified(path: &ClassifiedPath) -> v1::ClassifiedPath {
    v1::ClassifiedPath {
        result: Some(to_proto::path::ended_path(&path.result)),
        class: to_proto::solution::class(path.verdict).into(),
        solution: path.solution,
    }
}

/// An answer of whatever kind, counted.
fn counted(summary: &AnySummary) -> v1::summary::Answer {
    use v1::summary::Answer;
    match summary {
        AnySummary::Solve(summary) => {
            let counts = to_proto::solution::counts(&summary.paths, &summary.solutions);
            Answer::Isolated(counts)
        }
        AnySummary::Decomposition(summary) => Answer::Decomposition(v1::DecompositionCounts {
            components: (summary.decomposition.components.iter())
                .map(|block| block.count)
                .sum(),
            settled: summary.settled,
        }),
        AnySummary::Question(summary) => Answer::Question(v1::QuestionCounts {
            question: summary.question.clone(),
            settled: summary.settled,
        }),
    }
}

fn worker(row: WorkerRow, refused: Option<String>, idle_seconds: f64) -> v1::WorkerOverview {
    // Evictions are in the ledger, whichever coordinator decided them.
    let evicted = row
        .evicted
        .then(|| LedgerError::Evicted(row.says.worker.clone()).to_string());
    v1::WorkerOverview {
        worker: row.says.worker.to_string(),
        host: row.says.host,
        version: row.says.version,
        numerics_revision: row.says.numerics_revision,
        instruction_set: row.says.instruction_set,
        lane_width: row.says.lane_width,
        threads: row.says.threads,
        transport: row.says.transport,
        idle_seconds,
        leased_chunks: u32::try_from(row.leased_chunks).unwrap_or(u32::MAX),
        accepted_chunks: row.chunks_done,
        accepted_paths: row.items_done,
        refused: evicted.or(refused).unwrap_or_default(),
    }
}

/// One message at a time of what comes a chunk at a time.
fn flattened<T: Send + 'static>(
    answers: Receiver<Result<Vec<Answered>, CoordinatorError>>,
    mut message: impl FnMut(Answered) -> Option<Result<T, Status>> + Send + 'static,
) -> Answers<T> {
    let messages = ReceiverStream::new(answers).flat_map(move |some| match some {
        Ok(some) => {
            let messages: Vec<_> = some.into_iter().filter_map(&mut message).collect();
            stream::iter(messages).left_stream()
        }
        Err(error) => {
            let status = Status::from(ApiError::from(error));
            stream::once(ready(Err(status))).right_stream()
        }
    });
    Box::pin(messages)
}

#[tonic::async_trait]
impl ClientApi for ClientService {
    async fn submit(
        &self,
        request: Request<v1::SubmitRequest>,
    ) -> Result<Response<v1::SubmitResponse>, Status> {
        let (caller, began) = (Caller::of(&request), SystemTime::now());
        let made = self.make_job(&caller, request.into_inner()).await;
        let job = made.as_ref().ok().map(|made| made.job.as_str());
        if let Some(job) = job.and_then(|job| job.parse().ok()) {
            self.context.traces.submitted(job, began);
        }
        self.record(&caller, "Submit", job, &made);
        made.map(Response::new)
    }

    type WatchStream = Answers<v1::JobProgress>;

    async fn watch(
        &self,
        request: Request<v1::WatchRequest>,
    ) -> Result<Response<Self::WatchStream>, Status> {
        let caller = Caller::of(&request);
        let job = self.job(&caller, &request.into_inner().job).await?;
        // A job that is not there is an error of the call, not of the stream.
        let warnings = self.warnings(job).await?;
        let changes = self.context.coordinator.watch(job);
        let answers = ReceiverStream::new(changes).map(move |change| {
            let change = change.map_err(ApiError::from)?;
            Ok(progress(change, warnings.clone()))
        });
        let stopping = self.context.stopping.clone();
        Ok(Response::new(Box::pin(StreamExt::take_until(
            answers,
            stopping.cancelled_owned(),
        ))))
    }

    async fn get_summary(
        &self,
        request: Request<v1::GetSummaryRequest>,
    ) -> Result<Response<v1::Summary>, Status> {
        let caller = Caller::of(&request);
        let job = self.job(&caller, &request.into_inner().job).await?;
        let summary = self.context.coordinator.summary(job).await;
        let (summary, json) = summary.map_err(ApiError::from)?;
        let answer = counted(&summary);
        let counts = match &answer {
            v1::summary::Answer::Isolated(counts) => Some(*counts),
            _ => None,
        };
        Ok(Response::new(v1::Summary {
            json,
            counts,
            answer: Some(answer),
        }))
    }

    type GetDecompositionStream = Answers<v1::ObjectPiece>;

    async fn get_decomposition(
        &self,
        request: Request<v1::GetDecompositionRequest>,
    ) -> Result<Response<Self::GetDecompositionStream>, Status> {
        let caller = Caller::of(&request);
        let job = self.job(&caller, &request.into_inner().job).await?;
        let turn = self.context.streams.turn().await?;
        let coordinator = &self.context.coordinator;
        let decomposition = coordinator.decomposition(job).await;
        let decomposition = decomposition.map_err(ApiError::from)?;
        let (system, seed) = coordinator.decomposed(job).await.map_err(ApiError::from)?;
        let object = WithSystem {
            found: decomposition,
            system,
            seed,
        };
        Ok(Response::new(turn.hold(json_pieces(object))))
    }

    type StreamSolutionsStream = Answers<v1::Solution>;

    async fn stream_solutions(
        &self,
        request: Request<v1::StreamSolutionsRequest>,
    ) -> Result<Response<Self::StreamSolutionsStream>, Status> {
        let caller = Caller::of(&request);
        let request = request.into_inner();
        let job = self.job(&caller, &request.job).await?;
        let skip = usize::try_from(request.skip).unwrap_or(usize::MAX);
        let turn = self.context.streams.turn().await?;
        let large = self.context.coordinator.answers(job).await;
        if let Some(answers) = large.map_err(ApiError::from)? {
            let mut left_out = 0;
            let message = move |answered: Answered| {
                let (target, solution) = answered.solution?;
                if left_out < skip {
                    left_out += 1;
                    return None;
                }
                Some(Ok(to_proto::solution::solution(&solution, target)))
            };
            return Ok(Response::new(turn.hold(flattened(answers, message))));
        }
        let sets = self.context.coordinator.solutions(job).await;
        let sets = sets.map_err(ApiError::from)?;
        // One at a time: a message takes more memory than what it is made of.
        let solutions = stream::unfold(
            (sets, 0, skip),
            |(sets, mut target, mut index)| async move {
                // An index beyond the end of a set belongs to the sets after it.
                while index >= sets.get(target)?.points().count() {
                    index -= sets[target].points().count();
                    target += 1;
                }
                let number = u32::try_from(target).unwrap_or(u32::MAX);
                let point = sets[target].points().nth(index)?;
                let message = to_proto::solution::solution(point, number);
                Some((Ok(message), (sets, target, index + 1)))
            },
        );
        Ok(Response::new(turn.hold(Box::pin(solutions))))
    }

    type StreamPathsStream = Answers<v1::ClassifiedPath>;

    async fn stream_paths(
        &self,
        request: Request<v1::StreamPathsRequest>,
    ) -> Result<Response<Self::StreamPathsStream>, Status> {
        let caller = Caller::of(&request);
        let job = self.job(&caller, &request.into_inner().job).await?;
        let turn = self.context.streams.turn().await?;
        let large = self.context.coordinator.answers(job).await;
        if let Some(answers) = large.map_err(ApiError::from)? {
            let message = |answered: Answered| Some(Ok(classified(&answered.path)));
            return Ok(Response::new(turn.hold(flattened(answers, message))));
        }
        let coordinator = self.context.coordinator.clone();
        let paths = guarded(async move { Ok(coordinator.paths(job).await?) }).await?;
        let paths = paths.into_iter().map(|path| Ok(classified(&path)));
        Ok(Response::new(turn.hold(Box::pin(stream::iter(paths)))))
    }

    async fn explain(
        &self,
        request: Request<v1::ExplainRequest>,
    ) -> Result<Response<v1::ExplainResponse>, Status> {
        let caller = Caller::of(&request);
        let job = self.job(&caller, &request.into_inner().job).await?;
        let explanation = self.context.coordinator.explain(job).await;
        let explanation = explanation.map_err(ApiError::from)?;
        Ok(Response::new(v1::ExplainResponse {
            text: explanation.text,
            json: explanation.json,
        }))
    }

    async fn cancel(
        &self,
        request: Request<v1::CancelRequest>,
    ) -> Result<Response<v1::CancelResponse>, Status> {
        let caller = Caller::of(&request);
        let asked = request.into_inner().job;
        let cancelled = async {
            let job = self.job(&caller, &asked).await?;
            let cancellation = self
                .context
                .coordinator
                .cancel(job, "cancelled by a client");
            cancellation.await.map_err(ApiError::from)
        };
        let cancelled = cancelled.await.map_err(Status::from);
        self.record(&caller, "Cancel", Some(&asked), &cancelled);
        Ok(Response::new(v1::CancelResponse {
            state: state(cancelled?).into(),
        }))
    }

    async fn delete(
        &self,
        request: Request<v1::DeleteRequest>,
    ) -> Result<Response<v1::DeleteResponse>, Status> {
        let caller = Caller::of(&request);
        let m = request.into_inner();
        let deleted = self.delete_job(&caller, &m).await;
        self.record(&caller, "Delete", Some(&m.job), &deleted);
        deleted.map(Response::new)
    }

    async fn list_jobs(
        &self,
        request: Request<v1::ListJobsRequest>,
    ) -> Result<Response<v1::ListJobsResponse>, Status> {
        let tenant = Caller::of(&request).tenant;
        let v1::ListJobsRequest { limit, skip } = request.into_inner();
        let limit = match limit {
            0 => JOBS_LISTED,
            limit => limit.min(JOBS_LIMIT),
        };
        let jobs = self.context.coordinator.jobs(skip, limit, tenant.as_ref());
        let jobs = jobs.await;
        let jobs = jobs.map_err(ApiError::from)?;
        Ok(Response::new(v1::ListJobsResponse {
            jobs: jobs.into_iter().map(overview).collect(),
        }))
    }

    async fn list_workers(
        &self,
        _: Request<v1::ListWorkersRequest>,
    ) -> Result<Response<v1::ListWorkersResponse>, Status> {
        let rows = self.context.coordinator.workers(WORKERS_LIMIT).await;
        let rows = rows.map_err(ApiError::from)?;
        let now = self.context.now().await?;
        let memory = self.context.rules.worker_memory.as_secs_f64();
        let workers = rows.into_iter().filter_map(|row| {
            let idle = now.since_ms(row.last_seen) as f64 / 1000.0;
            let here = idle < memory && (!row.says.draining || row.leased_chunks > 0);
            here.then(|| {
                let refused = self.context.refusal(&row.says.worker);
                let aside = || self.context.coordinator.put_aside(&row.says.worker);
                let refused = refused.or_else(aside);
                worker(row, refused, idle)
            })
        });
        Ok(Response::new(v1::ListWorkersResponse {
            workers: workers.collect(),
        }))
    }

    async fn upload(
        &self,
        request: Request<Streaming<v1::ObjectPiece>>,
    ) -> Result<Response<v1::UploadResponse>, Status> {
        let caller = Caller::of(&request);
        let kept = self.keep_upload(&caller, request.into_inner()).await;
        self.record(&caller, "Upload", None, &kept);
        kept.map(Response::new)
    }

    async fn get_server_info(
        &self,
        request: Request<v1::GetServerInfoRequest>,
    ) -> Result<Response<v1::ServerInfo>, Status> {
        let caller = Caller::of(&request);
        let limits = limits::ALL.iter().map(|limit| v1::NamedCount {
            name: limit.name.to_owned(),
            count: limit.value,
        });
        Ok(Response::new(v1::ServerInfo {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            protocol_version: PROTOCOL_VERSION,
            numerics_revision: NUMERICS_REVISION,
            limits: limits.collect(),
            reads_only: caller.reads_only,
        }))
    }
}
