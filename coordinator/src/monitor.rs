//! Monitor: answers an operator's programs by plain HTTP, with metrics and with whether this coordinator lives and
//! serves.
//!
//! It has a listener of its own (`--metrics HOST:PORT`): `GET /metrics` for Prometheus, `GET /live` and `GET /ready`
//! for probes. It requires no credentials, and gives counts only, no names of problems.

use crate::api::accounting::CallMeasures;
use crate::coordinator::Coordinator;
use crate::ledger::LedgerError;
use crate::measures::{StorageMeasures, write_process};
use crate::metrics::{Waiting, metrics};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Mutex;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// Time that a client has to send its request and to take the answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Bytes of a request.
const REQUEST_BYTES: usize = 8192;
/// Time for which metrics of the ledger are reused, so that any number of clients costs one query.
const FRESH: Duration = Duration::from_secs(5);

/// Service that answers an operator's programs.
pub struct Monitor {
    coordinator: Arc<Coordinator>,
    calls: Arc<CallMeasures>,
    storage: Arc<StorageMeasures>,
    /// Last metrics of the ledger with their time, and the times since when jobs wait. One request at a time renews
    /// them.
    latest: Mutex<(Option<(Instant, String)>, Waiting)>,
}

impl Monitor {
    /// Monitor of this coordinator, its calls and its storage.
    pub fn new(
        coordinator: Arc<Coordinator>,
        calls: Arc<CallMeasures>,
        storage: Arc<StorageMeasures>,
    ) -> Self {
        Self {
            coordinator,
            calls,
            storage,
            latest: Mutex::default(),
        }
    }

    /// Answers until the service stops.
    pub async fn serve(self, listener: TcpListener, stopping: CancellationToken) {
        let monitor = Arc::new(self);
        loop {
            let accepted = tokio::select! {
                accepted = listener.accept() => accepted,
                () = stopping.cancelled() => return,
            };
            match accepted {
                Ok((stream, _)) => {
                    let (monitor, stopping) = (Arc::clone(&monitor), stopping.clone());
                    tokio::spawn(async move {
                        // A client that does not take its answer gets none.
                        let answered = monitor.answer(stream, &stopping);
                        let _ = tokio::time::timeout(PATIENCE, answered).await;
                    });
                }
                Err(error) => {
                    tracing::warn!(%error, "a connection for metrics could not be accepted");
                    tokio::time::sleep(Duration::from_millis(100)).await;
                }
            }
        }
    }

    async fn metrics(&self) -> Result<String, LedgerError> {
        let mut text = self.of_the_ledger().await?;
        self.calls.write(&mut text);
        self.storage.write(&mut text);
        self.coordinator.events().write(&mut text);
        write_process(&mut text);
        Ok(text)
    }

    async fn of_the_ledger(&self) -> Result<String, LedgerError> {
        let mut latest = self.latest.lock().await;
        let (kept, waiting) = &mut *latest;
        if let Some((made, text)) = kept
            && made.elapsed() < FRESH
        {
            return Ok(text.clone());
        }
        let text = metrics(self.coordinator.ledger(), waiting).await?;
        *kept = Some((Instant::now(), text.clone()));
        Ok(text)
    }

    /// Why calls are not answered as they should be; empty where they are.
    fn troubles(&self, stopping: &CancellationToken) -> Vec<String> {
        let mut troubles = self.coordinator.health().troubles();
        if stopping.is_cancelled() {
            troubles.push("this coordinator is stopping".to_owned());
        }
        troubles
    }

    async fn answer(
        &self,
        mut stream: TcpStream,
        stopping: &CancellationToken,
    ) -> std::io::Result<()> {
        let mut request = Vec::new();
        let mut piece = [0; 1024];
        while !request.windows(4).any(|end| end == b"\r\n\r\n") {
            let read = stream.read(&mut piece).await?;
            if read == 0 || request.len() > REQUEST_BYTES {
                return Ok(());
            }
            request.extend_from_slice(&piece[..read]);
        }
        let line = String::from_utf8_lossy(&request);
        let mut words = line.split_whitespace();
        let unavailable = "503 Service Unavailable";
        let (status, body) = match (words.next(), words.next()) {
            (Some("GET"), Some("/metrics")) => match self.metrics().await {
                Ok(text) => ("200 OK", text),
                Err(error) => (unavailable, format!("{error}\n")),
            },
            (Some("GET"), Some("/live")) => ("200 OK", "live\n".to_owned()),
            (Some("GET"), Some("/ready")) => match self.troubles(stopping) {
                troubles if troubles.is_empty() => ("200 OK", "ready\n".to_owned()),
                troubles => (unavailable, format!("{}\n", troubles.join("\n"))),
            },
            _ => (
                "404 Not Found",
                "only GET /metrics, /live and /ready\n".to_owned(),
            ),
        };
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4\r\n\
             Content-Length: {}\r\nConnection: close\r\n\r\n",
            body.len()
        );
        stream.write_all(head.as_bytes()).await?;
        stream.write_all(body.as_bytes()).await?;
        stream.shutdown().await
    }
}
