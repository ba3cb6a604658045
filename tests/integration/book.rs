//! The pages under `docs`: each has its place in the table of contents, every link leads
//! somewhere, and their commands are run.

mod commands;
mod listed;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::process::{repository, servoscope};

/// Pages that a reader comes to by themselves: the contents, and what leads to them.
const BESIDE: [&str; 2] = ["docs/SUMMARY.md", "docs/README.md"];

fn text(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Every page under a folder of the repository.
fn pages(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(repository(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
    let name = |path: &PathBuf| format!("{folder}/{}", path.file_name().unwrap().to_str().unwrap());
    let own = files.iter().map(name).filter(|name| name.ends_with(".md"));
    own.chain(folders.iter().flat_map(|path| pages(&name(path)))).collect()
}

/// Targets of the links of a page, outside of blocks of code.
fn links(text: &str) -> Vec<&str> {
    let prose = text.split("\n```").step_by(2);
    let rests = prose.flat_map(|prose| prose.split("](").skip(1));
    let targets = rests.map(|rest| rest.split([')', ' ']).next().unwrap());
    targets.filter(|target| !target.contains("://")).collect()
}

/// A path without `..`.
fn plain(path: &Path) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.iter().map(|part| part.to_str().unwrap()) {
        match part {
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// What a heading is linked to by.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().replace(' ', "-")
}

fn anchors(text: &str) -> BTreeSet<String> {
    text.lines().filter(|line| line.starts_with('#')).map(anchor).collect()
}

#[test]
fn every_page_is_in_the_contents_once() {
    let contents = text("docs/SUMMARY.md");
    let mut listed: Vec<String> =
        links(&contents).into_iter().map(|link| plain(&Path::new("docs").join(link))).collect();
    listed.retain(|page| page.starts_with("docs/"));
    let mut there = pages("docs");
    there.retain(|page| !BESIDE.contains(&page.as_str()));
    listed.sort();
    there.sort();
    assert_eq!(listed, there);
}

#[test]
fn every_link_leads_to_a_file_and_a_heading_that_is_there() {
    let mut wrong = Vec::new();
    let all = ["README.md".to_owned(), "clients/README.md".to_owned()];
    for page in all.into_iter().chain(pages("docs")) {
        let own = text(&page);
        for link in links(&own) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let folder = Path::new(&page).parent().unwrap();
            let path = if file.is_empty() { page.clone() } else { plain(&folder.join(file)) };
            if !repository(&path).exists() {
                wrong.push(format!("{page}: {link}: there is no {path}"));
            } else if !heading.is_empty() && !anchors(&text(&path)).contains(heading) {
                wrong.push(format!("{page}: {link}: {path} has no such heading"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_pages_of_the_effects_are_those_that_the_program_writes() {
    let folder = tempfile::tempdir().unwrap();
    let output = servoscope(&["effects", "--output", folder.path().to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<BTreeSet<_>>()
    };
    let kept = repository("docs/effects");
    assert_eq!(names(&kept), names(folder.path()));
    for name in names(&kept) {
        let [kept, written] = [kept.as_path(), folder.path()]
            .map(|folder| std::fs::read_to_string(folder.join(&name)).unwrap());
        assert!(kept == written, "{name} is not what `servoscope effects --output` writes");
    }
}
