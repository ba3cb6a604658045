//! Which key each operation needs.

use utoipa::openapi::path::Operation;
use utoipa::openapi::security::{
    ApiKey, ApiKeyValue, Http, HttpAuthScheme, SecurityRequirement, SecurityScheme,
};
use utoipa::openapi::{Components, OpenApi};

use crate::http::access::{Need, need};
use crate::http::gate::COOKIE;

/// Names of the two ways to say who one is.
const KEY: &str = "key";
const SESSION: &str = "session";

/// Declares both ways.
pub(super) fn schemes(document: &mut OpenApi) {
    let components = document.components.get_or_insert_with(Components::new);
    let mut bearer = Http::new(HttpAuthScheme::Bearer);
    bearer.bearer_format = Some("sk_servoscope_ID_SECRET".into());
    bearer.description =
        Some("A key. A server that listens on the loopback and has none asks for none.".into());
    components.add_security_scheme(KEY, SecurityScheme::Http(bearer));
    let description = "The cookie of a browser that was signed in by `POST /v1/session`.";
    let cookie = ApiKeyValue::with_description(COOKIE, description);
    components.add_security_scheme(SESSION, SecurityScheme::ApiKey(ApiKey::Cookie(cookie)));
}

/// Says what an operation needs.
pub(super) fn declare(operation: &mut Operation) {
    let need = operation.operation_id.as_deref().and_then(need);
    let scopes: Vec<&str> = match need {
        Some(Need::Scope(scope)) => vec![scope.name()],
        Some(Need::Key) => Vec::new(),
        Some(Need::Nothing) | None => {
            operation.security = Some(Vec::new());
            return;
        }
    };
    let ways = [KEY, SESSION].map(|way| SecurityRequirement::new(way, scopes.clone()));
    operation.security = Some(ways.to_vec());
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use crate::http::openapi;

    #[test]
    fn an_operation_says_which_scope_it_needs_of_which_scheme() {
        let document = serde_json::to_value(openapi()).unwrap();
        let of = |path: &str, method: &str| document["paths"][path][method]["security"].clone();
        assert_eq!(of("/v1/jobs", "post"), json!([{"key": ["run"]}, {"session": ["run"]}]));
        assert_eq!(of("/v1/session", "get"), json!([{"key": []}, {"session": []}]));
        assert_eq!(of("/livez", "get"), json!([]));
        let schemes = &document["components"]["securitySchemes"];
        assert_eq!(
            (&schemes["key"]["type"], &schemes["key"]["scheme"]),
            (&json!("http"), &json!("bearer"))
        );
        assert_eq!(schemes["session"]["in"], "cookie");
    }
}
