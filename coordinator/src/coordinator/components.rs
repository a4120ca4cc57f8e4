//! Components of a finished decomposition, as clients ask for them, and the system that was decomposed.

use super::{Coordinator, CoordinatorError};
use crate::jobs::planning::{Planned, STATE};
use crate::ledger::identity::JobId;
use crate::results::answer::StoredAnswer;
use cognate_algorithms::{AnyAlgorithm, AnySolve};
use cognate_solutions::witness::Decomposition;
use cognate_systems::formats;

impl Coordinator {
    /// The components that a solved job found.
    pub async fn decomposition(&self, job: JobId) -> Result<Decomposition, CoordinatorError> {
        let digest = self.answer_of(job).await?;
        match StoredAnswer::get(&self.store, digest).await? {
            StoredAnswer::Decomposition(decomposition) => Ok(decomposition),
            other => Err(CoordinatorError::OtherAnswer {
                job,
                is: other.describe(),
            }),
        }
    }

    /// System that was decomposed, as JSON that is read as a problem, and the seed.
    pub async fn decomposed(&self, job: JobId) -> Result<(String, u64), CoordinatorError> {
        let row = self.solved(job).await?;
        let planned = Planned::from_bytes(&row.asked.options)?;
        let state = self.store.bytes_record(&STATE, planned.first_state).await?;
        let unreadable = |error: String| {
            CoordinatorError::Problem(format!("the system of job {job} cannot be read: {error}"))
        };
        let algorithm = AnyAlgorithm::restore(&state).map_err(|e| unreadable(e.to_string()))?;
        let (system, seed) = match algorithm.solve() {
            AnySolve::Decomposition(solve) => (solve.system(), solve.seed()),
            // Intersections and singular loci are questions to components.
            AnySolve::Question(solve) => (solve.system(), solve.seed()),
            _ => return Err(unreadable("it was planned as another job".into())),
        };
        let system = system.map_err(|e| unreadable(e.to_string()))?;
        let text = formats::json::write(&system).map_err(|e| unreadable(e.to_string()))?;
        Ok((text, seed))
    }
}
