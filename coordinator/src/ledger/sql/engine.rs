//! Engine: SQLite or PostgreSQL behind the same statements.
//!
//! A statement is written once, with `?` for its values. Several of them with `;` between
//! are one exchange: SQLite takes them as they are, PostgreSQL as one statement.

use crate::ledger::LedgerError;
use crate::ledger::clock::{Clock, LedgerTime};
use sqlx::postgres::{PgConnectOptions, PgConnection, PgPool, PgPoolOptions, PgRow};
use sqlx::sqlite::{
    Sqlite, SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqlitePool,
    SqlitePoolOptions, SqliteRow, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection as _, Decode, Postgres, Row as _, Type};
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Who writes to a ledger on PostgreSQL holds this lock ("cognate" as a number): commits of several coordinators come one
/// after the other. They meet in the counts of stages and tenants anyway.
const BEGIN: &str = "BEGIN; SELECT pg_advisory_xact_lock(27988512718550117); \
    SELECT CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT) AS now";
/// A coordinator that stands still in the middle of a commit loses its session after so long, in
/// milliseconds, and with it the lock. Default 3 s: below the time that a steward's right lasts.
const STANDSTILL_MS: &str = "3000";
/// No statement takes so long, in milliseconds, unless the server is in trouble.
const STATEMENT_MS: &str = "30000";
/// A server that does not answer is given up after this, and reached anew.
const ANSWER: Duration = Duration::from_secs(40);
/// One wait for a connection that reads. The pool's pauses between attempts to connect double up to a fifth of
/// this: a server that is there again is found within a second.
const ACQUIRE: Duration = Duration::from_secs(5);
/// How long whoever reads waits in all for a server that is away ...
const AWAY: Duration = Duration::from_secs(10);
/// ... and the pause after an attempt that failed at once.
const PAUSE: Duration = Duration::from_millis(100);

/// Where the database is, and whose clock counts.
#[derive(Clone)]
pub enum Engine {
    /// A file, and this process's clock.
    Sqlite(SqliteConnectOptions, Arc<dyn Clock>),
    /// A server, and its clock where there is no other.
    Postgres(PgConnectOptions, Option<Arc<dyn Clock>>),
}

/// Values that a ledger gets once: when it is made, or when a version first opens it that has them.
pub struct InitialValues {
    /// Name of the ledger.
    pub identity: String,
    /// Secret of the ledger's audits (`AuditKey::from_text`).
    pub audit_secret: String,
}

/// The connection that writes.
pub enum Connection {
    /// To a file.
    Sqlite(SqliteConnection, Arc<dyn Clock>),
    /// To a server.
    Postgres(PgConnection, Option<Arc<dyn Clock>>),
}

/// Connections that only read.
pub enum Readers {
    /// To a file.
    Sqlite(SqlitePool, Arc<dyn Clock>),
    /// To a server.
    Postgres(PgPool, Option<Arc<dyn Clock>>),
}

/// A row of either.
pub enum Row {
    /// A row of SQLite.
    Sqlite(SqliteRow),
    /// A row of PostgreSQL.
    Postgres(PgRow),
}

impl Row {
    /// A value of this row: `i64` or `String`, or either optional.
    pub fn try_get<T>(&self, column: &str) -> Result<T, LedgerError>
    where
        T: for<'r> Decode<'r, Sqlite> + Type<Sqlite>,
        T: for<'r> Decode<'r, Postgres> + Type<Postgres>,
    {
        let value = match self {
            Self::Sqlite(row) => row.try_get(column),
            Self::Postgres(row) => row.try_get(column),
        };
        Ok(value?)
    }
}

#[derive(Clone)]
enum Value {
    Number(i64),
    Text(Option<String>),
}

impl From<i64> for Value {
    fn from(value: i64) -> Self {
        Self::Number(value)
    }
}

impl From<u32> for Value {
    fn from(value: u32) -> Self {
        Self::Number(value.into())
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::Text(Some(value.to_owned()))
    }
}

impl From<&String> for Value {
    fn from(value: &String) -> Self {
        Self::Text(Some(value.clone()))
    }
}

impl From<String> for Value {
    fn from(value: String) -> Self {
        Self::Text(Some(value))
    }
}

impl From<Option<String>> for Value {
    fn from(value: Option<String>) -> Self {
        Self::Text(value)
    }
}

/// A statement and its values.
#[derive(Clone)]
pub struct Query {
    statement: &'static str,
    values: Vec<Value>,
}

/// A statement, or several with `;` between, with `?` for each value.
pub fn query(statement: &'static str) -> Query {
    Query {
        statement,
        values: Vec::new(),
    }
}

macro_rules! bound {
    ($query:expr, $values:expr) => {{
        let mut query = $query;
        for value in $values {
            query = match value {
                Value::Number(number) => query.bind(number),
                Value::Text(text) => query.bind(text),
            };
        }
        query
    }};
}

/// On this executor of either engine.
macro_rules! on {
    ($self:ident, $kind:ident, $target:ident, $c:ident => $c_of:expr, $call:ident, $done:expr) => {
        match $target {
            $kind::Sqlite($c, ..) => {
                let query = bound!(sqlx::query($self.statement), $self.values);
                query.$call($c_of).await.map($done.0)
            }
            $kind::Postgres($c, ..) => {
                let statement = for_postgres($self.statement);
                let query = bound!(sqlx::query(AssertSqlSafe(statement)), $self.values);
                query.$call($c_of).await.map($done.1)
            }
        }
    };
}

impl Query {
    /// The next value.
    #[must_use]
    #[allow(private_bounds)]
    pub fn bind(mut self, value: impl Into<Value>) -> Self {
        self.values.push(value.into());
        self
    }

    /// Carries it out; how many rows it changed, where it is one statement.
    pub async fn execute(self, c: &mut Connection) -> Result<u64, LedgerError> {
        let done = on!(self, Connection, c, c => &mut *c, execute,
            (|d: sqlx::sqlite::SqliteQueryResult| d.rows_affected(),
             |d: sqlx::postgres::PgQueryResult| d.rows_affected()));
        Ok(done?)
    }

    /// All rows.
    pub async fn fetch_all(self, c: &mut Connection) -> Result<Vec<Row>, LedgerError> {
        let rows = on!(self, Connection, c, c => &mut *c, fetch_all, (of_file, of_server));
        Ok(rows?)
    }

    /// The only row, if there is one.
    pub async fn fetch_optional(self, c: &mut Connection) -> Result<Option<Row>, LedgerError> {
        let row = on!(self, Connection, c, c => &mut *c, fetch_optional,
            (|r: Option<_>| r.map(Row::Sqlite), |r: Option<_>| r.map(Row::Postgres)));
        Ok(row?)
    }

    /// The only row.
    pub async fn fetch_one(self, c: &mut Connection) -> Result<Row, LedgerError> {
        let row = on!(self, Connection, c, c => &mut *c, fetch_one, (Row::Sqlite, Row::Postgres));
        Ok(row?)
    }

    /// All rows, from a connection that only reads; a server that is away is waited for.
    pub async fn read_all(self, readers: &Readers) -> Result<Vec<Row>, LedgerError> {
        let read = || async {
            let query = self.clone();
            on!(query, Readers, readers, c => c, fetch_all, (of_file, of_server))
        };
        Ok(readers.patiently(read).await?)
    }

    /// The only row, if there is one, from a connection that only reads; a server that is away is waited for.
    pub async fn read_optional(self, readers: &Readers) -> Result<Option<Row>, LedgerError> {
        let read = || async {
            let query = self.clone();
            on!(query, Readers, readers, c => c, fetch_optional,
                (|r: Option<_>| r.map(Row::Sqlite), |r: Option<_>| r.map(Row::Postgres)))
        };
        Ok(readers.patiently(read).await?)
    }
}

fn of_file(rows: Vec<SqliteRow>) -> Vec<Row> {
    rows.into_iter().map(Row::Sqlite).collect()
}

fn of_server(rows: Vec<PgRow>) -> Vec<Row> {
    rows.into_iter().map(Row::Postgres).collect()
}

/// As PostgreSQL wants it: numbered values, and one statement. Statements that are joined write to
/// different rows, so that it does not matter that each sees the tables as they were before all.
fn for_postgres(statements: &str) -> String {
    let mut parts: Vec<&str> = statements.split(';').map(str::trim).collect();
    let last = parts.pop().unwrap_or_default();
    let mut text = String::with_capacity(statements.len() + 64);
    for (number, part) in parts.iter().enumerate() {
        text += if number == 0 { "WITH " } else { ", " };
        text += &format!("part_{number} AS ({part})");
    }
    text += " ";
    text += last;
    let mut numbered = String::with_capacity(text.len() + 64);
    let mut value = 0;
    for c in text.trim().chars() {
        if c == '?' {
            value += 1;
            numbered += &format!("${value}");
        } else {
            numbered.push(c);
        }
    }
    numbered
}

impl Engine {
    /// In this file.
    pub fn sqlite(path: &Path, clock: Arc<dyn Clock>) -> Self {
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .busy_timeout(Duration::from_secs(10))
            .statement_cache_capacity(128);
        Self::Sqlite(options, clock)
    }

    /// On this server.
    pub fn postgres(url: &str, clock: Option<Arc<dyn Clock>>) -> Result<Self, LedgerError> {
        let options = PgConnectOptions::from_str(url)?
            .application_name("cognate")
            .statement_cache_capacity(128)
            .options([
                ("synchronous_commit", "on"),
                ("idle_in_transaction_session_timeout", STANDSTILL_MS),
                ("statement_timeout", STATEMENT_MS),
            ]);
        Ok(Self::Postgres(options, clock))
    }

    /// A connection that writes.
    pub async fn connect(&self) -> Result<Connection, LedgerError> {
        Ok(match self {
            Self::Sqlite(options, clock) => {
                Connection::Sqlite(options.connect().await?, Arc::clone(clock))
            }
            Self::Postgres(options, clock) => {
                let connection = tokio::time::timeout(ANSWER, options.connect()).await;
                let connection = connection.map_err(|_| no_answer())??;
                Connection::Postgres(connection, clock.clone())
            }
        })
    }

    /// Connections that only read.
    pub async fn readers(&self) -> Result<Readers, LedgerError> {
        Ok(match self {
            Self::Sqlite(options, clock) => {
                let pool = SqlitePoolOptions::new().max_connections(4);
                let pool = pool.connect_with(options.clone().read_only(true)).await?;
                Readers::Sqlite(pool, Arc::clone(clock))
            }
            Self::Postgres(options, clock) => {
                let pool = PgPoolOptions::new()
                    .max_connections(4)
                    .acquire_timeout(ACQUIRE);
                Readers::Postgres(pool.connect_with(options.clone()).await?, clock.clone())
            }
        })
    }
}

impl From<sqlx::Error> for LedgerError {
    fn from(error: sqlx::Error) -> Self {
        match is_out_of_reach(&error) {
            true => Self::Unreachable(error.to_string()),
            false => Self::Storage(error.to_string()),
        }
    }
}

/// Whether the database server is not there, goes down or comes up, or has ended the session.
fn is_out_of_reach(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Io(_) | sqlx::Error::PoolTimedOut => true,
        sqlx::Error::Database(error) => {
            // PostgreSQL, Error Codes: connection exceptions, operator intervention, too many
            // connections, a session that stood still in a transaction.
            let code = error.code().unwrap_or_default();
            code.starts_with("08") || code.starts_with("57P") || code == "53300" || code == "25P03"
        }
        _ => false,
    }
}

fn no_answer() -> LedgerError {
    LedgerError::Unreachable("the server does not answer".into())
}

const SERVER_TIME: &str =
    "SELECT CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT) AS now";

impl Readers {
    /// What is read, again and again while the server is away, for [`AWAY`] at most.
    async fn patiently<T, F>(&self, read: impl Fn() -> F) -> Result<T, sqlx::Error>
    where
        F: Future<Output = Result<T, sqlx::Error>>,
    {
        let begin = Instant::now();
        loop {
            match read().await {
                Err(error)
                    if matches!(self, Self::Postgres(..))
                        && is_out_of_reach(&error)
                        && begin.elapsed() < AWAY =>
                {
                    tracing::debug!(%error, "waiting for the ledger's database");
                    tokio::time::sleep(PAUSE).await;
                }
                read => return read,
            }
        }
    }

    /// The ledger's clock.
    pub async fn now(&self) -> Result<LedgerTime, LedgerError> {
        match self {
            Self::Sqlite(_, clock) | Self::Postgres(_, Some(clock)) => Ok(clock.now()),
            Self::Postgres(pool, None) => {
                let read = || sqlx::query(SERVER_TIME).fetch_one(pool);
                let row = self.patiently(read).await?;
                Ok(LedgerTime(row.try_get("now")?))
            }
        }
    }

    /// Closes them.
    pub async fn close(&self) {
        match self {
            Self::Sqlite(pool, _) => pool.close().await,
            Self::Postgres(pool, _) => pool.close().await,
        }
    }
}

impl Connection {
    /// Begins a commit that nobody else's comes between; the ledger's time in it.
    pub async fn begin(&mut self) -> Result<LedgerTime, LedgerError> {
        match self {
            Self::Sqlite(c, clock) => {
                sqlx::query("BEGIN IMMEDIATE").execute(c).await?;
                Ok(clock.now())
            }
            Self::Postgres(c, clock) => {
                // One exchange: the lock first, then the time.
                let begun = async {
                    let rows = sqlx::raw_sql(BEGIN).fetch_all(&mut *c).await?;
                    match (clock, rows.last()) {
                        (Some(clock), _) => Ok(clock.now()),
                        (None, Some(row)) => Ok(LedgerTime(row.try_get("now")?)),
                        (None, None) => Err(LedgerError::Damaged("it has no time".into())),
                    }
                };
                let begun = tokio::time::timeout(ANSWER, begun).await;
                begun.map_err(|_| no_answer())?
            }
        }
    }

    /// Makes what was written durable.
    pub async fn commit(&mut self) -> Result<(), LedgerError> {
        self.raw("COMMIT").await
    }

    /// Takes back what was written. An error: this connection is of no use any more.
    pub async fn roll_back(&mut self) -> Result<(), LedgerError> {
        self.raw("ROLLBACK").await
    }

    async fn raw(&mut self, statements: &'static str) -> Result<(), LedgerError> {
        match self {
            Self::Sqlite(c, _) => sqlx::raw_sql(statements).execute(c).await.map(|_| ())?,
            Self::Postgres(c, _) => {
                let done = sqlx::raw_sql(statements).execute(c);
                let done = tokio::time::timeout(ANSWER, done).await;
                done.map_err(|_| no_answer())?.map(|_| ())?;
            }
        }
        Ok(())
    }

    /// Closes it in order.
    pub async fn close(self) -> Result<(), LedgerError> {
        match self {
            Self::Sqlite(c, _) => c.close().await?,
            Self::Postgres(c, _) => c.close().await?,
        }
        Ok(())
    }

    /// Brings the schema to this version, all or nothing. A ledger without one of the initial values gets this one.
    pub async fn migrate(
        &mut self,
        migrations: &[&'static str],
        known: i64,
        initial: &InitialValues,
    ) -> Result<(), LedgerError> {
        self.begin().await?;
        let done = self.migrate_in(migrations, known, initial).await;
        match done {
            Ok(()) => self.commit().await,
            Err(error) => {
                // The connection ends with the error, and the commit with it.
                let _ = self.roll_back().await;
                Err(error)
            }
        }
    }

    async fn migrate_in(
        &mut self,
        migrations: &[&'static str],
        known: i64,
        initial: &InitialValues,
    ) -> Result<(), LedgerError> {
        let count = match self {
            Self::Sqlite(..) => "SELECT COUNT(*) AS n FROM sqlite_master WHERE type = 'table'",
            Self::Postgres(..) => {
                "SELECT COUNT(*) AS n FROM pg_catalog.pg_tables
                 WHERE schemaname = current_schema() AND tablename = 'ledger'"
            }
        };
        let tables: i64 = query(count).fetch_one(self).await?.try_get("n")?;
        let found: i64 = if tables == 0 {
            0
        } else {
            query("SELECT schema_version FROM ledger")
                .fetch_one(self)
                .await
                .map_err(|_| LedgerError::Damaged("it has no schema version".into()))?
                .try_get("schema_version")?
        };
        if found > known {
            return Err(LedgerError::TooNew { found, known });
        }
        let done = usize::try_from(found)
            .map_err(|_| LedgerError::Damaged(format!("its schema version is {found}")))?;
        for migration in &migrations[done..] {
            match self {
                Self::Sqlite(c, _) => {
                    sqlx::raw_sql(*migration).execute(&mut *c).await?;
                }
                Self::Postgres(c, _) => {
                    // Text is compared byte by byte, whatever the database's language.
                    let schema = migration.replace(" TEXT", " TEXT COLLATE \"C\"");
                    sqlx::raw_sql(AssertSqlSafe(schema))
                        .execute(&mut *c)
                        .await?;
                }
            }
        }
        if found < known {
            let write = if found == 0 {
                "INSERT INTO ledger (schema_version) VALUES (?)"
            } else {
                "UPDATE ledger SET schema_version = ?"
            };
            query(write).bind(known).execute(self).await?;
        }
        for (write, value) in [
            (
                "UPDATE ledger SET identity = ? WHERE identity IS NULL",
                &initial.identity,
            ),
            (
                "UPDATE ledger SET audit_secret = ? WHERE audit_secret IS NULL",
                &initial.audit_secret,
            ),
        ] {
            query(write).bind(value).execute(self).await?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_numbered_and_joined() {
        assert_eq!(
            for_postgres("SELECT 1 FROM a WHERE b = ? AND c = ?"),
            "SELECT 1 FROM a WHERE b = $1 AND c = $2"
        );
        assert_eq!(
            for_postgres(
                "UPDATE a SET b = ?; UPDATE c SET d = ?;\n UPDATE e SET f = ? WHERE g = ?"
            ),
            "WITH part_0 AS (UPDATE a SET b = $1), part_1 AS (UPDATE c SET d = $2) \
             UPDATE e SET f = $3 WHERE g = $4"
        );
    }
}
