//! Introduction: a connection that stays silent is closed, and the number of connections is limited.
//!
//! A connection that has sent the beginning of HTTP/2 is checked by pings. A connection that has not would stay for
//! ever, and take a descriptor that ledger and store need.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::collections::HashMap;
use std::future::Future;
use std::io;
use std::net::{IpAddr, Ipv6Addr};
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Sleep, sleep};
use tonic::transport::server::Connected;

/// Bytes that every HTTP/2 connection begins with (RFC 9113, section 3.4); of TLS, a part of the greeting.
const PREFACE: usize = 24;
/// Descriptors that are kept for ledger, store, logs and what else is opened.
const KEPT: u64 = 256;

/// How many connections there may be, and how long one may be silent at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConnectionLimits {
    /// Connections of all listeners. Default 10,000; fewer where the system gives fewer descriptors.
    pub most: usize,
    /// Connections of one address (of IPv6: of one network of 64 bits). Default: no limit, as the workers of a
    /// cluster may share one.
    pub most_of_one_address: Option<usize>,
    /// Until a connection has introduced itself. Default 10 s.
    pub patience: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        Self {
            most: 10_000,
            most_of_one_address: None,
            patience: Duration::from_secs(10),
        }
    }
}

/// Raises the limit of open files as far as the system lets it.
pub fn raise_open_files() {
    let limit = getrlimit(Resource::Nofile);
    let raised = Rlimit {
        current: limit.maximum,
        ..limit
    };
    if limit.current != limit.maximum
        && let Err(error) = setrlimit(Resource::Nofile, raised)
    {
        tracing::debug!(%error, "the limit of open files stays as it is");
    }
}

/// The connections of all listeners.
#[derive(Clone, Debug)]
pub struct Connections {
    places: Arc<Semaphore>,
    patience: Duration,
    most_of_one_address: Option<usize>,
    by_address: Arc<Mutex<HashMap<IpAddr, usize>>>,
}

impl Connections {
    /// Empty set of connections, limited by `limits` and by the descriptors of the process.
    pub fn new(limits: ConnectionLimits) -> Self {
        let files = getrlimit(Resource::Nofile).current.unwrap_or(u64::MAX);
        // Half of what there is where there is little.
        let files = files.saturating_sub(KEPT).max(files / 2);
        let most = usize::try_from(files)
            .unwrap_or(usize::MAX)
            .min(limits.most);
        Self {
            places: Arc::new(Semaphore::new(most.max(1))),
            patience: limits.patience,
            most_of_one_address: limits.most_of_one_address,
            by_address: Arc::default(),
        }
    }

    /// Counts a connection of this address; `None` where the address has as many as it may.
    pub fn of_address(&self, address: IpAddr) -> Option<AddressTurn> {
        let Some(most) = self.most_of_one_address else {
            return Some(AddressTurn(None));
        };
        let network = network_of(address);
        let mut counts = lock(&self.by_address);
        let count = counts.entry(network).or_default();
        if *count >= most {
            return None;
        }
        *count += 1;
        Some(AddressTurn(Some((Arc::clone(&self.by_address), network))))
    }

    /// Waits until there may be one more: the system holds those that come meanwhile.
    pub async fn place(&self) -> OwnedSemaphorePermit {
        if self.places.available_permits() == 0 {
            tracing::warn!("as many connections as there may be: others wait");
        }
        let place = Arc::clone(&self.places).acquire_owned().await;
        place.expect("the places are never closed")
    }

    /// A connection that has this place and is to introduce itself.
    pub fn introduce<S>(
        &self,
        stream: S,
        place: OwnedSemaphorePermit,
        turn: AddressTurn,
    ) -> Introduced<S> {
        Introduced {
            stream,
            heard: 0,
            deadline: Some(Box::pin(sleep(self.patience))),
            _place: place,
            _turn: turn,
        }
    }
}

/// Counts of connections by network.
type Counts = Arc<Mutex<HashMap<IpAddr, usize>>>;

/// A connection that counts for its address as long as this lives.
#[derive(Debug, Default)]
pub struct AddressTurn(Option<(Counts, IpAddr)>);

impl Drop for AddressTurn {
    fn drop(&mut self) {
        let Some((counts, network)) = &self.0 else {
            return;
        };
        let mut counts = lock(counts);
        if let Some(count) = counts.get_mut(network) {
            *count -= 1;
            if *count == 0 {
                counts.remove(network);
            }
        }
    }
}

fn lock(
    counts: &Mutex<HashMap<IpAddr, usize>>,
) -> std::sync::MutexGuard<'_, HashMap<IpAddr, usize>> {
    counts.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The address itself of IPv4; of IPv6 the network of 64 bits, of which a subscriber has all addresses (RFC 6177).
fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let network = u128::from(address) & !u128::from(u64::MAX);
            Ipv6Addr::from(network).into()
        }
        address => address,
    }
}

/// A connection that is closed when it does not introduce itself in time.
#[derive(Debug)]
pub struct Introduced<S> {
    stream: S,
    heard: usize,
    /// Time until the introduction; `None` once it has come.
    deadline: Option<Pin<Box<Sleep>>>,
    _place: OwnedSemaphorePermit,
    _turn: AddressTurn,
}

impl<S: AsyncRead + Unpin> AsyncRead for Introduced<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if let Some(deadline) = &mut self.deadline
            && deadline.as_mut().poll(cx).is_ready()
        {
            tracing::debug!("a connection that did not introduce itself is closed");
            return Poll::Ready(Err(io::ErrorKind::TimedOut.into()));
        }
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.stream).poll_read(cx, buffer);
        if self.deadline.is_some() {
            self.heard += buffer.filled().len() - before;
            if self.heard >= PREFACE {
                self.deadline = None;
            }
        }
        read
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Introduced<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write_vectored(cx, bytes)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

impl<S: Connected> Connected for Introduced<S> {
    type ConnectInfo = S::ConnectInfo;

    fn connect_info(&self) -> Self::ConnectInfo {
        self.stream.connect_info()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_address_has_only_so_many_connections() {
        let connections = Connections::new(ConnectionLimits {
            most_of_one_address: Some(2),
            ..ConnectionLimits::default()
        });
        let connection_of = |address: &str| connections.of_address(address.parse().unwrap());
        let first = connection_of("192.0.2.1");
        let second = connection_of("::ffff:192.0.2.1");
        assert!(first.is_some() && second.is_some());
        assert!(
            connection_of("192.0.2.1").is_none(),
            "IPv4 within IPv6 is the same address"
        );
        assert!(connection_of("192.0.2.2").is_some());
        drop(first);
        assert!(connection_of("192.0.2.1").is_some());
        let neighbours = [
            connection_of("2001:db8::1"),
            connection_of("2001:db8::ffff:1"),
        ];
        assert!(neighbours.iter().all(Option::is_some));
        assert!(connection_of("2001:db8::2").is_none());
        assert!(connection_of("2001:db8:0:1::2").is_some());
        drop((second, neighbours));
        assert!(lock(&connections.by_address).is_empty());
    }
}
