//! Pictures of the scene, and what their pixels show.

use std::sync::Arc;

use axum::{
    Json,
    body::Bytes,
    extract::{FromRequestParts, State},
    http::{StatusCode, header, request::Parts},
    response::{IntoResponse, Response},
};
use serde::Deserialize;
use serde_json::json;
use strahl::{
    RenderOptions, Scene,
    film::{Crop, SampleCount},
    render::Layer,
    scene::Origin,
    session::{Motion, Quality, Seen, View},
};

use super::{
    app::App,
    desk::Desk,
    drawings::Drawings,
    places::{PagePlace, PageSpan},
    refusal::{Refusal, apart, apart_until_dropped, refuse},
    texts::{Answer, checked, new_edits},
};
use crate::cli::pixel::Explanation;

/// What a request asks of a picture.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asked {
    revision: u64,
    camera: Option<String>,
    frame: u32,
    layer: Option<String>,
    exposure: Option<f64>,
    samples: Option<u32>,
    motion: Option<String>,
    quality: Option<String>,
    /// The number of samples of a round, where light follows paths.
    round: Option<u32>,
    /// The number of times that a magnified picture has the size of the scene's.
    factor: u32,
    x: u32,
    y: u32,
    line: usize,
    column: usize,
    /// True for all columns of the row of a table.
    whole: bool,
    /// The geometry of an outline, in place of the one at the line and column.
    geometry: Option<String>,
    pub(super) reference: String,
}

impl Asked {
    pub(super) fn view(&self) -> Result<View, Refusal> {
        let layer = self.layer.as_deref().unwrap_or("color").parse::<Layer>();
        let motion = self.motion.as_deref().map(motion).transpose()?;
        let samples = self.samples.map(SampleCount::new).transpose();
        Ok(View {
            camera: self.camera.clone().filter(|name| !name.is_empty()),
            frame: self.frame,
            layer: layer.map_err(|error| refuse::impossible(error.to_string()))?,
            exposure: self.exposure.filter(|stops| stops.is_finite()),
            samples: samples.map_err(|error| refuse::impossible(error.to_string()))?,
            motion: motion.unwrap_or_default(),
        })
    }

    /// Returns the scene, if it is still the one asked for.
    pub(super) fn scene(&self, desk: &Desk) -> Result<Arc<Scene>, Refusal> {
        let checked = desk.session().checked();
        let ready = checked.as_ref().and_then(|checked| checked.scene());
        let ready = ready.filter(|ready| ready.revision == self.revision);
        let ready = ready.ok_or_else(refuse::gone)?;
        Ok(Arc::clone(&ready.scene))
    }

    fn quality(&self) -> Result<Quality, Refusal> {
        let asked = self.quality.as_deref().unwrap_or("full");
        let found = Quality::ALL.into_iter().find(|(name, _)| *name == asked);
        let (_, quality) = found.ok_or_else(|| refuse::impossible("an unknown quality"))?;
        Ok(quality)
    }
}

impl<S: Sync> FromRequestParts<S> for Asked {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Refusal> {
        let query = parts.uri.query().unwrap_or_default();
        serde_urlencoded::from_str(query).map_err(refuse::unreadable)
    }
}

/// Reads the five numbers of a movement.
fn motion(text: &str) -> Result<Motion, Refusal> {
    let numbers = text.split(',').map(|number| number.trim().parse::<f64>());
    let numbers: Vec<_> = numbers.collect::<Result<_, _>>().unwrap_or_default();
    motion_of(&numbers)
}

fn motion_of(numbers: &[f64]) -> Result<Motion, Refusal> {
    match *numbers {
        [right, up, pan_right, pan_up, dolly] if numbers.iter().all(|n| n.is_finite()) => {
            Ok(Motion {
                orbit: [right, up],
                pan: [pan_right, pan_up],
                dolly,
            })
        }
        _ => Err(refuse::impossible("a movement has five finite numbers")),
    }
}

/// Returns the answer for a picture; one without bytes has nothing to show.
fn png(bytes: Bytes) -> Response {
    if bytes.is_empty() {
        return StatusCode::NO_CONTENT.into_response();
    }
    ([(header::CONTENT_TYPE, "image/png")], bytes).into_response()
}

/// Returns the picture that a request asks for, as PNG.
pub(super) async fn draw(
    desk: &Desk,
    drawings: &Arc<Drawings>,
    asked: &Asked,
) -> Result<Bytes, Refusal> {
    let (scene, view, quality) = (asked.scene(desk)?, asked.view()?, asked.quality()?);
    let key = format!("{} {view:?} {quality:?}", asked.revision);
    let draw = move |cancel: &_| view.png(&scene, quality, cancel);
    drawings.get(key, draw).await
}

pub(super) async fn picture(
    State(App {
        desk,
        drawings,
        progressive,
        ..
    }): State<App>,
    asked: Asked,
) -> Result<Response, Refusal> {
    let Some(round) = asked.round else {
        return draw(&desk, &drawings, &asked).await.map(png);
    };
    let (scene, view) = (asked.scene(&desk)?, asked.view()?);
    let samples = SampleCount::new(round);
    let samples = samples.map_err(|error| refuse::impossible(error.to_string()))?;
    if !scene.follows_paths() {
        return Err(refuse::impossible(
            "only light that follows paths has rounds",
        ));
    }
    let key = format!("{} {view:?} of {samples}", asked.revision);
    let draw = move |cancel: &_| progressive.png(&view, &scene, samples, cancel);
    drawings.get(key, draw).await.map(png)
}

/// Returns the picture for a screen with more pixels than it has; nothing if there is none.
pub(super) async fn magnified(
    State(App { desk, drawings, .. }): State<App>,
    asked: Asked,
) -> Result<Response, Refusal> {
    let (scene, view, factor) = (asked.scene(&desk)?, asked.view()?, asked.factor);
    let key = format!("{} {view:?} times {factor}", asked.revision);
    let draw = move |cancel: &_| {
        let picture = view.magnified(&scene, factor, cancel)?;
        Ok(picture.unwrap_or_default())
    };
    drawings.get(key, draw).await.map(png)
}

/// The path of a geometry in the scene.
const GEOMETRY: &str = "x-strahl-geometry";

pub(super) async fn outline(
    State(App { desk, drawings, .. }): State<App>,
    asked: Asked,
) -> Result<Response, Refusal> {
    let (scene, view) = (asked.scene(&desk)?, asked.view()?);
    let place = PagePlace::at(asked.line, asked.column);
    let geometry = apart(move || {
        if let Some(geometry) = asked.geometry {
            return Ok(Some(geometry.parse::<Origin>()?));
        }
        let checked = desk.session().checked().ok_or_else(refuse::gone)?;
        let document = checked.document();
        Ok(document.geometry_at(place.offset(&document.lines())))
    });
    let Some(geometry) = geometry.await? else {
        return Ok(StatusCode::NO_CONTENT.into_response());
    };
    let path = geometry.to_string();
    let key = format!("{} {view:?} {path}", asked.revision);
    let draw = move |cancel: &_| {
        let outline = view.outline(&scene, &geometry, cancel)?;
        Ok(outline.unwrap_or_default())
    };
    let outline = drawings.get(key, draw).await?;
    Ok(match outline.is_empty() {
        true => png(outline),
        false => ([(GEOMETRY, path)], png(outline)).into_response(),
    })
}

pub(super) async fn pixel(State(App { desk, .. }): State<App>, asked: Asked) -> Answer {
    apart_until_dropped(move |cancel| {
        let (x, y) = (asked.x, asked.y);
        let scene = asked.view()?.of(&*asked.scene(&desk)?)?;
        let crop = Crop::new(x, y, 1, 1).map_err(|error| refuse::impossible(error.to_string()))?;
        let image = scene.render_with(&RenderOptions::new().threads(1).crop(crop))?;
        let checked = desk
            .session()
            .checked()
            .filter(|checked| !checked.is_broken());
        let cells_of = |seen: &Seen<'_>| {
            let shape = seen.hit.geometry.shape();
            match asked.whole {
                true => scene.row_cells_in_file(seen.id, shape, cancel),
                false => scene.row_cells(seen.id, shape),
            }
        };
        let geometry = scene.seen_at(x, y).map(|seen| (cells_of(&seen), seen));
        let geometry = geometry.map(|(cells, seen)| {
            let mut geometry = json!({
                "path": seen.origin.path().to_string(),
                "row": seen.origin.row,
                "name": scene.name(seen.id),
                "kind": seen.hit.geometry.shape().kind(),
                "depth": seen.hit.t,
                "position": seen.hit.point.to_array(),
                "normal": seen.hit.normal.to_array(),
                "columns": cells.shown,
                "more_columns": cells.more,
                "is_from_file": cells.is_from_file,
            });
            if let Some(checked) = checked
                && let Some(range) = scene.text_range(seen.id)
            {
                let span = PageSpan::new(&checked.document().lines(), &range);
                geometry["from"] = json!(span.from);
                geometry["to"] = json!(span.to);
            }
            geometry
        });
        let byte = image.pixel(0, 0).unwrap_or_default();
        Ok(Json(
            json!({"x": x, "y": y, "byte": byte, "geometry": geometry}),
        ))
    })
    .await
}

pub(super) async fn why(
    State(App { desk, .. }): State<App>,
    asked: Asked,
) -> Result<String, Refusal> {
    apart_until_dropped(move |cancel| {
        let scene = asked.view()?.of(&*asked.scene(&desk)?)?;
        let size = scene.size();
        let y = size.height().checked_sub(asked.y.saturating_add(1));
        let y = y.filter(|_| asked.x < size.width());
        let y = y.ok_or_else(|| refuse::impossible("the pixel is outside the picture"))?;
        let frame = scene.animation().map(|_| asked.frame);
        let camera = scene.camera();
        Ok(
            Explanation::new(&scene, camera, frame, size, ((asked.x, y), None), cancel)?
                .to_string(),
        )
    })
    .await
}

/// A movement that is to be written into the text.
#[derive(Deserialize)]
pub(super) struct Move {
    version: u64,
    view: MoveView,
    motion: Option<Vec<f64>>,
    geometry: Option<String>,
    by: Option<[f64; 2]>,
    #[serde(default)]
    frame_all: bool,
}

#[derive(Deserialize)]
struct MoveView {
    camera: Option<String>,
    #[serde(default)]
    frame: u32,
}

pub(super) fn shift(desk: &Desk, asked: Move) -> Answer {
    let checked = checked(desk, asked.version)?;
    let view = View {
        camera: asked.view.camera.filter(|name| !name.is_empty()),
        frame: asked.view.frame,
        motion: motion_of(asked.motion.as_deref().unwrap_or(&[0.0; 5]))?,
        ..View::default()
    };
    let edits = match (asked.geometry, asked.by) {
        (Some(geometry), Some(by)) => {
            let geometry: Origin = geometry.parse()?;
            checked.move_geometry(&view, &geometry, by)?
        }
        _ if asked.frame_all => checked.frame_all(&view)?,
        _ => checked.move_camera(&view)?,
    };
    new_edits(checked.document(), &edits)
}
