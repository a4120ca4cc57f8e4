//! Names of jobs, chunks, leases, requests and processes. Types, not integers and strings.

use cognate_continuation::start_points::Digest;
use cognate_continuation::work::StageId;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Error of a name, an id or a digest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IdentityError {
    /// Names have 1 to 128 visible ASCII characters.
    #[error("{what} must have 1 to 128 visible ASCII characters")]
    Name {
        /// Kind of the name: of a worker, of a tenant.
        what: &'static str,
        /// The field of a request that has such a name.
        field: &'static str,
    },
    /// A job's id has 16 hexadecimal digits.
    #[error("`{0}` is no job id: it must have 16 hexadecimal digits")]
    Job(String),
    /// A digest has 64 hexadecimal digits.
    #[error("`{0}` is no digest: it must have 64 hexadecimal digits")]
    Digest(String),
}

impl IdentityError {
    /// The field of a request that has such a name.
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::Name { field, .. } => Some(field),
            Self::Job(_) => Some("job"),
            Self::Digest(_) => None,
        }
    }
}

macro_rules! name {
    ($(#[$doc:meta])* $type:ident, $what:literal, $field:literal) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $type(String);

        impl $type {
            /// Checks the length and the characters.
            pub fn new(name: impl Into<String>) -> Result<Self, IdentityError> {
                let name = name.into();
                if (1..=128).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic()) {
                    Ok(Self(name))
                } else {
                    Err(IdentityError::Name {
                        what: $what,
                        field: $field,
                    })
                }
            }

            /// The name.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }
    };
}

name!(
    /// Id of a request, chosen by the caller, so that a repeated call has the effect of one call.
    RequestId,
    "a request id",
    "request_id"
);
name!(
    /// One worker process.
    WorkerId,
    "a worker's id",
    "identity.worker"
);
name!(
    /// One coordinator process.
    CoordinatorId,
    "a coordinator's id",
    "coordinator"
);
name!(
    /// Tenant on whose behalf jobs run; tenants share the workers fairly.
    Tenant,
    "a tenant's name",
    "tenant"
);

/// Credential by which a caller is known, whatever names it gives itself: its token, its certificate, or that it is
/// this machine's user. Empty where it is not remembered.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Credential(pub String);

impl fmt::Display for Credential {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl RequestId {
    /// The request of this id as a tenant makes it: other tenants may use the same id for jobs of their own.
    #[must_use]
    pub fn within(&self, tenant: &Tenant) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key("cognate 2026-11 request id of a tenant");
        // Names have no spaces, so that no two pairs are one text.
        hasher.update(format!("{} {}", tenant.as_str(), self.as_str()).as_bytes());
        let digits = hasher.finalize().to_hex();
        Self(format!("tenant-{}", &digits[..40]))
    }

    /// Session of a worker's request id `SESSION.NUMBER`, with its dot: one life of the process.
    pub fn session(&self) -> &str {
        let text = self.as_str();
        text.rfind('.').map_or(text, |dot| &text[..=dot])
    }

    /// The session as a [`Speaker`] names it, without the dot.
    pub fn speaker_session(&self) -> &str {
        self.session().trim_end_matches('.')
    }
}

/// A worker in one session, that is, in one life of its process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Speaker {
    /// Name of the worker.
    pub worker: WorkerId,
    /// Session of the worker, which only the worker and the coordinator know.
    pub session: String,
}

/// A job, named after the request that made it: 16 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct JobId(pub u64);

impl JobId {
    /// The id of the job that a request makes.
    pub fn of_request(request: &RequestId) -> Self {
        let hash = blake3::hash(request.as_str().as_bytes());
        let head = hash.as_bytes().first_chunk::<8>();
        Self(u64::from_be_bytes(
            *head.expect("a BLAKE3 hash has 32 bytes"),
        ))
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl FromStr for JobId {
    type Err = IdentityError;
    fn from_str(text: &str) -> Result<Self, IdentityError> {
        Some(text)
            .filter(|t| t.len() == 16 && t.bytes().all(|b| b.is_ascii_hexdigit()))
            .and_then(|t| u64::from_str_radix(t, 16).ok())
            .map(Self)
            .ok_or_else(|| IdentityError::Job(text.chars().take(40).collect()))
    }
}

/// Grows whenever a chunk or a job changes hands; writes with an older one are refused.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct Epoch(pub u64);

/// A chunk, by its first item. Chunks are cut smaller, never joined, so the name stays its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ChunkId {
    /// The job.
    pub job: JobId,
    /// The stage within the job.
    pub stage: StageId,
    /// The first item.
    pub first: u64,
}

/// One lease of one chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct LeaseId {
    /// The chunk.
    pub chunk: ChunkId,
    /// Epoch of the lease: how often the chunk had been leased.
    pub epoch: Epoch,
}

impl fmt::Display for LeaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ChunkId { job, stage, first } = self.chunk;
        write!(f, "{job}/{}/{first}/{}", stage.0, self.epoch.0)
    }
}

/// Items `first..last` of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ItemRange {
    /// The first item.
    pub first: u64,
    /// One past the last item.
    pub last: u64,
}

impl ItemRange {
    /// Number of items.
    pub fn len(&self) -> u64 {
        self.last.saturating_sub(self.first)
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.last <= self.first
    }
}

/// Reads the 64 hexadecimal digits that a [`Digest`] prints.
pub fn parse_digest(text: &str) -> Result<Digest, IdentityError> {
    let bad = || IdentityError::Digest(text.chars().take(80).collect());
    let digits = text.as_bytes();
    if digits.len() != 64 {
        return Err(bad());
    }
    let mut bytes = [0; 32];
    for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
        let nibble = |c: u8| char::from(c).to_digit(16).ok_or_else(bad);
        *byte = (nibble(pair[0])? * 16 + nibble(pair[1])?) as u8;
    }
    Ok(Digest(bytes))
}

/// The digest of these bytes.
pub fn digest_of(bytes: &[u8]) -> Digest {
    Digest(*blake3::hash(bytes).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert!(RequestId::new("").is_err());
        assert!(RequestId::new("a b").is_err());
        assert!(RequestId::new("x".repeat(129)).is_err());
        assert_eq!(RequestId::new("x-1").unwrap().as_str(), "x-1");
        assert_eq!(RequestId::new("s.x.12").unwrap().session(), "s.x.");
        assert_eq!(RequestId::new("12").unwrap().session(), "12");
    }

    #[test]
    fn tenants_do_not_share_request_ids() {
        let (ada, bob) = (Tenant::new("ada").unwrap(), Tenant::new("bob").unwrap());
        let nightly = RequestId::new("nightly").unwrap();
        let ids = [nightly.clone(), nightly.within(&ada), nightly.within(&bob)];
        let jobs: std::collections::BTreeSet<_> = ids.iter().map(JobId::of_request).collect();
        assert_eq!(jobs.len(), 3);
        assert_eq!(nightly.within(&ada), ids[1]);
        assert!(RequestId::new(ids[1].as_str()).is_ok());
    }

    #[test]
    fn ids_come_back_from_their_text() {
        let job = JobId::of_request(&RequestId::new("a").unwrap());
        assert_eq!(job.to_string().parse::<JobId>().unwrap(), job);
        assert!("12".parse::<JobId>().is_err());
        assert!("+123456789abcdef".parse::<JobId>().is_err());
        let digest = digest_of(b"x");
        assert_eq!(parse_digest(&digest.to_string()).unwrap(), digest);
        assert!(parse_digest("zz").is_err());
    }
}
