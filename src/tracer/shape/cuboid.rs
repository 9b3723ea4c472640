//! A box along the axes of the world.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Faces, Leaving},
        span::{Convex, Span},
        working::{Term, Working},
    },
    vector::finite,
};

/// All points between two corners, on each axis: a `Box` in a file.
///
/// Faces 0 and 1 are the lower and the upper end along x, 2 and 3 along y, 4 and 5 along z.
///
/// On each axis, a ray is between the planes from `(min - o)/d` to `(max - o)/d` or the other way
/// around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    min: DVec3,
    max: DVec3,
    around: Around,
}

/// The names of the terms along each axis.
const NAMES: [[&str; 3]; 3] = [
    ["x_from", "x_to", "d_x"],
    ["y_from", "y_to", "d_y"],
    ["z_from", "z_to", "d_z"],
];

impl Cuboid {
    /// Creates a box between two corners.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, or if `max` is not above `min` on each axis.
    pub fn new(min: DVec3, max: DVec3) -> Result<Self, GeometryError> {
        let (min, max) = (finite(min, "min")?, finite(max, "max")?);
        for axis in 0..3 {
            let (name, value) = ("max - min", max[axis] - min[axis]);
            if max[axis] <= min[axis] {
                return Err(GeometryError::NotPositive { name, value });
            }
        }
        let around = Around::points(&[min, max]);
        Ok(Self { min, max, around })
    }

    /// The lower corner.
    pub const fn min(&self) -> DVec3 {
        self.min
    }

    /// The upper corner.
    pub const fn max(&self) -> DVec3 {
        self.max
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let is_up = direction.cmpgt(DVec3::ZERO);
        Some(DVec3::select(is_up, self.max, self.min))
    }

    /// Returns the part of the line between the planes of an axis.
    #[inline]
    fn slab(&self, axis: usize, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let (o, d) = (ray.origin()[axis], ray.direction()[axis]);
        let face = 2 * axis as u64;
        let [mut low, mut high] = [self.min[axis] - o, self.max[axis] - o];
        if !leaving.is_empty() {
            low = if leaving.has(face) { 0.0 } else { low };
            high = if leaving.has(face + 1) { 0.0 } else { high };
        }
        Span::slab([low, high], d, [face, face + 1])
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        for face in 0..6 {
            let corner = if face % 2 == 0 { self.min } else { self.max };
            let axis = (face / 2) as usize;
            let equation = FaceEquation::plane(at, corner, self.normal(face));
            let along = |axis: usize| {
                let ends = [self.min[axis], self.max[axis]];
                FaceEdge::of_interval(at.point[axis], ends, DVec3::AXES[axis])
            };
            let edges = || {
                let [[a, b], [c, d]] = [along((axis + 1) % 3), along((axis + 2) % 3)];
                [a, b, c, d]
            };
            at.see(face, &equation, edges, see);
        }
    }

    /// Returns the outward normal of a face.
    fn normal(&self, face: u64) -> DVec3 {
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][(face / 2 % 3) as usize];
        if face.is_multiple_of(2) { -axis } else { axis }
    }

    pub(crate) fn normal_on(&self, face: u64, _: &Ray, _: f64) -> DVec3 {
        self.normal(face)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let line = |axis: usize| {
            let (o, d) = (ray.origin()[axis], ray.direction()[axis]);
            let [low, high, direction] = NAMES[axis];
            vec![
                Term::number(low, "min - o", self.min[axis] - o),
                Term::number(high, "max - o", self.max[axis] - o),
                Term::number(direction, "d", d),
            ]
        };
        Working {
            form: None,
            parts: vec![
                Term::vector("min", "min", self.min),
                Term::vector("max", "max", self.max),
            ],
            lines: (0..3).map(line).collect(),
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> [f64; 6] {
        let Self { min, max, .. } = *self;
        [min.x, min.y, min.z, max.x, max.y, max.z]
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let away = (self.min - point).abs().max((self.max - point).abs());
        away.length()
    }
}

impl Convex for Cuboid {
    #[inline]
    fn hull(&self) -> &Around {
        &self.around
    }

    #[inline]
    fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let x = self.slab(0, ray, leaving)?;
        let both = x.and(self.slab(1, ray, leaving)?)?;
        both.and(self.slab(2, ray, leaving)?)
    }

    /// Returns a depth below the surface: above 0 inside, 0 on it and below 0 outside.
    fn depth(&self, point: DVec3) -> f64 {
        let depths = (point - self.min).min(self.max - point);
        depths.min_element()
    }
}
