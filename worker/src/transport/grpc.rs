//! gRPC over TCP, a Unix socket, shared memory or within a process: the calls of a worker as messages.
//!
//! Connections are made when they are needed and again when they broke; where
//! several coordinators are named, a call without an answer is made to the next.

use super::connect::UnusableAddress;
use super::route::Route;
use super::{
    Announcement, GiveBack, Lease, LeaseId, Pulled, Receipt, Renewal, Transport, TransportError,
};
use crate::chunk_runner::TrackedChunk;
use crate::config::Config;
use async_trait::async_trait;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::{Stage, StageId};
use cognate_numeric::NUMERICS_REVISION;
use cognate_protocol::error::ProtocolError;
use cognate_protocol::limits::OBJECT_BYTES;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use cognate_protocol::{PROTOCOL_VERSION, digest, from_proto, to_proto, v1};
use cognate_systems::system::System;
use std::future::Future;
use std::time::Duration;
use tokio::sync::watch;
use tonic::{Code, Status};

type Client = WorkerApiClient<Route>;

/// A call that should be answered at once is given up after this.
const ANSWER: Duration = Duration::from_secs(20);
/// A renewal or a question for work that one of several coordinators does not answer is made to the next after
/// this, long before a lease ends: one that stands still takes the call and says nothing.
const ANSWER_OF_SEVERAL: Duration = Duration::from_secs(2);
/// A report may be large and is durable before it is answered.
const REPORT_ANSWER: Duration = Duration::from_secs(120);

/// Calls by gRPC.
pub struct Grpc {
    clients: Vec<Client>,
    routes: Vec<Route>,
    /// Index of the client that answered last; calls that wait for another client are woken by a change.
    current: watch::Sender<usize>,
    identity: v1::WorkerIdentity,
    machine: v1::Machine,
}

impl Grpc {
    /// Prepares the connections; none is made yet. Must be called within a tokio runtime.
    pub fn new(config: &Config, announcement: &Announcement) -> Result<Self, UnusableAddress> {
        let routes: Result<Vec<_>, _> = config
            .coordinators
            .iter()
            .map(|address| {
                let channel = config.credentials.channel(address)?;
                let bearer = config.credentials.bearer();
                Ok(Route::new(
                    channel,
                    bearer,
                    address.clone(),
                    config.transport,
                ))
            })
            .collect();
        Ok(Self::over(routes?, config.message_bytes, announcement))
    }

    /// Client of the coordinators at these routes, at least one; messages have at most `bytes` bytes.
    pub fn over(routes: Vec<Route>, bytes: usize, announcement: &Announcement) -> Self {
        let client = |route: &Route| {
            Client::new(route.clone())
                .max_decoding_message_size(bytes)
                .max_encoding_message_size(bytes)
        };
        let clients: Vec<_> = routes.iter().map(client).collect();
        assert!(!clients.is_empty(), "a configuration names a coordinator");
        let machine = &announcement.machine;
        Self {
            clients,
            routes,
            current: watch::Sender::new(0),
            identity: v1::WorkerIdentity {
                worker: announcement.worker.clone(),
                session: announcement.session.clone(),
            },
            machine: v1::Machine {
                version: env!("CARGO_PKG_VERSION").to_owned(),
                protocol_version: PROTOCOL_VERSION,
                numerics_revision: NUMERICS_REVISION,
                instruction_set: machine.instruction_set.name().to_owned(),
                lane_width: u32::try_from(announcement.lane_width).unwrap_or(u32::MAX),
                threads: u32::try_from(announcement.threads).unwrap_or(u32::MAX),
                host: machine.host.clone(),
                transport: String::new(),
            },
        }
    }

    fn identity(&self) -> Option<v1::WorkerIdentity> {
        Some(self.identity.clone())
    }

    /// How long a call may take that should be answered at once.
    fn patience(&self) -> Duration {
        match self.clients.len() {
            1 => ANSWER,
            _ => ANSWER_OF_SEVERAL,
        }
    }

    /// Ends once calls go to another coordinator than to this one.
    async fn moved_on(&self, from: usize) {
        let mut current = self.current.subscribe();
        // An error means that the transport is gone, and all calls that wait with it.
        let _ = current.wait_for(|&client_index| client_index != from).await;
    }

    /// Makes a call to the coordinator that answered last; after a failure the next one is asked, and
    /// calls that still wait are made there, too.
    async fn call<T, F>(
        &self,
        patience: Duration,
        call: impl FnOnce(Client) -> F + Send,
    ) -> Result<T, TransportError>
    where
        F: Future<Output = Result<T, Status>> + Send,
    {
        let current = *self.current.borrow();
        let client = self.clients[current % self.clients.len()].clone();
        let answered = tokio::select! {
            answered = tokio::time::timeout(patience, call(client)) => answered,
            () = self.moved_on(current) => {
                let why = "another call had no answer from this coordinator";
                return Err(TransportError::Unavailable(why.to_owned()));
            }
        };
        let error = match answered {
            Ok(Ok(answer)) => return Ok(answer),
            Ok(Err(status)) => explain(&status),
            Err(_) => {
                TransportError::Unavailable(format!("no answer within {} s", patience.as_secs()))
            }
        };
        if matches!(error, TransportError::Unavailable(_)) && self.clients.len() > 1 {
            // Of several calls that fail at once, one moves on.
            self.current.send_if_modified(|client_index| {
                let moves = *client_index == current;
                *client_index = if moves {
                    current.wrapping_add(1)
                } else {
                    *client_index
                };
                moves
            });
        }
        Err(error)
    }
}

/// Sorts the errors of calls: some are worth another attempt.
fn explain(status: &Status) -> TransportError {
    let mut text = status.message().to_owned();
    let mut source = std::error::Error::source(status);
    while let Some(cause) = source {
        // The innermost cause is what a person can act on ("connection refused").
        text = cause.to_string();
        source = cause.source();
    }
    if text.is_empty() {
        text = status.code().description().to_owned();
    }
    match status.code() {
        Code::InvalidArgument
        | Code::NotFound
        | Code::AlreadyExists
        | Code::PermissionDenied
        | Code::Unauthenticated
        | Code::FailedPrecondition
        | Code::OutOfRange
        | Code::Unimplemented
        | Code::DataLoss => TransportError::Refused(text),
        Code::Ok
        | Code::Cancelled
        | Code::Unknown
        | Code::DeadlineExceeded
        | Code::ResourceExhausted
        | Code::Aborted
        | Code::Internal
        | Code::Unavailable => TransportError::Unavailable(text),
    }
}

impl From<ProtocolError> for TransportError {
    fn from(error: ProtocolError) -> Self {
        Self::Malformed(error.to_string())
    }
}

fn lease_id_to_proto(lease: &LeaseId) -> v1::LeaseId {
    v1::LeaseId {
        job: lease.job.clone(),
        stage: lease.stage.0,
        chunk: lease.chunk,
        epoch: lease.epoch,
    }
}

fn lease_from_proto(lease: v1::Lease) -> Result<Lease, ProtocolError> {
    let id = lease.id.ok_or_else(|| ProtocolError::missing("id"))?;
    let end = lease
        .first
        .checked_add(lease.count)
        .ok_or_else(|| ProtocolError::invalid("count", lease.count, "a range of 64-bit numbers"))?;
    Ok(Lease {
        id: LeaseId {
            job: id.job,
            stage: StageId(id.stage),
            chunk: id.chunk,
            epoch: id.epoch,
        },
        problem: from_proto::digest("problem", &lease.problem)?,
        stage: from_proto::digest("stage_digest", &lease.stage_digest)?,
        items: lease.first..end,
        lasts: Duration::from_millis(lease.duration_ms.into()),
        alone: lease.alone,
    })
}

fn receipt_from_proto(verdict: v1::ReportVerdict) -> Result<Receipt, TransportError> {
    match verdict.verdict() {
        v1::Verdict::Accepted => Ok(Receipt::Accepted),
        v1::Verdict::AlreadyAccepted => Ok(Receipt::AlreadyAccepted),
        v1::Verdict::Stale => Ok(Receipt::Stale),
        v1::Verdict::HashDiffers => Ok(Receipt::HashDiffers),
        v1::Verdict::Invalid => Ok(Receipt::Invalid(verdict.message)),
        v1::Verdict::Unspecified => Err(TransportError::Malformed("an unknown verdict".to_owned())),
    }
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

#[async_trait]
impl Transport for Grpc {
    async fn pull(
        &self,
        sequence: u64,
        free: usize,
        wait: Duration,
    ) -> Result<Pulled, TransportError> {
        // The heartbeat is also the time to look for a better way.
        let route = &self.routes[*self.current.borrow() % self.routes.len()];
        route.look_for_shared_memory().await;
        let mut machine = self.machine.clone();
        route.transport().clone_into(&mut machine.transport);
        let request = v1::PullRequest {
            identity: self.identity(),
            sequence,
            free_slots: u32::try_from(free).unwrap_or(u32::MAX),
            wait_ms: u32::try_from(wait.as_millis()).unwrap_or(u32::MAX),
            machine: Some(machine),
        };
        let call = |mut client: Client| async move { client.pull(request).await };
        let response = self.call(wait + self.patience(), call).await?.into_inner();
        let leases = response.leases.into_iter().enumerate();
        let leases = leases.map(|(number, lease)| {
            lease_from_proto(lease).map_err(|error| error.within(format!("leases[{number}]")))
        });
        Ok(Pulled {
            leases: leases.collect::<Result<_, _>>()?,
            refused: (!response.refused.is_empty()).then_some(response.refused),
            draining: response.draining,
        })
    }

    async fn renew(&self, leases: &[LeaseId]) -> Result<Vec<Renewal>, TransportError> {
        let request = v1::RenewRequest {
            identity: self.identity(),
            leases: leases.iter().map(lease_id_to_proto).collect(),
        };
        let call = |mut client: Client| async move { client.renew(request).await };
        let renewals = self
            .call(self.patience(), call)
            .await?
            .into_inner()
            .renewals;
        if renewals.len() != leases.len() {
            let (renewal_count, asked) = (renewals.len(), leases.len());
            let text = format!("{renewal_count} renewals for {asked} leases");
            return Err(TransportError::Malformed(text));
        }
        let renewals = renewals.into_iter().map(|renewal| {
            if renewal.held {
                Renewal::Held(Duration::from_millis(renewal.duration_ms.into()))
            } else {
                Renewal::Lost
            }
        });
        Ok(renewals.collect())
    }

    async fn report(
        &self,
        lease: &LeaseId,
        chunk: &TrackedChunk,
    ) -> Result<Receipt, TransportError> {
        let request = v1::ReportRequest {
            identity: self.identity(),
            chunks: vec![v1::ChunkReport {
                lease: Some(lease_id_to_proto(lease)),
                results: chunk
                    .results
                    .iter()
                    .map(to_proto::path::item_result)
                    .collect(),
                cpu_nanoseconds: nanoseconds(chunk.cpu),
                wall_nanoseconds: nanoseconds(chunk.wall),
            }],
        };
        let call = |mut client: Client| async move { client.report(request).await };
        let mut verdicts = self.call(REPORT_ANSWER, call).await?.into_inner().verdicts;
        match (verdicts.pop(), verdicts.pop()) {
            (Some(verdict), None) => receipt_from_proto(verdict),
            _ => {
                let text = "not one verdict for one report".to_owned();
                Err(TransportError::Malformed(text))
            }
        }
    }

    async fn give_back(&self, leases: &[LeaseId], why: &GiveBack) -> Result<(), TransportError> {
        let (reason, message) = match why {
            GiveBack::Draining => (v1::GiveBackReason::Draining, String::new()),
            // The reason accuses nobody; the message says what is the matter.
            GiveBack::Unfetched(message) => (v1::GiveBackReason::Draining, message.clone()),
            GiveBack::Failed(message) => (v1::GiveBackReason::Failed, message.clone()),
        };
        let request = v1::GiveBackRequest {
            identity: self.identity(),
            leases: leases.iter().map(lease_id_to_proto).collect(),
            reason: reason.into(),
            message,
            leaving: false,
        };
        let call = |mut client: Client| async move { client.give_back(request).await };
        self.call(ANSWER, call).await.map(|_| ())
    }

    async fn leave(&self) -> Result<(), TransportError> {
        let request = v1::GiveBackRequest {
            identity: self.identity(),
            leases: Vec::new(),
            reason: v1::GiveBackReason::Draining.into(),
            message: String::new(),
            leaving: true,
        };
        let call = |mut client: Client| async move { client.give_back(request).await };
        self.call(ANSWER, call).await.map(|_| ())
    }

    async fn system(&self, problem: Digest) -> Result<System, TransportError> {
        let request = v1::GetProblemRequest {
            digest: to_proto::digest(problem),
        };
        let call = |mut client: Client| async move { client.get_problem(request).await };
        let message = self.call(ANSWER, call).await?.into_inner();
        let system = from_proto::problem::system(&message)?;
        let received_digest = digest::of_system(&system);
        if received_digest == problem {
            Ok(system)
        } else {
            let text = format!("asked for system {problem}, got {received_digest}");
            Err(TransportError::Malformed(text))
        }
    }

    async fn stage(&self, job: &str, stage: StageId) -> Result<Stage, TransportError> {
        let request = v1::GetStageRequest {
            job: job.to_owned(),
            stage: stage.0,
        };
        let call = |mut client: Client| async move { client.get_stage(request).await };
        let message = self.call(ANSWER, call).await?.into_inner();
        Ok(from_proto::path::stage(&message)?)
    }

    async fn points(&self, object: Digest) -> Result<StoredPoints, TransportError> {
        let request = v1::GetObjectRequest {
            digest: to_proto::digest(object),
        };
        let call = |mut client: Client| async move {
            let mut pieces = client.get_object(request).await?.into_inner();
            let mut bytes = Vec::new();
            while let Some(piece) = pieces.message().await? {
                bytes.extend_from_slice(&piece.data);
                if bytes.len() as u64 > OBJECT_BYTES.value {
                    return Err(Status::out_of_range("the object is larger than any may be"));
                }
            }
            Ok(bytes)
        };
        let bytes = self.call(REPORT_ANSWER, call).await?;
        let received_digest = digest::of_bytes(&bytes);
        if received_digest != object {
            let text = format!("asked for object {object}, got {received_digest}");
            return Err(TransportError::Malformed(text));
        }
        StoredPoints::from_bytes(&bytes)
            .map_err(|error| TransportError::Malformed(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_worth_asking_again_are_told_apart() {
        let check = |status: Status, expected: TransportError| {
            assert_eq!(explain(&status), expected);
        };
        check(
            Status::unavailable("down"),
            TransportError::Unavailable("down".to_owned()),
        );
        check(
            Status::not_found("no such stage"),
            TransportError::Refused("no such stage".to_owned()),
        );
        let refused = std::io::Error::new(std::io::ErrorKind::ConnectionRefused, "refused");
        let mut status = Status::unavailable("transport error");
        status.set_source(std::sync::Arc::new(refused));
        check(status, TransportError::Unavailable("refused".to_owned()));
    }

    #[test]
    fn a_lease_is_checked() {
        let lease = v1::Lease {
            id: Some(v1::LeaseId {
                job: "j".to_owned(),
                stage: 3,
                chunk: 4,
                epoch: 5,
            }),
            problem: vec![1; 32].into(),
            first: 10,
            count: 7,
            duration_ms: 1500,
            stage_digest: vec![2; 32].into(),
            alone: false,
        };
        let read = lease_from_proto(lease.clone()).unwrap();
        assert_eq!(read.items, 10..17);
        assert_eq!(read.lasts, Duration::from_millis(1500));
        assert_eq!(read.id.to_string(), "j/3/4/5");
        let check = |broken: v1::Lease, field: &str| {
            assert_eq!(lease_from_proto(broken).unwrap_err().field(), field);
        };
        let (mut no_id, mut short, mut endless) = (lease.clone(), lease.clone(), lease);
        no_id.id = None;
        short.problem = vec![1; 31].into();
        endless.count = u64::MAX;
        check(no_id, "id");
        check(short, "problem");
        check(endless, "count");
    }
}
