//! A worker that does evil: it takes chunks as any other does, and then fails them, lies about them, or reaches for
//! those of others.
//!
//! A process of its own: `chaos evil-worker KIND ADDRESS[,ADDRESS]`.

use async_trait::async_trait;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::Coordinates;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::{Stage, StageId};
use cognate_systems::system::System;
use cognate_worker::chunk_runner::TrackedChunk;
use cognate_worker::config::Config;
use cognate_worker::machine::Machine;
use cognate_worker::shell::run_over;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::grpc::Grpc;
use cognate_worker::transport::{
    Announcement, GiveBack, LeaseId, Pulled, Receipt, Renewal, Transport, TransportError,
};
use std::collections::BTreeSet;
use std::fmt;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// Behaviour of an evil worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evil {
    /// Gives back whatever it gets as failed.
    BlackHole,
    /// Tracks, and moves ends by a hundredth before it reports them.
    Liar,
    /// Renews, gives back and reports chunks that others have, before it reports its own.
    Squatter,
}

impl Evil {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::BlackHole, Self::Liar, Self::Squatter];
    /// Number of chunks after which the worker must be named. Lies show at once, three failures in a row are a fault,
    /// and of some chunks that a squatter reaches for another worker has one.
    pub fn found_out_after(self) -> usize {
        match self {
            Self::BlackHole => 4,
            Self::Liar => 1,
            Self::Squatter => 6,
        }
    }

    /// Text of a squatter before the lease if a forged report was accepted.
    pub const BELIEVED: &str = "a forged report was accepted: ";
    /// Text of a squatter before a lease that it was given.
    pub const LEASED: &str = "leased ";
}

impl fmt::Display for Evil {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::BlackHole => "black-hole",
            Self::Liar => "liar",
            Self::Squatter => "squatter",
        })
    }
}

/// The name that a worker of this kind has in this process.
pub fn name(kind: Evil, process: u32) -> String {
    format!("evil-{kind}-{process}")
}

/// Calls of a worker that does evil.
struct EvilCalls {
    kind: Evil,
    honest: Grpc,
    /// Leases of this worker.
    own: Mutex<BTreeSet<LeaseId>>,
}

impl EvilCalls {
    /// Chunks beside its own, of as many items, and its own as they may be leased later: those that are not its own.
    fn of_others(&self, lease: &LeaseId, items: u64) -> Vec<LeaseId> {
        let evil_leases = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        let ahead = (1..4).map(|k| LeaseId {
            epoch: lease.epoch + k,
            ..lease.clone()
        });
        let beside = (0..16).map(|k| LeaseId {
            chunk: (lease.chunk + k * items).saturating_sub(8 * items),
            ..lease.clone()
        });
        let others = ahead.chain(beside);
        others
            .filter(|other| !evil_leases.contains(other))
            .collect()
    }

    async fn squat(&self, lease: &LeaseId, chunk: &TrackedChunk) -> Result<(), TransportError> {
        let others = self.of_others(lease, chunk.results.len() as u64);
        // One may be its own by now, which a pull that waits has not said yet: it is no forgery where that says it later.
        self.honest.renew(&others).await?;
        let lie = GiveBack::Failed("another one says so".into());
        self.honest.give_back(&others, &lie).await?;
        for other in &others {
            let receipt = self.honest.report(other, &spoilt(chunk)).await?;
            if receipt == Receipt::Accepted {
                println!("{}{other}", Evil::BELIEVED);
            }
        }
        Ok(())
    }
}

/// A copy of the chunk with endpoints that are beside the true ones.
fn spoilt(chunk: &TrackedChunk) -> TrackedChunk {
    let mut chunk = chunk.clone();
    for result in &mut chunk.results {
        if let ItemResult::Track(path) = result {
            let moved = path.endpoint.to_double().iter().enumerate();
            let moved = moved.map(|(k, z)| z * (1.0 + 0.01 * (k % 3) as f64));
            path.endpoint = Coordinates::Double(moved.collect());
        }
    }
    chunk
}

#[async_trait]
impl Transport for EvilCalls {
    async fn pull(
        &self,
        sequence: u64,
        free: usize,
        wait: Duration,
    ) -> Result<Pulled, TransportError> {
        let pulled = self.honest.pull(sequence, free, wait).await?;
        let mut evil_leases = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        for lease in &pulled.leases {
            println!("{}{}", Evil::LEASED, lease.id);
            evil_leases.insert(lease.id.clone());
        }
        Ok(pulled)
    }

    async fn renew(&self, leases: &[LeaseId]) -> Result<Vec<Renewal>, TransportError> {
        self.honest.renew(leases).await
    }

    async fn report(
        &self,
        lease: &LeaseId,
        chunk: &TrackedChunk,
    ) -> Result<Receipt, TransportError> {
        match self.kind {
            Evil::BlackHole => {
                let lie = GiveBack::Failed("it cannot be done here".into());
                self.honest
                    .give_back(std::slice::from_ref(lease), &lie)
                    .await?;
                Ok(Receipt::Stale)
            }
            Evil::Liar => self.honest.report(lease, &spoilt(chunk)).await,
            Evil::Squatter => {
                self.squat(lease, chunk).await?;
                self.honest.report(lease, chunk).await
            }
        }
    }

    async fn give_back(&self, leases: &[LeaseId], why: &GiveBack) -> Result<(), TransportError> {
        self.honest.give_back(leases, why).await
    }

    async fn leave(&self) -> Result<(), TransportError> {
        self.honest.leave().await
    }

    async fn system(&self, problem: Digest) -> Result<System, TransportError> {
        self.honest.system(problem).await
    }

    async fn stage(&self, job: &str, stage: StageId) -> Result<Stage, TransportError> {
        self.honest.stage(job, stage).await
    }

    async fn points(&self, object: Digest) -> Result<StoredPoints, TransportError> {
        self.honest.points(object).await
    }
}

/// The process: works for the coordinators until it is ended, or gets no more work.
pub fn execute(words: &[String]) -> ExitCode {
    let [kind, addresses] = words else {
        eprintln!("error: expected evil-worker KIND ADDRESS");
        return ExitCode::from(2);
    };
    let kind = Evil::ALL.into_iter().find(|k| k.to_string() == *kind);
    let addresses: Result<Vec<Address>, _> = addresses.split(',').map(str::parse).collect();
    let (Some(kind), Ok(addresses)) = (kind, addresses) else {
        eprintln!("error: unknown kind or address");
        return ExitCode::from(2);
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .expect("a runtime");
    runtime.block_on(async {
        let config = Config {
            threads: 1,
            ..Config::new(addresses)
        };
        let announcement = Announcement {
            worker: name(kind, std::process::id()),
            session: uuid::Uuid::new_v4().to_string(),
            machine: Machine::detect(),
            threads: 1,
            lane_width: 16,
        };
        let honest = Grpc::new(&config, &announcement).expect("an address");
        let calls = Arc::new(EvilCalls {
            kind,
            honest,
            own: Mutex::default(),
        });
        let ending = run_over(config, announcement, calls, CancellationToken::new()).await;
        println!("ended: {ending:?}");
    });
    ExitCode::SUCCESS
}
