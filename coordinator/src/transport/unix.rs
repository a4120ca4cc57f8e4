//! Unix socket: only this user may connect; a socket left over by a killed process is replaced.

use super::ListenError;
use crate::config::ListenAddress;
use std::io;
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::path::{Path, PathBuf};
use tokio::net::{UnixListener, UnixStream};

/// A bound socket; its file goes with it.
#[derive(Debug)]
pub struct Socket {
    listener: UnixListener,
    path: PathBuf,
}

impl Socket {
    /// Binds a path, unless somebody answers there.
    pub async fn bind(path: &Path) -> Result<Self, ListenError> {
        let address = || ListenAddress::Unix(path.to_owned());
        let refused = |source| ListenError::Bind {
            address: address(),
            source,
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(refused)?;
        }
        match std::fs::symlink_metadata(path) {
            Ok(metadata) if metadata.file_type().is_socket() => {
                if UnixStream::connect(path).await.is_ok() {
                    return Err(ListenError::Taken { address: address() });
                }
                std::fs::remove_file(path).map_err(refused)?;
            }
            Ok(_) => {
                return Err(refused(io::Error::new(
                    io::ErrorKind::AlreadyExists,
                    "there is a file of that name which is no socket",
                )));
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            Err(e) => return Err(refused(e)),
        }
        let listener = UnixListener::bind(path).map_err(refused)?;
        let socket = Self {
            listener,
            path: path.to_owned(),
        };
        // This socket requires no credentials, so only this user may connect.
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).map_err(refused)?;
        Ok(socket)
    }

    /// Path of the socket.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next connection.
    pub async fn accept(&self) -> io::Result<UnixStream> {
        self.listener.accept().await.map(|(stream, _)| stream)
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        // Nothing depends on it: the next start replaces a socket that nobody answers on.
        let _ = std::fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_left_over_socket_is_replaced_and_a_live_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deeper/c.sock");
        let first = Socket::bind(&path).await.unwrap();
        let mode = std::fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert!(matches!(
            Socket::bind(&path).await,
            Err(ListenError::Taken { .. })
        ));
        drop(first);
        assert!(!path.exists());
        // As a killed process leaves it: bound once, and nobody there.
        drop(std::os::unix::net::UnixListener::bind(&path).unwrap());
        assert!(path.exists());
        Socket::bind(&path).await.unwrap();
        std::fs::write(&path, "precious").unwrap();
        assert!(matches!(
            Socket::bind(&path).await,
            Err(ListenError::Bind { .. })
        ));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "precious");
    }
}
