//! TCP: a listener on an address of this machine, beyond loopback only when told so.

use super::DoorError;
use crate::config::ListenAddress;
use tokio::net::{TcpListener, lookup_host};

/// Binds the first address that the name stands for.
pub async fn bind(authority: &str, insecure: bool) -> Result<TcpListener, DoorError> {
    let address = || ListenAddress::Tcp(authority.to_owned());
    let refused = |source| DoorError::Bind {
        address: address(),
        source,
    };
    let candidates: Vec<_> = lookup_host(authority).await.map_err(refused)?.collect();
    if !insecure && candidates.iter().any(|a| !a.ip().is_loopback()) {
        return Err(DoorError::BeyondLoopback { address: address() });
    }
    TcpListener::bind(candidates.as_slice())
        .await
        .map_err(|e| match e.kind() {
            std::io::ErrorKind::AddrInUse => DoorError::Taken { address: address() },
            _ => refused(e),
        })
}
