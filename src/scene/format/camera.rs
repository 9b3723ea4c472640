//! The `camera` of a scene file.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        field::{Triple, variants},
        orthographic::OrthographicModel,
        perspective::PerspectiveModel,
    },
    tracer::{camera::Camera, error::GeometryError},
};

/// The default up direction.
pub(crate) const UP: Triple = [0.0, 1.0, 0.0];

/// A camera: the viewpoint of the scene and its projection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Camera", deny_unknown_fields)]
pub enum CameraModel {
    /// A pinhole camera: all rays start at the eye.
    Perspective(PerspectiveModel),
    /// A camera of parallel rays: what is far is as large as what is near.
    Orthographic(OrthographicModel),
}

/// The directions of a camera, with the defaults filled in.
pub(crate) struct Sight {
    /// The point that rays start at, or the middle of the picture.
    pub(crate) eye: DVec3,
    /// The direction of view: `gaze`, or `look_at - eye`; 0 where neither is given.
    pub(crate) gaze: DVec3,
    /// The point `look_at`, where there is one.
    pub(crate) target: DVec3,
    /// True if `gaze` comes from `look_at`.
    pub(crate) by_point: bool,
    /// The direction that is up.
    pub(crate) up: DVec3,
    /// True if the scene gives no `up`.
    pub(crate) up_is_default: bool,
}

impl Sight {
    fn new(eye: Triple, gaze: Option<Triple>, look_at: Option<Triple>, up: Option<Triple>) -> Self {
        let seen = look_at.map(|point| DVec3::from(point) - DVec3::from(eye));
        Self {
            eye: eye.into(),
            gaze: gaze.map(DVec3::from).or(seen).unwrap_or(DVec3::ZERO),
            target: look_at.unwrap_or_default().into(),
            by_point: gaze.is_none() && seen.is_some(),
            up: up.unwrap_or(UP).into(),
            up_is_default: up.is_none(),
        }
    }

    /// Returns the field that the gaze comes from, and its name in messages.
    pub(crate) const fn name(&self) -> (&'static str, &'static str) {
        if self.by_point {
            ("look_at", "`look_at` - `eye`")
        } else {
            ("gaze", "`gaze`")
        }
    }
}

/// The fields that every camera has, where they may be written.
pub(crate) struct Pose<'m> {
    pub(crate) eye: &'m mut Triple,
    pub(crate) gaze: &'m mut Option<Triple>,
    pub(crate) look_at: &'m mut Option<Triple>,
    pub(crate) up: &'m mut Option<Triple>,
}

variants! {
    CameraModel {
        Perspective(PerspectiveModel),
        Orthographic(OrthographicModel),
    }
}

/// Evaluates an expression for each kind of camera.
macro_rules! of_each {
    ($self:expr, $model:ident => $value:expr) => {
        match $self {
            Self::Perspective($model) => $value,
            Self::Orthographic($model) => $value,
        }
    };
}

impl CameraModel {
    /// The camera.
    pub(crate) fn build(&self) -> Result<Camera, GeometryError> {
        let sight = self.sight();
        of_each!(self, camera => camera.build(&sight))
    }

    /// The directions of the camera.
    pub(crate) fn sight(&self) -> Sight {
        of_each!(self, camera => Sight::new(camera.eye, camera.gaze, camera.look_at, camera.up))
    }

    /// The fields that every camera has.
    pub(crate) fn pose(&mut self) -> Pose<'_> {
        of_each!(self, camera => Pose {
            eye: &mut camera.eye,
            gaze: &mut camera.gaze,
            look_at: &mut camera.look_at,
            up: &mut camera.up,
        })
    }

    /// Returns the full vertical angle of view in degrees, if the camera has one.
    pub(crate) const fn angle(&self) -> Option<f64> {
        match self {
            Self::Perspective(camera) => Some(camera.fov),
            Self::Orthographic(_) => None,
        }
    }

    /// Returns true for `gaze` and for `look_at` if given.
    pub(crate) const fn aims(&self) -> (bool, bool) {
        of_each!(self, camera => (camera.gaze.is_some(), camera.look_at.is_some()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn perspective(gaze: Option<Triple>, look_at: Option<Triple>) -> CameraModel {
        CameraModel::Perspective(PerspectiveModel {
            eye: [1.0, 2.0, 3.0],
            gaze,
            look_at,
            up: None,
            fov: 90.0,
        })
    }

    #[test]
    fn look_at_is_a_point_and_gaze_a_direction() {
        let by_point = perspective(None, Some([1.0, 2.0, -7.0])).build().unwrap();
        assert_eq!(by_point.gaze(), DVec3::new(0.0, 0.0, -10.0));
        assert_eq!(by_point.up(), DVec3::Y);
        let by_direction = perspective(Some([0.0, 0.0, -2.0]), None).build().unwrap();
        assert_eq!(by_direction.w(), by_point.w());
        assert!(perspective(None, None).build().is_err());
    }

    #[test]
    fn pixels_are_square_unless_stretched() {
        let orthographic = |stretch| {
            CameraModel::Orthographic(OrthographicModel {
                eye: [0.0; 3],
                gaze: Some([0.0, 0.0, -1.0]),
                look_at: None,
                up: None,
                scale: 2.0,
                stretch,
            })
        };
        let corner = |stretch| {
            let camera = orthographic(stretch).build().unwrap();
            camera.ray_for(3, 2, 2.0, 1.0).origin()
        };
        assert_eq!(corner(None), DVec3::new(2.0, 1.0, 0.0));
        assert_eq!(corner(Some(false)), DVec3::new(2.0, 1.0, 0.0));
        assert_eq!(corner(Some(true)), DVec3::new(1.0, 1.0, 0.0));
    }
}
