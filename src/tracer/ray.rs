//! A half line: an origin and a direction.

use glam::DVec3;

/// A ray `o + t·d`: the points from its origin `o` along its direction `d`, for `t > 0`.
///
/// # Examples
///
/// ```
/// use strahl::{Ray, Vec3};
///
/// let ray = Ray::new(Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, -1.0));
/// assert_eq!(ray.at(2.0), Vec3::new(0.0, 1.0, -2.0));
/// assert_eq!(ray.t_of(Vec3::new(0.0, 1.0, -2.0)), 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
}

impl Ray {
    /// Creates a ray from `origin` along `direction`, which is not normalized and need not be of
    /// unit length.
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction }
    }

    /// The origin.
    pub const fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction, as given.
    pub const fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Returns the point `o + t·d`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Returns the `t` of the point on the ray's line that is nearest to `p`: `(p - o)·d / (d·d)`.
    ///
    /// If the direction is a unit vector, this is the distance from the origin, negative behind it.
    /// A direction of length 0 gives NaN.
    pub fn t_of(&self, p: DVec3) -> f64 {
        (p - self.origin).dot(self.direction) / self.direction.dot(self.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAY: Ray = Ray::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 0.0, -2.0));

    #[test]
    fn at_walks_along_the_direction() {
        assert_eq!(RAY.at(0.0), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(RAY.at(1.5), DVec3::new(1.0, 2.0, 0.0));
        assert_eq!(RAY.at(-1.0), DVec3::new(1.0, 2.0, 5.0));
    }

    #[test]
    fn t_of_turns_at_around() {
        assert_eq!(RAY.t_of(DVec3::new(1.0, 2.0, 0.0)), 1.5);
        assert_eq!(RAY.t_of(DVec3::new(1.0, 2.0, 5.0)), -1.0);
    }

    #[test]
    fn t_of_drops_a_perpendicular_onto_the_line() {
        assert_eq!(RAY.t_of(DVec3::new(9.0, -7.0, 1.0)), 1.0);
    }

    #[test]
    fn a_ray_returns_its_origin_and_direction() {
        assert_eq!(RAY.origin(), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(RAY.direction(), DVec3::new(0.0, 0.0, -2.0));
    }
}
