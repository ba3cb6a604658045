//! Who may pass: each request with a key or a session, held against what it needs.

use std::sync::Arc;
use std::time::Instant;

use axum::body::Body;
use axum::extract::{MatchedPath, Request, State};
use axum::http::{Extensions, HeaderMap, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tracing::Span;

use crate::service::{Caller, Key, Service, ServiceError};

use super::access::{Need, Needs};
use super::answer::Answer;
use super::body::{self, Most};
use super::callers::SEC_FETCH_SITE;
use super::layers::WATCHED;
use super::problem::Problem;
use super::rates::Rates;
use super::server::Peer;
use super::shares::{Share, Shares, Who};

/// Name of the cookie that holds a session.
pub(super) const COOKIE: &str = "servoscope_session";

/// Where browsers sign in: of what needs nothing, the only thing that has a body.
const SIGN_IN: &str = "/v1/session";

/// Most bytes of the body of a sign-in: a key and what is around it.
const SIGN_IN_BYTES: usize = 4 << 10;

/// How often browsers at one address may sign in within a minute.
const SIGN_INS: usize = 60;

/// What lets requests pass.
#[derive(Clone)]
pub(super) struct Gate {
    /// The service, for nobody in particular.
    pub(super) service: Service,
    /// What each request needs.
    pub(super) needs: Arc<Needs>,
    /// How often keys ask, and browsers sign in.
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
///
/// It counts as under way until all of its answer is sent.
pub(super) async fn admit(State(gate): State<Gate>, request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map(MatchedPath::as_str);
    let need = gate.needs.of_request(request.method(), route);
    let signs_in = need == Need::Nothing && route == Some(SIGN_IN);
    let mut caller = gate.caller(need, request.method(), request.headers()).await;
    if signs_in && let Err(problem) = gate.count_sign_in(request.extensions()) {
        caller = Err(problem);
    }
    if WATCHED.contains(&request.uri().path()) {
        // Answered at once, however many are under way.
        return gate.pass(caller, body::without(request), next).await;
    }
    let share = match share(request.extensions(), caller.as_ref().ok().and_then(Caller::key)) {
        Ok(share) => share,
        // The connection is for others: what comes of the body is not waited for.
        Err(problem) => return ([(header::CONNECTION, "close")], problem).into_response(),
    };
    let request = match need {
        Need::Nothing if signs_in => {
            let (mut parts, body) = request.into_parts();
            parts.extensions.insert(Most(SIGN_IN_BYTES));
            Request::from_parts(parts, body)
        }
        Need::Nothing => body::left_out(request).await,
        Need::Key | Need::Scope(_) => request,
    };
    let answer = gate.pass(caller, request, next).await;
    answer.map(|body| Body::new(Answer::new(body, share)))
}

/// A request of a key, or of an address, counts as under way while this is kept. `None`: nobody keeps
/// connections.
///
/// # Errors
/// The caller has as many as one may have.
fn share(request: &Extensions, key: Option<&Key>) -> Result<Option<Share>, Box<Problem>> {
    let Some(shares) = request.get::<Arc<Shares>>() else { return Ok(None) };
    let peer = request.get::<Peer>().map(|Peer(address)| Who::at(*address));
    let who = key.map(|key| Who::Key(key.id.clone())).or(peer);
    who.map(|who| shares.take(who)).transpose()
}

impl Gate {
    /// Passes a request on for its caller, or says why it is refused.
    async fn pass(
        &self,
        caller: Result<Caller, Box<Problem>>,
        mut request: Request,
        next: Next,
    ) -> Response {
        match caller {
            Ok(caller) => {
                if let Some(key) = caller.key() {
                    Span::current().record("key", &key.id);
                }
                request.extensions_mut().insert(self.service.on_behalf_of(caller));
                next.run(request).await
            }
            Err(problem) => {
                body::read_on(request).await;
                problem.into_response()
            }
        }
    }

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
        self.count(&key)?;
        match need {
            Need::Scope(scope) if !key.may(scope) => {
                let Key { name, scopes, .. } = key;
                Err(ServiceError::Lacking { name, scope, scopes }.into())
            }
            _ => Ok(Caller::Holder(Box::new(key))),
        }
    }

    /// Counts a request of a key.
    fn count(&self, key: &Key) -> Result<(), Box<Problem>> {
        let Some((most, by)) = self.service.quotas_of(key).requests_per_minute() else {
            return Ok(());
        };
        let who = Who::Key(key.id.clone());
        let Err(wait_s) = self.rates.take(who, most, Instant::now()) else { return Ok(()) };
        let requests = if most == 1 { "request" } else { "requests" };
        let reason =
            format!("has used its {most} {requests} a minute ({by}); send it again in {wait_s} s");
        let (name, wait_s) = (key.name.clone(), Some(wait_s));
        Err(ServiceError::OverQuota { name, reason, wait_s }.into())
    }

    /// Counts a sign-in, of whoever sends from its address.
    fn count_sign_in(&self, request: &Extensions) -> Result<(), Box<Problem>> {
        let Some(Peer(address)) = request.get::<Peer>() else { return Ok(()) };
        let taken = self.rates.take(Who::at(*address), SIGN_INS, Instant::now());
        taken.map_err(|wait_s| {
            let detail = format!(
                "your address has used its {SIGN_INS} sign-ins a minute; try again in {wait_s} s"
            );
            Box::new(Problem::over_quota(detail, Some(wait_s)))
        })
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
