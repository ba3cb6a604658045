//! Certificates for TLS, made by `openssl`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shared_files::skipped;

/// A certificate and its key, as files.
pub struct Certificate {
    pub file: PathBuf,
    pub key: PathBuf,
}

/// An authority of its own, that nobody trusts who is not told to.
pub struct Authority(Certificate);

impl Authority {
    /// Keeps its files in this folder; `None` where there is no openssl.
    pub fn new(folder: &Path, name: &str) -> Option<Self> {
        if Command::new("openssl").arg("version").output().is_err() {
            // A real broker speaks TLS only with certificates, so one needs the other.
            let required = std::env::var_os("SERVO_REQUIRE_MOSQUITTO").is_some();
            assert!(!required, "openssl is absent");
            skipped("openssl is absent");
            return None;
        }
        Some(Self(made(folder, name, &["basicConstraints=critical,CA:TRUE"], None)))
    }

    /// What a program is given that shall trust it.
    pub fn file(&self) -> &Path {
        &self.0.file
    }

    /// A certificate for these names, as in `DNS:localhost,IP:127.0.0.1`.
    pub fn certify(&self, names: &str) -> Certificate {
        let folder = self.0.file.parent().unwrap();
        let names = format!("subjectAltName={names}");
        made(folder, "server", &["basicConstraints=critical,CA:FALSE", &names], Some(&self.0))
    }
}

fn made(
    folder: &Path,
    name: &str,
    extensions: &[&str],
    authority: Option<&Certificate>,
) -> Certificate {
    let [file, key] = ["pem", "key"].map(|end| folder.join(format!("{name}.{end}")));
    let mut command = Command::new("openssl");
    command.args(["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]);
    command.args(["-nodes", "-days", "2", "-subj", &format!("/CN={name}")]);
    for extension in extensions {
        command.args(["-addext", extension]);
    }
    if let Some(Certificate { file, key }) = authority {
        command.arg("-CA").arg(file).arg("-CAkey").arg(key);
    }
    let output = command.arg("-keyout").arg(&key).arg("-out").arg(&file).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Certificate { file, key }
}
