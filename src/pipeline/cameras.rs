//! The cameras of a scene.

use glam::DVec3;

use super::{Scene, animation::Moving, refused};
use crate::{
    diagnostic::error::Error,
    film::{
        Outlines,
        samples::{SampleCount, Samples},
        size::Size,
    },
    parallel::Cancel,
    scene::{
        format::{
            camera::CameraModel,
            fit::{
                FitModel, OrthographicProjectionModel, PerspectiveProjectionModel, ProjectionModel,
            },
            scene::Model,
        },
        framing::{Framing, Known, Subject},
        unknown,
    },
    tracer::{camera::Camera, world::World},
};

/// The cameras of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cameras {
    /// The camera that the scene is rendered with.
    pub(super) chosen: Viewpoint,
    /// Its index among the named cameras, if it was chosen by name.
    pub(super) index: Option<usize>,
    /// The camera without a name.
    pub(super) unnamed: Option<Viewpoint>,
    pub(super) named: Vec<(Box<str>, Viewpoint)>,
}

/// A camera in the picture of the scene's size.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Viewpoint {
    pub(super) camera: Camera,
    /// The point that it looks at, if the scene gives one.
    pub(super) target: Option<DVec3>,
    /// The camera of the scene, if that frames the geometries.
    pub(super) fit: Option<FitModel>,
}

impl Scene {
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
                let aperture = camera.lens().map(|[aperture, _]| aperture);
                let projection = PerspectiveProjectionModel { fov, aperture };
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

    /// Returns the same scene for a picture of `factor` times the size that shows the same, with outlines as much
    /// wider; `None` if there is none.
    pub(crate) fn magnified(self, factor: u32) -> Option<Self> {
        let (width, height) = (self.size.width(), self.size.height());
        let camera = self.camera().magnified(width, height, factor)?;
        let size = Size::new(width.checked_mul(factor)?, height.checked_mul(factor)?);
        let outlines = self.outlines.map(|outlines| Outlines {
            width: outlines.width * f64::from(factor),
            ..outlines
        });
        Some(Self {
            size: size.ok()?,
            outlines,
            ..self.seen_by(camera)
        })
    }

    /// Returns the samples of a pixel of [`Scene::magnified`], given those of the picture. With outlines both
    /// pictures have about as many in all: the time grows with the fourth power of the width in samples.
    pub(crate) fn samples_magnified(&self, samples: SampleCount, factor: u32) -> SampleCount {
        let fewer = |samples: Samples| {
            let side = samples.side();
            let fewer = side.div_ceil(factor.max(1)).max(side.min(2));
            Samples::new(fewer * fewer).ok()
        };
        let is_grid = self.outlines.is_some() && self.world.paths().is_none();
        let grid = is_grid.then(|| samples.grid().ok()).flatten();
        grid.and_then(fewer).map_or(samples, SampleCount::from)
    }
}

impl Cameras {
    /// Builds the cameras of a model at a frame. The unnamed camera is chosen, else the first.
    pub(super) fn of(
        model: &Model,
        framing: &Framing,
        number: u32,
        file: &str,
    ) -> Result<Self, Error> {
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
    pub(super) fn choose(&mut self, index: usize) {
        if let Some((_, camera)) = self.named.get(index) {
            self.chosen = camera.clone();
            self.index = Some(index);
        }
    }
}

/// Returns what the cameras of a scene frame.
pub(super) fn framing<'a>(
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
