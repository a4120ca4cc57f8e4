//! Database: a PostgreSQL server of one test, which may be killed.

use crate::skip::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A server in a folder of its own; it ends with this value.
pub struct Database {
    folder: PathBuf,
}

impl Database {
    /// Starts one; `None`, with a printed reason, where PostgreSQL is not installed.
    ///
    /// # Panics
    /// When it is installed and does not start.
    pub fn start() -> Option<Self> {
        // Its user must be able to go there, and the path of a socket is short.
        let name = format!("cognate-pg-{}", uuid::Uuid::new_v4().simple());
        let database = Self {
            folder: std::env::temp_dir().join(name),
        };
        match database.tell("start") {
            Some(0) => Some(database),
            Some(77) => {
                skip("PostgreSQL is not installed; tests/run.sh installs it");
                None
            }
            code => panic!("PostgreSQL did not start: {code:?}"),
        }
    }

    fn tell(&self, verb: &str) -> Option<i32> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("support/postgres.sh");
        let status = Command::new("bash")
            .arg(script)
            .arg(verb)
            .arg(&self.folder)
            .status();
        status.expect("bash can be started").code()
    }

    /// `kill -9`.
    ///
    /// # Panics
    /// When it is not there.
    pub fn kill(&self) {
        assert_eq!(self.tell("kill"), Some(0));
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
        assert_eq!(self.tell("start"), Some(0));
    }

    /// As a coordinator wants it.
    pub fn url(&self) -> String {
        let folder = self.folder.display();
        format!("postgres:///postgres?host={folder}&user=cognate")
    }
}

impl Drop for Database {
    fn drop(&mut self) {
        self.tell("stop");
    }
}
