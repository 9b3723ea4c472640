//! Requests that are answered by their query, or by the JSON of their body.
//!
//! The extractors of axum name the place of a fault. They and its handlers are compiled for each type of a
//! request, which made the program 0.1 MB larger.

use std::{fmt::Display, sync::Arc};

use axum::{
    body::Bytes,
    extract::State,
    http::{
        HeaderMap, Uri,
        header::{CONTENT_TYPE, HeaderValue},
    },
    response::{IntoResponse, Response},
    routing::{MethodFilter, MethodRouter, on, post},
};
use serde::de::DeserializeOwned;

use super::{
    app::App,
    desk::Desk,
    refusal::{Refusal, apart, refuse},
};

/// Answers what is asked for by these bytes.
type Answering = Arc<dyn Fn(&Desk, &[u8]) -> Response + Send + Sync>;

fn answering<Q: 'static, A: IntoResponse + 'static, E: Display + 'static>(
    read: fn(&[u8]) -> Result<Q, E>,
    answer: fn(&Desk, Q) -> Result<A, Refusal>,
) -> Answering {
    Arc::new(move |desk, bytes| match read(bytes) {
        Ok(asked) => answer(desk, asked).into_response(),
        Err(error) => refuse::unreadable(error).into_response(),
    })
}

/// Returns the handler of requests that are answered by their query.
pub(super) fn queried<Q: DeserializeOwned + 'static, A: IntoResponse + 'static>(
    method: MethodFilter,
    answer: fn(&Desk, Q) -> Result<A, Refusal>,
) -> MethodRouter<App> {
    by_query(
        method,
        answering(|query| serde_urlencoded::from_bytes(query), answer),
    )
}

fn by_query(method: MethodFilter, answering: Answering) -> MethodRouter<App> {
    let handler = move |State(App { desk, .. }), uri: Uri| {
        let answering = Arc::clone(&answering);
        apart(move || Ok(answering(&desk, uri.query().unwrap_or_default().as_bytes())))
    };
    on(method, handler)
}

/// Returns the handler of requests that are answered by the JSON of their body.
pub(super) fn posted<Q: DeserializeOwned + 'static, A: IntoResponse + 'static>(
    answer: fn(&Desk, Q) -> Result<A, Refusal>,
) -> MethodRouter<App> {
    by_json(answering(|json| serde_json::from_slice(json), answer))
}

fn by_json(answering: Answering) -> MethodRouter<App> {
    // A form of another page cannot send this type.
    const JSON: HeaderValue = HeaderValue::from_static("application/json");
    post(
        move |State(App { desk, .. }), headers: HeaderMap, body: Bytes| {
            let answering = Arc::clone(&answering);
            apart(move || match headers.get(CONTENT_TYPE) == Some(&JSON) {
                true => Ok(answering(&desk, &body)),
                false => Err(refuse::unreadable("the body is not application/json")),
            })
        },
    )
}
