//! The traversal of copies by a ray.

use std::fmt;

use glam::DVec3;

use crate::tracer::{
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        around::Around,
        face::{Crossing, FaceId, Leaving, in_front},
        instances::{Instances, PrototypeShape},
    },
    transform::Transform,
};

/// Finds the crossings of a ray with copies faster than the loop over all of them, with the same bits.
pub(crate) trait Index: fmt::Debug + Send + Sync {
    /// Returns the crossing with the smallest `t`, `0 < t < t_max`; at equal `t` the one with the
    /// lowest number.
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing>;

    /// Returns the first crossing of each ray of a bundle.
    fn first_of_each(
        &self,
        copies: &Instances,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE];

    /// Calls `see` with each crossing with `0 < t < t_max`, in any order.
    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing));

    /// Calls `see` with each copy whose box meets another one, and maybe with others near it.
    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize));
}

/// The traversal of copies by a ray.
pub(crate) struct Passage<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
    leaving: Leaving<'a>,
}

/// A copy and the ray that is mapped back to the prototype.
pub(crate) struct Copied<'a> {
    passage: &'a Passage<'a>,
    copy: usize,
    transform: Transform,
    ray: Ray,
    leaving: Leaving<'a>,
}

impl<'a> Passage<'a> {
    pub(super) const fn new(instances: &'a Instances, ray: &'a Ray, leaving: Leaving<'a>) -> Self {
        Self {
            instances,
            ray,
            leaving,
        }
    }

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
        let faces = instances.faces;
        Some(Copied {
            passage: self,
            copy,
            ray: transform.ray_back(self.ray),
            transform,
            leaving: self.leaving.part(copy as u64 * faces, faces),
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
        !self.leaving.is_empty() || inner.is_none_or(|around| around.may_meet(&self.ray, t_max))
    }

    /// Returns the faces that the ray leaves, by the index of their shape.
    pub(crate) fn left(&self) -> Vec<FaceId> {
        let faces = self.leaving.faces();
        let found = faces.filter_map(|face| {
            let (geometry, _, face) = self.passage.instances.part_of(face)?;
            Some(FaceId { geometry, face })
        });
        found.collect()
    }

    /// Returns the first crossing with `0 < t < t_max`.
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        let mut nearest = None;
        for (index, part) in self.passage.instances.prototype.iter().enumerate() {
            let t_max = nearest.map_or(t_max, |(_, crossing): (usize, Crossing)| crossing.t);
            let met = part.shape.meet(&self.ray, self.leaving_of(part), t_max);
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
            let leaving = self.leaving_of(part);
            part.shape
                .each_crossing(&self.ray, leaving, t_max, |crossing| {
                    if self.counts(part, &crossing) && in_front(crossing.t, t_max).is_some() {
                        see(self.numbered(part, crossing));
                    }
                });
        }
    }

    /// Returns the faces of a shape that the ray leaves.
    #[inline]
    fn leaving_of(&self, part: &PrototypeShape) -> Leaving<'_> {
        self.leaving.part(part.first, part.shape.face_count())
    }

    /// Returns true if a crossing lies around the shape that is mapped, as that of a
    /// [`Placed`](super::Placed) shape must.
    fn counts(&self, part: &PrototypeShape, crossing: &Crossing) -> bool {
        let around = Around::shape(&part.shape);
        let around = around.and_then(|around| around.mapped(&self.transform));
        around.is_none_or(|around| around.holds(self.passage.ray, crossing.t))
    }

    /// Returns the crossing with the number of its face among those of all copies.
    fn numbered(&self, part: &PrototypeShape, crossing: Crossing) -> Crossing {
        let face = self.copy as u64 * self.passage.instances.faces + part.first + crossing.face;
        Crossing { face, ..crossing }
    }
}
