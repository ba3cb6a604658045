//! Documents that a client may keep: results, tables, figures, pages.

use std::borrow::Cow;

use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// What an answer depends on beside its address: who asks.
const BY_CALLER: &str = "authorization, cookie";

/// What is made of a job that has ended stays the same but for new versions of
/// the service.
pub(super) const SETTLED: &str = "private, max-age=3600";

/// What goes with a document.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept<'p> {
    /// Its media type.
    pub(super) media_type: &'static str,
    /// What it may do in a browser.
    pub(super) policy: &'p str,
    /// How long it may be kept without asking again.
    pub(super) caching: &'static str,
}

/// Answers with a document that may style itself, or with 304 where the request
/// names it by its tag. `settled`: it will stay as it is.
pub(super) fn answer(
    request: &HeaderMap,
    media_type: &'static str,
    document: String,
    settled: bool,
) -> Response {
    let caching = if settled { SETTLED } else { "no-cache" };
    // It may have the styles that it carries and nothing more: no script, no other file.
    let styles = styles(&document);
    let policy = format!("default-src 'none'; style-src {styles}; frame-ancestors 'none'; sandbox");
    keep(request, Kept { media_type, policy: &policy, caching }, document.into())
}

/// The style sheets in a document, as its policy names them.
pub(super) fn styles(document: &str) -> String {
    let parts = document.split("<style>").skip(1);
    let sheets = parts.filter_map(|part| Some(part.split_once("</style>")?.0));
    let mut named: Vec<String> = sheets.map(digest).collect();
    named.sort_unstable();
    named.dedup();
    if named.is_empty() { "'none'".into() } else { named.join(" ") }
}

/// A text in a document, as the document's policy names it.
pub(super) fn digest(text: &str) -> String {
    format!("'sha256-{}'", BASE64_STANDARD.encode(Sha256::digest(text)))
}

/// The same for any document.
pub(super) fn keep(request: &HeaderMap, kept: Kept<'_>, document: Cow<'static, str>) -> Response {
    // Weak: the bytes on the wire may be compressed.
    let digest = Sha256::digest(document.as_bytes());
    let tag: String = digest[..12].iter().map(|byte| format!("{byte:02x}")).collect();
    let tag = format!("W/\"{tag}\"");
    let caching = [
        (header::CACHE_CONTROL, kept.caching),
        (header::VARY, BY_CALLER),
        (header::ETAG, tag.as_str()),
    ];
    // What comes with a 304 takes the place of what came with the document (RFC 9111, 4.3.4).
    let policy = [(header::CONTENT_SECURITY_POLICY, kept.policy)];
    if is_named(request, &tag) {
        return (StatusCode::NOT_MODIFIED, caching, policy).into_response();
    }
    (caching, policy, [(header::CONTENT_TYPE, kept.media_type)], document).into_response()
}

/// Whether a request says that its sender has the document with this tag. The
/// comparison is the weak one, as `If-None-Match` wants it (RFC 9110, 13.1.2).
fn is_named(request: &HeaderMap, tag: &str) -> bool {
    let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
    let lines = request.get_all(header::IF_NONE_MATCH).iter();
    let tags = lines.filter_map(|line| line.to_str().ok()).flat_map(|line| line.split(','));
    tags.map(opaque).any(|named| named == "*" || named == opaque(tag))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_policy_names_every_style_sheet_of_a_document_once_and_nothing_else() {
        assert_eq!(styles("a,b\n"), "'none'");
        assert_eq!(styles("<svg><style>a{}"), "'none'");
        let a = digest("a{}");
        let twice = "<style>a{}</style><p>b{}</p><svg><style>a{}</style></svg>";
        assert_eq!(styles(twice), a);
        let both = styles("<style>a{}</style><style>\nb{}\n</style>");
        assert!(both.contains(&a) && both.contains(&digest("\nb{}\n")), "{both}");
        assert_eq!(digest(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
    }

    #[test]
    fn a_document_is_named_by_its_tag_weak_or_strong_alone_or_among_others() {
        for (line, named) in [
            ("W/\"a1\"", true),
            ("\"a1\"", true),
            ("\"b2\", W/\"a1\"", true),
            ("*", true),
            ("a1", false),
            ("\"b2\"", false),
            ("", false),
        ] {
            let request = HeaderMap::from_iter([(header::IF_NONE_MATCH, line.parse().unwrap())]);
            assert_eq!(is_named(&request, "W/\"a1\""), named, "{line}");
        }
        assert!(!is_named(&HeaderMap::new(), "W/\"a1\""));
    }
}
