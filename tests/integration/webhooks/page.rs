//! The scripts of the page on messages, run on an example: they verify its signature.

use std::io::Write;
use std::process::{Command, Stdio};

use crate::process::repository;
use crate::shared_files::skipped;

/// A block of the page on messages.
fn block(kind: &str) -> String {
    let page = std::fs::read_to_string(repository("docs/notifications.md")).unwrap();
    let opening = format!("\n```{kind}\n");
    let rest = page.split(opening.as_str()).nth(1).unwrap_or_else(|| panic!("no {kind}"));
    rest.split("\n```").next().unwrap().to_owned()
}

/// What a script prints that is fed to a program.
fn printed(program: &str, arguments: &[&str], script: &str) -> Option<String> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
    let Ok(mut child) = command.spawn() else {
        skipped(&format!("{program} is absent"));
        return None;
    };
    child.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{script}");
    Some(String::from_utf8(output.stdout).unwrap())
}

/// Id, timestamp, body and signature of the example of Standard Webhooks.
const EXAMPLE: [&str; 4] = [
    "msg_p5jXN8AQM9LWM0D4loKWxJek",
    "1614265330",
    r#"{"test": 2432232314}"#,
    "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=",
];

#[test]
fn the_python_of_the_page_verifies_a_signature() {
    let [id, timestamp, body, signature] = EXAMPLE;
    let script = format!(
        "{}\n\nsecret = 'whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw'\n\
         good = {{'webhook-id': '{id}', 'webhook-timestamp': '{timestamp}', \
         'webhook-signature': 'v1,no {signature}'}}\n\
         print(verified(secret, good, b'{body}', now={timestamp}))\n\
         print(verified(secret, good, b'{{}}', now={timestamp}))\n\
         print(verified(secret, good, b'{body}'))\n",
        block("python")
    );
    let Some(printed) = printed("python3", &["-"], &script) else { return };
    assert_eq!(printed, "True\nFalse\nFalse\n", "good, another body, too old");
}

#[test]
fn the_shell_of_the_page_computes_a_signature() {
    let [id, timestamp, body, signature] = EXAMPLE;
    if Command::new("openssl").arg("version").output().is_err() {
        skipped("openssl is absent");
        return;
    }
    let script = format!(
        "secret=whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw id={id} timestamp={timestamp} body='{body}'\n{}",
        block("bash")
    );
    let Some(printed) = printed("bash", &["-eu"], &script) else { return };
    assert_eq!(printed.trim(), signature);
}
