//! The one task that writes: operations are grouped into a commit and acknowledged after it.

use super::damage::Damage;
use super::engine::{Connection, Engine};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::measures::StorageMeasures;
use futures::future::BoxFuture;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, oneshot};

/// Operations in a commit. More would let the first wait longer than a sync to disk takes.
const GROUP: usize = 64;
/// Time for which a write waits for a server that is away: crash recovery of a ledger takes seconds.
const AWAY: Duration = Duration::from_secs(10);
/// Pause after the first attempt to reach the server; it doubles after each attempt.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
/// Longest pause between two attempts to reach the server.
const LARGEST_PAUSE: Duration = Duration::from_millis(500);

type Acknowledge = Box<dyn FnOnce() + Send>;
type Operation = Box<
    dyn for<'c> FnOnce(
            &'c mut Connection,
            LedgerTime,
        ) -> BoxFuture<'c, Result<Acknowledge, LedgerError>>
        + Send,
>;

enum Message {
    Write(Operation),
    Close(oneshot::Sender<()>),
}

/// The way to the writing task.
pub struct Writer {
    operations: mpsc::Sender<Message>,
    damage: Damage,
}

impl Writer {
    /// Starts the task; it ends when the writer is closed or dropped.
    pub fn start(
        engine: Engine,
        connection: Connection,
        measures: Arc<OnceLock<Arc<StorageMeasures>>>,
        damage: Damage,
    ) -> Self {
        let (operations, queue) = mpsc::channel(4 * GROUP);
        let noted = damage.clone();
        tokio::spawn(run(engine, connection, queue, measures, noted));
        Self { operations, damage }
    }

    /// Carries out an operation; the answer comes when it is durable.
    ///
    /// An operation checks first and writes then, so that a refusal leaves nothing behind. Only
    /// where the storage itself fails is the whole group rolled back.
    pub async fn write<T, F>(&self, operation: F) -> Result<T, LedgerError>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(&'c mut Connection, LedgerTime) -> BoxFuture<'c, Result<T, LedgerError>>
            + Send
            + 'static,
    {
        // A write into a damaged file is as good as lost.
        self.damage.refuse()?;
        let (reply, answer) = oneshot::channel();
        let operation: Operation = Box::new(move |connection, now| {
            let running = operation(connection, now);
            Box::pin(async move {
                match running.await {
                    Err(
                        error @ (LedgerError::Storage(_)
                        | LedgerError::Malformed(_)
                        | LedgerError::Unreachable(_)
                        | LedgerError::Damaged(_)),
                    ) => {
                        let copy = match &error {
                            LedgerError::Damaged(why) => LedgerError::Damaged(why.clone()),
                            LedgerError::Unreachable(why) => LedgerError::Unreachable(why.clone()),
                            LedgerError::Malformed(why) => LedgerError::Malformed(why.clone()),
                            other => LedgerError::Storage(other.to_string()),
                        };
                        // The receiver may be gone; the group is rolled back all the same.
                        let _ = reply.send(Err(copy));
                        Err(error)
                    }
                    result => Ok(Box::new(move || {
                        let _ = reply.send(result);
                    }) as Acknowledge),
                }
            })
        });
        self.operations
            .send(Message::Write(operation))
            .await
            .map_err(|_| LedgerError::Closed)?;
        answer.await.unwrap_or_else(|_| {
            Err(LedgerError::Storage(
                "the commit that this write was part of was rolled back".into(),
            ))
        })
    }

    /// Writes what is queued, then closes the connection.
    pub async fn close(&self) {
        let (reply, done) = oneshot::channel();
        if self.operations.send(Message::Close(reply)).await.is_ok() {
            // The task answers or has ended: closed either way.
            let _ = done.await;
        }
    }
}

/// The connection that writes, made anew after the server was away.
struct Link {
    engine: Engine,
    /// Connection to the database; `None` while the server is away.
    connection: Option<Connection>,
    /// Time since which the server is away.
    away_since: Option<Instant>,
}

impl Link {
    /// Begins a commit and returns its time. A server that is away is waited for, [`AWAY`] in all; after that each
    /// call makes one attempt, so that a caller hears soon that nothing is written.
    ///
    /// Nothing was written before this: a dead connection costs no caller its write.
    async fn begin(&mut self) -> Result<(&mut Connection, LedgerTime), LedgerError> {
        let mut pause = FIRST_PAUSE;
        let now = loop {
            match self.try_begin().await {
                Ok(now) => break now,
                Err(error @ LedgerError::Unreachable(_)) => {
                    self.connection = None;
                    let since = *self.away_since.get_or_insert_with(Instant::now);
                    if since.elapsed() >= AWAY {
                        return Err(error);
                    }
                    if pause == FIRST_PAUSE {
                        tracing::warn!(%error, "waiting for the ledger's database");
                    }
                    tokio::time::sleep(pause).await;
                    pause = (2 * pause).min(LARGEST_PAUSE);
                }
                Err(error) => return Err(error),
            }
        };
        self.away_since = None;
        match &mut self.connection {
            Some(connection) => Ok((connection, now)),
            None => Err(LedgerError::Closed),
        }
    }

    async fn try_begin(&mut self) -> Result<LedgerTime, LedgerError> {
        let connection = match &mut self.connection {
            Some(connection) => connection,
            none => none.insert(self.engine.connect().await?),
        };
        connection.begin().await
    }

    /// Takes back what was written, or gives the connection up.
    async fn roll_back(&mut self) {
        if let Some(connection) = &mut self.connection
            && connection.roll_back().await.is_err()
        {
            self.connection = None;
        }
    }
}

async fn run(
    engine: Engine,
    connection: Connection,
    mut queue: mpsc::Receiver<Message>,
    measures: Arc<OnceLock<Arc<StorageMeasures>>>,
    damage: Damage,
) {
    let mut closing = None;
    let mut link = Link {
        engine,
        connection: Some(connection),
        away_since: None,
    };
    while closing.is_none() {
        match queue.recv().await {
            Some(Message::Write(first)) => {
                let begin = Instant::now();
                let written = match link.begin().await {
                    Ok((connection, now)) => {
                        let done = commit_group(connection, now, first, &mut queue).await;
                        done.map_err(|error| (error, "a commit of the ledger failed"))
                    }
                    // Each caller gets an error and tries again.
                    Err(error) => Err((error, "nothing is written")),
                };
                if let Some(measures) = measures.get() {
                    measures.commits.observe(begin.elapsed(), written.is_err());
                }
                match written {
                    Ok(close) => closing = close,
                    Err((error, what)) => {
                        tracing::error!(%error, "{what}");
                        damage.note(&error);
                        match error {
                            // The server rolls back what a session had begun that is closed.
                            LedgerError::Unreachable(_) => link.connection = None,
                            _ => link.roll_back().await,
                        }
                    }
                }
            }
            Some(Message::Close(reply)) => closing = Some(reply),
            None => break,
        }
    }
    queue.close();
    if let Some(connection) = link.connection
        && let Err(error) = connection.close().await
    {
        tracing::warn!(%error, "the ledger was not closed cleanly");
    }
    if let Some(reply) = closing {
        // The receiver may be gone.
        let _ = reply.send(());
    }
}

/// One commit that has begun: the first operation and those that wait behind it.
async fn commit_group(
    connection: &mut Connection,
    now: LedgerTime,
    first: Operation,
    queue: &mut mpsc::Receiver<Message>,
) -> Result<Option<oneshot::Sender<()>>, LedgerError> {
    let mut acknowledgements = Vec::new();
    let mut closing = None;
    let mut next = Some(first);
    while let Some(operation) = next.take() {
        acknowledgements.push(operation(connection, now).await?);
        if acknowledgements.len() < GROUP {
            match queue.try_recv() {
                Ok(Message::Write(operation)) => next = Some(operation),
                Ok(Message::Close(reply)) => closing = Some(reply),
                Err(_) => {}
            }
        }
    }
    connection.commit().await?;
    for acknowledge in acknowledgements {
        acknowledge();
    }
    Ok(closing)
}
