//! A shape with its color.

use crate::tracer::{color::Color, hit::Hit, ray::Ray, shape::Shape};

/// A [`Shape`] with its color.
///
/// # Examples
///
/// ```
/// use strahl::{Color, Geometry, Ray, Sphere, Vec3};
///
/// let red = Color::new(1.0, 0.0, 0.0);
/// let ball = Geometry::new(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5)?, red);
/// let hit = ball.hit(&Ray::new(Vec3::ZERO, Vec3::NEG_Z)).expect("it is straight ahead");
/// assert_eq!(hit.t, 2.5);
/// assert_eq!(hit.geometry.color(), red);
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    shape: Shape,
    color: Color,
}

impl Geometry {
    /// Creates a shape with a color.
    pub fn new(shape: impl Into<Shape>, color: Color) -> Self {
        Self {
            shape: shape.into(),
            color,
        }
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) const fn parts(&self) -> (&Shape, Color) {
        let Self { shape, color } = self;
        (shape, *color)
    }

    /// The shape.
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The color.
    pub const fn color(&self) -> Color {
        self.color
    }

    /// Returns the first hit of the ray in front of its origin, if any.
    pub fn hit(&self, ray: &Ray) -> Option<Hit<'_>> {
        let t = self.shape.intersect(ray, f64::INFINITY)?;
        Some(self.hit_at(ray, t))
    }

    /// Returns the hit at a `t` found by [`Shape::intersect`].
    pub(crate) fn hit_at(&self, ray: &Ray, t: f64) -> Hit<'_> {
        Hit::new(self, ray, t, self.shape.normal_at(ray, t))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::shape::{plane::Plane, sphere::Sphere};

    #[test]
    fn a_hit_has_its_point_and_geometry() {
        let sphere = Sphere::new(DVec3::new(0.0, 0.0, -3.0), 0.5).unwrap();
        let ball = Geometry::new(sphere, Color::WHITE);
        let hit = ball.hit(&Ray::new(DVec3::ZERO, DVec3::NEG_Z)).unwrap();
        assert_eq!(hit.t, 2.5);
        assert_eq!(hit.point, DVec3::new(0.0, 0.0, -2.5));
        assert_eq!(hit.normal, DVec3::Z);
        assert!(hit.front_face);
        assert_eq!(hit.geometry, &ball);
    }

    #[test]
    fn from_inside_and_from_behind_the_back_face_is_hit() {
        let sphere = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        let ball = Geometry::new(sphere, Color::WHITE);
        let hit = ball.hit(&Ray::new(DVec3::ZERO, DVec3::X)).unwrap();
        assert_eq!((hit.normal, hit.front_face), (DVec3::X, false));

        let floor = Plane::new(DVec3::ZERO, DVec3::new(0.0, 4.0, 0.0)).unwrap();
        let floor = Geometry::new(floor, Color::WHITE);
        let hit = floor.hit(&Ray::new(DVec3::NEG_Y, DVec3::Y)).unwrap();
        assert_eq!((hit.normal, hit.front_face), (DVec3::Y, false));
    }
}
