//! Pictures from elsewhere that the scene's picture is compared with.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex},
};

use axum::{
    Json,
    body::Bytes,
    extract::{Path, State},
    http::header,
    response::{IntoResponse, Response},
};
use serde_json::json;
use strahl::compare::{CompareOptions, Picture, PictureOptions};

use super::{
    app::App,
    pictures::{Asked, draw},
    refusal::{Refusal, apart, refuse},
    texts::Answer,
};
use crate::cli::threads::lock;

/// The number of pictures that are kept.
const KEPT: usize = 4;
/// The number of bytes in memory that they may have together.
const LARGEST: usize = 1 << 30;
/// The name of the header with the numbers of a comparison.
const DIFFERENCE: &str = "x-strahl-difference";

#[derive(Default)]
pub(super) struct References(Mutex<KeptPictures>);

#[derive(Default)]
struct KeptPictures {
    /// Number of pictures that were ever added.
    count: u64,
    pictures: VecDeque<(String, Arc<Picture>)>,
}

impl KeptPictures {
    /// Drops the oldest pictures until this many are left, with this many bytes together.
    fn shrink(&mut self, most: usize, bytes: usize) {
        let size = |known: &Self| -> usize {
            let pictures = known.pictures.iter();
            pictures.map(|(_, picture)| picture.bytes()).sum()
        };
        while self.pictures.len() > most || size(self) > bytes {
            self.pictures.pop_front();
        }
    }
}

impl References {
    fn add(&self, picture: Picture) -> Result<String, Refusal> {
        if picture.bytes() > LARGEST {
            let (mebibytes, most) = (picture.bytes() >> 20, LARGEST >> 20);
            let message =
                format!("the picture takes {mebibytes} MiB of memory, at most {most} are kept");
            return Err(refuse::impossible(message));
        }
        let mut known = lock(&self.0);
        known.count += 1;
        let id = known.count.to_string();
        known.pictures.push_back((id.clone(), picture.into()));
        known.shrink(KEPT, LARGEST);
        Ok(id)
    }

    fn get(&self, id: &str) -> Result<Arc<Picture>, Refusal> {
        let known = lock(&self.0);
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
        let id = references.add(picture)?;
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

pub(super) async fn difference(State(app): State<App>, asked: Asked) -> Result<Response, Refusal> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kept_pictures_are_bounded_by_number_and_bytes() {
        let picture = || {
            let file = [&b"P6 100 100 255 "[..], &[7; 30_000]].concat();
            Arc::new(Picture::from_bytes(&file, &PictureOptions::new()).unwrap())
        };
        let pictures = (0..9).map(|id: u32| (id.to_string(), picture()));
        let mut known = KeptPictures {
            count: 9,
            pictures: pictures.collect(),
        };
        let left = |known: &KeptPictures| {
            known
                .pictures
                .iter()
                .map(|(id, _)| id.clone())
                .collect::<String>()
        };
        known.shrink(4, usize::MAX);
        assert_eq!(left(&known), "5678");
        known.shrink(4, 60_000);
        assert_eq!(left(&known), "78");
        known.shrink(4, 59_999);
        assert_eq!(left(&known), "8");
    }
}
