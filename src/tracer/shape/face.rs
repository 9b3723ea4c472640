//! The faces of shapes, the crossings of a ray with them, and the face that a ray leaves.
//!
//! A surface is not met at the point where a ray leaves it, which rounding errors would find a
//! little before or behind the origin: a flat face is not met again, and of a curved one only the
//! other root of its equation is, with its constant term taken as 0.

use std::ptr;

use crate::tracer::{
    ray::Ray,
    shape::{Shape, around::Around, plane::Plane},
    transform::Transform,
};

/// The faces of a kind of shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Faces {
    /// A flat face. As glass, it is a pane without thickness.
    Flat,
    /// A curved face.
    Curved,
    /// Faces with numbers from 0.
    Several,
    /// The same, all of them flat: which one a ray leaves is known by its plane alone.
    Triangles,
    /// The faces of copies.
    Copies,
}

/// A face of a geometry, as a hit finds it and the next ray leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceId {
    /// The index of the geometry.
    pub geometry: usize,
    /// The number of the face; 0 for a shape with one face.
    pub face: u64,
}

/// A point at which a ray crosses a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The ray parameter.
    pub(crate) t: f64,
    /// The number of the face.
    pub(crate) face: u64,
}

/// The crossings of a ray's line with a shape, at most `N`, from near to far. Some may lie behind the
/// origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossings<const N: usize = 2>(pub(crate) [Option<Crossing>; N]);

impl Default for Crossings {
    fn default() -> Self {
        Self([None; 2])
    }
}

impl<const N: usize> Crossings<N> {
    /// Returns the crossings that lie around a shape.
    #[inline(always)]
    pub(crate) fn near(mut self, around: &Around, ray: &Ray) -> Self {
        // In place: `map` of an array is a call.
        for at in &mut self.0 {
            *at = at.filter(|at| around.holds(ray, at.t));
        }
        self
    }

    /// Returns the `t` of the crossings, or the reason why there are none.
    pub(crate) fn solutions(self) -> Result<Vec<f64>, &'static str> {
        let all: Vec<_> = self.0.into_iter().flatten().map(|at| at.t).collect();
        match all.is_empty() {
            true => Err("the ray misses it"),
            false => Ok(all),
        }
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline(always)]
    pub(crate) fn first(self, t_max: f64) -> Option<Crossing> {
        self.in_front(t_max).next()
    }

    /// Returns the crossings with `0 < t < t_max`.
    #[inline(always)]
    pub(crate) fn in_front(self, t_max: f64) -> impl Iterator<Item = Crossing> {
        let all = self.0.into_iter().flatten();
        all.filter(move |at| in_front(at.t, t_max).is_some())
    }
}

impl<T: Into<Crossing>> From<Option<T>> for Crossings {
    #[inline(always)]
    fn from(at: Option<T>) -> Self {
        Self([at.map(T::into), None])
    }
}

impl From<f64> for Crossing {
    /// Creates the crossing of a shape with one face.
    #[inline(always)]
    fn from(t: f64) -> Self {
        Self { t, face: 0 }
    }
}

/// Returns `t` if it lies in front of the ray's origin and before `t_max`: `0 < t < t_max`.
#[inline(always)]
pub(crate) fn in_front(t: f64, t_max: f64) -> Option<f64> {
    (t > 0.0 && t < t_max).then_some(t)
}

/// The face that a ray leaves.
///
/// Planes are compared in the space of the shape. So a flat face under a transform lies in one plane
/// with those that the same matrix places, and with no others: moved by different numbers, rounding
/// would decide whether two planes are the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Own<'a> {
    shape: &'a Shape,
    face: u64,
    /// The plane of a flat face, in the space of the shape.
    plane: Option<Plane>,
    /// The transform of the part of a solid that the face belongs to.
    inner: Option<&'a Transform>,
}

impl<'a> Own<'a> {
    #[inline]
    pub(crate) fn new(shape: &'a Shape, face: u64) -> Self {
        Self {
            shape,
            face,
            plane: shape.plane(face),
            inner: shape.inner_transform(face),
        }
    }

    /// The shape.
    #[inline(always)]
    pub(crate) const fn shape(&self) -> &'a Shape {
        self.shape
    }

    /// Returns the part of this face in a shape, which may be another one.
    #[inline]
    pub(crate) fn on(&self, shape: &Shape) -> Leaving<'_> {
        let is_own = match shape.faces() {
            // Two meshes may be equal without being one, and are long to compare.
            Faces::Triangles => false,
            // So are lists of copies.
            Faces::Copies => ptr::eq(self.shape, shape),
            Faces::Flat | Faces::Curved | Faces::Several => self.shape == shape,
        };
        Leaving {
            face: is_own.then_some(self.face),
            plane: self
                .plane
                .as_ref()
                .filter(|_| self.shape.shares_space(shape)),
            inner: self.inner,
        }
    }

    /// Returns true if the only face of a shape is the same surface, at least in part: the sphere
    /// has the same numbers, or the flat shape lies in the same plane.
    #[inline]
    pub(crate) fn is_all_of(&self, shape: &Shape) -> bool {
        match (&self.plane, shape.plane(0)) {
            (Some(own), Some(other)) => {
                let is_in_place = self.inner.is_none() && self.shape.shares_space(shape);
                is_in_place && own.contains(&other)
            }
            _ => self.shape == shape,
        }
    }
}

/// The face that a ray leaves, as a shape sees it that the ray may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaving<'a> {
    /// The number of the face if it belongs to this shape or an equal one.
    pub(crate) face: Option<u64>,
    /// The plane of a flat face, of any shape in the same space.
    plane: Option<&'a Plane>,
    /// The transform of the part of a solid that the plane belongs to, in that space.
    inner: Option<&'a Transform>,
}

impl Leaving<'_> {
    /// A ray that leaves no surface.
    pub(crate) const NOTHING: Self = Self {
        face: None,
        plane: None,
        inner: None,
    };

    /// Returns the same for a part of a solid, with the number of the face if it belongs to it.
    #[inline(always)]
    pub(crate) const fn of_face(self, face: Option<u64>) -> Self {
        Self { face, ..self }
    }

    /// Returns the same in the space of a part of a solid before its transform.
    pub(crate) fn before(self, transform: &Transform) -> Self {
        Self {
            plane: self.plane.filter(|_| self.inner == Some(transform)),
            inner: None,
            ..self
        }
    }

    /// Returns true if both are known to be the same.
    #[inline(always)]
    pub(crate) fn is_surely(&self, other: &Self) -> bool {
        let [one, other_plane] = [self.plane, other.plane].map(|plane| plane.map(ptr::from_ref));
        self.face == other.face && one == other_plane
    }

    /// Returns true if the face is flat.
    #[inline(always)]
    pub(crate) const fn is_flat(&self) -> bool {
        self.plane.is_some()
    }

    /// Returns true if the ray leaves this plane.
    #[inline(always)]
    pub(crate) fn is_in(&self, plane: &Plane) -> bool {
        self.inner.is_none() && self.plane.is_some_and(|own| own.contains(plane))
    }
}

impl Shape {
    /// Returns the transform of the part of a solid that a face belongs to.
    #[inline]
    fn inner_transform(&self, face: u64) -> Option<&Transform> {
        match self {
            Self::Solid(solid) => solid.part(face)?.transform(),
            Self::Placed(placed) => placed.shape().inner_transform(face),
            _ => None,
        }
    }

    /// Returns true if both shapes are placed by the same matrix, or neither is placed.
    #[inline]
    fn shares_space(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Placed(one), Self::Placed(other)) => one.transform() == other.transform(),
            (Self::Placed(_), _) | (_, Self::Placed(_)) => false,
            _ => true,
        }
    }

    /// Returns the number of the face that a ray meets at a `t` found by [`Shape::intersect`].
    pub(crate) fn face_at(&self, ray: &Ray, t: f64) -> u64 {
        match self.faces() {
            Faces::Flat | Faces::Curved => 0,
            Faces::Several | Faces::Triangles | Faces::Copies => {
                let met = self.meet(ray, Leaving::NOTHING, t.next_up());
                met.map_or(0, |crossing| crossing.face)
            }
        }
    }

    /// Returns the first crossing with `0 < t < t_max` of a ray that leaves a face, if it leaves
    /// any.
    #[inline]
    pub(crate) fn meet_from(&self, own: Option<&Own>, ray: &Ray, t_max: f64) -> Option<Crossing> {
        let leaving = own.map_or(Leaving::NOTHING, |own| own.on(self));
        self.meet(ray, leaving, t_max)
    }
}
