//! TCP: a listener on an address of this machine, beyond loopback only when told so.

use super::ListenError;
use crate::config::ListenAddress;
use tokio::net::{TcpListener, lookup_host};

/// Binds the first address that the name stands for.
pub async fn bind(authority: &str, insecure: bool) -> Result<TcpListener, ListenError> {
    let address = || ListenAddress::Tcp(authority.to_owned());
    let refused = |source| ListenError::Bind {
        address: address(),
        source,
    };
    let candidates: Vec<_> = lookup_host(authority).await.map_err(refused)?.collect();
    if !insecure && candidates.iter().any(|a| !a.ip().is_loopback()) {
        return Err(ListenError::BeyondLoopback { address: address() });
    }
    TcpListener::bind(candidates.as_slice())
        .await
        .map_err(|e| match e.kind() {
            std::io::ErrorKind::AddrInUse => ListenError::Taken { address: address() },
            _ => refused(e),
        })
}
