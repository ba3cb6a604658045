//! A process of the version before goes on while a newer one changes the database under it.
//!
//! `session_of_step_4.json` is what a server of that version sent while it stored measurements,
//! computed, cancelled and deleted jobs and batches, told a receiver and made keys: each statement
//! with its values, as Postgres logs them (`log_statement = all`), without transactions and without
//! reads that were repeated. Whoever adds a step after a release records one of that release.

use serde::Deserialize;
use sqlx::{AssertSqlSafe, PgConnection, PgPool, raw_sql};

use crate::store::contract::cluster::Cluster;

use super::migrations;

/// Steps that the version before knew.
const BEFORE: usize = 4;

#[derive(Deserialize)]
struct Session {
    statements: Vec<String>,
    session: Vec<Sent>,
}

/// A statement by its place, and its values.
#[derive(Deserialize)]
#[serde(from = "Vec<serde_json::Value>")]
struct Sent {
    statement: usize,
    values: Vec<Option<String>>,
}

impl From<Vec<serde_json::Value>> for Sent {
    fn from(parts: Vec<serde_json::Value>) -> Self {
        let values = parts[1..].iter().map(|value| value.as_str().map(str::to_owned));
        Self { statement: parts[0].as_u64().unwrap() as usize, values: values.collect() }
    }
}

async fn send(connection: &mut PgConnection, sql: String) -> u64 {
    let done = raw_sql(AssertSqlSafe(sql.clone())).execute(connection).await;
    done.unwrap_or_else(|error| panic!("{error}: {sql}")).rows_affected()
}

/// Sends a session to a new database, which a newer process changes before the statement `changed`;
/// how many rows each statement found or wrote.
async fn replayed(session: &Session, address: &str, changed: usize) -> Vec<u64> {
    let pool = PgPool::connect(address).await.unwrap();
    migrations::first(BEFORE).run(&pool).await.unwrap();
    let mut connection = pool.acquire().await.unwrap();
    let mut prepared = vec![false; session.statements.len()];
    let mut rows = Vec::new();
    for (place, Sent { statement, values }) in session.session.iter().enumerate() {
        if place == changed {
            migrations::run(&pool).await.unwrap();
        }
        // Prepared once, as by a process: one that reads all of a table fails after the change.
        if !std::mem::replace(&mut prepared[*statement], true) {
            let sql = &session.statements[*statement];
            send(&mut connection, format!("PREPARE s{statement} {sql}")).await;
        }
        let values = values.iter().map(|value| match value {
            Some(text) => format!("'{}'", text.replace('\'', "''")),
            None => "NULL".to_owned(),
        });
        let values = values.collect::<Vec<_>>().join(", ");
        let values = if values.is_empty() { values } else { format!("({values})") };
        rows.push(send(&mut connection, format!("EXECUTE s{statement}{values}")).await);
    }
    rows
}

#[tokio::test]
async fn a_server_of_the_version_before_goes_on_while_the_database_is_brought_up_to_date() {
    let Some(cluster) = Cluster::shared() else { return };
    let session: Session = serde_json::from_str(include_str!("session_of_step_4.json")).unwrap();
    let length = session.session.len();
    let unchanged = replayed(&session, &cluster.database(), length).await;
    let effective = unchanged.iter().filter(|rows| **rows > 0).count();
    assert!(2 * effective > length, "most statements find or write something, not {effective}");
    for changed in [0, length / 4, length / 2, 3 * length / 4] {
        let rows = replayed(&session, &cluster.database(), changed).await;
        assert_eq!(rows, unchanged, "changed before statement {changed}");
    }
}
