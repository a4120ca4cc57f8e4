//! Marker: the file or object that says that a place holds results, and whose.
//!
//! A folder that is mounted too late, or a bucket that is not the one that was meant, has none; what is not found
//! there is not lost.

use super::addresses::{JOBS, OBJECTS};
use super::bucket;
use super::place::{BucketAddress, ResultsPlace};
use super::store::{Place, Store, StoreError};
use futures::StreamExt;
use object_store::local::LocalFileSystem;
use object_store::path::Path as Address;
use object_store::{Error, ObjectStore, ObjectStoreExt, PutMode, PutOptions, UpdateVersion};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Name of the file or object.
pub const MARKER: &str = "cognate-results";
/// Text of the marker.
const MARKED: &str = "Results of cognate. This file stays as long as they do: a coordinator takes a \
                      folder without it for one that is not mounted.\n";
/// Beginning of the marker's line that names the ledger of the results.
const OWNER: &str = "ledger ";

/// Attempts to reach a bucket when a coordinator starts.
const TRIES: u32 = 5;
/// Pause between two attempts to reach a bucket.
const PAUSE: Duration = Duration::from_secs(1);

impl Store {
    /// Opens a folder or bucket of results. With `is_new`, when the ledger knows of no results, a missing one is
    /// made; otherwise it must have its marker, or results from before there were markers.
    ///
    /// # Errors
    /// [`StoreError::Away`] where there is neither.
    pub async fn open(place: &ResultsPlace, is_new: bool) -> Result<Self, StoreError> {
        match place {
            ResultsPlace::Folder(folder) => Self::folder(folder, is_new),
            ResultsPlace::Bucket(address) => Self::bucket(address, is_new).await,
        }
    }

    /// Opens a folder of results, as [`Self::open`] does.
    pub fn folder(folder: &Path, is_new: bool) -> Result<Self, StoreError> {
        let failed = |error| StoreError::Folder {
            folder: folder.display().to_string(),
            error,
        };
        let marker = folder.join(MARKER);
        if !marker.exists() {
            let has_results = folder.join(OBJECTS).is_dir() || folder.join(JOBS).is_dir();
            if !is_new && !has_results {
                return Err(StoreError::Away(folder.display().to_string()));
            }
            std::fs::create_dir_all(folder).map_err(failed)?;
            std::fs::write(&marker, MARKED).map_err(failed)?;
        }
        // A row in the ledger may name an object only once the object is on the disk.
        let local = LocalFileSystem::new_with_prefix(folder)?.with_fsync(true);
        Ok(Self::at(Place::Folder(folder.to_owned()), Arc::new(local)))
    }

    /// Opens a bucket of results, as [`Self::open`] does. The bucket must exist. One that is not reached is waited
    /// for, some seconds long.
    async fn bucket(address: &BucketAddress, is_new: bool) -> Result<Self, StoreError> {
        let objects = bucket::open(address).map_err(|what| StoreError::Bucket {
            bucket: address.to_string(),
            what,
        })?;
        let store = Self::at(Place::Bucket(address.to_string()), objects);
        let mut tries = 1;
        loop {
            match store.is_there().await {
                Err(StoreError::Away(_))
                    if is_new || store.has_any(JOBS).await? || store.has_any(OBJECTS).await? =>
                {
                    store.mark().await?;
                    return Ok(store);
                }
                Err(error @ StoreError::Bucket { .. }) if tries < TRIES => {
                    tracing::warn!(%error, "waiting for the results");
                    tries += 1;
                    tokio::time::sleep(PAUSE).await;
                }
                there => return there.map(|()| store),
            }
        }
    }

    async fn mark(&self) -> Result<(), StoreError> {
        let create = PutOptions::from(PutMode::Create);
        match self
            .objects
            .put_opts(&marker(), MARKED.into(), create)
            .await
        {
            // Another coordinator began at the same time.
            Ok(_) | Err(Error::AlreadyExists { .. }) => Ok(()),
            Err(error) => Err(self.unusable(&error)),
        }
    }

    /// Whether there are results of jobs.
    pub async fn has_results(&self) -> Result<bool, StoreError> {
        self.has_any(JOBS).await
    }

    async fn has_any(&self, folder: &str) -> Result<bool, StoreError> {
        let first = self.objects.list(Some(&folder.into())).next().await;
        let first = first.transpose().map_err(|error| self.unusable(&error))?;
        Ok(first.is_some())
    }

    /// An error where the place of the results is not there, or is another.
    pub async fn is_there(&self) -> Result<(), StoreError> {
        match &self.place {
            Place::Bucket(bucket) => match self.objects.head(&marker()).await {
                Ok(_) => Ok(()),
                Err(Error::NotFound { .. }) => Err(StoreError::Away(bucket.clone())),
                Err(error) => Err(self.unusable(&error)),
            },
            Place::Memory | Place::Folder(_) => self.is_mounted(),
        }
    }

    /// An error where the folder of the results is not there: a write would make the folder where another is to be
    /// mounted. Nobody makes buckets by writing to them.
    pub(super) fn is_mounted(&self) -> Result<(), StoreError> {
        match &self.place {
            Place::Folder(folder) if !folder.join(MARKER).exists() => {
                Err(StoreError::Away(folder.display().to_string()))
            }
            _ => Ok(()),
        }
    }

    fn unusable(&self, error: &Error) -> StoreError {
        StoreError::Bucket {
            bucket: self.place.to_string(),
            what: bucket::cause(error),
        }
    }

    /// Whether nobody has said yet whose results these are; an error where they are not those of the ledger of
    /// this name. What lives in memory is its process's.
    pub async fn belongs_to(&self, ledger: Option<&str>) -> Result<bool, StoreError> {
        if self.place == Place::Memory {
            return Ok(false);
        }
        let foreign = |why: &str| StoreError::Foreign(format!("{} {why}", self.place));
        let Some(ledger) = ledger else {
            return Err(foreign("outlives this ledger, which ends with its process"));
        };
        self.is_there().await?;
        let text = self.objects.get(&marker()).await?.bytes().await?;
        let text = String::from_utf8_lossy(&text);
        match text.lines().find_map(|line| line.strip_prefix(OWNER)) {
            None => Ok(true),
            Some(owner) if owner == ledger => Ok(false),
            Some(owner) => Err(foreign(&format!(
                "holds the results of the ledger {owner}, and this one is {ledger}"
            ))),
        }
    }

    /// Says whose results these are, for good.
    pub async fn give_to(&self, ledger: &str) -> Result<(), StoreError> {
        let mode = match &self.place {
            Place::Memory => return Ok(()),
            Place::Folder(_) => PutMode::Overwrite,
            Place::Bucket(_) => {
                // Of two ledgers that say so at once, one does.
                let metadata = self.objects.head(&marker()).await?;
                PutMode::Update(UpdateVersion {
                    e_tag: metadata.e_tag,
                    version: metadata.version,
                })
            }
        };
        let text = format!("{MARKED}{OWNER}{ledger}\n");
        let options = PutOptions::from(mode);
        self.objects
            .put_opts(&marker(), text.into(), options)
            .await?;
        Ok(())
    }
}

fn marker() -> Address {
    Address::from(MARKER)
}
