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

/// Number of rays in a [`Bundle`].
pub(crate) const BUNDLE: usize = 8;

/// Rays that lie close together, so that it pays to trace them together.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    /// x, y and z of each ray.
    origins: [[f64; BUNDLE]; 3],
    directions: [[f64; BUNDLE]; 3],
    from: f64,
    t_max: [f64; BUNDLE],
    /// True if any crossing of a ray will do.
    is_any: bool,
}

impl Bundle {
    /// Creates a bundle of rays that look for what they meet at `0 < t < t_max`. One whose `t_max` is 0
    /// looks for nothing; it may be any ray.
    #[inline]
    pub(crate) fn new(
        mut origins: [[f64; BUNDLE]; 3],
        mut directions: [[f64; BUNDLE]; 3],
        t_max: [f64; BUNDLE],
    ) -> Self {
        let first = t_max.iter().position(|t| *t > 0.0).unwrap_or_default();
        for numbers in origins.iter_mut().chain(&mut directions) {
            let one = numbers[first];
            for (number, t) in numbers.iter_mut().zip(&t_max) {
                if *t <= 0.0 {
                    *number = one;
                }
            }
        }
        Self {
            origins,
            directions,
            from: 0.0,
            t_max,
            is_any: false,
        }
    }

    /// Returns the same rays if any crossing of each will do.
    pub(crate) fn any(self) -> Self {
        Self {
            is_any: true,
            ..self
        }
    }

    /// Returns true if any crossing of a ray will do, and not its first one alone.
    pub(crate) const fn is_any(&self) -> bool {
        self.is_any
    }

    /// Creates a bundle of some rays up to their first crossings, at `t`.
    pub(crate) fn to(
        origins: [[f64; BUNDLE]; 3],
        directions: [[f64; BUNDLE]; 3],
        t: &[f64; BUNDLE],
        are_wanted: [bool; BUNDLE],
    ) -> Self {
        let wanted = t.iter().zip(are_wanted);
        let from = wanted.fold(f64::INFINITY, |from, (t, is_wanted)| match is_wanted {
            true => from.min(*t),
            false => from,
        });
        let t_max = std::array::from_fn(|lane| match are_wanted[lane] {
            true => t[lane].next_up(),
            false => 0.0,
        });
        Self {
            from,
            ..Self::new(origins, directions, t_max)
        }
    }

    /// x, y and z of the origins.
    pub(crate) const fn origins(&self) -> &[[f64; BUNDLE]; 3] {
        &self.origins
    }

    /// x, y and z of the directions.
    pub(crate) const fn directions(&self) -> &[[f64; BUNDLE]; 3] {
        &self.directions
    }

    /// No ray meets anything before this `t`.
    pub(crate) const fn start(&self) -> f64 {
        self.from
    }

    /// The `t` before which each ray ends.
    pub(crate) const fn t_max(&self) -> &[f64; BUNDLE] {
        &self.t_max
    }

    /// Ends a ray before a `t`.
    pub(crate) fn end(&mut self, lane: usize, t_max: f64) {
        self.t_max[lane] = t_max;
    }

    /// Returns a ray.
    pub(crate) fn ray(&self, lane: usize) -> Ray {
        // Taken apart: `map` of an array copies all lanes.
        let at = |[x, y, z]: &[[f64; BUNDLE]; 3]| DVec3::new(x[lane], y[lane], z[lane]);
        Ray::new(at(&self.origins), at(&self.directions))
    }

    /// Returns the results of a function of the number of each ray that looks for something, the ray
    /// itself, and its `t_max`.
    pub(crate) fn each<T>(
        &self,
        mut find: impl FnMut(usize, &Ray, f64) -> Option<T>,
    ) -> [Option<T>; BUNDLE] {
        std::array::from_fn(|lane| {
            let t_max = self.t_max[lane];
            (t_max > 0.0)
                .then(|| find(lane, &self.ray(lane), t_max))
                .flatten()
        })
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
