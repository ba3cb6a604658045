//! Rules of single members, as the document has them and as they hold.

use super::*;

#[test]
fn the_document_says_by_which_rules_a_request_is_refused() {
    let server = Server::start();
    let document = json_of(server.get("/openapi.json"), 200);
    let of = |schema: &str, property: &str| {
        document["components"]["schemas"][schema]["properties"][property].clone()
    };
    assert_eq!(of("AddWebhook", "events")["minItems"], 1);
    assert_eq!(of("AddWebhook", "url")["maxLength"], 2000);
    assert_eq!(of("PutMapping", "settings")["minProperties"], 1);
    assert!(of("AddKey", "name")["pattern"].is_string());
    for name in ["name", "machine", "axis", "operator"] {
        assert_eq!(of("DescribeMeasurement", name)["maxLength"], 1000, "{name}");
    }
    let labels = of("DescribeMeasurement", "labels");
    assert_eq!(labels["maxProperties"], 100);
    assert_eq!(labels["additionalProperties"]["maxLength"], 1000);
    let parameter = |path: &str, method: &str, name: &str| {
        let parameters = document["paths"][path][method]["parameters"].as_array().unwrap();
        parameters.iter().find(|one| one["name"] == name).unwrap()["schema"].to_string()
    };
    let name = parameter("/v1/mappings/{name}", "put", "name");
    assert!(name.contains("pattern") && name.contains("\"maxLength\":64"), "{name}");
    for (name, words) in [
        ("loop", "\"open\",\"closed\""),
        ("amplitude", "\"peak\",\"rms\",\"peak-to-peak\""),
        ("decimal", "\"comma\",\"point\""),
        ("inverted", "\"yes\",\"no\""),
    ] {
        let schema = parameter("/v1/measurements", "post", name);
        assert!(schema.contains(words), "{name}: {schema}");
        let field = of("UploadForm", name).to_string();
        assert!(field.contains(words), "{name}: {field}");
    }

    // Each holds, and what is just within it is taken.
    let json = [("content-type", "application/json")];
    let status = |method: &str, path: &str, body: &Value| {
        server.send(method, path, &json, body.to_string().as_bytes()).status().as_u16()
    };
    let url = |length: usize| format!("http://127.0.0.1:9/{}", "a".repeat(length - 19));
    assert_eq!(status("POST", "/v1/webhooks", &json!({"url": url(2000)})), 201);
    assert_eq!(status("POST", "/v1/webhooks", &json!({"url": url(2001)})), 422);
    assert_eq!(status("POST", "/v1/webhooks", &json!({"url": url(99), "events": []})), 422);
    let mapping = json!({"settings": {"response": "velocity rad/s"}});
    assert_eq!(status("PUT", "/v1/mappings/Pr%C3%BCfstand%207", &mapping), 201);
    assert_eq!(status("PUT", "/v1/mappings/_7", &mapping), 422);
    assert_eq!(status("PUT", "/v1/mappings/none", &json!({"settings": {}})), 422);
    let path = format!("/v1/measurements/{}", server.measurement());
    let labels = |count: usize| -> serde_json::Map<String, Value> {
        (0..count).map(|label| (format!("l{label}"), json!("x"))).collect()
    };
    for (body, expected) in [
        (json!({"operator": "x".repeat(1000)}), 200),
        (json!({"operator": "x".repeat(1001)}), 422),
        (json!({"labels": labels(100)}), 200),
        (json!({"labels": labels(101)}), 422),
    ] {
        assert_eq!(status("PATCH", &path, &body), expected);
    }
}
