//! One connection to a coordinator: calls out, answers and errors in the client's own words.

use super::error::ClientError;
use cognate_protocol::limits::{MESSAGE_BYTES, PIECE_BYTES};
use cognate_protocol::v1::client_api_client::ClientApiClient;
use cognate_protocol::{from_proto, v1};
use cognate_solutions::solution::Solution;
use cognate_worker::config::TransportChoice;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::connect::{CredentialFiles, Credentials, Role, innermost};
use cognate_worker::transport::route::Route;
use std::io;
use std::time::{Duration, Instant};
use tonic::service::Routes;
use tonic::{Code, Status};
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_client::HealthClient;

/// How long a coordinator may take to accept a connection.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// How long a command waits where nobody listens: a coordinator that was started on the line before takes some tenths of a
/// second to open its ledger and to listen.
const STARTING: Duration = Duration::from_secs(3);
/// The pause between two attempts meanwhile.
const PAUSE: Duration = Duration::from_millis(100);

/// The address of the coordinator of this process.
const HERE: &str = "this process";

/// Where calls go.
#[derive(Clone, Debug)]
pub enum Target {
    /// To a coordinator elsewhere.
    Elsewhere {
        /// Addresses of the coordinators, with commas between.
        addresses: String,
        /// Credentials for the coordinator: token and certificates.
        credentials: Credentials,
    },
    /// To the coordinator of this process.
    Here(Routes),
}

impl Target {
    /// The target with these addresses, with credentials from these files.
    pub fn read(addresses: &str, files: &CredentialFiles) -> Result<Self, ClientError> {
        let read = Credentials::read(files, Role::Client);
        Ok(Self::Elsewhere {
            addresses: addresses.to_owned(),
            credentials: read.map_err(|error| ClientError::Input {
                origin: error.file,
                message: error.what,
            })?,
        })
    }

    /// Name of the target, for the user.
    pub fn name(&self) -> &str {
        match self {
            Self::Elsewhere { addresses, .. } => addresses,
            Self::Here(_) => HERE,
        }
    }
}

/// A connection to one coordinator.
#[derive(Clone, Debug)]
pub struct Connection {
    client: ClientApiClient<Route>,
    address: String,
}

impl Connection {
    /// Connects to the first of these addresses that answers; waits for a coordinator that is about to listen.
    pub async fn open(target: &Target) -> Result<Self, ClientError> {
        Self::open_within(STARTING, target).await
    }

    /// Connects to the first of these addresses that answers; waits for at most `patience`.
    pub async fn open_within(patience: Duration, target: &Target) -> Result<Self, ClientError> {
        let begin = Instant::now();
        loop {
            match Self::open_at_once(target).await {
                Err(ClientError::Absent { .. }) if begin.elapsed() < patience => {
                    tokio::time::sleep(PAUSE).await;
                }
                done => return done,
            }
        }
    }

    /// Connects to the first of these addresses that answers, or says that nobody does.
    pub async fn open_at_once(target: &Target) -> Result<Self, ClientError> {
        let (addresses, credentials) = match target {
            Target::Here(services) => {
                let route = Route::in_process(services.clone());
                return Ok(Self::by(route, target.name()));
            }
            Target::Elsewhere {
                addresses,
                credentials,
            } => (addresses, credentials),
        };
        let mut last = None;
        for address in addresses.split(',') {
            match Self::open_one(address.trim(), credentials).await {
                Err(error @ (ClientError::Unreachable { .. } | ClientError::Absent { .. })) => {
                    last = Some(error);
                }
                done => return done,
            }
        }
        last.map_or_else(|| unreachable!("a split text has a first part"), Err)
    }

    fn by(route: Route, address: &str) -> Self {
        let limit = usize::try_from(MESSAGE_BYTES.value).unwrap_or(usize::MAX);
        Self {
            client: ClientApiClient::new(route)
                .max_decoding_message_size(limit)
                .max_encoding_message_size(limit),
            address: address.to_owned(),
        }
    }

    async fn open_one(address: &str, credentials: &Credentials) -> Result<Self, ClientError> {
        let wrong = |e: &dyn std::fmt::Display| ClientError::Input {
            origin: "--coordinator".into(),
            message: e.to_string(),
        };
        let parsed: Address = address.parse().map_err(|e| wrong(&e))?;
        let channel = credentials.channel(&parsed).map_err(|e| wrong(&e))?;
        let route = Route::new(channel, credentials.bearer(), parsed, TransportChoice::Grpc);
        // Asked at once whether anybody is there: later errors are about the call.
        let mut health = HealthClient::new(route.clone());
        let answer = health.check(HealthCheckRequest::default());
        let reason = match tokio::time::timeout(CONNECT_TIMEOUT, answer).await {
            Ok(Err(status)) if nobody_listens(&status) => {
                return Err(ClientError::Absent {
                    address: address.to_owned(),
                    reason: innermost(&status),
                });
            }
            Ok(Err(status)) if std::error::Error::source(&status).is_some() => innermost(&status),
            Ok(_) => return Ok(Self::by(route, address)),
            Err(_) => "no answer in time".into(),
        };
        Err(ClientError::Unreachable {
            address: address.to_string(),
            reason,
        })
    }

    /// Converts an error of the service into an error for the user.
    fn explain(&self, status: &Status) -> ClientError {
        // A cause of its own: the connection broke; what the service says has none.
        if std::error::Error::source(status).is_some() {
            return ClientError::Unreachable {
                address: self.address.clone(),
                reason: innermost(status),
            };
        }
        let message = status.message().to_string();
        match status.code() {
            Code::InvalidArgument
            | Code::NotFound
            | Code::FailedPrecondition
            | Code::OutOfRange
            | Code::ResourceExhausted
            | Code::AlreadyExists
            | Code::PermissionDenied
            | Code::Unauthenticated => match self.address.as_str() {
                // A user of `cognate solve` does not know of a coordinator.
                HERE => ClientError::Misfit(message),
                _ => ClientError::Refused(message),
            },
            // The service says "not in this version" itself.
            Code::Unimplemented => ClientError::NotInThisVersion {
                what: message
                    .trim_start_matches("not in this version")
                    .trim_start_matches([':', ' '])
                    .to_string(),
            },
            Code::Unavailable => ClientError::Unreachable {
                address: self.address.clone(),
                reason: innermost(status),
            },
            code => ClientError::GaveUp(format!("{message} ({})", code.description())),
        }
    }

    /// The error of a stream that ended before its last message.
    pub fn stopped_early(&self) -> ClientError {
        ClientError::Unreachable {
            address: self.address.clone(),
            reason: "it stopped in the middle of an answer".into(),
        }
    }

    /// Makes a job; the same request id sent twice makes one job.
    pub async fn submit(
        &mut self,
        request_id: &str,
        problem: v1::Problem,
    ) -> Result<v1::SubmitResponse, ClientError> {
        let request = v1::SubmitRequest {
            request_id: request_id.to_string(),
            problem: Some(problem),
            tenant: String::new(),
        };
        let answer = self.client.submit(request).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner())
    }

    /// Stores an object for a later submission.
    pub async fn upload(&mut self, bytes: Vec<u8>) -> Result<v1::UploadResponse, ClientError> {
        let data = bytes::Bytes::from(bytes);
        let piece = usize::try_from(PIECE_BYTES.value).unwrap_or(usize::MAX);
        let pieces: Vec<v1::ObjectPiece> = (0..data.len().max(1))
            .step_by(piece)
            .map(|at| v1::ObjectPiece {
                data: data.slice(at..data.len().min(at + piece)),
            })
            .collect();
        let answer = self.client.upload(futures::stream::iter(pieces)).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner())
    }

    /// The job's progress, now and after every change.
    pub async fn watch(&mut self, job: &str) -> Result<Following, ClientError> {
        let request = v1::WatchRequest { job: job.into() };
        let answer = self.client.watch(request).await;
        Ok(Following {
            stream: answer.map_err(|e| self.explain(&e))?.into_inner(),
            connection: self.clone(),
        })
    }

    /// Where the job stands now.
    pub async fn progress(&mut self, job: &str) -> Result<v1::JobProgress, ClientError> {
        let mut following = self.watch(job).await?;
        match following.next().await? {
            Some(progress) => Ok(progress),
            None => Err(self.stopped_early()),
        }
    }

    /// The summary of a finished job, as JSON.
    pub async fn summary(&mut self, job: &str) -> Result<String, ClientError> {
        let request = v1::GetSummaryRequest { job: job.into() };
        let answer = self.client.get_summary(request).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner().json)
    }

    /// The components that a finished job found, with their witness points: one JSON object, whose numbers are
    /// kept as they were written.
    pub async fn decomposition(&mut self, job: &str) -> Result<serde_json::Value, ClientError> {
        let request = v1::GetDecompositionRequest { job: job.into() };
        let answer = self.client.get_decomposition(request).await;
        let mut pieces = answer.map_err(|e| self.explain(&e))?.into_inner();
        let mut json = Vec::new();
        while let Some(piece) = pieces.message().await.map_err(|e| self.explain(&e))? {
            json.extend_from_slice(&piece.data);
        }
        serde_json::from_slice(&json)
            .map_err(|e| ClientError::GaveUp(format!("its components are no JSON: {e}")))
    }

    /// Hands every solution of a finished job to `take`, until it says that it has enough.
    pub async fn solutions(
        &mut self,
        job: &str,
        mut take: impl FnMut(Solution, u32) -> Result<bool, ClientError>,
    ) -> Result<(), ClientError> {
        let request = v1::StreamSolutionsRequest {
            job: job.into(),
            skip: 0,
        };
        let answer = self.client.stream_solutions(request).await;
        let mut stream = answer.map_err(|e| self.explain(&e))?.into_inner();
        while let Some(solution) = stream.message().await.map_err(|e| self.explain(&e))? {
            let target = solution.target;
            let solution = from_proto::solution::solution(&solution)
                .map_err(|e| ClientError::GaveUp(format!("a solution of it is malformed: {e}")))?;
            if !take(solution, target)? {
                break;
            }
        }
        Ok(())
    }

    /// Hands every path of a finished job to `take`.
    pub async fn paths(
        &mut self,
        job: &str,
        mut take: impl FnMut(v1::ClassifiedPath) -> Result<(), ClientError>,
    ) -> Result<(), ClientError> {
        let request = v1::StreamPathsRequest { job: job.into() };
        let answer = self.client.stream_paths(request).await;
        let mut stream = answer.map_err(|e| self.explain(&e))?.into_inner();
        while let Some(path) = stream.message().await.map_err(|e| self.explain(&e))? {
            take(path)?;
        }
        Ok(())
    }

    /// How the job's numbers came about: for people, and as JSON.
    pub async fn explanation(&mut self, job: &str) -> Result<v1::ExplainResponse, ClientError> {
        let request = v1::ExplainRequest { job: job.into() };
        let answer = self.client.explain(request).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner())
    }

    /// Stops a job; gives its state afterwards.
    pub async fn cancel(&mut self, job: &str) -> Result<v1::JobState, ClientError> {
        let request = v1::CancelRequest { job: job.into() };
        let answer = self.client.cancel(request).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner().state())
    }

    /// Deletes a job; returns the counts of the removed data.
    pub async fn delete(
        &mut self,
        job: &str,
        cancel_first: bool,
    ) -> Result<v1::DeleteResponse, ClientError> {
        let request = v1::DeleteRequest {
            job: job.into(),
            cancel_first,
        };
        let answer = self.client.delete(request).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner())
    }

    /// The newest jobs.
    pub async fn jobs(&mut self) -> Result<Vec<v1::JobOverview>, ClientError> {
        let answer = self.client.list_jobs(v1::ListJobsRequest::default()).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner().jobs)
    }

    /// The workers that were heard of lately.
    pub async fn workers(&mut self) -> Result<Vec<v1::WorkerOverview>, ClientError> {
        let answer = self.client.list_workers(v1::ListWorkersRequest {}).await;
        Ok(answer.map_err(|e| self.explain(&e))?.into_inner().workers)
    }
}

/// Whether no process listens at the address of a call that failed so.
fn nobody_listens(status: &Status) -> bool {
    let mut cause = std::error::Error::source(status);
    while let Some(error) = cause {
        let kind = error.downcast_ref::<io::Error>().map(io::Error::kind);
        if let Some(io::ErrorKind::ConnectionRefused | io::ErrorKind::NotFound) = kind {
            return true;
        }
        cause = error.source();
    }
    false
}

/// A job's progress as it comes.
pub struct Following {
    stream: tonic::Streaming<v1::JobProgress>,
    connection: Connection,
}

impl Following {
    /// The next change; nothing when the job has ended.
    pub async fn next(&mut self) -> Result<Option<v1::JobProgress>, ClientError> {
        self.stream
            .message()
            .await
            .map_err(|e| self.connection.explain(&e))
    }
}
