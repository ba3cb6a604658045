//! Examples of requests about webhooks, and of their answers.

use serde_json::{Value, json};

use crate::http::webhooks::{Delivery, TestedWebhook, WebhookView};
use crate::service::{EventType, Tested, Webhook};
use crate::store::DeliveryRow;

use super::examples::{AT_MS, shown};

const URL: &str = "https://mes.example/servoscope";

/// What a request may send; `None` for operations that have nothing to do with webhooks.
pub(super) fn request(operation: &str) -> Option<Value> {
    (operation == "add_webhook").then(|| json!({"url": URL, "events": ["axis.changed"]}))
}

/// What an operation answers where nothing is wrong; `None` as above.
pub(super) fn answer(operation: &str) -> Option<Value> {
    let list = |item: Value| json!({"items": [item], "next": null});
    Some(match operation {
        "add_webhook" => {
            let mut added = webhook();
            added["secret"] = json!("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw");
            added
        }
        "list_webhooks" => list(webhook()),
        "get_webhook" => webhook(),
        "test_webhook" => {
            let tested = Tested { answered: Some(204), error: None, seconds: 0.042 };
            shown(TestedWebhook::from(tested))
        }
        "list_deliveries" => list(delivery()),
        _ => return None,
    })
}

fn webhook() -> Value {
    shown(WebhookView::from(Webhook {
        id: "019ac0de-7a11-7000-8000-000000000001".into(),
        created_at_ms: AT_MS,
        url: URL.into(),
        events: vec![EventType::AxisChanged],
        disabled: None,
    }))
}

fn delivery() -> Value {
    shown(Delivery::from(DeliveryRow {
        id: "msg_019ac0de7a1170008000000000000002".into(),
        event: "axis.changed".into(),
        status: "waiting".into(),
        attempts: 1,
        created_at_ms: AT_MS,
        due_ms: AT_MS + 5000,
        ended_at_ms: None,
        answered: Some(503),
        error: Some("the receiver answered 503".into()),
    }))
}
