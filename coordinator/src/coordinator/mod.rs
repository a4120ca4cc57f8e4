//! Coordinator: everything that the services call, without sockets and messages.
//!
//! Any number of coordinators may share a ledger and a store; each answers any
//! client and any worker, and drives the jobs that no other drives.

mod answers;
mod arbitration;
mod changes;
mod components;
pub mod conduct;
mod error;
pub mod inspection;
mod large_answer;
mod limited_submission;
mod mixed_cells;
mod recorded;
pub mod removal;
mod result_check;
mod run;
mod sick_jobs;
#[cfg(test)]
pub(crate) mod simulation;
mod stage_objects;
mod standing_still;
pub mod submission_limits;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_audits;
#[cfg(test)]
mod tests_of_counting;
#[cfg(test)]
mod tests_of_decomposition;
#[cfg(test)]
mod tests_of_limits;
#[cfg(test)]
mod tests_of_removal;
#[cfg(test)]
mod tests_of_storage;
#[cfg(test)]
mod tests_of_upgrades;
mod work;

pub use answers::{ClassifiedPath, Explanation};
pub use error::CoordinatorError;
pub use large_answer::Answered;
pub use work::{Pull, Report};

use self::changes::Changes;
use self::conduct::Conduct;
use self::sick_jobs::SickJobs;
use self::submission_limits::SubmissionLimits;
use crate::chunks::audit::AuditKey;
use crate::chunks::leasing::Policy;
use crate::chunks::losses::Losses;
use crate::chunks::plausibility::EndCheck;
use crate::health::Health;
use crate::jobs::planning::{Planned, STATE, plan_job};
use crate::jobs::planning_queue::PlanningQueue;
use crate::ledger::identity::{CoordinatorId, JobId, RequestId, Tenant, WorkerId};
use crate::ledger::rows::{Cancelled, JobState, NewJob, WorkerSeen};
use crate::ledger::{Ledger, LedgerError};
use crate::measures::ChunkEvents;
use crate::recent::Recent;
use crate::results::store::{Store, StoreError};
use crate::results::upload::Upload;
use bytes::Bytes;
use cognate_continuation::prepared_check::PreparedCheck;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::{Stage, StageId};
use cognate_numeric::NUMERICS_REVISION;
use cognate_protocol::submission::{Options, StartSolutions};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex};
use tokio::sync::Notify;

/// Systems, stages and solutions that are kept decoded.
const KEPT: usize = 64;

/// Stages that are kept ready for checks; each holds its compiled program and its start points. As many as small jobs
/// that report in turns.
const KEPT_CHECKS: usize = 32;

/// Stages that are kept ready because the coordinator itself computes some of their items, which is rare.
const KEPT_PREPARED: usize = 4;

/// A problem that passed the checks: the system and the resolved options.
#[derive(Clone, Debug, PartialEq)]
pub struct NewProblem {
    /// The system, with the groups and conjugates of the options.
    pub system: System,
    /// The options; settings and seed are named.
    pub options: Options,
    /// Start solutions that were sent along: the object that the options name.
    pub start_solutions: Option<Bytes>,
    /// Warnings about parts of the problem that are ignored.
    pub warnings: Vec<String>,
}

/// Outcome of a submission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The job.
    pub job: JobId,
    /// False when the same request had made it before.
    pub is_new: bool,
    /// Warnings about the problem, for people.
    pub warnings: Vec<String>,
}

/// One coordinator process.
pub struct Coordinator {
    ledger: Arc<dyn Ledger>,
    store: Store,
    who: CoordinatorId,
    policy: Policy,
    /// Recent failures of workers.
    conduct: Conduct,
    /// State of ledger and store: whether they can be used.
    health: Health,
    /// Times at which workers were lost with chunks in hand.
    losses: Mutex<Losses>,
    /// Counts of the events of chunks.
    events: ChunkEvents,
    /// Lock under which submissions with limits are written one at a time.
    limited: tokio::sync::Mutex<()>,
    /// Secret of the ledger's audits, once it was read.
    audit_key: tokio::sync::OnceCell<AuditKey>,
    /// Lock under which the coordinator computes items itself, one at a time.
    arbitration: tokio::sync::Mutex<()>,
    /// Problems that are read and planned, or wait for it.
    planning: PlanningQueue,
    /// Something may be leased that could not be before.
    work: Notify,
    /// Wakes those who watch a job when the job changes.
    changes: Changes,
    /// Jobs that this coordinator drives.
    drives: Mutex<HashMap<JobId, Arc<Notify>>>,
    /// A job may want a steward.
    unattended: Notify,
    /// Last description of each worker, and the time at which it was written.
    seen: Mutex<HashMap<WorkerId, (WorkerSeen, i64)>>,
    /// Session in which each worker asked for work last.
    sessions: Mutex<HashMap<WorkerId, String>>,
    /// Session of each worker that left last.
    left: Mutex<HashMap<WorkerId, String>>,
    systems: Recent<Digest, System>,
    stages: Recent<Digest, Stage>,
    /// Checks of the ends of a stage's paths; `None` where a stage has none.
    end_checks: Recent<(JobId, StageId), Option<EndCheck>>,
    /// Stages whose results this coordinator checks; each is compiled once.
    prepared_checks: Recent<(JobId, StageId), tokio::sync::OnceCell<Arc<PreparedCheck>>>,
    /// Stages whose items this coordinator computes itself after a doubt or a dispute.
    prepared: Recent<(JobId, StageId), tokio::sync::OnceCell<Arc<PreparedWork>>>,
    definitions: Recent<(JobId, StageId), Digest>,
    solutions: Recent<Digest, Vec<SolutionSet>>,
    /// Mixed cells of each finished chunk, by its first item, for stages that count mixed cells.
    cells: Recent<(JobId, StageId), HashMap<u64, u64>>,
    /// Jobs whose objects are lost.
    sick: SickJobs,
    /// Jobs that have ended, whose late results were looked for.
    tidied: Mutex<HashSet<JobId>>,
}

impl Coordinator {
    /// A coordinator on this ledger and store. [`Self::run`] does what must be done by itself.
    pub fn new(
        ledger: Arc<dyn Ledger>,
        store: Store,
        who: CoordinatorId,
        policy: Policy,
    ) -> Arc<Self> {
        Arc::new(Self {
            ledger,
            store,
            who,
            conduct: Conduct::new(policy.conduct),
            health: Health::default(),
            losses: Mutex::default(),
            events: ChunkEvents::default(),
            limited: tokio::sync::Mutex::default(),
            audit_key: tokio::sync::OnceCell::new(),
            arbitration: tokio::sync::Mutex::default(),
            planning: PlanningQueue::new(policy.planning),
            policy,
            work: Notify::new(),
            changes: Changes::default(),
            drives: Mutex::default(),
            unattended: Notify::new(),
            seen: Mutex::default(),
            sessions: Mutex::default(),
            left: Mutex::default(),
            systems: Recent::new(KEPT),
            stages: Recent::new(KEPT),
            end_checks: Recent::new(KEPT),
            prepared_checks: Recent::new(KEPT_CHECKS),
            prepared: Recent::new(KEPT_PREPARED),
            definitions: Recent::new(64 * KEPT),
            solutions: Recent::new(4),
            cells: Recent::new(KEPT),
            sick: SickJobs::default(),
            tidied: Mutex::default(),
        })
    }

    /// The numbers that it goes by.
    pub fn policy(&self) -> &Policy {
        &self.policy
    }

    /// The ledger.
    pub fn ledger(&self) -> &dyn Ledger {
        &*self.ledger
    }

    /// Why a worker gets no chunk now, in words.
    pub fn put_aside(&self, worker: &WorkerId) -> Option<String> {
        self.conduct.refusal(worker, tokio::time::Instant::now())
    }

    /// Whether ledger and store can be used.
    pub fn health(&self) -> &Health {
        &self.health
    }

    /// Counts of the events of chunks at this coordinator.
    pub fn events(&self) -> &ChunkEvents {
        &self.events
    }

    /// Looks whether ledger and store can be used.
    pub async fn examine(&self) {
        self.health.examine(&*self.ledger, &self.store).await;
    }

    /// Queue that limits the reading and planning of problems.
    pub fn planning(&self) -> &PlanningQueue {
        &self.planning
    }

    /// The store of objects.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Makes a job of a problem. The same request sent again is the same job.
    pub async fn submit(
        &self,
        request: RequestId,
        tenant: Tenant,
        problem: NewProblem,
    ) -> Result<Accepted, CoordinatorError> {
        let unlimited = SubmissionLimits::default();
        self.submit_within(request, tenant, problem, unlimited)
            .await
    }

    /// Makes a job of a problem, within the limits of its tenant. The same request sent again is the same job.
    pub async fn submit_within(
        &self,
        request: RequestId,
        tenant: Tenant,
        problem: NewProblem,
        limits: SubmissionLimits,
    ) -> Result<Accepted, CoordinatorError> {
        let _naming = self.store.naming().begin();
        // The limits are checked before the long work, and again when the number of paths is known.
        self.check_limits(&request, &tenant, limits, 0).await?;
        let NewProblem {
            system,
            options,
            start_solutions,
            warnings,
        } = problem;
        let start_solutions = match (&options.start_solutions, start_solutions) {
            (Some(StartSolutions::Object(object)), Some(bytes)) => {
                if self.store.put(bytes.clone()).await? != *object {
                    return Err(CoordinatorError::Problem(
                        "the start solutions are not the object that the options name".into(),
                    ));
                }
                Some(bytes)
            }
            (Some(StartSolutions::Object(object)), None) => match self.store.get(*object).await {
                Err(error @ StoreError::Missing(_)) => {
                    return Err(CoordinatorError::Problem(format!(
                        "the start solutions are not here, and are to be uploaded first: {error}"
                    )));
                }
                read => Some(read?),
            },
            (Some(StartSolutions::Points(_)), _) => {
                return Err(CoordinatorError::Problem(
                    "start solutions must be an object when a job is made of them".into(),
                ));
            }
            (None, _) => None,
        };
        // Counting the paths of some starts takes long: it has its turn, and its time.
        let counting_operations = self.policy.counting_operations;
        let (system, options) = (Arc::new(system), Arc::new(options));
        let plan = {
            let (system, options) = (Arc::clone(&system), Arc::clone(&options));
            self.planning.plan(move || {
                let start_solutions = start_solutions.as_deref();
                plan_job(&system, &options, start_solutions, counting_operations)
            })
        };
        let plan = plan.await??;
        let planned = Planned {
            name: options.name.clone(),
            problem: self.store.put_problem(&system).await?,
            variables: system.variable_count() as u64,
            equations: system.equation_count() as u64,
            start: plan.start.to_string(),
            why: plan.why.clone(),
            paths: plan.paths,
            seed: options.seed.unwrap_or_default(),
            first_state: self
                .store
                .put_record(&STATE, plan.algorithm.snapshot())
                .await?,
            warnings: warnings.clone(),
        };
        let job = NewJob {
            tenant,
            label: options.name.clone(),
            problem: self.store.put_problem(&plan.system).await?,
            options: planned.to_bytes(),
            numerics_revision: NUMERICS_REVISION,
        };
        let _turn = match limits.is_any() {
            true => Some(self.limited.lock().await),
            false => None,
        };
        let paths = planned.paths.unwrap_or(0);
        self.check_limits(&request, &job.tenant, limits, paths)
            .await?;
        let submitted = self.ledger.submit(request, job).await?;
        if submitted.is_new {
            tracing::info!(job = %submitted.job, name = planned.name, start = planned.start,
                paths = ?planned.paths, "a job is submitted");
        }
        self.unattended.notify_one();
        self.changed(submitted.job);
        Ok(Accepted {
            job: submitted.job,
            is_new: submitted.is_new,
            warnings,
        })
    }

    /// Ends a job; its state afterwards.
    pub async fn cancel(&self, job: JobId, reason: &str) -> Result<JobState, CoordinatorError> {
        let cancelled = self.ledger.cancel(job, reason).await?;
        tracing::info!(%job, reason, ?cancelled, "a job is cancelled");
        self.wake_steward(job);
        self.changed(job);
        Ok(match cancelled {
            Cancelled::Now => JobState::Cancelled,
            Cancelled::HadEnded(state) => state,
        })
    }

    /// Begins an upload of a client: start solutions, whose bytes come in pieces.
    pub async fn begin_upload(&self) -> Result<Upload, CoordinatorError> {
        Ok(self.store.begin_upload().await?)
    }

    /// The bytes of an object.
    pub async fn object(&self, digest: Digest) -> Result<Bytes, CoordinatorError> {
        Ok(self.heed_loss(digest, self.store.get(digest).await)?)
    }

    /// The system of a problem.
    pub async fn problem(&self, digest: Digest) -> Result<Arc<System>, CoordinatorError> {
        Ok(self.read_problem(digest).await?)
    }

    async fn read_problem(&self, digest: Digest) -> Result<Arc<System>, StoreError> {
        if let Some(system) = self.systems.get(&digest) {
            return Ok(system);
        }
        let read = self.heed_loss(digest, self.store.problem(digest).await);
        let system = Arc::new(read?);
        self.systems.keep(digest, Arc::clone(&system));
        Ok(system)
    }

    /// A stage of a job.
    pub async fn stage(&self, job: JobId, stage: StageId) -> Result<Arc<Stage>, CoordinatorError> {
        let digest = match self.definitions.get(&(job, stage)) {
            Some(digest) => *digest,
            None => {
                let rows = self.ledger.stages(job).await?;
                let row = rows.iter().find(|row| row.stage == stage);
                let digest = row
                    .ok_or(CoordinatorError::UnknownStage { job, stage })?
                    .definition;
                self.definitions.keep((job, stage), Arc::new(digest));
                digest
            }
        };
        Ok(self.stage_of(digest).await?)
    }

    pub(super) async fn stage_of(&self, definition: Digest) -> Result<Arc<Stage>, StoreError> {
        if let Some(stage) = self.stages.get(&definition) {
            return Ok(stage);
        }
        let read = self.heed_loss(definition, self.store.stage(definition).await);
        let stage = Arc::new(read?);
        self.stages.keep(definition, Arc::clone(&stage));
        Ok(stage)
    }

    /// Clients may see something else of this job now.
    fn changed(&self, job: JobId) {
        self.changes.happened(job);
    }

    fn wake_steward(&self, job: JobId) {
        let drives = self.drives();
        if let Some(wake) = drives.get(&job) {
            wake.notify_one();
        }
    }

    fn drives(&self) -> std::sync::MutexGuard<'_, HashMap<JobId, Arc<Notify>>> {
        self.drives
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The row of a job that must exist.
async fn job_row(
    ledger: &dyn Ledger,
    job: JobId,
) -> Result<crate::ledger::rows::JobRow, CoordinatorError> {
    let row = ledger.job(job).await?;
    Ok(row.ok_or(LedgerError::UnknownJob(job))?)
}
