//! The part of an address behind the question mark.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde::de::DeserializeOwned;

use super::problem::Problem;

/// A query as a value; a name may be given several times. What is not understood is
/// refused by its name.
pub(super) struct Query<T>(pub(super) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequestParts<S> for Query<T> {
    type Rejection = Box<Problem>;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Box<Problem>> {
        match axum_extra::extract::Query::from_request_parts(parts, state).await {
            Ok(axum_extra::extract::Query(value)) => Ok(Self(value)),
            Err(rejection) => Err(refused(&rejection.body_text())),
        }
    }
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
    fn a_refusal_names_what_is_wrong_and_not_the_parser() {
        let text = "Failed to deserialize query string: limit: invalid digit found in string";
        let expected = Problem::invalid_query(
            "limit".into(),
            "limit: it is not a whole number from 0 on".into(),
        );
        assert_eq!(refused(text), expected);
    }
}
