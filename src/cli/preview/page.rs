//! The page itself, which is part of the program.

use axum::{
    http::{HeaderValue, StatusCode, header},
    response::{Html, IntoResponse, Response},
};

use super::guard::random;

const HTML: &str = include_str!("page/index.html");
const STYLE: &str = include_str!("page/page.css");
const ICON: &str = include_str!("page/icon.svg");
const SCRIPT: &str = include_str!("page/built/page.js");

const EVENTS: &str = include_str!("page/built/events.js");

/// The parts of the page: they are the same for everybody, so they need no token.
const PARTS: [(&str, &str, &str); 4] = [
    ("/events.js", "text/javascript; charset=utf-8", EVENTS),
    ("/page.js", "text/javascript; charset=utf-8", SCRIPT),
    ("/page.css", "text/css; charset=utf-8", STYLE),
    ("/icon.svg", "image/svg+xml", ICON),
];

/// The place of the nonce in the page.
const NONCE: &str = "{{nonce}}";

/// The policy of every answer other than the page: it shows nothing. A worker may ask this server.
pub(super) const POLICY: &str = "default-src 'none'; connect-src 'self'; frame-ancestors 'none'";

/// Returns true for a part of the page.
pub(super) fn is_part(path: &str) -> bool {
    PARTS.iter().any(|(known, ..)| *known == path)
}

/// Answers with a part of the page.
pub(super) fn part(path: &str) -> Response {
    let part = PARTS.iter().find(|(known, ..)| *known == path);
    match part {
        Some((_, kind, text)) => ([(header::CONTENT_TYPE, *kind)], *text).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

/// Answers with the page.
pub(super) async fn page() -> Response {
    // Without a nonce the editor has no style; everything else works.
    let nonce = random().unwrap_or_default();
    let policy = format!(
        "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; img-src 'self' \
         blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let mut response = Html(HTML.replace(NONCE, &nonce)).into_response();
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}
