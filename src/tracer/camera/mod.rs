//! Cameras: from a pixel to the ray through it.
//!
//! All cameras share one basis. With eye e, gaze g and up t, it is `w = -g/|g|`, `u = (t × w)/|t ×
//! w|`, `v = w × u`: u points to the right of the picture, v to its top, and w back towards the
//! viewer (P. Shirley and S. Marschner, Fundamentals of Computer Graphics, 2009, section 4.3).

pub(crate) mod basis;
pub(crate) mod fit;
pub(crate) mod lens;
pub(crate) mod matrices;
pub(crate) mod orthographic;
pub(crate) mod perspective;
pub(crate) mod rigid;

use glam::DVec3;

use crate::tracer::{
    camera::{basis::Basis, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
    ray::Ray,
    sampling::UnitPair,
};

/// A camera, which turns a pixel into the ray through its center.
///
/// In a picture of `width` times `height` pixels, pixel (0, 0) is at the bottom left: x counts to
/// the right, y counts UPWARDS. Row r of an image file, counted from the top, is `y = height - 1 -
/// r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// A camera whose rays all start at the eye.
    Perspective(PerspectiveCamera),
    /// A camera whose rays are all parallel.
    Orthographic(OrthographicCamera),
}

impl Camera {
    /// Returns the ray through a point of the picture, in pixels from the bottom left.
    ///
    /// Integers are the centers of pixels: `(0.0, 0.0)` is the center of the bottom left pixel,
    /// `(width - 1, height - 1)` that of the top right one.
    pub fn ray_for(&self, width: u32, height: u32, x: f64, y: f64) -> Ray {
        match self {
            Self::Perspective(camera) => camera.ray_for(width, height, x, y),
            Self::Orthographic(camera) => camera.ray_for(width, height, x, y),
        }
    }

    /// Returns a ray of a path through a point of the picture, which starts at a point of the lens.
    pub(crate) fn ray_from_lens(
        &self,
        (width, height): (u32, u32),
        [x, y]: [f64; 2],
        pair: UnitPair,
    ) -> Ray {
        let ray = self.ray_for(width, height, x, y);
        match self {
            Self::Perspective(camera) => match &camera.lens {
                Some(lens) => lens.ray(&camera.basis, &ray, pair),
                None => ray,
            },
            Self::Orthographic(_) => ray,
        }
    }

    /// Returns the shared part of the rays of a column, `x` counted from the left.
    pub(crate) fn column(&self, width: u32, height: u32, x: f64) -> DVec3 {
        match self {
            Self::Perspective(camera) => camera.column(width, height, x),
            Self::Orthographic(camera) => camera.column(width, height, x),
        }
    }

    /// Returns the shared part of the rays of a row, `y` counted from the bottom.
    pub(crate) fn row(&self, height: u32, y: f64) -> DVec3 {
        match self {
            Self::Perspective(camera) => camera.row(height, y),
            Self::Orthographic(camera) => camera.row(height, y),
        }
    }

    /// Returns the ray that the sum of a column and a row defines: [`Camera::ray_for`].
    pub(crate) fn ray_of(&self, sum: DVec3) -> Ray {
        match self {
            Self::Perspective(camera) => camera.ray_of(sum),
            Self::Orthographic(camera) => camera.ray_of(sum),
        }
    }

    /// Returns the camera for a picture of `factor` times the size that shows the same: each pixel is divided
    /// into equal ones. `None` if there is none.
    pub(crate) fn magnified(&self, width: u32, height: u32, factor: u32) -> Option<Self> {
        match self {
            Self::Perspective(_) => Some(*self),
            Self::Orthographic(camera) => camera.magnified(width, height, factor).map(Self::from),
        }
    }

    /// The eye e.
    pub const fn eye(&self) -> DVec3 {
        self.basis().eye
    }

    /// The direction of view g, as given.
    pub const fn gaze(&self) -> DVec3 {
        self.basis().gaze
    }

    /// The up vector t, as given.
    pub const fn up(&self) -> DVec3 {
        self.basis().up
    }

    /// The unit vector to the right of the picture.
    pub const fn u(&self) -> DVec3 {
        self.basis().u
    }

    /// The unit vector to the top of the picture.
    pub const fn v(&self) -> DVec3 {
        self.basis().v
    }

    /// The unit vector opposite to the direction of view.
    pub const fn w(&self) -> DVec3 {
        self.basis().w
    }

    const fn basis(&self) -> &Basis {
        match self {
            Self::Perspective(camera) => &camera.basis,
            Self::Orthographic(camera) => &camera.basis,
        }
    }
}

impl From<PerspectiveCamera> for Camera {
    fn from(camera: PerspectiveCamera) -> Self {
        Self::Perspective(camera)
    }
}

impl From<OrthographicCamera> for Camera {
    fn from(camera: OrthographicCamera) -> Self {
        Self::Orthographic(camera)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnified_pixels_have_the_centers_of_their_pixel() {
        let (eye, gaze, up) = (
            DVec3::new(1.0, 2.0, 9.0),
            DVec3::new(0.1, -0.2, -1.0),
            DVec3::Y,
        );
        let square = OrthographicCamera::with_square_pixels(eye, gaze, up, 4.0).unwrap();
        let stretched = OrthographicCamera::new(eye, gaze, up, 4.0).unwrap();
        let perspective = PerspectiveCamera::new(eye, gaze, up, 0.5).unwrap();
        for (camera, (width, height)) in [
            (Camera::from(perspective), (7, 5)),
            (square.into(), (7, 5)),
            (square.into(), (4, 1)),
            (stretched.into(), (6, 6)),
        ] {
            for factor in [1, 3, 5] {
                let magnified = camera.magnified(width, height, factor).unwrap();
                for (x, y) in [(0, 0), (width - 1, 0), (1, height - 1)] {
                    let ray = camera.ray_for(width, height, f64::from(x), f64::from(y));
                    let middle = |part: u32| f64::from(part * factor + factor / 2);
                    let size = (width * factor, height * factor);
                    let other = magnified.ray_for(size.0, size.1, middle(x), middle(y));
                    assert!(
                        (ray.origin() - other.origin()).length() < 1e-13,
                        "{camera:?}"
                    );
                    assert!((ray.direction() - other.direction()).length() < 1e-13);
                }
            }
        }
        assert_eq!(Camera::from(stretched).magnified(7, 5, 3), None);
    }
}
