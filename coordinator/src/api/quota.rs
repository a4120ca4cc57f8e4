//! Quota: what each credential uses now, and whether it may have more.
//!
//! Calls that are not answered and bytes of the last hour are counted here, by this coordinator; jobs and paths
//! are counted in the ledger when one is submitted (`coordinator/limited_submission.rs`).

use super::caller::Caller;
use crate::ledger::identity::Credential;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tonic::Status;

/// Bytes are counted over this time, in pieces.
const HOUR: Duration = Duration::from_secs(3600);
/// Pieces of the hour: bytes of a piece count until the whole piece is over.
const PIECES: u32 = 12;

/// Current use of the service by each credential. Only credentials with limits are counted.
#[derive(Clone, Debug, Default)]
pub struct Quota(Arc<Mutex<HashMap<Credential, Use>>>);

#[derive(Debug, Default)]
struct Use {
    calls: u64,
    /// Start of each piece of the hour, and the bytes received in it.
    bytes: Vec<(Instant, u64)>,
}

impl Use {
    fn recent(&mut self, now: Instant) -> u64 {
        self.bytes
            .retain(|(began, _)| now.saturating_duration_since(*began) < HOUR);
        self.bytes.iter().map(|(_, bytes)| bytes).sum()
    }
}

/// A call that is counted as long as this lives.
#[derive(Debug)]
pub struct CallPermit {
    quota: Quota,
    credential: Credential,
}

impl Drop for CallPermit {
    fn drop(&mut self) {
        let mut usage_by_credential = self.quota.lock();
        if let Some(used) = usage_by_credential.get_mut(&self.credential) {
            used.calls -= 1;
            if used.calls == 0 && used.recent(Instant::now()) == 0 {
                usage_by_credential.remove(&self.credential);
            }
        }
    }
}

impl Quota {
    fn lock(&self) -> MutexGuard<'_, HashMap<Credential, Use>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a call until it is answered, or refuses it; `None` where the caller has no limit.
    pub fn call(&self, caller: &Caller) -> Result<Option<CallPermit>, Status> {
        let Some(limit) = caller.limits.calls else {
            return Ok(None);
        };
        let mut usage_by_credential = self.lock();
        let used = usage_by_credential
            .entry(caller.credential.clone())
            .or_default();
        if used.calls >= limit {
            return Err(exceeded("calls at once", limit, used.calls, 1));
        }
        used.calls += 1;
        Ok(Some(CallPermit {
            quota: self.clone(),
            credential: caller.credential.clone(),
        }))
    }

    /// Counts bytes that somebody sent, or refuses them.
    pub fn bytes(&self, caller: &Caller, bytes: u64, now: Instant) -> Result<(), Status> {
        let Some(limit) = caller.limits.bytes else {
            return Ok(());
        };
        let mut usage_by_credential = self.lock();
        let used = usage_by_credential
            .entry(caller.credential.clone())
            .or_default();
        let recent = used.recent(now);
        if recent.saturating_add(bytes) > limit {
            return Err(exceeded("bytes in an hour", limit, recent, bytes));
        }
        match used.bytes.last_mut() {
            Some((began, sum)) if now.saturating_duration_since(*began) < HOUR / PIECES => {
                *sum += bytes;
            }
            _ => used.bytes.push((now, bytes)),
        }
        Ok(())
    }
}

fn exceeded(what: &str, limit: u64, used: u64, asked: u64) -> Status {
    Status::resource_exhausted(format!(
        "this token's limit is {limit} {what}: {used} are in use, and this asks for {asked} more"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_worker::transport::tokens::Limits;
    use tonic::Code;

    fn caller(name: &str) -> Caller {
        Caller {
            limits: Limits {
                calls: Some(2),
                bytes: Some(100),
                ..Limits::default()
            },
            ..Caller::untold(name, "here")
        }
    }

    #[test]
    fn calls_count_while_they_last_and_for_one_credential() {
        let quota = Quota::default();
        let (a, b) = (caller("a"), caller("b"));
        let first = quota.call(&a).unwrap();
        let _second = quota.call(&a).unwrap();
        let refused = quota.call(&a).unwrap_err();
        assert_eq!(refused.code(), Code::ResourceExhausted);
        assert!(
            refused
                .message()
                .contains("limit is 2 calls at once: 2 are"),
            "{refused}"
        );
        assert!(quota.call(&b).is_ok());
        drop(first);
        assert!(quota.call(&a).is_ok());
        let unlimited = Caller::untold("a", "here");
        assert!(quota.call(&unlimited).unwrap().is_none());
    }

    #[test]
    fn bytes_are_forgotten_after_an_hour() {
        let quota = Quota::default();
        let (a, now) = (caller("a"), Instant::now());
        quota.bytes(&a, 60, now).unwrap();
        assert!(quota.bytes(&a, 41, now).is_err());
        quota.bytes(&a, 40, now + HOUR / 2).unwrap();
        assert!(quota.bytes(&a, 1, now + HOUR / 2).is_err());
        quota.bytes(&a, 60, now + HOUR).unwrap();
        assert!(quota.bytes(&a, 1, now + HOUR).is_err());
    }
}
