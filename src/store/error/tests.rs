//! Which errors are for good, by what the databases themselves say.

use std::time::Duration;

use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions as _, Connection as _, PgConnection, SqliteConnection};

use super::*;
use crate::store::contract::cluster::Cluster;

/// What SQLite says to a statement.
async fn of_sqlite(connection: &mut SqliteConnection, statement: &'static str) -> StoreError {
    sqlx::query(statement).execute(connection).await.unwrap_err().into()
}

#[tokio::test]
async fn what_sqlite_cannot_hold_is_refused_for_good() {
    let mut connection = SqliteConnection::connect("sqlite::memory:").await.unwrap();
    let table = "CREATE TABLE kept (id INTEGER PRIMARY KEY, text TEXT NOT NULL)";
    sqlx::query(table).execute(&mut connection).await.unwrap();
    for statement in [
        "INSERT INTO kept (text) VALUES (NULL)",
        "INSERT INTO kept (id, text) VALUES (1, 'one'), (1, 'another')",
        "INSERT INTO kept (id, text) VALUES ('no number', 'one')",
        "INSERT INTO kept (text) VALUES (zeroblob(2000000000))",
    ] {
        let error = of_sqlite(&mut connection, statement).await;
        assert!(error.is_permanent(), "{statement}: {error:?}");
    }
}

#[tokio::test]
async fn what_sqlite_may_take_another_time_is_not_refused_for_good() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("kept.sqlite3");
    let options = SqliteConnectOptions::new().filename(file).create_if_missing(true);
    let options = options.busy_timeout(Duration::ZERO);
    let mut connection = options.connect().await.unwrap();
    for statement in [
        "CREATE TABLE kept (id INTEGER PRIMARY KEY, text TEXT)",
        "CREATE TRIGGER raises BEFORE DELETE ON kept BEGIN SELECT RAISE(ABORT, 'no'); END",
        "INSERT INTO kept (text) VALUES ('one')",
        "PRAGMA max_page_count = 3",
    ] {
        sqlx::query(statement).execute(&mut connection).await.unwrap();
    }
    let raised = of_sqlite(&mut connection, "DELETE FROM kept").await;
    let large = "INSERT INTO kept (text) VALUES (zeroblob(100000))";
    let full = of_sqlite(&mut connection, large).await;
    assert!(matches!(full, StoreError::Full(_)), "{full:?}");
    let mut other = options.connect().await.unwrap();
    sqlx::query("BEGIN IMMEDIATE").execute(&mut other).await.unwrap();
    let locked = of_sqlite(&mut connection, "INSERT INTO kept (text) VALUES ('two')").await;
    assert!(locked.is_locked(), "{locked:?}");
    for error in [raised, full, locked] {
        assert!(!error.is_permanent(), "{error:?}");
    }
}

#[test]
fn what_no_database_has_refused_is_tried_again() {
    let lost = std::io::Error::from(std::io::ErrorKind::ConnectionReset);
    for error in [sqlx::Error::PoolTimedOut, sqlx::Error::PoolClosed, sqlx::Error::Io(lost)] {
        let error = StoreError::from(error);
        assert!(!error.is_permanent(), "{error:?}");
    }
    assert!(!StoreError::Silent.is_permanent());
    assert!(StoreError::from(sqlx::Error::Encode("too long".into())).is_permanent());
}

#[tokio::test]
async fn the_state_of_an_error_of_postgres_says_whether_it_is_for_good() {
    let Some(cluster) = Cluster::shared() else { return };
    let mut connection = PgConnection::connect(&cluster.database()).await.unwrap();
    let mut says = async |statement: String| -> StoreError {
        let said = sqlx::raw_sql(AssertSqlSafe(statement)).execute(&mut connection).await;
        said.unwrap_err().into()
    };
    for statement in ["SELECT 99999::smallint", "SELECT repeat('0123456789', 200000000)"] {
        let error = says(statement.into()).await;
        assert!(error.is_permanent(), "{statement}: {error:?}");
    }
    let raises = |state: &str| format!("DO $$ BEGIN RAISE SQLSTATE '{state}'; END $$");
    for state in ["22003", "22021", "22P05", "23502", "23505", "23514", "54000", "54001"] {
        let error = says(raises(state)).await;
        assert!(error.is_permanent(), "{state}: {error:?}");
    }
    // In each other's way, no room, too many connections, locked, cancelled, stopped, cut off,
    // read-only, raised by a trigger.
    for state in [
        "40001", "40P01", "53100", "53200", "53300", "55P03", "57014", "57P01", "08006", "25006",
        "P0001",
    ] {
        let error = says(raises(state)).await;
        assert!(!error.is_permanent(), "{state}: {error:?}");
    }
}
