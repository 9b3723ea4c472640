//! The pipeline that turns a scene file into a picture, and joins the other modules.

pub(crate) mod animation;
mod bands;
mod cameras;
mod contents;
mod effects;
mod fingerprint;
mod hash;
pub(crate) mod options;
mod picture;
mod rounds;

use std::{fmt, path::Path, sync::Arc};

use self::{
    animation::Moving,
    cameras::{Cameras, framing},
    fingerprint::WorldHash,
};
use crate::{
    accel::kept::Kept,
    diagnostic::{Diagnostic, error::Error},
    film::{
        Outlines,
        samples::{SampleCount, Samples},
        size::Size,
    },
    parallel::{
        Cancel,
        timings::{Stage, Timings},
    },
    render::explained::{ExplainedPixel, PixelSource},
    scene::{
        build::{self, Built},
        document::Document,
        format::{lighting::LightingModel, outlines::OutlinesModel, scene::Model},
        framing::Known,
        options::ReadOptions,
        origins::Origins,
        scales::Scales,
        source::Source,
    },
    text::syntax::Syntax,
    tracer::{tone::Tone, world::World},
};

/// A scene without errors, ready to be rendered.
///
/// # Examples
///
/// ```no_run
/// strahl::Scene::from_path("scenes/gallery.ron")?.save("gallery.png")?;
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file name in reports.
    file: Arc<str>,
    cameras: Cameras,
    world: Arc<World>,
    world_hash: Arc<WorldHash>,
    /// The last results of framing several scenes of which this is the first.
    known_together: Arc<Known>,
    /// The results of cameras that frame the scene.
    known: Arc<Known>,
    origins: Arc<Origins>,
    scales: Arc<Scales>,
    size: Size,
    samples: Samples,
    tone: Tone,
    outlines: Option<Outlines>,
    moving: Option<Arc<Moving>>,
    /// What the frames share; `None` if too little of the world stands still.
    kept: Option<Arc<Kept>>,
    /// The number of the frame.
    frame: u32,
    warnings: Arc<[Diagnostic]>,
    source: Arc<Source>,
    timings: Timings,
}

impl Scene {
    /// Reads a scene file. The syntax follows from its extension, `.ron` or `.json`.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and a scene with errors.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let options = ReadOptions::new().keep_text(false);
        Document::from_path_with(path, &options)?.try_into()
    }

    /// Reads a scene from text.
    ///
    /// # Errors
    ///
    /// A scene with errors.
    pub fn from_text(text: impl Into<String>, syntax: Syntax) -> Result<Self, Error> {
        Document::from_text("<text>", text, syntax).try_into()
    }

    /// Returns true if all pictures of both scenes are certainly equal, of every camera and layer. Those of
    /// animations are not compared.
    pub(crate) fn looks_like(&self, other: &Self) -> bool {
        let fields = |scene: &Self| (scene.size, scene.samples, scene.tone, scene.outlines);
        fields(self) == fields(other)
            && self.cameras == other.cameras
            && self.world == other.world
            && self.moving.is_none()
            && other.moving.is_none()
    }

    /// Returns the exposure and tone mapping of a lit picture.
    pub const fn tone(&self) -> Tone {
        self.tone
    }

    /// Returns the same scene with another exposure or tone mapping.
    #[must_use]
    pub fn with_tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// Returns the name of the scene file in reports.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the world: the background and the geometries.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns every step from the samples of a pixel to its light; `None` for a flat picture with
    /// one sample per pixel, without outlines. `y` counts from the bottom. Where light follows paths, the path of
    /// one sample may be asked for.
    ///
    /// # Errors
    ///
    /// Outlines that are too wide for a picture.
    #[doc(hidden)]
    pub fn explain(
        &self,
        size: Size,
        (x, y): (u32, u32),
        sample: Option<u32>,
        cancel: &Cancel,
    ) -> Result<Option<ExplainedPixel>, Error> {
        let above = y.checked_add(1);
        let row = above.and_then(|above| size.height().checked_sub(above));
        let camera = self.camera_for(size).ok();
        let (Some(row), Some(camera)) = (row.filter(|_| x < size.width()), camera) else {
            return Ok(None);
        };
        let view = PixelSource {
            camera: &camera,
            world: &self.world,
            size,
            samples: self.samples,
            outlines: self.outlines,
            tone: self.world.tone(self.tone),
            is_shaded: self.mixes_colors(),
            sample,
            cancel,
        };
        let is_one_color = !view.is_shaded && self.samples == Samples::ONE;
        if is_one_color {
            return Ok(None);
        }
        view.explain(x, row).map(Some)
    }

    /// Returns the size of the picture given by the scene.
    pub const fn size(&self) -> Size {
        self.size
    }

    /// Returns the number of samples per pixel given by the scene: its paths, if light follows paths.
    pub fn samples(&self) -> SampleCount {
        match self.world.paths() {
            Some(paths) => SampleCount::of_paths(paths),
            None => self.samples.into(),
        }
    }

    /// Returns the warnings about probable mistakes, in file order.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Returns the time taken to read, check and build the scene.
    pub const fn timings(&self) -> &Timings {
        &self.timings
    }
}

impl TryFrom<Document> for Scene {
    type Error = Error;

    /// Builds a scene from a document without errors. Tables that the document did not keep are
    /// read again.
    fn try_from(document: Document) -> Result<Self, Error> {
        let name = document.name().to_owned();
        let timings = document.timings().clone();
        let source = Arc::clone(document.source());
        let cancel = document.canceller().cloned();
        let cancel = cancel.as_ref();
        let (mut model, mut tables, warnings) = document.into_parts()?;
        // Validation found no errors, so none of these calls fails.
        let mut moving = Moving::of(&model, &tables);
        if let Some(moving) = &mut moving {
            let shown = moving.start(&mut model, &mut tables);
            shown.map_err(|error| refused(&name, &error))?;
        }
        let moving = moving.map(Arc::new);
        let file: Arc<str> = name.into();
        let image = model.image.clone().unwrap_or_default();
        let (width, height) = image.sides();
        let (tone, outlines) = (
            image.tone(),
            model.outlines.as_ref().map(OutlinesModel::build),
        );
        let samples = match (image.samples, &model.lighting) {
            (Some(samples), _) => Samples::new(samples),
            // Lines have samples of their own.
            (None, Some(LightingModel::Path(_))) if outlines.is_some() => Samples::new(16),
            (None, _) => Ok(Samples::ONE),
        };
        let seen = Model {
            camera: model.camera.clone(),
            cameras: model.cameras.clone(),
            image: model.image.clone(),
            ..Model::default()
        };
        let watch = timings.watch();
        let built = watch.time(Stage::Build, || build::world(model, tables, cancel));
        cancel.map_or(Ok(()), Cancel::check)?;
        let Built {
            world,
            origins,
            scales,
        } = built.map_err(|error| refused(&file, &error))?;
        let known = Arc::default();
        let known_together = Arc::default();
        let framing = framing(&world, moving.as_deref(), &known, cancel);
        let cameras = Cameras::of(&seen, &framing, 0, &file);
        cancel.map_or(Ok(()), Cancel::check)?;
        let cameras = cameras?;
        let kept = moving
            .as_ref()
            .and_then(|moving| Kept::new(&world, moving.places()));
        Ok(Self {
            cameras,
            world_hash: WorldHash::new(&world).into(),
            world: world.into(),
            known,
            known_together,
            frame: 0,
            origins: origins.into(),
            scales: scales.into(),
            size: Size::new(width, height).map_err(|error| refused(&file, &error))?,
            samples: samples.map_err(|error| refused(&file, &error))?,
            tone,
            outlines,
            moving,
            kept: kept.map(Arc::new),
            warnings: warnings.into(),
            source,
            timings,
            file,
        })
    }
}

/// Returns the error for a scene that validation should have rejected.
fn refused(file: &str, error: &dyn fmt::Display) -> Error {
    Error::scene(format!("{file}: {error}"), vec![], String::new())
}
