//! The position and orientation of a camera.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    vector::{direction, finite, unit},
};

/// The largest |t × w| relative to |t| at which the two count as parallel.
const PARALLEL: f64 = 1e-9;

/// The eye and the unit vectors u (right), v (up) and w (back) of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Basis {
    pub(crate) eye: DVec3,
    pub(crate) gaze: DVec3,
    pub(crate) up: DVec3,
    pub(crate) u: DVec3,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

impl Basis {
    /// Creates the basis of a camera at `eye` that looks along `gaze`, with `up` pointing upwards
    /// in the picture.
    pub(crate) fn new(eye: DVec3, gaze: DVec3, up: DVec3) -> Result<Self, GeometryError> {
        finite(eye, "eye")?;
        direction(finite(gaze, "gaze")?, "gaze")?;
        direction(finite(up, "up")?, "up")?;
        if are_parallel(gaze, up) {
            return Err(GeometryError::ParallelVectors { gaze, up });
        }
        let w = -unit(gaze);
        let u = unit(up.cross(w));
        let v = w.cross(u);
        Ok(Self {
            eye,
            gaze,
            up,
            u,
            v,
            w,
        })
    }
}

/// Returns true if `up` t is parallel to the line of sight: |t × w| ≤ 1e-9 · |t|.
pub(crate) fn are_parallel(gaze: DVec3, up: DVec3) -> bool {
    let w = -unit(gaze);
    up.cross(w).length() <= PARALLEL * up.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_of_the_course() {
        let basis = Basis::new(DVec3::ZERO, DVec3::new(0.0, 0.0, -2.0), DVec3::Y).unwrap();
        assert_eq!((basis.u, basis.v, basis.w), (DVec3::X, DVec3::Y, DVec3::Z));
    }

    #[test]
    fn up_need_not_be_perpendicular() {
        let up = DVec3::new(0.0, 3.0, -4.0);
        let basis = Basis::new(DVec3::ONE, DVec3::NEG_Z, up).unwrap();
        assert_eq!((basis.u, basis.v, basis.w), (DVec3::X, DVec3::Y, DVec3::Z));
        assert_eq!(
            (basis.eye, basis.gaze, basis.up),
            (DVec3::ONE, DVec3::NEG_Z, up)
        );
    }

    #[test]
    fn up_must_not_be_parallel_to_the_line_of_sight() {
        for up in [
            DVec3::Z,
            DVec3::new(1e-10, 0.0, -5.0),
            DVec3::new(0.0, 1e-9, 1.0),
        ] {
            assert!(matches!(
                Basis::new(DVec3::ZERO, DVec3::NEG_Z, up),
                Err(GeometryError::ParallelVectors { .. })
            ));
        }
        assert!(Basis::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::new(0.0, 1.1e-9, 1.0)).is_ok());
    }

    #[test]
    fn directions_must_have_a_length() {
        let refused = |gaze, up| Basis::new(DVec3::ZERO, gaze, up).unwrap_err();
        assert!(matches!(
            refused(DVec3::ZERO, DVec3::Y),
            GeometryError::NoDirection { name: "gaze", .. }
        ));
        assert!(matches!(
            refused(DVec3::X, DVec3::ZERO),
            GeometryError::NoDirection { name: "up", .. }
        ));
        assert!(matches!(
            Basis::new(DVec3::INFINITY, DVec3::X, DVec3::Y),
            Err(GeometryError::NotFinite { name: "eye" })
        ));
    }
}
