//! Backups of servers that run, restored by either engine; and what is left where that is
//! interrupted.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde_json::{Value, json};

use crate::durability::{is_running, until, upload};
use crate::no_room;
use crate::postgres_cluster::Cluster;
use crate::process::{Server, command, servoscope, simulated};
use crate::service::{endless, submit};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn done(arguments: &[&str]) -> String {
    let output = servoscope(arguments);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn refused(arguments: &[&str], code: i32) -> String {
    let Output { status, stderr, .. } = servoscope(arguments);
    let said = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(code), "{said}");
    said
}

/// What a server answers about everything that it has; of lists whole pages.
fn everything(server: &Server, jobs: &[String]) -> Vec<Value> {
    let mut paths = vec!["/v1/measurements?limit=100".to_owned(), "/v1/mappings".into()];
    paths.push("/v1/webhooks".into());
    paths.extend(
        jobs.iter()
            .flat_map(|job| [job.clone(), format!("{job}/result"), format!("{job}/convergence")]),
    );
    let answers = paths.iter().map(|path| server.get(path));
    answers.map(|answer| (answer.status == 200).then(|| answer.json()).into()).collect()
}

#[test]
fn a_backup_of_a_server_that_runs_is_restored_by_either_engine_and_back() {
    let root = tempfile::tempdir().unwrap();
    let folder = |name: &str| root.path().join(name);
    let file = folder("backup");
    let server = Server::start(&folder("first"), &["--workers", "1"]);
    let jobs: Vec<_> = (0..3).map(|seed| submit(&server, &json!({ "seed": seed }))).collect();
    for job in &jobs {
        assert_eq!(server.ended(job)["status"], "succeeded");
    }
    let layout = json!({"settings": {"machine": "press"}});
    assert!(server.put("/v1/mappings/press", &layout).status < 300);
    let running = submit(&server, &endless());
    until(&server, &running, is_running);
    let before = everything(&server, &jobs);

    // Others go on storing meanwhile.
    let (stop, table) = (AtomicBool::new(false), simulated(&[]));
    let first = folder("first");
    let backup = ["backup", text(&file), "--data-dir", text(&first)];
    let output = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::Relaxed) {
                assert_eq!(upload(&server, &table).status, 201);
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        let output = servoscope(&backup);
        stop.store(true, Ordering::Relaxed);
        output
    });
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("jobs 4"), "{said}");
    assert!(until(&server, &running, is_running)["attempt"] == 1);
    server.kill();

    let one_more = |server: &Server| {
        let job = submit(server, &json!({"seed": 9}));
        assert_eq!(server.ended(&job)["status"], "succeeded");
    };
    // No worker: what ran would run again.
    let idle = ["--workers", "0"];
    done(&["restore", text(&file), "--data-dir", text(&folder("second"))]);
    let server = Server::start(&folder("second"), &idle);
    let restored = everything(&server, &jobs);
    assert_eq!(restored[1..], before[1..]);
    let measurements = restored[0]["items"].as_array().unwrap();
    assert!(before[0]["items"].as_array().unwrap().iter().all(|one| measurements.contains(one)));
    assert_eq!(server.get(&running).json()["status"], "queued");
    assert!(server.post(&format!("{running}/cancel"), "text/plain", b"").status < 300);
    drop(server);
    one_more(&Server::start(&folder("second"), &[]));

    let Some(cluster) = Cluster::shared() else { return };
    let database = cluster.database();
    let place = ["--database", database.as_str()];
    done(&[&["restore", text(&file)], &place[..]].concat());
    let server = Server::start(&folder("nothing"), &[&place[..], &idle].concat());
    assert_eq!(everything(&server, &jobs), restored);
    let back = folder("back");
    done(&[&["backup", text(&back)], &place[..]].concat());
    drop(server);
    done(&["restore", text(&back), "--data-dir", text(&folder("third"))]);
    let server = Server::start(&folder("third"), &idle);
    assert_eq!(everything(&server, &jobs), restored);
}

/// A server's folder with a measurement of some mebibytes, and a backup of it.
fn large(root: &Path) -> Vec<u8> {
    let data = root.join("data");
    let server = Server::start(&data, &[]);
    for seed in 0..12 {
        let stored = upload(&server, &no_room::large(seed));
        assert_eq!(stored.status, 201, "{}", stored.text);
    }
    drop(server);
    let file = root.join("backup");
    done(&["backup", text(&file), "--data-dir", text(&data)]);
    std::fs::read(&file).unwrap()
}

/// A pipe with a name: who reads or writes it stands still until the other end goes on.
fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

fn began(arguments: &[&str]) -> Child {
    command().args(arguments).stderr(Stdio::null()).spawn().unwrap()
}

fn killed(mut child: Child) {
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), None, "it had ended by itself");
}

#[test]
fn a_restore_that_is_killed_leaves_nothing_and_can_be_repeated() {
    let root = tempfile::tempdir().unwrap();
    let whole = large(root.path());
    let (slow, folder) = (root.path().join("slow"), root.path().join("restored"));
    pipe(&slow);
    let mut places = vec![vec!["--data-dir".to_owned(), text(&folder).to_owned()]];
    if let Some(cluster) = Cluster::shared() {
        places.push(vec!["--database".to_owned(), cluster.database()]);
    }
    for place in places {
        let place: Vec<&str> = place.iter().map(String::as_str).collect();
        let child = began(&[&["restore", text(&slow)], &place[..]].concat());
        let mut end = File::options().write(true).open(&slow).unwrap();
        // More is read than a pipe holds.
        assert!(whole.len() / 2 > 1 << 17, "{} bytes", whole.len());
        end.write_all(&whole[..whole.len() - 1000]).unwrap();
        killed(child);
        drop(end);
        let file = root.path().join("backup");
        let said = done(&[&["restore", text(&file)], &place[..]].concat());
        assert!(said.contains("measurements 12"), "{said}");
        let again = refused(&[&["restore", text(&file)], &place[..]].concat(), 2);
        assert!(again.contains("into an empty store only"), "{again}");
    }
}

#[test]
fn a_backup_that_is_killed_or_has_no_room_leaves_the_one_before() {
    let root = tempfile::tempdir().unwrap();
    let whole = large(root.path());
    let (file, part) = (root.path().join("backup"), root.path().join("backup.part"));
    pipe(&part);
    let data = root.path().join("data");
    let child = began(&["backup", text(&file), "--data-dir", text(&data)]);
    // It goes on as soon as somebody reads, and stands still when the pipe is full.
    let end = File::open(&part).unwrap();
    killed(child);
    drop(end);
    assert!(std::fs::read(&file).unwrap() == whole);
    std::fs::remove_file(&part).unwrap();
    std::os::unix::fs::symlink("/dev/full", &part).unwrap();
    let full = refused(&["backup", text(&file), "--data-dir", text(&data)], 2);
    assert!(full.contains("No space left"), "{full}");
    assert!(std::fs::read(&file).unwrap() == whole && !part.exists());
    done(&["backup", text(&file), "--data-dir", text(&data)]);
    assert!(std::fs::read(&file).unwrap() == whole, "the same store makes the same file");
}

#[test]
fn what_cannot_be_backed_up_or_restored_is_said() {
    let root = tempfile::tempdir().unwrap();
    let folder = |name: &str| root.path().join(name);
    let file = folder("backup");
    let nothing = refused(&["backup", text(&file), "--data-dir", text(&folder("none"))], 2);
    assert!(nothing.contains("there is no database in"), "{nothing}");
    assert!(!folder("none").exists() && !file.exists());
    let server = Server::start(&folder("data"), &[]);
    let unwritten = folder("none/backup");
    let unwritten = refused(&["backup", text(&unwritten), "--data-dir", text(&folder("data"))], 2);
    assert!(unwritten.contains("the folder is not there; make it first"), "{unwritten}");
    done(&["backup", text(&file), "--data-dir", text(&folder("data"))]);
    let busy = refused(&["restore", text(&file), "--data-dir", text(&folder("data"))], 1);
    assert!(busy.contains("another server runs on"), "{busy}");
    drop(server);

    let absent = refused(&["restore", text(&folder("absent"))], 2);
    assert!(absent.contains("there is no such file"), "{absent}");
    let table = folder("table");
    std::fs::write(&table, simulated(&[])).unwrap();
    let foreign = refused(&["restore", text(&table), "--data-dir", text(&folder("new"))], 2);
    assert!(foreign.contains("this is not a backup of servoscope"), "{foreign}");
    let whole = std::fs::read(&file).unwrap();
    std::fs::write(&file, &whole[..whole.len() - 9]).unwrap();
    let cut = refused(&["restore", text(&file), "--data-dir", text(&folder("new"))], 2);
    assert!(cut.contains("cut off or damaged"), "{cut}");
}

#[test]
fn a_database_that_is_cut_off_or_overwritten_is_said_at_the_start_and_left_as_it_is() {
    let root = tempfile::tempdir().unwrap();
    large(root.path());
    let [backup, data, new] = ["backup", "restored", "new"].map(|name| root.path().join(name));
    done(&["restore", text(&backup), "--data-dir", text(&data)]);
    let file = data.join("servoscope.sqlite3");
    let whole = std::fs::read(&file).unwrap();
    let half = whole[..whole.len() / 2].to_vec();
    let one_page_less = whole[..whole.len() - 4096].to_vec();
    let overwritten = [&[b'x'; 4096], &whole[4096..]].concat();
    for damaged in [half, one_page_less, overwritten, whole[..50].to_vec()] {
        std::fs::write(&file, &damaged).unwrap();
        let start = ["serve", "--listen", "127.0.0.1:0", "--data-dir", text(&data)];
        let said = refused(&start, 1);
        assert!(said.contains("its database is damaged"), "{said}");
        assert!(said.contains("servoscope restore FILE"), "{said}");
        assert!(std::fs::read(&file).unwrap() == damaged);
    }
    done(&["restore", text(&backup), "--data-dir", text(&new)]);
    let server = Server::start(&new, &[]);
    assert_eq!(server.get("/v1/measurements").json()["items"].as_array().unwrap().len(), 12);
}
