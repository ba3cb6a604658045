//! Previews of uploads, and mappings that are stored and used again.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use crate::process::{Server, servoscope};
use crate::service::problem;

const NAMES: &str = "Time (ms); Current (A); ; Position (mm)";

/// A record of an axis with a friction-free response, its columns under names of no vocabulary, one
/// of which holds words.
fn foreign(amplitude: f64) -> Vec<u8> {
    let mut text = String::from("Rig 7\n\ntick;chan a;state;chan b\n");
    for n in 0..400 {
        let angle = TAU * f64::from(n) / 50.0;
        let row = format!("{n};{:.5};on;{:.5}\n", amplitude * angle.cos(), (angle - 0.5).cos());
        text += &row.replace('.', ",");
    }
    text.into_bytes()
}

/// A server without measurements or mappings, and its folder.
fn server() -> (Server, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    (Server::start(directory.path(), &[]), directory)
}

fn previewed(server: &Server, query: &str, file: &[u8]) -> Value {
    let answer = server.post(&format!("/v1/preview{query}"), "text/plain", file);
    assert_eq!(answer.status, 200, "{}", answer.text);
    answer.json()
}

fn stored(server: &Server, layout: &Value) {
    let body = json!({"settings": {"column_names": NAMES}, "layout": layout});
    let answer = server.put("/v1/mappings/rig%207", &body);
    assert_eq!(answer.status, 201, "{}", answer.text);
}

fn uploads(server: &Server) -> usize {
    server.get("/v1/measurements").json()["items"].as_array().unwrap().len()
}

#[test]
fn a_preview_says_what_is_missing_and_stores_nothing() {
    let (server, _directory) = server();
    let seen = previewed(&server, "", &foreign(1.0));
    let table = &seen["files"][0]["table"];
    assert_eq!(table["delimiter"], "semicolons");
    assert_eq!(table["decimal"], "comma");
    assert_eq!(table["preamble"], json!(["Rig 7"]));
    assert_eq!(table["columns"][1]["name"], "chan a");
    assert_eq!(table["rows"].as_array().unwrap().len(), 20);
    assert_eq!(table["rows"][0][1], "1,00000");
    let missing = &seen["refusal"]["missing"][0];
    assert_eq!(missing["key"], "column_names");
    assert!(missing["how"].as_str().unwrap().contains("--column-names"), "{missing}");
    assert_eq!(seen["measurement"], Value::Null);

    let query = format!("?column_names={}", NAMES.replace(' ', "%20").replace(';', "%3B"));
    let named = previewed(&server, &query, &foreign(1.0));
    assert_eq!(named["refusal"], Value::Null);
    assert_eq!(named["measurement"]["response"], json!({"name": "position", "unit": "mm"}));
    assert_eq!(named["files"][0]["table"]["columns"][3]["used_as"], "output");
    assert_eq!(named["given"], json!({"column_names": NAMES}));
    assert_eq!(named["layout"], seen["layout"]);

    let wrong = previewed(&server, "?magnitude=soon", &foreign(1.0));
    assert!(wrong["refusal"]["detail"].as_str().unwrap().contains("soon"), "{wrong}");
    assert_eq!(uploads(&server), 0);
    problem(&server.post("/v1/preview", "image/png", b"x"), 415);
}

#[test]
fn a_mapping_is_used_by_itself_for_its_layout_and_says_so_by_name() {
    let (server, _directory) = server();
    problem(&server.post("/v1/measurements", "text/plain", &foreign(1.0)), 422);
    let layout = previewed(&server, "", &foreign(1.0))["layout"].clone();
    stored(&server, &layout);
    let next = server.post("/v1/measurements", "text/plain", &foreign(2.0));
    assert_eq!(next.status, 201, "{}", next.text);
    let next = next.json();
    assert_eq!(next["response_kind"], "position");
    assert_eq!(next["input"], json!({"name": "current", "unit": "A"}));
    let note = next["notes"][0].as_str().unwrap();
    assert!(note.contains("`rig 7`") && note.contains(NAMES), "{note}");
    assert_eq!(previewed(&server, "", &foreign(2.0))["mapping"], "rig 7");

    // What the upload gives holds before what the mapping says.
    let other = NAMES.replace("mm", "m").replace(' ', "%20").replace(';', "%3B");
    let path = format!("/v1/measurements?column_names={other}");
    let own = server.post(&path, "text/plain", &foreign(1.0)).json();
    assert_eq!(own["response"]["unit"], "m");

    // A file that is understood is not changed, whatever the layout of a mapping.
    let plain = b"time_s,input,output\n0,1,2\n1,0,1\n2,-1,0\n3,0,1\n4,1,2\n5,0,1\n6,-1,0\n7,0,1\n";
    let seen = previewed(&server, "", plain);
    let body = json!({"settings": {"response": "position m"}, "layout": seen["layout"]});
    assert_eq!(server.put("/v1/mappings/plain", &body).status, 201);
    let again = previewed(&server, "", plain);
    assert_eq!((&again["mapping"], &again["measurement"]), (&Value::Null, &seen["measurement"]));

    assert_eq!(server.delete("/v1/mappings/rig%207"), 204);
    problem(&server.post("/v1/measurements", "text/plain", &foreign(1.0)), 422);
}

#[test]
fn a_mapping_without_a_layout_is_used_by_its_name_alone() {
    let (server, _directory) = server();
    stored(&server, &Value::Null);
    problem(&server.post("/v1/measurements", "text/plain", &foreign(1.0)), 422);
    let path = "/v1/measurements?mapping=rig%207";
    let named = server.post(path, "text/plain", &foreign(1.0));
    assert_eq!(named.status, 201, "{}", named.text);
    assert!(named.json()["notes"][0].as_str().unwrap().contains("as asked for"));
    let file = String::from_utf8(foreign(1.0)).unwrap();
    let form = format!(
        "--X\r\ncontent-disposition: form-data; name=\"f\"; filename=\"rig.txt\"\r\n\r\n{file}\r\n\
         --X\r\ncontent-disposition: form-data; name=\"mapping\"\r\n\r\nrig 7\r\n--X--\r\n"
    );
    let by_field =
        server.post("/v1/measurements", "multipart/form-data; boundary=X", form.as_bytes());
    assert_eq!(by_field.status, 201, "{}", by_field.text);
    let unknown = server.post("/v1/measurements?mapping=rig", "text/plain", &foreign(1.0));
    assert_eq!(problem(&unknown, 422)["member"], "mapping");
    let still = server.post(path, "text/plain", b"x;y\n1;2\n");
    let detail = problem(&still, 422)["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("the stored mapping `rig 7`"), "{detail}");
}

#[test]
fn the_command_line_reads_a_stored_mapping_unchanged() {
    let (server, directory) = server();
    stored(&server, &Value::Null);
    let toml = server.get("/v1/mappings/rig%207/mapping.toml");
    assert_eq!((toml.status, toml.content_type.as_str()), (200, "application/toml"));
    let (mapping, file) = (directory.path().join("rig.toml"), directory.path().join("rig.txt"));
    std::fs::write(&mapping, &toml.text).unwrap();
    std::fs::write(&file, foreign(1.0)).unwrap();
    let path = |path: &std::path::Path| path.to_str().unwrap().to_owned();
    let plain = servoscope(&["inspect", &path(&file)]);
    assert!(!plain.status.success());
    let mapped = servoscope(&["inspect", "--mapping", &path(&mapping), &path(&file)]);
    let said = String::from_utf8_lossy(&mapped.stderr);
    assert!(mapped.status.success(), "{said}");
}

#[test]
fn mappings_are_listed_replaced_and_refused_with_what_is_wrong() {
    let (server, _directory) = server();
    stored(&server, &Value::Null);
    let body = json!({"settings": {"response": "velocity rad/s", "magnitude": "0.5"}});
    let replaced = server.put("/v1/mappings/rig%207", &body);
    assert_eq!(replaced.status, 200, "{}", replaced.text);
    let items = server.get("/v1/mappings").json()["items"].clone();
    assert_eq!(items.as_array().unwrap().len(), 1);
    assert_eq!(items[0]["settings"], body["settings"]);
    assert_eq!(items[0], server.get("/v1/mappings/rig%207").json());
    for (name, settings, member) in [
        ("rig", json!({}), "settings"),
        ("rig", json!({"response": "red"}), "settings.response"),
        ("rig", json!({"colour": "red"}), "settings.colour"),
        (".rig", json!({"decimal": "comma"}), "name"),
    ] {
        let answer = server.put(&format!("/v1/mappings/{name}"), &json!({"settings": settings}));
        assert_eq!(problem(&answer, 422)["member"], member);
    }
    problem(&server.get("/v1/mappings/nobody"), 404);
    assert_eq!(server.delete("/v1/mappings/nobody"), 404);
}

#[test]
fn a_table_without_column_names_is_named_once_and_its_mapping_says_what_it_goes_by() {
    let (server, _directory) = server();
    let nameless = |rows: &[u8]| {
        let text = String::from_utf8(rows.to_vec()).unwrap();
        text.split_once("chan b\n").unwrap().1.replace("on;", "").into_bytes()
    };
    let refused =
        problem(&server.post("/v1/measurements", "text/plain", &nameless(&foreign(1.0))), 422);
    let detail = refused["detail"].as_str().unwrap();
    assert!(detail.contains("columns 1 to 3 of numbers and no column names"), "{detail}");
    let seen = previewed(&server, "", &nameless(&foreign(1.0)));
    let columns = seen["files"][0]["table"]["columns"].as_array().unwrap();
    assert!(columns.len() == 3 && columns.iter().all(|column| column["name"] == ""), "{columns:?}");
    let body = json!({
        "settings": {"column_names": "Time (ms); Current (A); Position (mm)"},
        "layout": seen["layout"],
    });
    assert_eq!(server.put("/v1/mappings/bare", &body).status, 201);

    let added = server.post("/v1/measurements", "text/plain", &nameless(&foreign(2.0)));
    assert_eq!(added.status, 201, "{}", added.text);
    let note = added.json()["notes"][0].as_str().unwrap().to_owned();
    for part in ["`bare` is used", "3 columns between semicolons with a decimal comma", "check"] {
        assert!(note.contains(part), "{note}");
    }
    // Another number of columns is another layout.
    let four = String::from_utf8(nameless(&foreign(1.0))).unwrap().replace('\n', ";1\n");
    problem(&server.post("/v1/measurements", "text/plain", four.as_bytes()), 422);
}
