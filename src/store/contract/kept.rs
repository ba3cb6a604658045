//! A store of either engine with everything in it as the database itself says.

use std::collections::BTreeMap;

use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, Column as _, Connection as _, TypeInfo as _};

use super::cluster::Cluster;
use super::{Postgres, Sqlite, Store};

/// Tables that hold nothing of value or follow from others, and what only one engine has.
const LEFT_OUT: [&str; 3] = ["_sqlx_migrations", "probe", "queue"];
const DERIVED: &str = "measured_at_ms";

/// Rows by table, each with its values by column.
pub(super) type Dump = BTreeMap<String, Vec<BTreeMap<String, String>>>;

/// A fresh store, and where it is.
pub(super) enum Kept {
    Sqlite(tempfile::TempDir, Sqlite),
    Postgres(String, Postgres),
}

impl Kept {
    pub(super) async fn sqlite() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = Sqlite::open(folder.path()).await.unwrap();
        Self::Sqlite(folder, store)
    }

    pub(super) async fn postgres() -> Option<Self> {
        let address = Cluster::shared()?.database();
        let store = Postgres::open(&address).await.unwrap();
        Some(Self::Postgres(address, store))
    }

    pub(super) fn store(&self) -> &dyn Store {
        match self {
            Self::Sqlite(_, store) => store,
            Self::Postgres(_, store) => store,
        }
    }

    /// Columns and their types by table, as the database says.
    pub(super) async fn catalogue(&self) -> BTreeMap<String, BTreeMap<String, String>> {
        let rows: Vec<(String, String, String)> = match self {
            Self::Sqlite(folder, _) => sqlx::query_as(
                "SELECT t.name, c.name, c.type FROM sqlite_master AS t, pragma_table_info(t.name) AS c
                 WHERE t.type = 'table'",
            )
            .fetch_all(&mut sqlite(folder).await)
            .await
            .unwrap(),
            Self::Postgres(address, _) => sqlx::query_as(
                "SELECT t.table_name::text, c.column_name::text, c.data_type::text
                 FROM information_schema.tables AS t JOIN information_schema.columns AS c
                 USING (table_schema, table_name)
                 WHERE table_schema = 'public' AND table_type = 'BASE TABLE'",
            )
            .fetch_all(&mut sqlx::PgConnection::connect(address).await.unwrap())
            .await
            .unwrap(),
        };
        let mut tables: BTreeMap<_, BTreeMap<_, _>> = BTreeMap::new();
        for (table, column, kind) in rows {
            if !LEFT_OUT.contains(&table.as_str()) && column != DERIVED {
                tables.entry(table).or_default().insert(column, kind);
            }
        }
        tables
    }

    /// Everything, read without the code that is tested.
    pub(super) async fn dump(&self) -> Dump {
        let mut dump = Dump::new();
        for (table, columns) in self.catalogue().await {
            let value = |(name, kind): (&String, &String)| match kind.as_str() {
                "REAL" | "double precision" => name.clone(),
                "BLOB" => format!("lower(hex({name})) AS {name}"),
                "bytea" => format!("encode({name}, 'hex') AS {name}"),
                "boolean" => format!("CAST(CAST({name} AS INTEGER) AS TEXT) AS {name}"),
                _ => format!("CAST({name} AS TEXT) AS {name}"),
            };
            let values: Vec<String> = columns.iter().map(value).collect();
            let read = AssertSqlSafe(format!("SELECT {} FROM {table}", values.join(", ")));
            let mut rows = match self {
                Self::Sqlite(folder, _) => {
                    let rows = sqlx::query(read).fetch_all(&mut sqlite(folder).await).await;
                    rows.unwrap().iter().map(texts).collect::<Vec<_>>()
                }
                Self::Postgres(address, _) => {
                    let mut connection = sqlx::PgConnection::connect(address).await.unwrap();
                    let rows = sqlx::query(read).fetch_all(&mut connection).await;
                    rows.unwrap().iter().map(texts).collect()
                }
            };
            rows.sort();
            dump.insert(table, rows);
        }
        dump
    }
}

async fn sqlite(folder: &tempfile::TempDir) -> sqlx::SqliteConnection {
    let file = folder.path().join("servoscope.sqlite3");
    let options = SqliteConnectOptions::new().filename(file);
    sqlx::SqliteConnection::connect_with(&options).await.unwrap()
}

/// The values of a row as text.
fn texts<R: sqlx::Row>(row: &R) -> BTreeMap<String, String>
where
    usize: sqlx::ColumnIndex<R>,
    for<'r> f64: sqlx::Decode<'r, R::Database> + sqlx::Type<R::Database>,
    for<'r> String: sqlx::Decode<'r, R::Database> + sqlx::Type<R::Database>,
{
    let text = |column: &<R::Database as sqlx::Database>::Column| {
        let at = column.ordinal();
        let value = if ["REAL", "FLOAT8"].contains(&column.type_info().name()) {
            row.get::<Option<f64>, _>(at).map(|value| format!("{value:?}"))
        } else {
            row.get::<Option<String>, _>(at)
        };
        (column.name().to_owned(), value.unwrap_or_else(|| "NULL".into()))
    };
    row.columns().iter().map(text).collect()
}
