//! Solids combined from others: their union, intersection or difference.
//!
//! The line of a ray has one span inside each part that is convex, and at most two in others. Along the
//! line, the whole is inside or outside as the operations say of its parts; it is crossed where that
//! changes. Spans that touch are thereby joined, and those of length 0 vanish. Where several operands of an operation
//! change at one t, the face is that of the first of them.
//!
//! If a ray leaves a face, the end of the part's span that lies on it is 0 exactly, so that what is
//! inside or outside behind it stays right.

mod crossings;
mod node;
mod part;
#[cfg(test)]
mod tests;

use std::{fmt, ptr, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        Membership, Shape,
        around::Around,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving},
        indexed::Indexed,
        solid::{
            crossings::{Crossings, ends_after},
            node::{Combination, Node},
            part::SolidPart,
        },
        span::Span,
        working::Working,
    },
    transform::Transform,
};

/// A solid combined from others.
///
/// Its parts are the simple solids in it, from the first to the last. Face `8·p + f` is face `f` of
/// part `p`. Where a part is cut away, its faces point into it.
#[derive(Clone, Debug)]
pub struct Solid {
    parts: Vec<SolidPart>,
    root: Node,
    /// True for an intersection of convex parts.
    is_convex: bool,
    /// The box and the ball around it, if it is bounded.
    around: Option<Around>,
    index: Indexed<dyn Index>,
}

/// Finds the parts of a solid that a ray or a point is near, faster than the loop over all parts.
pub(crate) trait Index: fmt::Debug + Send + Sync {
    /// Calls `see` with each part that the ray may be inside of at a `t` with `0 ≤ t ≤ t_max`, and maybe
    /// with others.
    fn each(&self, ray: &Ray, t_max: f64, see: &mut dyn FnMut(usize));

    /// Calls `see` with each part whose box meets another one, and maybe with others, in their order.
    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize));

    /// Returns the first crossing of each ray of a bundle.
    fn first_of_each(
        &self,
        solid: &Solid,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE];
}

/// The way in which a solid is combined from its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// All points that are in some operand.
    Union,
    /// The points that are in all operands.
    Intersection,
    /// The points that are in the first operand and in no other.
    Difference,
}

impl Solid {
    /// The number of faces of each part.
    pub const FACES_OF_PART: u64 = 8;

    /// Puts solids together: planes as the half-spaces that their normals point away from, spheres,
    /// boxes, capped cylinders and cones, capsules, ellipsoids and others of this kind. All but the last
    /// may be placed by a transform.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no operand or if one of them is not a solid.
    pub fn new(
        operation: Operation,
        operands: impl IntoIterator<Item: Into<Shape>>,
    ) -> Result<Self, GeometryError> {
        let mut parts = Vec::new();
        let mut nodes = Vec::new();
        let mut ends = Vec::new();
        let mut arounds = Vec::new();
        for operand in operands {
            let shape: Shape = operand.into();
            let is_cut = operation == Operation::Difference && !nodes.is_empty();
            let first = parts.len();
            match &shape {
                Shape::Solid(solid) => {
                    arounds.push(solid.around);
                    nodes.push(solid.root.moved(first));
                    parts.extend(solid.parts.iter().cloned());
                }
                _ => {
                    let kind = shape.kind();
                    let part = SolidPart::new(shape);
                    let part = part.ok_or(GeometryError::NotSolid { kind })?;
                    arounds.push(part.around);
                    nodes.push(Node::Part(first));
                    parts.push(part);
                }
            }
            ends.push(parts.len());
            for part in &mut parts[first..] {
                part.is_cut ^= is_cut;
            }
        }
        if nodes.is_empty() {
            return Err(GeometryError::NoOperand);
        }
        let (around, smallest) = match operation {
            Operation::Union => (Around::union(&arounds), None),
            Operation::Intersection => Around::intersection(&arounds),
            Operation::Difference => (arounds[0], None),
        };
        let bounds = around.and_then(|around| around.bounds());
        let root = Node::Of(Box::new(Combination {
            operation,
            operands: nodes,
            ends,
            bounds,
            smallest,
        }));
        Ok(Self {
            is_convex: root.is_convex(&parts),
            parts,
            root,
            around: around.filter(|_| bounds.is_some()),
            index: Indexed::none(),
        })
    }

    /// Answers with an index from now on, unless there is one already.
    pub(crate) fn index_with(&self, build: impl FnOnce(&Self) -> Option<Box<dyn Index>>) {
        self.index.build(|| build(self));
    }

    /// Returns the lower and upper corners of the box around a part, if it is bounded.
    pub(crate) fn box_of(&self, part: usize) -> Option<[DVec3; 2]> {
        self.parts.get(part)?.around?.bounds()
    }

    /// The simple solids in it, from the first to the last.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = &Shape> {
        self.parts.iter().map(|part| &part.shape)
    }

    /// Returns true if it is easily seen that the solid is empty: the boxes around the operands of an
    /// intersection are disjoint, or the first operand of a difference is equal to another one, or its
    /// box lies in that, or both are balls and it lies in that.
    pub(crate) fn is_surely_empty(&self) -> bool {
        self.root.is_surely_empty(&self.parts)
    }

    /// Returns the smallest box around the operands of a union, around the first of a difference, and
    /// in those around the operands of an intersection, unless it is empty or unbounded: of the solid
    /// itself, or once it is mapped.
    pub(crate) fn smallest_box(&self, by: Option<&Arc<Transform>>) -> Option<[DVec3; 2]> {
        let [low, high] = self.root.smallest_box(&self.parts, by)?;
        low.cmple(high).all().then_some([low, high])
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        self.around
    }

    /// Returns a farthest point of a union's operands, of the first one of a difference, and of the
    /// smallest of the operands of an intersection or the box around it.
    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        self.bounds()?;
        self.root.support(&self.parts, direction)
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) const fn crossings<'a>(
        &'a self,
        ray: &'a Ray,
        leaving: Leaving<'a>,
    ) -> Crossings<'a> {
        Crossings {
            solid: self,
            ray,
            leaving,
        }
    }

    /// Returns the part that a face belongs to, and its number there.
    fn part_of(&self, face: u64) -> (usize, u64) {
        let part = face / Self::FACES_OF_PART;
        (part as usize, face % Self::FACES_OF_PART)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        self.each_near(at.around(), &mut |part| {
            let first = part as u64 * Self::FACES_OF_PART;
            self.parts[part].shape.each_face_near(at, &mut |found| {
                let face = first + found.face;
                see(&NearFace { face, ..*found });
            });
        });
    }

    /// The way in which its parts are combined.
    pub(crate) const fn root(&self) -> &Node {
        &self.root
    }

    /// Calls `see` with each part whose box meets another one, and maybe with others.
    pub(crate) fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        match self.index.get() {
            Some(index) => index.each_near(corners, see),
            None => (0..self.parts.len()).for_each(see),
        }
    }

    /// Returns a part, and the box and the ball around it.
    pub(crate) fn part(&self, part: usize) -> (&Shape, Option<&Around>) {
        let part = &self.parts[part];
        (&part.shape, part.around.as_ref())
    }

    /// Returns true if the point of a ray at `t` lies where the solid may be.
    pub(crate) fn holds(&self, ray: &Ray, t: f64) -> bool {
        let around = self.around.as_ref();
        around.is_none_or(|around| around.holds(ray, t))
    }

    /// Calls `see` with the spans of a ray inside a part.
    #[inline]
    pub(crate) fn each_span(
        &self,
        part: usize,
        ray: &Ray,
        leaving: Leaving,
        mut see: impl FnMut(Span),
    ) {
        let first_face = part as u64 * Self::FACES_OF_PART;
        let leaving = leaving.part(first_face, Self::FACES_OF_PART);
        let mut second = None;
        let first = self.parts[part].span(ray, leaving, |span| second = Some(span));
        first.map(&mut see);
        second.map(see);
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

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        let (part, face) = self.part_of(face);
        let Some(part) = self.parts.get(part) else {
            return -ray.direction();
        };
        let normal = part.shape.normal_at(ray, Crossing { t, face });
        if part.is_cut { -normal } else { normal }
    }

    /// Returns the terms of each part with the span of the ray's line inside, and where the line crosses
    /// the whole.
    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let crossings = self.crossings(ray, Leaving::NOTHING);
        let spans = crossings.of_parts(0..self.parts.len());
        let lines = self.parts.iter().enumerate().flat_map(|(number, part)| {
            let own = spans.iter().filter(|(of, _)| *of == number);
            part.working(number, ray, own.map(|(_, span)| span))
        });
        let all = ends_after(f64::NEG_INFINITY, &spans);
        let all = all.into_iter().filter_map(|t| crossings.at(t, &spans));
        let all: Vec<_> = all.map(|at| at.t).collect();
        Working {
            form: Some(self.root.form(&self.parts)),
            parts: Vec::new(),
            lines: lines.collect(),
            solutions: if all.is_empty() {
                Err("the ray misses it")
            } else {
                Ok(all)
            },
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        let mut all = Vec::new();
        self.root
            .each_number(&self.parts, &mut |number| all.push(number));
        all
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        match &self.around {
            Some(_) => self.root.farthest_from(&self.parts, point),
            None => f64::INFINITY,
        }
    }

    pub(crate) fn membership(&self, eye: DVec3) -> Membership {
        match self.around.filter(Around::is_finite) {
            Some(around) if self.root.depth(&self.parts, eye) > 0.0 => around.inside(),
            _ => Membership::Outside,
        }
    }
}

/// Copies of a solid are compared at once.
impl PartialEq for Solid {
    fn eq(&self, other: &Self) -> bool {
        let Self { parts, root, .. } = self;
        ptr::eq(self, other) || (*parts == other.parts && *root == other.root)
    }
}
