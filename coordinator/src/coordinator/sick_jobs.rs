//! Sick jobs: those whose stages no worker could fetch, as storage has lost an object that they need.
//!
//! Marks of jobs and stages; `stage_objects` sets them.

use crate::ledger::identity::JobId;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::StageId;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::Instant;

/// Time for which no chunk of a sick job is leased. Afterwards its stages are checked again, as another coordinator
/// may have mended them.
const SICK: Duration = Duration::from_secs(15);
/// Stages whose objects are remembered as readable.
const MOST_CHECKED: usize = 4096;

/// Jobs whose objects are lost, and stages whose objects were found.
#[derive(Debug, Default)]
pub struct SickJobs(Mutex<Marks>);

#[derive(Debug, Default)]
struct Marks {
    /// Time until which no chunk of a job is leased.
    sick: HashMap<JobId, Instant>,
    /// Objects of the stages whose chunks may be leased.
    checked: HashMap<(JobId, StageId), Vec<Digest>>,
}

impl SickJobs {
    fn lock(&self) -> MutexGuard<'_, Marks> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The jobs of which nothing is given out.
    pub fn jobs(&self) -> Vec<JobId> {
        let mut marks = self.lock();
        marks.sick.retain(|_, until| Instant::now() < *until);
        marks.sick.keys().copied().collect()
    }

    /// Whether the objects of a stage were read.
    pub fn is_checked(&self, job: JobId, stage: StageId) -> bool {
        self.lock().checked.contains_key(&(job, stage))
    }

    /// The objects of a stage were read.
    pub fn check(&self, job: JobId, stage: StageId, objects: Vec<Digest>) {
        let mut marks = self.lock();
        if marks.checked.len() >= MOST_CHECKED {
            marks.checked.clear();
        }
        marks.checked.insert((job, stage), objects);
    }

    /// The objects of a job are to be read again.
    pub fn uncheck(&self, job: JobId) {
        let mut marks = self.lock();
        marks
            .checked
            .retain(|(marked_job, _), _| *marked_job != job);
    }

    /// Objects of a job are lost.
    pub fn falls_sick(&self, job: JobId) {
        let mut marks = self.lock();
        marks.sick.insert(job, Instant::now() + SICK);
        marks
            .checked
            .retain(|(marked_job, _), _| *marked_job != job);
    }

    /// Whether the steward is to look after the job.
    pub fn is_sick(&self, job: JobId) -> bool {
        self.lock().sick.contains_key(&job)
    }

    /// The steward has looked after the job.
    pub fn recovers(&self, job: JobId) {
        self.lock().sick.remove(&job);
    }

    /// An object that somebody asked for is lost: what needs it is looked at again.
    pub fn forget(&self, object: Digest) {
        let mut marks = self.lock();
        marks.checked.retain(|_, needs| !needs.contains(&object));
    }
}
