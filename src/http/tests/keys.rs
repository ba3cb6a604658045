//! Keys: what opens a server, until when, and who sees that.

use super::*;
use crate::store::{KeyRow, Reach};

fn as_holder(server: &Server, method: &str, path: &str, key: &str, body: &Value) -> Response<Body> {
    let authorization = format!("Bearer {key}");
    let headers = [("authorization", authorization.as_str()), ("content-type", "application/json")];
    let body = if body.is_null() { String::new() } else { body.to_string() };
    server.send(method, path, &headers, body.as_bytes())
}

fn get(server: &Server, path: &str, key: &str) -> Response<Body> {
    as_holder(server, "GET", path, key, &Value::Null)
}

#[test]
fn a_server_without_keys_asks_for_none_and_with_the_first_for_one_at_once() {
    let server = Server::start();
    let measurement = server.measurement();
    assert_eq!(json_of(server.get("/v1/session"), 200), json!({"key": null}));
    let headers = [("content-type", "application/json")];
    let body = json!({"name": "first", "scopes": ["admin"]}).to_string();
    let added = server.post("/v1/keys", &headers, body.as_bytes());
    let location = header(&added, "location").to_owned();
    let added = json_of(added, 201);
    let key = string(&added, "key");
    assert_eq!(location, format!("/v1/keys/{}", string(&added, "id")));

    problem(server.get("/v1/measurements"), 401);
    problem(server.get("/metrics"), 401);
    for open in
        ["/livez", "/readyz", "/", "/jobs/any", "/assets/main.js", "/docs/", "/openapi.json"]
    {
        assert_eq!(server.get(open).status(), 200, "{open}");
    }
    // It was made when there was no key: it is the admins'.
    assert_eq!(get(&server, &format!("/v1/measurements/{measurement}"), &key).status(), 200);
    let (_, reader) = server.key(&[Scope::Read]);
    problem(get(&server, &format!("/v1/measurements/{measurement}"), &reader), 404);
    assert_eq!(json_of(get(&server, "/v1/measurements", &reader), 200)["items"], json!([]));
}

#[test]
fn a_key_is_shown_once_and_lists_say_when_it_was_used() {
    let server = Server::start();
    let (id, admin) = server.key(&[Scope::Admin]);
    let body = json!({
        "name": "rig 7", "scopes": ["read", "upload", "read"], "expires_at": "2126-01-01T00:00:00Z",
    });
    let added = json_of(as_holder(&server, "POST", "/v1/keys", &admin, &body), 201);
    let key = string(&added, "key");
    assert_eq!(added["scopes"], json!(["upload", "read"]));
    assert_eq!(added["expires_at"], "2126-01-01T00:00:00Z");
    let mut listed = get(&server, "/v1/keys", &admin);
    let text = listed.body_mut().read_to_string().unwrap();
    assert!(!text.contains("sk_servoscope_"), "{text}");
    let listed: Value = serde_json::from_str(&text).unwrap();
    let of = |id: &str| {
        listed["items"].as_array().unwrap().iter().find(|item| item["id"] == id).cloned()
    };
    assert!(of(&id).unwrap()["last_used_at"].is_string());
    let path = format!("/v1/keys/{}", string(&added, "id"));
    assert_eq!(json_of(get(&server, &path, &admin), 200)["last_used_at"], Value::Null);
    assert_eq!(get(&server, "/v1/jobs", &key).status(), 200);
    assert!(json_of(get(&server, &path, &admin), 200)["last_used_at"].is_string());

    for (patch, member) in [
        (json!({"name": ""}), "name"),
        (json!({"name": "a\nb"}), "name"),
        (json!({"scopes": []}), "scopes"),
        (json!({"scopes": ["everything"]}), "scopes[0]"),
        (json!({"expires_at": "soon"}), "expires_at"),
        (json!({"expires_at": "2001-01-01T00:00:00Z"}), "expires_at"),
    ] {
        let mut body = json!({"name": "rig", "scopes": ["read"]});
        body.as_object_mut().unwrap().extend(patch.as_object().unwrap().clone());
        let refused = problem(as_holder(&server, "POST", "/v1/keys", &admin, &body), 422);
        assert_eq!(refused["member"], member, "{refused}");
    }
}

#[test]
fn a_key_that_has_expired_or_was_revoked_or_is_wrong_opens_nothing() {
    let server = Server::start();
    let (_, admin) = server.key(&[Scope::Admin]);
    let (id, key) = server.key(&[Scope::Read]);
    assert_eq!(get(&server, "/v1/jobs", &key).status(), 200);
    let last = if key.ends_with('0') { "1" } else { "0" };
    let almost = format!("{}{last}", &key[..key.len() - 1]);
    for wrong in [almost.as_str(), "sk_servoscope_", "secret", &key[..30]] {
        let refused = problem(get(&server, "/v1/jobs", wrong), 401);
        assert!(string(&refused, "detail").contains("not known"), "{refused}");
    }

    let now = server.runtime.block_on(server.store.key(&id)).unwrap().unwrap().now_ms;
    let digest = |key: &str| {
        use sha2::Digest as _;
        sha2::Sha256::digest(key.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let old = format!("sk_servoscope_{}_{}", "a".repeat(16), "b".repeat(64));
    let row = KeyRow {
        id: "a".repeat(16),
        name: "old".into(),
        scopes: "[\"read\"]".into(),
        sha256: digest(&old),
        created_at_ms: 0,
        expires_at_ms: Some(now),
        revoked_at_ms: None,
        used_at_ms: None,
        quotas: "{}".into(),
        now_ms: 0,
    };
    assert!(server.runtime.block_on(server.store.insert_key(&row)).unwrap());
    let refused = problem(get(&server, "/v1/jobs", &old), 401);
    assert!(string(&refused, "detail").contains("expired"), "{refused}");

    let path = format!("/v1/keys/{id}");
    for _ in 0..2 {
        assert_eq!(as_holder(&server, "DELETE", &path, &admin, &Value::Null).status(), 204);
    }
    let refused = problem(get(&server, "/v1/jobs", &key), 401);
    assert!(string(&refused, "detail").contains("revoked"), "{refused}");
    let shown = json_of(get(&server, &path, &admin), 200);
    assert!(shown["valid"] == false && shown["revoked_at"].is_string(), "{shown}");
    let rotate = format!("{path}/rotate");
    problem(as_holder(&server, "POST", &rotate, &admin, &Value::Null), 422);
    problem(as_holder(&server, "DELETE", "/v1/keys/nobody", &admin, &Value::Null), 404);
}

#[test]
fn a_rotated_key_keeps_its_data_and_the_old_secret_opens_nothing() {
    let server = Server::start();
    let (_, admin) = server.key(&[Scope::Admin]);
    let (id, key) = server.key(&[Scope::Upload, Scope::Read]);
    let authorization = format!("Bearer {key}");
    let headers = [("authorization", authorization.as_str()), ("content-type", "text/csv")];
    let made = json_of(server.post("/v1/measurements", &headers, b"any"), 201);
    let path = format!("/v1/keys/{id}/rotate");
    let rotated = json_of(as_holder(&server, "POST", &path, &admin, &Value::Null), 200);
    let new = string(&rotated, "key");
    assert_eq!(string(&rotated, "id"), id);
    problem(get(&server, "/v1/measurements", &key), 401);
    let listed = json_of(get(&server, "/v1/measurements", &new), 200);
    assert_eq!(listed["items"][0]["id"], made["id"]);
}

#[test]
fn idempotency_keys_names_and_layouts_of_one_key_mean_nothing_to_another() {
    let server = Server::start();
    let scopes = [Scope::Upload, Scope::Run, Scope::Read];
    let [(_, first), (_, second)] = [server.key(&scopes), server.key(&scopes)];
    let upload = |key: &str, body: &[u8]| {
        let authorization = format!("Bearer {key}");
        let headers = [
            ("authorization", authorization.as_str()),
            ("content-type", "text/csv"),
            ("idempotency-key", "k"),
        ];
        json_of(server.post("/v1/measurements", &headers, body), 201)
    };
    let of_first = upload(&first, b"any");
    assert_eq!(upload(&first, b"any"), of_first);
    assert_ne!(upload(&second, b"any")["id"], of_first["id"]);
    // Nor does the same key with another request tell that it is taken.
    let (_, third) = server.key(&scopes);
    upload(&third, b"other");

    let put = |key: &str, machine: &str| {
        let body = json!({"settings": {"machine": machine}});
        as_holder(&server, "PUT", "/v1/mappings/rig", key, &body).status().as_u16()
    };
    assert_eq!((put(&first, "one"), put(&second, "two"), put(&first, "three")), (201, 201, 200));
    let machine = |key: &str| {
        json_of(get(&server, "/v1/mappings/rig", key), 200)["settings"]["machine"].clone()
    };
    assert_eq!((machine(&first), machine(&second)), (json!("three"), json!("two")));
}

#[test]
fn a_webhook_is_told_what_its_key_may_see_and_nothing_once_that_has_ended() {
    let server = Server::start();
    let (_, rig) = server.key(&[Scope::Upload, Scope::Run, Scope::Read]);
    let (_, stranger) = server.key(&[Scope::Upload, Scope::Run, Scope::Read]);
    let (_, wall) = server.key(&[Scope::Run, Scope::ReadAll]);
    let (ended_id, ended) = server.key(&[Scope::Run, Scope::Admin]);
    let hooks = [&rig, &stranger, &wall, &ended].map(|key| {
        let body = json!({"url": "http://127.0.0.1:9/"});
        string(&json_of(as_holder(&server, "POST", "/v1/webhooks", key, &body), 201), "id")
    });
    server.runtime.block_on(server.service.revoke_key(&ended_id)).unwrap();
    let authorization = format!("Bearer {rig}");
    let headers = [("authorization", authorization.as_str()), ("content-type", "text/csv")];
    let measurement = json_of(server.post("/v1/measurements", &headers, b"any"), 201);
    let body = json!({"measurement_id": measurement["id"], "kind": "identify"});
    let job = string(&json_of(as_holder(&server, "POST", "/v1/jobs", &rig, &body), 202), "id");
    let ended = json_of(get(&server, &format!("/v1/jobs/{job}?wait=60"), &rig), 200);
    assert_eq!(ended["status"], "succeeded");
    server.runtime.block_on(server.service.announce()).unwrap();
    let told = hooks.map(|hook| {
        let all = Reach::everything();
        server.runtime.block_on(server.store.deliveries(&all, &hook, 10)).unwrap().len()
    });
    assert_eq!(told, [1, 0, 1, 0]);
}
