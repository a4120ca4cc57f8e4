//! Chunks: who gets what, how large, until when.
//!
//! Plain decisions only. Whose turn it is, the ledger decides where it can see
//! all jobs at once (virtual time per tenant, then per job); how large a chunk
//! is cut, [`sizing`], and [`losses`] where workers are lost often; what becomes of one that no worker survives, [`expiry`];
//! which are done twice to compare, [`audit`]; which because they are late,
//! [`speculation`]; whose results are done again because they cannot be right, [`plausibility`]; the
//! numbers behind it, [`leasing`].

pub mod audit;
pub mod expiry;
pub mod leasing;
pub mod losses;
pub mod plausibility;
pub mod sizing;
pub mod speculation;
