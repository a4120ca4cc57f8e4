//! Sessions: what a browser's cookie stands for. The cookie is a random name; the token stays in this process.
//!
//! A session ends when its browser logs out, after a day, or with the coordinator. The token behind it is asked for at
//! every call, so that a token that is taken out of the file opens nothing any more.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Sessions at a time; the oldest makes room.
const MOST: usize = 1000;
/// How long a session lasts.
const LASTS: Duration = Duration::from_secs(24 * 3600);

/// The sessions of a page.
#[derive(Default)]
pub struct Sessions(Mutex<HashMap<blake3::Hash, Session>>);

struct Session {
    token: String,
    since: Instant,
}

impl Sessions {
    fn lock(&self) -> MutexGuard<'_, HashMap<blake3::Hash, Session>> {
        let mut sessions = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sessions.retain(|_, session| session.since.elapsed() < LASTS);
        sessions
    }

    /// Begins a session for a token; the session's name, which nobody can guess.
    pub fn begin(&self, token: &str) -> String {
        let name = format!(
            "{}{}",
            uuid::Uuid::new_v4().simple(),
            uuid::Uuid::new_v4().simple()
        );
        let mut sessions = self.lock();
        if sessions.len() >= MOST {
            let oldest = sessions.iter().min_by_key(|(_, session)| session.since);
            if let Some(key) = oldest.map(|(key, _)| *key) {
                sessions.remove(&key);
            }
        }
        let session = Session {
            token: token.to_owned(),
            since: Instant::now(),
        };
        // The key is the hash of the name: the time of a look-up says nothing about names.
        sessions.insert(blake3::hash(name.as_bytes()), session);
        name
    }

    /// The token of a session; `None` where it has ended.
    pub fn token(&self, name: &str) -> Option<String> {
        let sessions = self.lock();
        let session = sessions.get(&blake3::hash(name.as_bytes()))?;
        Some(session.token.clone())
    }

    /// Ends a session.
    pub fn end(&self, name: &str) {
        self.lock().remove(&blake3::hash(name.as_bytes()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_ends_when_it_is_told_to_and_the_oldest_makes_room() {
        let sessions = Sessions::default();
        let first = sessions.begin("token");
        let second = sessions.begin("token");
        assert_ne!(first, second);
        assert_eq!(sessions.token(&first).as_deref(), Some("token"));
        sessions.end(&first);
        assert_eq!(sessions.token(&first), None);
        assert_eq!(sessions.token(&second).as_deref(), Some("token"));
        for _ in 0..MOST {
            sessions.begin("other");
        }
        assert_eq!(sessions.lock().len(), MOST);
        assert_eq!(sessions.token(&second), None);
    }
}
