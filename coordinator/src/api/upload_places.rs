//! Upload places: limits on the uploads at a time, in all and of one credential.
//!
//! An upload is a stream that lasts as long as its client likes, and holds a part of its object in memory and a file
//! in the store. So an upload takes a place before anything of it is read, and a slow upload loses the place.

use super::caller::Caller;
use crate::ledger::identity::Credential;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;
use tonic::Status;

/// Limits of uploads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UploadLimits {
    /// Uploads of all callers at a time. Default 16: each holds up to 16 MiB where results are in a bucket.
    pub most: usize,
    /// Uploads of one credential at a time. Default 4.
    pub most_of_one: usize,
    /// How long an upload waits for its place, and then for each of its pieces. Default 60 s.
    pub patience: Duration,
    /// How long an upload may last. Default 15 minutes: the largest object at 600 kB/s.
    pub longest: Duration,
}

impl Default for UploadLimits {
    fn default() -> Self {
        Self {
            most: 16,
            most_of_one: 4,
            patience: Duration::from_secs(60),
            longest: Duration::from_secs(900),
        }
    }
}

/// The places of uploads.
#[derive(Debug)]
pub struct UploadPlaces {
    limits: UploadLimits,
    all: Arc<Semaphore>,
    /// Places of each credential that has an upload, or had one lately.
    by_credential: Mutex<HashMap<Credential, Arc<Semaphore>>>,
}

/// An upload's place, which is free again when this is dropped.
#[derive(Debug)]
pub struct UploadPlace {
    _of_credential: OwnedSemaphorePermit,
    _of_all: OwnedSemaphorePermit,
}

impl UploadPlaces {
    /// All places are free.
    pub fn new(limits: UploadLimits) -> Self {
        Self {
            limits,
            all: Arc::new(Semaphore::new(limits.most)),
            by_credential: Mutex::default(),
        }
    }

    /// The limits.
    pub fn limits(&self) -> UploadLimits {
        self.limits
    }

    /// A place for this caller, once there is one.
    pub async fn place(&self, caller: &Caller) -> Result<UploadPlace, Status> {
        let of_credential = self.of_credential(caller);
        let wait = async {
            // The place of the credential comes first: a client with many uploads waits for its own places.
            let of_credential = of_credential.acquire_owned().await;
            (of_credential, Arc::clone(&self.all).acquire_owned().await)
        };
        match timeout(self.limits.patience, wait).await {
            Ok((Ok(of_credential), Ok(of_all))) => Ok(UploadPlace {
                _of_credential: of_credential,
                _of_all: of_all,
            }),
            _ => Err(Status::unavailable(format!(
                "{} uploads of one caller and {} of all are taken at a time: send it again later",
                self.limits.most_of_one, self.limits.most
            ))),
        }
    }

    fn of_credential(&self, caller: &Caller) -> Arc<Semaphore> {
        let by_credential = self.by_credential.lock();
        let mut by_credential = by_credential.unwrap_or_else(PoisonError::into_inner);
        // Every upload that holds or awaits a place holds a reference to the semaphore, too.
        by_credential.retain(|_, places| Arc::strong_count(places) > 1);
        let places = by_credential.entry(caller.credential.clone());
        let most = self.limits.most_of_one;
        Arc::clone(places.or_insert_with(|| Arc::new(Semaphore::new(most))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tonic::Code;

    #[tokio::test]
    async fn nobody_has_all_places() {
        let places = UploadPlaces::new(UploadLimits {
            most: 3,
            most_of_one: 2,
            patience: Duration::from_millis(20),
            ..UploadLimits::default()
        });
        let (ada, bob) = (Caller::untold("ada", "here"), Caller::untold("bob", "here"));
        let first = places.place(&ada).await.unwrap();
        let _second = places.place(&ada).await.unwrap();
        let refused = places.place(&ada).await.unwrap_err();
        assert_eq!(refused.code(), Code::Unavailable);
        let bobs = places.place(&bob).await.unwrap();
        assert!(places.place(&bob).await.is_err(), "three are all");
        drop(first);
        assert!(places.place(&bob).await.is_ok());
        drop(bobs);
        assert!(places.place(&ada).await.is_ok());
        assert!(places.by_credential.lock().unwrap().len() <= 2);
    }
}
