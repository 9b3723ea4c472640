//! The `camera` of a scene file.

use glam::DVec3;

use crate::{
    scene::format::{
        field::Triple,
        fit::{FitModel, ProjectionModel},
        orthographic::OrthographicModel,
        perspective::PerspectiveModel,
        variants::variants,
    },
    tracer::{camera::Camera, error::GeometryError},
};

/// The default up direction.
pub(crate) const UP: Triple = [0.0, 1.0, 0.0];

variants! {
    /// A camera: the viewpoint of the scene and its projection.
    pub enum CameraModel = "Camera" {
        /// A pinhole camera: all rays start at the eye.
        Perspective(PerspectiveModel) | PerspectiveCamera,
        /// A camera with parallel rays: distance does not change size.
        Orthographic(OrthographicModel) | OrthographicCamera,
        /// A camera that frames all bounded geometries.
        Fit(FitModel),
    }
}

/// The directions of a camera, with the defaults filled in.
pub(crate) struct Sight {
    /// The point that rays start at, or the middle of the picture.
    pub(crate) eye: DVec3,
    /// The direction of view: `gaze`, `look_at - eye` or `-from`; 0 where none is given.
    pub(crate) gaze: DVec3,
    /// The point `look_at`, where there is one.
    pub(crate) target: DVec3,
    /// The field that `gaze` comes from.
    pub(crate) aim: Aim,
    /// True if the scene does not give that field.
    pub(crate) aim_is_default: bool,
    /// The direction that is up.
    pub(crate) up: DVec3,
    /// True if the scene gives no `up`.
    pub(crate) up_is_default: bool,
}

/// The field that the direction of view comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// The direction itself.
    Gaze,
    /// A point.
    LookAt,
    /// The opposite direction.
    From,
}

impl Sight {
    fn new(eye: Triple, gaze: Option<Triple>, look_at: Option<Triple>, up: Option<Triple>) -> Self {
        let seen = look_at.map(|point| DVec3::from(point) - DVec3::from(eye));
        Self {
            eye: eye.into(),
            gaze: gaze.map(DVec3::from).or(seen).unwrap_or(DVec3::ZERO),
            target: look_at.unwrap_or_default().into(),
            aim: match gaze.is_none() && seen.is_some() {
                true => Aim::LookAt,
                false => Aim::Gaze,
            },
            aim_is_default: false,
            up: up.unwrap_or(UP).into(),
            up_is_default: up.is_none(),
        }
    }

    /// Returns the field that the gaze comes from, and its name in messages.
    pub(crate) const fn name(&self) -> (&'static str, &'static str) {
        match self.aim {
            Aim::Gaze => ("gaze", "`gaze`"),
            Aim::LookAt => ("look_at", "`look_at` - `eye`"),
            Aim::From => ("from", "`from`"),
        }
    }

    /// Returns the point `look_at`, if the camera has one.
    pub(crate) fn target(&self) -> Option<DVec3> {
        (self.aim == Aim::LookAt).then_some(self.target)
    }
}

impl CameraModel {
    /// The camera. A [`FitModel`] has no place before it frames anything:
    /// [`FitModel::explicit`].
    pub(crate) fn build(&self) -> Result<Camera, GeometryError> {
        let sight = self.sight();
        match self {
            Self::Perspective(camera) => camera.build(&sight),
            Self::Orthographic(camera) => camera.build(&sight),
            Self::Fit(_) => Err(GeometryError::NothingToFit),
        }
    }

    /// Returns true if the camera frames the geometries.
    pub(crate) const fn is_fit(&self) -> bool {
        matches!(self, Self::Fit(_))
    }

    /// The directions of the camera.
    pub(crate) fn sight(&self) -> Sight {
        match self {
            Self::Perspective(camera) => {
                Sight::new(camera.eye, camera.gaze, camera.look_at, camera.up)
            }
            Self::Orthographic(camera) => {
                Sight::new(camera.eye, camera.gaze, camera.look_at, camera.up)
            }
            Self::Fit(camera) => {
                let gaze = -DVec3::from(camera.from());
                Sight {
                    aim: Aim::From,
                    aim_is_default: camera.from.is_none(),
                    ..Sight::new([0.0; 3], Some(gaze.into()), None, camera.up)
                }
            }
        }
    }

    /// Returns the projection of a camera that frames what it sees, if the scene gives it.
    pub(crate) const fn projection(&self) -> Option<&ProjectionModel> {
        match self {
            Self::Fit(camera) => camera.projection.as_ref(),
            Self::Perspective(_) | Self::Orthographic(_) => None,
        }
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
