//! Transport: the listeners by which workers and clients come in.
//!
//! One gRPC service behind all of them.

pub mod introduction;
pub mod same_user;
pub mod shared_memory;
pub mod tcp;
pub mod unix;

use self::introduction::{AddressTurn, Connections, Introduced};
use crate::api::security::Security;
use crate::config::ListenAddress;
use futures::Stream;
use std::io;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream, UnixStream};

/// Where no connection can be accepted, the next is tried after this time. Default 100 ms: when
/// descriptors have run out, trying at once would only burn the processor.
const PAUSE: Duration = Duration::from_millis(100);

/// Why a listener does not open.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// Nothing to listen on.
    #[error("there is no address to listen on")]
    NoAddress,
    /// The system refuses it.
    #[error("cannot listen on {address}: {source}")]
    Bind {
        /// The address that was to be listened at.
        address: ListenAddress,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// Anybody could come in.
    #[error(
        "{address} can be reached from other machines: give it --token-file, or --tls-client-ca \
         with a certificate of its own; or say --insecure to ask nobody there who they are"
    )]
    BeyondLoopback {
        /// The address that was to be listened at.
        address: ListenAddress,
    },
    /// The page would be anybody's.
    #[error(
        "the page at {address} can be reached from other machines: give it --token-file with --tls-certificate \
         and --tls-key; or say --insecure to ask nobody there who they are"
    )]
    PageBeyondLoopback {
        /// The address that was to be listened at.
        address: String,
    },
    /// A listener with TLS and no certificate.
    #[error("{address} needs a certificate: --tls-certificate and --tls-key")]
    NoCertificate {
        /// The address that was to be listened at.
        address: ListenAddress,
    },
    /// Another process listens there.
    #[error("another process listens on {address}")]
    Taken {
        /// The address that was to be listened at.
        address: ListenAddress,
    },
}

/// Callers whose connections are accepted, before any credentials are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Callers {
    /// All callers: either they show credentials, or none are required.
    All,
    /// Callers of this process's user, on this machine.
    SameUser,
}

impl Callers {
    /// Whether a connection is taken. One whose user cannot be found out is not.
    async fn takes(self, stream: &TcpStream, peer: SocketAddr) -> bool {
        if self == Self::All {
            return true;
        }
        let Ok(local_address) = stream.local_addr() else {
            return false;
        };
        let looked =
            tokio::task::spawn_blocking(move || same_user::user_of(peer, local_address)).await;
        let user = looked.ok().flatten();
        let takes = user == Some(rustix::process::geteuid().as_raw());
        if user.is_none() {
            // A probe that connects and leaves has no socket any more when it is looked for.
            tracing::debug!(%peer, "a connection is closed: nobody has its other end");
        } else if !takes {
            tracing::warn!(%peer, ?user, "a connection of another user is refused: \
                give them tokens with --token-file, or say --insecure to ask nobody who they are");
        }
        takes
    }
}

/// A listener that is open: the socket is bound, and connections queue up.
#[derive(Debug)]
pub enum Listener {
    /// TCP.
    Tcp(TcpListener, Callers),
    /// TCP and TLS.
    Tls(TcpListener, Callers),
    /// A Unix socket, which is removed when the listener closes.
    Unix(unix::Socket),
}

impl Listener {
    /// Binds an address; one that others can reach only where callers are known, or if `insecure`.
    /// With a certificate, every TCP listener speaks TLS.
    pub async fn open(
        address: &ListenAddress,
        security: &Security,
        insecure: bool,
    ) -> Result<Self, ListenError> {
        let open_to_all = insecure || security.knows_callers();
        let callers = match open_to_all {
            true => Callers::All,
            false => Callers::SameUser,
        };
        match address {
            ListenAddress::Tcp(authority) | ListenAddress::Tls(authority)
                if security.tls.is_some() =>
            {
                let listener = tcp::bind(authority, open_to_all).await?;
                Ok(Self::Tls(listener, callers))
            }
            ListenAddress::Tls(_) => Err(ListenError::NoCertificate {
                address: address.clone(),
            }),
            ListenAddress::Tcp(authority) => {
                let listener = tcp::bind(authority, open_to_all).await?;
                let beyond = !listener.local_addr().is_ok_and(|a| a.ip().is_loopback());
                if beyond && security.tokens.is_some() {
                    tracing::warn!(%address, "tokens travel in the clear: give it --tls-certificate");
                }
                Ok(Self::Tcp(listener, callers))
            }
            ListenAddress::Unix(path) => unix::Socket::bind(path).await.map(Self::Unix),
        }
    }

    /// Where it is; with the port that was free where port 0 was asked for.
    pub fn address(&self) -> ListenAddress {
        let bound = |listener: &TcpListener| {
            let address = listener.local_addr();
            address.map_or_else(|e| e.to_string(), |address| address.to_string())
        };
        match self {
            Self::Tcp(listener, _) => ListenAddress::Tcp(bound(listener)),
            Self::Tls(listener, _) => ListenAddress::Tls(bound(listener)),
            Self::Unix(socket) => ListenAddress::Unix(socket.path().to_owned()),
        }
    }
}

/// Connections over TCP, without end.
pub fn tcp_connections(
    listener: TcpListener,
    callers: Callers,
    connections: Connections,
) -> impl Stream<Item = io::Result<Introduced<TcpStream>>> {
    futures::stream::unfold(
        (listener, connections),
        move |(listener, connections)| async move {
            loop {
                let place = connections.place().await;
                let accepted = match listener.accept().await {
                    Ok((stream, peer)) => {
                        let Some(turn) = connections.of_address(peer.ip()) else {
                            tracing::warn!(%peer, "a connection is closed: its address has as many as it may");
                            continue;
                        };
                        if !callers.takes(&stream, peer).await {
                            continue;
                        }
                        // Small messages go out at once.
                        stream.set_nodelay(true).map(|()| (stream, turn))
                    }
                    Err(error) => Err(error),
                };
                match accepted {
                    Ok((stream, turn)) => {
                        let stream = connections.introduce(stream, place, turn);
                        return Some((Ok(stream), (listener, connections)));
                    }
                    Err(error) => not_accepted(&error).await,
                }
            }
        },
    )
}

/// Connections over a Unix socket, without end.
pub fn unix_connections(
    socket: unix::Socket,
    connections: Connections,
) -> impl Stream<Item = io::Result<Introduced<UnixStream>>> {
    futures::stream::unfold((socket, connections), |(socket, connections)| async move {
        loop {
            let place = connections.place().await;
            match socket.accept().await {
                Ok(stream) => {
                    let stream = connections.introduce(stream, place, AddressTurn::default());
                    return Some((Ok(stream), (socket, connections)));
                }
                Err(error) => not_accepted(&error).await,
            }
        }
    })
}

async fn not_accepted(error: &io::Error) {
    tracing::warn!(%error, "a connection could not be accepted");
    tokio::time::sleep(PAUSE).await;
}
