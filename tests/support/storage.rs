//! Storage: a server of S3 of one test, which may be killed.

use crate::skip::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A server in a folder of its own; it ends with this value.
pub struct Storage {
    folder: PathBuf,
}

impl Storage {
    /// Starts one; `None`, with a printed reason, where its program is not installed.
    ///
    /// # Panics
    /// When it is installed and does not start.
    pub fn start() -> Option<Self> {
        let name = format!("cognate-s3-{}", uuid::Uuid::new_v4().simple());
        let storage = Self {
            folder: std::env::temp_dir().join(name),
        };
        match storage.tell("start") {
            Some(0) => Some(storage),
            Some(77) => {
                skip("the S3 server s3s-fs is not installed; tests/run.sh installs it");
                None
            }
            code => panic!("the S3 server did not start: {code:?}"),
        }
    }

    fn tell(&self, verb: &str) -> Option<i32> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("support/s3.sh");
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

    /// A new server on the same data, where the last was killed.
    ///
    /// # Panics
    /// When it does not come up.
    pub fn start_again(&self) {
        assert_eq!(self.tell("start"), Some(0));
    }

    /// Where a coordinator keeps its results.
    pub fn address(&self, prefix: &str) -> String {
        format!("s3://tests/{prefix}")
    }

    /// The folder in which the server keeps these results as files.
    pub fn files(&self, prefix: &str) -> PathBuf {
        self.folder.join("data/tests").join(prefix)
    }

    /// What a coordinator must have in its environment: name and value.
    ///
    /// # Panics
    /// When the server has not started.
    pub fn environment(&self) -> Vec<(String, String)> {
        let text = std::fs::read_to_string(self.folder.join("environment"));
        let text = text.expect("the server has started");
        let line = |line: &str| {
            let (name, value) = line.split_once('=')?;
            Some((name.to_owned(), value.to_owned()))
        };
        text.lines().filter_map(line).collect()
    }
}

impl Drop for Storage {
    fn drop(&mut self) {
        self.tell("stop");
    }
}
