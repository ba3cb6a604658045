//! Lists that have no pages.

use super::*;

/// A list as it is sent, and how many items it has.
fn listed(server: &Server, path: &str) -> (String, usize) {
    let mut answer = server.get(path);
    let text = answer.body_mut().read_to_string().unwrap();
    let list: Value = serde_json::from_str(&text).unwrap();
    let items = list["items"].as_array().unwrap().len();
    (text, items)
}

#[test]
fn mappings_are_so_many_and_their_list_is_small_whatever_their_layouts_are() {
    let server = Server::start();
    server.database(
        "WITH RECURSIVE numbers (number) AS (
             SELECT 1 UNION ALL SELECT number + 1 FROM numbers WHERE number < 1000)
         INSERT INTO mappings (name, settings, layout, updated_at_ms, owner)
         SELECT 'rig ' || number, '{\"machine\":\"press 4\"}', NULL, 1, '' FROM numbers",
    );
    assert_eq!(listed(&server, "/v1/mappings").1, 1000);
    let put = |name: &str| {
        let path = format!("{}/v1/mappings/{name}", server.address);
        let request = server.agent.put(path).header("content-type", "application/json");
        request.send(&b"{\"settings\": {\"machine\": \"press 5\"}}"[..]).unwrap()
    };
    let refused = problem(put("another"), 422);
    assert_eq!(refused["member"], "name");
    let text = string(&refused, "detail");
    assert!(text.contains("1000 mappings already; delete one"), "{text}");
    assert_eq!(put("rig%201").status(), 200, "one that is there is replaced");
    assert_eq!(server.delete("/v1/mappings/rig%202"), 204);
    assert_eq!(put("another").status(), 201);

    server.database("UPDATE mappings SET layout = hex(zeroblob(8000))");
    let (text, items) = listed(&server, "/v1/mappings");
    assert!(text.len() < 3 << 20 && items > 100, "{} bytes, {items} items", text.len());
}

#[test]
fn the_list_of_webhooks_is_small_however_many_there_are() {
    let server = Server::start();
    server.database(
        "WITH RECURSIVE numbers (number) AS (
             SELECT 1 UNION ALL SELECT number + 1 FROM numbers WHERE number < 1500)
         INSERT INTO webhooks (id, created_at_ms, url, secret, events, owner)
         SELECT printf('%04d', number), 1, 'http://127.0.0.1:9/', 'whsec_', '[\"job.finished\"]', ''
         FROM numbers",
    );
    let (text, items) = listed(&server, "/v1/webhooks");
    assert_eq!(items, 1000);
    assert!(text.contains("\"1500\"") && !text.contains("\"0500\""), "the newest are listed");
    server.database("UPDATE webhooks SET url = 'http://127.0.0.1:9/' || hex(zeroblob(3950))");
    let (text, items) = listed(&server, "/v1/webhooks");
    assert!(text.len() < 3 << 20 && items > 100, "{} bytes, {items} items", text.len());
}
