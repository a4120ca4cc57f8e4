//! Security of the service as real processes: the rows of the table in `deploy/security.md` that need a process of
//! their own to be seen. The other rows are in `coordinator/tests` (`hostile`, `access`, `security`) and
//! `tests/service`.

mod closed_terminal;
mod damaged_ledger;
mod files_of_the_owner;
mod killed_workers;
mod long_system;
mod waiting_jobs;
