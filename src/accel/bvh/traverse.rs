//! Traversal of a tree by one ray, eight boxes at a time, in f32, which only excludes misses (see
//! `frame.rs`).

use crate::{
    accel::bvh::{
        frame::{Beam, Probe, SMALLEST},
        node::{Link, LinkTarget, Node},
        tree::Tree,
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
                LinkTarget::Node(number) => {
                    let node = &nodes[number];
                    let (met, enter) = rays.boxes(simd, node, farthest);
                    if met != 0 {
                        let met = (met, &enter);
                        (link, len) = stack.push_all_but_nearest(simd, nodes, seek, node, met, len);
                        continue;
                    }
                }
                LinkTarget::Leaf(number) => {
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
        LinkTarget::Node(number) => simd.prefetch(&nodes[number]),
        LinkTarget::Leaf(number) => seek.prefetch(simd, number),
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

/// The planes of a node that a ray meets first, for each axis, and those opposite to them: the places
/// of their numbers.
#[derive(Clone, Copy)]
struct Order {
    first: [usize; 3],
    last: [usize; 3],
}

impl Order {
    /// Creates the order of a ray whose direction is negative along the axes that are bits.
    #[inline(always)]
    fn new(backwards: u8) -> Self {
        let upper = |axis: u8| usize::from(backwards >> axis & 1) * (3 * LANES);
        let (x, y, z) = (upper(0), upper(1), upper(2));
        Self {
            first: [x, LANES + y, 2 * LANES + z],
            last: [3 * LANES - x, 4 * LANES - y, 5 * LANES - z],
        }
    }
}

/// Returns the planes at a place of [`Order`].
#[inline(always)]
fn planes<S: Simd>(simd: S, node: &Node, place: usize) -> S::F32 {
    let planes = node.planes.as_flattened()[place..].first_chunk();
    simd.load_f32(planes.unwrap_or(&[0.0; LANES]))
}

/// A probe, each number in all lanes.
pub(crate) struct OneRay<'a, S: Simd> {
    probe: &'a Probe,
    /// The first number of each axis below.
    numbers: [[f32; LANES]; 3],
    /// The reciprocals of the direction.
    inverse: [S::F32; 3],
    /// The distances of the center: those of planes through it that the ray meets first, nearer by the
    /// slack.
    entering: [S::F32; 3],
    /// The same for the planes that it meets last, farther by the slack.
    leaving: [S::F32; 3],
    order: Order,
}

impl<'a, S: Simd> OneRay<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, probe: &'a Probe) -> Self {
        // Each axis in a lane.
        let direction = by_axis(simd, &probe.direction);
        let zero = simd.splat_f32(0.0);
        let size = direction.with_sign_of(zero).max(simd.splat_f32(SMALLEST));
        let steep = simd.splat_f32(1.0) / size;
        let inverse = steep.with_sign_of(direction);
        let center = by_axis(simd, &probe.center) * inverse;
        let slack = simd.splat_f32(probe.slack) * steep;
        let mut numbers = [[0.0; LANES]; 3];
        inverse.store(&mut numbers[0]);
        (center - slack).store(&mut numbers[1]);
        (center + slack).store(&mut numbers[2]);
        Self {
            probe,
            inverse: splat(simd, &numbers[0]),
            entering: splat(simd, &numbers[1]),
            leaving: splat(simd, &numbers[2]),
            numbers,
            order: Order::new(inverse.le(zero)),
        }
    }

    /// Returns true if the ray meets a box in the frame, given by its lower and upper corners, before
    /// `t`, or comes close to it.
    #[inline(always)]
    pub(crate) fn meets(&self, [low, high]: &[[f32; 3]; 2], t: f64) -> bool {
        let (mut enter, mut leave) = (0.0_f32, self.distance(t));
        let [inverse, entering, leaving] = &self.numbers;
        for axis in 0..3 {
            let [first, last] = match inverse[axis] < 0.0 {
                true => [high[axis], low[axis]],
                false => [low[axis], high[axis]],
            };
            enter = enter.max(first * inverse[axis] + entering[axis]);
            leave = leave.min(last * inverse[axis] + leaving[axis]);
        }
        enter <= leave
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
        let inverse = &self.inverse;
        [
            planes(simd, node, x).times_plus(inverse[0], from[0]),
            planes(simd, node, y).times_plus(inverse[1], from[1]),
            planes(simd, node, z).times_plus(inverse[2], from[2]),
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
            order: Order::new(by_axis(simd, one).le(simd.splat_f32(0.0))),
        }
    }
}

impl<S: Simd> Together<'_, S> {
    /// Returns true if one of the rays may meet a box before `t`, given its lower and upper corners.
    #[inline(always)]
    pub(crate) fn meets(&self, [low, high]: &[[f32; 3]; 2], t: f64) -> bool {
        let Beam {
            inverse: [one, other],
            entering,
            leaving,
            ..
        } = self.beam;
        let (mut enter, mut leave) = (self.beam.nearest, self.beam.distance(t));
        for axis in 0..3 {
            let [first, last] = match one[axis] < 0.0 {
                true => [high[axis], low[axis]],
                false => [low[axis], high[axis]],
            };
            let (first, last) = (first - entering[axis], last - leaving[axis]);
            enter = enter.max((first * one[axis]).min(first * other[axis]));
            leave = leave.min((last * one[axis]).max(last * other[axis]));
        }
        enter <= leave
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
            let first = planes(simd, node, self.order.first[axis]) - self.entering[axis];
            let last = planes(simd, node, self.order.last[axis]) - self.leaving[axis];
            enter = (first * one[axis]).min(first * other[axis]).max(enter);
            leave = (last * one[axis]).max(last * other[axis]).min(leave);
        }
        let mut at = [0.0; LANES];
        enter.store(&mut at);
        (enter.le(leave), at)
    }
}

/// Returns the first three of some numbers, each in all lanes.
#[inline(always)]
fn splat<S: Simd, const COUNT: usize>(simd: S, numbers: &[f32; COUNT]) -> [S::F32; 3] {
    [
        simd.splat_f32(numbers[0]),
        simd.splat_f32(numbers[1]),
        simd.splat_f32(numbers[2]),
    ]
}

/// Returns a vector with one number of each axis.
#[inline(always)]
fn by_axis<S: Simd>(simd: S, [x, y, z]: &[f32; 3]) -> S::F32 {
    simd.load_f32(&[*x, *y, *z, 1.0, 1.0, 1.0, 1.0, 1.0])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{
        accel::bvh::frame::{Frame, Hull},
        simd::{Kernel, isa::Isa},
        tracer::ray::Ray,
    };

    /// The numbers of a ray.
    struct Numbers(Probe);

    impl Kernel for Numbers {
        type Output = [[f32; LANES]; 3];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> [[f32; LANES]; 3] {
            OneRay::new(simd, &self.0).numbers
        }
    }

    #[test]
    fn the_numbers_of_a_ray_are_finite_and_grow_boxes() {
        let hull = Hull::of_box([-DVec3::ONE, DVec3::ONE]);
        let frame = Frame::around([hull].into_iter()).unwrap();
        for direction in [DVec3::Y, DVec3::NEG_X, DVec3::new(0.0, -0.0, 1e49)] {
            for origin in [DVec3::ZERO, DVec3::X, DVec3::splat(-3e4)] {
                let probe = frame.probe(&Ray::new(origin, direction)).unwrap();
                for isa in Isa::all() {
                    let [inverse, entering, leaving] = isa.run(Numbers(probe));
                    for axis in 0..3 {
                        assert!(inverse[axis].is_finite());
                        assert!(entering[axis] < leaving[axis] && leaving[axis].is_finite());
                    }
                }
            }
        }
    }
}
