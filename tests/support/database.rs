//! Database: a PostgreSQL server of one test, which may be killed.

use crate::server::OwnServer;

/// A server in a folder of its own; it ends with this value.
pub struct Database(OwnServer);

impl Database {
    /// Starts one; `None`, with a printed reason, where PostgreSQL is not installed.
    ///
    /// # Panics
    /// When it is installed and does not start.
    pub fn start() -> Option<Self> {
        OwnServer::start("postgres.sh", "cognate-pg", "PostgreSQL").map(Self)
    }

    /// `kill -9`.
    ///
    /// # Panics
    /// When it is not there.
    pub fn kill(&self) {
        self.0.kill();
    }

    /// `kill -9`, then a new server on the same data.
    ///
    /// # Panics
    /// When it does not come up again.
    pub fn kill_and_start(&self) {
        self.kill();
        self.start_again();
    }

    /// A new server on the same data, where the last was killed.
    ///
    /// # Panics
    /// When it does not come up.
    pub fn start_again(&self) {
        self.0.start_again();
    }

    /// Address of the database in the form that a coordinator takes.
    pub fn url(&self) -> String {
        let folder = self.0.folder().display();
        format!("postgres:///postgres?host={folder}&user=cognate")
    }
}
