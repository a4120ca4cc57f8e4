//! Storage that fails by chance under a seed: bits that rot, writes that are lost or torn after they were
//! acknowledged, and handles that are stale for a while.

use crate::coordinator::simulation::Dice;
use async_trait::async_trait;
use bytes::Bytes;
use futures::stream::BoxStream;
use object_store::memory::InMemory;
use object_store::path::Path;
use object_store::{
    CopyOptions, Error, GetOptions, GetResult, ListResult, MultipartUpload, ObjectMeta,
    ObjectStore, ObjectStoreExt, PutMultipartOptions, PutOptions, PutPayload, PutResult, Result,
};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Mutex, MutexGuard};

/// Fault of a written object or of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StorageFault {
    /// A bit of the object flips after it was written.
    BitRot,
    /// The write is acknowledged and never happens.
    LostWrite,
    /// Only the beginning of the object is written.
    TornWrite,
    /// Operations fail for a while, then all is as before.
    StaleHandle,
}

const ALL: [StorageFault; 4] = [
    StorageFault::BitRot,
    StorageFault::LostWrite,
    StorageFault::TornWrite,
    StorageFault::StaleHandle,
];

/// Operations that fail while a handle is stale, at most.
const STALE: u64 = 6;

/// Storage in memory in which one write in `one_in` goes wrong.
#[derive(Debug)]
pub struct FaultyStorage {
    inner: InMemory,
    /// Only objects whose address begins so are hurt; stale handles concern all.
    hurt: &'static str,
    one_in: u64,
    state: Mutex<State>,
}

struct State {
    dice: Dice,
    /// Number of next operations that fail.
    stale: u64,
    happened: BTreeMap<StorageFault, u64>,
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.happened)
    }
}

impl FaultyStorage {
    /// Nothing is stored yet.
    pub fn new(hurt: &'static str, one_in: u64, seed: u64) -> Self {
        Self {
            inner: InMemory::new(),
            hurt,
            one_in,
            state: Mutex::new(State {
                dice: Dice(seed),
                stale: 0,
                happened: BTreeMap::new(),
            }),
        }
    }

    /// Number of faults of each kind so far.
    pub fn happened(&self) -> BTreeMap<StorageFault, u64> {
        self.lock().happened.clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no roll panics")
    }

    /// An error while the handle is stale.
    fn reach(&self) -> Result<()> {
        let mut state = self.lock();
        if state.stale == 0 {
            return Ok(());
        }
        state.stale -= 1;
        Err(Error::Generic {
            store: "faulty",
            source: "stale file handle".into(),
        })
    }

    /// Fault of a write to this address, if there is one, with the place of the fault in the object.
    fn fault(&self, location: &Path, length: usize) -> Option<(StorageFault, usize)> {
        let mut state = self.lock();
        if state.dice.roll(self.one_in) != 0 {
            return None;
        }
        let fault = ALL[state.dice.roll(ALL.len() as u64) as usize];
        let is_hurt = location.as_ref().starts_with(self.hurt) && length > 0;
        if fault != StorageFault::StaleHandle && !is_hurt {
            return None;
        }
        *state.happened.entry(fault).or_default() += 1;
        if fault == StorageFault::StaleHandle {
            state.stale = 1 + state.dice.roll(STALE);
        }
        Some((fault, state.dice.roll(length.max(1) as u64) as usize))
    }
}

impl fmt::Display for FaultyStorage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("faulty storage")
    }
}

#[async_trait]
impl ObjectStore for FaultyStorage {
    async fn put_opts(
        &self,
        location: &Path,
        payload: PutPayload,
        opts: PutOptions,
    ) -> Result<PutResult> {
        self.reach()?;
        let bytes: Bytes = payload.into();
        let fault = self.fault(location, bytes.len());
        let stored: Bytes = match fault {
            None | Some((StorageFault::StaleHandle, _)) => bytes,
            Some((StorageFault::LostWrite, _)) => {
                return Ok(PutResult {
                    e_tag: None,
                    version: None,
                    extensions: Default::default(),
                });
            }
            Some((StorageFault::TornWrite, at)) => bytes.slice(..at),
            Some((StorageFault::BitRot, at)) => {
                let mut rotten = bytes.to_vec();
                rotten[at] ^= 1 << (at % 8);
                rotten.into()
            }
        };
        self.inner.put_opts(location, stored.into(), opts).await
    }

    async fn put_multipart_opts(
        &self,
        location: &Path,
        opts: PutMultipartOptions,
    ) -> Result<Box<dyn MultipartUpload>> {
        self.inner.put_multipart_opts(location, opts).await
    }

    async fn get_opts(&self, location: &Path, options: GetOptions) -> Result<GetResult> {
        self.reach()?;
        self.inner.get_opts(location, options).await
    }

    fn delete_stream(
        &self,
        locations: BoxStream<'static, Result<Path>>,
    ) -> BoxStream<'static, Result<Path>> {
        self.inner.delete_stream(locations)
    }

    fn list(&self, prefix: Option<&Path>) -> BoxStream<'static, Result<ObjectMeta>> {
        self.inner.list(prefix)
    }

    async fn list_with_delimiter(&self, prefix: Option<&Path>) -> Result<ListResult> {
        self.inner.list_with_delimiter(prefix).await
    }

    async fn copy_opts(&self, from: &Path, to: &Path, options: CopyOptions) -> Result<()> {
        self.inner.copy_opts(from, to, options).await
    }
}

#[tokio::test]
async fn each_fault_happens_and_none_elsewhere() {
    let storage = FaultyStorage::new("jobs", 2, 1);
    for k in 0..200 {
        for folder in ["jobs", "objects"] {
            let address = Path::from(format!("{folder}/{k}"));
            let written = storage.put(&address, Bytes::from(vec![7; 9]).into()).await;
            if folder == "objects" && written.is_ok() {
                while storage.lock().stale > 0 {
                    let _ = storage.reach();
                }
                let read = storage.get(&address).await.unwrap().bytes().await.unwrap();
                assert_eq!(read, vec![7; 9]);
            }
        }
    }
    assert_eq!(storage.happened().len(), 4, "{storage:?}");
}
