//! The pipeline that turns a scene file into a picture, and joins the other modules.

pub(crate) mod animation;
mod bands;
mod contents;
mod effects;
mod fingerprint;
mod hash;
pub(crate) mod options;
mod picture;

use std::{
    fmt,
    ops::Range,
    path::Path,
    sync::{Arc, OnceLock},
};

use self::animation::Moving;
use glam::DVec3;

use crate::{
    diagnostic::{Diagnostic, error::Error},
    film::{Outlines, Wanted, samples::Samples, size::Size},
    parallel::{
        Cancel,
        timings::{Stage, Timings},
    },
    render::{
        explained::{ExplainedPixel, View},
        ray_tracer::RayTracer,
    },
    scene::{
        build::{self, Built},
        document::Document,
        format::{
            camera::CameraModel,
            fit::{
                FitModel, OrthographicProjectionModel, PerspectiveProjectionModel, ProjectionModel,
            },
            outlines::OutlinesModel,
            scene::Model,
        },
        framing::{Framing, Known, Subject},
        locate::range_of,
        options::ReadOptions,
        origin::Origin,
        origins::Origins,
        part::PartPlace,
        scales::{ColorValues, Scales},
        source::Source,
        unknown,
    },
    text::syntax::Syntax,
    tracer::{camera::Camera, colormap::scale::ColorScale, tone::Tone, world::World},
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
    /// The hash of the world, computed by `hash.rs` on first use.
    world_hash: Arc<OnceLock<String>>,
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
    /// The number of the frame.
    frame: u32,
    warnings: Arc<[Diagnostic]>,
    source: Arc<Source>,
    timings: Timings,
}

/// The cameras of a scene.
#[derive(Clone, Debug, PartialEq)]
struct Cameras {
    /// The camera that the scene is rendered with.
    chosen: Viewpoint,
    /// Its index among the named cameras, if it was chosen by name.
    index: Option<usize>,
    /// The camera without a name.
    unnamed: Option<Viewpoint>,
    named: Vec<(Box<str>, Viewpoint)>,
}

/// A camera in the picture of the scene's size.
#[derive(Clone, Debug, PartialEq)]
struct Viewpoint {
    camera: Camera,
    /// The point that it looks at, if the scene gives one.
    target: Option<DVec3>,
    /// The camera of the scene, if that frames the geometries.
    fit: Option<FitModel>,
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

    /// Returns the current camera: the one chosen with [`Scene::with_camera`], else the scene's
    /// `camera`, else the first of its `cameras`.
    pub const fn camera(&self) -> &Camera {
        &self.cameras.chosen.camera
    }

    /// Returns the current camera for a picture of another size. It differs from [`Scene::camera`]
    /// only if it is a `Fit` of the scene, which frames the geometries in that picture.
    ///
    /// # Errors
    ///
    /// A size so narrow that the geometries cannot be framed.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Size, Syntax};
    ///
    /// let text = r##"(
    ///     image: (width: 100, height: 100),
    ///     camera: Fit(from: (0, 0, 1)),
    ///     geometries: [Sphere(center: (1, 2, 3), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// let narrow = scene.camera_for(Size::new(50, 100)?)?;
    /// assert_eq!((narrow.eye().x, narrow.eye().y), (1.0, 2.0));
    /// assert!(narrow.eye().z > scene.camera().eye().z);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn camera_for(&self, size: Size) -> Result<Camera, Error> {
        let Viewpoint { camera, fit, .. } = &self.cameras.chosen;
        let Some(fit) = fit.as_ref().filter(|_| size != self.size) else {
            return Ok(*camera);
        };
        let framing = framing(&self.world, self.moving.as_deref(), &self.known, None);
        let camera = CameraModel::Fit(fit.clone());
        let camera = framing.build(&camera, (size.width(), size.height()), self.frame);
        camera.map_err(|error| refused(&self.file, &error))
    }

    /// Returns the current camera as far away that all bounded geometries are in the picture, in all frames.
    pub(crate) fn camera_of_all(&self) -> Result<Camera, Error> {
        let camera = self.camera();
        let (width, height) = (self.size.width(), self.size.height());
        let (projection, size) = match camera {
            Camera::Perspective(camera) => {
                let fov = 2.0 * camera.half_angle().to_degrees();
                let projection = PerspectiveProjectionModel { fov };
                (ProjectionModel::Perspective(projection), (width, height))
            }
            Camera::Orthographic(camera) => {
                let projection = ProjectionModel::Orthographic(OrthographicProjectionModel {});
                // A stretched picture is as wide in the scene as it is high.
                let width = if camera.stretch() { height } else { width };
                (projection, (width, height))
            }
        };
        let fit = FitModel {
            from: Some((-camera.gaze()).into()),
            up: Some(camera.up().into()),
            projection: Some(projection),
            margin: None,
        };
        let framing = framing(&self.world, self.moving.as_deref(), &self.known, None);
        let camera = framing.explicit(&fit, size);
        let camera = camera.and_then(|camera| camera.build());
        camera.map_err(|error| refused(&self.file, &error))
    }

    /// Returns the same scene for a picture of this size, in which the current camera, if it is a
    /// `Fit` of the scene, frames the geometries of these scenes instead, always the same ones. It
    /// frames those of a scene with an animation in all its frames.
    ///
    /// # Errors
    ///
    /// Scenes that cannot be framed.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let scene = |radius| {
    ///     let text = format!(
    ///         "(camera: Fit(), geometries: [Sphere(center: (0, 0, 0), radius: {radius}, color: \"#f00\")])"
    ///     );
    ///     Scene::from_text(text, Syntax::Ron)
    /// };
    /// let scenes = [scene(1)?, scene(2)?];
    /// let [small, large] = scenes.clone();
    /// let size = small.size();
    /// assert_ne!(small.camera().eye(), large.camera().eye());
    /// let small = small.framed_with(&scenes, size)?;
    /// assert_eq!(small.camera().eye(), large.camera().eye());
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn framed_with(self, scenes: &[Self], size: Size) -> Result<Self, Error> {
        let (Some(fit), Some(first)) = (&self.cameras.chosen.fit, scenes.first()) else {
            return Ok(self);
        };
        let all = scenes.iter();
        let all =
            all.map(|scene| framing(&scene.world, scene.moving.as_deref(), &scene.known, None));
        let all: Vec<_> = all.collect();
        let known = &first.known_together;
        let camera = known.explicit(&all, fit, (size.width(), size.height()));
        let camera = camera.and_then(|camera| camera.build());
        let camera = camera.map_err(|error| refused(&self.file, &error))?;
        Ok(self.seen_by(camera))
    }

    /// Returns true if the current camera is a `Fit` of the scene, which frames the geometries.
    pub const fn is_framed(&self) -> bool {
        self.cameras.chosen.fit.is_some()
    }

    /// Returns the `look_at` of the current camera, if it has one.
    pub(crate) const fn target(&self) -> Option<DVec3> {
        self.cameras.chosen.target
    }

    /// Returns true if the scene has a `camera`, the one without a name.
    pub const fn has_camera(&self) -> bool {
        self.cameras.unnamed.is_some()
    }

    /// Returns the names of the scene's `cameras`, in file order.
    pub fn cameras(&self) -> impl ExactSizeIterator<Item = &str> {
        self.cameras.named.iter().map(|(name, _)| &**name)
    }

    /// Returns the same scene with one of its `cameras` chosen.
    ///
    /// # Errors
    ///
    /// An unknown name; [`Error::diagnostics`] suggests a similar one.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     cameras: {
    ///         "front": Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    ///         "top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4),
    ///     },
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// assert!(scene.cameras().eq(["front", "top"]));
    /// assert_eq!(scene.with_camera("top")?.camera().eye().y, 9.0);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn with_camera(mut self, name: &str) -> Result<Self, Error> {
        let Some(index) = self.cameras().position(|other| other == name) else {
            let known: Vec<_> = self.cameras().collect();
            return Err(Error::usage(unknown::name("camera", name, &known)));
        };
        self.cameras.choose(index);
        Ok(self)
    }

    /// Returns the same scene seen by another camera, which need not be one of its own.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{OrthographicCamera, Scene, Syntax, Vec3};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let top = OrthographicCamera::new(Vec3::Y * 9.0, Vec3::NEG_Y, Vec3::NEG_Z, 4.0)?;
    /// let scene = Scene::from_text(text, Syntax::Ron)?.seen_by(top);
    /// assert_eq!(scene.camera().eye().y, 9.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn seen_by(mut self, camera: impl Into<Camera>) -> Self {
        self.cameras.chosen = Viewpoint {
            camera: camera.into(),
            fit: None,
            ..self.cameras.chosen
        };
        self
    }

    /// Returns the same scene for a picture of `factor` times the size that shows the same, `None` if there
    /// is none, or if it has outlines: as much wider, they would take `factor`⁴ the time.
    pub(crate) fn magnified(self, factor: u32) -> Option<Self> {
        if self.outlines.is_some() {
            return None;
        }
        let (width, height) = (self.size.width(), self.size.height());
        let camera = self.camera().magnified(width, height, factor)?;
        let size = Size::new(width.checked_mul(factor)?, height.checked_mul(factor)?);
        Some(Self {
            size: size.ok()?,
            ..self.seen_by(camera)
        })
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

    /// Returns the position in the scene of a geometry, by its index in the world. Each row of a
    /// table and each geometry of a group is one of its own; those of a part have the position of
    /// the part.
    pub fn origin(&self, index: usize) -> Origin {
        self.origins.of(index)
    }

    /// Returns the places of a geometry in the parts that hold it, by its index in the world: first
    /// in the part that the scene names. A geometry of the scene itself has none.
    pub fn places_in_parts(&self, index: usize) -> Vec<PartPlace<'_>> {
        let mut places = Vec::new();
        if let Some((part, index)) = self.origins.part_of(index) {
            part.add_to(&mut places, index);
        }
        places
    }

    /// Returns the indices in the world of a geometry of the scene: one, or the rows of a table, or
    /// the geometries of a part or a group.
    pub(crate) fn indices(&self, origin: &Origin) -> Range<usize> {
        self.origins.indices(origin)
    }

    /// Returns the name of a geometry in the scene, by its index in the world. All rows of a table
    /// have the name of the table, and all geometries of a part that of the part.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    ///     geometries: [
    ///         Sphere(center: (2, 0, -3), radius: 0.5, color: "#00ff00"),
    ///         Sphere(center: (0, 0, -3), radius: 0.5, color: "#ff0000", name: "ball"),
    ///     ],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// assert_eq!([scene.name(0), scene.name(1)], [None, Some("ball")]);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn name(&self, index: usize) -> Option<&str> {
        self.origins.name(index)
    }

    /// Returns the names of the groups that hold a geometry, by its index in the world, the outermost
    /// first. Groups without a name are left out.
    pub fn groups(&self, index: usize) -> Vec<&str> {
        self.origins.groups(index)
    }

    /// Returns each table and each mesh whose values determine its colors, in the order of the scene.
    pub fn color_values(&self) -> impl Iterator<Item = ColorValues<'_>> {
        self.scales.all(&self.world, &self.origins).into_iter()
    }

    /// Returns the value that determines the color of a row of a table, by its index in the world, and
    /// the colors of all values of the table; `None` if no value does. Those of a mesh depend on the
    /// point: see [`Hit::interpolation`](crate::Hit::interpolation).
    pub fn value(&self, index: usize) -> Option<(f64, &ColorScale)> {
        self.scales.of(index)
    }

    /// Returns the position in the scene text of a geometry, by its index in the world.
    ///
    /// The range is in bytes, with the end exclusive. A row of a table has the range of the
    /// geometry that names the table, a geometry of a part that of the part. `None` if the text was not kept
    /// ([`ReadOptions::keep_text`](crate::ReadOptions::keep_text)).
    ///
    /// # Examples
    ///
    /// From a pixel to the text:
    ///
    /// ```
    /// use strahl::{Document, Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    ///     geometries: [Sphere(center: (0, 0, -3), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// let seen = scene.geometry_at(320, 240).and_then(|index| scene.text_range(index));
    /// assert!(text[seen.unwrap()].starts_with("Sphere("));
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn text_range(&self, index: usize) -> Option<Range<usize>> {
        let path = self.origin(index).path();
        range_of(self.source.text(), self.source.tree(), path.steps())
    }

    /// Returns the index in the world of the geometry at the center of a pixel, or `None` if the
    /// pixel shows the background.
    ///
    /// The picture has the size given by the scene; `x` counts from the left, `y` from the top.
    pub fn geometry_at(&self, x: u32, y: u32) -> Option<usize> {
        let (width, height) = (self.size.width(), self.size.height());
        let y = height.checked_sub(y.checked_add(1)?)?;
        let camera = self.camera();
        let ray = camera.ray_for(width, height, f64::from(x), f64::from(y));
        self.world.hit(&ray).map(|(index, _)| index)
    }

    /// Returns every step from the samples of a pixel to its light; `None` for a flat picture with
    /// one sample per pixel, without outlines. `y` counts from the bottom.
    ///
    /// # Errors
    ///
    /// Outlines that are too wide for a picture.
    #[doc(hidden)]
    pub fn explain(&self, size: Size, x: u32, y: u32) -> Result<Option<ExplainedPixel>, Error> {
        let above = y.checked_add(1);
        let row = above.and_then(|above| size.height().checked_sub(above));
        let camera = self.camera_for(size).ok();
        let (Some(row), Some(camera)) = (row.filter(|_| x < size.width()), camera) else {
            return Ok(None);
        };
        let view = View {
            camera: &camera,
            world: &self.world,
            size,
            samples: self.samples,
            outlines: self.outlines,
            tone: self.world.tone(self.tone),
            is_shaded: RayTracer::with_size(&camera, &self.world, size)
                .outlines(self.outlines)
                .is_shaded(Wanted::Light),
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

    /// Returns the number of samples per pixel given by the scene.
    pub const fn samples(&self) -> Samples {
        self.samples
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
        let moving = Moving::of(&model, &tables).map(Arc::new);
        if let Some(moving) = &moving {
            let shown = moving.show(0, &mut model, &mut tables);
            shown.map_err(|error| refused(&name, &error))?;
        }
        let file: Arc<str> = name.into();
        let image = model.image.clone().unwrap_or_default();
        let (width, height) = image.sides();
        let (tone, outlines) = (
            image.tone(),
            model.outlines.as_ref().map(OutlinesModel::build),
        );
        let samples = image.samples.map_or(Ok(Samples::ONE), Samples::new);
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
        Ok(Self {
            cameras,
            world: world.into(),
            world_hash: Arc::default(),
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
            warnings: warnings.into(),
            source,
            timings,
            file,
        })
    }
}

/// Returns what the cameras of a scene frame.
fn framing<'a>(
    world: &'a World,
    moving: Option<&'a Moving>,
    known: &'a Known,
    cancel: Option<&'a Cancel>,
) -> Framing<'a> {
    Framing {
        subject: moving
            .and_then(Moving::subject)
            .unwrap_or(Subject::World(world)),
        frames: moving.map(Moving::frames),
        known,
        cancel,
    }
}

/// Returns the error for a scene that validation should have rejected.
fn refused(file: &str, error: &dyn fmt::Display) -> Error {
    Error::scene(format!("{file}: {error}"), vec![], String::new())
}

impl Cameras {
    /// Builds the cameras of a model at a frame. The unnamed camera is chosen, else the first.
    fn of(model: &Model, framing: &Framing, number: u32, file: &str) -> Result<Self, Error> {
        let build = |camera: &CameraModel| {
            let built = framing.build(camera, model.sides(), number);
            Ok(Viewpoint {
                camera: built.map_err(|error| refused(file, &error))?,
                target: camera.sight().target(),
                fit: match camera {
                    CameraModel::Fit(fit) => Some(fit.clone()),
                    CameraModel::Perspective(_) | CameraModel::Orthographic(_) => None,
                },
            })
        };
        let unnamed = model.camera.as_ref().map(build).transpose()?;
        let named = model
            .all_cameras()
            .filter_map(|(name, camera)| Some((name?, camera)));
        let named = named.map(|(name, camera)| Ok::<_, Error>((name.into(), build(camera)?)));
        let named: Vec<(Box<str>, Viewpoint)> = named.collect::<Result<_, _>>()?;
        let first = || Some(named.first()?.1.clone());
        let chosen = unnamed
            .clone()
            .or_else(first)
            .ok_or_else(|| refused(file, &"there is no camera"))?;
        Ok(Self {
            chosen,
            index: None,
            unnamed,
            named,
        })
    }

    /// Chooses a named camera.
    fn choose(&mut self, index: usize) {
        if let Some((_, camera)) = self.named.get(index) {
            self.chosen = camera.clone();
            self.index = Some(index);
        }
    }
}
