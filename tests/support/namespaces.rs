//! Namespaces: a small file system, or a network of one's own, for processes of one test.
//!
//! Linux only, and only where this user may make them; else a test is skipped and says why.

use crate::skip::skip;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A file system of limited size, which only processes that start within it see.
pub struct SmallDisk {
    holder: Child,
    folder: PathBuf,
}

impl SmallDisk {
    /// Mounts a file system of `mib` MiB at this folder, which must exist; `None`, with a printed reason, if this user
    /// may not mount.
    pub fn mount(folder: &Path, mib: u32) -> Option<Self> {
        let script =
            "mount -t tmpfs -o size=\"$1\"m none \"$2\" && echo ready && exec sleep infinity";
        let holder = Command::new("unshare")
            .args(["--mount", "sh", "-c", script, "sh", &mib.to_string()])
            .arg(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut holder = match holder {
            Ok(holder) => holder,
            Err(error) => {
                skip(&format!("no small file system: unshare: {error}"));
                return None;
            }
        };
        let mut line = String::new();
        let said = holder.stdout.take().map(BufReader::new);
        let ready = said.is_some_and(|mut said| said.read_line(&mut line).is_ok());
        if ready && line.trim() == "ready" {
            return Some(Self {
                holder,
                folder: folder.to_owned(),
            });
        }
        let told = holder.wait_with_output();
        let told = told.map_or_else(
            |e| e.to_string(),
            |o| String::from_utf8_lossy(&o.stderr).into(),
        );
        skip(&format!(
            "no small file system for this user: {}",
            told.trim()
        ));
        None
    }

    /// The words before a command that is to see it.
    pub fn within(&self) -> Vec<String> {
        let holder = self.holder.id().to_string();
        let words = ["nsenter", "--target", &holder, "--mount", "--"];
        words.map(str::to_owned).to_vec()
    }

    /// Path of the folder for processes outside the namespace.
    pub fn outside(&self) -> PathBuf {
        let root = PathBuf::from(format!("/proc/{}/root", self.holder.id()));
        let inner = self.folder.strip_prefix("/").unwrap_or(&self.folder);
        root.join(inner)
    }

    /// Writes until nothing more goes in.
    pub fn fill(&self) {
        let file = std::fs::File::create(self.filler());
        let mut file = file.expect("a file has a name, whatever is free");
        for size in [1 << 16, 1 << 12, 1] {
            let block = vec![1u8; size];
            while std::io::Write::write_all(&mut file, &block).is_ok() {}
        }
    }

    /// Makes room again.
    pub fn clear(&self) {
        std::fs::remove_file(self.filler()).expect("it was filled");
    }

    fn filler(&self) -> PathBuf {
        self.outside().join("filler")
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // It sleeps; its mount goes with it and with the last process within.
        let _ = self.holder.kill();
        let _ = self.holder.wait();
    }
}

/// Networks of their own: a hub with a bridge, and places that are wired to it.
pub struct Network {
    name: String,
    places: usize,
}

/// Runs `ip` with these words.
fn ip(words: &str) -> Result<(), String> {
    let done = Command::new("ip").args(words.split_whitespace()).output();
    let done = done.map_err(|error| format!("ip: {error}"))?;
    if done.status.success() {
        Ok(())
    } else {
        let why = String::from_utf8_lossy(&done.stderr).trim().to_owned();
        Err(format!("ip {words}: {why}"))
    }
}

impl Network {
    /// A hub at 10.77.0.1 and this many places, at 10.77.0.2 and so on; `None`, with a printed reason, where
    /// this user may not make them.
    pub fn new(places: usize) -> Option<Self> {
        let id = uuid::Uuid::new_v4().simple().to_string();
        let network = Self {
            name: format!("cg{}", &id[..6]),
            places,
        };
        match network.make() {
            Ok(()) => Some(network),
            Err(why) => {
                skip(&format!("no networks for this user: {why}"));
                None
            }
        }
    }

    fn make(&self) -> Result<(), String> {
        let hub = self.hub();
        ip(&format!("netns add {hub}"))?;
        ip(&format!("-n {hub} link set lo up"))?;
        ip(&format!("-n {hub} link add bridge type bridge"))?;
        ip(&format!("-n {hub} addr add 10.77.0.1/24 dev bridge"))?;
        ip(&format!("-n {hub} link set bridge up"))?;
        for place in 0..self.places {
            let (name, address) = (self.place(place), place + 2);
            ip(&format!("netns add {name}"))?;
            ip(&format!(
                "-n {hub} link add wire{place} type veth peer name wire netns {name}"
            ))?;
            ip(&format!("-n {hub} link set wire{place} master bridge"))?;
            ip(&format!("-n {hub} link set wire{place} up"))?;
            ip(&format!("-n {name} addr add 10.77.0.{address}/24 dev wire"))?;
            ip(&format!("-n {name} link set lo up"))?;
            ip(&format!("-n {name} link set wire up"))?;
        }
        Ok(())
    }

    fn hub(&self) -> String {
        format!("{}-hub", self.name)
    }

    fn place(&self, place: usize) -> String {
        format!("{}-{place}", self.name)
    }

    /// The words before a command that runs at the hub.
    pub fn within_hub(&self) -> Vec<String> {
        let hub = self.hub();
        ["ip", "netns", "exec", &hub].map(str::to_owned).to_vec()
    }

    /// The words before a command that runs at this place.
    pub fn within(&self, place: usize) -> Vec<String> {
        let name = self.place(place);
        ["ip", "netns", "exec", &name].map(str::to_owned).to_vec()
    }

    /// Cuts the wire to a place, or mends it.
    ///
    /// # Panics
    /// When the system refuses.
    pub fn set_wire(&self, place: usize, up: bool) {
        let state = if up { "up" } else { "down" };
        let words = format!("-n {} link set wire{place} {state}", self.hub());
        ip(&words).expect("a wire that is there");
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        // Wires go with their ends.
        for place in 0..self.places {
            let _ = ip(&format!("netns delete {}", self.place(place)));
        }
        let _ = ip(&format!("netns delete {}", self.hub()));
    }
}
