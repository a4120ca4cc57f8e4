//! A worker made of single calls, so that a test decides when each of them happens.

use cognate_continuation::item_result::ItemResult;
use cognate_continuation::stage::PreparedStage;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use cognate_protocol::{PROTOCOL_VERSION, from_proto, to_proto, v1};
use cognate_tests::client::Client;
use tonic::transport::Channel;

type Calls = WorkerApiClient<Channel>;

/// A worker that does what a test says.
pub struct HandWorker<'a> {
    client: &'a Client,
    identity: v1::WorkerIdentity,
    sequence: u64,
}

impl<'a> HandWorker<'a> {
    /// A worker of this name.
    pub fn new(client: &'a Client, name: &str) -> Self {
        Self {
            client,
            identity: v1::WorkerIdentity {
                worker: name.to_owned(),
                session: format!("{name}-1"),
            },
            sequence: 0,
        }
    }

    /// Description of the machine that this worker sends.
    pub fn machine() -> v1::Machine {
        v1::Machine {
            version: "by hand".to_owned(),
            protocol_version: PROTOCOL_VERSION,
            numerics_revision: cognate_numeric::NUMERICS_REVISION,
            instruction_set: "avx2".to_owned(),
            lane_width: 8,
            threads: 1,
            host: "here".to_owned(),
            transport: "grpc".to_owned(),
        }
    }

    /// One pull, with this machine.
    pub fn pull_as(&self, sequence: u64, machine: v1::Machine) -> v1::PullResponse {
        let request = v1::PullRequest {
            identity: Some(self.identity.clone()),
            sequence,
            free_slots: 1,
            wait_ms: 5000,
            machine: Some(machine),
        };
        let call = |mut calls: Calls| async move { calls.pull(request).await };
        let response = self.client.call_as_worker(call);
        response.expect("the coordinator answers").into_inner()
    }

    /// The next pull.
    pub fn pull(&mut self) -> v1::PullResponse {
        self.sequence += 1;
        self.pull_as(self.sequence, Self::machine())
    }

    /// The last pull once more.
    pub fn pull_again(&self) -> v1::PullResponse {
        self.pull_as(self.sequence, Self::machine())
    }

    /// Pulls until there is a chunk.
    pub fn lease(&mut self) -> v1::Lease {
        for _ in 0..20 {
            if let Some(lease) = self.pull().leases.pop() {
                return lease;
            }
        }
        panic!("no chunk for a worker that asks for one");
    }

    /// The results of a chunk, tracked here.
    pub fn track(&self, lease: &v1::Lease) -> Vec<ItemResult> {
        let id = lease.id.clone().expect("a lease has an id");
        let digest = lease.problem.clone();
        let call = |mut calls: Calls| async move {
            let problem = calls.get_problem(v1::GetProblemRequest { digest }).await?;
            let request = v1::GetStageRequest {
                job: id.job,
                stage: id.stage,
            };
            let stage = calls.get_stage(request).await?;
            Ok((problem.into_inner(), stage.into_inner()))
        };
        let (system, stage) = self.client.call_as_worker(call).expect("system and stage");
        let system = from_proto::problem::system(&system).expect("a system");
        let stage = from_proto::path::stage(&stage).expect("a stage");
        let prepared = PreparedStage::new(&system, &stage, &|_| None).expect("a stage to track");
        let paths = prepared.track(lease.first..lease.first + lease.count, 8);
        paths.into_iter().map(ItemResult::Track).collect()
    }

    /// Reports results for a lease.
    pub fn report(&self, lease: &v1::Lease, results: &[ItemResult]) -> v1::Verdict {
        let request = v1::ReportRequest {
            identity: Some(self.identity.clone()),
            chunks: vec![v1::ChunkReport {
                lease: lease.id.clone(),
                results: results.iter().map(to_proto::path::item_result).collect(),
                cpu_nanoseconds: 1_000_000,
                wall_nanoseconds: 1_000_000,
            }],
        };
        let call = |mut calls: Calls| async move { calls.report(request).await };
        let response = self
            .client
            .call_as_worker(call)
            .expect("a verdict")
            .into_inner();
        assert_eq!(response.verdicts.len(), 1);
        response.verdicts[0].verdict()
    }

    /// Whether a lease could be renewed.
    pub fn renew(&self, lease: &v1::Lease) -> bool {
        let request = v1::RenewRequest {
            identity: Some(self.identity.clone()),
            leases: lease.id.iter().cloned().collect(),
        };
        let call = |mut calls: Calls| async move { calls.renew(request).await };
        let response = self
            .client
            .call_as_worker(call)
            .expect("an answer")
            .into_inner();
        assert_eq!(response.renewals.len(), 1);
        response.renewals[0].held
    }
}
