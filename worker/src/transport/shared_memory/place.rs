//! Place: a coordinator's folder below /dev/shm, and the settings of iceoryx2 that go with it.
//!
//! A process that can read the token in the file `door` shares host, user and memory with the coordinator. A process
//! that can lock the file knows that the coordinator is gone.

use cognate_protocol::v1;
use iceoryx2::config::Config;
use iceoryx2::prelude::{
    AllocationStrategy, FileName, Node, NodeBuilder, Path as IpcPath, SemanticString,
    SignalHandlingMode, ipc_threadsafe,
};
use iceoryx2::service::port_factory::{event, request_response};
use rustix::fs::{Mode, OFlags};
use std::fmt::Debug;
use std::fs::{File, TryLockError};
use std::io::{self, Read, Write};
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};

/// Version of the frames and of the settings below.
pub const LAYOUT: u32 = 1;
/// The largest message, in bytes: what is larger goes by gRPC. Default 16 MiB: the memory for a size
/// is reserved for several messages of it, and copying is not what large ones wait for.
pub const LARGEST_MESSAGE: usize = 16 << 20;
/// Calls that one worker may have open at a time. Default 24: a pull, a renewal, 16 reports,
/// goodbyes.
pub const CALLS: usize = 24;
/// While less is free in /dev/shm, nobody writes there, in bytes. Default 256 MiB: where it is full,
/// the kernel ends the process that writes.
pub const LEAST_FREE: u64 = 256 << 20;
/// Bytes of the first slices; longer ones are made when they are needed.
pub const FIRST_SLICE: usize = 4096;

/// Workers of one coordinator by this way; more of them go by gRPC.
const CLIENTS: usize = 64;
/// Where memory is shared on Linux.
const ROOT: &str = "/dev/shm";
/// How the names of all places begin.
const PREFIX: &str = "cognate-";
/// The file with the token.
const DOOR: &str = "door";
/// Most bytes of a door that are read: a token has 32.
const DOOR_BYTES: u64 = 256;

/// The kind of all nodes, services and ports.
pub type Ipc = ipc_threadsafe::Service;
/// Requests and responses.
pub type Calls = request_response::PortFactory<Ipc, [u8], (), [u8], ()>;
/// Events that wake the other side.
pub type Bells = event::PortFactory<Ipc>;

/// Why shared memory is not used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unusable(pub String);

/// Wraps an error, with a description of the operation that failed.
pub fn failed<E: Debug>(what: &'static str) -> impl FnOnce(E) -> Unusable {
    move |error| Unusable(format!("{what}: {error:?}"))
}

/// A coordinator's folder in shared memory.
#[derive(Debug)]
pub struct Place {
    folder: PathBuf,
    name: String,
    token: String,
    door: File,
    least_free: u64,
    ours: bool,
}

impl Place {
    /// Makes a new one and locks its door; places of coordinators that are gone are removed.
    pub fn create(least_free: u64) -> Result<Self, Unusable> {
        sweep();
        enough_free(least_free)?;
        let token = uuid::Uuid::new_v4().simple().to_string();
        let name = format!("{PREFIX}{}", &token[..8]);
        let folder = Path::new(ROOT).join(&name);
        let made = (|| {
            std::fs::DirBuilder::new().mode(0o700).create(&folder)?;
            // The door is locked before it has its name, so that a sweep never meets an unlocked door of a living
            // coordinator.
            let unnamed = folder.join("door.new");
            let mut door = File::create_new(&unnamed)?;
            door.lock()?;
            door.write_all(token.as_bytes())?;
            std::fs::rename(unnamed, folder.join(DOOR))?;
            Ok::<_, io::Error>(door)
        })();
        Ok(Self {
            door: made.map_err(failed("no folder in /dev/shm"))?,
            folder,
            name,
            token,
            least_free,
            ours: true,
        })
    }

    /// The place that a coordinator named, where it is the same on this side.
    pub fn open(named: &v1::SharedMemory) -> Result<Self, Unusable> {
        let no = |why: &str| Err(Unusable(why.to_owned()));
        if named.folder.is_empty() {
            return no("the coordinator offers none");
        }
        if named.layout != LAYOUT {
            return no("the coordinator's version lays it out differently");
        }
        let folder = PathBuf::from(&named.folder);
        let name = match folder.file_name().and_then(|name| name.to_str()) {
            Some(name)
                if folder.parent() == Some(Path::new(ROOT))
                    && name.strip_prefix(PREFIX).is_some_and(is_short_hex) =>
            {
                name.to_owned()
            }
            _ => return no("the coordinator names a folder that is none of its kind"),
        };
        let Ok(about) = std::fs::symlink_metadata(&folder) else {
            return no("the coordinator is on another host, or in a container");
        };
        if !about.is_dir() || about.uid() != own_user() {
            return no("the coordinator runs as another user");
        }
        let door = open_door(&folder, OFlags::RDONLY).map_err(failed("its door cannot be read"))?;
        let mut token = String::new();
        let read = (&door).take(DOOR_BYTES).read_to_string(&mut token);
        read.map_err(failed("its door cannot be read"))?;
        if token != named.token {
            return no("the coordinator is on another host, or in a container");
        }
        enough_free(named.least_free_bytes)?;
        Ok(Self {
            folder,
            name,
            token,
            door,
            least_free: named.least_free_bytes,
            ours: false,
        })
    }

    /// As it is named to workers.
    pub fn named(&self) -> v1::SharedMemory {
        v1::SharedMemory {
            folder: self.folder.display().to_string(),
            token: self.token.clone(),
            layout: LAYOUT,
            least_free_bytes: self.least_free,
        }
    }

    /// Whether the coordinator that made this place still runs: its lock ends with it.
    pub fn coordinator_lives(&self) -> bool {
        if self.ours {
            return true;
        }
        match self.door.try_lock_shared() {
            Err(TryLockError::WouldBlock) => true,
            Ok(()) => {
                // Nothing depends on it: the lock is shared, and ends with the file.
                let _ = self.door.unlock();
                false
            }
            Err(TryLockError::Error(_)) => false,
        }
    }

    /// Whether a message of `bytes` bytes may be written now.
    pub fn has_room(&self, bytes: usize) -> Result<(), Unusable> {
        if bytes > LARGEST_MESSAGE {
            return Err(Unusable(format!(
                "a message of {bytes} bytes; at most {LARGEST_MESSAGE} go by shared memory"
            )));
        }
        enough_free(self.least_free.saturating_add(2 * bytes as u64))
    }

    /// A node in this place, with nothing of a configuration file and no signal handlers.
    pub fn node(&self) -> Result<Node<Ipc>, Unusable> {
        let mut config = Config::default();
        let root = IpcPath::new(self.folder.display().to_string().as_bytes());
        config
            .global
            .set_root_path(&root.map_err(failed("the folder's name"))?);
        let prefix = FileName::new(format!("{}-", self.name).as_bytes());
        config.global.prefix = prefix.map_err(failed("the folder's name"))?;
        // Cleaning is the coordinator's, at its own times.
        config.global.node.cleanup_dead_nodes_on_creation = self.ours;
        config.global.node.cleanup_dead_nodes_on_destruction = self.ours;
        config.global.service.cleanup_dead_nodes_on_open = false;
        NodeBuilder::new()
            .config(&config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(failed("no node"))
    }

    /// The service of requests and responses.
    pub fn calls(&self, node: &Node<Ipc>) -> Result<Calls, Unusable> {
        let name = "cognate/calls".try_into().map_err(failed("a name"))?;
        let builder = node
            .service_builder(&name)
            .request_response::<[u8], [u8]>()
            // With it, the oldest message would be dropped in silence.
            .enable_safe_overflow_for_requests(false)
            .enable_safe_overflow_for_responses(false)
            // A request whose asker is gone is not worth answering.
            .enable_fire_and_forget_requests(false)
            .max_active_requests_per_client(CALLS)
            .max_loaned_requests(CALLS)
            .max_response_buffer_size(1)
            .max_borrowed_responses_per_pending_response(1)
            .max_servers(1)
            .max_clients(CLIENTS)
            .max_nodes(CLIENTS + 1);
        if self.ours {
            builder.create().map_err(failed("no service"))
        } else {
            builder.open().map_err(failed("no service"))
        }
    }

    /// The events that wake the coordinator.
    pub fn requests(&self, node: &Node<Ipc>) -> Result<Bells, Unusable> {
        // One more than workers: the coordinator wakes itself when it is to stop.
        self.bells(node, "cognate/requests", 1, CLIENTS + 1)
    }

    /// The events that wake workers, each by the name of its listener.
    pub fn responses(&self, node: &Node<Ipc>) -> Result<Bells, Unusable> {
        self.bells(node, "cognate/responses", CLIENTS, 1)
    }

    fn bells(
        &self,
        node: &Node<Ipc>,
        name: &str,
        listeners: usize,
        notifiers: usize,
    ) -> Result<Bells, Unusable> {
        let name = name.try_into().map_err(failed("a name"))?;
        let builder = node
            .service_builder(&name)
            .event()
            .max_listeners(listeners)
            .max_notifiers(notifiers)
            .max_nodes(CLIENTS + 1);
        if self.ours {
            builder.create().map_err(failed("no event"))
        } else {
            builder.open().map_err(failed("no event"))
        }
    }

    /// How memory grows: with the size of the messages.
    pub fn growth() -> AllocationStrategy {
        AllocationStrategy::PowerOfTwo
    }

    /// Unlocks the door: workers see that the coordinator leaves.
    #[must_use]
    pub fn unlocked(self) -> Self {
        // Where it cannot be unlocked, it is when this value is dropped.
        let _ = self.door.unlock();
        self
    }

    /// Removes the place with all that stands in it. For its coordinator, when its node is gone.
    pub fn remove(self) {
        remove(&self.folder, &self.name);
    }
}

fn is_short_hex(text: &str) -> bool {
    text.len() == 8 && text.bytes().all(|b| b.is_ascii_hexdigit())
}

/// Refuses where less than `bytes` bytes are free.
fn enough_free(bytes: u64) -> Result<(), Unusable> {
    let file_system = rustix::fs::statvfs(ROOT).map_err(failed("/dev/shm cannot be asked"))?;
    let free = file_system.f_bavail.saturating_mul(file_system.f_frsize);
    if free >= bytes {
        Ok(())
    } else {
        Err(Unusable(format!(
            "{} MiB are free in {ROOT}, {} MiB are wanted",
            free >> 20,
            bytes >> 20
        )))
    }
}

/// User of this process.
fn own_user() -> u32 {
    rustix::process::geteuid().as_raw()
}

/// Opens the door of a folder if both are this user's own. Nothing in a folder of another user is opened, and a door
/// that is no regular file is refused without waiting: opening a FIFO would otherwise wait for the process at its
/// other end.
fn open_door(folder: &Path, access: OFlags) -> io::Result<File> {
    let is_own = |about: &std::fs::Metadata| about.uid() == own_user();
    let about = std::fs::symlink_metadata(folder)?;
    if !about.is_dir() || !is_own(&about) {
        return Err(io::Error::other("the folder is another user's"));
    }
    let flags = access | OFlags::NONBLOCK | OFlags::NOFOLLOW | OFlags::CLOEXEC;
    let door = File::from(rustix::fs::open(folder.join(DOOR), flags, Mode::empty())?);
    let about = door.metadata()?;
    match about.is_file() && is_own(&about) {
        true => Ok(door),
        false => Err(io::Error::other("the door is no file of this user")),
    }
}

/// Removes the places of coordinators that are gone.
fn sweep() {
    let Ok(entries) = std::fs::read_dir(ROOT) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.strip_prefix(PREFIX).is_some_and(is_short_hex) {
            continue;
        }
        let folder = entry.path();
        // A living coordinator's door cannot be locked.
        if open_door(&folder, OFlags::WRONLY).is_ok_and(|door| door.try_lock().is_ok()) {
            remove(&folder, &name);
        }
    }
}

/// Removes a place. Files that cannot be removed are left to the next sweep.
fn remove(folder: &Path, name: &str) {
    let of_this_place = format!("{name}-");
    for entry in std::fs::read_dir(ROOT).into_iter().flatten().flatten() {
        if entry
            .file_name()
            .to_string_lossy()
            .starts_with(&of_this_place)
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
    let _ = std::fs::remove_dir_all(folder);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_known_by_its_token_and_its_coordinator_by_its_lock() {
        let place = Place::create(1 << 20).unwrap();
        let seen = Place::open(&place.named()).unwrap();
        assert!(seen.coordinator_lives());
        let why = |named: v1::SharedMemory| Place::open(&named).unwrap_err().to_string();
        let named = || place.named();
        assert!(
            why(v1::SharedMemory {
                token: "another".into(),
                ..named()
            })
            .contains("another host")
        );
        assert!(
            why(v1::SharedMemory {
                folder: "/etc".into(),
                ..named()
            })
            .contains("none of its kind")
        );
        assert!(
            why(v1::SharedMemory {
                layout: 0,
                ..named()
            })
            .contains("version")
        );
        assert!(
            why(v1::SharedMemory {
                least_free_bytes: u64::MAX,
                ..named()
            })
            .contains("free")
        );
        assert!(why(v1::SharedMemory::default()).contains("offers none"));
        assert!(seen.has_room(LARGEST_MESSAGE + 1).is_err());
        let folder = place.folder.clone();
        // As a killed coordinator leaves it.
        drop(place);
        assert!(folder.exists());
        assert!(!seen.coordinator_lives());
        drop(seen);
        let next = Place::create(1 << 20).unwrap();
        assert!(!folder.exists(), "the next one has swept it away");
        next.remove();
    }

    /// Attack F of the third attack on the service (2026-11): a FIFO as door hung every coordinator and every solve.
    #[test]
    fn a_door_that_is_no_file_is_not_waited_for() {
        let parent_folder = tempfile::tempdir().unwrap();
        let refused = |folder: &Path| {
            [OFlags::WRONLY, OFlags::RDONLY].map(|access| open_door(folder, access).is_err())
        };
        let make = |name: &str| {
            let folder = parent_folder.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            folder
        };
        let fifo = make("fifo");
        let made = std::process::Command::new("mkfifo")
            .arg(fifo.join(DOOR))
            .status();
        assert!(made.unwrap().success());
        assert_eq!(refused(&fifo), [true; 2]);
        let link = make("link");
        std::fs::write(parent_folder.path().join("victim"), "token").unwrap();
        std::os::unix::fs::symlink(parent_folder.path().join("victim"), link.join(DOOR)).unwrap();
        assert_eq!(refused(&link), [true; 2]);
        let linked_folder = parent_folder.path().join("linked");
        let good = make("good");
        std::fs::write(good.join(DOOR), "token").unwrap();
        std::os::unix::fs::symlink(&good, &linked_folder).unwrap();
        assert_eq!(refused(&linked_folder), [true; 2]);
        assert_eq!(refused(&make("empty")), [true; 2]);
        assert_eq!(refused(&good), [false; 2]);
    }

    #[test]
    fn nothing_is_made_where_nothing_is_free() {
        let refusal = Place::create(u64::MAX).unwrap_err().to_string();
        assert!(refusal.contains("free in /dev/shm"), "{refusal}");
    }
}
