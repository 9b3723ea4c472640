//! Pictures from elsewhere that the scene's picture is compared with.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
};

use axum::{
    Json,
    body::Bytes,
    extract::{Path, Query, State},
    http::header,
    response::{IntoResponse, Response},
};
use serde_json::json;
use strahl::compare::{CompareOptions, Picture, PictureOptions};

use super::{
    pictures::{Asked, draw},
    routes::{App, Refusal, apart, refuse},
    texts::Answer,
};

/// The number of pictures that are kept.
const KEPT: usize = 4;
/// The name of the header with the numbers of a comparison.
const DIFFERENCE: &str = "x-strahl-difference";

#[derive(Default)]
pub(super) struct References(Mutex<Known>);

#[derive(Default)]
struct Known {
    /// Number of pictures that were ever added.
    count: u64,
    pictures: VecDeque<(String, Arc<Picture>)>,
}

impl References {
    fn add(&self, picture: Picture) -> String {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.count += 1;
        let id = known.count.to_string();
        known.pictures.push_back((id.clone(), picture.into()));
        if known.pictures.len() > KEPT {
            known.pictures.pop_front();
        }
        id
    }

    fn get(&self, id: &str) -> Result<Arc<Picture>, Refusal> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.pictures.iter().find(|(known, _)| known == id);
        found
            .map(|(_, picture)| Arc::clone(picture))
            .ok_or_else(|| refuse::missing("this picture is no longer kept; choose it again"))
    }
}

pub(super) async fn add(State(App { references, .. }): State<App>, file: Bytes) -> Answer {
    apart(move || {
        let picture = Picture::from_bytes(&file, &PictureOptions::new())?;
        let size = picture.size();
        let id = references.add(picture);
        Ok(Json(
            json!({"id": id, "width": size.width(), "height": size.height()}),
        ))
    })
    .await
}

pub(super) async fn show(
    State(App { references, .. }): State<App>,
    Path(id): Path<String>,
) -> Result<Response, Refusal> {
    apart(move || {
        let png = references.get(&id)?.to_png()?;
        Ok(([(header::CONTENT_TYPE, "image/png")], png).into_response())
    })
    .await
}

pub(super) async fn difference(
    State(app): State<App>,
    Query(asked): Query<Asked>,
) -> Result<Response, Refusal> {
    let reference = app.references.get(&asked.reference)?;
    let drawn = draw(&app.desk, &app.drawings, &asked).await?;
    apart(move || {
        let picture = Picture::from_bytes(&drawn, &PictureOptions::new())?;
        let found = reference.compare_with_heat(&picture, &CompareOptions::new())?;
        let (found, heat) = found.ok_or_else(|| {
            let (theirs, ours) = (reference.size(), picture.size());
            refuse::impossible(format!(
                "the other picture has {theirs} pixels, this one {ours}"
            ))
        })?;
        let numbers = json!({
            "pixels": found.size.pixels(),
            "different": found.different,
            "max_delta": found.max_delta,
        });
        let headers = [
            (header::CONTENT_TYPE.as_str(), "image/png".to_owned()),
            (DIFFERENCE, numbers.to_string()),
        ];
        Ok((headers, heat).into_response())
    })
    .await
}
