//! Who may pass: each request with a key or a session, held against what it needs.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tracing::Span;

use crate::service::{Caller, Key, Service, ServiceError};

use super::access::{Need, Needs};
use super::body;
use super::callers::SEC_FETCH_SITE;
use super::problem::Problem;
use super::rates::Rates;

/// Name of the cookie that holds a session.
pub(super) const COOKIE: &str = "servoscope_session";

/// What lets requests pass.
#[derive(Clone)]
pub(super) struct Gate {
    /// The service, for nobody in particular.
    pub(super) service: Service,
    /// What each request needs.
    pub(super) needs: Arc<Needs>,
    /// How often a key may ask.
    pub(super) rates: Arc<Rates>,
    /// Whether a key is needed also while none is stored.
    pub(super) always: bool,
}

/// What a request brings along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Credential<'a> {
    Key(&'a str),
    Session(&'a str),
}

/// Lets a request through with the service for its caller, or refuses it.
pub(super) async fn admit(State(gate): State<Gate>, mut request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>();
    let need = gate.needs.of_request(request.method(), route.map(MatchedPath::as_str));
    match gate.caller(need, request.method(), request.headers()).await {
        Ok(caller) => {
            if let Some(key) = caller.key() {
                Span::current().record("key", &key.id);
            }
            request.extensions_mut().insert(gate.service.on_behalf_of(caller));
            next.run(request).await
        }
        Err(problem) => {
            body::read_on(request).await;
            problem.into_response()
        }
    }
}

impl Gate {
    async fn caller(
        &self,
        need: Need,
        method: &Method,
        headers: &HeaderMap,
    ) -> Result<Caller, Box<Problem>> {
        if need == Need::Nothing {
            return Ok(Caller::Nobody);
        }
        if !self.always && !self.service.has_keys().await? {
            return Ok(Caller::Everybody);
        }
        let key = match credential(headers) {
            Some(Credential::Key(key)) => self.service.holder_of(key).await?,
            Some(Credential::Session(secret)) => {
                if !method.is_safe() && !names_its_page(headers) {
                    let detail = "a change by a browser that is signed in must say which page it \
                                  comes from, in `Origin` or `Sec-Fetch-Site`; programs send a \
                                  key as `Authorization: Bearer` instead";
                    return Err(Problem::of_status(StatusCode::FORBIDDEN, detail));
                }
                self.service.signed_in(secret).await?
            }
            None => {
                let reason = "this server asks for a key";
                return Err(ServiceError::Unrecognised { reason }.into());
            }
        };
        match need {
            Need::Scope(scope) if !key.may(scope) => {
                let Key { name, scopes, .. } = key;
                Err(ServiceError::Lacking { name, scope, scopes }.into())
            }
            _ => {
                self.count(&key)?;
                Ok(Caller::Holder(Box::new(key)))
            }
        }
    }
}

impl Gate {
    /// Counts a request of a key.
    fn count(&self, key: &Key) -> Result<(), Box<Problem>> {
        let Some((most, by)) = self.service.quotas_of(key).requests_per_minute() else {
            return Ok(());
        };
        let Err(wait_s) = self.rates.take(&key.id, most, Instant::now()) else { return Ok(()) };
        let reason = format!("may ask {most} times a minute ({by}) and has; wait {wait_s} s");
        let (name, wait_s) = (key.name.clone(), Some(wait_s));
        Err(ServiceError::OverQuota { name, reason, wait_s }.into())
    }
}

/// A key goes before a session: whoever sends both means the key.
fn credential(headers: &HeaderMap) -> Option<Credential<'_>> {
    let authorization = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    // A proxy in front may have a scheme of its own.
    let bearer = authorization.and_then(|value| value.split_once(' '));
    if let Some((_, key)) = bearer.filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer")) {
        return Some(Credential::Key(key.trim()));
    }
    session(headers).map(Credential::Session)
}

/// What the cookie of a signed-in browser holds.
pub(super) fn session(headers: &HeaderMap) -> Option<&str> {
    let lines = headers.get_all(header::COOKIE).iter().filter_map(|line| line.to_str().ok());
    let mut pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.split_once('='));
    pairs.find(|(name, _)| name.trim() == COOKIE).map(|(_, value)| value.trim())
}

/// The cookie for so many seconds. No script reads it, and no other site makes a browser send it.
pub(super) fn cookie(secret: &str, seconds: u64, headers: &HeaderMap) -> String {
    let secure = if is_behind_https(headers) { "; Secure" } else { "" };
    format!("{COOKIE}={secret}; Path=/; Max-Age={seconds}; HttpOnly; SameSite=Strict{secure}")
}

/// Whether the page that sent a request came over https: what ends TLS is in front of this server.
fn is_behind_https(headers: &HeaderMap) -> bool {
    let says = |name: &str, word: &str| {
        let value = headers.get(name).and_then(|value| value.to_str().ok());
        value.is_some_and(|value| value.to_ascii_lowercase().starts_with(word))
    };
    says("origin", "https://") || says("x-forwarded-proto", "https")
}

/// Whether a request says which page it comes from. What it says has been judged before: see
/// [`Callers`](super::Callers).
fn names_its_page(headers: &HeaderMap) -> bool {
    headers.contains_key(header::ORIGIN) || headers.contains_key(SEC_FETCH_SITE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(lines: &[(&'static str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in lines {
            headers.append(*name, value.parse().unwrap());
        }
        headers
    }

    #[test]
    fn a_key_or_a_session_is_found_among_other_headers() {
        let found = |lines: &[(&'static str, &str)]| {
            credential(&headers(lines)).map(|found| match found {
                Credential::Key(key) => format!("key {key}"),
                Credential::Session(secret) => format!("session {secret}"),
            })
        };
        assert_eq!(found(&[("authorization", "Bearer a")]).as_deref(), Some("key a"));
        assert_eq!(found(&[("authorization", "bearer  a ")]).as_deref(), Some("key a"));
        assert_eq!(found(&[("authorization", "Basic a")]), None);
        assert_eq!(found(&[("authorization", "Bearer")]), None);
        let cookie = ("cookie", "theme=dark; servoscope_session=b; other_servoscope_session=c");
        assert_eq!(found(&[cookie]).as_deref(), Some("session b"));
        assert_eq!(found(&[("authorization", "Basic a"), cookie]).as_deref(), Some("session b"));
        assert_eq!(found(&[("authorization", "Bearer a"), cookie]).as_deref(), Some("key a"));
        assert_eq!(found(&[("cookie", "my_servoscope_session=c")]), None);
    }

    #[test]
    fn the_cookie_is_hidden_from_scripts_and_other_sites_and_from_the_wire_behind_https() {
        let of = |lines: &[(&'static str, &str)]| cookie("s", 60, &headers(lines));
        let open = "servoscope_session=s; Path=/; Max-Age=60; HttpOnly; SameSite=Strict";
        assert_eq!(of(&[("origin", "http://127.0.0.1:8080")]), open);
        for line in [("origin", "https://rig.example"), ("x-forwarded-proto", "HTTPS")] {
            assert_eq!(of(&[line]), format!("{open}; Secure"));
        }
    }
}
