//! What each operation of the interface needs, in one list. The router enforces it and the document
//! says it; what is not in the list is for admins.

use std::collections::HashMap;

use axum::http::Method;
use utoipa::openapi::OpenApi;

use crate::service::Scope;

/// What a request needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    /// Nothing: anybody may ask.
    Nothing,
    /// Any valid key.
    Key,
    /// A key with this scope.
    Scope(Scope),
}

/// Addresses of the dashboard's page and of its files, which are the same on every server.
pub(super) const PAGES: [&str; 10] = [
    "/",
    "/measurements/{id}",
    "/jobs/{id}",
    "/batches",
    "/batches/{id}",
    "/compare",
    "/axes",
    "/plans",
    "/together",
    "/assets/{file}",
];

/// Where the document is shown, which is the same on every server.
const DOCUMENTS: &str = "/docs";

const UPLOAD: Need = Need::Scope(Scope::Upload);
const RUN: Need = Need::Scope(Scope::Run);
const READ: Need = Need::Scope(Scope::Read);
const METRICS: Need = Need::Scope(Scope::Metrics);
const ADMIN: Need = Need::Scope(Scope::Admin);

/// Each operation by its id, and what it needs.
const NEEDS: &[(&str, Need)] = &[
    ("add_measurement", UPLOAD),
    ("preview_measurement", UPLOAD),
    ("describe_measurement", UPLOAD),
    ("preview_reading", UPLOAD),
    ("read_again", UPLOAD),
    ("delete_measurement", UPLOAD),
    ("put_mapping", UPLOAD),
    ("delete_mapping", UPLOAD),
    ("submit_job", RUN),
    ("cancel_job", RUN),
    ("delete_job", RUN),
    ("submit_batch", RUN),
    ("cancel_batch", RUN),
    ("delete_batch", RUN),
    ("validate", RUN),
    ("plan", RUN),
    ("plan_excitation", RUN),
    ("plan_figure", RUN),
    ("add_webhook", RUN),
    ("delete_webhook", RUN),
    ("test_webhook", RUN),
    ("list_measurements", READ),
    ("get_measurement", READ),
    ("get_measurement_csv", READ),
    ("get_measurement_json", READ),
    ("get_measurement_figure", READ),
    ("inspect_measurement", READ),
    ("list_mappings", READ),
    ("get_mapping", READ),
    ("get_mapping_toml", READ),
    ("list_jobs", READ),
    ("get_job", READ),
    ("follow_job", READ),
    ("get_result", READ),
    ("get_convergence", READ),
    ("get_convergence_csv", READ),
    ("get_parameters_csv", READ),
    ("get_comparison_csv", READ),
    ("get_plot", READ),
    ("get_report", READ),
    ("list_batches", READ),
    ("get_batch", READ),
    ("list_batch_results", READ),
    ("list_batch_results_csv", READ),
    ("list_results", READ),
    ("list_results_csv", READ),
    ("list_axes", READ),
    ("get_history", READ),
    ("get_history_csv", READ),
    ("get_history_figure", READ),
    ("list_webhooks", READ),
    ("get_webhook", READ),
    ("list_deliveries", READ),
    ("metrics", METRICS),
    ("add_key", ADMIN),
    ("list_keys", ADMIN),
    ("get_key", ADMIN),
    ("rotate_key", ADMIN),
    ("limit_key", ADMIN),
    ("revoke_key", ADMIN),
    ("get_session", Need::Key),
    ("sign_out", Need::Key),
    ("sign_in", Need::Nothing),
    ("live", Need::Nothing),
    ("ready", Need::Nothing),
    ("openapi_document", Need::Nothing),
];

/// What an operation needs; `None`: it is not in the list.
pub(super) fn need(operation_id: &str) -> Option<Need> {
    NEEDS.iter().find(|(known, _)| *known == operation_id).map(|(_, need)| *need)
}

/// What requests need, by method and route.
#[derive(Debug, Clone)]
pub(super) struct Needs(HashMap<(Method, String), Need>);

impl Needs {
    /// Of the operations of a document, and of pages.
    pub(super) fn of(document: &OpenApi) -> Self {
        let mut needs = HashMap::new();
        for (path, item) in &document.paths.paths {
            let operations = [
                (Method::GET, &item.get),
                (Method::PUT, &item.put),
                (Method::POST, &item.post),
                (Method::PATCH, &item.patch),
                (Method::DELETE, &item.delete),
            ];
            for (method, operation) in operations {
                let id = operation.as_ref().and_then(|operation| operation.operation_id.as_deref());
                if let Some(need) = id.and_then(need) {
                    needs.insert((method, path.clone()), need);
                }
            }
        }
        needs.extend(PAGES.map(|page| ((Method::GET, page.to_owned()), Need::Nothing)));
        Self(needs)
    }

    /// What a request needs. `route`: the pattern that its path matches; `None`: there is nothing,
    /// which anybody may know.
    pub(super) fn of_request(&self, method: &Method, route: Option<&str>) -> Need {
        let Some(route) = route else { return Need::Nothing };
        // A request for the headers alone is routed to the same handler.
        let method = if *method == Method::HEAD { Method::GET } else { method.clone() };
        let inside = route.strip_prefix(DOCUMENTS);
        if method == Method::GET
            && inside.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        {
            return Need::Nothing;
        }
        self.0.get(&(method, route.to_owned())).copied().unwrap_or(ADMIN)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::http::openapi;

    #[test]
    fn every_operation_says_what_it_needs_and_no_other_is_in_the_list() {
        let document = serde_json::to_value(openapi()).unwrap();
        let paths = document["paths"].as_object().unwrap().values();
        let operations = paths.flat_map(|item| item.as_object().unwrap().values());
        let ids: BTreeSet<&str> =
            operations.map(|operation| operation["operationId"].as_str().unwrap()).collect();
        let listed: BTreeSet<&str> = NEEDS.iter().map(|(id, _)| *id).collect();
        assert_eq!(listed, ids);
    }

    #[test]
    fn what_changes_something_needs_more_than_reading_and_keys_are_for_admins() {
        let document = serde_json::to_value(openapi()).unwrap();
        for (path, item) in document["paths"].as_object().unwrap() {
            for (method, operation) in item.as_object().unwrap() {
                let id = operation["operationId"].as_str().unwrap();
                let given = need(id).unwrap();
                let fits = match (path.as_str(), method.as_str()) {
                    _ if path.starts_with("/v1/keys") => given == ADMIN,
                    _ if path.starts_with("/v1/session") => given == Need::Key || id == "sign_in",
                    _ if !path.starts_with("/v1/") => [Need::Nothing, METRICS].contains(&given),
                    (_, "get") => given == READ,
                    _ => [UPLOAD, RUN].contains(&given),
                };
                assert!(fits, "{method} {path}: {given:?}");
            }
        }
        assert_eq!(need("metrics"), Some(METRICS));
    }

    #[test]
    fn what_nobody_thought_of_is_for_admins() {
        let needs = Needs::of(&openapi());
        let of = |method, route| needs.of_request(&method, Some(route));
        assert_eq!(of(Method::POST, "/v1/jobs"), RUN);
        assert_eq!(of(Method::HEAD, "/v1/jobs"), READ);
        assert_eq!(of(Method::PATCH, "/v1/jobs"), ADMIN);
        assert_eq!(of(Method::GET, "/v1/secrets"), ADMIN);
        assert_eq!(of(Method::POST, "/"), ADMIN);
        assert_eq!(of(Method::GET, "/"), Need::Nothing);
        assert_eq!(of(Method::GET, "/docs/{*rest}"), Need::Nothing);
        assert_eq!(of(Method::GET, "/docsecret"), ADMIN);
        assert_eq!(needs.of_request(&Method::GET, None), Need::Nothing);
    }
}
