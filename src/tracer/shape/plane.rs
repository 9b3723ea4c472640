//! An infinite plane.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Membership,
        around::Around,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Crossing, Crossings, Faces, Leaving},
        span::Span,
        working::{Term, Working},
    },
    vector::{direction, finite, is_direction, unit},
};

/// A plane: all points `p` with `(p - a)·n = 0`, for a point `a` and a normal `n`.
///
/// The normal is used as given and need not be of unit length. A plane is visible from both sides.
///
/// A ray `o + t·d` meets it at `t = ((a - o)·n) / (d·n)`, unless `d·n` is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Creates a plane through `point`, perpendicular to `normal`.
    ///
    /// # Errors
    ///
    /// Returns an error if a component is not finite, or if the squared length of `normal` in f64
    /// is 0 or not finite.
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self, GeometryError> {
        Ok(Self {
            point: finite(point, "point")?,
            normal: direction(finite(normal, "normal")?, "normal")?,
        })
    }

    /// The same for a point that is known to be finite.
    // A component of the normal that is not finite makes its length so.
    #[inline(always)]
    pub(crate) fn at(point: DVec3, normal: DVec3) -> Option<Self> {
        is_direction(normal).then_some(Self { point, normal })
    }

    /// A point of the plane.
    pub const fn point(&self) -> DVec3 {
        self.point
    }

    /// The normal, as given.
    pub const fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Returns the normal at unit length.
    pub fn unit_normal(&self) -> DVec3 {
        unit(self.normal)
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        None
    }

    pub(crate) const fn support(&self, _: DVec3) -> Option<DVec3> {
        None
    }

    /// Returns the numerator and denominator of `t`: `(a - o)·n` and `d·n`.
    pub fn terms(&self, ray: &Ray) -> (f64, f64) {
        (
            (self.point - ray.origin()).dot(self.normal),
            ray.direction().dot(self.normal),
        )
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let (numerator, denominator) = self.terms(ray);
        Working {
            form: None,
            parts: vec![
                Term::vector("point", "point a", self.point),
                Term::vector("normal", "normal n", self.normal),
            ],
            lines: vec![vec![
                Term::number("numerator", "(a - o)·n", numerator),
                Term::number("denominator", "d·n", denominator),
            ]],
            solutions: if denominator == 0.0 {
                Err("the ray is parallel to the plane")
            } else {
                Ok(vec![numerator / denominator])
            },
            name: None,
        }
    }

    /// Returns the part of the ray's line on the side away from the normal: all of it or nothing if it
    /// is parallel to the plane.
    #[inline]
    pub(super) fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let (above, up) = self.terms(ray);
        let above = if !leaving.is_empty() { 0.0 } else { above };
        if up == 0.0 {
            return (above >= 0.0).then_some(Span::WHOLE);
        }
        let end = Crossing::from(above / up);
        let Span { enter, exit } = Span::WHOLE;
        Some(match up > 0.0 {
            true => Span { enter, exit: end },
            false => Span { enter: end, exit },
        })
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let Self { point, normal } = self;
        [point.to_array(), normal.to_array()].into_iter().flatten()
    }

    pub(crate) const fn farthest_from(&self, _: DVec3) -> f64 {
        f64::INFINITY
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let equation = FaceEquation::plane(at, self.point, self.normal);
        at.see(0, &equation, FaceEdge::none, see);
    }

    /// Returns a depth in the half-space that the normal points away from: above 0 inside, 0 on the
    /// plane and below 0 outside.
    pub(crate) fn depth(&self, point: DVec3) -> f64 {
        (self.point - point).dot(self.normal)
    }
}

/// A plane or a piece of one.
pub(crate) trait Planar {
    const FACES: Faces = Faces::Flat;

    /// The plane, in the words of a message.
    const PLANE: &'static str;

    /// The plane.
    fn in_plane(&self) -> &Plane;

    /// Returns the `t` at which the ray's line hits it.
    fn t(&self, ray: &Ray) -> Option<f64>;

    #[inline]
    fn crossings(&self, ray: &Ray, leaving: Leaving) -> Crossings {
        match leaving.is_empty() {
            true => self.t(ray).into(),
            false => Crossings::default(),
        }
    }

    fn normal_on(&self, _: u64, _: &Ray, _: f64) -> DVec3 {
        self.in_plane().unit_normal()
    }

    fn membership(&self, eye: DVec3) -> Membership {
        match self.in_plane().depth(eye) == 0.0 {
            true => Membership::EdgeOn(Self::PLANE),
            false => Membership::Outside,
        }
    }
}

impl Planar for Plane {
    const PLANE: &'static str = "this plane";

    fn in_plane(&self) -> &Plane {
        self
    }

    /// Returns the `t` at which the ray's line hits the plane.
    #[inline(always)]
    fn t(&self, ray: &Ray) -> Option<f64> {
        let (numerator, denominator) = self.terms(ray);
        (denominator != 0.0).then(|| numerator / denominator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor() -> Plane {
        Plane::new(DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 2.0, 0.0)).unwrap()
    }

    #[test]
    fn the_length_of_the_normal_does_not_matter() {
        let down = Ray::new(DVec3::new(5.0, 3.0, 0.0), DVec3::new(0.0, -2.0, 0.0));
        assert_eq!(floor().intersect(&down, f64::INFINITY), Some(2.0));
        assert_eq!(floor().terms(&down), (-8.0, -4.0));
        assert_eq!(floor().unit_normal(), DVec3::Y);
        assert_eq!(floor().normal(), DVec3::new(0.0, 2.0, 0.0));
    }

    #[test]
    fn a_plane_is_infinite_and_not_hit_at_the_largest_t() {
        assert_eq!(floor().bounds(), None);
        let up = Ray::new(DVec3::new(0.0, -3.0, 0.0), DVec3::Y);
        assert_eq!(floor().intersect(&up, 2.0), None);
        assert_eq!(floor().intersect(&up, 2.5), Some(2.0));
    }

    #[test]
    fn a_plane_is_visible_from_behind() {
        let up = Ray::new(DVec3::new(0.0, -3.0, 0.0), DVec3::Y);
        assert_eq!(floor().intersect(&up, f64::INFINITY), Some(2.0));
    }

    #[test]
    fn nothing_is_hit_behind_beside_or_at_the_origin() {
        let at = |y: f64, direction| {
            floor().intersect(&Ray::new(DVec3::new(0.0, y, 0.0), direction), f64::INFINITY)
        };
        assert_eq!(at(0.0, DVec3::Y), None, "behind");
        assert_eq!(at(0.0, DVec3::X), None, "parallel");
        assert_eq!(at(-1.0, DVec3::X), None, "inside of the plane");
        assert_eq!(at(-1.0, -DVec3::Y), None, "t is 0");
        assert_eq!(
            at(1e300, DVec3::new(0.0, -1e-300, 0.0)),
            None,
            "t overflows"
        );
    }

    #[test]
    fn impossible_planes_are_rejected() {
        let point = DVec3::ZERO;
        assert!(matches!(
            Plane::new(point, DVec3::ZERO),
            Err(GeometryError::NoDirection { name: "normal", .. })
        ));
        assert!(matches!(
            Plane::new(DVec3::NAN, DVec3::Y),
            Err(GeometryError::NotFinite { name: "point" })
        ));
        assert!(Plane::new(point, DVec3::new(0.0, f64::INFINITY, 0.0)).is_err());
    }
}
