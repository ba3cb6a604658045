//! The server behind the proxy of the operator's page.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::time::Duration;

use crate::process::{Server, repository, simulated};
use crate::shared_files::skipped;

/// A proxy, ended when it is dropped.
struct Proxy(Child);

impl Drop for Proxy {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn is_there(program: &str) -> bool {
    Command::new(program).arg("-v").output().is_ok()
}

/// The page's own file with these addresses and the files of this folder, run by the proxy.
fn start(folder: &Path, port: u16, server: &Server) -> Proxy {
    let own = std::fs::read_to_string(repository("docs/proxy/nginx.conf")).unwrap();
    let site = own
        .replace("listen 443 ssl", &format!("listen 127.0.0.1:{port} ssl"))
        .replace("http://127.0.0.1:8080", server.address())
        .replace("/etc/ssl", folder.to_str().unwrap());
    let folders = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"]
        .map(|name| format!("{name}_temp_path {}/{name};\n", folder.display()))
        .concat();
    let whole = format!(
        "daemon off;\nmaster_process off;\npid {0}/pid;\nerror_log {0}/error.log;\nevents {{}}\n\
         http {{\naccess_log off;\n{folders}\n{site}}}\n",
        folder.display()
    );
    std::fs::write(folder.join("nginx.conf"), whole).unwrap();
    let conf = folder.join("nginx.conf");
    let mut command = Command::new("nginx");
    command.arg("-p").arg(folder).arg("-e").arg(folder.join("error.log")).arg("-c").arg(conf);
    Proxy(command.spawn().unwrap())
}

#[test]
fn the_proxy_of_the_page_answers_over_tls_for_its_name_alone() {
    if !["nginx", "openssl", "curl"].into_iter().all(is_there) {
        skipped("nginx, openssl or curl is absent");
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let [certificate, key] = ["pem", "key"].map(|end| folder.join(format!("bench.example.{end}")));
    let made = Command::new("openssl")
        .args(["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"])
        .args(["-subj", "/CN=bench.example", "-addext", "subjectAltName=DNS:bench.example"])
        .arg("-keyout")
        .arg(&key)
        .arg("-out")
        .arg(&certificate)
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let server = Server::start(&folder.join("store"), &["--host", "bench.example"]);
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let _proxy = start(folder, port, &server);
    let curl = |arguments: &[&str], path: &str| -> Output {
        let mut command = Command::new("curl");
        command.args(["-sS", "-i", "--noproxy", "*", "--cacert"]).arg(&certificate);
        command.args(["--resolve", &format!("bench.example:{port}:127.0.0.1")]).args(arguments);
        command.arg(format!("https://bench.example:{port}{path}")).output().unwrap()
    };
    let text = |output: &Output| String::from_utf8_lossy(&output.stdout).into_owned();
    for _ in 0..100 {
        if curl(&[], "/readyz").status.success() {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let ready = curl(&[], "/readyz");
    let why = String::from_utf8_lossy(&ready.stderr).into_owned();
    let said = text(&ready);
    assert!(said.contains(" 200 ") && said.contains("Strict-Transport-Security"), "{said}{why}");

    // Larger than a proxy takes by itself.
    let mut table =
        "# a remark as long as such remarks are, more or less\n".repeat(50_000).into_bytes();
    table.extend(simulated(&[]));
    std::fs::write(folder.join("table.csv"), table).unwrap();
    let file = format!("@{}", folder.join("table.csv").display());
    let upload = ["-H", "content-type: text/csv", "-H", "expect:", "--data-binary", &file];
    let stored = text(&curl(&upload, "/v1/measurements"));
    assert!(stored.contains(" 201 "), "{stored}");
    // A page of the proxy's own name may change things, one of another name may not.
    for (name, status) in [("bench.example", " 404 "), ("evil.example", " 403 ")] {
        let origin = format!("origin: https://{name}");
        let answer = text(&curl(&["-X", "DELETE", "-H", &origin], "/v1/jobs/none"));
        assert!(answer.contains(status), "{name}: {answer}");
    }
}
