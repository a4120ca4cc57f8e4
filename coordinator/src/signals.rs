//! Signals: hints that something has changed, so that nobody has to look all the time.
//!
//! A hint may be lost with the process or come for nothing; whoever waits for
//! one looks for himself after a while too.

use std::time::Duration;
use tokio::sync::watch;

/// One kind of hint.
#[derive(Debug)]
pub struct Signal(watch::Sender<u64>);

impl Default for Signal {
    fn default() -> Self {
        Self(watch::Sender::new(0))
    }
}

impl Signal {
    /// Wakes everybody who waits.
    pub fn raise(&self) {
        self.0.send_modify(|count| *count = count.wrapping_add(1));
    }

    /// To wait for hints from now on.
    pub fn listen(&self) -> Listener {
        Listener(self.0.subscribe())
    }
}

/// Waits for hints. One that comes between two waits is not missed.
#[derive(Debug)]
pub struct Listener(watch::Receiver<u64>);

impl Listener {
    /// Returns after the next hint, or after `most`.
    pub async fn wait(&mut self, most: Duration) {
        match tokio::time::timeout(most, self.0.changed()).await {
            Ok(Ok(())) | Err(_) => {}
            // Nobody is left who could give a hint.
            Ok(Err(_)) => tokio::time::sleep(most).await,
        }
    }
}

/// All hints of a coordinator.
#[derive(Debug, Default)]
pub struct Signals {
    /// There may be chunks to lease.
    pub work: Signal,
    /// A chunk was finished, or a job was submitted or cancelled: stewards look.
    pub stewards: Signal,
    /// Something about a job has changed that a watching client should hear.
    pub watchers: Signal,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_hint_between_two_waits_is_not_missed() {
        let signal = Signal::default();
        let mut listener = signal.listen();
        let start = std::time::Instant::now();
        signal.raise();
        listener.wait(Duration::from_secs(60)).await;
        assert!(start.elapsed() < Duration::from_secs(30));
        let start = std::time::Instant::now();
        listener.wait(Duration::from_millis(30)).await;
        assert!(start.elapsed() >= Duration::from_millis(30));
    }
}
