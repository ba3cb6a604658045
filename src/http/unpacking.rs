//! Unpacks request bodies that are sent with gzip.

use std::io::{self, Read};

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use flate2::bufread::MultiGzDecoder;
use http_body_util::BodyExt;

use super::body::Most;
use super::memory::{self, Memory};
use super::problem::Problem;

/// A byte of deflate stands for no more bytes than this (zlib's documentation: 1032 to 1).
const MOST_EXPANDED: usize = 1032;

/// How a body is encoded.
#[derive(Debug, PartialEq)]
enum Encoding {
    Identity,
    Gzip,
    Other,
}

/// The encoding that `Content-Encoding` names (RFC 9110, section 8.4): case does not matter, and
/// `x-gzip` is gzip.
fn encoding(headers: &HeaderMap) -> Encoding {
    let values = headers.get_all(header::CONTENT_ENCODING).iter();
    let names: Vec<String> = values
        .flat_map(|value| value.to_str().unwrap_or("unreadable").split(','))
        .map(|name| name.trim().to_ascii_lowercase())
        .filter(|name| !name.is_empty() && name != "identity")
        .collect();
    match names.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Encoding::Identity,
        ["gzip" | "x-gzip"] => Encoding::Gzip,
        _ => Encoding::Other,
    }
}

/// Passes a request on with its body unpacked.
///
/// A body of more than `max_bytes` once unpacked is answered with 413, one that is not whole gzip
/// members from its first byte to its last with 400, and any other encoding with 415.
pub(super) async fn unpacked(
    request: Request,
    next: Next,
    max_bytes: usize,
    memory: &Memory,
) -> Response {
    match encoding(request.headers()) {
        Encoding::Identity => return next.run(request).await,
        Encoding::Other => {
            let accepted = [(header::ACCEPT_ENCODING, "gzip")];
            return (StatusCode::UNSUPPORTED_MEDIA_TYPE, accepted).into_response();
        }
        Encoding::Gzip => {}
    }
    let (mut parts, body) = request.into_parts();
    let packed = match body.collect().await {
        Ok(body) => body.to_bytes(),
        Err(error) => return not_gzip(&error),
    };
    let max_bytes = Most::of(&parts.extensions, max_bytes);
    let mut held = memory.none(&parts.extensions);
    if !held.grow_to(packed.len().saturating_mul(MOST_EXPANDED).min(max_bytes)) {
        return memory::refusal().into_response();
    }
    let unpacking = tokio::task::spawn_blocking(move || members(&packed, max_bytes));
    let body = match unpacking.await.unwrap_or_else(|error| Err(io::Error::other(error))) {
        Ok(Some(body)) => body,
        Ok(None) => {
            let detail = format!("the body is larger than {max_bytes} bytes once unpacked");
            return Problem::of_status(StatusCode::PAYLOAD_TOO_LARGE, detail).into_response();
        }
        Err(error) => return not_gzip(&error),
    };
    held.shrink_to(body.len());
    parts.headers.remove(header::CONTENT_ENCODING);
    parts.headers.insert(header::CONTENT_LENGTH, body.len().into());
    next.run(Request::from_parts(parts, Body::from(body))).await
}

fn not_gzip(error: &dyn std::error::Error) -> Response {
    let detail = format!(
        "the body is not the gzip that `Content-Encoding` says, from its first byte to its last: \
         {error}; send it again"
    );
    Problem::of_status(StatusCode::BAD_REQUEST, detail).into_response()
}

/// The content of all gzip members, one after the other (RFC 1952); `None` if it is larger than
/// `max_bytes`.
fn members(packed: &[u8], max_bytes: usize) -> io::Result<Option<Bytes>> {
    let mut content = Vec::new();
    let most = u64::try_from(max_bytes).unwrap_or(u64::MAX).saturating_add(1);
    MultiGzDecoder::new(packed).take(most).read_to_end(&mut content)?;
    Ok((content.len() <= max_bytes).then(|| content.into()))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn packed(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    #[tokio::test]
    async fn a_body_is_unpacked_where_there_is_memory_for_it_and_not_before() {
        use axum::Router;
        use axum::http::Extensions;
        use axum::middleware::from_fn;
        use axum::routing::post;
        use tower_service::Service as _;

        // Memory is given in pieces: this is one.
        let memory = Memory::new(1, 1);
        let own = memory.clone();
        let mut router = Router::new().route("/", post(|body: String| async { body })).layer(
            from_fn(move |request: Request, next: Next| {
                let memory = own.clone();
                async move { unpacked(request, next, 100, &memory).await }
            }),
        );
        let mut status = async || {
            let request = Request::post("/").header(header::CONTENT_ENCODING, "gzip");
            let request = request.body(Body::from(packed(b"one"))).unwrap();
            router.call(request).await.unwrap().status()
        };
        let mut other = memory.none(&Extensions::new());
        assert!(other.grow_to(1));
        assert_eq!(status().await, StatusCode::SERVICE_UNAVAILABLE);
        drop(other);
        assert_eq!(status().await, StatusCode::OK);
        assert_eq!(status().await, StatusCode::OK, "it is given back");
    }

    #[test]
    fn all_members_are_read_up_to_the_limit() {
        let two = [packed(b"one,"), packed(b"two")].concat();
        assert_eq!(members(&two, 7).unwrap().as_deref(), Some(&b"one,two"[..]));
        assert_eq!(members(&two, 6).unwrap(), None);
        // The end of a block-gzipped file is an empty member.
        let ended = [packed(b"one"), packed(b"")].concat();
        assert_eq!(members(&ended, 7).unwrap().as_deref(), Some(&b"one"[..]));
    }

    #[test]
    fn what_is_no_whole_member_is_refused_wherever_it_is() {
        let one = packed(b"one");
        for tail in [
            &b"x"[..],
            b"\0",
            b"\0\0\0\0\0\0\0\0\0\0\0\0\0",
            b"no gzip at all",
            &one[..5],
            &one[..one.len() - 1],
        ] {
            assert!(members(&[&one[..], tail].concat(), 100).is_err(), "{tail:?}");
        }
        assert!(members(b"", 100).is_err());
    }

    #[test]
    fn the_name_of_an_encoding_is_read_in_any_case() {
        let of = |values: &[&'static str]| {
            let mut headers = HeaderMap::new();
            for value in values {
                headers.append(header::CONTENT_ENCODING, value.parse().unwrap());
            }
            encoding(&headers)
        };
        for values in [&["gzip"][..], &["GZIP"], &["x-gzip"], &["X-Gzip"], &["identity, gzip"]] {
            assert_eq!(of(values), Encoding::Gzip, "{values:?}");
        }
        for values in [&[][..], &[""], &["Identity"]] {
            assert_eq!(of(values), Encoding::Identity, "{values:?}");
        }
        for values in [&["br"][..], &["gzip, gzip"], &["gzip", "br"], &["gzipped"]] {
            assert_eq!(of(values), Encoding::Other, "{values:?}");
        }
    }
}
