//! The way in which a solid is combined from its parts.

use std::{iter, sync::Arc};

use glam::{BVec3, DVec3};

use crate::tracer::{
    shape::{
        Shape,
        solid::{Operation, part::SolidPart},
        span::{Side, Span},
        sphere::Sphere,
    },
    transform::Transform,
    vector::farthest_along,
};

/// A part, or what is combined from others.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Node {
    /// A part, by its index.
    Part(usize),
    Of(Box<Combination>),
}

/// Nodes and the operation that combines them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Combination {
    pub(super) operation: Operation,
    pub(super) operands: Vec<Node>,
    /// The number behind that of the last part of each operand.
    pub(super) ends: Vec<usize>,
    /// The box around it, if it is bounded.
    pub(super) bounds: Option<[DVec3; 2]>,
    /// The operand of an intersection that is smaller than that box.
    pub(super) smallest: Option<usize>,
}

impl Node {
    /// Returns true if it is the union of all its parts.
    pub(crate) fn is_union(&self) -> bool {
        match self {
            Self::Part(_) => true,
            Self::Of(of) => {
                of.operation == Operation::Union && of.operands.iter().all(Self::is_union)
            }
        }
    }

    /// Returns true if it is the intersection of all its parts, and these are convex.
    pub(super) fn is_convex(&self, parts: &[SolidPart]) -> bool {
        match self {
            Self::Part(part) => parts[*part].shape.is_convex(),
            Self::Of(of) => {
                let mut operands = of.operands.iter();
                of.operation == Operation::Intersection
                    && operands.all(|operand| operand.is_convex(parts))
            }
        }
    }

    /// Returns the node for parts that are moved to later indices.
    pub(super) fn moved(&self, by: usize) -> Self {
        match self {
            Self::Part(part) => Self::Part(part + by),
            Self::Of(of) => Self::Of(Box::new(Combination {
                operands: of.operands.iter().map(|node| node.moved(by)).collect(),
                ends: of.ends.iter().map(|end| end + by).collect(),
                ..(**of).clone()
            })),
        }
    }

    /// Returns what is surely inside and what is surely outside of it, lane i as bit i, given the same of
    /// some parts, in their order: nothing is inside of others.
    pub(crate) fn sides<T>(&self, parts: &[(usize, T)], of: &impl Fn(&T) -> [u8; 2]) -> [u8; 2] {
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

    /// Returns the least and the largest `t` that may be inside of it, given the spans of some parts, in their
    /// order.
    pub(super) fn range(&self, spans: &[(usize, Span)]) -> [f64; 2] {
        const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let around =
            |[low, high]: [f64; 2], [least, most]: [f64; 2]| [low.min(least), high.max(most)];
        let of = match self {
            Self::Part(_) => {
                let spans = spans.iter().map(|(_, span)| [span.enter.t, span.exit.t]);
                return spans.fold(NONE, around);
            }
            Self::Of(of) => of,
        };
        let mut met = of.met(spans);
        let range = |(_, (node, spans)): (usize, (&Self, _))| node.range(spans);
        match of.operation {
            Operation::Union => met.map(range).fold(NONE, around),
            Operation::Intersection => {
                let mut count = 0;
                let all = met.fold(
                    [f64::NEG_INFINITY, f64::INFINITY],
                    |[low, high], operand| {
                        count += 1;
                        let [least, most] = range(operand);
                        [low.max(least), high.min(most)]
                    },
                );
                if count == of.operands.len() {
                    all
                } else {
                    NONE
                }
            }
            Operation::Difference => {
                let first = met.next().filter(|(operand, _)| *operand == 0);
                first.map_or(NONE, range)
            }
        }
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
    pub(super) fn bounds(&self, parts: &[SolidPart]) -> Option<[DVec3; 2]> {
        match self {
            Self::Part(index) => parts[*index].around.as_ref()?.bounds(),
            Self::Of(of) => of.bounds,
        }
    }

    /// Returns [`Solid::smallest_box`](crate::tracer::shape::solid::Solid).
    pub(super) fn smallest_box(
        &self,
        parts: &[SolidPart],
        by: Option<&Arc<Transform>>,
    ) -> Option<[DVec3; 2]> {
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

    /// Returns [`Solid::is_surely_empty`](crate::tracer::shape::solid::Solid).
    pub(super) fn is_surely_empty(&self, parts: &[SolidPart]) -> bool {
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
    pub(super) fn depth(&self, parts: &[SolidPart], point: DVec3) -> f64 {
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
    pub(super) fn form(&self, parts: &[SolidPart]) -> String {
        match self {
            Self::Part(part) => format!("{} {part}", parts[*part].shape.kind()),
            Self::Of(of) => {
                let operands: Vec<_> = of.operands.iter().map(|node| node.form(parts)).collect();
                format!("{:?}({})", of.operation, operands.join(", "))
            }
        }
    }

    pub(super) fn support(&self, parts: &[SolidPart], direction: DVec3) -> Option<DVec3> {
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

    pub(super) fn farthest_from(&self, parts: &[SolidPart], point: DVec3) -> f64 {
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
    pub(super) fn each_number(&self, parts: &[SolidPart], see: &mut dyn FnMut(f64)) {
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

/// Returns the corners of a box, given by its lower and upper ones.
fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |corner| {
        let is_high = |axis: u32| corner >> axis & 1 == 1;
        DVec3::select(BVec3::new(is_high(0), is_high(1), is_high(2)), high, low)
    })
}
