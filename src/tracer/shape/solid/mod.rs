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

use std::{fmt, iter, ptr, sync::Arc};

use glam::{BVec3, DVec3};
use smallvec::SmallVec;

use crate::tracer::{
    error::GeometryError,
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        Membership, Shape,
        around::Around,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving, in_front},
        indexed::Indexed,
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
    /// The number behind that of the last part of each operand.
    ends: Vec<usize>,
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
            parts,
            root,
            around: around.filter(|_| bounds.is_some()),
            index: Indexed::none(),
        })
    }

    /// Returns true if it is the union of all its parts.
    pub(crate) fn is_union(&self) -> bool {
        self.root.is_union()
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

    /// Returns what is surely inside and what is surely outside of it, lane i as bit i, given the same of
    /// some parts, in their order: nothing is inside of others.
    pub(crate) fn sides<T>(&self, parts: &[(usize, T)], of: &impl Fn(&T) -> [u8; 2]) -> [u8; 2] {
        self.root.sides(parts, of)
    }

    /// Returns the lanes of those given that are on another side of it before than after, given the sides of
    /// some parts. Calls `see` with each part whose face is crossed there, and with its lanes.
    pub(crate) fn crossed<T>(
        &self,
        parts: &[(usize, T)],
        sides: &impl Fn(&T, Side) -> [u8; 2],
        lanes: u8,
        see: &mut impl FnMut(&[(usize, T)], u8),
    ) -> u8 {
        self.root.crossed(parts, sides, lanes, see)
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

impl Node {
    fn is_union(&self) -> bool {
        match self {
            Self::Part(_) => true,
            Self::Of(of) => {
                of.operation == Operation::Union && of.operands.iter().all(Self::is_union)
            }
        }
    }

    /// Returns the node for parts that are moved to later indices.
    fn moved(&self, by: usize) -> Self {
        match self {
            Self::Part(part) => Self::Part(part + by),
            Self::Of(of) => Self::Of(Box::new(Combination {
                operands: of.operands.iter().map(|node| node.moved(by)).collect(),
                ends: of.ends.iter().map(|end| end + by).collect(),
                ..(**of).clone()
            })),
        }
    }

    /// Returns [`Solid::sides`].
    fn sides<T>(&self, parts: &[(usize, T)], of: &impl Fn(&T) -> [u8; 2]) -> [u8; 2] {
        const NOWHERE: [u8; 2] = [0, u8::MAX];
        let either =
            |[inside, outside]: [u8; 2], [one, other]: [u8; 2]| [inside | one, outside & other];
        let combined = match self {
            Self::Part(_) => return parts.iter().map(|(_, it)| of(it)).fold(NOWHERE, either),
            Self::Of(combined) => combined,
        };
        let mut met = combined.met(parts);
        let sides = |(_, (node, parts)): (usize, (&Self, _))| node.sides(parts, of);
        match combined.operation {
            Operation::Union => met.map(sides).fold(NOWHERE, either),
            Operation::Intersection => {
                let mut count = 0;
                let all = met.fold([u8::MAX, 0], |[inside, outside], operand| {
                    count += 1;
                    let [one, other] = sides(operand);
                    [inside & one, outside | other]
                });
                match count == combined.operands.len() {
                    true => all,
                    false => NOWHERE,
                }
            }
            Operation::Difference => {
                let first = met.next().filter(|(operand, _)| *operand == 0);
                let Some(first) = first.map(sides) else {
                    return NOWHERE;
                };
                met.fold(first, |[inside, outside], cut| {
                    let [one, other] = sides(cut);
                    [inside & other, outside | one]
                })
            }
        }
    }

    /// Returns [`Solid::crossed`].
    fn crossed<T>(
        &self,
        parts: &[(usize, T)],
        sides: &impl Fn(&T, Side) -> [u8; 2],
        lanes: u8,
        see: &mut impl FnMut(&[(usize, T)], u8),
    ) -> u8 {
        let inside = |side| self.sides(parts, &|part| sides(part, side))[0];
        let changed = (inside(Side::Before) ^ inside(Side::After)) & lanes;
        match self {
            _ if changed == 0 => {}
            Self::Part(_) => see(parts, changed),
            Self::Of(of) => {
                // Of operands that change at one t, the first counts.
                of.met(parts).fold(changed, |left, (_, (node, parts))| {
                    left & !node.crossed(parts, sides, left, see)
                });
            }
        }
        changed
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

impl Combination {
    /// Returns the operands that have some of these parts, in their order, and those of each.
    fn met<'a, T>(
        &'a self,
        mut parts: &'a [(usize, T)],
    ) -> impl Iterator<Item = (usize, MetOperand<'a, T>)> {
        iter::from_fn(move || {
            let (first, _) = *parts.first()?;
            let operand = self.ends.partition_point(|end| *end <= first);
            let end = *self.ends.get(operand)?;
            let count = parts.iter().position(|(part, _)| *part >= end);
            let (own, others) = parts.split_at(count.unwrap_or(parts.len()));
            parts = others;
            Some((operand, (&self.operands[operand], own)))
        })
    }
}

/// An operand and what is known of some of its parts.
type MetOperand<'a, T> = (&'a Node, &'a [(usize, T)]);

/// The crossings of a ray's line with a solid.
pub(crate) struct Crossings<'a> {
    solid: &'a Solid,
    ray: &'a Ray,
    leaving: Leaving<'a>,
}

/// The spans of a ray inside parts, in their order.
type PartSpans = SmallVec<[(usize, Span); 6]>;

impl<'a> Crossings<'a> {
    /// Returns true if the ray is inside just before or just after its origin.
    pub(crate) fn is_inside(&self, side: Side) -> bool {
        let sides = |span: &Span| sides_of(span, 0.0, side);
        let [inside, _] = self.solid.sides(&self.spans(0.0), &sides);
        inside & 1 == 1
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline]
    pub(crate) fn first(self, t_max: f64) -> Option<Crossing> {
        self.in_front(t_max).next()
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far.
    pub(crate) fn in_front(self, t_max: f64) -> impl Iterator<Item = Crossing> + use<'a> {
        let spans = self.spans(t_max);
        let ends = ends_after(0.0, &spans).into_iter();
        let ends = ends.take_while(move |t| in_front(*t, t_max).is_some());
        ends.filter_map(move |t| self.at(t, &spans))
    }

    /// Returns the crossing at a `t` where the ray gets inside or outside of a part.
    fn at(&self, t: f64, spans: &[(usize, Span)]) -> Option<Crossing> {
        let sides = |span: &Span, side| sides_of(span, t, side);
        let mut face = None;
        self.solid.crossed(spans, &sides, 1, &mut |own, _| {
            let ends = own.iter().flat_map(|(part, span)| {
                let ends = [span.enter, span.exit].into_iter();
                ends.map(|end| (end.t, *part as u64 * Solid::FACES_OF_PART + end.face))
            });
            face = ends
                .filter(|(end, _)| *end == t)
                .map(|(_, face)| face)
                .next();
        });
        let face = face?;
        let holds = self.solid.holds(self.ray, t);
        holds.then_some(Crossing { t, face })
    }

    /// Returns the spans inside the parts that the ray may meet at a `t` with `0 ≤ t ≤ t_max`.
    fn spans(&self, t_max: f64) -> PartSpans {
        let Some(index) = self.solid.index.get() else {
            return self.of_parts(0..self.solid.parts.len());
        };
        let mut met = SmallVec::<[usize; 16]>::new();
        index.each(self.ray, t_max, &mut |part| met.push(part));
        met.sort_unstable();
        self.of_parts(met)
    }

    /// Returns the spans inside some parts, in their order.
    fn of_parts(&self, parts: impl IntoIterator<Item = usize>) -> PartSpans {
        let mut spans = PartSpans::new();
        for part in parts {
            let see = |span| spans.push((part, span));
            self.solid.each_span(part, self.ray, self.leaving, see);
        }
        spans
    }
}

/// Returns whether a line is inside of a span or outside just before or just after a `t`, in lane 0.
fn sides_of(span: &Span, t: f64, side: Side) -> [u8; 2] {
    let holds = span.holds(t, side);
    [u8::from(holds), u8::from(!holds)]
}

/// Returns the finite `t` above one at which spans begin or end, in ascending order.
fn ends_after(t: f64, spans: &[(usize, Span)]) -> SmallVec<[f64; 12]> {
    let spans = spans.iter().map(|(_, span)| span);
    let ends = spans.flat_map(|span| [span.enter.t, span.exit.t]);
    let mut ends: SmallVec<_> = ends
        .filter(|end| *end > t && *end < f64::INFINITY)
        .collect();
    ends.sort_unstable_by(f64::total_cmp);
    ends.dedup();
    ends
}

/// Returns the corners of a box, given by its lower and upper ones.
fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |corner| {
        let is_high = |axis: u32| corner >> axis & 1 == 1;
        DVec3::select(BVec3::new(is_high(0), is_high(1), is_high(2)), high, low)
    })
}
