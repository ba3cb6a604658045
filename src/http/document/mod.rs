//! What the document of the interface teaches beside its types: an example of every request and
//! answer, every status with its types of problem, and what a request needs.

mod batches;
mod examples;
mod keys;
mod problems;
mod security;
mod webhooks;

use serde_json::Value;
use utoipa::openapi::path::{Operation, ParameterIn, PathItem};
use utoipa::openapi::schema::{ArrayItems, Object, Schema, SchemaType, Type};
use utoipa::openapi::{OpenApi, RefOr};

/// What a method does to an operation of the document.
pub(super) enum Effect {
    /// It reads.
    Reads,
    /// It writes.
    Writes,
}

/// Adds it to the document that is made of the handlers.
pub(super) fn teach(document: &mut OpenApi) {
    security::schemes(document);
    for (path, item) in &mut document.paths.paths {
        for (effect, operation) in operations(item) {
            problems::declare(path, &effect, operation);
            security::declare(operation);
            need_values(operation);
            show(operation);
        }
    }
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = (Effect, &mut Operation)> {
    let PathItem { get, put, post, patch, delete, .. } = item;
    let reads = get.iter_mut().map(|operation| (Effect::Reads, operation));
    let writes = [put, post, patch, delete].into_iter().flatten();
    reads.chain(writes.map(|operation| (Effect::Writes, operation)))
}

/// Says of every text of a query that it is not empty, see [`Query`](super::query::Query), and of
/// every header that it is not null.
fn need_values(operation: &mut Operation) {
    for parameter in operation.parameters.iter_mut().flatten() {
        let RefOr::T(parameter) = parameter else { continue };
        if let (ParameterIn::Header, Some(RefOr::T(Schema::Object(header)))) =
            (&parameter.parameter_in, &mut parameter.schema)
        {
            is_something(header);
        }
        if parameter.parameter_in != ParameterIn::Query {
            continue;
        }
        match &mut parameter.schema {
            Some(RefOr::T(Schema::Object(text))) => need_value(text),
            Some(RefOr::T(Schema::Array(list))) => {
                if let ArrayItems::RefOrSchema(item) = &mut list.items
                    && let RefOr::T(Schema::Object(text)) = &mut **item
                {
                    need_value(text);
                }
            }
            _ => {}
        }
    }
}

fn need_value(text: &mut Object) {
    let is_text = match &text.schema_type {
        SchemaType::Type(kind) => *kind == Type::String,
        SchemaType::Array(kinds) => kinds.contains(&Type::String),
        SchemaType::AnyValue => false,
    };
    if is_text {
        text.min_length = Some(1);
    }
}

/// A header that is left out is not null: it is not there.
fn is_something(header: &mut Object) {
    if let SchemaType::Array(kinds) = &mut header.schema_type {
        kinds.retain(|kind| *kind != Type::Null);
        if let [kind] = &kinds[..] {
            header.schema_type = SchemaType::Type(kind.clone());
        }
    }
}

/// Adds the examples, and the descriptions that every answer must have.
fn show(operation: &mut Operation) {
    let id = operation.operation_id.clone().unwrap_or_default();
    let summary = operation.summary.clone().unwrap_or_default();
    if let Some(RefOr::T(body)) = &mut operation.request_body {
        for (media_type, content) in &mut body.content {
            set(content, examples::request(&id, media_type));
        }
    }
    for (status, response) in &mut operation.responses.responses {
        let RefOr::T(response) = response else { continue };
        if response.description.is_empty() {
            response.description = summary.trim_end_matches('.').to_owned();
        }
        if status.starts_with('2') {
            for (media_type, content) in &mut response.content {
                set(content, examples::answer(&id, media_type));
            }
        }
    }
}

fn set(content: &mut RefOr<utoipa::openapi::Content>, example: Option<Value>) {
    if let RefOr::T(content) = content {
        content.example = example;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::openapi;
    use crate::http::problem::MEDIA_TYPE;

    /// Bodies that no text can show.
    const BYTES: [&str; 2] = [
        "application/octet-stream",
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    ];

    fn document() -> Value {
        serde_json::to_value(openapi()).unwrap()
    }

    /// Path and method of every operation, and the operation.
    fn all(document: &Value) -> Vec<(String, &Value)> {
        let paths = document["paths"].as_object().unwrap();
        let methods = paths.iter().flat_map(|(path, item)| {
            let methods = item.as_object().unwrap().iter();
            methods.map(move |(method, operation)| (format!("{method} {path}"), operation))
        });
        methods.collect()
    }

    fn members(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
        value.as_object().into_iter().flatten()
    }

    #[test]
    fn every_request_and_every_answer_has_an_example_and_a_type() {
        let document = document();
        assert!(all(&document).len() > 30);
        for (name, operation) in all(&document) {
            let body = &operation["requestBody"]["content"];
            let answers =
                members(&operation["responses"]).filter(|(status, _)| *status < &"300".to_owned());
            let answers = answers.flat_map(|(_, answer)| members(&answer["content"]));
            for (media_type, content) in members(body).chain(answers) {
                assert!(content["schema"].is_object(), "{name}, {media_type}: no type");
                let shown = content.get("example").is_some_and(|example| !example.is_null());
                assert!(
                    shown || BYTES.contains(&media_type.as_str()),
                    "{name}, {media_type}: no example"
                );
            }
        }
    }

    #[test]
    fn every_status_is_described_and_every_error_has_its_types_of_problem() {
        let document = document();
        for (name, operation) in all(&document) {
            for (status, answer) in members(&operation["responses"]) {
                let described = answer["description"].as_str().is_some_and(|text| !text.is_empty());
                assert!(described, "{name}, {status}: no description");
                let status: u16 = status.parse().unwrap_or_else(|_| panic!("{name}: {status}"));
                if status < 400 {
                    continue;
                }
                let shown = &answer["content"][MEDIA_TYPE]["examples"];
                assert!(members(shown).count() > 0, "{name}, {status}: no problem");
                for (kind, example) in members(shown) {
                    assert_eq!(example["value"]["status"], status, "{name}, {kind}");
                    assert!(example["value"]["type"].is_string(), "{name}, {kind}");
                }
            }
            let is_service = !name.contains(" /v1/");
            let fails = operation["responses"].get("503").is_some();
            assert!(is_service || fails, "{name}: a database that does not answer");
        }
    }

    #[test]
    fn every_text_of_a_query_has_a_character() {
        let document = document();
        let mut texts = 0;
        for (name, operation) in all(&document) {
            let parameters = operation["parameters"].as_array().into_iter().flatten();
            for parameter in parameters.filter(|parameter| parameter["in"] == "query") {
                let schema = &parameter["schema"];
                let kinds = schema["type"].to_string() + &schema["items"]["type"].to_string();
                if kinds.contains("\"string\"") {
                    let least = [&schema["minLength"], &schema["items"]["minLength"]];
                    assert!(least.contains(&&Value::from(1)), "{name}: {parameter}");
                    texts += 1;
                }
            }
        }
        assert!(texts > 30, "{texts}");
    }

    #[test]
    fn uploads_are_files() {
        let document = document();
        for path in ["/v1/measurements", "/v1/preview"] {
            let content = &document["paths"][path]["post"]["requestBody"]["content"];
            for (media_type, content) in members(content) {
                let name = content["schema"]["$ref"].as_str().unwrap().rsplit('/').next().unwrap();
                let schema = &document["components"]["schemas"][name];
                let file = match media_type.as_str() {
                    "multipart/form-data" => &schema["properties"]["file"]["items"],
                    _ => schema,
                };
                assert_eq!(file["format"], "binary", "{path}, {media_type}: {schema}");
            }
        }
    }

    /// What is wrong with a value as one of a type.
    fn fault(value: &Value, schema: &Value, schemas: &Value) -> Option<String> {
        if let Some(name) = schema["$ref"].as_str() {
            return fault(value, &schemas[name.rsplit('/').next().unwrap()], schemas);
        }
        for key in ["oneOf", "anyOf"] {
            if let Some(choices) = schema[key].as_array() {
                let faults = choices.iter().map(|choice| fault(value, choice, schemas));
                let faults: Option<Vec<String>> = faults.collect();
                return faults.map(|faults| faults.join(" or "));
            }
        }
        let types = match &schema["type"] {
            Value::Array(types) => types.clone(),
            Value::Null => return None,
            one => vec![one.clone()],
        };
        let is = |name: &str| match name {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "boolean" => value.is_boolean(),
            _ => value.is_null(),
        };
        if !types.iter().any(|name| is(name.as_str().unwrap())) {
            return Some(format!("{value} is not {types:?}"));
        }
        if let Some(items) = value.as_array().filter(|_| schema["items"].is_object()) {
            return items.iter().find_map(|item| fault(item, &schema["items"], schemas));
        }
        let properties = schema["properties"].as_object()?;
        let object = value.as_object()?;
        let unknown = object.keys().find(|key| !properties.contains_key(*key));
        let required = schema["required"].as_array().into_iter().flatten();
        let mut missing = required.filter(|key| !object.contains_key(key.as_str().unwrap()));
        unknown
            .map(|key| format!("{key} is unknown"))
            .or_else(|| missing.next().map(|key| format!("{key} is missing")))
            .or_else(|| {
                let of = |(key, value)| {
                    fault(value, &properties[key], schemas).map(|fault| format!("{key}: {fault}"))
                };
                object.iter().find_map(of)
            })
    }

    #[test]
    fn every_example_is_of_its_type() {
        let document = document();
        let schemas = &document["components"]["schemas"];
        for (name, operation) in all(&document) {
            let body = members(&operation["requestBody"]["content"]);
            let answers = members(&operation["responses"]);
            let answers = answers.flat_map(|(_, answer)| members(&answer["content"]));
            for (media_type, content) in body.chain(answers) {
                let several = members(&content["examples"]).map(|(_, example)| &example["value"]);
                for example in content.get("example").into_iter().chain(several) {
                    let fault = fault(example, &content["schema"], schemas);
                    assert_eq!(fault, None, "{name}, {media_type}");
                }
            }
        }
    }
}
