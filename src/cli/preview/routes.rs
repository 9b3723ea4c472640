//! The addresses of the page, and the form of errors.

use std::{convert::Infallible, pin::Pin, sync::Arc, time::Duration};

use axum::{
    Json, Router,
    extract::{DefaultBodyLimit, Query, State},
    http::{StatusCode, Uri},
    middleware,
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
    routing::{get, post},
};
use serde_json::json;
use strahl::parallel::Cancel;
use tokio_stream::{Stream, StreamExt, wrappers::WatchStream};

use super::{
    desk::Desk, drawings::Drawings, guard, guard::Guard, page, parts, pictures, references,
    references::References, texts,
};

/// The largest request: a picture to compare with, or a long text.
const LARGEST: usize = 1 << 30;
/// The header of a refusal that is a part of normal work, with its status. Its answer is a success, because
/// a browser notes every other one as an error in its console.
const REFUSED: &str = "x-strahl-refused";
/// The time between signs of life.
const ALIVE: Duration = Duration::from_secs(15);

/// The parts of the server that answers use.
#[derive(Clone)]
pub(super) struct App {
    pub(super) desk: Arc<Desk>,
    pub(super) drawings: Arc<Drawings>,
    pub(super) references: Arc<References>,
    guard: Arc<Guard>,
}

impl App {
    pub(super) fn new(desk: Arc<Desk>, guard: Guard) -> Self {
        Self {
            desk,
            drawings: Arc::default(),
            references: Arc::default(),
            guard: guard.into(),
        }
    }

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

/// Answers with the state, now and after each change. Who reads slowly gets only the last one.
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

async fn events(
    State(App { desk, .. }): State<App>,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let states = WatchStream::new(desk.states());
    let states = states.filter(|state| !state.is_empty());
    let events = states.map(|state| Ok(Event::default().data(&*state)));
    Sse::new(events).keep_alive(KeepAlive::new().interval(ALIVE))
}

/// A request that is not met.
#[derive(Clone, Debug)]
pub(super) struct Refusal {
    status: StatusCode,
    message: String,
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let body = Json(json!({"error": self.message}));
        match self.status {
            StatusCode::CONFLICT
            | StatusCode::GONE
            | StatusCode::NOT_FOUND
            | StatusCode::UNPROCESSABLE_ENTITY => {
                ([(REFUSED, self.status.as_str().to_owned())], body).into_response()
            }
            status => (status, body).into_response(),
        }
    }
}

impl From<strahl::Error> for Refusal {
    fn from(error: strahl::Error) -> Self {
        refuse::impossible(error.to_string())
    }
}

/// The kinds of refusals.
pub(super) mod refuse {
    use axum::http::StatusCode;

    use super::Refusal;

    fn with(status: StatusCode, message: impl Into<String>) -> Refusal {
        let message = message.into();
        Refusal { status, message }
    }

    /// The request is not allowed.
    pub(in super::super) fn forbidden(message: &str) -> Refusal {
        with(StatusCode::FORBIDDEN, message)
    }

    /// The text has another version.
    pub(in super::super) fn outdated() -> Refusal {
        with(StatusCode::CONFLICT, "the text has changed meanwhile")
    }

    /// The file has another text.
    pub(in super::super) fn conflict(message: impl Into<String>) -> Refusal {
        with(StatusCode::CONFLICT, message)
    }

    /// The scene has another revision.
    pub(in super::super) fn gone() -> Refusal {
        with(StatusCode::GONE, "the scene has changed meanwhile")
    }

    /// There is no such thing.
    pub(in super::super) fn missing(message: impl Into<String>) -> Refusal {
        with(StatusCode::NOT_FOUND, message)
    }

    /// The scene does not allow it.
    pub(in super::super) fn impossible(message: impl Into<String>) -> Refusal {
        with(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// The disk does not allow it.
    pub(in super::super) fn unwritable(message: impl Into<String>) -> Refusal {
        with(StatusCode::INTERNAL_SERVER_ERROR, message)
    }
}

/// Runs work that takes long, and is cancelled once nobody waits for it.
pub(super) async fn apart_until_dropped<T: Send + 'static>(
    work: impl FnOnce(&Cancel) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    struct Waiting(Cancel);
    impl Drop for Waiting {
        fn drop(&mut self) {
            self.0.cancel();
        }
    }
    let waiting = Waiting(Cancel::new());
    let cancel = waiting.0.clone();
    apart(move || work(&cancel)).await
}

/// Runs work that takes long on a thread of its own.
pub(super) async fn apart<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(refuse::unwritable(error.to_string())))
}
