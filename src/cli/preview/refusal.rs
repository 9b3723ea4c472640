//! Requests that are not met, and work that may lead to that.

use axum::{
    Json,
    http::StatusCode,
    response::{IntoResponse, Response},
};
use serde_json::json;
use strahl::parallel::Cancel;

/// The header of a refusal that is a part of normal work, with its status. Its answer is a success, because
/// a browser notes every other one as an error in its console.
const REFUSED: &str = "x-strahl-refused";

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
    use std::fmt::Display;

    use axum::http::StatusCode;

    use super::Refusal;

    fn with(status: StatusCode, message: impl Into<String>) -> Refusal {
        let message = message.into();
        Refusal { status, message }
    }

    /// The request is not allowed.
    pub(in crate::cli::preview) fn forbidden(message: &str) -> Refusal {
        with(StatusCode::FORBIDDEN, message)
    }

    /// The text has another version.
    pub(in crate::cli::preview) fn outdated() -> Refusal {
        with(StatusCode::CONFLICT, "the text has changed meanwhile")
    }

    /// The file has another text.
    pub(in crate::cli::preview) fn conflict(message: impl Into<String>) -> Refusal {
        with(StatusCode::CONFLICT, message)
    }

    /// The scene has another revision.
    pub(in crate::cli::preview) fn gone() -> Refusal {
        with(StatusCode::GONE, "the scene has changed meanwhile")
    }

    /// There is no such thing.
    pub(in crate::cli::preview) fn missing(message: impl Into<String>) -> Refusal {
        with(StatusCode::NOT_FOUND, message)
    }

    /// The scene does not allow it.
    pub(in crate::cli::preview) fn impossible(message: impl Into<String>) -> Refusal {
        with(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// Nobody asks for that.
    pub(in crate::cli::preview) fn unreadable(error: impl Display) -> Refusal {
        with(StatusCode::BAD_REQUEST, error.to_string())
    }

    /// The disk does not allow it.
    pub(in crate::cli::preview) fn unwritable(message: impl Into<String>) -> Refusal {
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
