//! Which requests a browser may bring.
//!
//! A page from anywhere can make its reader's browser send requests to servers that only this
//! browser reaches. Two rules keep such pages out:
//!
//! - The name that a request was sent to (`Host`) must be one of the server's. Otherwise a foreign
//!   name whose address is changed to 127.0.0.1 (DNS rebinding) would be this server's own page.
//! - A request that changes something must not come from a foreign page. Browsers say where it comes
//!   from: `Sec-Fetch-Site` (<https://www.w3.org/TR/fetch-metadata/>) and `Origin` (RFC 6454). Other
//!   programs send neither.

use std::net::IpAddr;

use axum::extract::Request;
use axum::http::uri::{Authority, InvalidUri};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::body;
use super::problem::Problem;

/// Where a browser says a request comes from.
pub(super) const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Who may send requests.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Callers {
    /// Names of the server beside those of the loopback, each with a port where its pages are not at
    /// the usual one.
    pub hosts: Vec<String>,
    /// Whether every name is the server's: others than it look after that.
    pub any_host: bool,
    /// Origins of foreign pages whose scripts may use the service.
    pub origins: Vec<HeaderValue>,
}

impl Callers {
    /// Lets a request through, or refuses it.
    pub(super) async fn admit(self, request: Request, next: Next) -> Response {
        match self.refusal(request.method(), request.uri(), request.headers()) {
            Some(problem) => {
                body::read_on(request).await;
                problem.into_response()
            }
            None => next.run(request).await,
        }
    }

    fn refusal(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Option<Box<Problem>> {
        let Ok(host) = host(uri, headers) else {
            let detail = "the header `Host` is neither a host name nor an address";
            return Some(Problem::of_status(StatusCode::BAD_REQUEST, detail));
        };
        let name = host.as_ref().map(Authority::host);
        if let Some(foreign) = name.filter(|name| !self.any_host && !self.is_own(name)) {
            let detail = format!(
                "this server is not `{foreign}`; ask for it by an address of this machine such as \
                 127.0.0.1, or start it with `--host {foreign}` if it is reached by that name"
            );
            return Some(Problem::of_status(StatusCode::MISDIRECTED_REQUEST, detail));
        }
        if method.is_safe() || self.is_from_own_page(host.as_ref(), headers) {
            return None;
        }
        let from = headers.get(header::ORIGIN).and_then(|origin| origin.to_str().ok());
        let from = from.filter(|origin| *origin != "null").unwrap_or("ORIGIN");
        let detail = format!(
            "a page of another origin may not change anything here; start the server with \
             `--cors-origin {from}` if that page is to use it"
        );
        Some(Problem::of_status(StatusCode::FORBIDDEN, detail))
    }

    /// Whether a name is one of the server's: of the loopback, or one that it was told.
    fn is_own(&self, host: &str) -> bool {
        let told = || self.hosts.iter().any(|own| split(own).0.eq_ignore_ascii_case(host));
        is_of_loopback(host) || told()
    }

    /// Whether a request comes from a page of this server, from a page that was let in, or from no
    /// page at all.
    fn is_from_own_page(&self, host: Option<&Authority>, headers: &HeaderMap) -> bool {
        let origin = headers.get(header::ORIGIN);
        if origin.is_some_and(|origin| self.origins.contains(origin)) {
            return true;
        }
        if let Some(site) = headers.get(SEC_FETCH_SITE) {
            return site == "same-origin" || site == "none";
        }
        // Browsers send no `Sec-Fetch-Site` to a plain HTTP address that is not on the loopback.
        let Some(origin) = origin else { return true };
        let page = origin.to_str().ok().and_then(|origin| origin.parse::<Uri>().ok());
        page.is_some_and(|page| self.is_own_page(host, &page))
    }

    /// Whether an origin has the name and the port of the server. A port that is not said is that of
    /// the origin's scheme: what ends TLS in front of the server passes the name alone.
    fn is_own_page(&self, host: Option<&Authority>, origin: &Uri) -> bool {
        let usual = match origin.scheme_str() {
            Some("https") => 443,
            Some("http") => 80,
            _ => return false,
        };
        let Some(page) = origin.authority() else { return false };
        let is_page = |name: &str, port: Option<u16>| {
            let same = page.port_u16().unwrap_or(usual) == port.unwrap_or(usual);
            same && page.host().eq_ignore_ascii_case(name)
        };
        let told = self.hosts.iter().map(|own| split(own)).any(|(name, port)| is_page(name, port));
        told || host.is_some_and(|host| is_page(host.host(), host.port_u16()))
    }
}

/// Whether a name, with a port or without, is one by which only this machine is reached.
pub fn is_of_loopback(host: &str) -> bool {
    let bare = split(host).0.trim_start_matches('[').trim_end_matches(']');
    let address = bare.parse::<IpAddr>().is_ok_and(|address| address.is_loopback());
    address || bare.eq_ignore_ascii_case("localhost")
}

/// The name and the port of a host; an address of IPv6 that has a port stands in brackets.
fn split(host: &str) -> (&str, Option<u16>) {
    let parts = host.rsplit_once(':');
    let parts = parts.filter(|(name, _)| !name.contains(':') || name.ends_with(']'));
    let port = parts.and_then(|(name, port)| Some((name, port.parse().ok()?)));
    port.map_or((host, None), |(name, port)| (name, Some(port)))
}

/// The name that a request was sent to, with its port. Requests of HTTP 1.0 have none; no browser
/// sends such.
///
/// # Errors
/// It is no name.
fn host(uri: &Uri, headers: &HeaderMap) -> Result<Option<Authority>, InvalidUri> {
    if let Some(authority) = uri.authority() {
        return Ok(Some(authority.clone()));
    }
    let given = headers.get(header::HOST).map(|host| Authority::try_from(host.as_bytes()));
    given.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn callers() -> Callers {
        Callers {
            hosts: vec!["rig.example".into(), "lab.example:8443".into()],
            any_host: false,
            origins: vec![HeaderValue::from_static("https://bench.example")],
        }
    }

    fn status(callers: &Callers, method: Method, headers: &[(&'static str, &str)]) -> u16 {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(*name, HeaderValue::from_str(value).unwrap());
        }
        let problem = callers.refusal(&method, &Uri::from_static("/v1/jobs"), &map);
        problem.map_or(200, |problem| problem.into_response().status().as_u16())
    }

    #[test]
    fn a_name_that_is_not_the_servers_is_refused() {
        let get = |host| status(&callers(), Method::GET, &[("host", host)]);
        for own in ["127.0.0.1:8080", "localhost", "[::1]:9", "127.8.0.1", "Rig.Example:443"] {
            assert_eq!(get(own), 200, "{own}");
        }
        // What passes the name on may leave the port out.
        assert_eq!((get("lab.example"), get("lab.example:8443")), (200, 200));
        for foreign in ["evil.example", "127.0.0.1.evil.example:8080", "10.0.0.1", "localhost.x"] {
            assert_eq!(get(foreign), 421, "{foreign}");
        }
        assert_eq!(get("two words"), 400);
        assert_eq!(status(&callers(), Method::GET, &[]), 200);
        let open = Callers { any_host: true, ..callers() };
        assert_eq!(status(&open, Method::GET, &[("host", "any.example")]), 200);
    }

    #[test]
    fn a_foreign_page_may_read_what_its_browser_hides_from_it_but_change_nothing() {
        let from = |method, more: &[(&'static str, &str)]| {
            status(&callers(), method, &[&[("host", "127.0.0.1:8080")], more].concat())
        };
        let foreign = [("origin", "https://evil.example")];
        assert_eq!(from(Method::GET, &foreign), 200);
        for method in [Method::POST, Method::PUT, Method::PATCH, Method::DELETE] {
            assert_eq!(from(method.clone(), &foreign), 403);
            assert_eq!(from(method.clone(), &[("origin", "null")]), 403);
            assert_eq!(from(method.clone(), &[("sec-fetch-site", "cross-site")]), 403);
            // Another port of this machine is another program.
            assert_eq!(from(method.clone(), &[("sec-fetch-site", "same-site")]), 403);
            assert_eq!(from(method, &[("origin", "http://127.0.0.1:3000")]), 403);
        }
    }

    #[test]
    fn own_pages_programs_and_pages_that_were_let_in_may_change_things() {
        let post = |more: &[(&'static str, &str)]| {
            status(&callers(), Method::POST, &[&[("host", "127.0.0.1:8080")], more].concat())
        };
        assert_eq!(post(&[]), 200);
        assert_eq!(post(&[("origin", "http://127.0.0.1:8080")]), 200);
        assert_eq!(
            post(&[("sec-fetch-site", "same-origin"), ("origin", "https://x.example")]),
            200
        );
        assert_eq!(
            post(&[("sec-fetch-site", "cross-site"), ("origin", "https://bench.example")]),
            200
        );
        // Behind a proxy that rewrites `Host`, over plain HTTP.
        assert_eq!(post(&[("origin", "http://rig.example")]), 200);
    }

    #[test]
    fn a_page_at_another_port_of_a_name_is_another_programs() {
        let post = |host: &str, origin: &str| {
            status(&callers(), Method::POST, &[("host", host), ("origin", origin)])
        };
        for (host, origin) in [
            ("127.0.0.1:8080", "https://rig.example"),
            ("127.0.0.1:8080", "https://rig.example:443"),
            ("127.0.0.1:8080", "https://Lab.Example:8443"),
            ("rig.example", "https://rig.example"),
            ("rig.example:9000", "http://rig.example:9000"),
            ("[::1]:8080", "http://[::1]:8080"),
            ("localhost", "http://localhost:80"),
        ] {
            assert_eq!(post(host, origin), 200, "{origin} to {host}");
        }
        for (host, origin) in [
            ("127.0.0.1:8080", "https://rig.example:3000"),
            ("127.0.0.1:8080", "https://lab.example"),
            ("rig.example", "https://rig.example:8443"),
            ("rig.example:9000", "ftp://rig.example:9000"),
            ("127.0.0.1:8080", "http://127.0.0.1"),
            ("[::1]:8080", "http://[::1]:3000"),
        ] {
            assert_eq!(post(host, origin), 403, "{origin} to {host}");
        }
    }

    #[test]
    fn only_addresses_and_the_name_of_the_loopback_are_of_this_machine_alone() {
        for own in
            ["localhost", "LOCALHOST:80", "127.0.0.1", "127.8.0.1:1", "[::1]", "[::1]:9", "::1"]
        {
            assert!(is_of_loopback(own), "{own}");
        }
        for foreign in
            ["bench.example", "10.0.0.1", "localhost.example", "[fe80::1]:9", "127.0.0.1.x"]
        {
            assert!(!is_of_loopback(foreign), "{foreign}");
        }
    }
}
