//! The surface of a ball.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Membership,
        around::Around,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Crossing, Crossings, Faces, Leaving, in_front},
        span::Span,
        working::{Term, Working},
    },
    vector::{finite, is_direction, positive, unit},
};

/// A sphere: all points at the distance `r` from a center `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

/// The quadratic equation `A·t² + B·t + C = 0` of a ray and a sphere, and its solutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic {
    /// `A = d·d`.
    pub a: f64,
    /// `B = d·(2(o - c))`.
    pub b: f64,
    /// `C = (o - c)·(o - c) - r·r`.
    pub c: f64,
    /// `B² - 4AC`.
    pub discriminant: f64,
    /// `(-B - √discriminant) / 2A` and `(-B + √discriminant) / 2A`; `None` if the discriminant is
    /// negative or NaN. They may be infinite or NaN if the numbers overflow.
    pub roots: Option<(f64, f64)>,
}

impl Sphere {
    /// Creates a sphere around `center`.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite or the radius is not above 0.
    pub fn new(center: DVec3, radius: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            center: finite(center, "center")?,
            radius: positive(radius, "radius")?,
        })
    }

    /// The center.
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius, above 0.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    pub(crate) fn around(&self) -> Option<Around> {
        let corners = [self.center - self.radius, self.center + self.radius];
        Some(Around::new(corners, self.center, self.radius))
    }

    #[inline]
    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        Some(self.center + self.radius * direction)
    }

    /// Returns the equation whose solutions are the `t` at which the ray's line hits the sphere.
    pub fn quadratic(&self, ray: &Ray) -> Quadratic {
        let d = ray.direction();
        let oc = ray.origin() - self.center;
        let a = d.dot(d);
        let b = d.dot(2.0 * oc);
        let c = oc.dot(oc) - self.radius * self.radius;
        let discriminant = b * b - 4.0 * a * c;
        let roots = (discriminant >= 0.0).then(|| {
            let root = discriminant.sqrt();
            ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a))
        });
        Quadratic {
            a,
            b,
            c,
            discriminant,
            roots,
        }
    }

    /// Returns the outward unit normal at the point of the ray at `t`.
    ///
    /// If the center and the point coincide in f64 (a tiny sphere far away), they define no
    /// direction, and the normal points back along the ray.
    pub fn normal_at(&self, ray: &Ray, t: f64) -> DVec3 {
        // Computed relative to the center, not through the point: o + t·d loses the digits of a
        // small sphere far from the world's origin.
        let outward = (ray.origin() - self.center) + t * ray.direction();
        if is_direction(outward) {
            unit(outward)
        } else {
            unit(-ray.direction())
        }
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let Quadratic {
            a,
            b,
            c,
            discriminant,
            roots,
        } = self.quadratic(ray);
        let roots = roots.map(|(near, far)| vec![near, far]);
        Working {
            form: None,
            parts: vec![
                Term::vector("center", "center c", self.center),
                Term::number("radius", "radius r", self.radius),
            ],
            lines: vec![
                vec![
                    Term::number("a", "A", a),
                    Term::number("b", "B", b),
                    Term::number("c", "C", c),
                ],
                vec![Term::number("discriminant", "B² - 4AC", discriminant)],
            ],
            solutions: roots.ok_or("the ray misses it"),
            name: Some("roots"),
        }
    }

    pub(crate) const FACES: Faces = Faces::Curved;

    #[inline]
    pub(crate) fn crossings(&self, ray: &Ray, leaving: Leaving) -> Crossings {
        let roots = match leaving.is_empty() {
            false => return self.far_from_own(ray, f64::INFINITY).into(),
            true => self.quadratic(ray).roots,
        };
        roots.map_or_else(Crossings::default, |(near, far)| {
            Crossings([near, far].map(|t| Some(Crossing::from(t))))
        })
    }

    /// Returns the part of the ray's line inside; if the ray leaves the sphere, one end is 0.
    #[inline]
    pub(super) fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let Quadratic { a, b, roots, .. } = self.quadratic(ray);
        let ends = match leaving.is_empty() {
            false => [0.0, -b / a],
            true => roots?.into(),
        };
        Some(Span::between(ends, 0))
    }

    /// Returns the far solution of a ray that leaves the sphere: with `C = 0`, as its origin lies on
    /// the sphere, the solutions are 0 and `-B/A`.
    pub(crate) fn far_from_own(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        let Quadratic { a, b, .. } = self.quadratic(ray);
        in_front(-b / a, t_max)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        // The roots of the equation are as uncertain as the square of the distance.
        let away = at.origin - self.center;
        let equation = FaceEquation {
            more: 4.0 * f64::EPSILON * away.dot(away),
            ..FaceEquation::ball(at, self.center, self.radius)
        };
        at.see(0, &equation, FaceEdge::none, see);
    }

    pub(crate) fn normal_on(&self, _: u64, ray: &Ray, t: f64) -> DVec3 {
        self.normal_at(ray, t)
    }

    pub(crate) fn numbers(&self) -> [f64; 4] {
        let Self { center, radius } = *self;
        [center.x, center.y, center.z, radius]
    }

    #[inline]
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        (self.center - point).length() + self.radius
    }

    /// Returns a depth below the surface: above 0 inside, 0 on it and below 0 outside.
    #[inline]
    pub(crate) fn depth(&self, point: DVec3) -> f64 {
        self.radius - (point - self.center).length()
    }

    #[inline]
    pub(crate) fn membership(&self, eye: DVec3) -> Membership {
        if self.depth(eye) > 0.0 {
            Membership::Inside(self.center, self.radius)
        } else {
            Membership::Outside
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball() -> Sphere {
        Sphere::new(DVec3::new(0.0, 0.0, -5.0), 2.0).unwrap()
    }

    fn along_z(x: f64, z: f64) -> Ray {
        Ray::new(DVec3::new(x, 0.0, z), DVec3::new(0.0, 0.0, -1.0))
    }

    #[test]
    fn the_terms_are_those_of_the_equation() {
        let found = ball().quadratic(&along_z(0.0, 0.0));
        let expected = Quadratic {
            a: 1.0,
            b: -10.0,
            c: 21.0,
            discriminant: 16.0,
            roots: Some((3.0, 7.0)),
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn the_nearer_point_in_front_is_hit() {
        assert_eq!(
            ball().intersect(&along_z(0.0, 0.0), f64::INFINITY),
            Some(3.0)
        );
        assert_eq!(
            ball().intersect(&along_z(0.0, -5.0), f64::INFINITY),
            Some(2.0),
            "from inside"
        );
        assert_eq!(
            ball().intersect(&along_z(0.0, -3.0), f64::INFINITY),
            Some(4.0),
            "from its surface"
        );
        assert_eq!(
            ball().intersect(&along_z(2.0, 0.0), f64::INFINITY),
            Some(5.0),
            "a tangent"
        );
        assert_eq!(
            ball().intersect(&along_z(2.1, 0.0), f64::INFINITY),
            None,
            "beside"
        );
        assert_eq!(
            ball().intersect(&along_z(0.0, -9.0), f64::INFINITY),
            None,
            "behind"
        );
    }

    #[test]
    fn only_hits_below_the_largest_t_count() {
        let at = |t_max| ball().intersect(&along_z(0.0, 0.0), t_max);
        assert_eq!(at(3.0), None, "not at it");
        assert_eq!(at(3.5), Some(3.0));
        assert_eq!(at(-1.0), None);
        assert_eq!(at(f64::NAN), None);
        let inside = |t_max| ball().intersect(&along_z(0.0, -5.0), t_max);
        assert_eq!((inside(2.0), inside(2.5)), (None, Some(2.0)));
    }

    #[test]
    fn the_box_touches_the_sphere_on_all_sides() {
        let corners = [DVec3::new(-2.0, -2.0, -7.0), DVec3::new(2.0, 2.0, -3.0)];
        assert_eq!(ball().bounds(), Some(corners));
        let far = Sphere::new(DVec3::splat(1.5e308), 1e308).unwrap();
        assert_eq!(far.bounds(), None, "beyond f64");
    }

    #[test]
    fn the_direction_need_not_be_a_unit_vector() {
        let ray = Ray::new(DVec3::ZERO, DVec3::new(0.0, 0.0, -4.0));
        assert_eq!(ball().intersect(&ray, f64::INFINITY), Some(0.75));
    }

    #[test]
    fn overflowing_numbers_hit_nothing() {
        let far = Sphere::new(DVec3::new(0.0, 0.0, -1e200), 1.0).unwrap();
        assert_eq!(far.intersect(&along_z(0.0, 0.0), f64::INFINITY), None);
    }

    #[test]
    fn the_normal_points_outward_at_unit_length() {
        let ray = along_z(0.0, 0.0);
        assert_eq!(ball().normal_at(&ray, 3.0), DVec3::Z);
        assert_eq!(ball().normal_at(&ray, 7.0), -DVec3::Z, "seen from inside");
        let tiny = Sphere::new(DVec3::new(0.0, 0.0, -1.0), 1e-30).unwrap();
        assert_eq!(
            tiny.normal_at(&ray, 1.0),
            DVec3::Z,
            "point and center coincide"
        );
    }

    #[test]
    fn impossible_spheres_are_rejected() {
        for radius in [0.0, -0.0, -1.0] {
            assert!(matches!(
                Sphere::new(DVec3::ZERO, radius),
                Err(GeometryError::NotPositive { name: "radius", .. })
            ));
        }
        for radius in [f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Sphere::new(DVec3::ZERO, radius),
                Err(GeometryError::NotFinite { name: "radius" })
            ));
        }
        assert!(Sphere::new(DVec3::NAN, 1.0).is_err());
    }
}
