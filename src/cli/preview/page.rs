//! The page itself, which is part of the program.

use axum::{
    http::{HeaderValue, StatusCode, header},
    response::{Html, IntoResponse, Response},
};

use super::guard::random;

const HTML: &str = include_str!("page/index.html");
const STYLE: &str = include_str!("page/page.css");
const ICON: &str = include_str!("page/icon.svg");
const EVENTS: &str = include_str!("page/built/events.js");
/// The script `page/built/page.js`, which `build.rs` compresses.
const SCRIPT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/page.js.zlib"));

const JAVASCRIPT: &str = "text/javascript; charset=utf-8";

/// The parts of the page: they are the same for everybody, so they need no token.
const PARTS: [Asset; 4] = [
    Asset::text("/events.js", JAVASCRIPT, EVENTS),
    Asset {
        path: "/page.js",
        kind: JAVASCRIPT,
        content: SCRIPT,
        is_compressed: true,
    },
    Asset::text("/page.css", "text/css; charset=utf-8", STYLE),
    Asset::text("/icon.svg", "image/svg+xml", ICON),
];

/// A part of the page.
struct Asset {
    path: &'static str,
    /// The media type.
    kind: &'static str,
    content: &'static [u8],
    /// True for a stream of zlib, the encoding that HTTP calls `deflate`.
    is_compressed: bool,
}

impl Asset {
    const fn text(path: &'static str, kind: &'static str, content: &'static str) -> Self {
        Self {
            path,
            kind,
            content: content.as_bytes(),
            is_compressed: false,
        }
    }
}

/// The place of the nonce in the page.
const NONCE: &str = "{{nonce}}";

/// The policy of every answer other than the page: it shows nothing. A worker may ask this server.
pub(super) const POLICY: &str = "default-src 'none'; connect-src 'self'; frame-ancestors 'none'";

/// Returns true for a part of the page.
pub(super) fn is_part(path: &str) -> bool {
    PARTS.iter().any(|part| part.path == path)
}

/// Answers with a part of the page.
pub(super) fn part(path: &str) -> Response {
    let Some(part) = PARTS.iter().find(|part| part.path == path) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let kind = [(header::CONTENT_TYPE, part.kind)];
    let encoding = part
        .is_compressed
        .then_some([(header::CONTENT_ENCODING, "deflate")]);
    (kind, encoding, part.content).into_response()
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
