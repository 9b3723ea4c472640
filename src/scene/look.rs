//! Looks: light that suits any scene.

use glam::DVec3;

use crate::{
    diagnostic::named::named,
    scene::{
        additions::drop_tracks,
        format::{
            color::ColorModel,
            light::{
                LightModel,
                directional::DirectionalLightModel,
                environment::{EnvironmentLightModel, SkyModel},
            },
            lighting::{LightingModel, PathModel},
            numbers::Triple,
            scene::Model,
            sight::UP,
        },
    },
    tracer::vector::unit,
};

named! {
    /// Light that suits any scene, in place of the lights that it has.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Look {
        /// A bright sky that the camera does not see, and a large sun from the upper left behind the camera.
        /// Light follows 256 paths per pixel.
        Studio = "studio",
    }
}

/// The direction to the sun: to the right, up and toward the viewer.
const TO_SUN: [f64; 3] = [-0.6, 0.9, 0.6];

impl Look {
    /// The fields of a scene that it replaces.
    pub(crate) const FIELDS: [&str; 2] = ["lights", "lighting"];

    /// Lights a scene. Tracks of its own lights are gone.
    pub(crate) fn light(self, model: &mut Model) {
        model.lighting = Some(self.lighting());
        let lights = self.lights(model);
        model.lights = Some(lights);
        // Only outlines would still use it, and a warning would not be about the scene.
        if let Some(image) = model.image.as_mut().filter(|_| model.outlines.is_none()) {
            image.samples = None;
        }
        drop_tracks(model, &Self::FIELDS);
    }

    /// Returns how light is evaluated.
    pub(crate) fn lighting(self) -> LightingModel {
        match self {
            Self::Studio => LightingModel::Path(PathModel {
                samples: Some(256),
                ..PathModel::default()
            }),
        }
    }

    /// Returns the lights of a scene, for its first camera.
    pub(crate) fn lights(self, model: &Model) -> Vec<LightModel> {
        let sight = model.all_cameras().next().map(|(_, camera)| camera.sight());
        let (gaze, up) = sight.map_or((DVec3::NEG_Z, UP.into()), |sight| (sight.gaze, sight.up));
        let color = |hex: &str| ColorModel::parse(hex);
        match self {
            Self::Studio => vec![
                LightModel::Environment(EnvironmentLightModel {
                    sky: Some(SkyModel {
                        zenith: color("#ffffff"),
                        horizon: color("#d8dee6"),
                        ground: color("#8f8a84"),
                    }),
                    up: Some(up.into()).filter(|up| *up != UP),
                    visible: Some(false),
                    intensity: Some(0.6),
                    ..EnvironmentLightModel::default()
                }),
                LightModel::Directional(DirectionalLightModel {
                    direction: from_sun(gaze, up),
                    angle: Some(10.0),
                    color: Some(color("#fff1de")),
                    intensity: Some(0.6),
                    ..DirectionalLightModel::default()
                }),
            ],
        }
    }
}

/// Returns the direction in which the light of the sun goes, to three places.
fn from_sun(gaze: DVec3, up: DVec3) -> Triple {
    let right = gaze.cross(up);
    let front = up.cross(right);
    let [x, y, z] = TO_SUN;
    let axes = [right, up, -front].map(|axis| {
        if axis == DVec3::ZERO {
            axis
        } else {
            unit(axis)
        }
    });
    let to_sun = x * axes[0] + y * axes[1] + z * axes[2];
    // No -0.
    (-to_sun)
        .to_array()
        .map(|part| (part * 1000.0).round() / 1000.0 + 0.0)
}
