//! What options add to a scene that has none of it.

use glam::DVec3;

use crate::{
    diagnostic::setters::setters,
    scene::{
        format::{
            camera::CameraModel,
            fit::{
                FitModel, OrthographicProjectionModel, PerspectiveProjectionModel, ProjectionModel,
            },
            light::{HeadlightLightModel, LightModel},
            numbers::Triple,
            outlines::OutlinesModel,
            scene::Model,
            sight::UP,
        },
        look::Look,
        options::ReadOptions,
        path::{self, PathPart},
    },
    tracer::camera::basis::are_parallel,
};

/// What is added to a scene before its values are set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Additions {
    headlight: bool,
    look: Option<Look>,
    outlines: bool,
    /// The direction that all cameras frame the scene from.
    fit: Option<Triple>,
}

impl Additions {
    /// Adds them to a scene, where it has none.
    pub(crate) fn to(self, model: &mut Model) {
        if self.headlight && model.lights.is_none() {
            let headlight = LightModel::Headlight(HeadlightLightModel::default());
            model.lights = Some(vec![headlight]);
        }
        if self.outlines && model.outlines.is_none() {
            model.outlines = Some(OutlinesModel::default());
        }
        if let Some(from) = self.fit {
            fit(model, from);
        }
        if let Some(look) = self.look {
            look.light(model);
        }
    }
}

/// Lets all cameras of a scene frame it, and gives it one if it has none. Their tracks are gone.
fn fit(model: &mut Model, from: Triple) {
    model.camera = Some(framing(model.camera.as_ref(), from));
    for (_, camera) in model.cameras.iter_mut().flat_map(|cameras| &mut cameras.0) {
        *camera = framing(Some(camera), from);
    }
    drop_tracks(model, &["camera", "cameras"]);
}

/// Drops the tracks of some fields of the root.
pub(super) fn drop_tracks(model: &mut Model, fields: &[&str]) {
    let tracks = model.animation.as_mut();
    if let Some(tracks) = tracks.and_then(|animation| animation.tracks.as_mut()) {
        tracks.0.retain(|(path, _)| !is_of(path, fields));
    }
}

/// Returns true if a track is one of some fields of the root.
pub(super) fn is_of(track: &str, fields: &[&str]) -> bool {
    let parts = path::parts(track).unwrap_or_default();
    let first = parts.first().and_then(PathPart::name);
    first.is_some_and(|first| fields.contains(&first))
}

/// Returns the camera with the projection of another that frames the scene from a direction.
fn framing(camera: Option<&CameraModel>, from: Triple) -> CameraModel {
    let (projection, margin) = match camera {
        None => (None, None),
        Some(CameraModel::Perspective(camera)) => {
            let projection = PerspectiveProjectionModel {
                fov: camera.fov,
                aperture: camera.aperture,
            };
            (Some(ProjectionModel::Perspective(projection)), None)
        }
        Some(CameraModel::Orthographic(_)) => {
            let projection = OrthographicProjectionModel {};
            (Some(ProjectionModel::Orthographic(projection)), None)
        }
        Some(CameraModel::Fit(camera)) => (camera.projection.clone(), camera.margin),
    };
    let up = camera.map_or(UP.into(), |camera| camera.sight().up);
    // Seen from above, any other direction is up.
    let ups = [up, DVec3::NEG_Z, DVec3::Y];
    let up = ups.into_iter().find(|up| !are_parallel(from.into(), *up));
    CameraModel::Fit(FitModel {
        from: Some(from),
        up: up.map(Triple::from),
        projection,
        margin,
    })
}

impl ReadOptions {
    setters! {
        /// Lets all cameras of a scene frame its bounded geometries, seen from this direction, as if
        /// each were a `Fit`; a scene without a camera gets one. They keep their projections, and no
        /// track moves them.
        ///
        /// # Examples
        ///
        /// ```
        /// use strahl::{Document, ReadOptions, Scene, Syntax};
        ///
        /// let text = "(geometries: [Sphere(center: (3, 4, 5), radius: 1, color: \"#ff0000\")])";
        /// let options = ReadOptions::new().syntax(Syntax::Ron).fit([0.0, 0.0, 1.0]);
        /// let scene = Scene::try_from(Document::from_reader("ball.ron", text.as_bytes(), &options)?)?;
        /// assert_eq!((scene.camera().eye().x, scene.camera().eye().y), (3.0, 4.0));
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        fit(from: [f64; 3]) => additions.fit = Some(from);

        /// Lights a scene that has no `lights` by a headlight.
        /// [`Document::has_lights`](crate::Document::has_lights) tells whether it has some.
        ///
        /// # Examples
        ///
        /// ```
        /// use strahl::{Document, ReadOptions, Scene, Syntax};
        ///
        /// let text = "(camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 30), \
        ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\")])";
        /// let options = ReadOptions::new().syntax(Syntax::Ron).headlight(true);
        /// let document = Document::from_reader("flat.ron", text.as_bytes(), &options)?;
        /// assert!(!document.has_lights());
        /// assert!(Scene::try_from(document)?.world().lighting().is_some());
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        headlight(add: bool) => additions.headlight = add;

        /// Lights a scene by a look, in place of its own lights and of its `lighting`.
        ///
        /// # Examples
        ///
        /// ```
        /// use strahl::{Document, ReadOptions, Scene, Syntax, scene::Look};
        ///
        /// let text = "(camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 30), \
        ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\")])";
        /// let options = ReadOptions::new().syntax(Syntax::Ron).look(Look::Studio);
        /// let scene = Scene::try_from(Document::from_reader("a.ron", text.as_bytes(), &options)?)?;
        /// assert!(scene.world().lighting().is_some());
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        look(look: impl Into<Option<Look>>) => additions.look = look.into();

        /// Adds the default outlines to a scene that has no `outlines`.
        outlines(add: bool) => additions.outlines = add;
    }
}
