//! Traversal of a tree by one ray, eight boxes at a time, in f32, which only excludes misses (see
//! `frame.rs`).

use crate::{
    accel::bvh::{
        Tree,
        frame::{Beam, Probe},
        node::{Link, Node, Place},
    },
    simd::{F32x8, LANES, Simd},
};

/// Number of links on the stack before it needs memory of its own: few, because each ray begins with a
/// new stack. Tests use less.
const FEW: usize = if cfg!(test) { 2 * LANES } else { 6 * LANES };

/// A search in the leaves of a tree along a ray.
pub(crate) trait Seek<S: Simd> {
    /// True if the first thing found ends the search.
    const ANY: bool;

    /// Returns the `t` at which the ray ends.
    fn end(&self) -> f64;

    /// Tests the contents of a leaf; returns true if something is found, so that the ray may end
    /// sooner.
    fn visit(&mut self, simd: S, leaf: usize) -> bool;

    /// Prefetches a leaf: a ray mostly waits for memory.
    fn prefetch(&self, simd: S, leaf: usize);
}

/// What is traced through the boxes of a tree: a ray, or several at once.
pub(crate) trait Rays<S: Simd> {
    /// Returns the distance of `t`, or slightly more.
    fn distance(&self, t: f64) -> f32;

    /// Returns the boxes that are met before `farthest`, and the distances at which they are entered.
    fn boxes(&self, simd: S, node: &Node, farthest: f32) -> (u8, [f32; LANES]);
}

impl Tree {
    /// Visits the leaves that rays may meet before their end, the nearest first.
    #[inline(always)]
    pub(crate) fn traverse<S: Simd, R: Rays<S>, K: Seek<S>>(
        &self,
        simd: S,
        rays: &R,
        seek: &mut K,
    ) {
        let mut stack = Stack {
            links: [Later(0); FEW],
            below: Vec::new(),
        };
        let mut len = 0;
        let nodes = &*self.nodes;
        // The end of the rays.
        let mut farthest = rays.distance(seek.end());
        let mut link = self.root;
        loop {
            match link.place() {
                Place::Node(number) => {
                    let node = &nodes[number];
                    let (met, enter) = rays.boxes(simd, node, farthest);
                    if met != 0 {
                        let met = (met, &enter);
                        (link, len) = stack.push_all_but_nearest(simd, nodes, seek, node, met, len);
                        continue;
                    }
                }
                Place::Leaf(number) => {
                    if seek.visit(simd, number) {
                        if K::ANY {
                            return;
                        }
                        farthest = rays.distance(seek.end());
                    }
                }
            }
            match stack.pop(len, farthest) {
                Some(next) => (link, len) = next,
                None => return,
            }
        }
    }
}

#[inline(always)]
fn prefetch<S: Simd>(simd: S, nodes: &[Node], seek: &impl Seek<S>, link: Link) {
    match link.place() {
        Place::Node(number) => simd.prefetch(&nodes[number]),
        Place::Leaf(number) => seek.prefetch(simd, number),
    }
}

/// The links still to be visited. Their number is kept apart, in a register.
struct Stack {
    links: [Later; FEW],
    /// Those below, if there are many.
    below: Vec<Later>,
}

impl Stack {
    /// Returns the nearest child that the ray meets, and pushes the others in order, the farthest
    /// lowest; returns the number of links too. `met` has at least one lane.
    #[inline(always)]
    fn push_all_but_nearest<S: Simd>(
        &mut self,
        simd: S,
        nodes: &[Node],
        seek: &impl Seek<S>,
        node: &Node,
        (mut met, enter): (u8, &[f32; LANES]),
        mut len: usize,
    ) -> (Link, usize) {
        let lane = met.trailing_zeros() as usize;
        met &= met - 1;
        if met == 0 {
            return (node.links[lane], len);
        }
        if len > FEW - LANES {
            move_below(&mut self.below, &self.links[..len]);
            len = 0;
        }
        let mut next = Later::new(enter[lane], node.links[lane]);
        prefetch(simd, nodes, seek, node.links[lane]);
        let first = len;
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            let mut other = Later::new(enter[lane], node.links[lane]);
            prefetch(simd, nodes, seek, node.links[lane]);
            if other < next {
                (next, other) = (other, next);
            }
            let mut place = len;
            while place > first && self.links[place - 1] < other {
                self.links[place] = self.links[place - 1];
                place -= 1;
            }
            self.links[place] = other;
            len += 1;
        }
        (next.link(), len)
    }

    /// Removes the topmost link that is not beyond `farthest`, and all above it; returns the number of
    /// the others too.
    #[inline(always)]
    fn pop(&mut self, mut len: usize, farthest: f32) -> Option<(Link, usize)> {
        while len > 0 {
            len -= 1;
            let later = self.links[len];
            if later.distance() <= farthest {
                return Some((later.link(), len));
            }
        }
        while let Some(later) = self.below.pop() {
            if later.distance() <= farthest {
                return Some((later.link(), 0));
            }
        }
        None
    }
}

/// Moves links to those below.
#[cold]
#[inline(never)]
fn move_below(below: &mut Vec<Later>, links: &[Later]) {
    below.extend_from_slice(links);
}

/// A link and its distance, ordered by the distance: the bits of a float that is not negative
/// compare as the float does.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Later(u64);

impl Later {
    #[inline(always)]
    fn new(distance: f32, link: Link) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | u64::from(link.0))
    }

    #[inline(always)]
    fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn link(self) -> Link {
        Link(self.0 as u32)
    }
}

/// The planes of a node that a ray meets first, for each axis, and those opposite to them.
#[derive(Clone, Copy)]
struct Order {
    first: [usize; 3],
    last: [usize; 3],
}

impl Order {
    #[inline(always)]
    fn new(inverse: &[f32; 3]) -> Self {
        let [x, y, z] = inverse.map(|inverse| usize::from(inverse < 0.0) * 3);
        Self {
            first: [x, 1 + y, 2 + z],
            last: [3 - x, 4 - y, 5 - z],
        }
    }
}

/// A probe, each number in all lanes.
pub(crate) struct OneRay<'a, S: Simd> {
    probe: &'a Probe,
    inverse: [S::F32; 3],
    /// The distances of the origin that is moved forwards or backwards.
    entering: [S::F32; 3],
    leaving: [S::F32; 3],
    order: Order,
}

impl<'a, S: Simd> OneRay<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, probe: &'a Probe) -> Self {
        let inverse = splat(simd, &probe.inverse);
        let [entering, leaving] = [splat(simd, &probe.entering), splat(simd, &probe.leaving)];
        Self {
            probe,
            inverse,
            entering: products::<S>(entering, inverse),
            leaving: products::<S>(leaving, inverse),
            order: Order::new(&probe.inverse),
        }
    }

    /// Returns the distances of planes along the axes.
    #[inline(always)]
    fn distances(
        &self,
        simd: S,
        node: &Node,
        [x, y, z]: [usize; 3],
        from: &[S::F32; 3],
    ) -> [S::F32; 3] {
        let (planes, inverse) = (&node.planes, &self.inverse);
        [
            simd.load_f32(&planes[x]).times_less(inverse[0], from[0]),
            simd.load_f32(&planes[y]).times_less(inverse[1], from[1]),
            simd.load_f32(&planes[z]).times_less(inverse[2], from[2]),
        ]
    }
}

impl<S: Simd> Rays<S> for OneRay<'_, S> {
    #[inline(always)]
    fn distance(&self, t: f64) -> f32 {
        self.probe.distance(t)
    }

    #[inline(always)]
    fn boxes(&self, simd: S, node: &Node, farthest: f32) -> (u8, [f32; LANES]) {
        let [x, y, z] = self.distances(simd, node, self.order.first, &self.entering);
        let enter = x.max(y).max(z.max(simd.splat_f32(0.0)));
        let [x, y, z] = self.distances(simd, node, self.order.last, &self.leaving);
        let leave = x.min(y).min(z.min(simd.splat_f32(farthest)));
        let mut at = [0.0; LANES];
        enter.store(&mut at);
        (enter.le(leave), at)
    }
}

/// A beam, each number in all lanes.
pub(crate) struct Together<'a, S: Simd> {
    beam: &'a Beam,
    inverse: [[S::F32; 3]; 2],
    entering: [S::F32; 3],
    leaving: [S::F32; 3],
    order: Order,
}

impl<'a, S: Simd> Together<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, beam: &'a Beam) -> Self {
        let [one, other] = &beam.inverse;
        Self {
            beam,
            inverse: [splat(simd, one), splat(simd, other)],
            entering: splat(simd, &beam.entering),
            leaving: splat(simd, &beam.leaving),
            order: Order::new(one),
        }
    }
}

impl<S: Simd> Rays<S> for Together<'_, S> {
    #[inline(always)]
    fn distance(&self, t: f64) -> f32 {
        self.beam.distance(t)
    }

    /// A product with any number between two others lies between those with the two, also if all are
    /// rounded. So a box that a ray of the beam meets is met.
    #[inline(always)]
    fn boxes(&self, simd: S, node: &Node, farthest: f32) -> (u8, [f32; LANES]) {
        let mut enter = simd.splat_f32(self.beam.nearest);
        let mut leave = simd.splat_f32(farthest);
        let [one, other] = &self.inverse;
        for axis in 0..3 {
            let first = simd.load_f32(&node.planes[self.order.first[axis]]) - self.entering[axis];
            let last = simd.load_f32(&node.planes[self.order.last[axis]]) - self.leaving[axis];
            enter = (first * one[axis]).min(first * other[axis]).max(enter);
            leave = (last * one[axis]).max(last * other[axis]).min(leave);
        }
        let mut at = [0.0; LANES];
        enter.store(&mut at);
        (enter.le(leave), at)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, numbers: &[f32; 3]) -> [S::F32; 3] {
    [
        simd.splat_f32(numbers[0]),
        simd.splat_f32(numbers[1]),
        simd.splat_f32(numbers[2]),
    ]
}

#[inline(always)]
fn products<S: Simd>(one: [S::F32; 3], other: [S::F32; 3]) -> [S::F32; 3] {
    [one[0] * other[0], one[1] * other[1], one[2] * other[2]]
}
