//! Copies of shapes, each in a place of its own.

pub(crate) mod passage;
#[cfg(test)]
mod tests;

use std::{fmt, ptr, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        Extent, Membership, Shape,
        around::Around,
        axis::outward,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving},
        indexed::Indexed,
        instances::passage::{Index, Passage},
        placed::placement_terms,
        working::{Term, Working},
    },
    transform::Transform,
};

/// Copies of shapes: the prototype, once for each transform.
///
/// A ray meets a copy where the ray that is mapped back by its transform meets the prototype, so that
/// a copy needs no memory but for its transform. A ray hits what it hits of the copies alone: the
/// smallest `t`, and at equal `t` the copy that comes first, and in it the shape that comes first. The
/// faces of all copies are numbered through, in their order.
///
/// A copy in the place of another has faces of its own.
pub struct Instances {
    prototype: Arc<[PrototypeShape]>,
    /// The number of faces of a copy.
    faces: u64,
    /// The number of shapes that a copy is, with those inside of others.
    inside: usize,
    rows: Arc<Vec<Rows>>,
    /// The box and the ball around the prototype, if it is bounded.
    inner: Option<Around>,
    /// The same around all copies, if each is finite.
    around: Option<Around>,
    index: Indexed<dyn Index>,
}

/// The rows of a transform: all that is kept of it.
pub(crate) type Rows = [[f64; 4]; 3];

/// A shape of the prototype.
#[derive(Clone, Debug, PartialEq)]
struct PrototypeShape {
    shape: Shape,
    /// The number that its first face has in a copy.
    first: u64,
}

/// A face of a copy.
struct Face<'a> {
    copy: usize,
    /// The index of the shape.
    part: usize,
    shape: &'a Shape,
    /// The number that it has in the shape.
    face: u64,
}

impl Instances {
    /// Creates copies of some shapes, one of all of them for each transform.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no shape or no transform, or if there are 2³² - 1 transforms or
    /// more, or 2⁶⁴ faces.
    pub fn new(
        shapes: impl IntoIterator<Item: Into<Shape>>,
        transforms: impl IntoIterator<Item = Transform>,
    ) -> Result<Self, GeometryError> {
        let rows = transforms.into_iter().map(|transform| transform.rows());
        Self::of_rows(shapes, rows.collect::<Vec<_>>().into())
    }

    /// The same from the rows of transforms, which can be inverted.
    pub(crate) fn of_rows(
        shapes: impl IntoIterator<Item: Into<Shape>>,
        rows: Arc<Vec<Rows>>,
    ) -> Result<Self, GeometryError> {
        let mut parts = Vec::new();
        let mut faces: u64 = 0;
        let mut inside: usize = 0;
        for shape in shapes {
            let shape: Shape = shape.into();
            let first = faces;
            faces = faces.saturating_add(shape.face_count());
            inside = inside.saturating_add(shape.total());
            parts.push(PrototypeShape { shape, first });
        }
        if parts.is_empty() || rows.is_empty() {
            return Err(GeometryError::NoOperand);
        }
        let count = rows.len() as u64;
        if count >= u64::from(u32::MAX) || faces.checked_mul(count).is_none() {
            return Err(GeometryError::OutOfRange {
                name: "number of faces",
                value: faces as f64 * count as f64,
                range: [1.0, u64::MAX as f64],
            });
        }
        let arounds: Vec<_> = parts
            .iter()
            .map(|part| Around::shape(&part.shape))
            .collect();
        let inner = Around::union(&arounds).filter(Around::is_finite);
        let mut instances = Self {
            prototype: parts.into(),
            faces,
            inside,
            rows,
            inner,
            around: None,
            index: Indexed::none(),
        };
        let boxes = (0..instances.len()).map(|copy| instances.box_of(copy));
        instances.around = boxes
            .reduce(|one, other| {
                let ([low, high], [lower, higher]) = (one?, other?);
                Some([low.min(lower), high.max(higher)])
            })
            .flatten()
            .map(|corners| Around::points(&corners))
            .filter(Around::is_finite);
        Ok(instances)
    }

    /// Returns the same copies mapped by a transform.
    ///
    /// # Errors
    ///
    /// Returns an error if a product cannot be inverted.
    pub(crate) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let rows = self.rows.iter();
        let rows = rows.map(|rows| {
            let product = transform.times(&Transform::from_rows(*rows)?)?;
            Ok(product.rows())
        });
        let rows = rows.collect::<Result<Vec<Rows>, GeometryError>>()?;
        Self::of_rows(self.shapes().cloned(), rows.into())
    }

    /// Returns each copy for itself; none if not all are finite.
    pub(crate) fn each(&self) -> impl Iterator<Item = Shape> {
        let rows = self.around.iter().flat_map(|_| self.rows.iter());
        rows.map(|rows| {
            let one = Self {
                prototype: Arc::clone(&self.prototype),
                rows: vec![*rows].into(),
                index: Indexed::none(),
                ..*self
            };
            one.into()
        })
    }

    /// The number of copies.
    #[inline]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns false: there is at least one copy.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The shapes of the prototype, in their order.
    pub fn shapes(&self) -> impl ExactSizeIterator<Item = &Shape> {
        self.prototype.iter().map(|part| &part.shape)
    }

    /// Returns the number of shapes that it is: itself and all of one copy.
    pub(crate) fn total(&self) -> usize {
        self.inside.saturating_add(1)
    }

    /// Returns a number that is above those of all faces.
    pub(crate) fn face_count(&self) -> u64 {
        self.faces.saturating_mul(self.rows.len() as u64)
    }

    /// Returns the transform of a copy.
    #[inline]
    pub fn transform(&self, copy: usize) -> Option<Transform> {
        Transform::from_rows(*self.rows.get(copy)?).ok()
    }

    /// Returns the number of the copy that a face belongs to.
    #[inline]
    pub fn copy_of(&self, face: u64) -> usize {
        (face / self.faces) as usize
    }

    /// Returns the shape of the prototype that a face belongs to, its index, and the number of the
    /// face there.
    pub(crate) fn part_of(&self, face: u64) -> Option<(usize, &Shape, u64)> {
        let Face {
            part, shape, face, ..
        } = self.face(face)?;
        Some((part, shape, face))
    }

    fn face(&self, face: u64) -> Option<Face<'_>> {
        let copy = self.copy_of(face);
        let face = face % self.faces;
        let behind = self.prototype.partition_point(|part| part.first <= face);
        let index = behind.checked_sub(1)?;
        let part = self.prototype.get(index)?;
        Some(Face {
            copy,
            part: index,
            shape: &part.shape,
            face: face - part.first,
        })
    }

    /// The number of faces of a copy.
    pub(crate) const fn faces_of_copy(&self) -> u64 {
        self.faces
    }

    /// Returns a shape of the prototype, and the number of its first face in a copy.
    #[inline]
    pub(crate) fn part(&self, index: usize) -> Option<(&Shape, u64)> {
        let part = self.prototype.get(index)?;
        Some((&part.shape, part.first))
    }

    /// The box and the ball around the prototype, if it is bounded.
    pub(crate) const fn around_prototype(&self) -> Option<&Around> {
        self.inner.as_ref()
    }

    /// Returns the lower and upper corners of a box around a copy, if it is finite.
    pub(crate) fn box_of(&self, copy: usize) -> Option<[DVec3; 2]> {
        self.inner?.mapped(&self.transform(copy)?)?.bounds()
    }

    /// Answers with an index from now on, unless there is one already.
    pub(crate) fn index_with(&self, build: impl FnOnce(&Self) -> Option<Box<dyn Index>>) {
        self.index.build(|| build(self));
    }

    /// Returns equal copies of other shapes in place of their own.
    #[cfg(test)]
    pub(crate) fn of_others(&self, shapes: impl IntoIterator<Item = Shape>) -> Self {
        Self::of_rows(shapes, Arc::clone(&self.rows)).unwrap()
    }

    /// Returns the smallest box around all copies.
    pub(crate) fn smallest_box(&self) -> Option<[DVec3; 2]> {
        let transforms = (0..self.len()).filter_map(|copy| self.transform(copy).map(Arc::new));
        Shape::smallest_box_around(transforms.flat_map(|transform| {
            let shapes = self.shapes().cloned();
            shapes.filter_map(move |shape| shape.placed(&transform).ok())
        }))
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        self.around
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        self.around?;
        let ball = |copy: usize| {
            let around = self.inner?.mapped(&self.transform(copy)?)?;
            match around.extent() {
                Extent::Ball(center, radius) => Some((center, radius)),
                Extent::Plane(_) => None,
            }
        };
        let support = |copy: usize| {
            let transform = self.transform(copy)?;
            let along = transform.steepest(direction);
            let mut farthest: Option<DVec3> = None;
            for shape in self.shapes() {
                let point = transform.point(shape.support(along)?);
                let is_nearer = |known: &DVec3| known.dot(direction) >= point.dot(direction);
                farthest = farthest.filter(is_nearer).or(Some(point));
            }
            farthest
        };
        let balls: Vec<_> = (0..self.len()).map(ball).collect::<Option<_>>()?;
        // Most copies lie far behind the one whose ball reaches farthest.
        let reaches = balls.iter().enumerate();
        let reaches =
            reaches.map(|(copy, (center, radius))| (center.dot(direction) + radius, copy));
        let (_, mut at) = reaches.max_by(|one, other| one.0.total_cmp(&other.0))?;
        let mut farthest = support(at)?;
        for (copy, (center, radius)) in balls.into_iter().enumerate() {
            if copy == at || (center - farthest).dot(direction) + radius < 0.0 {
                continue;
            }
            let point = support(copy)?;
            let [known, this] = [farthest, point].map(|point| point.dot(direction));
            // Of equal ones, the first.
            if this > known || (this == known && copy < at) {
                (at, farthest) = (copy, point);
            }
        }
        Some(farthest)
    }

    pub(crate) const FACES: Faces = Faces::Copies;

    pub(crate) fn crossings<'a>(&'a self, ray: &'a Ray, leaving: Leaving<'a>) -> Passage<'a> {
        Passage::new(self, ray, leaving)
    }

    /// Returns the first crossing of each ray of a bundle.
    pub(crate) fn first_of_each(
        &self,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        match self.index.get() {
            Some(index) => index.first_of_each(self, bundle, leaving),
            None => bundle.each(|lane, ray, t_max| self.crossings(ray, leaving[lane]).first(t_max)),
        }
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let mut test = |copy: usize| {
            let is_near = self.box_of(copy).is_none_or(|around| at.is_near(around));
            let Some(transform) = self.transform(copy).filter(|_| is_near) else {
                return;
            };
            let (at, first) = (at.before(&transform), copy as u64 * self.faces);
            for part in self.prototype.iter() {
                part.shape.each_face_near(&at, &mut |found| {
                    let face = first + part.first + found.face;
                    see(&NearFace { face, ..*found });
                });
            }
        };
        self.each_near(at.around(), &mut test);
    }

    /// Calls `see` with each copy whose box meets another one, given its corners, and maybe with others.
    pub(crate) fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        match self.index.get() {
            Some(index) => index.each_near(corners, see),
            None => (0..self.len()).for_each(see),
        }
    }

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        let normal = self.face(face).and_then(|found| {
            let transform = self.transform(found.copy)?;
            let crossing = Crossing {
                t,
                face: found.face,
            };
            let inner = found.shape.normal_at(&transform.ray_back(ray), crossing);
            Some(outward(transform.normal(inner), ray))
        });
        normal.unwrap_or(-ray.direction())
    }

    pub(crate) fn weights_at(&self, ray: &Ray, face: u64) -> Option<[f64; 3]> {
        let found = self.face(face)?;
        let inner = self.transform(found.copy)?.ray_back(ray);
        found.shape.weights_at(&inner, found.face)
    }

    /// Returns the working of the shape that the ray hits first, in its copy.
    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let number = |number: usize| number as f64;
        let mut parts = vec![Term::number("copies", "copies", number(self.len()))];
        let first = self.crossings(ray, Leaving::NOTHING).first(f64::INFINITY);
        let met = first.and_then(|crossing| {
            let found = self.face(crossing.face)?;
            let transform = self.transform(found.copy)?;
            Some((found, transform))
        });
        let Some((found, transform)) = met else {
            return Working {
                form: None,
                parts,
                lines: Vec::new(),
                solutions: Err("the ray misses all copies"),
                name: None,
            };
        };
        parts.push(Term::number("copy", "copy", number(found.copy)));
        if self.prototype.len() > 1 {
            parts.push(Term::number("shape", "shape", number(found.part)));
        }
        let (terms, line) = placement_terms(&transform, ray);
        parts.extend(terms);
        let mut working = found.shape.working(&transform.ray_back(ray));
        working.parts.splice(0..0, parts);
        working.lines.insert(0, line);
        working
    }

    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let mut all = Vec::new();
        for shape in self.shapes() {
            shape.each_number(|number| all.push(number));
        }
        let rows = self.rows.iter();
        all.into_iter()
            .chain(rows.flat_map(|rows| rows.as_flattened().iter().copied()))
    }

    /// Returns an upper bound: the copies lie in a box and in a ball.
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let around = self.around.as_ref();
        around.map_or(f64::INFINITY, |around| around.farthest_from(point))
    }

    /// Returns the first copy that the eye is inside of. That it lies in the plane of one hides no
    /// others.
    pub(crate) fn membership(&self, eye: DVec3) -> Membership {
        let copies = 0..self.len();
        let mut all = copies.filter_map(|copy| {
            let transform = self.transform(copy)?;
            let inner = transform.point_back(eye);
            let is_near = self.inner.is_none_or(|around| around.boxes(inner));
            let mut shapes = self.shapes().filter(|_| is_near);
            let around = shapes.find_map(|shape| match shape.membership(inner) {
                Membership::Inside(..) => Some(Around::shape(shape)?.mapped(&transform)),
                Membership::EdgeOn(_) | Membership::Outside => None,
            });
            Some(around??.inside())
        });
        all.next().unwrap_or(Membership::Outside)
    }
}

/// Lists in the same memory are compared at once.
impl PartialEq for Instances {
    fn eq(&self, other: &Self) -> bool {
        ptr::eq(self, other) || (self.prototype == other.prototype && self.rows == other.rows)
    }
}

impl fmt::Debug for Instances {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instances")
            .field("prototype", &self.prototype)
            .field("rows", &self.rows)
            .finish_non_exhaustive()
    }
}
