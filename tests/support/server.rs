//! Server: a server of other people's that a test has for itself and may kill, by a script of this folder that starts, kills
//! and stops it.

use crate::skip::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A server in a folder of its own; it ends with this value.
pub struct OwnServer {
    script: &'static str,
    folder: PathBuf,
}

impl OwnServer {
    /// Starts one by this script, in a folder whose name begins so; `None`, with a printed reason, where `program` is not
    /// installed.
    ///
    /// # Panics
    /// When it is installed and does not start.
    pub fn start(script: &'static str, folder: &str, program: &str) -> Option<Self> {
        // A user of its own must be able to go there, and the path of a socket is short.
        let name = format!("{folder}-{}", uuid::Uuid::new_v4().simple());
        let server = Self {
            script,
            folder: std::env::temp_dir().join(name),
        };
        match server.tell("start") {
            Some(0) => Some(server),
            Some(77) => {
                skip(&format!(
                    "{program} is not installed; tests/run.sh installs it"
                ));
                None
            }
            code => panic!("{program} did not start: {code:?}"),
        }
    }

    fn tell(&self, verb: &str) -> Option<i32> {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("support");
        let status = Command::new("bash")
            .arg(scripts.join(self.script))
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

    /// The folder with its data.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for OwnServer {
    fn drop(&mut self) {
        self.tell("stop");
    }
}
