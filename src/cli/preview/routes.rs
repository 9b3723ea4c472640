//! The addresses of the page.

use std::{convert::Infallible, pin::Pin, sync::Arc, time::Duration};

use axum::{
    Json, Router,
    extract::{DefaultBodyLimit, Query, State},
    http::Uri,
    middleware,
    response::sse::{Event, KeepAlive, Sse},
    routing::{get, post},
};
use tokio_stream::{Stream, StreamExt, wrappers::WatchStream};

use super::{
    app::App,
    desk::Desk,
    guard, page, parts, pictures, references,
    refusal::{Refusal, apart},
    texts,
};

/// The largest request: a picture to compare with, or a long text.
const LARGEST: usize = 1 << 30;
/// The time between signs of life.
const ALIVE: Duration = Duration::from_secs(15);

impl App {
    pub(super) fn router(self) -> Router {
        let guard = Arc::clone(&self.guard);
        Router::new()
            .route("/", get(page::page))
            .route("/events", get(events))
            .route("/text", get(queried(texts::text)))
            .route("/edits", post(posted(texts::edit)))
            .route("/save", post(posted(texts::save)))
            .route("/reload", post(queried(texts::reload)))
            .route("/disk", get(queried(texts::disk)))
            .route("/format", post(posted(texts::format)))
            .route("/completions", get(queried(texts::completions)))
            .route("/hover", get(queried(texts::hover)))
            .route("/colors", get(queried(texts::colors)))
            .route("/parts", get(queried(parts::list)))
            .route("/parts", post(posted(parts::change)))
            .route("/move", post(posted(pictures::shift)))
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

/// An answer to come.
type Pending<A> = Pin<Box<dyn Future<Output = Result<A, Refusal>> + Send>>;

/// Returns the handler of requests that are answered by their query.
fn queried<Q: Send + 'static, A: Send + 'static>(
    answer: fn(&Desk, Q) -> Result<A, Refusal>,
) -> impl Fn(State<App>, Query<Q>) -> Pending<A> + Clone {
    move |State(App { desk, .. }), Query(asked)| Box::pin(apart(move || answer(&desk, asked)))
}

/// Returns the handler of requests that are answered by the JSON of their body.
fn posted<Q: Send + 'static, A: Send + 'static>(
    answer: fn(&Desk, Q) -> Result<A, Refusal>,
) -> impl Fn(State<App>, Json<Q>) -> Pending<A> + Clone {
    move |State(App { desk, .. }), Json(asked)| Box::pin(apart(move || answer(&desk, asked)))
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
