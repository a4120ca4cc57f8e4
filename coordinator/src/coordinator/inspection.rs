//! Inspection: finds objects that the ledger names and that are missing or damaged, and objects that it does not
//! name.
//!
//! `cognate fsck` uses it on the ledger and the folder of a service, running or not. Rows are read after the folder
//! was listed, and an object that a coordinator writes or removes meanwhile is read again before it is reported as
//! missing.

use super::{Coordinator, CoordinatorError};
use crate::jobs::planning::Planned;
use crate::ledger::LedgerError;
use crate::ledger::identity::JobId;
use crate::ledger::rows::{JobRow, ResultObject, StageRow};
use crate::results::store::StoreError;
use crate::results::trash::Amount;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::{Stage, StageId};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::Duration;

/// A file that a writer has not finished after this time was left by one that was killed.
const UNFINISHED: Duration = Duration::from_secs(3600);

/// An object that a row names and that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The job whose row names it; another one may, too.
    pub job: JobId,
    /// Description of the object: a summary, for instance.
    pub is: &'static str,
    /// Error of the store: missing or damaged, with the address.
    pub what: String,
    /// The object does not exist; otherwise its content is not the content that was written.
    pub missing: bool,
    /// A coordinator has the paths tracked again by itself, while the job goes on.
    pub tracked_again: bool,
    /// The object is the results of this chunk of a stage that nobody tracks any more: a repair tracks it again.
    pub lost_chunk: Option<(StageId, ResultObject)>,
}

/// Outcome of an inspection.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inspection {
    /// Number of jobs in the ledger.
    pub jobs: u64,
    /// Number of objects that rows name, each once, good ones and others.
    pub checked: u64,
    /// Objects that cannot be read.
    pub faults: Vec<Fault>,
    /// Objects that nothing names, and late results of jobs that have ended; `None` where an object is lost
    /// that would say what a job names.
    pub unnamed: Option<Amount>,
    /// Objects in the trash.
    pub trash: Amount,
    /// Jobs that are deleted, and whose results are still there.
    pub deleted_jobs: Vec<JobId>,
    /// Jobs of which there are results, and which the ledger neither knows nor has deleted.
    pub unknown_jobs: Vec<JobId>,
    /// Files of writers that were killed, with their sizes in bytes.
    pub unfinished: Vec<(PathBuf, u64)>,
}

impl Inspection {
    /// Whether all that the rows name is there and whole.
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }
}

/// Digests and faults that the inspection has seen so far.
#[derive(Default)]
struct Seen {
    digests: BTreeSet<Digest>,
    found: Inspection,
}

impl Coordinator {
    /// Looks at everything; changes nothing.
    pub async fn inspect(&self) -> Result<Inspection, CoordinatorError> {
        let with_results = self.store.jobs_with_results().await?;
        let listed: BTreeMap<Digest, u64> = self.store.objects().await?.into_iter().collect();
        let mut seen = Seen::default();
        for trashed in self.store.in_trash().await? {
            seen.found.trash += Amount::one(trashed.bytes);
        }
        for row in self.ledger.jobs(u32::MAX).await? {
            match self.inspect_job(&row, &mut seen).await {
                // Somebody has deleted it meanwhile.
                Err(CoordinatorError::Ledger(LedgerError::UnknownJob(_))) => {}
                done => done?,
            }
            seen.found.jobs += 1;
        }
        let mut inspection = seen.found;
        let mut unnamed = Amount::default();
        let objects = match self.unnamed(listed.keys().copied().collect()).await {
            Err(CoordinatorError::Plan(_)) => None,
            Err(CoordinatorError::Store(error)) if error.is_loss() => None,
            objects => Some(objects?),
        };
        for digest in objects.iter().flatten() {
            unnamed += Amount::one(listed[digest]);
        }
        for job in with_results {
            match self.ledger.job(job).await? {
                Some(row) if row.state.has_ended() => {
                    for (_, bytes) in self.late_results(job).await? {
                        unnamed += Amount::one(bytes);
                    }
                }
                Some(_) => {}
                None if self.ledger.is_deleted(job).await? => inspection.deleted_jobs.push(job),
                None => inspection.unknown_jobs.push(job),
            }
        }
        inspection.unnamed = objects.map(|_| unnamed);
        inspection.unfinished = self.store.unfinished_files(UNFINISHED);
        Ok(inspection)
    }

    async fn inspect_job(&self, row: &JobRow, seen: &mut Seen) -> Result<(), CoordinatorError> {
        let planned = Planned::from_bytes(&row.asked.options);
        if let Err(error) = &planned {
            seen.found.faults.push(Fault {
                job: row.job,
                is: "the plan",
                what: error.to_string(),
                missing: false,
                tracked_again: false,
                lost_chunk: None,
            });
        }
        let planned = planned.ok();
        let objects = [
            ("the submitted problem", planned.as_ref().map(|p| p.problem)),
            ("the problem", Some(row.asked.problem)),
            ("the first state", planned.as_ref().map(|p| p.first_state)),
            ("the state", row.snapshot),
            ("the solutions", row.solutions),
            ("the summary", row.summary),
        ];
        for (is, digest) in objects {
            if let Some(digest) = digest {
                self.inspect_object(row, is, digest, seen).await?;
            }
        }
        for stage in self.ledger.stages(row.job).await? {
            let definition = stage.definition;
            self.inspect_object(row, "a stage", definition, seen)
                .await?;
            let Ok(read) = self.store.stage(definition).await else {
                continue;
            };
            for (is, digest) in [
                ("the system of a stage", read.system),
                ("start points", read.start_points.object()),
            ] {
                if let Some(digest) = digest {
                    self.inspect_object(row, is, digest, seen).await?;
                }
            }
            self.inspect_results(row, &stage, &read, seen).await?;
        }
        Ok(())
    }

    async fn inspect_object(
        &self,
        row: &JobRow,
        is: &'static str,
        digest: Digest,
        seen: &mut Seen,
    ) -> Result<(), CoordinatorError> {
        if !seen.digests.insert(digest) {
            return Ok(());
        }
        seen.found.checked += 1;
        if let Some(fault) = self.judge(row, is, self.store.get(digest).await).await? {
            seen.found.faults.push(fault);
        }
        Ok(())
    }

    async fn inspect_results(
        &self,
        row: &JobRow,
        stage: &StageRow,
        read: &Stage,
        seen: &mut Seen,
    ) -> Result<(), CoordinatorError> {
        let mut from = 0;
        while let Some((next, objects)) = self.named_page(row.job, stage.stage, from).await? {
            from = next;
            for object in objects {
                seen.found.checked += 1;
                let results = self.store.results(&object, read.work).await;
                let Some(fault) = self.judge(row, "results of a chunk", results).await? else {
                    continue;
                };
                let tracked_again = !row.state.has_ended() && !stage.closed;
                seen.found.faults.push(Fault {
                    tracked_again,
                    lost_chunk: (!tracked_again).then_some((stage.stage, object)),
                    ..fault
                });
            }
        }
        Ok(())
    }

    /// Fault of an object that the store has lost; `None` where the object can be read or the job has been deleted
    /// meanwhile.
    async fn judge<T>(
        &self,
        row: &JobRow,
        is: &'static str,
        read: Result<T, StoreError>,
    ) -> Result<Option<Fault>, CoordinatorError> {
        match read {
            Ok(_) => Ok(None),
            Err(error) if error.is_loss() => {
                let is_there = self.ledger.job(row.job).await?.is_some();
                Ok(is_there.then(|| Fault {
                    job: row.job,
                    is,
                    what: error.to_string(),
                    missing: matches!(error, StoreError::Missing(_)),
                    tracked_again: false,
                    lost_chunk: None,
                }))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Tracks the chunks again whose results an inspection found lost and nobody else tracks: paths are pure, so that
    /// the results are those that were lost, or are not kept. How many are there again.
    pub async fn track_lost_chunks(
        &self,
        inspection: &Inspection,
    ) -> Result<u64, CoordinatorError> {
        let mut tracked = 0;
        for fault in &inspection.faults {
            let Some((stage, object)) = &fault.lost_chunk else {
                continue;
            };
            match self.track_lost_chunk(fault.job, *stage, object).await {
                Ok(true) => tracked += 1,
                Ok(false) => tracing::warn!(job = %fault.job, object = object.address,
                    "the paths give other results here than those that are lost: they stay lost"),
                Err(error) => tracing::warn!(job = %fault.job, object = object.address, %error,
                    "the results stay lost"),
            }
        }
        Ok(tracked)
    }

    async fn track_lost_chunk(
        &self,
        job: JobId,
        stage: StageId,
        object: &ResultObject,
    ) -> Result<bool, CoordinatorError> {
        let stage = self.stage(job, stage).await?;
        let prepared = self.prepared(job, &stage).await?;
        let items = object.items;
        let track = move || prepared.run(items.first..items.last, prepared.preferred_width());
        let tracked = tokio::task::spawn_blocking(track).await;
        let results = tracked.map_err(|error| CoordinatorError::Problem(error.to_string()))?;
        Ok(self.store.put_results_again(object, &results).await?)
    }

    /// Removes what an inspection found that no row names; what a running service may be about to name only goes
    /// into the trash. Gives how much went, or nothing where no job of the folder is this ledger's.
    pub async fn repair(&self, inspection: &Inspection) -> Result<Amount, CoordinatorError> {
        let unknown = match inspection.jobs {
            0 => inspection.unknown_jobs.len() as u64,
            _ => 0,
        };
        self.claim_results(unknown).await?;
        let mut removed = Amount::default();
        for job in inspection
            .unknown_jobs
            .iter()
            .chain(&inspection.deleted_jobs)
        {
            if self.ledger.job(*job).await?.is_none() {
                removed += self.store.remove_results_of(*job).await?;
            }
        }
        for (file, bytes) in &inspection.unfinished {
            // The file may be gone because the writer has finished it.
            if std::fs::remove_file(file).is_ok() {
                removed += Amount::one(*bytes);
            }
        }
        let collected = self.collect().await?;
        removed += collected.results;
        removed += collected.removed;
        Ok(removed)
    }
}
