//! A standby of Postgres takes over from a server that is gone.

use std::path::PathBuf;

use sqlx::PgPool;

use super::cluster::{Cluster, run};
use super::*;

/// A server that follows the one of a cluster, in a folder and with a socket of its own.
struct Standby<'a> {
    cluster: &'a Cluster,
    data: PathBuf,
    /// Of its copy of the database.
    address: String,
}

impl<'a> Standby<'a> {
    fn of(cluster: &'a Cluster, database: &str) -> Self {
        let (start, folder) = database.split_once("?host=").unwrap();
        let data = PathBuf::from(folder).join("standby");
        let mut copy = cluster.program("pg_basebackup");
        copy.args(["--host", folder, "--username=postgres", "--checkpoint=fast", "--no-sync"]);
        run(copy.args(["--wal-method=stream", "--write-recovery-conf", "--pgdata"]).arg(&data));
        let address = format!("{start}?host={}", data.display());
        let standby = Self { cluster, data, address };
        let settings = format!("-c unix_socket_directories={}", standby.data.display());
        standby.control(&["-w", "-l", &format!("{folder}/standby.log"), "-o", &settings, "start"]);
        standby
    }

    fn control(&self, arguments: &[&str]) {
        let mut control = self.cluster.program("pg_ctl");
        run(control.arg("-D").arg(&self.data).args(arguments));
    }
}

impl Drop for Standby<'_> {
    fn drop(&mut self) {
        let mut stop = self.cluster.program("pg_ctl");
        let _ = stop.arg("-D").arg(&self.data).args(["-m", "immediate", "stop"]).output();
    }
}

async fn requeued(store: &Postgres) -> Recovered {
    let found = async {
        loop {
            let recovered = store.recover_expired(NO_WAIT).await.unwrap();
            if recovered != Recovered::default() {
                return recovered;
            }
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    };
    tokio::time::timeout(LONG, found).await.expect("its lease ends")
}

#[tokio::test]
async fn a_standby_that_takes_over_charges_no_job_for_it_but_for_later_deaths() {
    let Some(cluster) = Cluster::alone() else { return };
    let address = cluster.database();
    let before = Postgres::open(&address).await.unwrap();
    let standby = Standby::of(&cluster, &address);
    let job = leased_job(&before, Duration::from_secs(1)).await.job_id;
    let pool = PgPool::connect(&standby.address).await.unwrap();
    let copied = async {
        let here = "SELECT EXISTS (SELECT 1 FROM jobs WHERE status = 'running')";
        while !sqlx::query_scalar::<_, bool>(here).fetch_one(&pool).await.unwrap() {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    tokio::time::timeout(LONG, copied).await.expect("the lease is copied");
    cluster.stop();
    standby.control(&["-w", "promote"]);

    let store = Postgres::open(&standby.address).await.unwrap();
    let again = Recovered { requeued: 1, ended: Vec::new() };
    assert_eq!(requeued(&store).await, again);
    let charged = || async {
        let charged = sqlx::query_scalar::<_, i64>("SELECT charged FROM jobs WHERE id = $1");
        charged.bind(&job).fetch_one(&pool).await.unwrap()
    };
    assert_eq!(charged().await, 0);
    for charge in 1..i64::from(MAX_ATTEMPTS) {
        assert!(lease(&store, EXPIRED).await.is_some());
        assert_eq!(requeued(&store).await, again);
        assert_eq!(charged().await, charge);
    }
}
