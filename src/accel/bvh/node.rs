//! The parts of the tree, in a layout for eight lanes.

use glam::DVec3;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use crate::{simd::LANES, tracer::shape::sphere::Sphere};

/// Up to eight boxes and the links to their contents.
#[derive(Clone, Debug, FromBytes, Immutable, IntoBytes, KnownLayout)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// The lower planes of the boxes along x, y, z, then the upper ones.
    pub(super) planes: [[f32; LANES]; 6],
    pub(super) links: [Link; LANES],
    /// To the end of a line of the cache.
    rest: [u32; LANES],
}

/// Up to eight shapes: copies of the spheres, and the indices of all.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    pub(super) center: [[f64; LANES]; 3],
    pub(super) radius: [f64; LANES],
    /// The indices of the shapes in the world.
    pub(super) index: [u32; LANES],
    /// Bit i is set if lane i is not a sphere.
    pub(super) others: u8,
    /// Bit i is set if lane i is of glass.
    pub(super) glass: u8,
}

/// A link to a node or a leaf.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, IntoBytes, KnownLayout, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Link(pub(super) u32);

/// The target of a [`Link`], by its index.
pub(super) enum LinkTarget {
    Node(usize),
    Leaf(usize),
}

impl Node {
    /// A node without boxes: no ray meets its planes.
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
        rest: [0; LANES],
    };
}

impl Leaf {
    /// A leaf without shapes. The discriminant of a NaN center is NaN, so that no ray hits it.
    pub(super) const EMPTY: Self = Self {
        center: [[f64::NAN; LANES]; 3],
        radius: [0.0; LANES],
        index: [0; LANES],
        others: 0,
        glass: 0,
    };

    /// Returns the sphere in a lane, if there is one.
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

    pub(crate) const fn leaf(number: usize) -> Self {
        Self(number as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub(super) const fn place(self) -> LinkTarget {
        if self.0 & Self::LEAF == 0 {
            LinkTarget::Node(self.0 as usize)
        } else {
            LinkTarget::Leaf((self.0 & !Self::LEAF) as usize)
        }
    }

    /// Returns the link after its tree has been appended to this many nodes and leaves.
    pub(super) const fn moved(self, nodes: usize, leaves: usize) -> Self {
        match self.place() {
            LinkTarget::Node(number) => Self::node(number + nodes),
            LinkTarget::Leaf(number) => Self::leaf(number + leaves),
        }
    }
}
