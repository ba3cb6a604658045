//! Examples of requests about keys and sessions, and of their answers.

use serde_json::{Value, json};

use crate::http::keys::{AddedKey, KeyView};
use crate::http::sessions::SessionView;
use crate::service::{Key, Quotas, Scope};

use super::examples::{AT_MS, shown};

const ID: &str = "3f9a1c0b7d2e4856";
const KEY: &str = "sk_servoscope_3f9a1c0b7d2e4856_\
    9b1f0c6e2a7d48530e1c9fb2a46d7835c0e8f1a2b3d49576e8a90b1c2d3e4f5a";

/// What a request may send; `None` for operations that have nothing to do with keys.
pub(super) fn request(operation: &str) -> Option<Value> {
    Some(match operation {
        "add_key" => json!({
            "name": "rig 7", "scopes": ["upload", "run", "read"],
            "expires_at": "2027-03-04T10:20:00Z", "quotas": {"jobs": 20},
        }),
        "limit_key" => json!({"measurements": 5000, "jobs": 20}),
        "sign_in" => json!({"key": KEY}),
        _ => return None,
    })
}

/// What an operation answers where nothing is wrong; `None` as above.
pub(super) fn answer(operation: &str) -> Option<Value> {
    Some(match operation {
        "add_key" | "rotate_key" => shown(AddedKey { stored: key(), key: KEY.into() }),
        "list_keys" => json!({"items": [shown(key())], "next": null}),
        "get_key" | "limit_key" => shown(key()),
        "sign_in" | "get_session" => shown(SessionView { key: Some(key()) }),
        _ => return None,
    })
}

fn key() -> KeyView {
    KeyView::from(Key {
        id: ID.into(),
        name: "rig 7".into(),
        scopes: vec![Scope::Upload, Scope::Run, Scope::Read],
        created_at_ms: AT_MS,
        expires_at_ms: Some(AT_MS + 365 * 24 * 3_600_000),
        revoked_at_ms: None,
        used_at_ms: Some(AT_MS + 86_400_000),
        valid: true,
        quotas: Quotas { jobs: Some(20), ..Quotas::default() },
    })
}
