//! What every list takes: a page, and what its items must match.

use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use crate::store::Millis;

use super::problem::Problem;

/// Items of a page where the request does not say.
pub(super) const DEFAULT_PAGE: u32 = 50;

/// Labels from `name:value`, the form they have in a query.
pub(super) fn labels(texts: &[String]) -> Result<Vec<(String, String)>, Box<Problem>> {
    let pair = |text: &String| match text.split_once(':') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err(Problem::invalid_query(
            "label".into(),
            format!("label: `{text}` is not a name and a value, as in `site:north`"),
        )),
    };
    texts.iter().map(pair).collect()
}

/// What [`labels`] takes, for the document.
pub(super) struct Label;

impl PartialSchema for Label {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new().schema_type(Type::String).pattern(Some("^[^:]+:")).into()
    }
}

impl ToSchema for Label {}

/// A time from RFC 3339.
pub(super) fn time(member: &str, text: Option<&str>) -> Result<Option<Millis>, Box<Problem>> {
    let Some(text) = text else { return Ok(None) };
    match text.parse::<jiff::Timestamp>() {
        Ok(time) => Ok(Some(time.as_millisecond())),
        Err(_) => Err(Problem::invalid_query(
            member.to_owned(),
            format!(
                "{member}: `{text}` is not a time as in `2026-03-04T10:20:00Z`; a `+` in a query \
                 is written `%2B`"
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_split_at_its_first_colon() {
        let labels = labels(&["site:north".into(), "bench:a:2".into()]).unwrap();
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(labels, [pair("site", "north"), pair("bench", "a:2")]);
        assert!(super::labels(&["north".into()]).is_err());
        assert!(super::labels(&[":north".into()]).is_err());
    }

    #[test]
    fn a_time_may_be_of_any_zone() {
        assert_eq!(time("since", Some("1970-01-01T01:00:02+01:00")).unwrap(), Some(2000));
        assert!(time("since", Some("yesterday")).is_err());
    }
}
