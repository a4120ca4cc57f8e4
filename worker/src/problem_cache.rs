//! Problem cache: what was made of the stages that this worker has met lately.
//!
//! A stage is fetched, checked and compiled once, however many of its chunks
//! arrive together; the least recently used one makes room for a new one.

use crate::chunk_runner::ChunkTracker;
use crate::transport::{Lease, Transport, TransportError};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_systems::system::System;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::OnceCell;

/// Why there is no tracker for a chunk.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PrepareFailure {
    /// An object that the chunk needs could not be fetched now.
    #[error(transparent)]
    Unavailable(TransportError),
    /// The chunk cannot be tracked here, now or later.
    #[error("{0}")]
    Untrackable(String),
}

impl From<TransportError> for PrepareFailure {
    fn from(error: TransportError) -> Self {
        match error {
            // A missing object is a fault of the storage, and may be mended.
            TransportError::Unavailable(_) | TransportError::Refused(_) => Self::Unavailable(error),
            TransportError::Malformed(text) => Self::Untrackable(text),
        }
    }
}

/// A stage that is ready to be tracked, or the reason why it never will be.
type Prepared = Result<Arc<dyn ChunkTracker>, String>;

/// The most recently used few of something.
struct Recent<K, V> {
    capacity: usize,
    /// The most recently used last.
    entries: Vec<(K, Arc<OnceCell<V>>)>,
}

impl<K: PartialEq, V> Recent<K, V> {
    fn new(capacity: usize) -> Self {
        Self {
            capacity: capacity.max(1),
            entries: Vec::new(),
        }
    }

    /// The cell of this key, perhaps still empty.
    fn cell(&mut self, key: K) -> Arc<OnceCell<V>> {
        let position = self
            .entries
            .iter()
            .position(|(cached_key, _)| *cached_key == key);
        let entry = match position {
            Some(place) => self.entries.remove(place),
            None => {
                if self.entries.len() >= self.capacity {
                    self.entries.remove(0);
                }
                (key, Arc::default())
            }
        };
        let cell = Arc::clone(&entry.1);
        self.entries.push(entry);
        cell
    }
}

/// Prepared stages and the systems they belong to.
pub struct ProblemCache {
    systems: Mutex<Recent<Digest, Arc<System>>>,
    stages: Mutex<Recent<(Digest, Digest), Prepared>>,
}

impl ProblemCache {
    /// Keeps up to `capacity` stages.
    pub fn new(capacity: usize) -> Self {
        Self {
            systems: Mutex::new(Recent::new(capacity)),
            stages: Mutex::new(Recent::new(capacity)),
        }
    }

    /// The tracker of a chunk's stage, made now if need be.
    pub async fn tracker(
        &self,
        transport: &dyn Transport,
        lease: &Lease,
    ) -> Result<Arc<dyn ChunkTracker>, PrepareFailure> {
        let key = (lease.problem, lease.stage);
        let cell = lock(&self.stages).cell(key);
        let prepared = cell.get_or_try_init(|| self.prepare(transport, lease));
        prepared.await?.clone().map_err(PrepareFailure::Untrackable)
    }

    async fn prepare(
        &self,
        transport: &dyn Transport,
        lease: &Lease,
    ) -> Result<Prepared, PrepareFailure> {
        let stage = transport.stage(&lease.id.job, lease.id.stage).await?;
        // A stage may be of a system that was made for it.
        let digest = stage.system.unwrap_or(lease.problem);
        let cell = lock(&self.systems).cell(digest);
        let fetch = || async { transport.system(digest).await.map(Arc::new) };
        let system = Arc::clone(cell.get_or_try_init(fetch).await?);
        let points = match stage.start_points.object() {
            Some(object) => Some((object, Arc::new(transport.points(object).await?))),
            None => None,
        };
        // Compiling may take seconds: not on the threads that talk to the coordinator.
        let compile = move || {
            let find = |wanted: Digest| -> Option<Arc<StoredPoints>> {
                let start_points = points.as_ref().filter(|(object, _)| *object == wanted);
                start_points.map(|(_, points)| Arc::clone(points))
            };
            PreparedWork::new(&system, &stage, &find)
        };
        // A compile error is cached; an object that could not be fetched is requested again.
        Ok(match tokio::task::spawn_blocking(compile).await {
            Ok(Ok(prepared)) => Ok(Arc::new(prepared)),
            Ok(Err(error)) => Err(error.to_string()),
            Err(panic) => Err(panic.to_string()),
        })
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ChunkTracker for PreparedWork {
    fn track(&self, items: Range<u64>, width: usize) -> Vec<ItemResult> {
        self.run(items, width)
    }

    fn items(&self) -> u64 {
        PreparedWork::items(self)
    }

    fn preferred_width(&self) -> usize {
        PreparedWork::preferred_width(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recently_used_makes_room() {
        let mut recent = Recent::<u32, u32>::new(2);
        for key in [1, 2] {
            recent.cell(key).set(key).unwrap();
        }
        assert!(recent.cell(1).initialized());
        assert!(!recent.cell(3).initialized(), "new; 2 had to go");
        assert!(recent.cell(1).initialized());
        assert!(!recent.cell(2).initialized());
    }
}
