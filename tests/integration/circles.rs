//! Files of the numeric core that know each other in a circle: of more than three, none can be
//! understood or changed without the others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree, Visibility};

use crate::process::repository;

const SOURCES: &str = "crates/core/src";

/// Most files that may know each other.
const MOST: usize = 3;

/// Every module that is a file, by its path, and its text; tests aside.
fn modules(folder: &Path, path: &[String], found: &mut BTreeMap<Vec<String>, String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let stem = file.file_stem().unwrap().to_str().unwrap().to_owned();
        if file.is_dir() {
            modules(&file, &[path, &[stem]].concat(), found);
        } else if !["tests", "fixtures"].contains(&stem.as_str()) {
            let own = match stem.as_str() {
                "mod" | "lib" => path.to_vec(),
                _ => [path, &[stem]].concat(),
            };
            found.insert(own, std::fs::read_to_string(&file).unwrap());
        }
    }
}

/// The paths that a file names, outside its unit tests and its `pub use` lines.
#[derive(Default)]
struct Named(Vec<Vec<String>>);

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("cfg"))
}

impl Named {
    fn collect(&mut self, tree: &UseTree, before: &[String]) {
        match tree {
            UseTree::Path(part) => {
                self.collect(&part.tree, &[before, &[part.ident.to_string()]].concat());
            }
            UseTree::Name(name) => self.0.push([before, &[name.ident.to_string()]].concat()),
            UseTree::Rename(name) => self.0.push([before, &[name.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.0.push(before.to_vec()),
            UseTree::Group(group) => {
                group.items.iter().for_each(|item| self.collect(item, before));
            }
        }
    }
}

impl<'f> Visit<'f> for Named {
    fn visit_item_mod(&mut self, module: &'f ItemMod) {
        if !is_test(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_use(&mut self, item: &'f ItemUse) {
        if matches!(item.vis, Visibility::Inherited) && !is_test(&item.attrs) {
            self.collect(&item.tree, &[]);
        }
    }

    // `pub(in super::super)` is no knowledge.
    fn visit_visibility(&mut self, _: &'f Visibility) {}

    fn visit_path(&mut self, path: &'f syn::Path) {
        if path.segments.len() > 1 {
            self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}

/// The module that a path leads to, as seen from `own`.
fn resolved<T>(
    own: &[String],
    named: &[String],
    modules: &BTreeMap<Vec<String>, T>,
) -> Option<Vec<String>> {
    let (mut at, mut rest) = (own.to_vec(), named);
    match named[0].as_str() {
        "crate" => (at, rest) = (Vec::new(), &named[1..]),
        "self" | "super" => {
            while let Some(("self" | "super", after)) =
                rest.split_first().map(|(first, after)| (first.as_str(), after))
            {
                if rest[0] == "super" {
                    at.pop();
                }
                rest = after;
            }
        }
        first if modules.contains_key(&[own, &[first.to_owned()]].concat()) => {}
        _ => return None,
    }
    at.extend(rest.iter().cloned());
    while !at.is_empty() && !modules.contains_key(&at) {
        at.pop();
    }
    Some(at)
}

type Knows = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

fn graph() -> Knows {
    let mut texts = BTreeMap::new();
    modules(&repository(SOURCES), &[], &mut texts);
    let known = |(own, text): (&Vec<String>, &String)| {
        let mut named = Named::default();
        named.visit_file(&syn::parse_file(text).unwrap());
        let others = named.0.iter().filter_map(|path| resolved(own, path, &texts));
        (own.clone(), others.filter(|other| other != own).collect())
    };
    texts.iter().map(known).collect()
}

/// What can be reached from a module, itself only by a circle.
fn reached(from: &Vec<String>, knows: &Knows) -> BTreeSet<Vec<String>> {
    let (mut found, mut left) = (BTreeSet::new(), vec![from]);
    while let Some(at) = left.pop() {
        left.extend(knows[at].iter().filter(|next| found.insert((*next).clone())));
    }
    found
}

/// Files that reach each other, by the first of them.
fn circles(knows: &Knows) -> BTreeSet<Vec<String>> {
    let reached: BTreeMap<_, _> = knows.keys().map(|from| (from, reached(from, knows))).collect();
    let circle = |from: &Vec<String>| -> Vec<String> {
        let back = reached[from].iter().filter(|other| reached[other].contains(from));
        back.map(|module| module.join("::")).collect()
    };
    knows.keys().map(circle).filter(|circle| circle.len() > 1).collect()
}

#[test]
fn no_more_than_three_files_of_the_core_know_each_other_in_a_circle() {
    let knows = graph();
    assert!(knows.len() > 100, "{} modules", knows.len());
    let all = circles(&knows);
    let large: Vec<_> = all.iter().filter(|circle| circle.len() > MOST).collect();
    assert!(large.is_empty(), "{large:#?}");
}

#[test]
fn a_circle_is_found() {
    let module = |name: &str| vec![name.to_owned()];
    let knows = |from: &str, to: &[&str]| (module(from), to.iter().map(|to| module(to)).collect());
    let knows = BTreeMap::from([
        knows("a", &["b"]),
        knows("b", &["c"]),
        knows("c", &["a", "d"]),
        knows("d", &[]),
    ]);
    let found: Vec<Vec<String>> = circles(&knows).into_iter().collect();
    assert_eq!(found, [["a", "b", "c"].map(str::to_owned).to_vec()]);
}
