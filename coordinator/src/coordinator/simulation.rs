//! A cluster in one process under a seed: coordinators that are killed, workers that die, fall
//! silent, cannot be heard and report twice, on one ledger that fails and one store. Real paths, a
//! clock set by hand.

mod fault;

pub use self::fault::Fault;

use super::conduct::ConductRules;
use super::{Coordinator, CoordinatorError, NewProblem, Pull, Report};
use crate::chunks::audit::AuditKey;
use crate::chunks::leasing::Policy;
use crate::chunks::sizing::Sizing;
use crate::jobs::drive::{Drive, Driven};
use crate::jobs::tools::Tools;
use crate::ledger::clock::ManualClock;
use crate::ledger::identity::*;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::*;
use crate::ledger::{Ledger, LedgerError};
use crate::results::store::{Store, StoreError};
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_protocol::submission::{Options, SettingsChoice};
use cognate_systems::system::System;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A worker of this name, whose session has the same.
pub fn speaker(name: &str) -> Speaker {
    Speaker {
        worker: WorkerId::new(name).expect("a good name"),
        session: name.to_owned(),
    }
}

/// Small numbers by a seed (SplitMix64).
pub struct Dice(pub u64);

impl Dice {
    /// One of 0, 1, ..., sides - 1.
    pub fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % sides
    }
}

/// Policy with at most this number of items in a chunk, and with short deadlines.
pub fn policy(most_items: u64) -> Policy {
    Policy {
        lease_ms: 3000,
        steward_ms: 2000,
        sizing: Sizing {
            first_items: most_items,
            most_items,
            ..Sizing::default()
        },
        // Each coordinator that is started would compile what it checks by: `tests_of_audits` has it.
        check_results: false,
        // Here workers fail by chance, and time is simulated.
        rework_percent: 0,
        conduct: ConductRules {
            failures: u32::MAX,
            ..ConductRules::default()
        },
        ..Policy::default()
    }
}

/// Cluster without faults, with at most this number of items in a chunk.
pub fn cluster(most_items: u64, seed: u64) -> Cluster {
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::with_audit_key(
        clock.clone(),
        AuditKey::from_text("simulation"),
    ));
    Cluster::new(ledger, Store::in_memory(), clock, policy(most_items), seed)
}

/// The reference of a problem: one coordinator and one worker solve it, and nothing happens to them.
pub async fn undisturbed(problem: &NewProblem) -> (Cluster, JobRow) {
    let mut cluster = cluster(1000, 1);
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.submit(problem).await;
    for _ in 0..200 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
    }
    let row = cluster.row().await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
    (cluster, row)
}

/// Whether clusters of all sizes, in which chance decides who does what, find what the reference is.
pub async fn check_any_cluster(
    problem: &NewProblem,
    reference: &JobRow,
    sizes: &[u64],
    seeds: u64,
) {
    for seed in 0..seeds {
        let mut cluster = cluster(sizes[seed as usize % sizes.len()], seed);
        // Here workers die by chance, and no path is at fault.
        cluster.policy.suspicion_limit = 1000;
        for _ in 0..=seed % 2 {
            cluster.start_coordinator();
        }
        for _ in 0..=seed % 3 {
            cluster.start_worker();
        }
        cluster.submit(problem).await;
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
    }
}

/// Every path fails at first and is tracked again: at least three stages.
pub fn problem() -> NewProblem {
    let text = "variable_group x, y; function f, g;
        f = x^4 + 2*x*y^2 - 3*y + 1; g = y^4 - x^3*y + 2*x - 5;";
    problem_of(text, Some(25))
}

/// Problem in Bertini's notation, with a limit on the steps of the first attempt.
pub fn problem_of(text: &str, max_steps: Option<u32>) -> NewProblem {
    let read = cognate_systems::formats::read("test", text.as_bytes());
    NewProblem {
        system: read.expect("the tests' systems can be read").system,
        options: Options {
            seed: Some(7),
            name: "test".into(),
            settings: SettingsChoice {
                max_steps,
                ..SettingsChoice::default()
            },
            ..Options::default()
        },
        start_solutions: None,
        warnings: Vec::new(),
    }
}

/// A worker process.
struct Worker {
    name: String,
    /// By what it is known; its name where nothing else was given to it.
    credential: String,
    pulls: u64,
    width: usize,
    leases: Vec<Lease>,
    said: Option<Report>,
    /// How its arithmetic is broken, if it is.
    wrong: Option<Fault>,
}

/// A coordinator process with the job that it drives.
struct Process {
    coordinator: Arc<Coordinator>,
    who: CoordinatorId,
    drive: Option<Drive>,
}

/// Everything that is alive, and what survives it.
pub struct Cluster {
    pub clock: Arc<ManualClock>,
    pub ledger: Arc<dyn Ledger>,
    pub store: Store,
    pub policy: Policy,
    pub dice: Dice,
    pub job: JobId,
    /// A path that no worker survives.
    pub deadly: Option<u64>,
    /// How often items were tracked.
    pub tracked: u64,
    /// Replies that were lost and heard the second time.
    pub heard_again: u64,
    /// Reports of late workers, after the second one's was accepted.
    pub overtaken: u64,
    /// Storage loses what was written: workers do not always find what they need.
    pub lossy: bool,
    /// Votes that a coordinator struck.
    pub struck: usize,
    /// One of the workers computes wrongly.
    broken: bool,
    /// Items whose results were accepted, by stage.
    pub accepted: BTreeSet<(u32, u64)>,
    processes: Vec<Process>,
    workers: Vec<Worker>,
    /// A worker that no coordinator hears.
    silent: Option<usize>,
    born: u64,
    prepared: Mutex<HashMap<Digest, Arc<PreparedWork>>>,
}

impl Cluster {
    /// A cluster with nobody in it.
    pub fn new(
        ledger: Arc<dyn Ledger>,
        store: Store,
        clock: Arc<ManualClock>,
        policy: Policy,
        seed: u64,
    ) -> Self {
        Self {
            clock,
            ledger,
            store,
            policy,
            dice: Dice(seed),
            job: JobId(0),
            deadly: None,
            tracked: 0,
            heard_again: 0,
            overtaken: 0,
            lossy: false,
            struck: 0,
            broken: false,
            accepted: BTreeSet::new(),
            processes: Vec::new(),
            workers: Vec::new(),
            silent: None,
            born: 0,
            prepared: Mutex::default(),
        }
    }

    /// Starts a coordinator; every one has a name of its own.
    pub fn start_coordinator(&mut self) {
        self.born += 1;
        let who = CoordinatorId::new(format!("c{}", self.born)).expect("a good name");
        let coordinator = Coordinator::new(
            Arc::clone(&self.ledger),
            self.store.clone(),
            who.clone(),
            self.policy.clone(),
        );
        self.processes.push(Process {
            coordinator,
            who,
            drive: None,
        });
    }

    /// Kills a coordinator and starts another in its place.
    pub fn crash(&mut self, process: usize) {
        self.start_coordinator();
        self.processes.swap_remove(process);
    }

    /// Starts a worker.
    pub fn start_worker(&mut self) {
        self.born += 1;
        let width = [1, 8, 16][self.dice.roll(3) as usize];
        self.workers.push(Worker {
            name: format!("w{}", self.born),
            credential: format!("w{}", self.born),
            pulls: 0,
            width,
            leases: Vec::new(),
            said: None,
            wrong: None,
        });
    }

    /// The name of a worker.
    pub fn name_of(&self, worker: usize) -> String {
        self.workers[worker].name.clone()
    }

    /// Breaks a worker's arithmetic.
    pub fn break_worker(&mut self, worker: usize, how: Fault) {
        self.workers[worker].wrong = Some(how);
        self.broken = true;
    }

    /// Starts a worker again under another name, with this credential.
    pub fn give_credential(&mut self, worker: usize, credential: &str) {
        self.born += 1;
        let given = &mut self.workers[worker];
        given.name = format!("w{}", self.born);
        given.credential = credential.to_owned();
    }

    fn kill_worker(&mut self, worker: usize) {
        self.workers.remove(worker);
        self.silent = None;
    }

    /// Submits the problem until it is accepted.
    pub async fn submit(&mut self, problem: &NewProblem) {
        for _ in 0..99 {
            let request = RequestId::new("request").expect("a good name");
            let tenant = Tenant::new("tenant").expect("a good name");
            let submitted = self.processes[0]
                .coordinator
                .submit(request, tenant, problem.clone())
                .await;
            if let Ok(accepted) = submitted {
                self.job = accepted.job;
                return;
            }
            self.crash(0);
        }
        panic!("a submission is accepted in the end");
    }

    /// The job's row.
    pub async fn row(&self) -> JobRow {
        let row = self.ledger.job(self.job).await.expect("the ledger is read");
        row.expect("the job is there")
    }

    /// Lets chance decide who does what until the job ends.
    pub async fn run(&mut self) -> JobRow {
        for _ in 0..20_000 {
            let row = self.row().await;
            if row.state.has_ended() {
                return row;
            }
            self.act().await;
            for stage in self.ledger.stages(self.job).await.expect("stages are read") {
                assert_eq!(stage.accounted(), stage.items, "{stage:?}");
            }
        }
        panic!(
            "the job does not end: {:?}",
            self.ledger.stages(self.job).await
        );
    }

    /// One thing that chance chooses.
    pub async fn act(&mut self) {
        let process = self.dice.roll(self.processes.len() as u64) as usize;
        let worker = self.dice.roll(self.workers.len() as u64) as usize;
        let cut_off = self.silent.is_some_and(|silent| silent == worker);
        match self.dice.roll(100) {
            30..90 if cut_off => {}
            0..30 => self.drive(process).await,
            30..50 => self.pull(process, worker).await,
            50..85 => self.report(process, worker).await,
            85..88 => self.report_again(process, worker).await,
            88..90 => self.give_back(process, worker).await,
            90..92 => {
                // Killed: what it had is known to nobody.
                self.kill_worker(worker);
                self.start_worker();
            }
            // Cut off: the others go on, and it comes back with what it had.
            92..93 => self.silent = self.silent.is_none().then_some(worker),
            93..95 => self.crash(process),
            _ => {
                self.clock.advance_ms(self.dice.roll(4000));
                self.expire(process).await;
            }
        }
    }

    /// One step of a coordinator's steward. A failure kills the coordinator.
    pub async fn drive(&mut self, process: usize) {
        let Process {
            who,
            drive,
            coordinator,
            ..
        } = &mut self.processes[process];
        let tools = Tools {
            ledger: &*self.ledger,
            store: &self.store,
            who,
            policy: &self.policy,
        };
        let step = async {
            if drive.is_none() {
                *drive = Drive::take(&tools, self.job).await?;
            }
            match drive {
                Some(steward) if coordinator.is_sick(self.job) => {
                    let mended = steward.mend(&tools).await?;
                    coordinator.recovers(self.job);
                    Ok(mended)
                }
                Some(steward) => steward.step(&tools).await,
                None => Ok(Driven::Waits),
            }
        };
        match step.await {
            Ok(Driven::Ended) => *drive = None,
            Ok(_) => {}
            Err(error) if error.is_fenced() => *drive = None,
            Err(_) => self.crash(process),
        }
    }

    /// A worker asks for chunks.
    pub async fn pull(&mut self, process: usize, worker: usize) {
        let asking = &mut self.workers[worker];
        asking.pulls += 1;
        let says = WorkerSeen {
            worker: WorkerId::new(asking.name.clone()).expect("a good name"),
            version: "0".into(),
            numerics_revision: cognate_numeric::NUMERICS_REVISION,
            instruction_set: "any".into(),
            threads: 1,
            lane_width: asking.width as u32,
            host: "here".into(),
            transport: "none".into(),
            draining: false,
            credential: Credential(asking.credential.clone()),
        };
        let pull = Pull {
            worker: says,
            request: RequestId::new(format!("{}.{}", asking.name, asking.pulls))
                .expect("a good name"),
            slots: 2,
            wait: Duration::ZERO,
        };
        match self.processes[process].coordinator.pull(pull).await {
            Ok(leases) => asking.leases.extend(leases),
            Err(CoordinatorError::Ledger(LedgerError::Evicted(_))) => {
                self.kill_worker(worker);
                self.start_worker();
            }
            Err(_) => self.crash(process),
        }
    }

    /// Compiled stage of a lease; an error where storage does not have its objects now.
    async fn prepare(&self, lease: &Lease) -> Result<Arc<PreparedWork>, StoreError> {
        let cached_work = {
            let prepared = self.prepared.lock().expect("nobody panics here");
            prepared.get(&lease.definition).cloned()
        };
        if let Some(stage) = cached_work {
            return Ok(stage);
        }
        let stage = self.store.stage(lease.definition).await?;
        let digest = stage.system.unwrap_or(lease.problem);
        let system: System = self.store.problem(digest).await?;
        let points = match stage.start_points.object() {
            None => None,
            Some(object) => {
                let bytes = self.store.get(object).await?;
                Some(Arc::new(
                    StoredPoints::from_bytes(&bytes).expect("they are points"),
                ))
            }
        };
        let prepared = PreparedWork::new(&system, &stage, &|_| points.clone());
        let prepared = prepared.expect("it can be prepared");
        let prepared = Arc::new(prepared);
        let mut cache = self.prepared.lock().expect("nobody panics here");
        cache.insert(lease.definition, Arc::clone(&prepared));
        Ok(prepared)
    }

    /// A worker tracks its oldest chunk and reports it.
    pub async fn report(&mut self, process: usize, worker: usize) {
        if self.workers[worker].leases.is_empty() {
            return;
        }
        let lease = self.workers[worker].leases.remove(0);
        let needed = match self.prepare(&lease).await {
            Ok(prepared) => {
                let stage = self.store.stage(lease.definition).await;
                stage.map(|stage| (prepared, stage))
            }
            Err(error) => Err(error),
        };
        let (prepared, stage) = match needed {
            Ok(needed) => needed,
            Err(error) => {
                assert!(self.lossy, "it is there: {error}");
                self.workers[worker].leases.push(lease);
                return self.give_back(process, worker).await;
            }
        };
        let items = lease.items.first..lease.items.last;
        if items
            .clone()
            .any(|item| self.deadly == Some(stage.origin(item)))
        {
            self.kill_worker(worker);
            self.start_worker();
            return;
        }
        self.tracked += lease.items.len();
        let mut results = prepared.run(items, self.workers[worker].width);
        if let Some(fault) = self.workers[worker].wrong {
            fault.spoil(&mut results);
        }
        let report = Report {
            by: speaker(&self.workers[worker].name),
            lease: lease.lease,
            results,
            cpu_micros: 1000 * lease.items.len(),
        };
        self.workers[worker].said = Some(report);
        self.report_again(process, worker).await;
    }

    /// A worker sends its last report, until it is answered.
    async fn report_again(&mut self, process: usize, worker: usize) {
        let Some(report) = self.workers[worker].said.clone() else {
            return;
        };
        for _ in 0..9 {
            let sent = self.processes[process].coordinator.complete(report.clone());
            match sent.await {
                Ok(Completion::HashDiffers) => assert!(self.broken, "paths are pure"),
                // Chunks that a broken worker computed may be done again.
                Ok(Completion::Accepted) if self.broken || self.lossy => {}
                Ok(Completion::Accepted) => self.count(&report),
                // The row was written, and the reply was lost.
                Ok(Completion::AlreadyAccepted)
                    if !self.broken && !self.lossy && !self.is_counted(&report) =>
                {
                    self.heard_again += 1;
                    self.count(&report);
                }
                Ok(Completion::Overtaken) => self.overtaken += 1,
                Ok(_) => {}
                Err(_) => {
                    self.crash(process);
                    continue;
                }
            }
            return;
        }
        panic!("a report is answered in the end");
    }

    /// Somebody sends a worker's last report again, in the worker's name and with wrong results.
    pub async fn forge_last_report(&self, process: usize, worker: usize) -> Completion {
        let said = self.workers[worker].said.clone();
        let mut report = said.expect("the worker has reported a chunk");
        report.by.session = "of somebody else".to_owned();
        Fault::Gross.spoil(&mut report.results);
        let coordinator = &self.processes[process].coordinator;
        let answer = coordinator.complete(report).await;
        answer.expect("a report that is understood")
    }

    fn is_counted(&self, report: &Report) -> bool {
        let ChunkId { stage, first, .. } = report.lease.chunk;
        self.accepted.contains(&(stage.0, first))
    }

    /// No item is accepted twice.
    fn count(&mut self, report: &Report) {
        let ChunkId { stage, first, .. } = report.lease.chunk;
        for item in first..first + report.results.len() as u64 {
            let new = self.accepted.insert((stage.0, item));
            assert!(new, "item {item} of stage {stage:?} was accepted twice");
        }
    }

    async fn give_back(&mut self, process: usize, worker: usize) {
        let leases: Vec<LeaseId> = self.workers[worker]
            .leases
            .drain(..)
            .map(|l| l.lease)
            .collect();
        let coordinator = &self.processes[process].coordinator;
        if coordinator
            .give_back(
                &leases,
                GiveBack::Drained,
                &speaker(&self.workers[worker].name),
            )
            .await
            .is_err()
        {
            self.crash(process);
        }
    }

    /// A coordinator takes back what has expired, and settles disputes.
    pub async fn expire(&mut self, process: usize) {
        let coordinator = Arc::clone(&self.processes[process].coordinator);
        match coordinator.expire().await {
            Ok(()) => {}
            Err(_) => return self.crash(process),
        }
        match coordinator.settle_disputes().await {
            Ok(struck) => self.struck += struck,
            Err(_) => self.crash(process),
        }
    }

    /// The state of the job in a process' hands.
    pub fn live_state(&self, process: usize) -> Option<Vec<u8>> {
        let drive = self.processes[process].drive.as_ref();
        drive.map(|drive| drive.steward().snapshot())
    }

    /// A coordinator of this cluster.
    pub fn coordinator(&self, process: usize) -> &Arc<Coordinator> {
        &self.processes[process].coordinator
    }

    /// The chunks of the job that have a result, with how each stage was cut.
    pub async fn finished(&self) -> BTreeMap<u32, Vec<ChunkRow>> {
        let mut finished = BTreeMap::new();
        for stage in self.ledger.stages(self.job).await.expect("stages are read") {
            let chunks = self
                .ledger
                .finished_chunks(self.job, stage.stage, 0, 10_000);
            finished.insert(stage.stage.0, chunks.await.expect("chunks are read"));
        }
        finished
    }
}
