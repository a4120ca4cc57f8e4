//! Interruption: somebody wants this process to end.

use crate::error::ClientError;
use tokio::signal::unix::{SignalKind, signal};

/// Returns when somebody wants this process to end.
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
            }
        }
        // Without handlers the signals end the process by themselves.
        _ => std::future::pending().await,
    }
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
