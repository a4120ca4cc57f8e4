//! Interruption: somebody wants this process to end.

use crate::error::ClientError;
use std::sync::LazyLock;
use tokio::signal::unix::{SignalKind, signal};

/// Returns when somebody wants this process to end: by SIGINT or SIGTERM, or by SIGHUP when the terminal is closed.
pub async fn interrupted() {
    let waiting = (
        signal(SignalKind::interrupt()),
        signal(SignalKind::terminate()),
    );
    match waiting {
        (Ok(mut interrupt), Ok(mut terminate)) => {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
                () = hung_up() => {}
            }
        }
        // Without handlers the signals end the process by themselves.
        _ => std::future::pending().await,
    }
}

/// Returns when the terminal is closed, unless this process was started so that it goes on then (`nohup`).
async fn hung_up() {
    // Looked at before a handler is set, and once: a handler is no `ignored` any more.
    static IS_IGNORED: LazyLock<bool> = LazyLock::new(|| {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        ignores_hangup(&status)
    });
    if *IS_IGNORED {
        return std::future::pending().await;
    }
    match signal(SignalKind::hangup()) {
        Ok(mut hangup) => drop(hangup.recv().await),
        Err(_) => std::future::pending().await,
    }
}

/// Whether the status of a process (proc(5)) has SIGHUP among its ignored signals: the lowest bit of the mask.
fn ignores_hangup(status: &str) -> bool {
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 == 1)
}

/// Does this work, unless somebody wants this process to end first.
pub async fn unless_interrupted<T>(
    work: impl Future<Output = Result<T, ClientError>>,
) -> Result<T, ClientError> {
    tokio::select! {
        ended = work => ended,
        () = interrupted() => Err(ClientError::Interrupted),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nohup_has_started_ignores_hangups() {
        let status = |mask: &str| format!("Name:\tcognate\nSigIgn:\t{mask}\nSigCgt:\t0001\n");
        assert!(ignores_hangup(&status("0000000000001001")));
        assert!(!ignores_hangup(&status("0000000000001000")));
        assert!(!ignores_hangup(""));
    }
}
