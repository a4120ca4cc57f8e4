//! The one task that writes: operations are grouped into a commit and acknowledged after it.

use crate::ledger::LedgerError;
use crate::ledger::clock::{Clock, LedgerTime};
use futures::future::BoxFuture;
use sqlx::Connection;
use sqlx::sqlite::SqliteConnection;
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Operations in a commit. More would let the first wait longer than a sync to disk takes.
const GROUP: usize = 64;

type Acknowledge = Box<dyn FnOnce() + Send>;
type Operation = Box<
    dyn for<'c> FnOnce(
            &'c mut SqliteConnection,
            LedgerTime,
        ) -> BoxFuture<'c, Result<Acknowledge, LedgerError>>
        + Send,
>;

enum Message {
    Write(Operation),
    Close(oneshot::Sender<()>),
}

/// The door to the writing task.
pub struct Writer {
    operations: mpsc::Sender<Message>,
}

impl Writer {
    /// Starts the task; it ends when the writer is closed or dropped.
    pub fn start(connection: SqliteConnection, clock: Arc<dyn Clock>) -> Self {
        let (operations, queue) = mpsc::channel(4 * GROUP);
        tokio::spawn(run(connection, clock, queue));
        Self { operations }
    }

    /// Carries out an operation; the answer comes when it is durable.
    ///
    /// An operation checks first and writes then, so that a refusal leaves nothing behind. Only
    /// where the storage itself fails is the whole group rolled back.
    pub async fn write<T, F>(&self, operation: F) -> Result<T, LedgerError>
    where
        T: Send + 'static,
        F: for<'c> FnOnce(
                &'c mut SqliteConnection,
                LedgerTime,
            ) -> BoxFuture<'c, Result<T, LedgerError>>
            + Send
            + 'static,
    {
        let (reply, answer) = oneshot::channel();
        let operation: Operation = Box::new(move |connection, now| {
            let running = operation(connection, now);
            Box::pin(async move {
                match running.await {
                    Err(error @ (LedgerError::Storage(_) | LedgerError::Damaged(_))) => {
                        let copy = match &error {
                            LedgerError::Damaged(why) => LedgerError::Damaged(why.clone()),
                            other => LedgerError::Storage(other.to_string()),
                        };
                        // Whoever asked may have gone; the group is rolled back all the same.
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

async fn run(
    mut connection: SqliteConnection,
    clock: Arc<dyn Clock>,
    mut queue: mpsc::Receiver<Message>,
) {
    let mut closing = None;
    while closing.is_none() {
        match queue.recv().await {
            Some(Message::Write(first)) => {
                let group = commit_group(&mut connection, &*clock, first, &mut queue).await;
                match group {
                    Ok(close) => closing = close,
                    Err(error) => tracing::error!(%error, "a commit of the ledger failed"),
                }
            }
            Some(Message::Close(reply)) => closing = Some(reply),
            None => break,
        }
    }
    queue.close();
    if let Err(error) = connection.close().await {
        tracing::warn!(%error, "the ledger's file was not closed cleanly");
    }
    if let Some(reply) = closing {
        // Whoever closed it may have gone.
        let _ = reply.send(());
    }
}

/// One commit: the first operation and those that wait behind it.
async fn commit_group(
    connection: &mut SqliteConnection,
    clock: &dyn Clock,
    first: Operation,
    queue: &mut mpsc::Receiver<Message>,
) -> Result<Option<oneshot::Sender<()>>, LedgerError> {
    let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await?;
    let mut acknowledgements = Vec::new();
    let mut closing = None;
    let mut next = Some(first);
    while let Some(operation) = next.take() {
        acknowledgements.push(operation(&mut transaction, clock.now()).await?);
        if acknowledgements.len() < GROUP {
            match queue.try_recv() {
                Ok(Message::Write(operation)) => next = Some(operation),
                Ok(Message::Close(reply)) => closing = Some(reply),
                Err(_) => {}
            }
        }
    }
    transaction.commit().await?;
    for acknowledge in acknowledgements {
        acknowledge();
    }
    Ok(closing)
}
