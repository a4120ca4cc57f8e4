//! The server of paths.
//!
//! The life of a job:
//! 1. A client's problem is checked ([`intake`]); [`jobs::planning`] finds how it is solved, or why not.
//! 2. Its row stands in the [`ledger`], its system and first state are objects in
//!    [`results::store`]; only then the client has its id.
//! 3. One coordinator takes the right to drive it ([`jobs::drive`]) and opens its first stage.
//! 4. Workers ask ([`coordinator`]); [`chunks`] says whose turn it is and how much is cut.
//! 5. A worker reports: the results are written once, then the chunk's row, then it hears so.
//! 6. A worker falls silent: its chunk goes to another; one that kills workers is split down.
//! 7. A stage is complete: its results are absorbed in order ([`jobs::steward`]), the next opens.
//! 8. The algorithm is done: solutions and summary are objects, then the last row.
//! 9. Meanwhile clients watch [`jobs::progress`].
//! 10. After the death of any process another goes on from ledger and store to the same answer.
#![forbid(unsafe_code)]

mod exact_values;
pub mod health;
pub mod intake;

pub mod ledger;

pub mod results;

pub mod jobs;

pub mod coordinator;

pub mod chunks;

pub mod recent;

pub mod api;

pub mod transport;

pub mod config;

pub mod server;

pub mod metrics;

pub mod measures;

pub mod monitor;

pub mod histogram;
pub mod page;
