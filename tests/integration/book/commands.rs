//! Commands of the pages, run as they stand.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::listed::{block, book};
use super::text;
use crate::process::{Server, command, servoscope};
use crate::shared_files::{shared, skipped};
use crate::worker_process::Worker;

/// How the pages run the program without installing it.
const RUN: &str = "cargo run --release -- ";

/// The server that the pages speak to.
const ADDRESS: &str = "http://127.0.0.1:8080";

/// Runs lines in `folder`, which is also the home of whoever types them, and gives what they print.
fn paste(lines: &str, folder: &Path) -> String {
    let program = env!("CARGO_BIN_EXE_servoscope");
    let lines = lines.replace(RUN, "servoscope ");
    let script = format!("servoscope() {{ '{program}' \"$@\"; }}\n{lines}\n");
    let mut shell = Command::new("bash");
    shell.args(["-eu", "-c", &script]).current_dir(folder).env("HOME", folder);
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("SERVOSCOPE_")) {
        shell.env_remove(name);
    }
    let output = shell.output().expect("there is a shell");
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{lines}\n{out}\n{err}");
    out
}

/// The same with another server than that of the pages.
fn paste_to(server: &Server, lines: &str, folder: &Path) -> String {
    assert!(lines.contains(ADDRESS), "{lines}");
    paste(&lines.replace(ADDRESS, server.address()), folder)
}

fn exists(folder: &Path, path: &str) {
    assert!(folder.join(path).metadata().is_ok_and(|file| file.len() > 0), "there is no {path}");
}

/// The block that computes a folder: what fills it, and the command.
fn of_a_folder() -> (String, String) {
    let block = block("docs/command-line.md", "mkdir -p runs");
    let (filling, command) = block.rsplit_once('\n').unwrap();
    (filling.to_owned(), command.to_owned())
}

#[test]
fn the_plan_of_the_page_is_printed_and_written_as_table_input_and_figure() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let command = block("docs/measuring.md", "cargo run --release -- plan ");
    let printed = paste(&command, folder);
    let words: Vec<&str> = printed.split_whitespace().collect();
    let ["Plan", experiments, "experiments", "in", _, "s", "of", "80", "s", ..] = words[..] else {
        panic!("{printed}");
    };
    let table = std::fs::read_to_string(folder.join("plan.csv")).unwrap();
    let mut rows = table.lines();
    assert!(rows.next().unwrap().starts_with("run,magnitude,omega_rad_s,settle_periods"));
    assert_eq!(rows.count().to_string(), experiments, "{table}");
    let played = std::fs::read_to_string(folder.join("played.csv")).unwrap();
    let played = played.lines().find(|line| !line.starts_with('#'));
    assert_eq!(played, Some("time_s,input,segment"));
    let figure = std::fs::read_to_string(folder.join("plan.svg")).unwrap();
    assert!(figure.starts_with("<svg ") && figure.trim_end().ends_with("</svg>"));
}

#[test]
fn the_folder_of_the_page_is_computed_as_one_batch() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(&folder.path().join("store"), &[]);
    let (filling, batch) = of_a_folder();
    let printed = paste_to(&server, &format!("{filling}\n{batch}"), folder.path());
    for part in ["run-1.csv  succeeded", "run-3.csv  succeeded", "3 of 3 ended: 3 succeeded"] {
        assert!(printed.contains(part), "{part} is missing in\n{printed}");
    }
    let again = paste_to(&server, &batch, folder.path());
    assert_eq!(again, printed, "the same command shows the same batch");
    let count = |path: &str| server.get(path).json()["items"].as_array().unwrap().len();
    assert_eq!([count("/v1/batches"), count("/v1/measurements"), count("/v1/jobs")], [1, 3, 3]);
}

#[test]
fn a_server_and_a_worker_of_the_page_on_load_compute_its_batch() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let block = block("docs/load.md", "servoscope serve --workers 0");
    let (processes, batch) = block.split_once('\n').unwrap();
    let [serve, work] = ["servoscope serve ", "servoscope worker "].map(|start| {
        let typed = processes.split('&').find_map(|typed| typed.trim().strip_prefix(start));
        typed.unwrap_or_else(|| panic!("no {start}")).split_whitespace().collect::<Vec<_>>()
    });
    let server = Server::start(&folder.join("servoscope-data"), &serve);
    let mut worker = command();
    worker.arg("worker").args(work).current_dir(folder);
    let _worker = Worker(worker.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap());
    paste(&of_a_folder().0, folder);
    let printed = paste_to(&server, &batch.replace("DIR", "runs"), folder);
    assert!(printed.contains("3 of 3 ended: 3 succeeded"), "{printed}");
}

#[test]
fn every_server_of_the_pages_starts() {
    for (page, begins) in [
        ("README.md", "cargo run --release -- serve --demo"),
        ("docs/dashboard.md", "cargo run --release -- serve --demo"),
        ("docs/http.md", "cargo run --release -- serve --data-dir"),
        ("docs/notifications.md", "servoscope serve --webhook-allow"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let typed = block(page, begins).replace(RUN, "servoscope ");
        let mut server = command();
        server.args(typed.split_whitespace().skip(1)).args(["--listen", "127.0.0.1:0"]);
        server.current_dir(folder.path()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = server.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
        server.kill().unwrap();
        server.wait().unwrap();
        assert!(line.starts_with("listening on http://127.0.0.1:"), "{page}: {typed}\n{line}");
        assert!(folder.path().join("servoscope-data").is_dir(), "{page}: {typed}");
    }
}

#[test]
fn the_webhook_of_the_page_is_registered_and_its_secret_shown() {
    if Command::new("curl").arg("--version").output().is_err() {
        skipped("curl is absent");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(&folder.path().join("store"), &[]);
    let printed = paste_to(&server, &block("docs/notifications.md", "curl "), folder.path());
    let hook: Value = serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{printed}"));
    assert!(hook["secret"].as_str().is_some_and(|secret| secret.starts_with("whsec_")), "{hook}");
    let listed = server.get(&format!("/v1/webhooks/{}", hook["id"].as_str().unwrap())).json();
    assert_eq!(listed["url"], "https://mes.example/servoscope");
    assert_eq!(listed["events"], serde_json::json!(["axis.changed"]));
}

#[test]
fn completions_and_manual_pages_are_written_where_the_page_has_them() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for folder in [".local/share/bash-completion/completions", ".config/fish/completions", "zsh"] {
        std::fs::create_dir_all(home.join(folder)).unwrap();
    }
    // The first element of an array has the index 1 in zsh, and 0 here.
    let scripts = block("docs/command-line.md", "servoscope completions bash");
    paste(&format!("fpath=(. ~/zsh)\n{scripts}"), home);
    exists(home, ".local/share/bash-completion/completions/servoscope");
    exists(home, "zsh/_servoscope");
    exists(home, ".config/fish/completions/servoscope.fish");
    let manual = block("docs/command-line.md", "servoscope man ");
    let (writing, reading) = manual.split_once('\n').unwrap();
    paste(writing, home);
    let page = reading.strip_prefix("man ").unwrap();
    exists(home, &format!(".local/share/man/man1/{page}.1"));
}

#[test]
fn a_folder_that_is_backed_up_as_on_the_page_has_the_same_keys_when_it_is_restored() {
    let folder = tempfile::tempdir().unwrap();
    paste(&block("docs/operating.md", "cargo run --release -- keys add"), folder.path());
    paste(&block("docs/operating.md", "servoscope backup FILE"), folder.path());
    let keys = |of: &str| paste(&format!("servoscope keys list --data-dir {of}"), folder.path());
    let restored = keys("another-folder");
    assert!(restored.contains("rig 7"), "{restored}");
    assert_eq!(restored, keys("servoscope-data"));
}

#[test]
#[ignore = "slow: a diagnosis of a measured record"]
fn the_real_machine_has_the_answer_that_its_page_shows() {
    let Some(file) = shared("data/emps/emps.csv") else { return };
    let folder = tempfile::tempdir().unwrap();
    let session = block("docs/real-machine.md", "$ cargo run --release -- diagnose ");
    let (typed, shown) = session.strip_prefix("$ ").unwrap().split_once("\n\n").unwrap();
    let named = "../shared/data/emps/emps.csv";
    assert!(typed.contains(named), "{typed}");
    let printed = paste(&typed.replace(named, &format!("'{}'", file.display())), folder.path());
    assert_eq!(printed, format!("{shown}\n"), "the page shows another answer");
    exists(folder.path(), "emps.html");
    exists(folder.path(), "figures/bode.svg");
}

/// Commands of the program that a page has, in a block or within a sentence.
fn typed(page: &str) -> Vec<String> {
    let page = text(page).replace(RUN, "servoscope ").replace("\\\n", " ");
    let parts = page.split("\n```").enumerate();
    let lines = parts.flat_map(|(place, part)| match place % 2 {
        0 => part.split('`').skip(1).step_by(2).collect::<Vec<_>>(),
        _ => part.lines().collect(),
    });
    let lines = lines.filter_map(|line| line.strip_prefix("servoscope "));
    // What a command does stands behind it.
    lines.map(|line| line.split("    ").next().unwrap().to_owned()).collect()
}

#[test]
fn every_benchmark_of_the_pages_is_one_that_the_program_takes() {
    let mut count = 0;
    for page in book() {
        let typed = typed(&page);
        let benchmarks = typed.iter().filter_map(|line| line.strip_prefix("benchmark "));
        for line in benchmarks.filter(|line| !line.contains("KIND,…")) {
            let line = line.replace("--effects ID", "--effects spring");
            let words = line.split_whitespace().filter(|word| !word.contains(['…', '[']));
            let words = words.filter(|word| *word != "--settings");
            // All of them are read before the settings are printed, and nothing is computed.
            let words: Vec<&str> = ["benchmark"].into_iter().chain(words).collect();
            let output = servoscope(&[&words[..], &["--settings"]].concat());
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(output.status.success(), "{page}: {line}\n{said}");
            count += 1;
        }
    }
    assert!(count > 20, "only {count} were found");
}

#[test]
fn every_command_of_the_pages_and_its_flags_are_those_of_the_program() {
    let mut count = 0;
    for page in book() {
        for line in typed(&page) {
            let words: Vec<&str> = line.split_whitespace().collect();
            // A command of commands has its flags one word later.
            let name = &words[..if ["keys", "config"].contains(&words[0]) { 2 } else { 1 }];
            let output = servoscope(&[name, &["--help"]].concat());
            assert!(output.status.success(), "{page}: {line}: there is no such command");
            let help = String::from_utf8(output.stdout).unwrap();
            let known: Vec<&str> = help.split_whitespace().collect();
            let flags = words.iter().map(|word| word.trim_matches(['[', ']', '…', ',']));
            for flag in flags.filter(|word| word.starts_with("--") && word.len() > 2) {
                assert!(known.contains(&flag), "{page}: {line}: there is no {flag}");
            }
            count += 1;
        }
    }
    assert!(count > 60, "only {count} were found");
}
