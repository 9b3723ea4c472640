//! Top-down construction of the tree, on all threads.

use std::mem;

use crate::{
    accel::bvh::{
        DEPTH, Tree,
        node::{Leaf, Link, Node},
        split::{Bounds, Halves, Item, Split, Surround},
    },
    parallel::Pool,
    simd::{Isa, LANES},
    tracer::geometry::Geometry,
};

/// Number of levels that are split by the heuristic, which does not bound the depth: enough for any
/// sane scene. Below them, runs are split in the middle, and the remaining levels hold 2³³ shapes.
const BY_COST: usize = DEPTH - 10;

/// Longer runs are built by several threads.
const PARALLEL: usize = 1 << 14;

/// The resources for building a tree.
#[derive(Clone, Copy)]
pub(super) struct Builder<'a> {
    pub(super) isa: Isa,
    pub(super) pool: &'a Pool,
}

/// A tree whose leaves are lists of shapes.
#[derive(Default)]
struct Sketch {
    nodes: Vec<Node>,
    /// The indices of the shapes in the world.
    leaves: Vec<[u32; LANES]>,
}

/// The index of an empty lane.
const NOBODY: u32 = u32::MAX;

/// Number of leaves that a thread fills at once.
const TOGETHER: usize = 1 << 10;

/// A part of a node: its shapes and their bounding box.
type Part<'a> = (&'a mut [Item], Bounds);

impl Builder<'_> {
    /// Builds a tree over shapes, at least one; their indices refer to `geometries`.
    pub(super) fn tree(&self, items: &mut [Item], geometries: &[Geometry]) -> Tree {
        let mut sketch = Sketch::default();
        let root = self.place(items, 0, &mut sketch);
        let Sketch {
            mut nodes,
            leaves: lists,
        } = sketch;
        nodes.shrink_to_fit();
        let mut leaves = vec![Leaf::EMPTY; lists.len()];
        let portions = leaves.chunks_mut(TOGETHER).zip(lists.chunks(TOGETHER));
        self.pool.map(portions, |(leaves, lists)| {
            for (leaf, list) in leaves.iter_mut().zip(lists) {
                fill(leaf, list, geometries);
            }
        });
        Tree {
            nodes,
            leaves,
            root,
        }
    }

    /// Adds shapes to the tree at this level, counted from the root.
    fn place(&self, items: &mut [Item], level: usize, tree: &mut Sketch) -> Link {
        if items.len() <= LANES {
            let index = |lane| items.get(lane).map_or(NOBODY, Item::index);
            tree.leaves.push(std::array::from_fn(index));
            return Link::leaf(tree.leaves.len() - 1);
        }
        let together = items.len() > PARALLEL;
        let parts = self.parts(items, level);
        let mut node = Node::EMPTY;
        for (lane, (_, bounds)) in parts.iter().enumerate() {
            for (axis, (low, high)) in bounds.low().into_iter().zip(bounds.high()).enumerate() {
                node.planes[axis][lane] = low;
                node.planes[axis + 3][lane] = high;
            }
        }
        let number = tree.nodes.len();
        tree.nodes.push(node);
        let links: Vec<Link> = if together {
            let grown = self.pool.map(parts, |(items, _)| {
                let mut part = Sketch::default();
                (self.place(items, level + 1, &mut part), part)
            });
            let grown = grown.into_iter();
            grown.map(|(root, part)| tree.append(root, part)).collect()
        } else {
            let parts = parts.into_iter();
            parts
                .map(|(items, _)| self.place(items, level + 1, tree))
                .collect()
        };
        for (to, link) in tree.nodes[number].links.iter_mut().zip(links) {
            *to = link;
        }
        Link::node(number)
    }

    /// Splits shapes into the parts of a node: the part that costs rays most is always split next.
    fn parts<'a>(&self, items: &'a mut [Item], level: usize) -> Vec<Part<'a>> {
        let by_cost = level < BY_COST;
        let mut parts = Vec::with_capacity(LANES);
        let bounds = self.isa.run(Surround(items));
        parts.push((items, bounds));
        while parts.len() < LANES {
            let weight = |(items, bounds): &Part<'_>| match items.len() {
                0..=LANES => -1.0,
                _ if by_cost => bounds.half_area(),
                count => count as f32,
            };
            let mut heaviest = 0;
            for at in 1..parts.len() {
                if weight(&parts[at]) > weight(&parts[heaviest]) {
                    heaviest = at;
                }
            }
            let part = &mut parts[heaviest];
            if part.0.len() <= LANES {
                break;
            }
            let items = mem::take(&mut part.0);
            let halves = by_cost.then(|| self.isa.run(Split(items))).flatten();
            let halves = halves.unwrap_or_else(|| self.middle(items));
            let (first, rest) = items.split_at_mut(halves.middle);
            *part = (first, halves.bounds[0]);
            parts.push((rest, halves.bounds[1]));
        }
        parts
    }

    /// Splits items in the middle, in their present order.
    fn middle(&self, items: &[Item]) -> Halves {
        let middle = items.len() / 2;
        let (first, rest) = items.split_at(middle);
        Halves {
            middle,
            bounds: [first, rest].map(|half| self.isa.run(Surround(half))),
        }
    }
}

impl Sketch {
    /// Appends another sketch; returns the new link to its root.
    fn append(&mut self, root: Link, other: Self) -> Link {
        let (nodes, leaves) = (self.nodes.len(), self.leaves.len());
        let moved = |mut node: Node| {
            node.links = node.links.map(|link| link.moved(nodes, leaves));
            node
        };
        self.nodes.extend(other.nodes.into_iter().map(moved));
        self.leaves.extend(other.leaves);
        root.moved(nodes, leaves)
    }
}

/// Copies the shapes of a list to a leaf.
fn fill(leaf: &mut Leaf, list: &[u32; LANES], geometries: &[Geometry]) {
    for (lane, index) in list.iter().enumerate() {
        let Some(geometry) = geometries.get(*index as usize) else {
            continue;
        };
        leaf.index[lane] = *index;
        leaf.glass |= u8::from(geometry.has_glass()) << lane;
        match geometry.shape().sphere() {
            Some(sphere) => {
                for (axis, x) in sphere.center().to_array().into_iter().enumerate() {
                    leaf.center[axis][lane] = x;
                }
                leaf.radius[lane] = sphere.radius();
            }
            None => leaf.others |= 1 << lane,
        }
    }
}
