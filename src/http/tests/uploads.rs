//! Measurements that are sent, and requests that are sent again.

use super::*;

#[test]
fn a_measurement_shows_what_is_in_it() {
    let server = Server::start();
    let headers = [("content-type", "text/csv; charset=utf-8")];
    let answer = server.post("/v1/measurements?name=axis%20x", &headers, b"any");
    let location = header(&answer, "location").to_owned();
    let added = json_of(answer, 201);
    assert_eq!(json_of(server.get(&location), 200), added);
    assert_eq!(added["name"], "axis x");
    assert_eq!(added["machine"], "press 4");
    assert_eq!(added["labels"]["site"], "north");
    assert_eq!(added["omega_range_rad_s"], json!([2.0, 20.0]));
    assert_eq!(added["notes"][0], "column `colour` is unknown and was not used");
}

#[test]
fn an_upload_that_cannot_be_read_says_where_and_is_not_stored() {
    let server = Server::start();
    let answer = server.post("/v1/measurements?name=run1", &[("content-type", "text/csv")], b"bad");
    let problem = problem(answer, 422);
    assert_eq!(problem["file"], "run1.csv");
    assert_eq!((&problem["line"], &problem["column"]), (&json!(3), &json!("gain")));
    assert!(string(&problem, "detail").contains("not a number"));
    assert_eq!(json_of(server.get("/v1/measurements"), 200), json!({"items": [], "next": null}));
}

#[test]
fn several_files_of_a_form_are_one_measurement() {
    let server = Server::start();
    let form = |second: &str| {
        format!(
            "--X\r\ncontent-disposition: form-data; name=\"a\"; filename=\"a.csv\"\r\n\r\nany\r\n\
             --X\r\ncontent-disposition: form-data; name=\"b\"; filename=\"b.csv\"\r\n\r\n{second}\
             \r\n--X--\r\n"
        )
    };
    let headers = [("content-type", "multipart/form-data; boundary=X")];
    json_of(server.post("/v1/measurements", &headers, form("any").as_bytes()), 201);
    let answer = server.post("/v1/measurements", &headers, form("bad").as_bytes());
    assert_eq!(problem(answer, 422)["file"], "b.csv");
    problem(server.post("/v1/measurements", &headers, b"--X--\r\n"), 400);
}

#[test]
fn a_repeated_key_gives_the_same_resource_and_never_another() {
    let server = Server::start();
    let csv = [("content-type", "text/csv"), ("idempotency-key", "k")];
    let first = json_of(server.post("/v1/measurements", &csv, b"any"), 201);
    assert_eq!(json_of(server.post("/v1/measurements", &csv, b"any"), 201), first);
    problem(server.post("/v1/measurements", &csv, b"other"), 422);
    assert_eq!(json_of(server.get("/v1/measurements"), 200)["items"].as_array().unwrap().len(), 1);

    let headers = [("content-type", "application/json"), ("idempotency-key", "k")];
    let body = |seed: u64| json!({"measurement_id": first["id"], "kind": "identify", "options": {"seed": seed}});
    let post = |body: &Value| server.post("/v1/jobs", &headers, body.to_string().as_bytes());
    let job = json_of(post(&body(SUCCEED)), 202);
    assert_eq!(json_of(post(&body(SUCCEED)), 202)["id"], job["id"]);
    problem(post(&body(UNUSABLE)), 422);
}
