//! Top-down construction of the tree, on all threads.

use std::mem;

use crate::{
    accel::{
        bvh::{
            node::{Leaf, Link, Node},
            split::{Bounds, Halves, Item, Split, Surround},
            tree::{DEPTH, Tree},
        },
        pages::Pages,
    },
    parallel::{Cancel, Pool},
    simd::{LANES, isa::Isa},
    tracer::geometry::Geometry,
};

/// Number of levels that are split by the heuristic, which does not bound the depth: enough for any
/// sane scene. Below them, runs are split in the middle, and the remaining levels hold 2³³ shapes.
const BY_COST: usize = DEPTH - 10;

/// Runs that are longer are built by several threads.
const PARALLEL: usize = 1 << 14;

/// Number of such runs for each thread. Their nodes are copied when they are done, so that more of them
/// would take more memory.
const SHARES: usize = 2;

/// Runs that are longer are not split once the building is cancelled. Tests use less.
const OFTEN: usize = if cfg!(test) { 1 << 6 } else { 1 << 12 };

/// The resources for building a tree.
#[derive(Clone, Copy)]
pub(crate) struct Builder<'a> {
    pub(crate) isa: Isa,
    pub(crate) pool: &'a Pool,
    /// What ends the building early, if anything does.
    pub(crate) cancel: Option<&'a Cancel>,
}

/// A tree that grows.
struct Sketch<L> {
    nodes: Vec<Node>,
    leaves: L,
    /// The length up to which a run is built by one thread.
    alone: usize,
}

/// The leaves of a tree.
pub(crate) trait Leaves: Send + Sync {
    /// Returns those of a part of the tree, as yet none.
    fn none(&self) -> Self;

    /// Adds a leaf with some items, at most eight, and returns the link to it.
    fn add(&mut self, items: &[Item]) -> Link;

    /// Returns the number of leaves that other ones move up by if they are appended.
    fn len(&self) -> usize;

    /// Appends other leaves.
    fn append(&mut self, other: Self);
}

/// Leaves that are lists of shapes, by their indices in the world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists(Vec<[u32; LANES]>);

impl Lists {
    /// Returns the indices in a list.
    #[inline(always)]
    pub(crate) fn of(&self, list: usize) -> impl Iterator<Item = u32> + use<> {
        self.0[list].into_iter().filter(|index| *index != NOBODY)
    }

    /// Returns the place of a list in memory.
    #[inline(always)]
    pub(crate) fn place(&self, list: usize) -> &[u32; LANES] {
        &self.0[list]
    }
}

impl Leaves for Lists {
    fn none(&self) -> Self {
        Self::default()
    }

    fn add(&mut self, items: &[Item]) -> Link {
        let index = |lane| items.get(lane).map_or(NOBODY, Item::index);
        self.0.push(std::array::from_fn(index));
        Link::leaf(self.0.len() - 1)
    }

    fn len(&self) -> usize {
        self.0.len()
    }

    fn append(&mut self, other: Self) {
        self.0.extend(other.0);
    }
}

/// The index of an empty lane.
const NOBODY: u32 = u32::MAX;

/// Number of leaves that a thread fills at once.
const TOGETHER: usize = 1 << 10;

/// A part of a node: its items and their bounding box.
type NodePart<'a> = (&'a mut [Item], Bounds);

impl<'a> Builder<'a> {
    /// Creates the resources of a building that nothing ends early.
    pub(crate) const fn new(pool: &'a Pool, isa: Isa) -> Self {
        Self {
            isa,
            pool,
            cancel: None,
        }
    }
}

impl Builder<'_> {
    /// Returns true once the building is cancelled.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(Cancel::is_cancelled)
    }

    /// Builds a tree over items, at least one; `None` if it is cancelled. Their memory is free before the
    /// nodes are moved.
    pub(crate) fn tree<L: Leaves>(&self, mut items: Pages<Item>, leaves: L) -> Option<(Tree, L)> {
        let alone = match self.pool.threads() {
            1 => usize::MAX,
            threads => PARALLEL.max(items.len() / (SHARES * threads)),
        };
        let mut sketch = Sketch::new(&items, alone, leaves);
        let root = self.place(items.as_mut(), 0, &mut sketch);
        drop(items);
        if self.is_cancelled() {
            return None;
        }
        let Sketch { nodes, leaves, .. } = sketch;
        let nodes = nodes.into();
        Some((Tree { nodes, root }, leaves))
    }

    /// Copies the shapes of lists to leaves.
    pub(super) fn leaves(&self, lists: &Lists, geometries: &[Geometry]) -> Vec<Leaf> {
        let mut leaves = vec![Leaf::EMPTY; lists.0.len()];
        let portions = leaves.chunks_mut(TOGETHER).zip(lists.0.chunks(TOGETHER));
        self.pool.map(portions, |(leaves, lists)| {
            for (leaf, list) in leaves.iter_mut().zip(lists) {
                fill(leaf, list, geometries);
            }
        });
        leaves
    }

    /// Adds items to the tree at this level, counted from the root.
    fn place<L: Leaves>(&self, items: &mut [Item], level: usize, tree: &mut Sketch<L>) -> Link {
        if items.len() <= LANES {
            return tree.leaves.add(items);
        }
        if items.len() > OFTEN && self.is_cancelled() {
            // The tree is dropped.
            return tree.leaves.add(&[]);
        }
        let together = items.len() > tree.alone;
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
            let (alone, leaves) = (tree.alone, &tree.leaves);
            let grown = self.pool.map(parts, |(items, _)| {
                let mut part = Sketch::new(items, alone, leaves.none());
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

    /// Splits items into the parts of a node: the part that costs rays most is always split next.
    fn parts<'a>(&self, items: &'a mut [Item], level: usize) -> Vec<NodePart<'a>> {
        let (by_cost, is_long) = (level < BY_COST, items.len() > OFTEN);
        let mut parts = Vec::with_capacity(LANES);
        let bounds = self.isa.run(Surround(items));
        parts.push((items, bounds));
        while parts.len() < LANES && !(is_long && self.is_cancelled()) {
            let weight = |(items, bounds): &NodePart<'_>| match items.len() {
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

impl<L: Leaves> Sketch<L> {
    /// Creates an empty tree. It has room for as many nodes as items need as a rule: a vector of nodes
    /// that grows is copied, for they are aligned to lines of the cache, and what it does not use takes
    /// no memory.
    fn new(items: &[Item], alone: usize, leaves: L) -> Self {
        Self {
            nodes: Vec::with_capacity(items.len() / (3 * LANES)),
            leaves,
            alone,
        }
    }

    /// Appends another sketch; returns the new link to its root.
    fn append(&mut self, root: Link, other: Self) -> Link {
        let (nodes, leaves) = (self.nodes.len(), self.leaves.len());
        let moved = |mut node: Node| {
            node.links = node.links.map(|link| link.moved(nodes, leaves));
            node
        };
        self.nodes.extend(other.nodes.into_iter().map(moved));
        self.leaves.append(other.leaves);
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
