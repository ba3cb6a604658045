//! Locks that are held until a transaction ends, for what no row stands for.

use sqlx::PgConnection;

/// Jobs of one submitter are queued one after the other.
pub(super) const SUBMITTER: &str = "submitter";
/// Mappings of one owner are counted and stored one after the other.
pub(super) const MAPPINGS: &str = "mappings";
/// Webhooks of one owner are counted and stored one after the other.
pub(super) const WEBHOOKS: &str = "webhooks";
/// Messages are taken one after the other.
pub(super) const MESSAGES: &str = "messages";
/// Expired leases are looked for by one process at a time.
const RECOVERY: &str = "recovery";

/// Waits for the lock of something by name.
pub(super) async fn wait_for(
    connection: &mut PgConnection,
    what: &'static str,
    name: &str,
) -> sqlx::Result<()> {
    sqlx::query("SELECT pg_advisory_xact_lock(hashtext($1), hashtext($2))")
        .bind(what)
        .bind(name)
        .execute(connection)
        .await?;
    Ok(())
}

/// Takes the lock of the recovery. `false`: another process has it.
pub(super) async fn recovery(connection: &mut PgConnection) -> sqlx::Result<bool> {
    sqlx::query_scalar("SELECT pg_try_advisory_xact_lock(hashtext($1), 0)")
        .bind(RECOVERY)
        .fetch_one(connection)
        .await
}
