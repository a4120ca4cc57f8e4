//! Introduction: a connection that says nothing is closed, and there are only so many.
//!
//! Whoever has sent the beginning of HTTP/2 is asked by pings whether it lives; whoever has not would stay
//! for ever, and take a descriptor that ledger and store need.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::future::Future;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
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
    /// Until a connection has introduced itself. Default 10 s.
    pub patience: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        Self {
            most: 10_000,
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
}

impl Connections {
    /// None yet; as many as are allowed and descriptors allow.
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
        }
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
    pub fn introduce<S>(&self, stream: S, place: OwnedSemaphorePermit) -> Introduced<S> {
        Introduced {
            stream,
            heard: 0,
            deadline: Some(Box::pin(sleep(self.patience))),
            _place: place,
        }
    }
}

/// A connection that is closed when it does not introduce itself in time.
#[derive(Debug)]
pub struct Introduced<S> {
    stream: S,
    heard: usize,
    /// None once it has.
    deadline: Option<Pin<Box<Sleep>>>,
    _place: OwnedSemaphorePermit,
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
