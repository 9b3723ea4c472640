//! Shapes that move as one, and the farthest of them in a direction.
//!
//! A tree of boxes finds it without a look at most shapes. The boxes are around the shapes before
//! they move, so one tree serves every frame.

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    shape::{Shape, placed::Placer},
    transform::Transform,
};

/// The largest number of shapes in a node without others under it.
const FEW: usize = 4;

/// The relative error of a bound, in units of the largest coordinates.
const SLACK: f64 = 1e-12;

/// Shapes that move as one.
pub(crate) struct Rigid {
    shapes: Vec<Shape>,
    /// The places of the bounded shapes, in the order of the nodes.
    order: Vec<usize>,
    /// The tree, each node before those under it.
    nodes: Vec<Node>,
}

/// A node of the tree.
struct Node {
    around: Box3,
    /// The place in the order of the first of its shapes.
    first: usize,
    content: Content,
}

enum Content {
    /// This many shapes.
    Few(usize),
    /// The next node, and the one at this place.
    Two(usize),
}

/// The box around a shape or several.
#[derive(Clone, Copy)]
struct Box3 {
    low: DVec3,
    high: DVec3,
}

/// Where shapes that move as one are at a time.
pub(crate) struct RigidPlace {
    placer: Placer,
    /// The product of the transforms, if there are some.
    product: Option<Transform>,
}

/// The farthest shape so far.
pub(crate) struct Farthest {
    /// The distance that counts as reached already, or that of the shape.
    pub(crate) far: f64,
    /// The place of the shape and its farthest point.
    found: Option<(usize, DVec3)>,
    pub(crate) is_finite: bool,
}

impl Farthest {
    /// Starts a search for what is farther than this.
    pub(crate) const fn than(far: f64) -> Self {
        Self {
            far,
            found: None,
            is_finite: true,
        }
    }

    /// Returns the farthest point.
    pub(crate) fn point(&self) -> Option<DVec3> {
        self.found.map(|(_, point)| point)
    }
}

impl RigidPlace {
    /// Creates a place from transforms, from outermost to innermost; `None` if a product of them
    /// cannot be inverted.
    pub(crate) fn new(levels: &[Arc<Transform>]) -> Option<Self> {
        let mut inner = levels.iter().rev();
        let product = match inner.next() {
            Some(last) => Some(inner.try_fold(**last, |inner, outer| outer.times(&inner).ok())?),
            None => None,
        };
        Some(Self {
            placer: Placer::new(levels),
            product,
        })
    }
}

impl Rigid {
    /// Creates the tree of some shapes. Once `is_cancelled`, it is of no use.
    pub(crate) fn new(shapes: Vec<Shape>, is_cancelled: &impl Fn() -> bool) -> Self {
        let mut rigid = Self {
            shapes,
            order: Vec::new(),
            nodes: Vec::new(),
        };
        let all = rigid.shapes.iter().enumerate();
        let all = all.take_while(|_| !is_cancelled());
        let mut boxes: Vec<_> = all
            .filter_map(|(place, shape)| Some((place, Box3::around(shape)?)))
            .collect();
        if !boxes.is_empty() {
            rigid.add_node(&mut boxes, is_cancelled);
        }
        rigid
    }

    fn add_node(&mut self, boxes: &mut [(usize, Box3)], is_cancelled: &impl Fn() -> bool) {
        let around = Box3::union(boxes.iter().map(|(_, each)| *each));
        let at = self.nodes.len();
        self.nodes.push(Node {
            around,
            first: self.order.len(),
            content: Content::Few(boxes.len()),
        });
        if boxes.len() <= FEW || is_cancelled() {
            self.order.extend(boxes.iter().map(|(place, _)| *place));
            return;
        }
        let sides = (around.high - around.low).to_array();
        let axis = (1..3).fold(0, |most, axis| match sides[axis] > sides[most] {
            true => axis,
            false => most,
        });
        let middle = |each: &Box3| each.low[axis] + each.high[axis];
        let half = boxes.len() / 2;
        boxes.select_nth_unstable_by(half, |(_, one), (_, other)| {
            middle(one).total_cmp(&middle(other))
        });
        let (one, other) = boxes.split_at_mut(half);
        self.add_node(one, is_cancelled);
        let second = self.nodes.len();
        self.add_node(other, is_cancelled);
        self.nodes[at].content = Content::Two(second);
    }

    /// Searches for the shape that is farthest in a direction of unit length, the first of equal
    /// ones. `see` returns the point that a point of a shape is seen at, and its distance, which is
    /// `beyond` more than that of the point itself, up to an error.
    pub(crate) fn search(
        &self,
        place: &mut RigidPlace,
        direction: DVec3,
        (beyond, error): (f64, f64),
        see: impl Fn(DVec3) -> (f64, DVec3),
        farthest: &mut Farthest,
    ) {
        let Some(root) = self.nodes.first() else {
            return;
        };
        let most = root.around.low.abs().max(root.around.high.abs());
        let sides = direction.abs();
        let (along, beyond, size) = match &place.product {
            None => (direction, beyond, most.dot(sides)),
            Some(product) => {
                let [x, y, z] = product.rows().map(|[x, y, z, _]| DVec3::new(x, y, z));
                let along = x * direction.x + y * direction.y + z * direction.z;
                let shift = product.point(DVec3::ZERO);
                let reach = [x, y, z].map(|row| row.abs().dot(most));
                let size = (DVec3::from(reach) + shift.abs()).dot(sides);
                (along, beyond + shift.dot(direction), size)
            }
        };
        let beyond = beyond + SLACK * size + error;
        let reach = |node: &Node| node.around.reach(along) + beyond;
        let mut ahead = vec![(reach(root), 0)];
        while let Some((most, at)) = ahead.pop() {
            // A bound that is not a number excludes nothing.
            if most < farthest.far {
                continue;
            }
            let node = &self.nodes[at];
            match node.content {
                Content::Two(second) => {
                    let [one, other] = [at + 1, second].map(|at| (reach(&self.nodes[at]), at));
                    // The farther one is next.
                    let is_less = one.0 < other.0;
                    ahead.extend(if is_less { [one, other] } else { [other, one] });
                }
                Content::Few(count) => {
                    for index in &self.order[node.first..node.first + count] {
                        let shape = place.placer.place(self.shapes[*index].clone());
                        let Some(p) = shape.ok().and_then(|shape| shape.support(direction)) else {
                            continue;
                        };
                        let (far, point) = see(p);
                        farthest.is_finite &= far.is_finite();
                        let is_first = farthest.found.is_some_and(|(known, _)| *index < known);
                        if far > farthest.far || (far == farthest.far && is_first) {
                            farthest.far = far;
                            farthest.found = Some((*index, point));
                        }
                    }
                }
            }
        }
    }
}

impl Box3 {
    /// Returns the box of the farthest points of a shape; `None` if it is unbounded.
    fn around(shape: &Shape) -> Option<Self> {
        let mut sides = [DVec3::ZERO; 2];
        for axis in 0..3 {
            let along = [DVec3::X, DVec3::Y, DVec3::Z][axis];
            sides[0][axis] = shape.support(-along)?[axis];
            sides[1][axis] = shape.support(along)?[axis];
        }
        let [low, high] = sides;
        Some(match low.is_finite() && high.is_finite() {
            true => Self { low, high },
            false => Self {
                low: DVec3::NEG_INFINITY,
                high: DVec3::INFINITY,
            },
        })
    }

    fn union(boxes: impl Iterator<Item = Self>) -> Self {
        let none = Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        };
        boxes.fold(none, |one, other| Self {
            low: one.low.min(other.low),
            high: one.high.max(other.high),
        })
    }

    /// Returns the largest `p·n` of its points.
    fn reach(&self, n: DVec3) -> f64 {
        (self.low * n).max(self.high * n).element_sum()
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::tracer::{
        camera::fit::{Extremes, Turntable},
        random::{Rng, cases},
        shape::{any::any, plane::Plane, sphere::Sphere},
        vector::unit,
    };
    use glam::DMat3;

    fn transform(rng: &mut Rng) -> Arc<Transform> {
        let turn = (rng.vector() + DVec3::splat(1e-3), 7.0 * rng.signed());
        let scale = match rng.below(2) {
            0 => DVec3::ONE,
            _ => DVec3::ONE + rng.vector().abs(),
        };
        let shift = rng.vector() * rng.one(&[0.0, 1.0, 100.0]);
        Arc::new(Transform::new(shift, Some(turn), scale).unwrap())
    }

    /// Returns shapes of any kind, some of them twice, some in lines, and a plane.
    fn shapes(rng: &mut Rng) -> Vec<Shape> {
        let plane = Plane::new(rng.vector(), DVec3::Y).unwrap();
        let mut all: Vec<Shape> = vec![plane.into()];
        for _ in 0..rng.below(60) {
            let center = rng.vector() * rng.one(&[DVec3::ONE, DVec3::X, DVec3::ZERO]);
            let shape = match rng.below(3) {
                0 => all[rng.below(all.len())].clone(),
                1 => Sphere::new(center * 9.0, 0.5).unwrap().into(),
                _ => any(rng, center * 9.0, 0.3).unwrap(),
            };
            all.push(shape);
        }
        all
    }

    #[test]
    fn the_farthest_is_that_of_all_bit_for_bit() {
        let mut rng = Rng(0x716d);
        for _ in 0..cases(1_000) {
            let shapes = shapes(&mut rng);
            let rigid = Rigid::new(shapes.clone(), &|| false);
            let directions: Vec<_> = (0..6)
                .map(|_| match rng.below(4) {
                    0 => rng.one(&[DVec3::X, DVec3::Y, DVec3::NEG_Z]),
                    _ => unit(rng.vector() + DVec3::splat(1e-3)),
                })
                .collect();
            let table = Turntable {
                around: rng.vector(),
                axis: DVec3::Y,
                turns: vec![DMat3::from_axis_angle(DVec3::Y, rng.signed()); 2],
            };
            let turned = (rng.below(3) == 0).then_some((&table, 1));
            let (mut one, mut all) = (Extremes::new(&directions), Extremes::new(&directions));
            for _ in 0..1 + rng.below(3) {
                let levels: Vec<_> = (0..rng.below(4)).map(|_| transform(&mut rng)).collect();
                one.add_rigid(&rigid, &mut RigidPlace::new(&levels).unwrap(), turned);
                let mut placer = Placer::new(&levels);
                for shape in &shapes {
                    let Ok(shape) = placer.place(shape.clone()) else {
                        continue;
                    };
                    match turned {
                        None => all.add(&shape),
                        Some((table, at)) => all.add_turned(&shape, table, at..at + 1),
                    }
                }
            }
            assert_eq!(one.found(), all.found());
        }
    }

    #[test]
    fn few_shapes_are_looked_at() {
        let mut rng = Rng(0x716e);
        let shell: Vec<Shape> = (0..10_000)
            .map(|_| Sphere::new(unit(rng.vector()), 1e-3).unwrap().into())
            .collect();
        let rigid = Rigid::new(shell, &|| false);
        let looks = Cell::new(0);
        for _ in 0..100 {
            let mut place = RigidPlace::new(&[transform(&mut rng)]).unwrap();
            let n = unit(rng.vector());
            let see = |p: DVec3| {
                looks.set(looks.get() + 1);
                (p.dot(n), p)
            };
            let mut farthest = Farthest::than(f64::NEG_INFINITY);
            rigid.search(&mut place, n, (0.0, 0.0), see, &mut farthest);
            assert!(farthest.point().is_some());
        }
        assert!(looks.get() < 100 * 150, "{}", looks.get());
    }

    #[test]
    fn numbers_that_are_too_large_are_told() {
        let large = Sphere::new(DVec3::splat(1e308), 1e308).unwrap();
        let small = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let rigid = Rigid::new(vec![small.into(), large.into()], &|| false);
        let mut extremes = Extremes::new(&[unit(DVec3::ONE)]);
        extremes.add_rigid(&rigid, &mut RigidPlace::new(&[]).unwrap(), None);
        assert!(!extremes.found().0);
        let none = Rigid::new(Vec::new(), &|| false);
        let mut extremes = Extremes::new(&[DVec3::X]);
        extremes.add_rigid(&none, &mut RigidPlace::new(&[]).unwrap(), None);
        assert_eq!(extremes.found().1[0].0, f64::NEG_INFINITY);
    }
}
