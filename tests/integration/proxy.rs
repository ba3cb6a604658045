//! The server behind the proxy of the operator's page.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::time::Duration;

use crate::process::{Server, repository, servoscope, simulated};
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
    let store = folder.join("store");
    let place = ["--data-dir", store.to_str().unwrap()];
    let first = ["keys", "add", "--name", "first", "--scope", "admin"];
    let first = servoscope(&[&first[..], &place].concat());
    assert!(first.status.success(), "{}", String::from_utf8_lossy(&first.stderr));
    let first = String::from_utf8(first.stdout).unwrap().trim().to_owned();
    let authorization = format!("authorization: Bearer {first}");
    let server = Server::start(&store, &["--host", "bench.example"]);
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
    let refused = text(&curl(&[], "/v1/measurements"));
    assert!(refused.contains(" 401 "), "without a key: {refused}");
    let stored = text(&curl(&[&upload[..], &["-H", &authorization]].concat(), "/v1/measurements"));
    assert!(stored.contains(" 201 "), "{stored}");
    // A page of the proxy's own name and port may change things, another one may not.
    for (page, status) in
        [("bench.example", " 404 "), ("bench.example:8443", " 403 "), ("evil.example", " 403 ")]
    {
        let origin = format!("origin: https://{page}");
        let change = ["-X", "DELETE", "-H", &origin, "-H", &authorization];
        let answer = text(&curl(&change, "/v1/jobs/none"));
        assert!(answer.contains(status), "{page}: {answer}");
    }

    // The browser keeps the session from plain HTTP: the proxy says how the page came.
    let signed_in = format!("{{\"key\": \"{first}\"}}");
    let sign_in = ["-H", "content-type: application/json", "--data-binary", &signed_in];
    let answer = text(&curl(&sign_in, "/v1/session"));
    let cookie = answer.lines().find(|line| line.to_lowercase().starts_with("set-cookie:"));
    assert!(cookie.is_some_and(|cookie| cookie.contains("; Secure")), "{answer}");
}

#[test]
fn a_name_that_a_proxy_passes_on_needs_a_valid_key() {
    let directory = tempfile::tempdir().unwrap();
    let place = ["--data-dir", directory.path().to_str().unwrap()];
    let serve = ["serve", "--listen", "127.0.0.1:0", "--host", "localhost", "--host"];
    let refused = servoscope(&[&serve[..], &["bench.example:8443"], &place].concat());
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    for part in ["`--host bench.example:8443`", "servoscope keys add --name first --scope admin"] {
        assert!(said.contains(part), "{said}");
    }
    // A name of the machine itself needs none.
    let server = Server::start(directory.path(), &["--host", "localhost:9000"]);
    assert_eq!(server.get("/v1/jobs").status, 200);
}

#[test]
fn a_worker_that_others_can_watch_needs_a_valid_key() {
    let directory = tempfile::tempdir().unwrap();
    let place = ["--data-dir", directory.path().to_str().unwrap()];
    let refused = servoscope(&[&["worker", "--metrics", "0.0.0.0:0"][..], &place].concat());
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    for part in ["other machines can reach 0.0.0.0:0", "servoscope keys add", "`--metrics`"] {
        assert!(said.contains(part), "{said}");
    }
}
