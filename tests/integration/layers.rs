//! Which layer may know which: the pictures in `src/lib.rs` and `crates/core/src/lib.rs`, enforced.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::process::repository;

/// Where the sources of each crate are, and by which names code says that it means a module of it.
const CRATES: &[&str] = &["src", "crates/core/src", "crates/bench/src"];
const PREFIXES: &[&str] = &["crate::", "servoscope_core::", "servoscope_bench::"];

/// Plain data and the way a computation reports: everybody may know them.
const COMMON: &[&str] = &["answers", "observer"];

/// Each layer, and what it may name beside [`COMMON`]. What is below a layer in
/// the picture, at any depth, is listed only where it really needs it.
const ALLOWED: &[(&str, &[&str])] = &[
    ("answers", &[]),
    ("observer", &[]),
    ("singular_values", &[]),
    ("measurement", &[]),
    ("plant", &["measurement"]),
    ("effects", &["plant", "measurement"]),
    ("simulate", &["effects", "plant", "measurement", "singular_values"]),
    ("identify", &["simulate", "effects", "plant", "measurement", "singular_values"]),
    ("diagnose", &["identify", "simulate", "effects", "plant", "measurement", "singular_values"]),
    // They know results, never solvers; the report also knows what effects are called.
    ("store", &[]),
    ("report", &["effects"]),
    ("notify", &[]),
    ("service", &["store", "report", "notify", "diagnose", "identify", "measurement", "methods"]),
    // They know what is kept and what is done with it, never how it is computed.
    ("worker", &["service", "store"]),
    ("http", &["service", "store", "web"]),
    // Files, and the look of the report.
    ("web", &["report"]),
    // Says whether a broker can be used.
    ("config", &["notify"]),
    // Puts the program together.
    (
        "cli",
        &[
            "config",
            "http",
            "worker",
            "service",
            "store",
            "report",
            "notify",
            "diagnose",
            "identify",
            "simulate",
            "effects",
            "plant",
            "measurement",
            "machines",
            "methods",
            "naming",
            "reproduction",
        ],
    ),
    // Drawn machines and a simulator of their own: nothing that fits.
    ("machines", &["plant", "measurement"]),
    // Judges the others by the public interface.
    ("naming", &["machines", "diagnose", "identify", "effects", "plant", "measurement"]),
    // The same of plans.
    (
        "planning",
        &["machines", "naming", "diagnose", "identify", "effects", "plant", "measurement"],
    ),
    // The experiments of the paper.
    ("reproduction", &["machines", "methods", "identify", "plant", "measurement"]),
    // Work to be timed.
    (
        "workloads",
        &["machines", "naming", "identify", "simulate", "effects", "plant", "measurement"],
    ),
    // Searches that only comparisons need.
    ("methods", &["identify"]),
];

/// The numeric core: data, seed and observer in, values out.
const PURE: &[&str] = &[
    "answers",
    "observer",
    "singular_values",
    "measurement",
    "plant",
    "effects",
    "simulate",
    "identify",
    "diagnose",
];

/// What has no place in the numeric core: runtimes, logs, clocks, the outside.
const IMPURE: &[&str] = &[
    "tokio::",
    "axum::",
    "sqlx::",
    "tracing::",
    "clap::",
    "indicatif::",
    "tower_http::",
    "std::fs",
    "std::net",
    "std::env",
    "std::process",
    "Instant::now",
    "SystemTime",
    "Timestamp::now",
    "println!",
];

/// Code of one file without comments and without its unit tests.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Files of a layer: `layer.rs` and everything in `layer/`, tests aside.
fn files(layer: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = Vec::new();
    for sources in CRATES {
        let single = repository(sources).join(format!("{layer}.rs"));
        found.extend(single.is_file().then_some(single));
        folders.push(repository(sources).join(layer));
    }
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            let test = ["tests.rs", "testing.rs", "contract.rs", "fixtures.rs"];
            if path.is_dir() {
                folders.push(path);
            } else if !test.contains(&path.file_name().unwrap().to_str().unwrap()) {
                found.push(path);
            }
        }
    }
    assert!(!found.is_empty(), "no file of {layer}");
    found
}

/// Every `name` in `crate::name` and `crate::{name::…, name}`, and in the same of a named crate.
fn named_layers(code: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for after in PREFIXES.iter().flat_map(|prefix| code.split(prefix).skip(1)) {
        match after.strip_prefix('{') {
            Some(group) => names.extend(group_heads(group)),
            None => names.extend([head(after)]),
        }
    }
    names
}

fn head(path: &str) -> String {
    path.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// First segment of each member of a brace group, up to the brace that closes it.
fn group_heads(group: &str) -> Vec<String> {
    let mut heads = Vec::new();
    let mut depth = 0;
    let mut member = String::new();
    for character in group.chars() {
        match character {
            ',' | '}' if depth == 0 => {
                heads.push(head(&std::mem::take(&mut member)));
                if character == '}' {
                    break;
                }
                continue;
            }
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        member.push(character);
    }
    heads.retain(|head| !head.is_empty());
    heads
}

#[test]
fn every_layer_knows_only_those_below_it() {
    let mut wrong = Vec::new();
    for (layer, allowed) in ALLOWED {
        for file in files(layer) {
            for name in named_layers(&code(&file)) {
                let is_layer = ALLOWED.iter().any(|(other, _)| *other == name);
                let known = [COMMON, allowed].iter().any(|list| list.contains(&name.as_str()));
                if is_layer && !known && name != *layer {
                    wrong.push(format!("{} names crate::{name}", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_numeric_core_has_no_runtime_clock_log_or_file() {
    let mut wrong = Vec::new();
    for layer in PURE {
        for file in files(layer) {
            let code = code(&file);
            let found = IMPURE.iter().filter(|word| code.contains(**word));
            wrong.extend(found.map(|word| format!("{} has {word}", file.display())));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_table_lists_every_module_of_the_crate_and_has_no_cycle() {
    let listed: BTreeMap<&str, &[&str]> = ALLOWED.iter().copied().collect();
    let libraries: Vec<String> =
        CRATES.iter().map(|sources| code(&repository(sources).join("lib.rs"))).collect();
    for line in libraries.iter().flat_map(|library| library.lines()) {
        if let Some(module) = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';'))
        {
            assert!(listed.contains_key(module), "`{module}` is missing from the table");
        }
    }
    // Layers are removed once all they know is gone; a cycle would remain.
    let mut left: BTreeSet<&str> = listed.keys().copied().collect();
    while let Some(bottom) =
        left.iter().copied().find(|layer| listed[layer].iter().all(|below| !left.contains(below)))
    {
        left.remove(bottom);
    }
    assert!(left.is_empty(), "these know each other: {left:?}");
}

#[test]
fn names_are_found_in_paths_and_groups() {
    let code = "use crate::plant::Plant;\nuse crate::{\n  store::{self, Page},\n  http, };\n\
                fn f() { crate::cli::main() }\nuse servoscope_core::diagnose::diagnose;";
    let names = named_layers(code);
    assert_eq!(
        names.iter().map(String::as_str).collect::<Vec<_>>(),
        ["cli", "diagnose", "http", "plant", "store"]
    );
}
