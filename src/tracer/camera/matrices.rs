//! Camera matrices of computer vision (R. Hartley and A. Zisserman, Multiple View Geometry in
//! Computer Vision, 2004, chapter 6).
//!
//! There, x points to the right, y DOWNWARDS and z forward, and pixels are counted from the top
//! left: the center of the top left pixel is (0, 0).

use glam::DVec3;

use crate::tracer::camera::{Camera, orthographic};

impl Camera {
    /// Returns the extrinsics [R|t], row by row.
    ///
    /// `R·P + t` is a point P of the world in camera space: x to the right, y downwards, z forward,
    /// in scene units.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Camera, PerspectiveCamera, Vec3};
    ///
    /// let eye = Vec3::new(1.0, 2.0, 3.0);
    /// let camera = Camera::from(PerspectiveCamera::new(eye, Vec3::NEG_Z, Vec3::Y, 0.5)?);
    /// let [right, down, forward] = camera.extrinsics();
    /// assert_eq!(right, [1.0, 0.0, 0.0, -1.0]);
    /// assert_eq!(down, [0.0, -1.0, 0.0, 2.0]);
    /// assert_eq!(forward, [0.0, 0.0, -1.0, 3.0]);
    /// # Ok::<(), strahl::GeometryError>(())
    /// ```
    pub fn extrinsics(&self) -> [[f64; 4]; 3] {
        [self.u(), -self.v(), -self.w()].map(|axis| row(axis, 0.0 - axis.dot(self.eye())))
    }

    /// Returns the intrinsics K of a perspective camera, row by row, for a picture of `width` times
    /// `height` pixels, or `None` for an orthographic camera.
    ///
    /// A point P in world space appears in column `x/z` and row `y/z` from the top, where `(x, y,
    /// z) = K·(R·P + t)` and z is above 0. The focal length is infinite if the field of view is so
    /// narrow that tan α is nearly 0.
    pub fn intrinsics(&self, width: u32, height: u32) -> Option<[[f64; 3]; 3]> {
        let Self::Perspective(camera) = self else {
            return None;
        };
        let focal = camera.distance(height);
        Some([
            [focal, 0.0, middle(width)],
            [0.0, focal, middle(height)],
            [0.0, 0.0, 1.0],
        ])
    }

    /// Returns the affine camera matrix M of an orthographic camera, row by row, for a picture of
    /// `width` times `height` pixels, or `None` for a perspective camera.
    ///
    /// In `(x, y, 1) = M·(P, 1)`, x and y are the column and the row from the top in which a point
    /// P in world space appears.
    pub fn affine(&self, width: u32, height: u32) -> Option<[[f64; 4]; 3]> {
        let Self::Orthographic(camera) = self else {
            return None;
        };
        let across = camera.pixels_across(width, height) / camera.scale();
        let down = orthographic::pixels(height) / camera.scale();
        let (right, downwards) = (self.u() * across, -self.v() * down);
        Some([
            row(right, middle(width) - right.dot(self.eye())),
            row(downwards, middle(height) - downwards.dot(self.eye())),
            [0.0, 0.0, 0.0, 1.0],
        ])
    }
}

/// Returns the middle of a side, between the centers of its first and last pixels.
fn middle(side: u32) -> f64 {
    (f64::from(side) - 1.0) / 2.0
}

fn row(axis: DVec3, last: f64) -> [f64; 4] {
    [axis.x, axis.y, axis.z, last]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::camera::{orthographic::OrthographicCamera, perspective::PerspectiveCamera};

    const EYE: DVec3 = DVec3::new(1.0, -2.0, 3.5);
    const GAZE: DVec3 = DVec3::new(0.3, 0.4, -2.0);
    const UP: DVec3 = DVec3::new(0.2, 1.0, 0.1);

    /// Multiplies a row of a matrix by a point.
    fn times(row: [f64; 4], p: DVec3) -> f64 {
        row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]
    }

    /// Asserts that the matrices project points of the ray through a pixel to that pixel.
    #[track_caller]
    fn compare(camera: Camera, width: u32, height: u32, project: impl Fn(DVec3) -> [f64; 2]) {
        for (column, row) in [
            (0, 0),
            (width - 1, 0),
            (0, height - 1),
            (width / 3, height / 2),
        ] {
            let y = f64::from(height - 1 - row);
            let ray = camera.ray_for(width, height, column.into(), y);
            for t in [0.5, 7.0] {
                let found = project(ray.at(t));
                let errors = [found[0] - f64::from(column), found[1] - f64::from(row)];
                assert!(
                    errors.iter().all(|error| error.abs() < 1e-10),
                    "{column},{row} in {width}x{height} at {t}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn points_of_a_ray_lie_in_its_pixel() {
        let camera = Camera::from(PerspectiveCamera::new(EYE, GAZE, UP, 0.6).unwrap());
        assert_eq!(camera.affine(4, 3), None);
        for (width, height) in [(64, 48), (31, 77)] {
            let k = camera.intrinsics(width, height).unwrap();
            compare(camera, width, height, |point| {
                let seen = DVec3::from(camera.extrinsics().map(|row| times(row, point)));
                let [x, y, z] = k.map(|row| DVec3::from(row).dot(seen));
                [x / z, y / z]
            });
        }
    }

    #[test]
    fn parallel_rays_have_an_affine_matrix() {
        for new in [
            OrthographicCamera::new,
            OrthographicCamera::with_square_pixels,
        ] {
            let camera = Camera::from(new(EYE, GAZE, UP, 2.5).unwrap());
            assert_eq!(camera.intrinsics(4, 3), None);
            for (width, height) in [(64, 48), (31, 77), (5, 1), (1, 5)] {
                let m = camera.affine(width, height).unwrap();
                compare(camera, width, height, |point| {
                    let [x, y, one] = m.map(|row| times(row, point));
                    assert_eq!(one, 1.0);
                    [x, y]
                });
            }
        }
    }

    #[test]
    fn the_extrinsics_are_a_rotation_and_z_is_forward() {
        let camera = Camera::from(PerspectiveCamera::new(EYE, GAZE, UP, 0.6).unwrap());
        let rows = camera.extrinsics();
        let [right, down, forward] = rows.map(|row| DVec3::new(row[0], row[1], row[2]));
        assert!((right.cross(down) - forward).length() < 1e-15);
        let ahead = EYE + 2.0 * GAZE;
        let seen = rows.map(|row| times(row, ahead));
        let distance = 2.0 * GAZE.length();
        assert!((DVec3::from(seen) - DVec3::new(0.0, 0.0, distance)).length() < 1e-14);
    }
}
