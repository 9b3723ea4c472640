//! Solids combined from others: their union, intersection or difference.
//!
//! The line of a ray has one span inside each part that is convex, and at most two in others. Along the
//! line, the whole is inside or outside as the operations say of its parts; it is crossed where that
//! changes. Spans that touch are thereby joined, and those of length 0 vanish. Where several operands of an operation
//! change at one t, the face is that of the first of them.
//!
//! If a ray leaves a face, the end of the part's span that lies on it is 0 exactly, so that what is
//! inside or outside behind it stays right.

mod part;
#[cfg(test)]
mod tests;

use std::{iter, ptr, slice, sync::Arc};

use glam::{BVec3, DVec3};

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Membership, Shape,
        around::Around,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving, in_front},
        solid::part::SolidPart,
        span::{Side, Span},
        sphere::Sphere,
        working::Working,
    },
    transform::Transform,
    vector::farthest_along,
};

/// A solid combined from others.
///
/// Its parts are the simple solids in it, from the first to the last. Face `8·p + f` is face `f` of
/// part `p`. Where a part is cut away, its faces point into it.
#[derive(Clone, Debug)]
pub struct Solid {
    parts: Vec<SolidPart>,
    root: Node,
    /// The box and the ball around it, if it is bounded.
    around: Option<Around>,
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

#[derive(Clone, Debug, PartialEq)]
enum Node {
    /// A part, by its index.
    Part(usize),
    Of(Box<Combination>),
}

#[derive(Clone, Debug, PartialEq)]
struct Combination {
    operation: Operation,
    operands: Vec<Node>,
    /// The box around it, if it is bounded.
    bounds: Option<[DVec3; 2]>,
    /// The operand of an intersection that is smaller than that box.
    smallest: Option<usize>,
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
            bounds,
            smallest,
        }));
        Ok(Self {
            parts,
            root,
            around: around.filter(|_| bounds.is_some()),
        })
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

    pub(crate) fn crossings<'a>(&'a self, ray: &'a Ray, leaving: Leaving<'a>) -> Crossings<'a> {
        let mut more = Vec::new();
        let spans = self.parts.iter().enumerate().map(|(number, part)| {
            let first_face = number as u64 * Self::FACES_OF_PART;
            let leaving = leaving.part(first_face, Self::FACES_OF_PART);
            let first = part.span(ray, leaving, |span| more.push((number, span)));
            first.unwrap_or(NOWHERE)
        });
        let spans = spans.collect();
        Crossings {
            solid: self,
            ray,
            inside: PartSpans::new(spans, more),
        }
    }

    /// Returns the part that a face belongs to, and its number there.
    fn part_of(&self, face: u64) -> (usize, u64) {
        let part = face / Self::FACES_OF_PART;
        (part as usize, face % Self::FACES_OF_PART)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        for (part, first) in self
            .parts()
            .zip((0..).step_by(Self::FACES_OF_PART as usize))
        {
            part.each_face_near(at, &mut |found| {
                let face = first + found.face;
                see(&NearFace { face, ..*found });
            });
        }
    }

    /// Returns which of eight points are surely not on its surface, given those that are surely inside and
    /// outside of each part.
    pub(crate) fn lanes_off(&self, inside: &[u8], outside: &[u8]) -> u8 {
        let [inside, outside] = self.root.lanes(&|part| [inside[part], outside[part]]);
        inside | outside
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
        let parts = self.parts.iter().enumerate();
        let lines =
            parts.flat_map(|(number, part)| part.working(number, ray, crossings.inside.of(number)));
        let all: Vec<_> = crossings.after(f64::NEG_INFINITY).map(|at| at.t).collect();
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

impl Node {
    /// Returns the node for parts that are moved to later indices.
    fn moved(&self, by: usize) -> Self {
        match self {
            Self::Part(part) => Self::Part(part + by),
            Self::Of(of) => Self::Of(Box::new(Combination {
                operands: of.operands.iter().map(|node| node.moved(by)).collect(),
                ..(**of).clone()
            })),
        }
    }

    /// Returns true inside, given the parts that are.
    #[inline]
    fn is_in(&self, part: &impl Fn(usize) -> bool) -> bool {
        match self {
            Self::Part(index) => part(*index),
            Self::Of(of) => {
                let mut operands = of.operands.iter().map(|node| node.is_in(part));
                match of.operation {
                    Operation::Union => operands.any(|is_in| is_in),
                    Operation::Intersection => operands.all(|is_in| is_in),
                    Operation::Difference => {
                        operands.next().is_some_and(|is_in| is_in) && !operands.any(|is_in| is_in)
                    }
                }
            }
        }
    }

    /// Returns the points that are surely inside and outside, lane i as bit i, given those of the parts.
    fn lanes(&self, part: &impl Fn(usize) -> [u8; 2]) -> [u8; 2] {
        let of = match self {
            Self::Part(index) => return part(*index),
            Self::Of(of) => of,
        };
        let mut operands = of.operands.iter().map(|node| node.lanes(part));
        let first = operands.next().unwrap_or([0, u8::MAX]);
        operands.fold(first, |[inside, outside], [one, other]| {
            match of.operation {
                Operation::Union => [inside | one, outside & other],
                Operation::Intersection => [inside & one, outside | other],
                Operation::Difference => [inside & other, outside | one],
            }
        })
    }

    /// Returns the corners of a box around it, if it is bounded.
    fn bounds(&self, parts: &[SolidPart]) -> Option<[DVec3; 2]> {
        match self {
            Self::Part(index) => parts[*index].around.as_ref()?.bounds(),
            Self::Of(of) => of.bounds,
        }
    }

    /// Returns [`Solid::smallest_box`].
    fn smallest_box(&self, parts: &[SolidPart], by: Option<&Arc<Transform>>) -> Option<[DVec3; 2]> {
        let of = match self {
            Self::Part(index) => {
                let mut shape = parts[*index].shape.clone();
                if let Some(transform) = by {
                    shape = shape.placed(transform).ok()?;
                }
                return Shape::smallest_box_around([shape]);
            }
            Self::Of(of) => of,
        };
        let mut boxes = of.operands.iter().map(|node| node.smallest_box(parts, by));
        match of.operation {
            Operation::Difference => boxes.next()?,
            Operation::Union => {
                let first = boxes.next()??;
                boxes.try_fold(first, |[low, high], more| {
                    let [least, most] = more?;
                    Some([low.min(least), high.max(most)])
                })
            }
            Operation::Intersection => {
                // Turned, the box around the whole may be smaller than all around its operands.
                let own = by.and_then(|by| Some(by.surround(self.smallest_box(parts, None)?)));
                boxes
                    .flatten()
                    .chain(own)
                    .reduce(|[low, high], [least, most]| [low.max(least), high.min(most)])
            }
        }
    }

    /// Returns true if two are equal, whatever the indices of their parts are.
    fn equals(&self, other: &Self, parts: &[SolidPart]) -> bool {
        match (self, other) {
            (Self::Part(one), Self::Part(other)) => parts[*one].shape == parts[*other].shape,
            (Self::Of(one), Self::Of(other)) => {
                let mut pairs = one.operands.iter().zip(&other.operands);
                one.operation == other.operation
                    && one.operands.len() == other.operands.len()
                    && pairs.all(|(one, other)| one.equals(other, parts))
            }
            (Self::Part(_), Self::Of(_)) | (Self::Of(_), Self::Part(_)) => false,
        }
    }

    /// Returns true if something surely lies inside, given the parts that it lies in.
    fn holds(&self, parts: &[SolidPart], is_in: &impl Fn(&SolidPart) -> bool) -> bool {
        match self {
            Self::Part(index) => is_in(&parts[*index]),
            Self::Of(of) => {
                let mut operands = of.operands.iter();
                match of.operation {
                    Operation::Union => operands.any(|node| node.holds(parts, is_in)),
                    Operation::Intersection => operands.all(|node| node.holds(parts, is_in)),
                    Operation::Difference => false,
                }
            }
        }
    }

    /// Returns [`Solid::is_surely_empty`].
    fn is_surely_empty(&self, parts: &[SolidPart]) -> bool {
        let Self::Of(of) = self else {
            return false;
        };
        let mut operands = of.operands.iter();
        match of.operation {
            Operation::Union => false,
            Operation::Intersection => {
                let none = [DVec3::NEG_INFINITY, DVec3::INFINITY];
                let [low, high] = operands
                    .filter_map(|node| node.bounds(parts))
                    .fold(none, |[low, high], [a, b]| [low.max(a), high.min(b)]);
                low.cmpgt(high).any()
            }
            Operation::Difference => {
                let Some(first) = operands.next() else {
                    return false;
                };
                let bounds = first.bounds(parts);
                let holds_box = |part: &SolidPart, bounds| {
                    let mut corners = corners(bounds);
                    part.shape.is_convex() && corners.all(|corner| part.depth(corner) >= 0.0)
                };
                let ball = match first {
                    Self::Part(index) => parts[*index].shape.sphere(),
                    Self::Of(_) => None,
                };
                let holds_ball = |part: &SolidPart, ball: &Sphere| {
                    part.shape.sphere().is_some_and(|sphere| {
                        let away = (sphere.center() - ball.center()).length();
                        away + ball.radius() <= sphere.radius()
                    })
                };
                operands.any(|node| {
                    let holds_box = |of| node.holds(parts, &|part| holds_box(part, of));
                    let holds_ball = |of| node.holds(parts, &|part| holds_ball(part, of));
                    node.equals(first, parts)
                        || bounds.is_some_and(holds_box)
                        || ball.is_some_and(holds_ball)
                })
            }
        }
    }

    /// Returns the depth of a point below the surface: above 0 inside, 0 on it and below 0 outside. What
    /// is cut away is outside at its depth inside, so that its surface is no part of either.
    fn depth(&self, parts: &[SolidPart], point: DVec3) -> f64 {
        match self {
            Self::Part(index) => parts[*index].depth(point),
            Self::Of(of) => {
                let mut depths = of.operands.iter().map(|node| node.depth(parts, point));
                let first = depths.next().unwrap_or(f64::NEG_INFINITY);
                match of.operation {
                    Operation::Union => depths.fold(first, f64::max),
                    Operation::Intersection => depths.fold(first, f64::min),
                    Operation::Difference => depths.fold(first, |all, cut| all.min(-cut)),
                }
            }
        }
    }

    /// Returns the part whose face is crossed at a `t`, if the ray gets inside or outside there.
    fn crossed(&self, inside: &PartSpans, t: f64) -> Option<usize> {
        let is_in = |side| self.is_in(&|part| inside.holds(part, t, side));
        if is_in(Side::Before) == is_in(Side::After) {
            return None;
        }
        match self {
            Self::Part(part) => Some(*part),
            Self::Of(of) => of.operands.iter().find_map(|node| node.crossed(inside, t)),
        }
    }

    /// Returns what it is put together from, such as `Difference(box 0, sphere 1)`.
    fn form(&self, parts: &[SolidPart]) -> String {
        match self {
            Self::Part(part) => format!("{} {part}", parts[*part].shape.kind()),
            Self::Of(of) => {
                let operands: Vec<_> = of.operands.iter().map(|node| node.form(parts)).collect();
                format!("{:?}({})", of.operation, operands.join(", "))
            }
        }
    }

    fn support(&self, parts: &[SolidPart], direction: DVec3) -> Option<DVec3> {
        let of = match self {
            Self::Part(part) => return parts[*part].shape.support(direction),
            Self::Of(of) => of,
        };
        let mut operands = of.operands.iter();
        match of.operation {
            Operation::Difference => operands.next()?.support(parts, direction),
            Operation::Union => {
                let first = operands.next()?.support(parts, direction)?;
                operands.try_fold(first, |farthest, node| {
                    farthest_along([farthest, node.support(parts, direction)?], direction)
                })
            }
            Operation::Intersection => match of.smallest {
                Some(smallest) => operands.nth(smallest)?.support(parts, direction),
                None => {
                    let [low, high] = of.bounds?;
                    Some(DVec3::select(direction.cmpgt(DVec3::ZERO), high, low))
                }
            },
        }
    }

    fn farthest_from(&self, parts: &[SolidPart], point: DVec3) -> f64 {
        let of = match self {
            Self::Part(part) => return parts[*part].shape.farthest_from(point),
            Self::Of(of) => of,
        };
        let mut operands = of
            .operands
            .iter()
            .map(|node| node.farthest_from(parts, point));
        match of.operation {
            Operation::Union => operands.fold(0.0, f64::max),
            Operation::Intersection => operands.fold(f64::INFINITY, f64::min),
            Operation::Difference => operands.next().unwrap_or(f64::INFINITY),
        }
    }

    /// Calls `see` with the numbers of the parts and of what is done with them.
    fn each_number(&self, parts: &[SolidPart], see: &mut dyn FnMut(f64)) {
        match self {
            Self::Part(part) => {
                let shape = &parts[*part].shape;
                let kind = Shape::KINDS.iter().position(|kind| *kind == shape.kind());
                see(kind.unwrap_or_default() as f64);
                shape.each_number(&mut *see);
            }
            Self::Of(of) => {
                see(match of.operation {
                    Operation::Union => -1.0,
                    Operation::Intersection => -2.0,
                    Operation::Difference => -3.0,
                });
                see(of.operands.len() as f64);
                for node in &of.operands {
                    node.each_number(parts, see);
                }
            }
        }
    }
}

/// The crossings of a ray's line with a solid, found one after the other.
pub(crate) struct Crossings<'a> {
    solid: &'a Solid,
    ray: &'a Ray,
    inside: PartSpans,
}

impl Crossings<'_> {
    /// Returns true if the ray is inside just before or just after its origin.
    pub(crate) fn is_inside(&self, side: Side) -> bool {
        let root = &self.solid.root;
        root.is_in(&|part| self.inside.holds(part, 0.0, side))
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline]
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        self.in_front(t_max).next()
    }

    /// Returns the crossings with `0 < t < t_max`.
    pub(crate) fn in_front(&self, t_max: f64) -> impl Iterator<Item = Crossing> {
        self.after(0.0)
            .take_while(move |at| in_front(at.t, t_max).is_some())
    }

    /// Returns the crossings after a `t`.
    fn after(&self, t: f64) -> impl Iterator<Item = Crossing> {
        let Self { solid, ray, inside } = self;
        let ends = || inside.all().flat_map(|span| [span.enter.t, span.exit.t]);
        let next = move |last: f64| ends().filter(|t| *t > last).min_by(f64::total_cmp);
        let all = iter::successors(next(t), move |last| next(*last));
        let finite = all.take_while(|t| *t < f64::INFINITY);
        let met = finite.filter_map(|t| {
            let part = solid.root.crossed(inside, t)?;
            let mut ends = inside.of(part).flat_map(|span| [span.enter, span.exit]);
            let Crossing { face, .. } = ends.find(|end| end.t == t)?;
            let face = part as u64 * Solid::FACES_OF_PART + face;
            Some(Crossing { t, face })
        });
        met.filter(|at| {
            let around = solid.around.as_ref();
            around.is_none_or(|around| around.holds(ray, at.t))
        })
    }
}

/// Returns the corners of a box, given by its lower and upper ones.
fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |corner| {
        let is_high = |axis: u32| corner >> axis & 1 == 1;
        DVec3::select(BVec3::new(is_high(0), is_high(1), is_high(2)), high, low)
    })
}

/// The spans of a ray inside the parts of a solid.
struct PartSpans {
    /// The first span of each part, and behind them the second spans of parts that are not convex.
    spans: Vec<Span>,
    /// The parts of the second spans.
    more: Vec<usize>,
}

impl PartSpans {
    fn new(mut spans: Vec<Span>, more: Vec<(usize, Span)>) -> Self {
        spans.extend(more.iter().map(|(_, span)| span));
        let more = more.into_iter().map(|(part, _)| part);
        Self {
            spans,
            more: more.collect(),
        }
    }

    fn all(&self) -> slice::Iter<'_, Span> {
        self.spans.iter()
    }

    /// Returns the spans inside a part.
    #[inline]
    fn of(&self, part: usize) -> impl Iterator<Item = &Span> {
        let first = self.spans.get(part).filter(|span| **span != NOWHERE);
        let seconds = self.spans.iter().rev().zip(self.more.iter().rev());
        let own = seconds.filter(move |(_, of)| **of == part);
        first.into_iter().chain(own.map(|(span, _)| span))
    }

    /// Returns true if the points right before or after a `t` are within a part.
    #[inline]
    fn holds(&self, part: usize, t: f64, side: Side) -> bool {
        let holds = |span: &Span| span.holds(t, side);
        holds(&self.spans[part]) || (!self.more.is_empty() && self.of(part).any(holds))
    }
}

/// The span of a ray that misses a part.
const NOWHERE: Span = Span::new([f64::INFINITY, f64::NEG_INFINITY], 0);
