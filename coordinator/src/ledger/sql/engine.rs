//! Engine: SQLite or PostgreSQL behind the same statements.
//!
//! A statement is written once, with `?` for its values. Several of them with `;` between
//! are one exchange: SQLite takes them as they are, PostgreSQL as one statement.

use super::damage::Damage;
use super::server_readers::{ServerReaders, is_out_of_reach, no_answer};
use crate::ledger::LedgerError;
use crate::ledger::clock::{Clock, LedgerTime};
use sqlx::error::DatabaseError;
use sqlx::postgres::{PgConnectOptions, PgConnection, PgRow};
use sqlx::sqlite::{
    Sqlite, SqliteConnectOptions, SqliteConnection, SqliteError, SqliteJournalMode, SqlitePool,
    SqlitePoolOptions, SqliteRow, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection as _, Decode, Postgres, Row as _, Type};
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::timeout;

/// Begins a commit on PostgreSQL and takes the writers' lock ("cognate" as a number): commits of several coordinators
/// come one after the other. They meet in the counts of stages and tenants anyway.
///
/// The settings are those of the transaction, so that a pooler between coordinator and server (PgBouncer) does not
/// notice them: a coordinator that stands still in the middle of a commit loses its session, and with it the lock,
/// after 3 s, below the time that a steward's right lasts; no statement takes 30 s unless the server is in trouble.
const BEGIN: &str = "BEGIN; SET LOCAL synchronous_commit = on; \
    SET LOCAL idle_in_transaction_session_timeout = 3000; SET LOCAL statement_timeout = 30000; \
    SELECT pg_advisory_xact_lock(27988512718550117); \
    SELECT CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT) AS now";
/// The server asks a silent connection whether it lives after 10 s, and drops one whose other side does not take what
/// was sent within 20 s: with it go its locks.
const KEEP_ALIVE: &str = "SET tcp_keepalives_idle = 10; SET tcp_keepalives_interval = 10; \
    SET tcp_user_timeout = 20000";
/// Time without an answer after which a server in a commit is given up and reached anew: longer than the server's own
/// limit of a statement.
const ANSWER: Duration = Duration::from_secs(35);
/// Time within which a server must let a connection in.
const CONNECT: Duration = Duration::from_secs(10);
/// Time within which a server must have begun a commit: longer than another coordinator that stands still may hold
/// the lock. A connection that has died silently is noticed here, before anything is written.
const BEGUN: Duration = Duration::from_secs(10);
/// Total time that a read waits for a server that is away.
const AWAY: Duration = Duration::from_secs(10);
/// Pause after an attempt to read that failed at once.
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
    Sqlite(SqlitePool, Arc<dyn Clock>, Damage),
    /// To a server.
    Postgres(Box<ServerReaders>, Option<Arc<dyn Clock>>),
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

/// On the connection that writes, of either engine; a server that does not answer is given up.
macro_rules! on {
    ($self:ident, $target:ident, $call:ident, $done:expr) => {
        match $target {
            Connection::Sqlite(c, _) => {
                let query = bound!(sqlx::query($self.statement), $self.values);
                query.$call(&mut *c).await.map($done.0)
            }
            Connection::Postgres(c, _) => {
                let statement = for_postgres($self.statement);
                let query = bound!(sqlx::query(AssertSqlSafe(statement)), $self.values);
                let done = timeout(ANSWER, query.$call(&mut *c)).await;
                done.unwrap_or_else(|late| Err(no_answer(late)))
                    .map($done.1)
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
        let done = on!(
            self,
            c,
            execute,
            (
                |d: sqlx::sqlite::SqliteQueryResult| d.rows_affected(),
                |d: sqlx::postgres::PgQueryResult| d.rows_affected()
            )
        );
        Ok(done?)
    }

    /// All rows.
    pub async fn fetch_all(self, c: &mut Connection) -> Result<Vec<Row>, LedgerError> {
        let rows = on!(self, c, fetch_all, (of_file, of_server));
        Ok(rows?)
    }

    /// The only row, if there is one.
    pub async fn fetch_optional(self, c: &mut Connection) -> Result<Option<Row>, LedgerError> {
        let row = on!(
            self,
            c,
            fetch_optional,
            (
                |r: Option<_>| r.map(Row::Sqlite),
                |r: Option<_>| r.map(Row::Postgres)
            )
        );
        Ok(row?)
    }

    /// The only row.
    pub async fn fetch_one(self, c: &mut Connection) -> Result<Row, LedgerError> {
        let row = on!(self, c, fetch_one, (Row::Sqlite, Row::Postgres));
        Ok(row?)
    }

    /// All rows, from a connection that only reads; a server that is away is waited for.
    pub async fn read_all(self, readers: &Readers) -> Result<Vec<Row>, LedgerError> {
        readers
            .patiently(|| self.clone().read_all_once(readers))
            .await
    }

    async fn read_all_once(self, readers: &Readers) -> Result<Vec<Row>, sqlx::Error> {
        match readers {
            Readers::Sqlite(pool, ..) => {
                let query = bound!(sqlx::query(self.statement), self.values);
                query.fetch_all(pool).await.map(of_file)
            }
            Readers::Postgres(pool, _) => {
                let statement = for_postgres(self.statement);
                let mut reader = pool.reader().await?;
                let query = bound!(sqlx::query(AssertSqlSafe(statement)), self.values);
                let (connection, patience) = reader.connection();
                let read = timeout(patience, query.fetch_all(connection)).await;
                reader.ended(read).map(of_server)
            }
        }
    }

    /// The only row, if there is one, from a connection that only reads; a server that is away is waited for.
    pub async fn read_optional(self, readers: &Readers) -> Result<Option<Row>, LedgerError> {
        readers
            .patiently(|| self.clone().read_optional_once(readers))
            .await
    }

    async fn read_optional_once(self, readers: &Readers) -> Result<Option<Row>, sqlx::Error> {
        match readers {
            Readers::Sqlite(pool, ..) => {
                let query = bound!(sqlx::query(self.statement), self.values);
                let row = query.fetch_optional(pool).await?;
                Ok(row.map(Row::Sqlite))
            }
            Readers::Postgres(pool, _) => {
                let statement = for_postgres(self.statement);
                let mut reader = pool.reader().await?;
                let query = bound!(sqlx::query(AssertSqlSafe(statement)), self.values);
                let (connection, patience) = reader.connection();
                let read = timeout(patience, query.fetch_optional(connection)).await;
                Ok(reader.ended(read)?.map(Row::Postgres))
            }
        }
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
            // Poolers refuse what they do not know; no number of a ledger is a float.
            .extra_float_digits(None);
        Ok(Self::Postgres(options, clock))
    }

    /// A connection that writes.
    pub async fn connect(&self) -> Result<Connection, LedgerError> {
        Ok(match self {
            Self::Sqlite(options, clock) => {
                Connection::Sqlite(options.connect().await?, Arc::clone(clock))
            }
            Self::Postgres(options, clock) => {
                let connect = async {
                    let mut connection = options.connect().await?;
                    sqlx::raw_sql(KEEP_ALIVE).execute(&mut connection).await?;
                    Ok::<_, sqlx::Error>(connection)
                };
                let connection = timeout(CONNECT, connect).await.map_err(no_answer)??;
                Connection::Postgres(connection, clock.clone())
            }
        })
    }

    /// Connections that only read.
    pub async fn readers(&self, damage: Damage) -> Result<Readers, LedgerError> {
        Ok(match self {
            Self::Sqlite(options, clock) => {
                let pool = SqlitePoolOptions::new().max_connections(4);
                let pool = pool.connect_with(options.clone().read_only(true)).await?;
                Readers::Sqlite(pool, Arc::clone(clock), damage)
            }
            Self::Postgres(options, clock) => {
                Readers::Postgres(Box::new(ServerReaders::new(options.clone())), clock.clone())
            }
        })
    }
}

impl From<sqlx::Error> for LedgerError {
    fn from(error: sqlx::Error) -> Self {
        if is_out_of_reach(&error) {
            Self::Unreachable(error.to_string())
        } else if is_malformed(&error) {
            Self::Malformed(error.to_string())
        } else {
            Self::Storage(error.to_string())
        }
    }
}

/// Whether SQLite says that the file is not what it wrote.
fn is_malformed(error: &sqlx::Error) -> bool {
    let sqlx::Error::Database(error) = error else {
        return false;
    };
    let Some(error) = error.try_downcast_ref::<SqliteError>() else {
        return false;
    };
    // SQLite, "Result and Error Codes": the low byte is the primary code; CORRUPT and NOTADB.
    let code = error.code().and_then(|code| code.parse::<u32>().ok());
    code.is_some_and(|code| matches!(code & 0xff, 11 | 26))
}

const SERVER_TIME: &str =
    "SELECT CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT) AS now";

impl Readers {
    /// Reads again and again while the server is away, for [`AWAY`] at most.
    async fn patiently<T, F>(&self, read: impl Fn() -> F) -> Result<T, LedgerError>
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
                Err(error) => {
                    let error = LedgerError::from(error);
                    if let Self::Sqlite(_, _, damage) = self {
                        damage.note(&error);
                    }
                    return Err(error);
                }
                Ok(read) => return Ok(read),
            }
        }
    }

    /// The ledger's clock.
    pub async fn now(&self) -> Result<LedgerTime, LedgerError> {
        match self {
            Self::Sqlite(_, clock, _) | Self::Postgres(_, Some(clock)) => Ok(clock.now()),
            Self::Postgres(_, None) => {
                let row = query(SERVER_TIME).read_optional(self).await?;
                let row = row.ok_or_else(|| LedgerError::Damaged("it has no time".into()))?;
                Ok(LedgerTime(row.try_get("now")?))
            }
        }
    }

    /// Closes them.
    pub async fn close(&self) {
        match self {
            Self::Sqlite(pool, ..) => pool.close().await,
            Self::Postgres(readers, _) => readers.close().await,
        }
    }
}

impl Connection {
    /// An error where pages of a file are damaged. Of a server its own tools find that out.
    pub async fn quick_check(&mut self) -> Result<(), LedgerError> {
        let Self::Sqlite(c, _) = self else {
            return Ok(());
        };
        let said = sqlx::query("PRAGMA quick_check(1)").fetch_one(c).await?;
        let said: String = said.try_get(0)?;
        match said.as_str() {
            "ok" => Ok(()),
            _ => Err(LedgerError::Malformed(said)),
        }
    }

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
                let begun = timeout(BEGUN, begun).await;
                begun.map_err(no_answer)?
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
                let done = timeout(ANSWER, done).await;
                done.map_err(no_answer)?.map(|_| ())?;
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
        newest_version: i64,
        initial: &InitialValues,
    ) -> Result<(), LedgerError> {
        self.begin().await?;
        let done = self.migrate_in(migrations, newest_version, initial).await;
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
        newest_version: i64,
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
        let file_version: i64 = if tables == 0 {
            0
        } else {
            query("SELECT schema_version FROM ledger")
                .fetch_one(self)
                .await
                .map_err(|_| LedgerError::Damaged("it has no schema version".into()))?
                .try_get("schema_version")?
        };
        if file_version > newest_version {
            return Err(LedgerError::TooNew {
                found: file_version,
                known: newest_version,
            });
        }
        let done = usize::try_from(file_version)
            .map_err(|_| LedgerError::Damaged(format!("its schema version is {file_version}")))?;
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
        if file_version < newest_version {
            let write = if file_version == 0 {
                "INSERT INTO ledger (schema_version) VALUES (?)"
            } else {
                "UPDATE ledger SET schema_version = ?"
            };
            query(write).bind(newest_version).execute(self).await?;
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
