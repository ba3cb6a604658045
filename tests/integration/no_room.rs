//! A Postgres whose disk is full.

use std::path::Path;
use std::process::Command;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use sqlx::{AssertSqlSafe, Connection as _};

use crate::durability::{Mounted, count, fill, upload};
use crate::postgres_cluster::Cluster;
use crate::process::{Server, simulated};
use crate::service::submit;
use crate::shared_files::skipped;
use crate::worker_process::{QUICK, Worker};

/// A measurement of about half a mebibyte that is hardly smaller when it is packed.
pub fn large(seed: u64) -> Vec<u8> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let letter = || char::from(b"0123456789abcdefghijklmnopqrstuvwxyz"[random.random_range(0..36)]);
    let remark: String = std::iter::repeat_with(letter).take(500_000).collect();
    [format!("# {remark}\n").into_bytes(), simulated(&[])].concat()
}

/// The address of a new database of the cluster whose tables are files of a folder.
fn database_in(cluster: &Cluster, folder: &Path) -> String {
    // Root starts the cluster as somebody else.
    if rustix::process::geteuid().is_root() {
        assert!(Command::new("chown").arg("nobody").arg(folder).status().unwrap().success());
    }
    let address = cluster.database();
    let space = format!("CREATE TABLESPACE small LOCATION '{}'", folder.display());
    let statements = [space, "CREATE DATABASE small TABLESPACE small".into()];
    tokio::runtime::Runtime::new().unwrap().block_on(async {
        let mut connection = sqlx::PgConnection::connect(&address).await.unwrap();
        for statement in statements {
            sqlx::query(AssertSqlSafe(statement)).execute(&mut connection).await.unwrap();
        }
    });
    let (before, after) = address.split_once("/test_0").unwrap();
    format!("{before}/small{after}")
}

#[test]
fn a_postgres_without_room_refuses_uploads_whole_and_its_jobs_end_once_there_is_room() {
    let Some(cluster) = Cluster::alone() else { return };
    let directory = tempfile::tempdir().unwrap();
    let Some(_disk) = Mounted::small(directory.path(), 24) else {
        skipped("no file system can be mounted here");
        return;
    };
    let (ballast, space) = (directory.path().join("ballast"), directory.path().join("space"));
    std::fs::write(&ballast, vec![0; 4 << 20]).unwrap();
    std::fs::create_dir(&space).unwrap();
    let database = database_in(&cluster, &space);
    let folder = tempfile::tempdir().unwrap();
    let place = [&["--database", database.as_str()], &QUICK[..]].concat();
    let server = Server::start(folder.path(), &[&place[..], &["--workers", "0"]].concat());
    let jobs: Vec<_> = (0..4).map(|seed| submit(&server, &json!({ "seed": seed }))).collect();

    let table = large(7);
    let stored = fill(&server, &table);
    assert!(!stored.is_empty());
    assert_eq!(count(&server), jobs.len() + stored.len(), "half a measurement was stored");
    assert_eq!(server.get("/livez").status, 200);
    let worker = Worker::start(&place[..2]);
    // Long enough for a few of them.
    std::thread::sleep(std::time::Duration::from_secs(3));
    assert!(upload(&server, &table).status == 507, "there is room again");
    std::fs::remove_file(&ballast).unwrap();

    assert_eq!(upload(&server, &table).status, 201);
    assert_eq!(server.get("/readyz").status, 200);
    for job in &jobs {
        let ended = server.ended(job);
        assert_eq!(ended["status"], "succeeded", "{ended}");
        assert_eq!(server.get(&format!("{job}/result")).status, 200);
    }
    assert_eq!(worker.terminate(), Some(0));
}
