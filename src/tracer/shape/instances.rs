//! Copies of shapes, each in a place of its own.

use std::{
    fmt, ptr,
    sync::{Arc, OnceLock},
};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Extent, Shape, Standing,
        around::Around,
        axis::outward,
        face::{Crossing, FaceId, Faces, Leaving, Own, in_front},
        placed::placement_terms,
        plane::Plane,
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
/// A ray that leaves a copy leaves a surface of this copy alone, or of one in the same place.
pub struct Instances {
    prototype: Arc<[Part]>,
    /// The number of faces of a copy.
    faces: u64,
    rows: Arc<Vec<Rows>>,
    /// The box and the ball around the prototype, if it is bounded.
    inner: Option<Around>,
    /// The same around all copies, if each is finite.
    around: Option<Around>,
    index: OnceLock<Box<dyn Index>>,
}

/// The rows of a transform: all that is kept of it.
pub(crate) type Rows = [[f64; 4]; 3];

/// A shape of the prototype.
#[derive(Clone, Debug, PartialEq)]
struct Part {
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

/// Finds the crossings of a ray with copies faster than the loop over all of them, with the same bits.
pub(crate) trait Index: fmt::Debug + Send + Sync {
    /// Returns the crossing with the smallest `t`, `0 < t < t_max`; at equal `t` the one with the
    /// lowest number.
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing>;

    /// Calls `see` with each crossing with `0 < t < t_max`, in any order.
    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing));
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
        for shape in shapes {
            let shape: Shape = shape.into();
            let first = faces;
            faces = faces.saturating_add(shape.face_count());
            parts.push(Part { shape, first });
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
            rows,
            inner,
            around: None,
            index: OnceLock::new(),
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

    /// Returns the lower and upper corners of a box around a copy, if it is finite.
    pub(crate) fn box_of(&self, copy: usize) -> Option<[DVec3; 2]> {
        self.inner?.mapped(&self.transform(copy)?)?.bounds()
    }

    /// Answers with an index from now on, unless there is one already.
    pub(crate) fn index_with(&self, build: impl FnOnce(&Self) -> Option<Box<dyn Index>>) {
        if self.index.get().is_none()
            && let Some(index) = build(self)
        {
            // Another thread may have been faster, as with a mesh.
            drop(self.index.set(index));
        }
    }

    /// Returns equal copies of other shapes in place of their own.
    #[cfg(test)]
    pub(crate) fn of_others(&self, shapes: impl IntoIterator<Item = Shape>) -> Self {
        Self::of_rows(shapes, Arc::clone(&self.rows)).unwrap()
    }

    pub(crate) fn bounds(&self) -> Option<[DVec3; 2]> {
        self.around?.bounds()
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        self.around?;
        let mut farthest: Option<DVec3> = None;
        for copy in 0..self.len() {
            let transform = self.transform(copy)?;
            // Most copies lie far behind another.
            if let (Extent::Ball(center, radius), Some(known)) =
                (self.inner?.mapped(&transform)?.extent(), farthest)
                && (center - known).dot(direction) + radius < 0.0
            {
                continue;
            }
            let along = transform.steepest(direction);
            for shape in self.shapes() {
                let point = transform.point(shape.support(along)?);
                let is_nearer = |known: &DVec3| known.dot(direction) >= point.dot(direction);
                farthest = farthest.filter(is_nearer).or(Some(point));
            }
        }
        farthest
    }

    /// Returns the smallest `t` with `0 < t < t_max` at which the ray hits a copy.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        let met = self.crossings(ray, Leaving::NOTHING).first(t_max)?;
        Some(met.t)
    }

    pub(crate) const FACES: Faces = Faces::Copies;

    pub(crate) fn crossings<'a>(&'a self, ray: &'a Ray, leaving: Leaving<'a>) -> Passage<'a> {
        Passage {
            instances: self,
            ray,
            own: leaving.face.and_then(|face| self.face(face)),
        }
    }

    /// None: planes are compared in a copy alone.
    pub(crate) const fn plane(&self, _: u64) -> Option<Plane> {
        None
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

    pub(crate) const fn extent(&self) -> Extent<'static> {
        match &self.around {
            Some(around) => around.extent(),
            None => Extent::EVERYWHERE,
        }
    }

    /// Returns an upper bound: the copies lie in a box and in a ball.
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let around = self.around.as_ref();
        around.map_or(f64::INFINITY, |around| around.farthest_from(point))
    }

    /// Returns the first copy that the eye is inside of. That it lies in the plane of one hides no
    /// others.
    pub(crate) fn standing(&self, eye: DVec3) -> Standing {
        let copies = 0..self.len();
        let mut all = copies.filter_map(|copy| {
            let transform = self.transform(copy)?;
            let inner = transform.point_back(eye);
            let is_near = self.inner.is_none_or(|around| around.boxes(inner));
            let mut shapes = self.shapes().filter(|_| is_near);
            let around = shapes.find_map(|shape| match shape.standing(inner) {
                Standing::Inside(..) => Some(Around::shape(shape)?.mapped(&transform)),
                Standing::EdgeOn(_) | Standing::Free => None,
            });
            Some(around??.inside())
        });
        all.next().unwrap_or(Standing::Free)
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

/// The way of a ray through copies.
pub(crate) struct Passage<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
    /// The face that the ray leaves, if it is one of these.
    own: Option<Face<'a>>,
}

/// A copy and the ray that is mapped back to the prototype.
pub(crate) struct Copied<'a> {
    passage: &'a Passage<'a>,
    copy: usize,
    transform: Transform,
    ray: Ray,
    /// The face that the ray leaves, if it belongs to this copy.
    own: Option<Own<'a>>,
}

impl<'a> Passage<'a> {
    /// The ray.
    #[inline(always)]
    pub(crate) const fn ray(&self) -> &Ray {
        self.ray
    }

    /// The number of copies.
    pub(crate) fn count(&self) -> usize {
        self.instances.len()
    }

    /// Returns a copy as the ray sees it.
    #[inline]
    pub(crate) fn copied(&'a self, copy: usize) -> Option<Copied<'a>> {
        let instances = self.instances;
        let transform = instances.transform(copy)?;
        let same_place = |own: &&Face<'a>| {
            own.copy == copy || instances.rows.get(own.copy) == instances.rows.get(copy)
        };
        let own = self.own.as_ref().filter(same_place);
        Some(Copied {
            passage: self,
            copy,
            ray: transform.ray_back(self.ray),
            transform,
            own: own.map(|own| Own::new(own.shape, own.face)),
        })
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline(never)]
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        match self.instances.index.get() {
            Some(index) => index.first(self, t_max),
            None => self.first_of_all(t_max),
        }
    }

    /// Returns the first crossing by testing all copies: the definition.
    pub(crate) fn first_of_all(&self, t_max: f64) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for copy in 0..self.instances.len() {
            let t_max = first.map_or(t_max, |crossing| crossing.t);
            let copied = self.copied(copy);
            first = copied.and_then(|copied| copied.first(t_max)).or(first);
        }
        first
    }

    /// Calls `see` with each crossing with `0 < t < t_max`, in the order of the copies.
    pub(crate) fn each_of_all(&self, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        let copies = 0..self.instances.len();
        let copies = copies.filter_map(|copy| self.copied(copy));
        copies.for_each(|copied| copied.each(t_max, see));
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far; at equal `t` in the order of the
    /// copies, and in a copy in that of its shapes.
    pub(crate) fn in_front(&self, t_max: f64) -> impl Iterator<Item = Crossing> + use<> {
        let mut all = Vec::new();
        let mut see = |crossing| all.push(crossing);
        match self.instances.index.get() {
            Some(index) => index.each(self, t_max, &mut see),
            None => self.each_of_all(t_max, &mut see),
        }
        let copy_of = |crossing: &Crossing| self.instances.copy_of(crossing.face);
        all.sort_by(|one, other| {
            let by_t = one.t.total_cmp(&other.t);
            by_t.then(copy_of(one).cmp(&copy_of(other)))
        });
        all.into_iter()
    }
}

impl Copied<'_> {
    /// The ray that is mapped back.
    pub(crate) const fn ray(&self) -> &Ray {
        &self.ray
    }

    /// Returns false if the ray does not meet the copy before `t_max`. Where a ray that leaves the copy
    /// meets it again depends on nothing but its direction.
    #[inline]
    pub(crate) fn is_near(&self, t_max: f64) -> bool {
        let inner = self.passage.instances.inner.as_ref();
        self.own.is_some() || inner.is_none_or(|around| around.may_meet(&self.ray, t_max))
    }

    /// Returns the face that the ray leaves, by the index of its shape.
    pub(crate) fn own(&self) -> Option<FaceId> {
        self.own.as_ref()?;
        let own = self.passage.own.as_ref()?;
        Some(FaceId {
            geometry: own.part,
            face: own.face,
        })
    }

    /// Returns the first crossing with `0 < t < t_max`.
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        let mut nearest = None;
        for (index, part) in self.passage.instances.prototype.iter().enumerate() {
            let t_max = nearest.map_or(t_max, |(_, crossing): (usize, Crossing)| crossing.t);
            let met = part.shape.meet_from(self.own.as_ref(), &self.ray, t_max);
            nearest = met.map(|met| (index, met)).or(nearest);
        }
        self.first_that_counts(nearest, t_max)
    }

    /// Returns the first crossing that counts from the nearest one of the mapped ray with a shape of
    /// the prototype: nearly always that one.
    pub(crate) fn first_that_counts(
        &self,
        nearest: Option<(usize, Crossing)>,
        t_max: f64,
    ) -> Option<Crossing> {
        let (index, crossing) = nearest?;
        let part = self.passage.instances.prototype.get(index)?;
        if self.counts(part, &crossing) {
            return Some(self.numbered(part, crossing));
        }
        let mut first: Option<Crossing> = None;
        self.each(t_max, &mut |crossing| {
            if first.is_none_or(|first| crossing.t < first.t) {
                first = Some(crossing);
            }
        });
        first
    }

    /// Calls `see` with each crossing with `0 < t < t_max`, in the order of the shapes.
    pub(crate) fn each(&self, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        for part in self.passage.instances.prototype.iter() {
            let own = self.own.as_ref();
            let leaving = own.map_or(Leaving::NOTHING, |own| own.on(&part.shape));
            part.shape
                .each_crossing(&self.ray, leaving, t_max, |crossing| {
                    if self.counts(part, &crossing) && in_front(crossing.t, t_max).is_some() {
                        see(self.numbered(part, crossing));
                    }
                });
        }
    }

    /// Returns true if a crossing lies around the shape that is mapped, as that of a
    /// [`Placed`](super::Placed) shape must.
    fn counts(&self, part: &Part, crossing: &Crossing) -> bool {
        let around = Around::shape(&part.shape);
        let around = around.and_then(|around| around.mapped(&self.transform));
        around.is_none_or(|around| around.holds(self.passage.ray, crossing.t))
    }

    /// Returns the crossing with the number of its face among those of all copies.
    fn numbered(&self, part: &Part, crossing: Crossing) -> Crossing {
        let face = self.copy as u64 * self.passage.instances.faces + part.first + crossing.face;
        Crossing { face, ..crossing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        random::{Rng, cases},
        shape::{any::copies, cuboid::Cuboid, disc::Disc, sphere::Sphere},
    };

    fn shift(x: f64) -> Transform {
        Transform::new(DVec3::new(x, 0.0, 0.0), None, DVec3::ONE).unwrap()
    }

    // A copy is hit where the same shapes are that are placed by its transform, and what is hit is the
    // same.
    #[test]
    fn copies_are_placed_shapes() {
        let mut rng = Rng(41);
        let mut hits = 0;
        for _ in 0..cases(300) {
            let Ok(all) = copies(&mut rng, DVec3::ZERO, 2.0) else {
                continue;
            };
            if all
                .shapes()
                .any(|shape| shape.transform().is_some() || shape.copies().is_some())
            {
                continue;
            }
            let places = (0..all.len()).map(|copy| Arc::new(all.transform(copy).unwrap()));
            let placed: Vec<Shape> = places
                .flat_map(|place| {
                    let shapes = all.shapes().cloned();
                    shapes.map(move |shape| shape.placed(&place).unwrap())
                })
                .collect();
            let shape = Shape::from(all);
            for _ in 0..20 {
                let origin = rng.vector() * 4.0;
                let ray = Ray::new(origin, rng.vector() - origin);
                let mut nearest: Option<(&Shape, Crossing)> = None;
                for other in &placed {
                    let t_max = nearest.map_or(f64::INFINITY, |(_, met)| met.t);
                    let met = other.meet(&ray, Leaving::NOTHING, t_max);
                    nearest = met.map(|met| (other, met)).or(nearest);
                }
                let found = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY);
                assert_eq!(
                    found.map(|met| met.t.to_bits()),
                    nearest.map(|(_, met)| met.t.to_bits()),
                    "{shape:?} {ray:?}"
                );
                let (Some(found), Some((other, met))) = (found, nearest) else {
                    continue;
                };
                hits += 1;
                assert_eq!(shape.normal_at(&ray, found), other.normal_at(&ray, met));
            }
        }
        assert!(hits > cases(300) / 4, "{hits}");
    }

    #[test]
    fn faces_are_numbered_through() {
        let ball: Shape = Sphere::new(DVec3::ZERO, 1.0).unwrap().into();
        let cube: Shape = Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5))
            .unwrap()
            .into();
        let all = Instances::new([ball, cube], [shift(0.0), shift(4.0), shift(4.0)]).unwrap();
        assert_eq!((all.len(), all.copy_of(all.face_count() - 1)), (3, 2));
        let shape = Shape::from(all);
        let ray = Ray::new(DVec3::new(9.0, 0.0, 0.0), DVec3::NEG_X);
        let met = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY).unwrap();
        let copies = shape.copies().unwrap();
        let (part, inner, face) = copies.part_of(met.face).unwrap();
        assert_eq!(
            (met.t, copies.copy_of(met.face)),
            (4.0, 1),
            "the first of two"
        );
        assert_eq!((part, inner.kind(), face), (0, "sphere", 0));
        let [low, high] = shape.bounds().unwrap();
        assert!(
            (low - DVec3::new(-1.0, -1.0, -1.0)).length() < 1e-12,
            "{low}"
        );
        assert!(
            (high - DVec3::new(5.0, 1.0, 1.0)).length() < 1e-12,
            "{high}"
        );
        assert_eq!(shape.support(DVec3::X), Some(DVec3::new(5.0, 0.0, 0.0)));
        assert_eq!(
            shape.standing(DVec3::new(4.2, 0.9, 0.0)).clone(),
            shape.standing(DVec3::new(4.0, 0.9, 0.0))
        );
        assert_eq!(shape.standing(DVec3::new(2.0, 0.0, 0.0)), Standing::Free);
    }

    // What a ray leaves is a surface of its copy, or of one in the same place, and of no other.
    #[test]
    fn a_ray_leaves_its_own_copy() {
        let disc: Shape = Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap().into();
        let other: Shape = Disc::new(DVec3::X * 0.5, DVec3::Z, 1.0).unwrap().into();
        let places = [shift(0.0), shift(0.25), shift(0.0)];
        let shape: Shape = Instances::new([disc.clone(), other], places)
            .unwrap()
            .into();
        let ray = Ray::new(DVec3::new(0.1, 0.1, 1e-20), DVec3::NEG_Z);
        let own = |face| Own::new(&shape, face);
        let met = |face| shape.meet_from(Some(&own(face)), &ray, f64::INFINITY);
        assert_eq!(
            met(0).map(|met| met.face),
            Some(2),
            "only the middle copy is met"
        );
        assert_eq!(met(2).map(|met| met.face), Some(0));
        let floor = Own::new(&disc, 0);
        assert!(shape.meet_from(Some(&floor), &ray, f64::INFINITY).is_some());
    }

    #[test]
    fn nothing_is_no_copy() {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        assert!(Instances::new([ball], []).is_err());
        assert!(Instances::new(Vec::<Shape>::new(), [shift(0.0)]).is_err());
    }
}
