//! Metrics: what the ledger says, as Prometheus reads it. Counts only, no names of problems.
//!
//! A listener of its own (`--metrics HOST:PORT`), plain HTTP: `GET /metrics`. Every answer is
//! asked of the ledger, so that any coordinator over a database says the same.

use crate::ledger::rows::JobState;
use crate::ledger::{Ledger, LedgerError};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Mutex;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// The latest jobs and workers that are counted.
const ROWS: u32 = 10_000;
/// A worker that was silent for longer counts as gone. Default 60 s: six heartbeats.
const PRESENT_MS: u64 = 60_000;
/// Who asks has so long to say what, and to take the answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Bytes of a request.
const REQUEST_BYTES: usize = 8192;

/// An answer is good for so long: however many ask, the ledger is asked once in this time.
const FRESH: Duration = Duration::from_secs(5);

/// The last answer, which is made by one asker at a time.
#[derive(Default)]
struct Latest(Mutex<Option<(Instant, String)>>);

impl Latest {
    async fn text(&self, ledger: &dyn Ledger) -> Result<String, LedgerError> {
        let mut latest = self.0.lock().await;
        if let Some((made, text)) = &*latest
            && made.elapsed() < FRESH
        {
            return Ok(text.clone());
        }
        let text = metrics(ledger).await?;
        *latest = Some((Instant::now(), text.clone()));
        Ok(text)
    }
}

/// Answers until the service stops.
pub async fn serve(listener: TcpListener, ledger: Arc<dyn Ledger>, stopping: CancellationToken) {
    let latest = Arc::new(Latest::default());
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = stopping.cancelled() => return,
        };
        match accepted {
            Ok((stream, _)) => {
                let (ledger, latest) = (Arc::clone(&ledger), Arc::clone(&latest));
                tokio::spawn(async move {
                    // Who does not take its answer has none.
                    let _ = tokio::time::timeout(PATIENCE, answer(stream, &*ledger, &latest)).await;
                });
            }
            Err(error) => {
                tracing::warn!(%error, "a connection for metrics could not be accepted");
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
}

async fn answer(
    mut stream: TcpStream,
    ledger: &dyn Ledger,
    latest: &Latest,
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
    let asked = (words.next(), words.next());
    let (status, body) = match asked {
        (Some("GET"), Some("/metrics")) => match latest.text(ledger).await {
            Ok(text) => ("200 OK", text),
            Err(error) => ("503 Service Unavailable", format!("{error}\n")),
        },
        _ => ("404 Not Found", "only GET /metrics\n".to_owned()),
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

/// A family of values, each with its label.
fn family(text: &mut String, name: &str, kind: &str, help: &str, values: &[(String, u64)]) {
    // Writing to a text does not fail.
    let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
    for (labels, value) in values {
        let _ = writeln!(text, "{name}{labels} {value}");
    }
}

fn label(name: &str, value: &str) -> String {
    let value = value.replace('\\', "\\\\").replace('"', "\\\"");
    format!("{{{name}=\"{}\"}}", value.replace('\n', " "))
}

/// All of it, in the text format of Prometheus.
pub async fn metrics(ledger: &dyn Ledger) -> Result<String, LedgerError> {
    let mut states: BTreeMap<&str, u64> = JobState::ALL
        .iter()
        .map(|state| (state.name(), 0))
        .collect();
    let mut chunks = [0; 3];
    let mut paths: BTreeMap<&str, u64> = BTreeMap::new();
    let mut micros = 0;
    let mut speculative = [0; 2];
    for job in ledger.jobs(ROWS).await? {
        *states.entry(job.state.name()).or_default() += 1;
        for stage in ledger.stages(job.job).await? {
            if !job.state.has_ended() {
                chunks[0] += stage.ready.chunks;
                chunks[1] += stage.leased.chunks;
                chunks[2] += stage.accepted.chunks + stage.failed.chunks;
            }
            *paths.entry("regular").or_default() += stage.outcomes.regular;
            *paths.entry("singular").or_default() += stage.outcomes.singular;
            *paths.entry("failed").or_default() += stage.outcomes.failed;
            micros += stage.cpu_micros;
            speculative[0] += stage.speculative_leases;
            speculative[1] += stage.speculative_won;
        }
    }
    let now = ledger.now().await?;
    let mut workers: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    for worker in ledger.workers(ROWS).await? {
        if now.since_ms(worker.last_seen) <= PRESENT_MS {
            let of_kind = workers.entry(worker.says.transport).or_default();
            of_kind.0 += 1;
            of_kind.1 += u64::from(worker.says.threads);
        }
    }
    let mut text = String::new();
    let named = |counts: BTreeMap<&str, u64>, name: &str| -> Vec<(String, u64)> {
        counts.iter().map(|(k, v)| (label(name, k), *v)).collect()
    };
    let jobs = named(states, "state");
    family(&mut text, "cognate_jobs", "gauge", "Jobs by state.", &jobs);
    let of_chunks = ["ready", "leased", "done"].iter().zip(chunks);
    let of_chunks: Vec<_> = of_chunks.map(|(k, v)| (label("state", k), v)).collect();
    let help = "Chunks of jobs that have not ended; ready ones wait for a worker.";
    family(&mut text, "cognate_chunks", "gauge", help, &of_chunks);
    let help = "Paths accepted, of all stages, by how they ended.";
    let of_paths = named(paths, "outcome");
    family(&mut text, "cognate_paths_total", "counter", help, &of_paths);
    let help = "CPU time of accepted chunks, in microseconds.";
    let time = [(String::new(), micros)];
    family(
        &mut text,
        "cognate_tracking_microseconds_total",
        "counter",
        help,
        &time,
    );
    let of_speculative = [
        (
            "cognate_speculative_leases_total",
            "Late chunks that were given to a second worker.",
        ),
        (
            "cognate_speculative_leases_won_total",
            "Late chunks that the second worker reported first.",
        ),
    ];
    for ((name, help), value) in of_speculative.into_iter().zip(speculative) {
        family(&mut text, name, "counter", help, &[(String::new(), value)]);
    }
    let of = |count: fn(&(u64, u64)) -> u64| -> Vec<(String, u64)> {
        let counts = workers.iter();
        counts
            .map(|(k, v)| (label("transport", k), count(v)))
            .collect()
    };
    let help = "Workers heard of in the last minute.";
    family(&mut text, "cognate_workers", "gauge", help, &of(|c| c.0));
    let help = "Their tracking threads.";
    family(
        &mut text,
        "cognate_worker_threads",
        "gauge",
        help,
        &of(|c| c.1),
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::clock::ManualClock;
    use crate::ledger::conformance::*;
    use crate::ledger::memory::MemoryLedger;
    use crate::ledger::rows::Advance;

    async fn busy() -> Arc<dyn Ledger> {
        let ledger = MemoryLedger::new(Arc::new(ManualClock::default()));
        let job = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
        let job = job.job;
        let epoch = ledger.steward(job, &coordinator("c"), 1000).await;
        let open = Advance {
            open: vec![stage(0, 100, 10)],
            ..Advance::default()
        };
        ledger
            .advance(job, epoch.unwrap().unwrap(), open)
            .await
            .unwrap();
        let lease = ledger.lease(wants("w", "q", 1)).await.unwrap()[0].clone();
        let object = result(lease.items, 1, 7_000);
        ledger.complete(lease.lease, object).await.unwrap();
        Arc::new(ledger)
    }

    #[tokio::test]
    async fn what_the_ledger_says_is_counted() {
        let text = metrics(&*busy().await).await.unwrap();
        assert!(text.contains("cognate_jobs{state=\"running\"} 1"), "{text}");
        assert!(
            text.contains("cognate_chunks{state=\"leased\"} 0"),
            "{text}"
        );
        assert!(text.contains("cognate_chunks{state=\"done\"} 1"), "{text}");
        assert!(text.contains("cognate_tracking_microseconds_total 7000"));
        assert!(text.contains("cognate_speculative_leases_total 0"));
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (name, value) = line.rsplit_once(' ').expect("name and value");
            assert!(name.starts_with("cognate_") && value.parse::<u64>().is_ok());
        }
    }

    #[tokio::test]
    async fn it_is_read_by_http() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let stop = CancellationToken::new();
        let serving = tokio::spawn(serve(listener, busy().await, stop.clone()));
        let ask = async |what: &str| {
            let mut stream = TcpStream::connect(address).await.unwrap();
            let request = format!("{what} HTTP/1.1\r\nHost: x\r\n\r\n");
            stream.write_all(request.as_bytes()).await.unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).await.unwrap();
            answer
        };
        let answer = ask("GET /metrics").await;
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        assert!(answer.contains("# TYPE cognate_chunks gauge"), "{answer}");
        assert!(ask("GET /").await.starts_with("HTTP/1.1 404"));
        stop.cancel();
        serving.await.unwrap();
    }
}
