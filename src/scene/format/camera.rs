//! The `camera` of a scene file.

use glam::DVec3;

use crate::{
    scene::format::{
        fit::{FitModel, ProjectionModel},
        orthographic::OrthographicModel,
        perspective::PerspectiveModel,
        sight::{Aim, Sight},
        variants::variants,
    },
    tracer::{camera::Camera, error::GeometryError},
};

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
    use crate::scene::format::numbers::Triple;

    fn perspective(gaze: Option<Triple>, look_at: Option<Triple>) -> CameraModel {
        CameraModel::Perspective(PerspectiveModel {
            eye: [1.0, 2.0, 3.0],
            gaze,
            look_at,
            up: None,
            fov: 90.0,
            aperture: None,
            focus: None,
            focus_at: None,
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
