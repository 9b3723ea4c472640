//! The faces of shapes, the crossings of a ray with them, and the faces that a ray leaves.
//!
//! A surface is not met at the point where a ray leaves it, which rounding errors would find a
//! little before or behind the origin: a flat face is not met again, and of a curved one only the
//! other root of its equation is, with its constant term taken as 0.

use crate::tracer::{
    ray::Ray,
    shape::{Shape, around::Around},
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
    /// The faces of copies.
    Copies,
}

/// A face of a geometry, as a hit finds it and the next ray leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

/// The faces of a shape that a ray leaves: those that its origin lies on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaving<'a> {
    /// In ascending order, all of one geometry.
    faces: &'a [FaceId],
    /// The number of the first face of the shape among those of the geometry.
    first: u64,
}

impl<'a> Leaving<'a> {
    /// A ray that leaves no surface.
    pub(crate) const NOTHING: Self = Self {
        faces: &[],
        first: 0,
    };

    /// Returns those of a geometry among faces in ascending order.
    #[inline(always)]
    pub(crate) fn of(faces: &'a [FaceId], geometry: usize) -> Self {
        Self { faces, first: 0 }.between(
            FaceId { geometry, face: 0 },
            FaceId {
                geometry,
                face: u64::MAX,
            },
        )
    }

    /// Returns those of a part of the shape with this many faces, from one on.
    #[inline(always)]
    pub(crate) fn part(self, first: u64, count: u64) -> Self {
        let Some(FaceId { geometry, .. }) = self.faces.first().copied() else {
            return self;
        };
        let first = self.first + first;
        let id = |face| FaceId { geometry, face };
        Self { first, ..self }.between(id(first), id(first.saturating_add(count - 1)))
    }

    /// Returns those from one face to another, which counts too.
    #[inline(always)]
    fn between(self, from: FaceId, to: FaceId) -> Self {
        let faces = self.faces;
        let start = faces.iter().position(|face| *face >= from);
        let faces = &faces[start.unwrap_or(faces.len())..];
        let end = faces.iter().position(|face| *face > to);
        Self {
            faces: &faces[..end.unwrap_or(faces.len())],
            ..self
        }
    }

    /// Returns true if the ray leaves none.
    #[inline(always)]
    pub(crate) const fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Returns true if the ray leaves a face.
    #[inline(always)]
    pub(crate) fn has(&self, face: u64) -> bool {
        let mut faces = self.faces.iter();
        faces.any(|left| left.face == self.first + face)
    }

    /// The numbers of the faces in the shape.
    pub(crate) fn faces(&self) -> impl Iterator<Item = u64> {
        self.faces.iter().map(|left| left.face - self.first)
    }
}

impl Shape {
    /// Returns the number of the face that a ray meets at a `t` found by [`Shape::intersect`].
    pub(crate) fn face_at(&self, ray: &Ray, t: f64) -> u64 {
        match self.faces() {
            Faces::Flat | Faces::Curved => 0,
            Faces::Several | Faces::Copies => {
                let met = self.meet(ray, Leaving::NOTHING, t.next_up());
                met.map_or(0, |crossing| crossing.face)
            }
        }
    }
}

#[cfg(test)]
impl FaceId {
    /// Creates a face of a shape that is the only geometry.
    pub(crate) const fn of_shape(face: u64) -> Self {
        Self { geometry: 0, face }
    }
}

#[cfg(test)]
impl<'a> Leaving<'a> {
    /// Creates a ray that leaves one face.
    pub(crate) const fn only(face: &'a FaceId) -> Self {
        Self {
            faces: std::slice::from_ref(face),
            first: 0,
        }
    }
}
