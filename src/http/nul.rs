//! The character NUL, which no text here has: a database cannot keep it in one.

use axum::extract::Request;
use axum::http::StatusCode;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::body;
use super::problem::Problem;

/// Refuses requests with it in their path or query.
pub(super) async fn refused(request: Request, next: Next) -> Response {
    if !request.uri().path_and_query().is_some_and(|address| address.as_str().contains("%00")) {
        return next.run(request).await;
    }
    body::read_on(request).await;
    let detail = "the address has the character NUL (`%00`), which no name or text here has; leave \
                  it out";
    Problem::of_status(StatusCode::BAD_REQUEST, detail).into_response()
}

/// Refuses a JSON document with it in a text or in the name of a member.
///
/// # Errors
/// The problem, with status 422.
pub(super) fn check_json(json: &[u8]) -> Result<(), Box<Problem>> {
    let mut rest = json;
    // In valid JSON a backslash stands in texts alone, and says what the next character is.
    while let Some(at) = rest.iter().position(|byte| *byte == b'\\') {
        let escape = &rest[at + 1..];
        if escape.starts_with(b"u0000") {
            let detail =
                "a text has the character NUL (`\\u0000`), which is not kept; leave it out";
            return Err(Problem::of_status(StatusCode::UNPROCESSABLE_ENTITY, detail));
        }
        rest = escape.get(1..).unwrap_or_default();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nul_is_found_where_it_is_escaped_and_not_where_its_escape_is() {
        for json in [r#"{"a":"\u0000"}"#, r#"{"\u0000":1}"#, r#"["\\\u0000"]"#, r#"["\n\u0000"]"#] {
            assert!(check_json(json.as_bytes()).is_err(), "{json}");
        }
        for json in [r#"{"a":"\\u0000"}"#, r#"["\u0001","u0000"]"#, "{}", r#"["\\"]"#, "\\"] {
            assert!(check_json(json.as_bytes()).is_ok(), "{json}");
        }
    }
}
