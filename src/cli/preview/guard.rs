//! The guard of the page: who may ask for what.
//!
//! Other programs of this machine, and any page that the browser shows, can reach the port. So every
//! request has to name this host (against DNS rebinding), must not come from another page, and,
//! unless it asks for a part of the program, has the token that only the printed address contains.

use std::{
    fmt::{Display, Write},
    net::SocketAddr,
    sync::Arc,
};

use axum::{
    extract::{Request, State},
    http::{HeaderMap, HeaderName, HeaderValue, Uri, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

use super::{
    connections::Trusted,
    opening::Opening,
    page,
    refusal::{Refusal, refuse},
};
use crate::cli::failure::Failure;

/// The port of an address that names none.
const HTTP: u16 = 80;
/// The fault of a page that the system refuses.
pub(super) const LOST: &str = "the page cannot be served";
/// Number of random bytes in a token.
const BYTES: usize = 16;

/// The rules of requests.
pub(super) struct Guard {
    port: u16,
    token: String,
    opening: Arc<Opening>,
}

impl Guard {
    /// Creates the guard of an address, with a new token.
    pub(super) fn new(address: SocketAddr, opening: Arc<Opening>) -> Result<Self, Failure> {
        Ok(Self {
            port: address.port(),
            token: random().map_err(|error| unavailable(&error))?,
            opening,
        })
    }

    /// Returns the address of the page, with the token.
    pub(super) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    /// Checks a request, and returns true if it has the token.
    fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<bool, Refusal> {
        let text =
            |name: &'static str| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let host = text("host").unwrap_or_default();
        if !self.is_own(host) {
            return Err(refuse::forbidden("this host is not served here"));
        }
        let own = format!("http://{host}");
        if text("origin").is_some_and(|origin| origin != own) {
            return Err(refuse::forbidden("other pages may not ask"));
        }
        let has_token = self.has_token(uri, headers);
        // The private file that leads to the page is another site.
        let is_opened = uri.path() == "/"
            && text("sec-fetch-mode") == Some("navigate")
            && text("sec-fetch-dest") == Some("document");
        let site = text("sec-fetch-site");
        let is_foreign = site.is_some_and(|site| !matches!(site, "same-origin" | "none"));
        if is_foreign && !(is_opened && has_token) {
            return Err(refuse::forbidden("other pages may not ask"));
        }
        match has_token || page::is_part(uri.path()) {
            true => Ok(has_token),
            false => Err(refuse::forbidden(
                "the token is missing or wrong; use the address that strahl printed",
            )),
        }
    }

    /// Returns true if a request names this host. A browser leaves out the usual port.
    fn is_own(&self, host: &str) -> bool {
        let (name, port) = match host.split_once(':') {
            Some((name, port)) => (name, port.parse().ok()),
            None => (host, Some(HTTP)),
        };
        matches!(name, "127.0.0.1" | "localhost") && port == Some(self.port)
    }

    fn has_token(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let header = headers.get(header::AUTHORIZATION);
        let header = header.and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
        let query = uri.query().unwrap_or_default().split('&');
        let mut given = header
            .into_iter()
            .chain(query.filter_map(|part| part.strip_prefix("token=")));
        given.any(|given| self.is_token(given))
    }

    /// Compares in a time that does not depend on where the two differ.
    fn is_token(&self, given: &str) -> bool {
        let pairs = given.bytes().zip(self.token.bytes());
        given.len() == self.token.len()
            && pairs.fold(0, |other, (one, two)| other | (one ^ two)) == 0
    }
}

/// Returns random hexadecimal digits.
pub(super) fn random() -> Result<String, getrandom::Error> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// Passes on a request that the guard lets through, and adds the headers that every answer has.
pub(super) async fn watch(
    State(guard): State<Arc<Guard>>,
    request: Request,
    next: Next,
) -> Response {
    let mut response = match guard.check(request.uri(), request.headers()) {
        Ok(has_token) => {
            if let Some(known) = request.extensions().get::<Trusted>().filter(|_| has_token) {
                known.set();
                guard.opening.end();
            }
            next.run(request).await
        }
        Err(refusal) => refusal.into_response(),
    };
    let headers = response.headers_mut();
    // The page itself has a policy with a nonce.
    headers
        .entry(header::CONTENT_SECURITY_POLICY)
        .or_insert(HeaderValue::from_static(page::POLICY));
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::CACHE_CONTROL, "no-store"),
        (header::REFERRER_POLICY, "no-referrer"),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Returns the failure for a server that cannot run.
pub(super) fn unavailable(error: &impl Display) -> Failure {
    Failure::usage(format!("{LOST}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_without_a_port_is_that_of_port_80() {
        let own = |port, host: &str| {
            let address = SocketAddr::from(([127, 0, 0, 1], port));
            let guard = Guard::new(address, Arc::default());
            guard.is_ok_and(|guard| guard.is_own(host))
        };
        for host in ["127.0.0.1", "localhost", "127.0.0.1:80", "localhost:80"] {
            assert!(own(80, host) && !own(8017, host), "{host}");
        }
        for host in ["127.0.0.1:8017", "localhost:8017"] {
            assert!(!own(80, host) && own(8017, host), "{host}");
        }
        for host in [
            "",
            ":80",
            "evil.example",
            "localhost:",
            "localhost:80:80",
            "[::1]",
        ] {
            assert!(!own(80, host), "{host}");
        }
    }
}
