//! Everything that the Dockerfile names, held against the repository.

use std::process::Command;

use crate::process::{Server, repository, servoscope};

fn text(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Instructions of the Dockerfile, as name and arguments, continued lines joined.
fn instructions() -> Vec<(String, String)> {
    let lines: Vec<String> = text("Dockerfile")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.strip_suffix('\\').unwrap_or(&format!("{line}\n")).to_owned())
        .collect();
    let joined = lines.concat();
    let parts = joined.lines().filter_map(|line| line.trim().split_once(' '));
    parts.map(|(name, arguments)| (name.to_owned(), arguments.trim().to_owned())).collect()
}

/// The arguments of every instruction of that name.
fn all(name: &str) -> Vec<String> {
    let named = instructions().into_iter().filter(|(found, _)| found == name);
    named.map(|(_, arguments)| arguments).collect()
}

fn only(name: &str) -> String {
    let [arguments] = all(name).try_into().unwrap_or_else(|found| panic!("{name}: {found:?}"));
    arguments
}

/// A command in its JSON form, from the bracket on.
fn words(arguments: &str) -> Vec<String> {
    serde_json::from_str(&arguments[arguments.find('[').unwrap()..]).unwrap()
}

/// What is copied from the repository.
fn copied() -> Vec<String> {
    let from_here = all("COPY").into_iter().filter(|copy| !copy.starts_with("--from"));
    let sources = from_here.flat_map(|copy| {
        let mut words: Vec<String> = copy.split_whitespace().map(str::to_owned).collect();
        words.pop();
        words
    });
    sources.collect()
}

/// Values of `key = "…"` in the manifest.
fn manifest(key: &str) -> Vec<String> {
    let manifest = text("Cargo.toml");
    let pairs = manifest.lines().filter_map(|line| line.split_once('='));
    let values = pairs.filter(|(found, _)| found.trim() == key);
    values.map(|(_, value)| value.trim().trim_matches('"').to_owned()).collect()
}

#[test]
fn it_copies_what_is_there_and_not_ignored() {
    let ignored = text(".dockerignore");
    let copied = copied();
    assert!(!copied.is_empty());
    for path in copied {
        assert!(repository(&path).exists(), "{path} is not there");
        assert!(!ignored.lines().any(|line| line.trim() == path), "{path} is ignored");
    }
}

#[test]
fn it_has_every_file_that_the_manifest_names() {
    let copied = copied();
    let build = all("RUN").into_iter().find(|run| run.contains("cargo build")).unwrap();
    let made: Vec<&str> = build.split_whitespace().collect();
    let mut named = manifest("path");
    // A benchmark's path follows from its name where it is not given.
    let manifest = text("Cargo.toml");
    let benches = manifest.split("[[bench]]").skip(1).map(|rest| rest.split("\n\n").next());
    for section in benches.flatten().filter(|section| !section.contains("path = ")) {
        let name = section.lines().find_map(|line| line.strip_prefix("name = ")).unwrap();
        named.push(format!("benches/{}.rs", name.trim_matches('"')));
    }
    for path in named {
        let inside = |folder: &String| path == *folder || path.starts_with(&format!("{folder}/"));
        let there = copied.iter().any(inside) || made.contains(&path.as_str());
        assert!(there, "cargo needs {path}, which is neither copied nor made");
    }
    // Files that the sources take in at compile time.
    assert!(copied.contains(&"migrations".to_owned()) && repository("migrations").is_dir());
}

#[test]
fn it_builds_the_program_with_the_compiler_that_the_manifest_asks_for() {
    let version = manifest("rust-version").remove(0);
    let images = all("FROM");
    assert!(images[0].starts_with(&format!("rust:{version}-")), "{images:?}");
    let program = manifest("default-run").remove(0);
    let build = all("RUN").into_iter().find(|run| run.contains("cargo build")).unwrap();
    assert!(build.ends_with(&format!("cargo build --release --locked --bin {program}")), "{build}");
    let built = format!("{}/target/release/{program}", only("WORKDIR"));
    let copy = all("COPY").into_iter().find(|copy| copy.starts_with("--from=build")).unwrap();
    let [_, from, to] = copy.split_whitespace().collect::<Vec<_>>()[..] else { panic!("{copy}") };
    assert_eq!((from, to), (built.as_str(), format!("/usr/local/bin/{program}").as_str()));
    assert_eq!(words(&only("ENTRYPOINT")), [program]);
}

#[test]
fn the_program_takes_the_arguments_it_is_started_with() {
    let command = words(&only("CMD"));
    let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
    // Everything before it is parsed first.
    arguments.push("--help");
    let output = servoscope(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let unknown = servoscope(&[&arguments[..1], &["--divine"], &arguments[1..]].concat());
    assert!(!unknown.status.success(), "a wrong argument would not be seen");
}

#[test]
fn ports_folders_and_users_are_the_same_throughout() {
    let command = words(&only("CMD"));
    let after = |flag: &str| {
        let position = command.iter().position(|word| word == flag).unwrap();
        command[position + 1].clone()
    };
    let port = only("EXPOSE");
    assert_eq!(after("--listen"), format!("0.0.0.0:{port}"));
    assert!(words(&only("HEALTHCHECK"))[2].contains(&format!("/127.0.0.1/{port} ")));
    let folder = only("VOLUME");
    assert_eq!(after("--data-dir"), folder);
    let user = only("USER");
    let made = all("RUN").into_iter().find(|run| run.contains("useradd")).unwrap();
    assert!(made.contains(&format!(" {user} ")), "{made}");
    assert!(made.ends_with(&format!("--owner {user} --group {user} {folder}")), "{made}");
}

#[test]
fn the_health_check_passes_while_the_server_is_ready_and_not_after() {
    let check = words(&only("HEALTHCHECK"));
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let (_, port) = server.address().rsplit_once(':').unwrap();
    let here = check[2].replace(&format!("/{} ", only("EXPOSE")), &format!("/{port} "));
    assert_ne!(here, check[2]);
    let healthy = || {
        let output = Command::new(&check[0]).args([&check[1], &here]).output();
        output.expect("bash is there, as in the image").status.success()
    };
    assert!(healthy());
    assert_eq!(server.terminate(), Some(0));
    assert!(!healthy());
}
