//! Results and parameters over the time of measuring.

use super::*;

fn text(mut answer: Response<Body>) -> String {
    assert_eq!(answer.status(), 200);
    answer.body_mut().read_to_string().unwrap()
}

#[test]
fn a_result_is_a_row_of_its_measurement_and_its_time() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    server.ended(&server.job(UNUSABLE));
    let rows = json_of(server.get("/v1/results.json"), 200);
    assert_eq!(rows["rows"].as_array().unwrap().len(), 1, "{rows}");
    let row = &rows["rows"][0];
    assert_eq!((&row["job_id"], &row["kind"]), (&json!(id), &json!("identify")));
    assert_eq!((&row["machine"], &row["axis"]), (&json!("press 4"), &json!("x")));
    let at = string(row, "at");
    for (query, found) in [
        (format!("from={at}"), 1),
        (format!("to={at}"), 0),
        ("machine=press%204".to_owned(), 1),
        ("axis=y".to_owned(), 0),
        (format!("measurement_id={}", string(row, "measurement_id")), 1),
    ] {
        let rows = json_of(server.get(&format!("/v1/results.json?{query}")), 200);
        assert_eq!(rows["rows"].as_array().unwrap().len(), found, "{query}");
    }
    let table = text(server.get("/v1/results.csv"));
    assert!(table.starts_with("at,job_id,measurement_id,name,machine,axis,kind,"), "{table}");
    assert_eq!(table.lines().count(), 2);
    problem(server.get("/v1/results.json?from=yesterday"), 400);
}

#[test]
fn an_axis_has_the_parameters_of_the_latest_result_of_each_measurement() {
    let server = Server::start();
    let measurement = server.measurement();
    for seed in [SUCCEED, 11] {
        let body = json!({
            "measurement_id": measurement, "kind": "identify", "options": {"seed": seed},
        });
        server.ended(&string(&json_of(server.submit(&body), 202), "id"));
    }
    server.measurement();
    let axes = json_of(server.get("/v1/axes"), 200);
    let axis = &axes["items"][0];
    assert_eq!((&axis["machine"], &axis["axis"]), (&json!("press 4"), &json!("x")));
    assert_eq!((&axis["measurements"], &axis["results"]), (&json!(2), &json!(1)));
    let none = json_of(server.get("/v1/axes?machine=press%205"), 200);
    assert_eq!(none["items"], json!([]));

    let history = "machine=press%204&axis=x";
    let poles = json_of(server.get(&format!("/v1/history.json?{history}&parameter=pole")), 200);
    let rows = poles["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1, "{poles}");
    assert_eq!((&rows[0]["changed"], &rows[0]["change"]), (&json!(false), &Value::Null));
    assert!(rows[0]["low95"].as_f64() < rows[0]["value"].as_f64());
    let changed = json_of(server.get(&format!("/v1/history.json?{history}&changed=true")), 200);
    assert_eq!(changed["rows"], json!([]));

    let table = text(server.get(&format!("/v1/history.csv?{history}")));
    assert!(
        table.starts_with("at,parameter,name,value,std,low95,high95,unit,change,changed,"),
        "{table}"
    );
    let figure = text(server.get(&format!("/v1/history.svg?{history}&theme=dark&width=600")));
    assert!(figure.starts_with("<svg") && figure.contains("width=\"600\""), "{figure}");
    problem(server.get("/v1/history.svg?machine=nobody&axis=x"), 404);
    problem(server.get("/v1/history.json?machine=press%204"), 400);
}
