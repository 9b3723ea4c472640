//! The addresses of the page.

use std::{convert::Infallible, sync::Arc, time::Duration};

use axum::{
    Router,
    extract::{DefaultBodyLimit, State},
    http::Uri,
    middleware,
    response::sse::{Event, KeepAlive, Sse},
    routing::{MethodFilter, get, post},
};
use tokio_stream::{Stream, StreamExt, wrappers::WatchStream};

use super::{
    app::App,
    guard, page, parts, pictures, references,
    requests::{posted, queried},
    texts,
};

/// The largest request: a picture to compare with, or a long text.
const LARGEST: usize = 1 << 30;
const GET: MethodFilter = MethodFilter::GET;
const POST: MethodFilter = MethodFilter::POST;
/// The time between signs of life.
const ALIVE: Duration = Duration::from_secs(15);

impl App {
    pub(super) fn router(self) -> Router {
        let guard = Arc::clone(&self.guard);
        Router::new()
            .route("/", get(page::page))
            .route("/events", get(events))
            .route("/text", queried(GET, texts::text))
            .route("/edits", posted(texts::edit))
            .route("/save", posted(texts::save))
            .route("/reload", queried(POST, texts::reload))
            .route("/disk", queried(GET, texts::disk))
            .route("/format", posted(texts::format))
            .route("/completions", queried(GET, texts::completions))
            .route("/hover", queried(GET, texts::hover))
            .route("/colors", queried(GET, texts::colors))
            .route("/parts", queried(GET, parts::list))
            .route("/parts", posted(parts::change))
            .route("/move", posted(pictures::shift))
            .route("/picture", get(pictures::picture))
            .route("/magnified", get(pictures::magnified))
            .route("/pixel", get(pictures::pixel))
            .route("/why", get(pictures::why))
            .route("/outline", get(pictures::outline))
            .route("/reference", post(references::add))
            .route("/reference/{id}", get(references::show))
            .route("/difference", get(references::difference))
            .fallback(|uri: Uri| async move { page::part(uri.path()) })
            .with_state(self)
            .layer(DefaultBodyLimit::max(LARGEST))
            .layer(middleware::from_fn_with_state(guard, guard::watch))
    }
}

/// Answers with the state, now and after each change. Who reads slowly gets only the last one.
async fn events(
    State(App { desk, .. }): State<App>,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let states = WatchStream::new(desk.states());
    let states = states.filter(|state| !state.is_empty());
    let events = states.map(|state| Ok(Event::default().data(&*state)));
    Sse::new(events).keep_alive(KeepAlive::new().interval(ALIVE))
}
