//! Transport: the doors by which workers and clients come in.
//!
//! One gRPC service behind all of them; shared memory on one host will be one more.

pub mod tcp;
pub mod unix;

use crate::config::ListenAddress;

/// Why a door does not open.
#[derive(Debug, thiserror::Error)]
pub enum DoorError {
    /// Nothing to listen on.
    #[error("there is no address to listen on")]
    NoAddress,
    /// The system refuses it.
    #[error("cannot listen on {address}: {source}")]
    Bind {
        /// Where.
        address: ListenAddress,
        /// What the system said.
        source: std::io::Error,
    },
    /// Anybody could come in.
    #[error(
        "{address} can be reached from other machines, and this version asks nobody who they are \
         (tokens and TLS are not in this version); say --insecure to listen there all the same"
    )]
    BeyondLoopback {
        /// Where.
        address: ListenAddress,
    },
    /// Somebody else is there.
    #[error("another process listens on {address}")]
    Taken {
        /// Where.
        address: ListenAddress,
    },
}

/// A door that is open: the socket is bound, and connections queue up.
#[derive(Debug)]
pub enum Door {
    /// TCP.
    Tcp(tokio::net::TcpListener),
    /// A Unix socket, which is removed when the door closes.
    Unix(unix::Socket),
}

impl Door {
    /// Binds an address; one that others can reach only if `insecure`.
    pub async fn open(address: &ListenAddress, insecure: bool) -> Result<Self, DoorError> {
        match address {
            ListenAddress::Tcp(authority) => tcp::bind(authority, insecure).await.map(Self::Tcp),
            ListenAddress::Unix(path) => unix::Socket::bind(path).await.map(Self::Unix),
        }
    }

    /// Where it is; with the port that was free where port 0 was asked for.
    pub fn address(&self) -> ListenAddress {
        match self {
            Self::Tcp(listener) => ListenAddress::Tcp(
                listener
                    .local_addr()
                    .map_or_else(|e| e.to_string(), |address| address.to_string()),
            ),
            Self::Unix(socket) => ListenAddress::Unix(socket.path().to_owned()),
        }
    }
}
