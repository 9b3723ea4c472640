//! A round piece of a plane.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        plane::{Planar, Plane},
        working::{Term, Working},
    },
    vector::{finite, positive, rim, unit},
};

/// All points `p` with `(p - a)·n = 0` and `|p - a| <= r`, for a center `a`, a normal `n` and a
/// radius `r`.
///
/// The normal is used as given and need not be of unit length. A disc is visible from both sides.
///
/// A ray `o + t·d` meets it at the `t = ((a - o)·n) / (d·n)` of its plane if that point `p` has
/// `|p - a|² <= r²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// The plane of the disc; its point is the center.
    plane: Plane,
    radius: f64,
}

impl Disc {
    /// Creates a disc around `center`, perpendicular to `normal`.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared length of `normal` in f64 is 0 or
    /// not finite, or if `radius` is not above 0.
    pub fn new(center: DVec3, normal: DVec3, radius: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            plane: Plane::new(finite(center, "center")?, normal)?,
            radius: positive(radius, "radius")?,
        })
    }

    /// The center.
    pub const fn center(&self) -> DVec3 {
        self.plane.point()
    }

    /// The normal, as given.
    pub const fn normal(&self) -> DVec3 {
        self.plane.normal()
    }

    /// The radius, above 0.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    pub(crate) fn around(&self) -> Option<Around> {
        // Along an axis x, the rim extends to r·|x × n|.
        let n = self.axis();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let half = self.radius * DVec3::from(axes.map(|axis| axis.cross(n).length()));
        let corners = [self.center() - half, self.center() + half];
        Some(Around::new(corners, self.center(), self.radius))
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let equation = FaceEquation::plane(at, self.center(), self.normal());
        let edge = || FaceEdge::of_circle(at.point - self.center(), self.radius);
        at.see(0, &equation, edge, see);
    }

    /// Returns the normal at unit length.
    pub fn unit_normal(&self) -> DVec3 {
        self.plane.unit_normal()
    }

    /// Returns the normal at unit length, with all digits.
    fn axis(&self) -> DVec3 {
        // Scaled to about 1 first, because the square of a small normal loses digits.
        let normal = self.normal();
        unit(normal / normal.abs().max_element())
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        Some(self.center() + self.radius * rim(self.axis(), direction))
    }

    /// Returns `|p - a|²` for the point p of the ray at `t`.
    fn squared_distance(&self, ray: &Ray, t: f64) -> f64 {
        let from_center = ray.at(t) - self.center();
        from_center.dot(from_center)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let mut working = self.plane.working(ray);
        working.parts = vec![
            Term::vector("center", "center a", self.center()),
            Term::vector("normal", "normal n", self.normal()),
            Term::number("radius", "radius r", self.radius),
        ];
        if let Ok([t]) = working.solutions.as_deref() {
            let squared = self.squared_distance(ray, *t);
            working.lines.push(vec![
                Term::number("squared_distance", "|o + t·d - a|²", squared),
                Term::number("squared_radius", "r²", self.radius * self.radius),
            ]);
        }
        working
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let Self { plane, radius } = *self;
        plane.numbers().into_iter().chain([radius])
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let to_center = self.center() - point;
        let above = to_center.dot(self.unit_normal());
        let beside = (to_center - above * self.unit_normal()).length() + self.radius;
        (beside * beside + above * above).sqrt()
    }
}

impl Planar for Disc {
    const PLANE: &'static str = "the plane of this disc";

    fn in_plane(&self) -> &Plane {
        &self.plane
    }

    /// Returns the `t` at which the ray's line hits the disc.
    #[inline]
    fn t(&self, ray: &Ray) -> Option<f64> {
        let t = self.plane.t(ray)?;
        (self.squared_distance(ray, t) <= self.radius * self.radius).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::shape::Membership;

    /// A disc in the plane y = -1, around x = 3.
    fn disc() -> Disc {
        let normal = DVec3::new(0.0, 2.0, 0.0);
        Disc::new(DVec3::new(3.0, -1.0, 0.0), normal, 0.5).unwrap()
    }

    fn down(x: f64) -> Ray {
        Ray::new(DVec3::new(x, 3.0, 0.0), DVec3::new(0.0, -2.0, 0.0))
    }

    #[test]
    fn it_is_met_up_to_its_rim_and_no_farther() {
        for (x, t) in [
            (3.0, Some(2.0)),
            (3.25, Some(2.0)),
            (2.5, Some(2.0)),
            (3.5, Some(2.0)),
            (3.5_f64.next_up(), None),
            (0.0, None),
        ] {
            assert_eq!(disc().intersect(&down(x), f64::INFINITY), t, "{x}");
        }
        assert_eq!(disc().intersect(&down(3.0), 2.0), None);
        assert_eq!(disc().intersect(&down(3.0), 2.5), Some(2.0));
    }

    #[test]
    fn it_is_seen_from_behind_and_not_along_its_plane() {
        let up = Ray::new(DVec3::new(3.0, -3.0, 0.0), DVec3::Y);
        assert_eq!(disc().intersect(&up, f64::INFINITY), Some(2.0));
        let along = Ray::new(DVec3::new(0.0, -1.0, 0.0), DVec3::X);
        assert_eq!(disc().intersect(&along, f64::INFINITY), None);
        let away = Ray::new(DVec3::new(3.0, 0.0, 0.0), DVec3::Y);
        assert_eq!(disc().intersect(&away, f64::INFINITY), None);
    }

    #[test]
    fn the_box_touches_the_rim_on_all_sides() {
        let corners = [DVec3::new(2.5, -1.0, -0.5), DVec3::new(3.5, -1.0, 0.5)];
        assert_eq!(disc().bounds(), Some(corners));
        // A normal whose square is not far above 0 has the same box.
        let normal = DVec3::new(3.0, 0.0, 4.0);
        for scale in [1.0, 1e-162, 1e150] {
            let leaning = Disc::new(DVec3::ZERO, normal * scale, 5.0).unwrap();
            let [low, high] = leaning.bounds().unwrap();
            let expected = DVec3::new(4.0, 5.0, 3.0);
            assert!((high - expected).length() < 1e-12, "{high}");
            assert_eq!(low, -high);
        }
        let far = Disc::new(DVec3::splat(1.5e308), DVec3::Y, 1e308).unwrap();
        assert_eq!(far.bounds(), None, "beyond f64");
    }

    #[test]
    fn the_farthest_point_lies_on_the_rim() {
        let from = |x, y| disc().farthest_from(DVec3::new(x, y, 0.0));
        assert_eq!(from(3.0, -1.0), 0.5);
        assert_eq!(from(0.0, -1.0), 3.5);
        assert_eq!(from(0.5, 3.0), 5.0);
    }

    #[test]
    fn an_eye_on_its_plane_does_not_see_it() {
        let membership = |y| disc().membership(DVec3::new(9.0, y, 0.0));
        assert_eq!(membership(0.0), Membership::Outside);
        assert_eq!(
            membership(-1.0),
            Membership::EdgeOn("the plane of this disc")
        );
    }

    #[test]
    fn impossible_discs_are_refused() {
        let disc = |center, normal, radius| Disc::new(center, normal, radius).unwrap_err();
        let (o, y) = (DVec3::ZERO, DVec3::Y);
        assert_eq!(
            disc(DVec3::NAN, y, 1.0),
            GeometryError::NotFinite { name: "center" }
        );
        assert_eq!(
            disc(o, y, f64::NAN),
            GeometryError::NotFinite { name: "radius" }
        );
        assert!(matches!(
            disc(o, o, 1.0),
            GeometryError::NoDirection { name: "normal", .. }
        ));
        assert!(matches!(
            disc(o, y, 0.0),
            GeometryError::NotPositive { name: "radius", .. }
        ));
    }
}
