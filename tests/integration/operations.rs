//! What an operator and a stranger do with the program.

use std::process::Output;

use serde_json::Value;

use crate::process::{Server, command, servoscope, simulated};

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The line of `config show` about a setting: its value and where it comes from.
fn shown(output: &Output, name: &str) -> (String, String) {
    let all = text(&output.stdout);
    let line = all.lines().find(|line| line.trim_start_matches("# ").starts_with(name));
    let (value, origin) =
        line.unwrap_or_else(|| panic!("{name} in\n{all}")).rsplit_once('#').unwrap();
    (value.trim().to_owned(), origin.trim().to_owned())
}

#[test]
fn settings_come_from_defaults_file_environment_and_flags_in_that_order() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("servoscope.toml");
    std::fs::write(&file, "workers = 1\nkeep_days = 30\njob_minutes = 5\n").unwrap();
    let show = || {
        let mut command = command();
        command.args(["config", "show", "--config"]).arg(&file);
        command.env("SERVOSCOPE_WORKERS", "2").env("SERVOSCOPE_JOB_MINUTES", "6");
        command
    };
    let output = show().args(["--workers", "3"]).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let pair = |value: &str, origin: &str| (value.to_owned(), origin.to_owned());
    assert_eq!(shown(&output, "workers"), pair("workers = 3", "flag"));
    assert_eq!(shown(&output, "job_minutes"), pair("job_minutes = 6", "environment"));
    assert_eq!(shown(&output, "keep_days"), pair("keep_days = 30", "file"));
    assert_eq!(shown(&output, "listen"), pair("listen = \"127.0.0.1:8080\"", "default"));
    assert_eq!(shown(&output, "max_store_mib").1, "not set");

    // What it prints is a file that says the same.
    std::fs::write(&file, &output.stdout).unwrap();
    let again = command().args(["config", "show", "--config"]).arg(&file).output().unwrap();
    assert_eq!(shown(&again, "workers"), pair("workers = 3", "file"));

    let secret = "sk_servoscope_of_nobody";
    let with_key = show().env("SERVOSCOPE_ADMIN_KEY", secret).output().unwrap();
    assert_eq!(shown(&with_key, "admin_key"), pair("admin_key = \"***\"", "environment"));
    assert!(!text(&with_key.stdout).contains(secret));
    let two = show().args(["--admin-key", secret, "--admin-key-file", "key"]).output().unwrap();
    assert_eq!(two.status.code(), Some(2));
    assert!(text(&two.stderr).contains("not both"), "{}", text(&two.stderr));
}

#[test]
fn a_result_is_computed_again_to_the_bit_and_never_from_other_data() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let [data, other, result, changed] =
        ["a.csv", "b.csv", "result.json", "changed.json"].map(path);
    std::fs::write(&data, simulated(&["--noise-db", "60"])).unwrap();
    std::fs::write(&other, simulated(&["--noise-db", "60", "--seed", "2"])).unwrap();
    for kind in ["diagnose", "identify"] {
        let computed = servoscope(&[kind, &data, "--actuator-order", "0", "--seed", "7", "--json"]);
        assert!(computed.status.success(), "{}", text(&computed.stderr));
        std::fs::write(&result, &computed.stdout).unwrap();
        let same = servoscope(&["rerun", &result, &data]);
        assert!(same.status.success(), "{}", text(&same.stderr));
        assert!(text(&same.stdout).starts_with("SAME"), "{}", text(&same.stdout));
        assert_eq!(text(&same.stderr), "");
    }

    let refused = servoscope(&["rerun", &result, &other]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("not the files that the result was computed from"),
        "{}",
        text(&refused.stderr)
    );

    let mut value: Value = serde_json::from_slice(&std::fs::read(&result).unwrap()).unwrap();
    value["provenance"]["software_version"] = "0.0.9".into();
    value["fit"]["nrmse"] = 0.5.into();
    std::fs::write(&changed, value.to_string()).unwrap();
    let differs = servoscope(&["rerun", &changed, &data]);
    assert_eq!(differs.status.code(), Some(1));
    let said = text(&differs.stderr);
    assert!(said.contains("computed by servoscope 0.0.9"), "{said}");
    assert!(said.contains("fit.nrmse: 0.5 was"), "{said}");
}

#[test]
fn the_demonstration_shows_an_answer_and_addresses_that_open() {
    let directory = tempfile::tempdir().unwrap();
    let (server, printed) = Server::demonstrate(directory.path());
    assert!(printed.contains("EXPLAINED") && printed.contains("static_friction"), "{printed}");
    let addresses = printed.split_whitespace().filter(|word| word.starts_with("http://"));
    let mut count = 0;
    for address in addresses.filter_map(|address| address.strip_prefix(server.address())) {
        let path = if address.is_empty() { "/" } else { address };
        assert_eq!(server.get(path).status, 200, "{path}");
        count += 1;
    }
    assert!(count >= 5, "{printed}");
    assert_eq!(server.terminate(), Some(0));
}

#[test]
fn log_lines_are_json_where_that_is_asked_for_and_name_the_job_and_the_request() {
    let directory = tempfile::tempdir().unwrap();
    let log = directory.path().join("log");
    let arguments = ["--log-format", "json"];
    let server = Server::start_logging(&directory.path().join("data"), &arguments, &log);
    let job = crate::service::submit(&server, &serde_json::json!({"seed": 5}));
    assert_eq!(server.ended(&job)["status"], "succeeded");
    assert_eq!(server.terminate(), Some(0));
    let lines: Vec<Value> = std::fs::read_to_string(&log)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect();
    let id = job.rsplit('/').next().unwrap();
    let of_job = lines.iter().find(|line| line["message"] == "job ends").expect("it ends");
    assert_eq!((&of_job["span"]["job"], &of_job["outcome"]), (&id.into(), &"succeeded".into()));
    let answered =
        |line: &&Value| line["span"]["name"] == "request" && line["span"]["id"].is_string();
    assert!(lines.iter().any(|line| answered(&line)), "no request is named");
}
