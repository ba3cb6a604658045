//! Reading a request's body: to its end, whatever becomes of the request, and as JSON.

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt;
use serde::de::{DeserializeOwned, IgnoredAny};

use super::measurements::media_type;
use super::problem::Problem;

/// How many times the largest body is read before the connection is given up.
const PATIENCE: usize = 8;

/// Reads the body before anything is decided.
///
/// A server that answers and closes while the client still sends makes the client
/// see a broken connection in place of the answer. So a body that is too large is
/// read on and thrown away, within reason, and one that nobody wants is read too.
pub(super) async fn whole(request: Request, next: Next, max_bytes: usize) -> Response {
    let (parts, body) = request.into_parts();
    let header_number = |name| parts.headers.get(name)?.to_str().ok()?.parse::<usize>().ok();
    let declared: Option<usize> = header_number(header::CONTENT_LENGTH);
    // The client asks before it sends: there is nothing to throw away.
    let asks = parts.headers.contains_key(header::EXPECT);
    if asks && declared.is_some_and(|bytes| bytes > max_bytes) {
        return refusal(max_bytes);
    }
    match read(body, max_bytes).await {
        Ok(Some(bytes)) => next.run(Request::from_parts(parts, Body::from(bytes))).await,
        Ok(None) => refusal(max_bytes),
        Err(error) => {
            let detail = format!("the body ends early: {error}");
            Problem::of_status(StatusCode::BAD_REQUEST, detail).into_response()
        }
    }
}

/// A body as what it should say.
pub(super) fn json<T: DeserializeOwned>(
    headers: &HeaderMap,
    body: &[u8],
) -> Result<T, Box<Problem>> {
    let content_type = media_type(headers);
    if content_type != "application/json" {
        return Err(not_read(&content_type, "application/json"));
    }
    serde_json::from_slice::<IgnoredAny>(body).map_err(|error| Problem::malformed_json(&error))?;
    // A list would be taken for the members in the order of this program's type.
    if !body.trim_ascii_start().starts_with(b"{") {
        let detail = "the body is JSON, but not an object";
        return Err(Problem::of_status(StatusCode::UNPROCESSABLE_ENTITY, detail));
    }
    let mut json = serde_json::Deserializer::from_slice(body);
    serde_path_to_error::deserialize(&mut json)
        .map_err(|error| Problem::wrong_json(error.path().to_string(), error.inner()))
}

/// Says that a body of this type is not read, and what is.
pub(super) fn not_read(content_type: &str, readable: &str) -> Box<Problem> {
    let detail = match content_type {
        "" => format!("the request does not say in `Content-Type` what it is; send {readable}"),
        other => format!("`{other}` is not read here; send {readable}"),
    };
    Problem::of_status(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail)
}

/// Says that a body is too large.
pub(super) fn too_large([sent, unpacked]: [usize; 2]) -> String {
    format!("the body is larger than {sent} bytes as sent, or {unpacked} bytes once unpacked")
}

fn refusal(max_bytes: usize) -> Response {
    let detail = format!("the body is larger than {max_bytes} bytes as sent");
    Problem::of_status(StatusCode::PAYLOAD_TOO_LARGE, detail).into_response()
}

/// The whole body, or `None` where it is larger than `max_bytes`.
async fn read(mut body: Body, max_bytes: usize) -> Result<Option<Bytes>, axum::Error> {
    let mut kept = Vec::new();
    let mut seen = 0_usize;
    while let Some(frame) = body.frame().await {
        let Ok(data) = frame?.into_data() else { continue };
        seen = seen.saturating_add(data.len());
        if seen > max_bytes.saturating_mul(PATIENCE) {
            break;
        }
        if seen <= max_bytes {
            kept.extend_from_slice(&data);
        } else {
            kept = Vec::new();
        }
    }
    Ok((seen <= max_bytes).then(|| kept.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_body_is_kept_up_to_the_limit_and_not_beyond() {
        let read = async |length: usize| read(Body::from(vec![7; length]), 10).await.unwrap();
        assert_eq!(read(10).await.as_deref(), Some(&[7; 10][..]));
        assert_eq!(read(11).await, None);
        assert_eq!(read(1000).await, None);
    }
}
