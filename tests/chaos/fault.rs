//! Fault: what goes wrong.

use std::fmt;

/// Kind of the fault that is injected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A worker is killed.
    KillWorker,
    /// A worker stands still for longer than its lease.
    FreezeWorker,
    /// A coordinator is killed.
    KillCoordinator,
    /// A coordinator stands still.
    FreezeCoordinator,
    /// The server of the database is killed.
    KillDatabase,
    /// The server of the results is killed.
    KillStorage,
    /// The results of a chunk are damaged or lost.
    SpoilResults,
}

impl Fault {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::KillWorker,
        Self::FreezeWorker,
        Self::KillCoordinator,
        Self::FreezeCoordinator,
        Self::KillDatabase,
        Self::KillStorage,
        Self::SpoilResults,
    ];
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::KillWorker => "a worker killed (-9)",
            Self::FreezeWorker => "a worker stopped for longer than its lease",
            Self::KillCoordinator => "a coordinator killed (-9)",
            Self::FreezeCoordinator => "a coordinator stopped for a while",
            Self::KillDatabase => "the database server killed (-9)",
            Self::KillStorage => "the server of the results killed (-9)",
            Self::SpoilResults => "the results of a chunk damaged or lost",
        })
    }
}
