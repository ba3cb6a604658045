//! Files as spreadsheets and instruments write them, through the server and the command line.

use serde_json::{Value, json};

use crate::process::{Server, servoscope, simulated};
use crate::service::problem;

/// A table in the form of the contract, and the same as a German spreadsheet saves it.
fn plain_and_german() -> [Vec<u8>; 2] {
    let plain = simulated(&["--noise-db", "60"]);
    let text = String::from_utf8(plain.clone()).unwrap();
    let rows = text.lines().map(|line| match line.starts_with('#') {
        true => line.to_owned(),
        false => line.replace(',', ";").replace('.', ","),
    });
    let rows: Vec<String> = rows.collect();
    let german = format!("sep=;\r\n# operator: Jürgen\r\n{};\r\n", rows.join(";\r\n"));
    [plain, german.chars().map(|c| c as u8).collect()]
}

#[test]
fn a_german_spreadsheet_is_the_same_measurement_over_http() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let [plain, german] = plain_and_german().map(|body| {
        let answer = server.post("/v1/measurements?name=table", "text/csv", &body);
        assert_eq!(answer.status, 201, "{}", answer.text);
        answer.json()
    });
    for member in ["experiments", "highest_harmonic", "magnitude_range", "omega_range_rad_s"] {
        assert_eq!(plain[member], german[member], "{member}");
    }
    let rows = |measurement: &Value| {
        let path = format!("/v1/measurements/{}/data.csv", measurement["id"].as_str().unwrap());
        let table = server.get(&path).text;
        let rows = table.lines().filter(|line| !line.starts_with('#')).map(str::to_owned);
        rows.collect::<Vec<_>>()
    };
    assert_eq!(rows(&plain), rows(&german));
    assert_eq!(german["operator"], "Jürgen");
    let said = german["notes"].to_string();
    assert!(said.contains("Windows-1252") && said.contains("decimal comma"), "{said}");
    // What is stored is read again for the computation.
    let [plain, german] = [plain, german].map(|measurement| {
        let job = server.submit(&json!({
            "measurement_id": measurement["id"], "kind": "identify",
            "plant": {"actuator_order": 0}, "method": "two-magnitude",
        }));
        assert_eq!(server.ended(&job)["status"], "succeeded");
        server.get(&format!("{job}/result")).json()["parameters"].clone()
    });
    assert_eq!(plain, german);
}

#[test]
fn a_german_spreadsheet_is_the_same_measurement_on_the_command_line() {
    let directory = tempfile::tempdir().unwrap();
    let [plain, german] = plain_and_german().map(|body| {
        let file = directory.path().join("table.csv");
        std::fs::write(&file, body).unwrap();
        let flags = ["--json", "--actuator-order", "0", "--method", "two-magnitude"];
        let output = servoscope(&[&["identify", file.to_str().unwrap()], &flags[..]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["parameters"].clone()
    });
    assert_eq!(plain, german);
}

#[test]
fn what_a_file_does_not_say_is_asked_for_and_given_as_query_field_or_flag() {
    let directory = tempfile::tempdir().unwrap();
    let bode = "Frequency (Hz);Magnitude (dB);Phase (°)\n0,5;-3,5;-70\n1,5;-9,5;-85\n";
    let server = Server::start(&directory.path().join("store"), &[]);
    let post =
        |query: &str| server.post(&format!("/v1/measurements{query}"), "text/csv", bode.as_bytes());
    let asked = problem(&post(""), 422).to_string();
    assert!(asked.contains("--magnitude") && asked.contains("--response"), "{asked}");
    let wrong = problem(&post("?response=temperature"), 422);
    assert_eq!(wrong["column"], "response");
    let answer = post("?response=velocity%20rad/s&magnitude=2");
    assert_eq!(answer.status, 201, "{}", answer.text);
    let by_query = answer.json();
    let field = |name: &str, value: &str| {
        format!("--x\r\ncontent-disposition: form-data; name=\"{name}\"\r\n\r\n{value}\r\n")
    };
    let form = format!(
        "{}{}--x\r\ncontent-disposition: form-data; name=\"file\"; filename=\"bode.csv\"\r\n\r\n\
         {bode}\r\n--x--\r\n",
        field("response", "velocity rad/s"),
        field("magnitude", "2"),
    );
    let kind = "multipart/form-data; boundary=x";
    let by_form = server.post("/v1/measurements", kind, form.as_bytes());
    assert_eq!(by_form.status, 201, "{}", by_form.text);
    assert_eq!(by_form.json()["magnitude_range"], json!([2.0, 2.0]));
    assert_eq!(by_query["experiments"], 2);

    let file = directory.path().join("bode.csv");
    std::fs::write(&file, bode).unwrap();
    let run = |flags: &[&str]| {
        let command = [&["identify", file.to_str().unwrap()], flags].concat();
        String::from_utf8(servoscope(&command).stderr).unwrap()
    };
    assert!(run(&[]).contains("--response"), "{}", run(&[]));
    // The file is read now; two points are too few for a fit.
    let given = run(&["--response", "velocity rad/s", "--magnitude", "2"]);
    assert!(!given.contains("--response") && !given.contains("is missing"), "{given}");
    let wrong = run(&["--decimal", "dot"]);
    assert!(wrong.contains("'dot' for '--decimal") && wrong.contains("comma, point"), "{wrong}");
}
