//! Keys as an operator handles them, and a server that other machines could reach.

use std::path::Path;
use std::process::Output;

use crate::process::{Server, servoscope};

fn keys(folder: &Path, arguments: &[&str]) -> Output {
    servoscope(&[&["keys"], arguments, &["--data-dir", folder.to_str().unwrap()]].concat())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// What a command prints that makes a key: the key alone.
fn made(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(&output.stderr));
    let key = text(&output.stdout).trim().to_owned();
    assert!(key.starts_with("sk_servoscope_") && key.lines().count() == 1, "{key}");
    assert!(!text(&output.stderr).contains(&key));
    key
}

/// The part of a key by which it is found.
fn id(key: &str) -> &str {
    key.split('_').nth(2).unwrap()
}

/// The line of `keys list` about a key.
fn listed(folder: &Path, key: &str) -> String {
    let output = keys(folder, &["list"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let all = text(&output.stdout);
    let line = all.lines().find(|line| line.starts_with(id(key)));
    line.unwrap_or_else(|| panic!("{key} in\n{all}")).to_owned()
}

#[test]
fn an_address_that_others_can_reach_needs_a_valid_key() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let data_dir = folder.to_str().unwrap();
    let refused = || {
        let output = servoscope(&["serve", "--listen", "0.0.0.0:0", "--data-dir", data_dir]);
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        for part in ["servoscope keys add --name first --scope admin", "SERVOSCOPE_ADMIN_KEY_FILE"]
        {
            assert!(said.contains(part), "{said}");
        }
    };
    refused();
    let key = made(&keys(folder, &["add", "--name", "first", "--scope", "admin"]));
    let server = Server::reachable(folder, &[]);
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(server.get("/v1/jobs").status, 401);
    assert_eq!(server.get_with("/v1/jobs", &key).status, 200);
    assert!(keys(folder, &["revoke", id(&key)]).status.success());
    assert_eq!(server.get_with("/v1/jobs", &key).status, 401);
    drop(server);
    refused();
}

#[test]
fn a_container_takes_its_first_key_from_the_environment_or_a_file() {
    let key = made(&servoscope(&["keys", "generate"]));
    let directory = tempfile::tempdir().unwrap();
    let [data, file] = ["data", "key"].map(|name| directory.path().join(name));
    std::fs::write(&file, format!("{key}\n")).unwrap();
    let given = [
        ("SERVOSCOPE_ADMIN_KEY", key.as_str()),
        ("SERVOSCOPE_ADMIN_KEY_FILE", file.to_str().unwrap()),
    ];
    // The second time it is there already.
    for variable in given {
        let server = Server::reachable(&data, &[variable]);
        assert_eq!(server.get("/v1/keys").status, 401);
        let listed = server.get_with("/v1/keys", &key).json();
        assert_eq!(listed["items"].as_array().unwrap().len(), 1);
        assert_eq!(listed["items"][0]["scopes"], serde_json::json!(["admin"]));
    }
    assert!(keys(&data, &["revoke", id(&key)]).status.success());
    let start = |key: &str| {
        let data_dir = data.to_str().unwrap();
        let serve = ["serve", "--listen", "0.0.0.0:0", "--data-dir", data_dir, "--admin-key", key];
        let output = servoscope(&serve);
        assert_eq!(output.status.code(), Some(2));
        assert!(!text(&output.stderr).contains(key) || key.is_empty());
        text(&output.stderr)
    };
    assert!(start(&key).contains("no valid key"), "a revoked key stays revoked");
    let other = format!("sk_servoscope_{}_{}", id(&key), "0123456789abcdef".repeat(4));
    assert!(start(&other).contains("could be guessed"));
    assert!(start("password").contains("servoscope keys generate"));
    assert!(start("").contains("servoscope keys generate"));
    let digits = key.rsplit('_').next().unwrap();
    let other: String = digits.chars().rev().collect();
    assert!(start(&format!("sk_servoscope_{}_{other}", id(&key))).contains("another key"));
}

#[test]
fn the_log_names_the_key_of_a_request_and_never_shows_it() {
    let directory = tempfile::tempdir().unwrap();
    let [data, log] = ["data", "log"].map(|name| directory.path().join(name));
    let key = made(&keys(&data, &["add", "--name", "first", "--scope", "admin"]));
    let server = Server::start_logging(&data, &["--log-format", "json"], &log);
    assert_eq!(server.get_with("/v1/jobs", &key).status, 200);
    assert_eq!(server.get_with("/v1/jobs", &key.replace("sk_", "sk-")).status, 401);
    assert_eq!(server.terminate(), Some(0));
    let text = std::fs::read_to_string(log).unwrap();
    let named = format!("\"key\":\"{}\"", id(&key));
    assert!(text.lines().any(|line| line.contains(&named) && line.contains("/v1/jobs")), "{text}");
    assert!(!text.contains(key.rsplit('_').next().unwrap()), "{text}");
}

#[test]
fn keys_are_made_listed_rotated_and_revoked_while_a_server_runs() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let server = Server::start(folder, &[]);
    assert_eq!(server.get("/v1/jobs").status, 200);
    let scopes = ["add", "--name", "rig 7", "--scope", "upload,run", "--scope", "read"];
    let key = made(&keys(folder, &[&scopes[..], &["--days", "30"]].concat()));
    assert_eq!(server.get("/v1/jobs").status, 401);
    assert_eq!(server.get_with("/v1/jobs", &key).status, 200);
    assert_eq!(server.get_with("/v1/keys", &key).status, 403);
    let line = listed(folder, &key);
    assert!(line.contains("valid") && line.ends_with("upload,run,read  server  rig 7"), "{line}");
    assert!(!line.contains("never"), "it expires, and was used: {line}");

    let limit = |more: &[&str]| keys(folder, &[&["limit", id(&key)], more].concat());
    assert!(limit(&["--jobs", "3", "--mib", "50"]).status.success());
    assert!(limit(&["--mib", "server", "--requests-per-minute", "600"]).status.success());
    let line = listed(folder, &key);
    assert!(line.ends_with("jobs=3,requests_per_minute=600  rig 7"), "{line}");
    for wrong in ["0", "many", "-1"] {
        assert!(!limit(&[&format!("--jobs={wrong}")]).status.success(), "{wrong}");
    }

    let rotated = made(&keys(folder, &["rotate", id(&key)]));
    assert_eq!(id(&rotated), id(&key));
    assert_eq!(server.get_with("/v1/jobs", &key).status, 401);
    assert_eq!(server.get_with("/v1/jobs", &rotated).status, 200);
    assert!(keys(folder, &["revoke", id(&key)]).status.success());
    assert_eq!(server.get_with("/v1/jobs", &rotated).status, 401);
    assert!(listed(folder, &key).contains("revoked"));

    for (arguments, says) in [
        (&["add", "--name", "x", "--scope", "everything"][..], "read:all"),
        (&["add", "--name", "", "--scope", "read"], "name"),
        (&["add", "--name", "x"], "--scope"),
        (&["revoke", "nobody"], "no key `nobody`"),
        (&["rotate", id(&key)], "revoked"),
    ] {
        let output = keys(folder, arguments);
        assert!(!output.status.success(), "{arguments:?}");
        assert!(text(&output.stderr).contains(says), "{arguments:?}: {}", text(&output.stderr));
    }
    let nowhere = keys(&folder.join("nowhere"), &["list"]);
    assert_eq!(nowhere.status.code(), Some(2));
    assert!(!folder.join("nowhere").exists());
}
