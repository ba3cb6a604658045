//! The part of an address behind the question mark.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde::de::DeserializeOwned;

use super::problem::Problem;

/// A query as a value; a name may be given several times. What is not understood is
/// refused by its name, and so is a name without a value: it could be taken for one that is left out,
/// and a filter without a value would let everything through.
pub(super) struct Query<T>(pub(super) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequestParts<S> for Query<T> {
    type Rejection = Box<Problem>;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Box<Problem>> {
        match axum_extra::extract::Query::from_request_parts(parts, state).await {
            Ok(axum_extra::extract::Query(value)) => match empty(parts.uri.query()) {
                None => Ok(Self(value)),
                Some(name) => {
                    let detail = format!("{name}: it has no value; give it one, or leave it out");
                    Err(Problem::invalid_query(name, detail))
                }
            },
            Err(rejection) => Err(refused(&rejection.body_text())),
        }
    }
}

/// The first name that has no value.
fn empty(query: Option<&str>) -> Option<String> {
    let pairs = query.unwrap_or_default().split('&').filter(|pair| !pair.is_empty());
    let mut pairs = pairs.map(|pair| pair.split_once('=').unwrap_or((pair, "")));
    let (name, _) = pairs.find(|(_, value)| value.is_empty())?;
    Some(percent_encoding::percent_decode_str(name).decode_utf8_lossy().into_owned())
}

/// Of the words of the parser, those a caller can use: `name: what is wrong`.
fn refused(text: &str) -> Box<Problem> {
    let said = text.strip_prefix("Failed to deserialize query string: ").unwrap_or(text);
    let said = said.replace("invalid digit found in string", "it is not a whole number from 0 on");
    let member = said.split_once(": ").map_or("", |(member, _)| member).to_owned();
    Problem::invalid_query(member, said)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_a_value_is_found() {
        for (query, name) in [
            ("changed=", Some("changed")),
            ("limit=5&changed", Some("changed")),
            ("a%20b=&limit=5", Some("a b")),
            ("limit=5&changed=true&", None),
            ("", None),
        ] {
            assert_eq!(empty(Some(query)).as_deref(), name, "{query}");
        }
        assert_eq!(empty(None), None);
    }

    #[test]
    fn a_refusal_names_what_is_wrong_and_not_the_parser() {
        let text = "Failed to deserialize query string: limit: invalid digit found in string";
        let expected = Problem::invalid_query(
            "limit".into(),
            "limit: it is not a whole number from 0 on".into(),
        );
        assert_eq!(refused(text), expected);
    }
}
