//! Storage: a server of S3 of one test, which may be killed.

use crate::server::OwnServer;
use std::path::PathBuf;

/// A server in a folder of its own; it ends with this value.
pub struct Storage(OwnServer);

impl Storage {
    /// Starts one; `None`, with a printed reason, where its program is not installed.
    ///
    /// # Panics
    /// When it is installed and does not start.
    pub fn start() -> Option<Self> {
        OwnServer::start("s3.sh", "cognate-s3", "the S3 server s3s-fs").map(Self)
    }

    /// `kill -9`.
    ///
    /// # Panics
    /// When it is not there.
    pub fn kill(&self) {
        self.0.kill();
    }

    /// A new server on the same data, where the last was killed.
    ///
    /// # Panics
    /// When it does not come up.
    pub fn start_again(&self) {
        self.0.start_again();
    }

    /// Where a coordinator keeps its results.
    pub fn address(&self, prefix: &str) -> String {
        format!("s3://tests/{prefix}")
    }

    /// The folder in which the server keeps these results as files.
    pub fn files(&self, prefix: &str) -> PathBuf {
        self.0.folder().join("data/tests").join(prefix)
    }

    /// Environment variables that a coordinator needs for the storage: name and value.
    ///
    /// # Panics
    /// When the server has not started.
    pub fn environment(&self) -> Vec<(String, String)> {
        let text = std::fs::read_to_string(self.0.folder().join("environment"));
        let text = text.expect("the server has started");
        let line = |line: &str| {
            let (name, value) = line.split_once('=')?;
            Some((name.to_owned(), value.to_owned()))
        };
        text.lines().filter_map(line).collect()
    }
}
