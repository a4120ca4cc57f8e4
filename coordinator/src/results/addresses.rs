//! Addresses: where in a store an object stands.

use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::{ItemRange, LeaseId, parse_digest};
use cognate_continuation::start_points::Digest;
use object_store::path::Path as Address;

/// Folder of the objects by digest.
pub(super) const OBJECTS: &str = "objects";
/// Folder of the chunks' results, one folder a job.
pub(super) const JOBS: &str = "jobs";
/// Folder of objects that are being uploaded, and have no digest yet.
pub(super) const UPLOADS: &str = "uploads";
/// Folder of the trash: in it, by the time at which they came, objects by digest.
pub(super) const TRASH: &str = "trash";

/// An object in the trash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trashed {
    /// Digest of the object.
    pub digest: Digest,
    /// Time at which it was put there, by the ledger's clock.
    pub since: LedgerTime,
    /// Bytes that it takes.
    pub bytes: u64,
    pub(super) address: Address,
}

/// Objects by digest are spread over 256 folders, which file systems like better than one.
pub(super) fn object_address(digest: Digest) -> Address {
    let name = digest.to_string();
    Address::from(format!("{OBJECTS}/{}/{name}", &name[..2]))
}

/// The address of a chunk's results.
pub(super) fn results_address(lease: LeaseId, items: ItemRange) -> Address {
    let ItemRange { first, last } = items;
    let (job, stage) = (lease.chunk.job, lease.chunk.stage.0);
    let epoch = lease.epoch.0;
    // One folder a job: making folders takes longer than writing small results.
    Address::from(format!("{JOBS}/{job}/{stage}.{first}-{last}.{epoch}"))
}

/// The digest of the object at an address, if its name is one.
pub(super) fn digest_in(address: &Address) -> Option<Digest> {
    parse_digest(address.filename()?).ok()
}
