//! What options add to a scene that has none of it.

use crate::scene::{
    format::{
        light::{HeadlightLightModel, LightModel},
        outlines::OutlinesModel,
        scene::Model,
    },
    options::ReadOptions,
};

/// What is added to a scene before its values are set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Additions {
    headlight: bool,
    outlines: bool,
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
    }
}

impl ReadOptions {
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
    #[must_use]
    pub fn headlight(mut self, add: bool) -> Self {
        self.additions.headlight = add;
        self
    }

    /// Adds the default outlines to a scene that has no `outlines`.
    #[must_use]
    pub fn outlines(mut self, add: bool) -> Self {
        self.additions.outlines = add;
        self
    }
}
