//! A tree of nodes, whose leaves are elsewhere.

use crate::{
    accel::{
        bvh::node::{Link, LinkTarget, Node},
        pages::Pages,
    },
    simd::LANES,
};

/// The largest number of nodes between the root and a leaf.
pub(super) const DEPTH: usize = 28;

/// A tree of nodes, whose leaves are elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) nodes: Pages<Node>,
    pub(super) root: Link,
}

impl Tree {
    /// Calls `see` with the number of every leaf that may meet a box.
    pub(crate) fn each_near(&self, [center, half]: [[f32; 3]; 2], mut see: impl FnMut(usize)) {
        let is_near = |node: &Node, lane: usize| {
            (0..3).all(|axis| {
                node.planes[axis][lane] <= center[axis] + half[axis]
                    && node.planes[axis + 3][lane] >= center[axis] - half[axis]
            })
        };
        let mut links = vec![self.root];
        while let Some(link) = links.pop() {
            match link.place() {
                LinkTarget::Node(number) => {
                    let node = &self.nodes[number];
                    let lanes = (0..LANES).filter(|lane| is_near(node, *lane));
                    links.extend(lanes.map(|lane| node.links[lane]));
                }
                LinkTarget::Leaf(number) => see(number),
            }
        }
    }
}
