//! The parts of the tree, laid out for eight lanes.

use glam::DVec3;

use crate::{simd::LANES, tracer::shape::sphere::Sphere};

/// Up to eight boxes with what is in them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// The lower planes of the boxes along x, y, z, then the upper ones.
    pub(super) planes: [[f32; LANES]; 6],
    pub(super) links: [Link; LANES],
}

/// Up to eight shapes: spheres as they are in the world, and where the others stand.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    pub(super) center: [[f64; LANES]; 3],
    pub(super) radius: [f64; LANES],
    /// Where the shapes stand in the world.
    pub(super) index: [u32; LANES],
    /// Lane i is no sphere if bit i is set.
    pub(super) others: u8,
}

/// A place in the tree: a node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link(pub(super) u32);

/// What a [`Link`] leads to, with its number.
pub(super) enum Place {
    Node(usize),
    Leaf(usize),
}

impl Node {
    /// No ray meets the boxes of places that are not filled.
    pub(super) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; LANES],
            [f32::INFINITY; LANES],
            [f32::INFINITY; LANES],
            [f32::NEG_INFINITY; LANES],
            [f32::NEG_INFINITY; LANES],
            [f32::NEG_INFINITY; LANES],
        ],
        links: [Link(0); LANES],
    };
}

impl Leaf {
    /// No discriminant that comes of NaN is 0 or more: no ray meets places without a sphere.
    pub(super) const EMPTY: Self = Self {
        center: [[f64::NAN; LANES]; 3],
        radius: [0.0; LANES],
        index: [0; LANES],
        others: 0,
    };

    /// The sphere in a lane, if it is one.
    pub(super) fn sphere(&self, lane: usize) -> Option<Sphere> {
        let [x, y, z] = self.center.map(|lanes| lanes.get(lane).copied());
        Sphere::new(DVec3::new(x?, y?, z?), *self.radius.get(lane)?).ok()
    }
}

impl Link {
    const LEAF: u32 = 1 << 31;

    pub(super) const fn node(number: usize) -> Self {
        Self(number as u32)
    }

    pub(super) const fn leaf(number: usize) -> Self {
        Self(number as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub(super) const fn place(self) -> Place {
        if self.0 & Self::LEAF == 0 {
            Place::Node(self.0 as usize)
        } else {
            Place::Leaf((self.0 & !Self::LEAF) as usize)
        }
    }

    /// The link in a tree that was put behind so many nodes and leaves.
    pub(super) const fn moved(self, nodes: usize, leaves: usize) -> Self {
        match self.place() {
            Place::Node(number) => Self::node(number + nodes),
            Place::Leaf(number) => Self::leaf(number + leaves),
        }
    }
}
