//! Every block of a page with something to type: which test runs it, or why none does.

use std::collections::BTreeSet;

use super::{pages, text};
use crate::process::repository;

/// Page, how a block begins, and the file and name of the test that runs it.
const RUN: [(&str, &str, &str, &str); 21] = [
    ("README.md", "cargo run --release -- simulate --noise-db", README, PASTED),
    ("README.md", "cargo run --release -- simulate --fs-plus", README, PASTED),
    ("README.md", "cargo run --release -- serve --demo", HERE, STARTS),
    ("README.md", "cargo test --locked", README, "the_tests_are_run_by_the_command_that_it_gives"),
    ("docs/command-line.md", "servoscope identify FILE…", HERE, FLAGS),
    ("docs/command-line.md", "servoscope completions bash", HERE, COMPLETIONS),
    ("docs/command-line.md", "servoscope man ", HERE, COMPLETIONS),
    (
        "docs/command-line.md",
        "mkdir -p runs",
        HERE,
        "the_folder_of_the_page_is_computed_as_one_batch",
    ),
    ("docs/dashboard.md", "cargo run --release -- serve --demo", HERE, STARTS),
    ("docs/http.md", "cargo run --release -- serve --data-dir", HERE, STARTS),
    ("docs/http.md", "server=", README, PASTED),
    (
        "docs/load.md",
        "servoscope serve --workers 0",
        HERE,
        "a_server_and_a_worker_of_the_page_on_load_compute_its_batch",
    ),
    (
        "docs/measuring.md",
        "cargo run --release -- plan ",
        HERE,
        "the_plan_of_the_page_is_printed_and_written_as_table_input_and_figure",
    ),
    ("docs/measuring.md", "cargo run --release -- inspect", README, PASTED),
    (
        "docs/notifications.md",
        "curl ",
        HERE,
        "the_webhook_of_the_page_is_registered_and_its_secret_shown",
    ),
    (
        "docs/notifications.md",
        "key=$(printf",
        "webhooks/page.rs",
        "the_shell_of_the_page_computes_a_signature",
    ),
    ("docs/notifications.md", "servoscope serve --webhook-allow", HERE, STARTS),
    ("docs/operating.md", "cargo run --release -- keys add", README, PASTED),
    (
        "docs/operating.md",
        "servoscope backup FILE",
        HERE,
        "a_folder_that_is_backed_up_as_on_the_page_has_the_same_keys_when_it_is_restored",
    ),
    ("docs/reading-an-answer.md", "cargo run --release -- simulate --fs-plus", README, PASTED),
    (
        "docs/real-machine.md",
        "$ cargo run --release -- diagnose ",
        HERE,
        "the_real_machine_has_the_answer_that_its_page_shows",
    ),
];

const HERE: &str = "book/commands.rs";
const README: &str = "readme.rs";
const PASTED: &str = "every_shell_block_works_as_pasted";
const STARTS: &str = "every_server_of_the_pages_starts";
const FLAGS: &str = "every_command_of_the_pages_and_its_flags_are_those_of_the_program";
const COMPLETIONS: &str = "completions_and_manual_pages_are_written_where_the_page_has_them";

/// Of benchmarks the arguments are tried:
/// `every_benchmark_of_the_pages_is_one_that_the_program_takes`.
const HOURS: &str = "it computes for hours";
const BUILDS: &str = "it compiles what is being tested";
const BENCH: &str = "it measures times, which a test beside others would change";
const DOCKER: &str = "it needs Docker";

/// Page, how a block begins, and why no test runs it.
const NOT_RUN: [(&str, &str, &str); 20] = [
    ("README.md", "cargo install", BUILDS),
    ("README.md", "docker build", DOCKER),
    ("docs/adding-an-effect.md", "cargo test -p", "an effect is to be written first"),
    ("docs/decisions.md", "servoscope benchmark --seed 31", HOURS),
    ("docs/decisions.md", "servoscope benchmark --seed 101", HOURS),
    ("docs/fuzzing.md", "fuzz/run.sh 3600", HOURS),
    ("docs/load.md", "cargo bench --bench load", BENCH),
    ("docs/load.md", "cargo bench --bench queue", BENCH),
    ("docs/load.md", "createdb load", BENCH),
    ("docs/operating.md", "docker build", DOCKER),
    ("docs/operating.md", "createdb servoscope", "it names somebody's database"),
    ("docs/operating.md", "cd deploy", DOCKER),
    ("docs/peers.md", "benches/peers/run.sh", "it downloads and builds other programs"),
    ("docs/performance.md", "cargo build --release", BUILDS),
    ("docs/performance.md", "benches/flame.sh", BENCH),
    ("docs/performance.md", "cargo run --release -p", BUILDS),
    ("docs/performance.md", "benches/instructions.sh", BENCH),
    (
        "docs/search-settings.md",
        "servoscope benchmark --settings",
        "its commands have gaps to fill",
    ),
    ("docs/search-settings.md", "servoscope benchmark --seed 24022", HOURS),
    ("docs/search-settings.md", "servoscope benchmark --seed 2411", HOURS),
];

/// How a line begins that is to be typed.
const TYPED: [&str; 9] =
    ["$ ", "servoscope ", "cargo ", "curl ", "docker ", "createdb ", "cd ", "benches/", "fuzz/"];

/// The pages of the book and the one before them.
pub fn book() -> Vec<String> {
    let mut book = pages("docs");
    book.push("README.md".to_owned());
    book
}

/// Blocks of a page, each as its kind and its lines.
fn blocks(page: &str) -> Vec<(String, String)> {
    let text = text(page);
    let inside = text.split("\n```").skip(1).step_by(2);
    let parts = inside.map(|block| block.split_once('\n').unwrap_or_else(|| panic!("{page}")));
    parts.map(|(kind, lines)| (kind.to_owned(), lines.to_owned())).collect()
}

/// The block of a page that begins like this.
pub fn block(page: &str, begins: &str) -> String {
    let listed = RUN.iter().any(|(of, begin, ..)| *of == page && *begin == begins);
    assert!(listed, "{page}: {begins} is not in the list of what is run");
    let found = blocks(page).into_iter().find(|(_, lines)| lines.starts_with(begins));
    found.unwrap_or_else(|| panic!("{page}: no block begins with {begins}")).1
}

#[test]
fn every_block_with_something_to_type_is_run_by_a_test_or_has_its_reason() {
    let run = RUN.iter().map(|(page, begins, ..)| (*page, *begins));
    let listed: Vec<_> =
        run.chain(NOT_RUN.iter().map(|(page, begins, _)| (*page, *begins))).collect();
    let mut unused: BTreeSet<_> = listed.iter().copied().collect();
    let mut missing = Vec::new();
    for page in book() {
        for (kind, lines) in blocks(&page) {
            let is_typed = |line: &str| TYPED.iter().any(|begin| line.starts_with(begin));
            if !["sh", "bash"].contains(&kind.as_str()) && !lines.lines().any(is_typed) {
                continue;
            }
            let fits = |(of, begins): &&(&str, &str)| *of == page && lines.starts_with(begins);
            match listed.iter().find(fits) {
                Some(entry) => drop(unused.remove(entry)),
                None => missing.push(format!("{page}: {}", lines.lines().next().unwrap())),
            }
        }
    }
    assert!(missing.is_empty(), "neither run nor given a reason: {missing:#?}");
    assert!(unused.is_empty(), "listed, but on no page: {unused:#?}");
}

#[test]
fn every_test_that_is_said_to_run_a_block_is_there() {
    for (page, begins, file, name) in RUN {
        let file = repository(&format!("tests/integration/{file}"));
        let tests = std::fs::read_to_string(&file).unwrap();
        let test = format!("fn {name}() {{");
        assert!(tests.contains(&test), "{page}: {begins}: {} has no {name}", file.display());
    }
}
