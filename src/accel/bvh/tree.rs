//! A tree of nodes, whose leaves are elsewhere.

use crate::{
    accel::{
        bvh::node::{Link, LinkTarget, Node},
        lanes::bits,
        pages::Pages,
    },
    simd::{F32x8, Simd},
};

/// The number of links that need no memory of their own.
const FEW: usize = 32;

/// The largest number of nodes between the root and a leaf.
pub(super) const DEPTH: usize = 28;

/// A tree of nodes, whose leaves are elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) nodes: Pages<Node>,
    pub(super) root: Link,
}

impl Tree {
    /// Calls `see` with the number of every leaf that may meet a box, given its corners, which are finite.
    #[inline(always)]
    pub(crate) fn each_near<S: Simd>(
        &self,
        simd: S,
        corners: [[f32; 3]; 2],
        mut see: impl FnMut(usize),
    ) {
        let [low, high] =
            corners.map(|[x, y, z]| [simd.splat_f32(x), simd.splat_f32(y), simd.splat_f32(z)]);
        // Few boxes of a node hold a point.
        let (mut links, mut len, mut below) = ([self.root; FEW], 1, Vec::new());
        loop {
            let link = match len {
                0 => match below.pop() {
                    Some(link) => link,
                    None => return,
                },
                _ => {
                    len -= 1;
                    links[len]
                }
            };
            match link.place() {
                LinkTarget::Leaf(number) => see(number),
                LinkTarget::Node(number) => {
                    let node = &self.nodes[number];
                    let mut is_near = u8::MAX;
                    for axis in 0..3 {
                        is_near &= simd.load_f32(&node.planes[axis]).le(high[axis]);
                        is_near &= low[axis].le(simd.load_f32(&node.planes[axis + 3]));
                    }
                    for lane in bits(is_near) {
                        if len < FEW {
                            links[len] = node.links[lane];
                            len += 1;
                        } else {
                            below.push(node.links[lane]);
                        }
                    }
                }
            }
        }
    }
}
