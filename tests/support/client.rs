//! Client: the service's calls as a test makes them, one after the other.

use crate::processes::PATIENCE;
use cognate_protocol::v1;
use cognate_protocol::v1::client_api_client::ClientApiClient;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use std::future::Future;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tokio::runtime::Runtime;
use tonic::transport::{Channel, Endpoint, Uri};
use tonic::{Code, Status};

/// A system to submit.
#[derive(Clone, Debug)]
pub struct Submission {
    /// The text of an input file.
    pub text: String,
    /// How it is to be solved.
    pub options: v1::Options,
    /// Chosen by the client.
    pub request_id: String,
}

impl Submission {
    /// A text with default options and seed 1.
    pub fn of(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            options: v1::Options {
                seed: Some(1),
                ..v1::Options::default()
            },
            request_id: format!("test-{}", uuid::Uuid::new_v4()),
        }
    }
}

/// All that a solved job says, in the bits that it says it in; times and workers left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The solutions, in order.
    pub solutions: Vec<v1::Solution>,
    /// Every path, by index.
    pub paths: Vec<v1::ClassifiedPath>,
    /// The counts.
    pub counts: v1::SummaryCounts,
}

/// A connection to one coordinator.
pub struct Client {
    runtime: Runtime,
    channel: Channel,
}

/// How long a job of a test may take.
pub const JOB_PATIENCE: Duration = Duration::from_secs(1800);

/// Messages may be as large as the service lets them be.
const MESSAGE_BYTES: usize = 64 << 20;

impl Client {
    /// Connects to `unix:PATH` or `http://HOST:PORT`; `None` when nobody answers.
    ///
    /// # Panics
    /// When the address is none.
    pub fn connect(address: &str) -> Option<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime");
        let channel = runtime.block_on(async {
            let channel = match address.strip_prefix("unix:") {
                Some(path) => {
                    let path = PathBuf::from(path);
                    let connector = tower::service_fn(move |_: Uri| {
                        let path = path.clone();
                        async move {
                            let stream = tokio::net::UnixStream::connect(path).await?;
                            Ok::<_, std::io::Error>(hyper_util::rt::TokioIo::new(stream))
                        }
                    });
                    let endpoint = Endpoint::from_static("http://localhost");
                    endpoint.connect_with_connector(connector).await
                }
                None => {
                    let endpoint = Endpoint::from_shared(address.to_owned());
                    endpoint.expect("an address").connect().await
                }
            };
            let channel = channel.ok()?;
            let mut client = ClientApiClient::new(channel.clone());
            let info = client.get_server_info(v1::GetServerInfoRequest {}).await;
            info.is_ok().then_some(channel)
        })?;
        Some(Self { runtime, channel })
    }

    /// Makes one call as a client.
    pub fn call<T, F>(&self, call: impl FnOnce(ClientApiClient<Channel>) -> F) -> Result<T, Status>
    where
        F: Future<Output = Result<T, Status>>,
    {
        let client = ClientApiClient::new(self.channel.clone());
        let client = client.max_decoding_message_size(MESSAGE_BYTES);
        self.runtime.block_on(call(client))
    }

    /// Makes one call as a worker.
    pub fn call_as_worker<T, F>(
        &self,
        call: impl FnOnce(WorkerApiClient<Channel>) -> F,
    ) -> Result<T, Status>
    where
        F: Future<Output = Result<T, Status>>,
    {
        let client = WorkerApiClient::new(self.channel.clone());
        let client = client.max_decoding_message_size(MESSAGE_BYTES);
        self.runtime.block_on(call(client))
    }

    /// Submits; the job's id.
    pub fn try_submit(&self, submission: &Submission) -> Result<String, Status> {
        let text = v1::Text {
            name: "test".to_owned(),
            content: submission.text.clone().into_bytes().into(),
        };
        let request = v1::SubmitRequest {
            request_id: submission.request_id.clone(),
            problem: Some(v1::Problem {
                source: Some(v1::problem::Source::Text(text)),
                options: Some(submission.options.clone()),
            }),
            tenant: String::new(),
        };
        let call =
            |mut client: ClientApiClient<Channel>| async move { client.submit(request).await };
        self.call(call).map(|response| response.into_inner().job)
    }

    /// Submits, as `cognate submit` does: while the coordinator is unavailable, the same request again. The
    /// job's id.
    ///
    /// # Panics
    /// When the coordinator does not take it.
    pub fn submit(&self, submission: &Submission) -> String {
        let begin = Instant::now();
        loop {
            match self.try_submit(submission) {
                Ok(job) => return job,
                Err(status) if status.code() == Code::Unavailable && begin.elapsed() < PATIENCE => {
                    std::thread::sleep(Duration::from_millis(100));
                }
                Err(status) => panic!("not submitted: {status}"),
            }
        }
    }

    /// How far a job is.
    pub fn progress(&self, job: &str) -> Result<v1::JobProgress, Status> {
        let request = v1::WatchRequest {
            job: job.to_owned(),
        };
        let call = |mut client: ClientApiClient<Channel>| async move {
            let mut stream = client.watch(request).await?.into_inner();
            let first = stream.message().await?;
            first.ok_or_else(|| Status::internal("a watch without progress"))
        };
        self.call(call)
    }

    /// Watches a job until it ends; how it ended.
    pub fn end(&self, job: &str) -> Result<v1::JobProgress, Status> {
        let request = v1::WatchRequest {
            job: job.to_owned(),
        };
        let call = |mut client: ClientApiClient<Channel>| async move {
            let mut stream = client.watch(request).await?.into_inner();
            let mut last = None;
            while let Some(progress) = stream.message().await? {
                last = Some(progress);
            }
            last.ok_or_else(|| Status::internal("a watch without progress"))
        };
        self.call(call)
    }

    /// How far a job is once this holds.
    ///
    /// # Panics
    /// When it does not hold in time.
    pub fn progress_once(
        &self,
        job: &str,
        what: &str,
        holds: impl Fn(&v1::JobProgress) -> bool,
    ) -> v1::JobProgress {
        self.progress_for(job, what, JOB_PATIENCE, holds)
    }

    /// How far a job is once this holds.
    ///
    /// # Panics
    /// When it does not hold within this time.
    pub fn progress_for(
        &self,
        job: &str,
        what: &str,
        patience: Duration,
        holds: impl Fn(&v1::JobProgress) -> bool,
    ) -> v1::JobProgress {
        let begin = Instant::now();
        let mut last = None;
        while begin.elapsed() < patience {
            match self.progress(job) {
                Ok(progress) if holds(&progress) => return progress,
                Ok(progress) => last = Some(Ok(progress)),
                Err(status) => last = Some(Err(status)),
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("{what}: not within {patience:?}; last heard: {last:?}");
    }

    /// Waits until a job is solved.
    ///
    /// # Panics
    /// When it ends otherwise, or does not end.
    pub fn wait_until_solved(&self, job: &str) {
        self.wait_until_solved_for(job, JOB_PATIENCE);
    }

    /// Waits at most this time until a job is solved.
    ///
    /// # Panics
    /// When it ends otherwise, or does not end in this time.
    pub fn wait_until_solved_for(&self, job: &str, patience: Duration) {
        let ended = self.progress_for(job, "the job ends", patience, has_ended);
        assert_eq!(ended.state(), v1::JobState::Solved, "{ended:?}");
    }

    /// Answer of a solved job.
    ///
    /// # Panics
    /// When there is no answer.
    pub fn answer(&self, job: &str) -> Answer {
        let mut solutions = Vec::new();
        self.each_solution(job, |solution| solutions.push(solution));
        let paths = self.paths(job);
        Answer {
            solutions,
            paths: paths.unwrap_or_else(|status| panic!("no answer: {status}")),
            counts: self.counts(job),
        }
    }

    /// Every path of a solved job, or why its results cannot be read.
    pub fn paths(&self, job: &str) -> Result<Vec<v1::ClassifiedPath>, tonic::Status> {
        let job = job.to_owned();
        let call = |mut client: ClientApiClient<Channel>| async move {
            let request = v1::StreamPathsRequest { job };
            let mut stream = client.stream_paths(request).await?.into_inner();
            let mut paths = Vec::new();
            while let Some(path) = stream.message().await? {
                paths.push(path);
            }
            Ok(paths)
        };
        self.call(call)
    }

    /// Every solution of a solved job, one at a time.
    ///
    /// # Panics
    /// When the coordinator does not say.
    pub fn each_solution(&self, job: &str, mut each: impl FnMut(v1::Solution)) {
        let job = job.to_owned();
        let call = |mut client: ClientApiClient<Channel>| async move {
            let request = v1::StreamSolutionsRequest { job, skip: 0 };
            let mut stream = client.stream_solutions(request).await?.into_inner();
            while let Some(solution) = stream.message().await? {
                each(solution);
            }
            Ok(())
        };
        self.call(call).expect("all solutions");
    }

    /// Every path of a solved job, one at a time.
    ///
    /// # Panics
    /// When the coordinator does not say.
    pub fn each_path(&self, job: &str, mut each: impl FnMut(v1::ClassifiedPath)) {
        let job = job.to_owned();
        let call = |mut client: ClientApiClient<Channel>| async move {
            let request = v1::StreamPathsRequest { job };
            let mut stream = client.stream_paths(request).await?.into_inner();
            while let Some(path) = stream.message().await? {
                each(path);
            }
            Ok(())
        };
        self.call(call).expect("all paths");
    }

    /// The counts of a solved job.
    ///
    /// # Panics
    /// When it does not say them.
    pub fn counts(&self, job: &str) -> v1::SummaryCounts {
        let request = v1::GetSummaryRequest {
            job: job.to_owned(),
        };
        let call =
            |mut client: ClientApiClient<Channel>| async move { client.get_summary(request).await };
        match self.call(call) {
            Ok(response) => response.into_inner().counts.unwrap_or_default(),
            Err(status) => panic!("no summary: {status}"),
        }
    }

    /// Submits, waits, and asks for the answer.
    ///
    /// # Panics
    /// When the job is not solved.
    pub fn solve(&self, submission: &Submission) -> Answer {
        let job = self.submit(submission);
        self.wait_until_solved(&job);
        self.answer(&job)
    }

    /// The workers that the coordinator has heard of.
    ///
    /// # Panics
    /// When it does not say.
    pub fn workers(&self) -> Vec<v1::WorkerOverview> {
        let call = |mut client: ClientApiClient<Channel>| async move {
            client.list_workers(v1::ListWorkersRequest {}).await
        };
        match self.call(call) {
            Ok(response) => response.into_inner().workers,
            Err(status) => panic!("no list of workers: {status}"),
        }
    }
}

/// Whether a job goes on no further.
pub fn has_ended(progress: &v1::JobProgress) -> bool {
    use v1::JobState::{Cancelled, Failed, Solved};
    matches!(progress.state(), Solved | Failed | Cancelled)
}

/// Items of all stages that are done.
pub fn accepted(progress: &v1::JobProgress) -> u64 {
    progress.stages.iter().map(|stage| stage.accepted).sum()
}

/// Items of all stages.
pub fn total(progress: &v1::JobProgress) -> u64 {
    progress.stages.iter().map(|stage| stage.total).sum()
}
