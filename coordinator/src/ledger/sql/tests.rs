//! Tests of ledgers in a database: reopening, versions, speed, and the conformance of all ledgers.

use super::engine::query;
use super::{MIGRATIONS, SCHEMA_VERSION, SqlLedger};
use crate::ledger::clock::{Clock, ManualClock, SystemClock};
use crate::ledger::conformance::*;
use crate::ledger::rows::*;
use crate::ledger::{Ledger, LedgerError};
use cognate_tests::skip::skip;
use std::path::Path;
use std::sync::Arc;

async fn open(clock: Arc<ManualClock>) -> (SqlLedger, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let ledger = SqlLedger::sqlite(&folder.path().join("ledger"), clock)
        .await
        .expect("an empty ledger opens");
    (ledger, folder)
}

ledger_conformance!(sqlite, open);

/// A server that tests may use, as `postgres://` understands it behind `?`: see
/// `tests/support/postgres.sh`.
fn postgres() -> Option<String> {
    let server = std::env::var("COGNATE_TEST_POSTGRES").ok();
    if server.is_none() {
        skip("COGNATE_TEST_POSTGRES names no server; tests/run.sh starts one");
    }
    server
}

/// An empty database of its own on this server.
async fn database(server: &str) -> String {
    use sqlx::{AssertSqlSafe, Connection, PgConnection};
    let name = format!("test_{}", uuid::Uuid::new_v4().simple());
    let url = format!("postgres:///postgres?{server}");
    let mut connection = PgConnection::connect(&url).await.expect("the server");
    let create = AssertSqlSafe(format!("CREATE DATABASE {name}"));
    let created = sqlx::raw_sql(create).execute(&mut connection).await;
    created.expect("a database is made");
    format!("postgres:///{name}?{server}")
}

async fn open_postgres(clock: Arc<ManualClock>) -> Option<(SqlLedger, ())> {
    let url = database(&postgres()?).await;
    let ledger = SqlLedger::postgres(&url, Some(clock)).await;
    Some((ledger.expect("an empty database opens"), ()))
}

ledger_conformance!(postgresql, open_postgres, optional);

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn coordinators_of_one_database_take_turns() {
    let Some(server) = postgres() else { return };
    let url = database(&server).await;
    // Opened at once: one of them makes the schema.
    let open = || SqlLedger::postgres(&url, None);
    let (one, two) = tokio::join!(open(), open());
    let (one, two) = (Arc::new(one.unwrap()), Arc::new(two.unwrap()));
    let job = one.submit(request("r"), new_job("t", 1)).await.unwrap().job;
    assert!(
        !two.submit(request("r"), new_job("t", 1))
            .await
            .unwrap()
            .is_new
    );
    let epoch = one.steward(job, &coordinator("one"), 600_000).await;
    let epoch = epoch.unwrap().expect("nobody else drives it");
    let second = two.steward(job, &coordinator("two"), 600_000).await;
    assert_eq!(second.unwrap(), None);
    let items = 2000;
    let open = Advance {
        open: vec![stage(0, items, items)],
        ..Advance::default()
    };
    one.advance(job, epoch, open).await.unwrap();
    let tasks = (0..8).map(|w| {
        let ledger = Arc::clone(if w % 2 == 0 { &one } else { &two });
        tokio::spawn(async move {
            let mut done = Vec::new();
            for k in 0.. {
                let mut wanted = wants(&format!("w{w}"), &format!("{w}-{k}"), 1);
                wanted.sizing.most_items = 10;
                let leases = ledger.lease(wanted).await.unwrap();
                let Some(lease) = leases.first() else { break };
                let object = result(lease.items, 1, 100_000);
                let verdict = ledger.complete(lease.lease, object).await.unwrap();
                assert_eq!(verdict, Completion::Accepted);
                done.extend(lease.items.first..lease.items.last);
            }
            done
        })
    });
    let mut done = Vec::new();
    for task in tasks.collect::<Vec<_>>() {
        done.extend(task.await.unwrap());
    }
    done.sort_unstable();
    assert_eq!(done, (0..items).collect::<Vec<_>>(), "each item once");
    assert_eq!(one.stages(job).await.unwrap()[0].accepted.items, items);
    let skew = one.now().await.unwrap().0 - SystemClock::default().now().0;
    assert!(
        skew.abs() < 60_000,
        "milliseconds since 1970, not {skew} off"
    );
}

/// As after a server that was killed and started again: all connections are dead, and nobody's call fails.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn dead_connections_cost_nobody_a_call() {
    use sqlx::{Connection, PgConnection};
    let Some(server) = postgres() else { return };
    let url = database(&server).await;
    let ledger = SqlLedger::postgres(&url, None).await.unwrap();
    let mut other = PgConnection::connect(&url).await.expect("the database");
    assert!(ledger.jobs(10).await.unwrap().is_empty());
    for round in 0..3 {
        let end = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity
                   WHERE datname = current_database() AND pid <> pg_backend_pid()";
        let ended = sqlx::raw_sql(end).fetch_all(&mut other).await.unwrap();
        assert!(ended.len() >= 2, "one that writes, and those that read");
        let id = format!("r{round}");
        let job = ledger.submit(request(&id), new_job("t", 1)).await;
        assert!(job.expect("it is written").is_new);
        let jobs = ledger.jobs(10).await.expect("they are read");
        assert_eq!(jobs.len(), round + 1);
    }
    ledger.close().await;
}

/// A way to a server by which connections that are there can be made silent, as a firewall does that forgets them:
/// nothing is closed, and nothing comes through. Those that come later are well.
struct Forgetful {
    folder: tempfile::TempDir,
    /// Number of times that connections were forgotten.
    forgotten: tokio::sync::watch::Sender<u32>,
}

impl Forgetful {
    const SOCKET: &str = ".s.PGSQL.5432";

    fn before(server: &str) -> Self {
        let host = server
            .split('&')
            .find_map(|part| part.strip_prefix("host="));
        let to = Path::new(host.expect("a folder")).join(Self::SOCKET);
        let folder = tempfile::tempdir().unwrap();
        let listener = tokio::net::UnixListener::bind(folder.path().join(Self::SOCKET)).unwrap();
        let (forgotten, _) = tokio::sync::watch::channel(0);
        let listened = forgotten.clone();
        tokio::spawn(async move {
            while let Ok((mut near, _)) = listener.accept().await {
                let (to, mut heard) = (to.clone(), listened.subscribe());
                tokio::spawn(async move {
                    let mut far = tokio::net::UnixStream::connect(to).await.unwrap();
                    tokio::select! {
                        _ = tokio::io::copy_bidirectional(&mut near, &mut far) => {}
                        _ = heard.changed() => std::future::pending().await,
                    }
                });
            }
        });
        Self { folder, forgotten }
    }

    fn url(&self, url: &str) -> String {
        let (database, _) = url.split_once('?').unwrap();
        let folder = self.folder.path().display();
        let (_, user) = url.rsplit_once("user=").unwrap();
        format!("{database}?host={folder}&user={user}")
    }

    fn forget(&self) {
        self.forgotten.send_modify(|times| *times += 1);
    }
}

/// Attack W of the third attack on the service (2026-11): half-open connections held calls for ever.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn connections_that_die_without_a_word_are_given_up() {
    let Some(server) = postgres() else { return };
    let url = database(&server).await;
    let way = Forgetful::before(&server);
    let ledger = Arc::new(SqlLedger::postgres(&way.url(&url), None).await.unwrap());
    for round in 0..2 {
        // Several, so that all connections that read are there, and idle, or in the midst of an answer.
        let reads = (0..16).map(|_| {
            let ledger = Arc::clone(&ledger);
            tokio::spawn(async move { ledger.jobs(10).await })
        });
        let reads: Vec<_> = reads.collect();
        way.forget();
        for read in reads {
            // A read at this moment may fail for lack of an answer.
            let _ = read.await.unwrap();
        }
        let id = format!("r{round}");
        let mut tries = 0;
        let job = loop {
            match ledger.submit(request(&id), new_job("t", 1)).await {
                Ok(job) => break job,
                Err(error @ LedgerError::Unreachable(_)) if tries < 3 => println!("{error}"),
                Err(error) => panic!("{error}"),
            }
            tries += 1;
        };
        assert!(job.is_new);
        let jobs = ledger.jobs(10).await.expect("they are read");
        assert_eq!(jobs.len(), round + 1);
    }
    ledger.close().await;
}

/// Overwrites all pages of a file but the first, as a broken disk does with one.
fn destroy_pages(path: &Path) {
    use std::os::unix::fs::FileExt;
    const PAGE: u64 = 4096;
    let file = std::fs::File::options().write(true).open(path).unwrap();
    let pages = file.metadata().unwrap().len() / PAGE;
    assert!(pages > 4, "{pages}");
    for page in 1..pages {
        file.write_all_at(&[0x5a; PAGE as usize], page * PAGE)
            .unwrap();
    }
}

/// Writes what stands in the write-ahead log into the file.
async fn write_back(path: &Path) {
    use sqlx::{ConnectOptions, Connection};
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(path);
    let mut connection = options.connect().await.unwrap();
    let written = sqlx::raw_sql("PRAGMA wal_checkpoint(TRUNCATE)");
    written.execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}

/// Attack Z of the third attack on the service (2026-11): a destroyed page was called healthy.
#[tokio::test]
async fn destroyed_pages_are_noticed_at_the_start_and_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let ledger = reopen(&path).await.unwrap();
    let job = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
    ledger.close().await;
    write_back(&path).await;
    let copy = folder.path().join("copy");
    std::fs::copy(&path, &copy).unwrap();
    let running = reopen(&path).await.unwrap();
    assert_eq!(running.damage(), None);
    destroy_pages(&path);
    let read = running.stages(job.job).await;
    assert!(matches!(read, Err(LedgerError::Malformed(_))), "{read:?}");
    let damage = running.damage().expect("it is remembered for health");
    assert!(damage.contains("cognate backup"), "{damage}");
    drop(running);
    let Err(refused) = reopen(&path).await else {
        panic!("it must not open");
    };
    assert!(matches!(refused, LedgerError::Malformed(_)), "{refused}");
    let restored = reopen(&copy).await.unwrap();
    assert_eq!(restored.jobs(10).await.unwrap().len(), 1);
}

async fn reopen(path: &Path) -> Result<SqlLedger, LedgerError> {
    SqlLedger::sqlite(path, Arc::new(SystemClock::default())).await
}

#[tokio::test]
async fn what_was_acknowledged_is_there_after_reopening() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let ledger = reopen(&path).await.unwrap();
    let job = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
    let row = ledger.job(job.job).await.unwrap();
    ledger.close().await;
    let refused = ledger.submit(request("s"), new_job("t", 1)).await;
    assert!(matches!(refused, Err(LedgerError::Closed)));
    let reopened_ledger = reopen(&path).await.unwrap();
    assert_eq!(reopened_ledger.job(job.job).await.unwrap(), row);
    let twice = reopened_ledger
        .submit(request("r"), new_job("t", 1))
        .await
        .unwrap();
    assert!(!twice.is_new);
}

#[tokio::test]
async fn a_lease_ends_in_time_though_the_clock_was_set_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    // The file was written by a clock that is an hour ahead.
    let ahead = Arc::new(ManualClock::default());
    ahead.advance_ms(u64::try_from(SystemClock::default().now().0).unwrap() + 3_600_000);
    let ledger = SqlLedger::sqlite(&path, ahead.clone()).await.unwrap();
    let job = ledger
        .submit(request("r"), new_job("t", 1))
        .await
        .unwrap()
        .job;
    let epoch = ledger.steward(job, &coordinator("c"), 1).await.unwrap();
    let open = Advance {
        open: vec![stage(0, 10, 10)],
        ..Advance::default()
    };
    ledger.advance(job, epoch.unwrap(), open).await.unwrap();
    ledger.seen(seen("w", 1)).await.unwrap();
    let wanted = LeaseRequest {
        duration_ms: 200,
        ..wants("w", "1", 1)
    };
    assert_eq!(ledger.lease(wanted).await.unwrap().len(), 1);
    ledger.close().await;
    let reopened_ledger = reopen(&path).await.unwrap();
    assert!(reopened_ledger.now().await.unwrap() >= ahead.now());
    tokio::time::sleep(std::time::Duration::from_millis(400)).await;
    assert_eq!(
        reopened_ledger.expire().await.unwrap().len(),
        1,
        "not an hour later"
    );
}

#[tokio::test]
async fn later_and_foreign_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let ledger = reopen(&path).await.unwrap();
    ledger
        .writer
        .write(|c, _| {
            Box::pin(async move {
                query("UPDATE ledger SET schema_version = 999")
                    .execute(c)
                    .await?;
                Ok(())
            })
        })
        .await
        .unwrap();
    ledger.close().await;
    let refused = reopen(&path).await.err().expect("it is refused");
    assert!(matches!(refused, LedgerError::TooNew { found: 999, .. }));
    let path = folder.path().join("text");
    std::fs::write(
        &path,
        "this is no database, whatever its name says\n".repeat(99),
    )
    .unwrap();
    assert!(reopen(&path).await.is_err());
}

/// A released schema never changes: a ledger of that version must still open.
#[test]
fn the_schema_of_version_1_is_what_it_was() {
    let hash = blake3::hash(MIGRATIONS[0].as_bytes()).to_hex();
    assert_eq!(SCHEMA_VERSION as usize, MIGRATIONS.len());
    assert_eq!(&hash[..16], "0d7a7ee043c8b187", "add a migration instead");
}

#[tokio::test]
async fn a_ledger_of_version_1_still_opens() {
    use sqlx::{Connection, SqliteConnection};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let url = format!("sqlite:{}?mode=rwc", path.display());
    let mut old = SqliteConnection::connect(&url).await.unwrap();
    for statements in [
        MIGRATIONS[0],
        "INSERT INTO ledger (schema_version) VALUES (1)",
    ] {
        sqlx::raw_sql(statements).execute(&mut old).await.unwrap();
    }
    old.close().await.unwrap();
    let ledger = reopen(&path).await.unwrap();
    ledger.seen(seen("w", 1)).await.unwrap();
    assert!(!ledger.workers(1).await.unwrap()[0].evicted);
}

#[tokio::test]
async fn a_database_of_version_1_still_opens() {
    use sqlx::{AssertSqlSafe, Connection, PgConnection, Row};
    let Some(server) = postgres() else { return };
    let url = database(&server).await;
    let mut old = PgConnection::connect(&url).await.expect("the database");
    // As the first version made it and left it: a job of which one chunk is ready.
    let schema = MIGRATIONS[0].replace(" TEXT", " TEXT COLLATE \"C\"");
    let rows = "INSERT INTO ledger (schema_version) VALUES (1)".to_owned();
    for statements in [schema, rows] {
        let statements = AssertSqlSafe(statements);
        sqlx::raw_sql(statements).execute(&mut old).await.unwrap();
    }
    let of_version = |statement: &'static str| sqlx::raw_sql(statement);
    let missing = of_version("SELECT * FROM votes").fetch_all(&mut old).await;
    assert!(missing.is_err(), "version 1 knows no votes");
    old.close().await.unwrap();
    let open = || SqlLedger::postgres(&url, None);
    // Two coordinators of the new version at once: one of them brings it up to date.
    let (one, two) = tokio::join!(open(), open());
    let (one, two) = (one.unwrap(), two.unwrap());
    one.seen(seen("w", 1)).await.unwrap();
    assert!(!two.workers(1).await.unwrap()[0].evicted);
    let job = two.submit(request("r"), new_job("t", 1)).await.unwrap().job;
    let epoch = two.steward(job, &coordinator("two"), 600_000).await;
    let open = Advance {
        open: vec![stage(0, 10, 10)],
        ..Advance::default()
    };
    two.advance(job, epoch.unwrap().unwrap(), open)
        .await
        .unwrap();
    let lease = one.lease(wants("w", "1", 1)).await.unwrap().remove(0);
    let object = result(lease.items, 1, 100_000);
    // Votes exist since version 2 of the schema.
    let voted = one
        .confirm(lease.lease, object, Confirmation::Doubt)
        .await
        .unwrap();
    assert_eq!(voted, Completion::Unconfirmed);
    let mut connection = PgConnection::connect(&url).await.expect("the database");
    let votes = of_version("SELECT * FROM votes")
        .fetch_all(&mut connection)
        .await;
    assert_eq!(votes.unwrap().len(), 1);
    let version = of_version("SELECT schema_version FROM ledger");
    let version = version.fetch_all(&mut connection).await.unwrap();
    let version: Vec<i64> = version.iter().map(|row| row.get(0)).collect();
    assert_eq!(version, [SCHEMA_VERSION]);
}

/// Measured, not asserted: `cargo test --release -p cognate-coordinator -- --ignored --nocapture speed`.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn speed_of_lease_and_complete() {
    let folder = tempfile::tempdir().unwrap();
    println!("SQLite:");
    measure(reopen(&folder.path().join("ledger")).await.unwrap()).await;
    if let Some(server) = postgres() {
        println!("PostgreSQL:");
        let url = database(&server).await;
        measure(SqlLedger::postgres(&url, None).await.unwrap()).await;
    }
}

async fn measure(ledger: SqlLedger) {
    let ledger = Arc::new(ledger);
    let job = ledger
        .submit(request("r"), new_job("t", 1))
        .await
        .unwrap()
        .job;
    let who = coordinator("c");
    let epoch = ledger.steward(job, &who, 600_000).await.unwrap().unwrap();
    let open = Advance {
        open: vec![stage(0, 1_000_000, 1_000_000)],
        ..Advance::default()
    };
    ledger.advance(job, epoch, open).await.unwrap();
    for workers in [1, 32] {
        let begin = std::time::Instant::now();
        let each = 6400 / workers / 4;
        let tasks = (0..workers).map(|w| {
            let ledger = Arc::clone(&ledger);
            tokio::spawn(async move {
                for k in 0..each {
                    let mut wanted = wants(&format!("w{w}"), &format!("{workers}-{k}"), 1);
                    wanted.sizing.most_items = 10;
                    let lease = ledger.lease(wanted).await.unwrap()[0].clone();
                    let object = result(lease.items, 1, 100_000);
                    let done = ledger.complete(lease.lease, object).await.unwrap();
                    assert_eq!(done, Completion::Accepted);
                }
            })
        });
        for task in tasks.collect::<Vec<_>>() {
            task.await.unwrap();
        }
        let rate = (each * workers) as f64 / begin.elapsed().as_secs_f64();
        println!("{workers} workers: {rate:.0} lease + complete a second");
    }
}

#[tokio::test]
async fn the_secret_of_audits_stays_and_is_each_ledgers_own() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    let ledger = reopen(&one).await.unwrap();
    let key = ledger.audit_key().await.unwrap();
    ledger.close().await;
    let opened = reopen(&one).await.unwrap().audit_key().await.unwrap();
    assert_eq!(key, opened, "it survives a restart");
    let another = reopen(&two).await.unwrap().audit_key().await.unwrap();
    assert_ne!(key, another);
}
