//! What the README and the pages behind it tell a reader to type.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use crate::process::{Server, repository, servoscope};
use crate::shared_files::skipped;

/// How the README runs the program.
const RUN: &str = "cargo run --release -- ";

/// The README and the pages that it leads to, in the order in which they are read.
const PAGES: [&str; 15] = [
    "README.md",
    "docs/real-machine.md",
    "docs/measuring.md",
    "docs/reading-an-answer.md",
    "docs/files.md",
    "docs/dashboard.md",
    "docs/http.md",
    "docs/operating.md",
    "docs/notifications.md",
    "docs/command-line.md",
    "docs/effects.md",
    "docs/how-it-works.md",
    "docs/decisions.md",
    "docs/how-good-it-is.md",
    "docs/building.md",
];

/// The most bytes of the README: one page.
const MOST_BYTES: usize = 8_000;

fn page(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap()
}

/// All pages as one text.
fn readme() -> String {
    PAGES.map(page).concat()
}

/// Blocks of a kind, in order.
fn blocks<'a>(text: &'a str, kind: &str) -> Vec<&'a str> {
    let opening = format!("\n```{kind}\n");
    let opened: Vec<&str> = text.split(opening.as_str()).skip(1).collect();
    opened.into_iter().map(|rest| rest.split("\n```").next().unwrap()).collect()
}

/// Runs a block as it stands, in `folder`; `cargo run` runs the program that
/// these tests were built with, and the server is `server`.
fn paste(block: &str, folder: &Path, server: Option<&Server>) -> String {
    let program = format!("{} ", env!("CARGO_BIN_EXE_servoscope"));
    let mut script = block.replace(RUN, &program);
    if let Some(server) = server {
        script = script.replace("http://127.0.0.1:8080", server.address());
    }
    let output = Command::new("sh").args(["-eu", "-c", &script]).current_dir(folder).output();
    let output = output.expect("there is a shell");
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{block}\n{out}\n{err}");
    out
}

#[test]
fn every_shell_block_works_as_pasted() {
    let text = readme();
    let blocks = blocks(&text, "sh");
    let directory = tempfile::tempdir().unwrap();
    let main_job = blocks.iter().find(|block| block.contains("simulate")).unwrap();
    let report = paste(main_job, directory.path(), None);
    let reports = self::blocks(&text, "text");
    let shown = |verdict: &str| {
        let shown = reports.iter().find(|block| block.starts_with(verdict));
        format!("{}\n", shown.unwrap_or_else(|| panic!("no report is {verdict}")))
    };
    assert_eq!(report, shown("ADEQUATE: The model"), "the README shows another report");
    let diagnosis = blocks.iter().find(|block| block.contains("diagnose")).unwrap();
    let report = paste(diagnosis, directory.path(), None);
    assert_eq!(report, shown("EXPLAINED"), "the README shows another report");
    let inspection = blocks.iter().find(|block| block.contains("inspect")).unwrap();
    let report = paste(inspection, directory.path(), None);
    let shown = reports.iter().find(|block| block.starts_with("What was read")).unwrap();
    // Shortened: what stands between the dots is all there, in this order.
    let mut rest = report.as_str();
    for part in shown.split('…') {
        let found = rest.find(part.trim_start_matches('\n'));
        let from = found.unwrap_or_else(|| panic!("{part}\nis not in what is left of\n{report}"));
        rest = &rest[from..];
    }
    let validation = blocks.iter().find(|block| block.contains("validate")).unwrap();
    let report = paste(validation, directory.path(), None);
    assert!(report.starts_with("CONFIRMED: the causes help on another"), "{report}");
    let keys = blocks.iter().find(|block| block.contains("keys add")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let printed = paste(keys, folder.path(), None);
    assert_eq!(printed.matches("sk_servoscope_").count(), 2, "{printed}");
    assert!(printed.contains("upload,run,read  server  rig 7"), "{printed}");
    if Command::new("curl").arg("--version").output().is_err() {
        skipped("curl is absent");
        return;
    }
    let server = Server::start(&directory.path().join("store"), &[]);
    let requests = blocks.iter().find(|block| block.contains("curl")).unwrap();
    let answers = paste(requests, directory.path(), Some(&server));
    for part in ["\"status\":\"succeeded\"", "\"transfer_function\":", "stage,cycle,evaluations"] {
        assert!(answers.contains(part), "{part} is missing in\n{answers}");
    }
}

#[test]
fn every_flag_and_subcommand_is_one_of_the_program() {
    let text = readme();
    let typed = blocks(&text, "sh").into_iter().flat_map(|block| block.split(RUN).skip(1));
    let listed = blocks(&text, "text").into_iter().filter(|block| block.starts_with("servoscope "));
    let listed =
        listed.flat_map(|block| block.lines().filter_map(|l| l.strip_prefix("servoscope ")));
    let commands = typed.chain(listed).map(|line| line.split_whitespace().collect::<Vec<_>>());
    let mut count = 0;
    for words in commands {
        // A command of commands has its flags one word later.
        let name = &words[..if ["keys", "config"].contains(&words[0]) { 2 } else { 1 }];
        let output = servoscope(&[name, &["--help"]].concat());
        assert!(output.status.success(), "`servoscope {}` is not a command", name.join(" "));
        let help = String::from_utf8(output.stdout).unwrap();
        let known: Vec<&str> = help.split_whitespace().collect();
        let flags = words.iter().map(|word| word.trim_matches(['[', ']', '…']));
        for flag in flags.filter(|word| word.starts_with("--") && word.len() > 2) {
            assert!(known.contains(&flag), "`{flag}` of `{}` is not in\n{help}", words.join(" "));
        }
        count += 1;
    }
    assert!(count > 4, "the README shows only {count} commands");
}

#[test]
fn every_setting_of_the_server_has_its_row_and_no_row_has_another() {
    let text = readme();
    let table = text.split("\n| setting | meaning | default |\n").nth(1).unwrap();
    let rows = table.lines().skip(1).take_while(|line| line.starts_with("| "));
    let cells = rows.map(|row| row.split('|').nth(1).unwrap().trim());
    let listed: BTreeSet<&str> =
        cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`')).collect();
    let entries = servoscope::config::Settings::default().entries();
    assert_eq!(listed, entries.into_iter().map(|(name, _)| name).collect());
}

#[test]
fn every_file_it_links_to_is_there() {
    for path in PAGES {
        let text = page(path);
        let folder = Path::new(path).parent().unwrap();
        let targets = text.split("](").skip(1).map(|rest| rest.split(')').next().unwrap());
        for target in targets.filter(|target| !target.starts_with(['#', 'h'])) {
            let file = folder.join(target.split('#').next().unwrap());
            assert!(repository(file.to_str().unwrap()).exists(), "{target} of {path}");
        }
    }
}

#[test]
fn the_readme_is_one_page() {
    let bytes = page("README.md").len();
    assert!(bytes <= MOST_BYTES, "{bytes} bytes");
}

#[test]
fn the_tests_are_run_by_the_command_that_it_gives() {
    let text = page("README.md");
    let ci = std::fs::read_to_string(repository(".ci/run")).unwrap();
    let command = "cargo test --locked";
    assert!(blocks(&text, "sh").contains(&command));
    assert!(ci.lines().any(|line| line.trim().ends_with(command)), "{ci}");
}
