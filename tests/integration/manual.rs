//! Completion scripts and manual pages.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::process::{Command, Stdio};

use crate::process::servoscope;

/// What the program prints, if it does.
fn printed(arguments: &[&str]) -> String {
    let output = servoscope(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Names of the commands that the help of another lists.
fn commands(of: &[&str]) -> Vec<String> {
    let help = printed(&[of, &["--help"]].concat());
    let list = help.split("\nCommands:\n").nth(1).unwrap_or_default();
    let list = list.lines().take_while(|line| !line.is_empty());
    let first = list.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = first.map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

#[test]
fn the_script_for_bash_is_one_that_bash_accepts_and_completes_values() {
    let script = printed(&["completions", "bash"]);
    for word in ["diagnose", "--actuator-order", "two-magnitude", "peak-to-peak", "read:all"] {
        assert!(script.contains(word), "{word}");
    }
    let mut bash = Command::new("bash").arg("-n").stdin(Stdio::piped()).spawn().unwrap();
    bash.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    assert!(bash.wait().unwrap().success());
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        assert!(printed(&["completions", shell]).contains("diagnose"), "{shell}");
    }
}

#[test]
fn every_command_has_a_manual_page_and_the_first_page_names_them_all() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    printed(&["man", "--output", pages.to_str().unwrap()]);
    let first = printed(&["man"]);
    let mut expected = BTreeSet::from(["servoscope.1".to_owned()]);
    for name in commands(&[]) {
        assert!(first.contains(&format!("servoscope\\-{name}(1)")), "{name} is not in\n{first}");
        for inner in commands(&[&name]) {
            expected.insert(format!("servoscope-{name}-{inner}.1"));
        }
        expected.insert(format!("servoscope-{name}.1"));
    }
    assert!(expected.contains("servoscope-keys-add.1"), "{expected:?}");
    let written = std::fs::read_dir(&pages).unwrap();
    let written = written.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(written.collect::<BTreeSet<_>>(), expected);
    let diagnose = std::fs::read_to_string(pages.join("servoscope-diagnose.1")).unwrap();
    assert!(diagnose.contains("actuator\\-order"), "{diagnose}");
}
