//! Reading a request's body: to its end, whatever becomes of the request, and as JSON.

use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::{Extensions, HeaderMap, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt;
use serde::de::{DeserializeOwned, IgnoredAny};
use tokio::time::{Instant, timeout_at};

use super::measurements::media_type;
use super::memory::{self, Held, Memory};
use super::nul;
use super::problem::Problem;

/// How many times the largest body is read before the connection is given up.
const PATIENCE: usize = 8;

/// What is read of the body of a request that was refused by its head, and for how long.
const LEFT_BYTES: usize = 64 << 10;
const LEFT_TIME: Duration = Duration::from_secs(2);

/// How fast a body must come: whoever sends one holds a connection and memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pace {
    /// How long a client may pause while it sends.
    pub pause: Duration,
    /// Bytes a second that must have come on average once the first pause is over.
    pub bytes_per_s: u32,
}

impl Default for Pace {
    fn default() -> Self {
        // Half of a telephone modem of 1990: no link of today is slower.
        Self { pause: Duration::from_secs(30), bytes_per_s: 500 }
    }
}

/// Marks a request whose body may have so many bytes at most, fewer than those of others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Most(pub(super) usize);

impl Most {
    /// What the body of a request may have, where it is `usual` for others.
    pub(super) fn of(request: &Extensions, usual: usize) -> usize {
        request.get::<Self>().map_or(usual, |Self(most)| usual.min(*most))
    }
}

/// Why a body was not read to its end.
#[derive(Debug)]
enum Unread {
    /// It ends early.
    Cut(axum::Error),
    /// It comes too slowly.
    Slow,
    /// Other bodies take the memory.
    NoMemory,
}

/// Reads the body before anything is decided.
///
/// A server that answers and closes while the client still sends makes the client
/// see a broken connection in place of the answer. So a body that is too large is
/// read on and thrown away, within reason, and one that nobody wants is read too.
pub(super) async fn whole(
    request: Request,
    next: Next,
    max_bytes: usize,
    pace: Pace,
    memory: &Memory,
) -> Response {
    let (parts, body) = request.into_parts();
    let max_bytes = Most::of(&parts.extensions, max_bytes);
    let header_number = |name| parts.headers.get(name)?.to_str().ok()?.parse::<usize>().ok();
    let declared: Option<usize> = header_number(header::CONTENT_LENGTH);
    // The client asks before it sends: there is nothing to throw away.
    let asks = parts.headers.contains_key(header::EXPECT);
    if asks && declared.is_some_and(|bytes| bytes > max_bytes) {
        return refusal(max_bytes);
    }
    let mut held = memory.none(&parts.extensions);
    match read(body, max_bytes, pace, &mut held).await {
        Ok(Some(bytes)) => next.run(Request::from_parts(parts, Body::from(bytes))).await,
        Ok(None) => refusal(max_bytes),
        Err(Unread::Cut(error)) => {
            let detail = format!("the body ends early: {error}");
            Problem::of_status(StatusCode::BAD_REQUEST, detail).into_response()
        }
        Err(Unread::NoMemory) => {
            ([(header::CONNECTION, "close")], memory::refusal()).into_response()
        }
        Err(Unread::Slow) => {
            let detail = format!(
                "the body came too slowly: a client that sends may pause for {} seconds at most, \
                 and must send {} bytes a second on average",
                pace.pause.as_secs_f64(),
                pace.bytes_per_s
            );
            let problem = Problem::of_status(StatusCode::REQUEST_TIMEOUT, detail);
            ([(header::CONNECTION, "close")], problem).into_response()
        }
    }
}

/// Reads on for a moment where a request was refused by its head alone.
///
/// Head and body mostly come as two pieces. A server that closes between them breaks the connection
/// under a client that still sends, and the client may lose the answer. Whoever asks before it sends
/// is not told to.
pub(super) async fn read_on(request: Request) {
    let (parts, body) = request.into_parts();
    throw_away(&parts.headers, body).await;
}

/// The same where the request is answered, but nobody wants its body: the request without it.
pub(super) async fn left_out(request: Request) -> Request {
    let (parts, body) = request.into_parts();
    throw_away(&parts.headers, body).await;
    without(Request::from_parts(parts, Body::empty()))
}

/// A request without its body, of which nothing is read.
pub(super) fn without(mut request: Request) -> Request {
    *request.body_mut() = Body::empty();
    for name in [header::CONTENT_LENGTH, header::CONTENT_ENCODING, header::TRANSFER_ENCODING] {
        request.headers_mut().remove(name);
    }
    request
}

async fn throw_away(headers: &HeaderMap, mut body: Body) {
    if headers.contains_key(header::EXPECT) {
        return;
    }
    let all = async {
        let mut seen = 0;
        while seen < LEFT_BYTES
            && let Some(Ok(frame)) = body.frame().await
        {
            seen += frame.data_ref().map_or(0, Bytes::len);
        }
    };
    // What has not come by then is not waited for.
    let _ = tokio::time::timeout(LEFT_TIME, all).await;
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
    nul::check_json(body)?;
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
async fn read(
    mut body: Body,
    max_bytes: usize,
    pace: Pace,
    held: &mut Held,
) -> Result<Option<Bytes>, Unread> {
    let mut kept = Vec::new();
    let mut seen = 0_usize;
    let began = Instant::now();
    loop {
        let owed = Duration::from_secs_f64(seen as f64 / f64::from(pace.bytes_per_s));
        let deadline = (began + pace.pause + owed).min(Instant::now() + pace.pause);
        let frame = timeout_at(deadline, body.frame()).await.map_err(|_| Unread::Slow)?;
        let Some(frame) = frame else { break };
        let Ok(data) = frame.map_err(Unread::Cut)?.into_data() else { continue };
        seen = seen.saturating_add(data.len());
        if seen > max_bytes.saturating_mul(PATIENCE) {
            break;
        }
        if seen <= max_bytes {
            if !held.grow_to(seen) {
                return Err(Unread::NoMemory);
            }
            kept.extend_from_slice(&data);
        } else {
            kept = Vec::new();
            held.shrink_to(0);
        }
    }
    Ok((seen <= max_bytes).then(|| kept.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_body_is_kept_up_to_the_limit_and_not_beyond() {
        let read = async |length: usize| {
            let mut held = Memory::new(1 << 20, 0).none(&Extensions::new());
            read(Body::from(vec![7; length]), 10, Pace::default(), &mut held).await.unwrap()
        };
        assert_eq!(read(10).await.as_deref(), Some(&[7; 10][..]));
        assert_eq!(read(11).await, None);
        assert_eq!(read(1000).await, None);
    }

    /// A body of `frames` frames of `bytes` bytes, one every `every`.
    fn paced(frames: usize, bytes: usize, every: Duration) -> Body {
        Body::from_stream(futures_util::stream::unfold(0, move |sent| async move {
            tokio::time::sleep(every).await;
            let frame = Ok::<_, std::io::Error>(vec![7_u8; bytes]);
            (sent < frames).then_some((frame, sent + 1))
        }))
    }

    #[tokio::test]
    async fn a_body_that_trickles_or_stops_is_given_up_and_one_on_a_slow_line_is_not() {
        let read = async |frames, bytes, every, pause| {
            let body = paced(frames, bytes, Duration::from_millis(every));
            let pace = Pace { pause: Duration::from_millis(pause), bytes_per_s: 500 };
            let mut held = Memory::new(1 << 20, 0).none(&Extensions::new());
            read(body, 1 << 20, pace, &mut held).await.map(|read| read.map(|bytes| bytes.len()))
        };
        // Longer than one pause may be, but fast enough.
        assert_eq!(read(30, 1000, 50, 1000).await.unwrap(), Some(30_000));
        // Never a long pause, but a byte each time: for an hour, if it were let.
        assert!(matches!(read(180_000, 1, 20, 300).await, Err(Unread::Slow)));
        // Fast enough, but then it pauses.
        assert!(matches!(read(9, 100_000, 400_000, 300).await, Err(Unread::Slow)));
    }
}
