//! The camera of a scene file that frames what it sees.

use glam::DVec3;

use crate::{
    scene::format::{
        camera::CameraModel, numbers::Triple, object::object, orthographic::OrthographicModel,
        perspective::PerspectiveModel, sight::UP, variants::variants,
    },
    tracer::{
        camera::{
            fit::{Extremes, Frame},
            perspective::half_angle_of,
        },
        error::GeometryError,
        vector::is_direction,
    },
};

object! {
    /// A camera that frames all bounded geometries: its eye is as close as the margin allows.
    #[derive(Default)]
    pub struct FitModel = "Fit" {
        /// The direction from the geometries to the eye, of any length; the camera looks the other way.
        /// (1, 0.6, 1) is the default.
        from: Direction = Self::FROM,
        /// The direction that is up in the picture; (0, 1, 0) is the default.
        up: Direction = UP,
        /// The projection; `Perspective(fov: 35)` is the default.
        projection: Thing(ProjectionModel)?,
        /// The part of the picture that is free at least, of the width on the left and on the right, of
        /// the height at the top and at the bottom: at least 0 and below 0.5; 0.05 is the default.
        margin: Margin = Self::MARGIN,
    }
}

variants! {
    /// The projection of a camera that frames what it sees.
    pub enum ProjectionModel = "Projection" {
        /// All rays start at the eye.
        Perspective(PerspectiveProjectionModel),
        /// All rays are parallel: what is far is as large as what is near. The eye is one height of the
        /// picture in front of the nearest point.
        Orthographic(OrthographicProjectionModel),
    }
}

object! {
    /// All rays start at the eye.
    pub struct PerspectiveProjectionModel = "Perspective" {
        /// The full vertical angle of view in degrees, above 0 and below 180.
        fov ! alpha ! angle ! half_angle: Angle,
        /// The diameter of the lens in units of the scene, 0 to 1e12, where light follows paths; the middle of
        /// what is framed is in focus. 0, the default, keeps everything in focus.
        aperture ! lens_radius ! f_stop: Aperture = 0.0,
    }
}

object! {
    /// All rays are parallel.
    #[derive(Default)]
    pub struct OrthographicProjectionModel = "Orthographic" {}
}

impl FitModel {
    /// The default direction to the eye.
    pub const FROM: Triple = [1.0, 0.6, 1.0];
    /// The default margin.
    const MARGIN: f64 = 0.05;

    /// Returns true if a direction has a length: its square in f64 is neither 0 nor infinite nor NaN.
    pub fn is_direction(direction: &Triple) -> bool {
        is_direction(DVec3::from(*direction))
    }

    /// The projection.
    pub(crate) fn projection(&self) -> ProjectionModel {
        self.projection.clone().unwrap_or_default()
    }

    /// Returns the camera with its place, for a picture of this size. `search` finds the extremes of
    /// what is framed.
    pub(crate) fn explicit(
        &self,
        size: (u32, u32),
        mut search: impl FnMut(&[DVec3]) -> Extremes,
    ) -> Result<CameraModel, GeometryError> {
        let from = DVec3::from(self.from());
        let frame = Frame {
            from,
            up: self.up().into(),
            margin: self.margin(),
            size,
        };
        // Subtracted from 0, because -0 would be an odd thing to write.
        let gaze = Some(Triple::from(DVec3::ZERO - from));
        let (look_at, up) = (None, self.up);
        Ok(match self.projection() {
            ProjectionModel::Perspective(PerspectiveProjectionModel { fov, aperture }) => {
                let eye = frame.perspective_eye(half_angle_of(fov), &mut search)?;
                let focus = aperture.filter(|aperture| *aperture > 0.0);
                let focus = focus.map(|_| frame.middle_from(eye, search)).transpose()?;
                CameraModel::Perspective(PerspectiveModel {
                    eye: eye.into(),
                    gaze,
                    look_at,
                    up,
                    fov,
                    aperture,
                    focus,
                    focus_at: None,
                })
            }
            ProjectionModel::Orthographic(_) => {
                let (eye, scale) = frame.orthographic_eye(search)?;
                CameraModel::Orthographic(OrthographicModel {
                    eye: eye.into(),
                    gaze,
                    look_at,
                    up,
                    scale,
                    stretch: None,
                })
            }
        })
    }
}

impl Default for ProjectionModel {
    fn default() -> Self {
        Self::Perspective(PerspectiveProjectionModel {
            fov: 35.0,
            aperture: None,
        })
    }
}
