//! Store: objects that are written once and never change.
//!
//! Most are named by the digest of their bytes. A chunk's results are named by
//! job, stage, items and epoch, so that a coordinator that died between object
//! and ledger row finds its object again. Every object is checked when it is
//! read: a damaged one is reported, never believed.

use super::addresses::{object_address, results_address};
use super::naming::Naming;
use crate::ledger::identity::{ItemRange, LeaseId, digest_of};
use crate::ledger::rows::{Outcomes, ResultObject};
use crate::measures::StorageMeasures;
use bytes::Bytes;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::{Stage, Work};
use cognate_protocol::{digest, records, stage_bytes};
use cognate_systems::system::System;
use object_store::memory::InMemory;
use object_store::path::Path as Address;
use object_store::{ObjectStore, ObjectStoreExt, PutMode, PutOptions};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::io::{self, BufWriter, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Why an object was not written or read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// There is no such object.
    #[error("there is no object {0}")]
    Missing(String),
    /// The object is not what was written.
    #[error("object {address} is damaged: {what}")]
    Damaged {
        /// Address of the object.
        address: String,
        /// Description of the damage.
        what: String,
    },
    /// Another execution of the same lease wrote other results there.
    #[error("object {0} holds other results for the same lease")]
    Differs(String),
    /// The folder or bucket of all results is not there, or is another: nothing is missing from it.
    #[error(
        "the place `{0}` of the results is not there (it has no `cognate-results`): is it mounted? Is it the right one?"
    )]
    Away(String),
    /// The bucket of all results cannot be used, or not now.
    #[error("cannot use {bucket} for results: {what}")]
    Bucket {
        /// Address of the bucket.
        bucket: String,
        /// Missing setting of the environment, or reason why a request failed.
        what: String,
    },
    /// The folder or bucket holds results of another ledger.
    #[error("{0}: nothing is removed from it")]
    Foreign(String),
    /// The storage failed.
    #[error("the result store failed: {0}")]
    Storage(#[from] object_store::Error),
    /// A folder cannot be used.
    #[error("cannot use the folder `{folder}` for results: {error}")]
    Folder {
        /// The folder.
        folder: String,
        /// The operating system's error.
        error: std::io::Error,
    },
}

impl StoreError {
    /// True where trying again later cannot help.
    pub fn is_permanent(&self) -> bool {
        !matches!(
            self,
            Self::Storage(_) | Self::Folder { .. } | Self::Away(_) | Self::Bucket { .. }
        )
    }

    /// True where an object is lost for good: there is none, or another one.
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::Missing(_) | Self::Damaged { .. })
    }
}

/// Kind and length that every record begins with.
const RECORD_HEAD: usize = 16;

/// Magic and version of a chunk's results; then the length of the records, then the records'
/// hash, then the records, compressed.
const MAGIC: &[u8; 8] = b"CGNCHK01";
/// Records are compressed with zstd's fastest common level: endpoints are nearly random bits,
/// and more effort gains under 2 % on them.
const LEVEL: i32 = 1;
/// No chunk's records are longer; a larger length in an object is damage.
const LONGEST_RECORDS: u64 = 1 << 32;
/// Plain bytes of a record that are compressed at once.
const PIECE: usize = 256 << 10;
/// Larger objects are written to a bucket in parts of this many bytes; a part has at least 5 MiB, and an object at
/// most 10,000 of them (Amazon S3 user guide, "Multipart upload limits").
pub(super) const PART: usize = 16 << 20;
/// Chunks above this size leave the runtime's thread for compression.
const SMALL: usize = 256 << 10;

/// Kind and version of a record: the first eight bytes of its object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordKind(pub &'static [u8; 8]);

/// Where a store keeps its objects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// In this process.
    Memory,
    /// In a folder.
    Folder(PathBuf),
    /// In a bucket, by its address.
    Bucket(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Memory => f.write_str("memory"),
            Self::Folder(folder) => folder.display().fmt(f),
            Self::Bucket(address) => f.write_str(address),
        }
    }
}

/// The objects of all jobs.
#[derive(Clone, Debug)]
pub struct Store {
    pub(super) objects: Arc<dyn ObjectStore>,
    pub(super) place: Place,
    measures: Arc<StorageMeasures>,
    naming: Naming,
}

impl Store {
    pub(super) fn at(place: Place, objects: Arc<dyn ObjectStore>) -> Self {
        Self {
            objects,
            place,
            measures: Arc::default(),
            naming: Naming::default(),
        }
    }

    /// Writers in this process of objects that a row is to name.
    pub fn naming(&self) -> &Naming {
        &self.naming
    }

    /// Counts its operations in these.
    pub fn measured(self, measures: Arc<StorageMeasures>) -> Self {
        Self { measures, ..self }
    }

    /// Objects somewhere else.
    #[cfg(test)]
    pub(crate) fn on(objects: Arc<dyn ObjectStore>) -> Self {
        Self::at(Place::Memory, objects)
    }

    /// Objects that live as long as this process.
    pub fn in_memory() -> Self {
        Self::at(Place::Memory, Arc::new(InMemory::new()))
    }

    /// Loses an object, as a broken disk does.
    #[cfg(test)]
    pub(crate) async fn lose(&self, digest: Digest) -> Result<(), StoreError> {
        Ok(self.objects.delete(&object_address(digest)).await?)
    }

    /// Writes an object unless it is there; true if it was not.
    async fn create(&self, address: &Address, bytes: Bytes) -> Result<bool, StoreError> {
        self.is_mounted()?;
        let begin = Instant::now();
        let mode = PutOptions::from(PutMode::Create);
        let put = self.objects.put_opts(address, bytes.into(), mode).await;
        let failed = matches!(&put, Err(error) if !is_there_already(error));
        self.measures.writes.observe(begin.elapsed(), failed);
        match put {
            // Where the folder went away meanwhile, the write made another one, which is none of ours.
            Ok(_) => self.is_mounted().map(|()| true),
            Err(object_store::Error::AlreadyExists { .. }) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Writes an object that is named by its digest in parts, so that a broken connection costs one part.
    /// Simultaneous writers write equal bytes.
    async fn write_in_parts(&self, address: &Address, bytes: Bytes) -> Result<(), StoreError> {
        let begin = Instant::now();
        let written = self.upload(address, bytes).await;
        self.measures
            .writes
            .observe(begin.elapsed(), written.is_err());
        Ok(written?)
    }

    async fn upload(&self, address: &Address, mut bytes: Bytes) -> Result<(), object_store::Error> {
        let mut upload = self.objects.put_multipart(address).await?;
        while !bytes.is_empty() {
            let part = bytes.split_to(bytes.len().min(PART));
            if let Err(error) = upload.put_part(part.into()).await {
                // Parts that stay cost money.
                let _ = upload.abort().await;
                return Err(error);
            }
        }
        upload.complete().await.map(drop)
    }

    async fn read(&self, address: &Address) -> Result<Bytes, StoreError> {
        let begin = Instant::now();
        let got = match self.objects.get(address).await {
            Ok(object) => object.bytes().await,
            Err(error) => Err(error),
        };
        self.measures.reads.observe(begin.elapsed(), got.is_err());
        match got {
            Ok(bytes) => Ok(bytes),
            Err(object_store::Error::NotFound { .. }) => {
                self.is_there().await?;
                self.read_trashed(address).await
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Keeps bytes under their digest.
    pub async fn put(&self, bytes: Bytes) -> Result<Digest, StoreError> {
        let digest = digest_of(&bytes);
        let address = object_address(digest);
        // Many jobs share their system: to look is cheaper than to write and be refused.
        if self.objects.head(&address).await.is_err() {
            match self.place {
                Place::Bucket(_) if bytes.len() > PART => {
                    self.write_in_parts(&address, bytes).await?;
                }
                _ => drop(self.create(&address, bytes).await?),
            }
        }
        Ok(digest)
    }

    /// Keeps bytes under their digest, also where the object there is damaged; true if it was missing or damaged.
    pub async fn put_again(&self, bytes: Bytes) -> Result<bool, StoreError> {
        let digest = digest_of(&bytes);
        match self.get(digest).await {
            Ok(_) => Ok(false),
            Err(error) if error.is_loss() => {
                self.is_mounted()?;
                self.objects
                    .put(&object_address(digest), bytes.into())
                    .await?;
                Ok(true)
            }
            Err(error) => Err(error),
        }
    }

    /// Keeps a system under its digest, also where the object there is damaged; true if it was missing or damaged.
    pub async fn put_problem_again(&self, system: &System) -> Result<bool, StoreError> {
        self.put_again(digest::encode_system(system).into()).await
    }

    /// Keeps a stage under its digest, also where the object there is damaged; true if it was missing or damaged.
    pub async fn put_stage_again(&self, stage: &Stage) -> Result<bool, StoreError> {
        self.put_again(stage_bytes::encode(stage)).await
    }

    /// The bytes of this digest.
    pub async fn get(&self, digest: Digest) -> Result<Bytes, StoreError> {
        let address = object_address(digest);
        let bytes = self.read(&address).await?;
        if digest_of(&bytes) != digest {
            return Err(damaged(&address, "its bytes have another digest"));
        }
        Ok(bytes)
    }

    /// An error where no object of this digest can be read; its bytes are not looked at.
    pub async fn is_here(&self, digest: Digest) -> Result<(), StoreError> {
        let address = object_address(digest);
        match self.objects.head(&address).await {
            Ok(_) => Ok(()),
            Err(object_store::Error::NotFound { .. }) => self.read(&address).await.map(drop),
            Err(error) => Err(error.into()),
        }
    }

    /// Keeps a checked system; its digest is the problem's.
    pub async fn put_problem(&self, system: &System) -> Result<Digest, StoreError> {
        self.put(digest::encode_system(system).into()).await
    }

    /// The system of this digest.
    pub async fn problem(&self, digest: Digest) -> Result<System, StoreError> {
        let bytes = self.get(digest).await?;
        digest::decode_system(&bytes).map_err(|error| damaged(&object_address(digest), error))
    }

    /// Keeps a stage.
    pub async fn put_stage(&self, stage: &Stage) -> Result<Digest, StoreError> {
        self.put(stage_bytes::encode(stage)).await
    }

    /// The stage of this digest.
    pub async fn stage(&self, digest: Digest) -> Result<Stage, StoreError> {
        let bytes = self.get(digest).await?;
        stage_bytes::decode(bytes).map_err(|error| damaged(&object_address(digest), error))
    }

    /// Keeps what serde can write, compressed, with a name for its kind before it.
    pub async fn put_record<T: Serialize + Send + 'static>(
        &self,
        kind: &'static RecordKind,
        value: T,
    ) -> Result<Digest, StoreError> {
        let bytes = off_thread(true, move || packed_record(kind, &value));
        self.put(bytes.await.into()).await
    }

    /// Whether a record is of this kind.
    pub async fn is_of_kind(
        &self,
        kind: &'static RecordKind,
        digest: Digest,
    ) -> Result<bool, StoreError> {
        let address = object_address(digest);
        match self
            .objects
            .get_range(&address, 0..kind.0.len() as u64)
            .await
        {
            Ok(head) => Ok(head[..] == kind.0[..]),
            Err(object_store::Error::NotFound { .. }) => {
                Ok(self.read(&address).await?.starts_with(kind.0))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Reads what [`Self::put_record`] kept.
    pub async fn record<T: DeserializeOwned + Send + 'static>(
        &self,
        kind: &'static RecordKind,
        digest: Digest,
    ) -> Result<T, StoreError> {
        let bytes = self.get(digest).await?;
        let address = object_address(digest);
        off_thread(true, move || {
            let plain = unpacked_record(kind, &address, bytes)?;
            postcard::from_bytes(&plain).map_err(|error| damaged(&address, error))
        })
        .await
    }

    /// Reads a record of bytes without copying them: they may take a large part of the memory.
    pub async fn bytes_record(
        &self,
        kind: &'static RecordKind,
        digest: Digest,
    ) -> Result<Vec<u8>, StoreError> {
        let bytes = self.get(digest).await?;
        let address = object_address(digest);
        off_thread(true, move || {
            let mut plain = unpacked_record(kind, &address, bytes)?;
            let counted = postcard::take_from_bytes::<usize>(&plain);
            let (count, rest) = counted.map_err(|error| damaged(&address, error))?;
            if count != rest.len() {
                return Err(damaged(&address, "it has another number of bytes"));
            }
            plain.drain(..plain.len() - count);
            Ok(plain)
        })
        .await
    }

    /// Keeps the results of a lease. Sent twice, they are kept once.
    pub async fn put_results(
        &self,
        lease: LeaseId,
        items: ItemRange,
        results: Vec<ItemResult>,
        cpu_micros: u64,
    ) -> Result<ResultObject, StoreError> {
        let (object, bytes) = Self::describe_results(lease, items, results, cpu_micros).await;
        let (address, hash) = (results_address(lease, items), object.hash);
        if !self.create(&address, bytes.into()).await? {
            // A reply was lost, or this coordinator died before it wrote the ledger's row.
            let there = self.read(&address).await?;
            let (stored_hash, _) = unpack(&address, &there)?;
            if stored_hash != hash {
                return Err(StoreError::Differs(address.to_string()));
            }
        }
        Ok(object)
    }

    /// Writes the results of an object that was lost, if these are they; false where they are others.
    pub async fn put_results_again(
        &self,
        object: &ResultObject,
        results: &[ItemResult],
    ) -> Result<bool, StoreError> {
        let (hash, bytes) = pack(results);
        if hash != object.hash {
            return Ok(false);
        }
        self.is_mounted()?;
        let address = Address::parse(&object.address)
            .map_err(|error| damaged(&Address::from(object.address.as_str()), error))?;
        let bytes = Bytes::from(bytes);
        self.objects.put(&address, bytes.into()).await?;
        Ok(true)
    }

    /// The object that results would be kept as, and its bytes; nothing is written.
    pub async fn describe_results(
        lease: LeaseId,
        items: ItemRange,
        results: Vec<ItemResult>,
        cpu_micros: u64,
    ) -> (ResultObject, Vec<u8>) {
        let outcomes = Outcomes::of(&results);
        let (hash, bytes) = off_thread(results.len() * 256 > SMALL, move || pack(&results)).await;
        let object = ResultObject {
            items,
            address: results_address(lease, items).to_string(),
            hash,
            cpu_micros,
            outcomes,
        };
        (object, bytes)
    }

    /// The object that results of a lease were kept as which were not accepted (yet).
    pub fn voted_results(lease: LeaseId, items: ItemRange, hash: Digest) -> ResultObject {
        ResultObject {
            items,
            address: results_address(lease, items).to_string(),
            hash,
            cpu_micros: 0,
            outcomes: Outcomes::default(),
        }
    }

    /// Removes the results of a lease that the ledger does not name and never will; false where somebody else did.
    pub async fn remove_results(&self, address: &str) -> Result<bool, StoreError> {
        let address =
            Address::parse(address).map_err(|error| damaged(&Address::from(address), error))?;
        was_there(self.objects.delete(&address).await)
    }

    /// The paths that an object of a stage that tracks holds, in the order of its items.
    pub async fn paths(&self, object: &ResultObject) -> Result<Vec<PathResult>, StoreError> {
        let results = self.results(object, Work::Track).await?.into_iter();
        Ok(results.map(ItemResult::into_path).collect())
    }

    /// The results that an object of a stage that does this work holds, in the order of their items.
    pub async fn results(
        &self,
        object: &ResultObject,
        work: Work,
    ) -> Result<Vec<ItemResult>, StoreError> {
        let address = Address::parse(&object.address)
            .map_err(|error| damaged(&Address::from(object.address.as_str()), error))?;
        let bytes = self.read(&address).await?;
        let object = object.clone();
        off_thread(bytes.len() > SMALL, move || {
            let (hash, records) = unpack(&address, &bytes)?;
            if hash != object.hash {
                return Err(damaged(&address, "it is not the object that was accepted"));
            }
            let results =
                records::decode(&records, work).map_err(|error| damaged(&address, error))?;
            if results.len() as u64 != object.items.len() {
                return Err(damaged(&address, "it has another number of results"));
            }
            Ok(results)
        })
        .await
    }
}

fn is_there_already(error: &object_store::Error) -> bool {
    matches!(error, object_store::Error::AlreadyExists { .. })
}

/// Runs long work where it holds nobody up.
async fn off_thread<T: Send + 'static>(long: bool, work: impl FnOnce() -> T + Send + 'static) -> T {
    if !long {
        return work();
    }
    match tokio::task::spawn_blocking(work).await {
        Ok(value) => value,
        Err(error) => std::panic::resume_unwind(error.into_panic()),
    }
}

/// The object of a record, compressed as it is written: its plain bytes are never all in memory.
pub fn packed_record(kind: &RecordKind, value: &impl Serialize) -> Vec<u8> {
    const MEMORY: &str = "memory takes every byte";
    let mut head = kind.0.to_vec();
    head.resize(RECORD_HEAD, 0);
    let encoder = zstd::stream::write::Encoder::new(head, LEVEL).expect(MEMORY);
    let pieces = BufWriter::with_capacity(PIECE, Counted { encoder, plain: 0 });
    let pieces = postcard::to_io(value, pieces).expect(MEMORY);
    let written = pieces.into_inner().map_err(|error| error.into_error());
    let Counted { encoder, plain } = written.expect(MEMORY);
    let mut bytes = encoder.finish().expect(MEMORY);
    bytes[kind.0.len()..RECORD_HEAD].copy_from_slice(&plain.to_le_bytes());
    bytes
}

/// Compresses, and counts what was written.
struct Counted {
    encoder: zstd::stream::write::Encoder<'static, Vec<u8>>,
    plain: u64,
}

impl Write for Counted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.encoder.write(bytes)?;
        self.plain += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.encoder.flush()
    }
}

/// The plain bytes of a record of this kind.
fn unpacked_record(
    kind: &RecordKind,
    address: &Address,
    bytes: Bytes,
) -> Result<Vec<u8>, StoreError> {
    let length = record_length(kind, &bytes)
        .ok_or_else(|| damaged(address, "it is of another kind or version"))?;
    decompress(address, &bytes[RECORD_HEAD..], length)
}

/// The length before compression that a record of this kind says it has; `None` where the bytes are none.
fn record_length(kind: &RecordKind, bytes: &[u8]) -> Option<usize> {
    let word = bytes.get(8..RECORD_HEAD)?.first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*word)).ok()?;
    bytes.starts_with(kind.0).then_some(length)
}

fn damaged(address: &Address, what: impl std::fmt::Display) -> StoreError {
    StoreError::Damaged {
        address: address.to_string(),
        what: what.to_string(),
    }
}

/// Whether the object was there that was removed or renamed.
pub(super) fn was_there(result: Result<(), object_store::Error>) -> Result<bool, StoreError> {
    match result {
        Ok(()) => Ok(true),
        Err(object_store::Error::NotFound { .. }) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

/// The hash of the results' records and the object that holds them.
fn pack(results: &[ItemResult]) -> (Digest, Vec<u8>) {
    let records = records::encode(results);
    let hash = records::hash(&records);
    let compressed =
        zstd::bulk::compress(&records, LEVEL).expect("memory takes whatever zstd writes");
    let mut bytes = Vec::with_capacity(48 + compressed.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&(records.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&hash.0);
    bytes.extend_from_slice(&compressed);
    (hash, bytes)
}

/// Exactly `length` bytes; a length that is a lie takes no memory.
fn decompress(address: &Address, compressed: &[u8], length: usize) -> Result<Vec<u8>, StoreError> {
    let mut bytes = Vec::with_capacity(length.min(1 << 20));
    let decoder = zstd::stream::read::Decoder::new(compressed);
    let read = decoder.and_then(|d| d.take(length as u64 + 1).read_to_end(&mut bytes));
    read.map_err(|error| damaged(address, error))?;
    if bytes.len() == length {
        Ok(bytes)
    } else {
        Err(damaged(address, "it has another length than it says"))
    }
}

/// The hash of the records and the records, checked against each other.
fn unpack(address: &Address, bytes: &[u8]) -> Result<(Digest, Vec<u8>), StoreError> {
    let (head, compressed) = bytes
        .split_at_checked(48)
        .filter(|(head, _)| head.starts_with(MAGIC))
        .ok_or_else(|| damaged(address, "it is no chunk of results"))?;
    let word = head[8..16].first_chunk::<8>();
    let length = word.map_or(u64::MAX, |word| u64::from_le_bytes(*word));
    let capacity = usize::try_from(length)
        .ok()
        .filter(|_| length <= LONGEST_RECORDS)
        .ok_or_else(|| damaged(address, "it claims to be absurdly long"))?;
    let records =
        zstd::bulk::decompress(compressed, capacity).map_err(|error| damaged(address, error))?;
    let hash = records::hash(&records);
    if records.len() != capacity || head[16..48] != hash.0 {
        return Err(damaged(address, "its records have another hash"));
    }
    Ok((hash, records))
}
