//! Trash: objects by digest that nothing names any more, on their way out; and all that a store holds, by name.
//!
//! The ledger names an object a moment after it is written, and an object that exists is not written again. So
//! nothing is removed at once: an object is put into the trash, where it is still read, and a writer that needs it
//! writes it anew. An object that is named after all is taken back; the others are removed after a grace period. Each
//! step is one renaming or one removal, so that a coordinator may be killed between any two. In a bucket a renaming
//! is a copy and a removal.

use super::addresses::{JOBS, OBJECTS, TRASH, Trashed, digest_in, object_address};
use super::store::{Place, Store, StoreError, was_there};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::JobId;
use bytes::Bytes;
use cognate_continuation::start_points::Digest;
use futures::TryStreamExt;
use object_store::path::Path as Address;
use object_store::{ObjectStore, ObjectStoreExt};
use std::ops::AddAssign;
use std::path::{Path, PathBuf};

/// How many objects, and their bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// Number of objects.
    pub objects: u64,
    /// Bytes that they take.
    pub bytes: u64,
}

impl AddAssign for Amount {
    fn add_assign(&mut self, other: Self) {
        self.objects += other.objects;
        self.bytes += other.bytes;
    }
}

impl Amount {
    /// One object of this size.
    pub fn one(bytes: u64) -> Self {
        Self { objects: 1, bytes }
    }
}

impl Store {
    /// All objects by digest, and their sizes in bytes.
    pub async fn objects(&self) -> Result<Vec<(Digest, u64)>, StoreError> {
        let objects = self.list(OBJECTS).await?.into_iter();
        Ok(objects
            .filter_map(|(address, bytes)| Some((digest_in(&address)?, bytes)))
            .collect())
    }

    /// Addresses of the results of a job's chunks, and their sizes in bytes.
    pub async fn results_of(&self, job: JobId) -> Result<Vec<(String, u64)>, StoreError> {
        let results = self.list(&format!("{JOBS}/{job}")).await?.into_iter();
        Ok(results.map(|(at, bytes)| (at.to_string(), bytes)).collect())
    }

    /// The jobs of which there are results.
    pub async fn jobs_with_results(&self) -> Result<Vec<JobId>, StoreError> {
        let listing = self.objects.list_with_delimiter(Some(&JOBS.into())).await?;
        let names = listing.common_prefixes.iter().filter_map(Address::filename);
        Ok(names.filter_map(|name| name.parse().ok()).collect())
    }

    async fn list(&self, folder: &str) -> Result<Vec<(Address, u64)>, StoreError> {
        self.is_there().await?;
        let objects = self.objects.list(Some(&folder.into()));
        Ok(objects
            .map_ok(|object| (object.location, object.size))
            .try_collect()
            .await?)
    }

    /// Removes the results of all chunks of a job that is deleted.
    pub async fn remove_results_of(&self, job: JobId) -> Result<Amount, StoreError> {
        let mut removed = Amount::default();
        for (address, bytes) in self.results_of(job).await? {
            if self.remove_results(&address).await? {
                removed += Amount::one(bytes);
            }
        }
        self.remove_empty_folder(&format!("{JOBS}/{job}"));
        Ok(removed)
    }

    /// Objects by digest in the trash.
    pub async fn in_trash(&self) -> Result<Vec<Trashed>, StoreError> {
        let objects = self.list(TRASH).await?.into_iter();
        let trashed = |(address, bytes): (Address, u64)| {
            let digest = digest_in(&address)?;
            let since = address.parts().nth(1)?.as_ref().parse().ok()?;
            Some(Trashed {
                digest,
                since: LedgerTime(since),
                bytes,
                address,
            })
        };
        Ok(objects.filter_map(trashed).collect())
    }

    /// Puts an object into the trash; false where somebody else did.
    pub async fn trash(&self, digest: Digest, now: LedgerTime) -> Result<bool, StoreError> {
        self.is_there().await?;
        let address = object_address(digest);
        let to = Address::from(format!("{TRASH}/{}/{digest}", now.0));
        was_there(self.objects.rename(&address, &to).await)
    }

    /// Takes an object back from the trash; false where another coordinator did, or the object is gone. `is_old`: the
    /// object has been there for longer than a coordinator may have stood still.
    pub async fn take_back(&self, trashed: &Trashed, is_old: bool) -> Result<bool, StoreError> {
        self.is_there().await?;
        let address = object_address(trashed.digest);
        if self.objects.head(&address).await.is_ok() {
            // It was written anew, or is being put into the trash, which in a bucket is to copy and then to remove.
            if is_old {
                self.remove_from_trash(trashed).await?;
            }
            return Ok(false);
        }
        was_there(self.objects.rename(&trashed.address, &address).await)
    }

    /// Removes an object in the trash for good; false where somebody else did, or took it back.
    pub async fn remove_from_trash(&self, trashed: &Trashed) -> Result<bool, StoreError> {
        self.is_there().await?;
        let removed = was_there(self.objects.delete(&trashed.address).await)?;
        self.remove_empty_folder(&format!("{TRASH}/{}", trashed.since.0));
        Ok(removed)
    }

    /// An object that is not where it should be: from the trash, or from its place where it was taken back
    /// meanwhile.
    pub(super) async fn read_trashed(&self, address: &Address) -> Result<Bytes, StoreError> {
        let missing = || StoreError::Missing(address.to_string());
        let digest = digest_in(address).filter(|_| address.as_ref().starts_with(OBJECTS));
        let digest = digest.ok_or_else(missing)?;
        let trashed = self.in_trash().await?.into_iter();
        let places = trashed.filter(|t| t.digest == digest).map(|t| t.address);
        for place in places.chain([address.clone()]) {
            match self.objects.get(&place).await {
                Ok(object) => return Ok(object.bytes().await?),
                Err(object_store::Error::NotFound { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Err(missing())
    }

    /// Files that writers left which were killed, with their sizes in bytes, if they are older than this.
    pub fn unfinished_files(&self, older: std::time::Duration) -> Vec<(PathBuf, u64)> {
        let mut unfinished_files = Vec::new();
        let mut folders: Vec<PathBuf> = self.own_folder().map(Into::into).into_iter().collect();
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                let Ok(about) = entry.metadata() else {
                    continue; // it is gone
                };
                // `object_store` writes `NAME#NUMBER`, then renames it.
                let name = entry.file_name().to_string_lossy().into_owned();
                let is_unfinished = name.rsplit_once('#').is_some_and(|(_, number)| {
                    !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit())
                });
                let age = about.modified().ok().and_then(|time| time.elapsed().ok());
                if about.is_dir() {
                    folders.push(entry.path());
                } else if is_unfinished && age.is_some_and(|age| age >= older) {
                    unfinished_files.push((entry.path(), about.len()));
                }
            }
        }
        unfinished_files.sort();
        unfinished_files
    }

    fn own_folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Folder(folder) => Some(folder),
            Place::Memory | Place::Bucket(_) => None,
        }
    }

    /// Removes a folder if it is empty; a later writer makes it again.
    fn remove_empty_folder(&self, folder: &str) {
        if let Some(results_folder) = self.own_folder() {
            let _ = std::fs::remove_dir(results_folder.join(folder));
        }
    }
}
