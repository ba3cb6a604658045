//! Requests to a server, each of which may be sent several times.

use reqwest::multipart::{Form, Part};
use reqwest::{Method, RequestBuilder, header};

/// A request, which may be sent several times.
#[derive(Debug, Clone)]
pub(super) struct Request {
    pub(super) method: Method,
    pub(super) path: String,
    /// Idempotency key.
    pub(super) key: Option<String>,
    body: Body,
}

#[derive(Debug, Clone)]
enum Body {
    None,
    Json(String),
    /// A file, and what is given beside it.
    File {
        name: String,
        bytes: Vec<u8>,
        given: Vec<(String, String)>,
    },
}

impl Request {
    pub(super) fn get(path: impl Into<String>) -> Self {
        Self { method: Method::GET, path: path.into(), key: None, body: Body::None }
    }

    pub(super) fn post(path: impl Into<String>) -> Self {
        Self { method: Method::POST, ..Self::get(path) }
    }

    pub(super) fn json(self, text: String) -> Self {
        Self { body: Body::Json(text), ..self }
    }

    pub(super) fn file(self, name: String, bytes: Vec<u8>, given: Vec<(String, String)>) -> Self {
        Self { body: Body::File { name, bytes, given }, ..self }
    }

    /// The same with an idempotency key.
    pub(super) fn keyed(self, key: String) -> Self {
        Self { key: Some(key), ..self }
    }

    /// Gives a request its body.
    pub(super) fn body(&self, builder: RequestBuilder) -> RequestBuilder {
        match &self.body {
            Body::None => builder,
            Body::Json(text) => {
                builder.header(header::CONTENT_TYPE, "application/json").body(text.clone())
            }
            Body::File { name, bytes, given } => {
                let file = Part::bytes(bytes.clone()).file_name(name.clone());
                let form = Form::new().part("file", file);
                let given = given.iter().cloned();
                builder.multipart(given.fold(form, |form, (key, value)| form.text(key, value)))
            }
        }
    }
}

/// An id as a part of a path.
pub(super) fn segment(id: &str) -> String {
    percent_encoding::utf8_percent_encode(id, percent_encoding::NON_ALPHANUMERIC).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_stays_within_its_part_of_a_path() {
        assert_eq!(segment("019a9c1e"), "019a9c1e");
        assert_eq!(segment("../jobs?x"), "%2E%2E%2Fjobs%3Fx");
    }
}
