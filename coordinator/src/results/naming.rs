//! Naming: writers of objects that a row is to name, and what may be removed beside them.
//!
//! An object is written first and named by a row later, however long the ledger takes; and an object that exists is
//! not written again. So an object in the trash is removed for good only when all writers that may have seen it at
//! its place have ended: after that either a row names it, or a writer that needs it has written it anew.

use super::addresses::Trashed;
use crate::ledger::clock::LedgerTime;
use cognate_continuation::start_points::Digest;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An object in the trash: put there again, it is another one.
type Key = (Digest, LedgerTime);

#[derive(Debug, Default)]
struct Book {
    /// The number of the next writer.
    next: u64,
    /// Numbers of the writers that have not ended.
    writers: BTreeSet<u64>,
    /// First writer that began while the object was in the trash, for each object in the trash.
    trashed: BTreeMap<Key, u64>,
}

/// The writers of one process.
#[derive(Clone, Debug, Default)]
pub struct Naming(Arc<Mutex<Book>>);

impl Naming {
    fn book(&self) -> MutexGuard<'_, Book> {
        // Numbers are right whatever ended while they were held.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to write objects; the turn ends when a row names them, or nothing will.
    pub fn begin(&self) -> NamingTurn {
        let mut book = self.book();
        let number = book.next;
        book.next += 1;
        book.writers.insert(number);
        NamingTurn {
            naming: self.clone(),
            number,
        }
    }

    /// Whether each of these objects, which are all that is in the trash, was put there before every writer that has not ended
    /// began. To be asked before rows are read.
    pub fn are_unseen(&self, trash: &[Trashed]) -> Vec<bool> {
        let mut book = self.book();
        let next = book.next;
        let first = book.writers.first().copied().unwrap_or(next);
        let trashed = trash.iter().map(|trashed| {
            let key = (trashed.digest, trashed.since);
            (key, book.trashed.get(&key).copied().unwrap_or(next))
        });
        let trashed: Vec<(Key, u64)> = trashed.collect();
        book.trashed = trashed.iter().copied().collect();
        trashed.iter().map(|(_, number)| first >= *number).collect()
    }
}

/// The time in which a writer writes objects until a row names them.
#[derive(Debug)]
pub struct NamingTurn {
    naming: Naming,
    number: u64,
}

impl Drop for NamingTurn {
    fn drop(&mut self) {
        self.naming.book().writers.remove(&self.number);
    }
}
