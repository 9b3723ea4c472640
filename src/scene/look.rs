//! Looks: light that suits any scene.

use glam::DVec3;

use crate::{
    diagnostic::named::named,
    scene::{
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
        path::{self, PathPart},
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
    /// Lights a scene. Tracks of its own lights are gone.
    pub(crate) fn light(self, model: &mut Model) {
        model.lighting = Some(self.lighting());
        let lights = self.lights(model);
        model.lights = Some(lights);
        // Only outlines would still use it, and a warning would not be about the scene.
        if let Some(image) = model.image.as_mut().filter(|_| model.outlines.is_none()) {
            image.samples = None;
        }
        let tracks = model.animation.as_mut();
        if let Some(tracks) = tracks.and_then(|animation| animation.tracks.as_mut()) {
            tracks.0.retain(|(path, _)| !changes_light(path));
        }
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

/// Returns true if a track changes the light of a scene.
pub(crate) fn changes_light(track: &str) -> bool {
    let parts = path::parts(track).unwrap_or_default();
    let first = parts.first().and_then(PathPart::name);
    matches!(first, Some("lights" | "lighting"))
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
