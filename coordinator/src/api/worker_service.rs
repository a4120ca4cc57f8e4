//! gRPC for workers: decode, one call inwards, encode.

use super::caller::Caller;
use super::error::ApiError;
use super::visible::visible;
use super::{Answers, Context, duration_ms, guarded, lease_id, pieces};
use crate::coordinator::{Coordinator, CoordinatorError, Pull, Report};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::{Credential, LeaseId, RequestId, Speaker, WorkerId};
use crate::ledger::rows::{Completion, GiveBack, Lease, Renewal, WorkerSeen};
use crate::results::store::StoreError;
use cognate_continuation::work::StageId;
use cognate_numeric::NUMERICS_REVISION;
use cognate_protocol::PROTOCOL_VERSION;
use cognate_protocol::error::{ProtocolError, within_limit};
use cognate_protocol::limits::{CHUNK_PATHS, CHUNKS_PER_CALL, NAME_BYTES};
use cognate_protocol::v1::worker_api_server::WorkerApi;
use cognate_protocol::{from_proto, to_proto, v1};
use futures::{StreamExt, TryStreamExt};
use std::sync::Arc;
use std::time::{Duration, SystemTime};
use tonic::{Request, Response, Status};

/// Reports of one call that are written at once: the ledger groups them into one commit.
const REPORTS_AT_ONCE: usize = 16;
/// Most chunks that one call gives out.
const SLOTS: u32 = 64;

/// The service for workers.
pub struct WorkerService {
    context: Arc<Context>,
}

impl WorkerService {
    /// In front of this coordinator.
    pub fn new(context: Arc<Context>) -> Self {
        Self { context }
    }
}

fn speaker(identity: Option<v1::WorkerIdentity>) -> Result<Speaker, ApiError> {
    let identity = identity.ok_or_else(|| ProtocolError::missing("identity"))?;
    Ok(Speaker {
        worker: WorkerId::new(identity.worker)?,
        session: identity.session,
    })
}

/// A question for chunks, or why this worker gets none.
fn pull(
    m: v1::PullRequest,
    credential: Credential,
    longest: Duration,
) -> Result<(Pull, Option<String>), ApiError> {
    let Speaker { worker, session } = speaker(m.identity)?;
    let machine = m.machine.ok_or_else(|| ProtocolError::missing("machine"))?;
    for (field, text) in [
        ("machine.version", &machine.version),
        ("machine.instruction_set", &machine.instruction_set),
        ("machine.host", &machine.host),
        ("machine.transport", &machine.transport),
    ] {
        within_limit(field, text.len(), NAME_BYTES)?;
    }
    let refusal = refusal(&machine);
    let pull = Pull {
        request: RequestId::new(format!("{session}.{}", m.sequence))?,
        worker: WorkerSeen {
            worker,
            version: visible(&machine.version),
            numerics_revision: machine.numerics_revision,
            instruction_set: visible(&machine.instruction_set),
            threads: machine.threads.max(1),
            lane_width: machine.lane_width,
            host: visible(&machine.host),
            transport: visible(&machine.transport),
            draining: false,
            credential,
        },
        slots: match refusal {
            None => m.free_slots.min(SLOTS),
            Some(_) => 0,
        },
        wait: Duration::from_millis(m.wait_ms.into()).min(longest),
    };
    Ok((pull, refusal))
}

/// Why a worker cannot work here.
fn refusal(machine: &v1::Machine) -> Option<String> {
    let (protocol, numerics) = (machine.protocol_version, machine.numerics_revision);
    if protocol != PROTOCOL_VERSION {
        return Some(format!(
            "the worker speaks protocol version {protocol}, this coordinator {PROTOCOL_VERSION}"
        ));
    }
    (numerics != NUMERICS_REVISION).then(|| {
        format!(
            "the worker has numerics revision {numerics}, this coordinator {NUMERICS_REVISION}: \
             their results would differ"
        )
    })
}

fn lease(lease: Lease, now: LedgerTime) -> v1::Lease {
    let LeaseId { chunk, epoch } = lease.lease;
    v1::Lease {
        id: Some(v1::LeaseId {
            job: chunk.job.to_string(),
            stage: chunk.stage.0,
            chunk: chunk.first,
            epoch: epoch.0,
        }),
        problem: to_proto::digest(lease.problem),
        first: lease.items.first,
        count: lease.items.len(),
        duration_ms: duration_ms(now, lease.until),
        stage_digest: to_proto::digest(lease.definition),
        alone: lease.alone,
    }
}

fn leases(m: &[v1::LeaseId]) -> Result<Vec<LeaseId>, ApiError> {
    within_limit("leases", m.len(), CHUNKS_PER_CALL)?;
    m.iter().map(|id| lease_id("leases", Some(id))).collect()
}

/// Status of an object that a worker asked for by its digest. If there is no such object, the digest may be wrong.
fn of_named_object(error: CoordinatorError) -> Status {
    match error {
        CoordinatorError::Store(StoreError::Missing(_)) => Status::not_found(error.to_string()),
        error => ApiError::from(error).into(),
    }
}

async fn report(
    coordinator: &Coordinator,
    by: Speaker,
    m: &v1::ChunkReport,
) -> Result<Report, ApiError> {
    let lease = lease_id("lease", m.lease.as_ref())?;
    let work = coordinator.work_of(lease).await?;
    within_limit("results", m.results.len(), CHUNK_PATHS)?;
    let results = m.results.iter().enumerate().map(|(i, result)| {
        from_proto::path::item_result(result, work).map_err(|e| e.within(format!("results[{i}]")))
    });
    Ok(Report {
        by,
        lease,
        results: results.collect::<Result<_, _>>()?,
        cpu_micros: m.cpu_nanoseconds / 1000,
    })
}

/// The answer to one report; an error only where sending it again may help.
fn verdict(answer: Result<Completion, ApiError>) -> Result<v1::ReportVerdict, ApiError> {
    let report_verdict = |verdict: v1::Verdict, message: String| {
        Ok(v1::ReportVerdict {
            verdict: verdict.into(),
            message,
        })
    };
    match answer {
        // Whether others agree is not the worker's business.
        Ok(Completion::Accepted | Completion::Unconfirmed) => {
            report_verdict(v1::Verdict::Accepted, String::new())
        }
        // That another worker was first is not the worker's business either.
        Ok(Completion::AlreadyAccepted | Completion::Overtaken) => {
            report_verdict(v1::Verdict::AlreadyAccepted, String::new())
        }
        Ok(Completion::Stale) => report_verdict(v1::Verdict::Stale, String::new()),
        Ok(Completion::HashDiffers) => report_verdict(v1::Verdict::HashDiffers, String::new()),
        // A job or a stage that is not here has no use for results.
        Err(ApiError::Coordinator(
            CoordinatorError::UnknownStage { .. }
            | CoordinatorError::Ledger(LedgerError::UnknownJob(_)),
        )) => report_verdict(v1::Verdict::Stale, String::new()),
        Err(
            error @ (ApiError::Message(_)
            | ApiError::Identity(_)
            | ApiError::Coordinator(CoordinatorError::Report { .. })),
        ) => {
            tracing::warn!(%error, "a report is refused");
            report_verdict(v1::Verdict::Invalid, error.to_string())
        }
        Err(error) => Err(error),
    }
}

#[tonic::async_trait]
impl WorkerApi for WorkerService {
    async fn pull(
        &self,
        request: Request<v1::PullRequest>,
    ) -> Result<Response<v1::PullResponse>, Status> {
        let Context {
            rules, stopping, ..
        } = &*self.context;
        let credential = Caller::of(&request).credential;
        let (pull, refusal) = pull(request.into_inner(), credential, rules.long_poll)?;
        if let Some(refused) = refusal {
            let worker = pull.worker.worker.clone();
            tracing::warn!(%worker, refused, "a worker gets no work");
            self.context.refuse(worker, &refused);
            self.context
                .coordinator
                .pull(pull)
                .await
                .map_err(ApiError::from)?;
            return Ok(Response::new(v1::PullResponse {
                refused,
                ..v1::PullResponse::default()
            }));
        }
        let draining = || {
            Response::new(v1::PullResponse {
                draining: true,
                ..v1::PullResponse::default()
            })
        };
        if stopping.is_cancelled() {
            return Ok(draining());
        }
        let worker = pull.worker.worker.clone();
        let (context, question) = (self.context.clone(), pull);
        let pulled = guarded(async move { Ok(context.coordinator.pull(question).await?) });
        let leases = tokio::select! {
            leases = pulled => match leases {
                Err(ApiError::Coordinator(CoordinatorError::Ledger(
                    error @ (LedgerError::Evicted(_) | LedgerError::NameTaken(_)),
                ))) => {
                    let refused = error.to_string();
                    tracing::error!(%worker, refused, "a worker gets no work");
                    self.context.refuse(worker, &refused);
                    return Ok(Response::new(v1::PullResponse {
                        refused,
                        ..v1::PullResponse::default()
                    }));
                }
                other => other?,
            },
            // Whatever was leased in this moment, the same question gets it again.
            () = stopping.cancelled() => return Ok(draining()),
        };
        for lease in &leases {
            // How long the worker had waited for work says nothing about the job.
            let now = SystemTime::now();
            self.context.traces.leased(lease, &worker, now);
        }
        let now = self.context.now().await?;
        Ok(Response::new(v1::PullResponse {
            leases: leases.into_iter().map(|l| lease(l, now)).collect(),
            ..v1::PullResponse::default()
        }))
    }

    async fn renew(
        &self,
        request: Request<v1::RenewRequest>,
    ) -> Result<Response<v1::RenewResponse>, Status> {
        let m = request.into_inner();
        let by = speaker(m.identity)?;
        let leases = leases(&m.leases)?;
        let renewals = self.context.coordinator.renew(&leases, &by).await;
        let renewals = renewals.map_err(ApiError::from)?;
        let now = self.context.now().await?;
        let renewal = |renewal: Renewal| match renewal {
            Renewal::Until(until) => v1::Renewal {
                held: true,
                duration_ms: duration_ms(now, until),
            },
            Renewal::Lost => v1::Renewal::default(),
        };
        Ok(Response::new(v1::RenewResponse {
            renewals: renewals.into_iter().map(renewal).collect(),
        }))
    }

    async fn report(
        &self,
        request: Request<v1::ReportRequest>,
    ) -> Result<Response<v1::ReportResponse>, Status> {
        let m = request.into_inner();
        let (by, began) = (speaker(m.identity)?, SystemTime::now());
        within_limit("chunks", m.chunks.len(), CHUNKS_PER_CALL).map_err(ApiError::from)?;
        let wanted = self.context.traces.are_wanted();
        let reported: Vec<_> = m
            .chunks
            .iter()
            .filter(|_| wanted)
            .map(|chunk| chunk.lease.clone())
            .collect();
        let worker = by.worker.clone();
        let verdicts: Vec<v1::ReportVerdict> = futures::stream::iter(m.chunks)
            .map(|chunk| {
                let (coordinator, by) = (self.context.coordinator.clone(), by.clone());
                // An error in one chunk says nothing about the other chunks.
                guarded(async move {
                    let report = report(&coordinator, by, &chunk).await?;
                    Ok(coordinator.complete(report).await?)
                })
            })
            .buffered(REPORTS_AT_ONCE)
            .map(verdict)
            .try_collect()
            .await?;
        for (lease, verdict) in reported.iter().zip(&verdicts) {
            if let Ok(lease) = lease_id("lease", lease.as_ref()) {
                let said = verdict.verdict().as_str_name();
                self.context.traces.reported(lease, &worker, said, began);
            }
        }
        Ok(Response::new(v1::ReportResponse { verdicts }))
    }

    async fn give_back(
        &self,
        request: Request<v1::GiveBackRequest>,
    ) -> Result<Response<v1::GiveBackResponse>, Status> {
        let m = request.into_inner();
        let by = speaker(m.identity)?;
        let leases = leases(&m.leases)?;
        let message = visible(&m.message.chars().take(500).collect::<String>());
        let why = match v1::GiveBackReason::try_from(m.reason) {
            Ok(v1::GiveBackReason::Failed) => GiveBack::Failed { reason: message },
            // A reason that this version does not know accuses nobody.
            Ok(v1::GiveBackReason::Draining | v1::GiveBackReason::Unspecified) | Err(_) => {
                if !message.is_empty() {
                    self.context.coordinator.not_fetched(&leases, &by, &message);
                }
                GiveBack::Drained
            }
        };
        let coordinator = &self.context.coordinator;
        let done = coordinator.give_back(&leases, why, &by).await;
        done.map_err(ApiError::from)?;
        if m.leaving {
            tracing::info!(worker = %by.worker, "a worker leaves");
            let left = coordinator.worker_leaves(&by).await;
            left.map_err(ApiError::from)?;
        }
        Ok(Response::new(v1::GiveBackResponse {}))
    }

    async fn get_problem(
        &self,
        request: Request<v1::GetProblemRequest>,
    ) -> Result<Response<v1::System>, Status> {
        let digest = from_proto::digest("digest", &request.into_inner().digest);
        let digest = digest.map_err(ApiError::from)?;
        let system = self.context.coordinator.problem(digest).await;
        let system = system.map_err(of_named_object)?;
        Ok(Response::new(to_proto::problem::system(&system)))
    }

    async fn get_stage(
        &self,
        request: Request<v1::GetStageRequest>,
    ) -> Result<Response<v1::Stage>, Status> {
        let m = request.into_inner();
        let job = m.job.parse().map_err(ApiError::from)?;
        let stage = self.context.coordinator.stage(job, StageId(m.stage)).await;
        let stage = stage.map_err(ApiError::from)?;
        Ok(Response::new(to_proto::path::stage(&stage)))
    }

    type GetObjectStream = Answers<v1::ObjectPiece>;

    async fn get_object(
        &self,
        request: Request<v1::GetObjectRequest>,
    ) -> Result<Response<Self::GetObjectStream>, Status> {
        let digest = from_proto::digest("digest", &request.into_inner().digest);
        let digest = digest.map_err(ApiError::from)?;
        let bytes = self.context.coordinator.object(digest).await;
        Ok(Response::new(pieces(bytes.map_err(of_named_object)?)))
    }

    async fn get_shared_memory(
        &self,
        _: Request<v1::GetSharedMemoryRequest>,
    ) -> Result<Response<v1::SharedMemory>, Status> {
        let named = self.context.shared_memory.get().cloned();
        Ok(Response::new(named.unwrap_or_default()))
    }
}
