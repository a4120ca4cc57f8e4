//! Server readers: connections to PostgreSQL that only read, a few of them, each given up when it does not answer.
//!
//! A firewall that forgets a connection, or a host that is gone, leaves it half open: nothing sent on it is ever
//! answered. Pools of the library wait for such a connection without end when it is given back to them. Here every
//! question has a time limit, a connection that was idle is asked whether it lives before it is used, and one that does
//! not answer is closed, together with those that were idle beside it.

use sqlx::postgres::{PgConnectOptions, PgConnection};
use sqlx::{ConnectOptions, Connection as _};
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::{Semaphore, SemaphorePermit};
use tokio::time::error::Elapsed;
use tokio::time::timeout;

/// Number of connections.
const CONNECTIONS: usize = 4;
/// Time that a read waits for a connection, and time that a new connection may take.
const ACQUIRE: Duration = Duration::from_secs(5);
/// Time within which a read must be answered. Default 20 s: all reads of a coordinator take milliseconds.
const READ: Duration = Duration::from_secs(20);
/// Idle time after which a connection is pinged before it is used.
const IDLE: Duration = Duration::from_secs(1);
/// Time within which a ping must be answered.
const PING: Duration = Duration::from_secs(3);

/// Connections that only read.
pub struct ServerReaders {
    options: PgConnectOptions,
    places: Semaphore,
    idle: Mutex<Vec<IdleConnection>>,
}

struct IdleConnection {
    connection: PgConnection,
    since: Instant,
}

/// A connection for one read. Dropped before the read has ended, it is closed.
pub struct Reader<'a> {
    readers: &'a ServerReaders,
    connection: PgConnection,
    _place: SemaphorePermit<'a>,
}

impl ServerReaders {
    /// None yet.
    pub fn new(options: PgConnectOptions) -> Self {
        Self {
            options,
            places: Semaphore::new(CONNECTIONS),
            idle: Mutex::default(),
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<IdleConnection>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A connection that lives, as far as can be known.
    pub async fn reader(&self) -> Result<Reader<'_>, sqlx::Error> {
        let place = timeout(ACQUIRE, self.places.acquire()).await;
        let Ok(Ok(place)) = place else {
            return Err(sqlx::Error::PoolTimedOut);
        };
        let connection = match self.idle_that_lives().await {
            Some(connection) => connection,
            None => {
                let made = timeout(ACQUIRE, self.options.connect()).await;
                made.map_err(no_answer)??
            }
        };
        Ok(Reader {
            readers: self,
            connection,
            _place: place,
        })
    }

    async fn idle_that_lives(&self) -> Option<PgConnection> {
        let taken = self.idle().pop();
        let IdleConnection {
            mut connection,
            since,
        } = taken?;
        if since.elapsed() < IDLE {
            return Some(connection);
        }
        match timeout(PING, connection.ping()).await {
            Ok(Ok(())) => Some(connection),
            Ok(Err(_)) | Err(_) => {
                self.forget_idle();
                None
            }
        }
    }

    /// Closes the connections that are idle: what ended one of them has ended all.
    fn forget_idle(&self) {
        let forgotten = std::mem::take(&mut *self.idle());
        drop(forgotten);
    }

    /// Closes all of them.
    pub async fn close(&self) {
        self.places.close();
        let idle = std::mem::take(&mut *self.idle());
        for IdleConnection { connection, .. } in idle {
            // The server notices by itself, too.
            let _ = timeout(PING, connection.close()).await;
        }
    }
}

impl Reader<'_> {
    /// The connection, and how long it may take to answer.
    pub fn connection(&mut self) -> (&mut PgConnection, Duration) {
        (&mut self.connection, READ)
    }

    /// Returns the result of the read, and keeps the connection for the next read if it is still of use.
    pub fn ended<T>(self, read: Result<Result<T, sqlx::Error>, Elapsed>) -> Result<T, sqlx::Error> {
        let read = read.unwrap_or_else(|elapsed| Err(no_answer(elapsed)));
        match &read {
            Err(error) if is_out_of_reach(error) => self.readers.forget_idle(),
            _ => self.readers.idle().push(IdleConnection {
                connection: self.connection,
                since: Instant::now(),
            }),
        }
        read
    }
}

/// The error of a server that does not answer in time.
pub fn no_answer(_: Elapsed) -> sqlx::Error {
    sqlx::Error::Io(io::Error::new(
        io::ErrorKind::TimedOut,
        "the server does not answer",
    ))
}

/// Whether the database server is not there, goes down or comes up, or has ended the session.
pub fn is_out_of_reach(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Io(_) | sqlx::Error::PoolTimedOut => true,
        sqlx::Error::Database(error) => {
            // PostgreSQL, Error Codes: connection exceptions, operator intervention, too many
            // connections, a session that stood still in a transaction.
            let code = error.code().unwrap_or_default();
            code.starts_with("08") || code.starts_with("57P") || code == "53300" || code == "25P03"
        }
        _ => false,
    }
}
