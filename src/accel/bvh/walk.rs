//! One ray through the tree: boxes and spheres eight at a time in f32, which only leave out what
//! cannot be hit (see `frame.rs`), and the textbook's own `intersect` for what remains.

use crate::{
    accel::bvh::{
        DEPTH, Tree,
        frame::Probe,
        node::{Leaf, Link, Node, Place},
    },
    simd::{F32x8, Kernel, LANES, Simd},
    tracer::{geometry::Geometry, ray::Ray},
};

/// Each level leaves up to seven places for later.
const STACK: usize = DEPTH * (LANES - 1) + 1;

/// The nearest hit so far: the smallest `t`, and at equal `t` the lower index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    pub(super) index: usize,
    pub(super) t: f64,
}

impl Nearest {
    /// Nothing is hit yet.
    pub(super) const NONE: Self = Self {
        index: usize::MAX,
        t: f64::INFINITY,
    };

    /// Tests a geometry, by the definition; whether it is nearer.
    #[inline(always)]
    pub(super) fn test(&mut self, geometries: &[Geometry], index: usize, ray: &Ray) -> bool {
        let found = geometries.get(index).map(|it| it.shape().intersect(ray));
        match found.flatten() {
            Some(t) if t < self.t || (t == self.t && index < self.index) => {
                *self = Self { index, t };
                true
            }
            _ => false,
        }
    }
}

/// Finds the nearest sphere.
pub(super) struct Walk<'a> {
    pub(super) tree: &'a Tree,
    pub(super) geometries: &'a [Geometry],
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a Probe,
    pub(super) nearest: Nearest,
}

impl Kernel for Walk<'_> {
    type Output = Nearest;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Nearest {
        let Self {
            tree,
            geometries,
            ray,
            probe,
            mut nearest,
        } = self;
        let lanes = Lanes::new(simd, probe);
        // How far the ray is followed, and the places still to be seen.
        let mut farthest = probe.distance(nearest.t);
        let mut stack = [Later(0); STACK];
        let mut left = 0;
        let mut link = tree.root;
        loop {
            match link.place() {
                Place::Node(number) => {
                    let (mut met, enter) = lanes.boxes(simd, &tree.nodes[number], farthest);
                    if met != 0 {
                        let links = &tree.nodes[number].links;
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        if met == 0 {
                            link = links[lane];
                            continue;
                        }
                        let mut next = Later::new(enter[lane], links[lane]);
                        tree.prefetch(simd, links[lane]);
                        // The nearest is next, the others wait in order, the farthest lowest.
                        let first = left;
                        while met != 0 {
                            let lane = met.trailing_zeros() as usize;
                            met &= met - 1;
                            let mut other = Later::new(enter[lane], links[lane]);
                            tree.prefetch(simd, links[lane]);
                            if other < next {
                                (next, other) = (other, next);
                            }
                            let mut place = left;
                            while place > first && stack[place - 1] < other {
                                stack[place] = stack[place - 1];
                                place -= 1;
                            }
                            stack[place] = other;
                            left += 1;
                        }
                        link = next.link();
                        continue;
                    }
                }
                Place::Leaf(number) => {
                    let leaf = &tree.leaves[number];
                    let (mut met, enter) = lanes.spheres(simd, leaf, farthest);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        if enter[lane] <= farthest
                            && nearest.test(geometries, leaf.index[lane] as usize, ray)
                        {
                            farthest = probe.distance(nearest.t);
                        }
                    }
                }
            }
            link = loop {
                if left == 0 {
                    return nearest;
                }
                left -= 1;
                if stack[left].distance() <= farthest {
                    break stack[left].link();
                }
            };
        }
    }
}

impl Tree {
    /// Fetches a place ahead of its use: waiting for memory is most of what a ray does.
    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S, link: Link) {
        match link.place() {
            Place::Node(number) => {
                let node = &self.nodes[number];
                simd.prefetch(&node.planes[0]);
                simd.prefetch(&node.planes[2]);
                simd.prefetch(&node.planes[4]);
                simd.prefetch(&node.links);
            }
            Place::Leaf(number) => {
                let leaf = &self.leaves[number];
                simd.prefetch(&leaf.center[0]);
                simd.prefetch(&leaf.center[2]);
                simd.prefetch(&leaf.index);
            }
        }
    }
}

/// A place with its distance, which comes first in the order: a float that is not negative
/// compares as its bits.
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

/// A probe, each number in all lanes.
struct Lanes<S: Simd> {
    origin: [S::F32; 3],
    direction: [S::F32; 3],
    slack: S::F32,
    inverse: [S::F32; 3],
    entering: [S::F32; 3],
    leaving: [S::F32; 3],
    /// Which of a node's planes the ray meets first along each axis, and which last.
    first: [usize; 3],
    last: [usize; 3],
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, probe: &Probe) -> Self {
        let [x, y, z] = probe.inverse.map(|inverse| usize::from(inverse < 0.0) * 3);
        Self {
            origin: splat(simd, &probe.origin),
            direction: splat(simd, &probe.direction),
            slack: simd.splat_f32(probe.slack),
            inverse: splat(simd, &probe.inverse),
            entering: splat(simd, &probe.entering),
            leaving: splat(simd, &probe.leaving),
            first: [x, 1 + y, 2 + z],
            last: [3 - x, 4 - y, 5 - z],
        }
    }

    /// Which boxes the ray meets on its way to `farthest`, and where it enters them.
    #[inline(always)]
    fn boxes(&self, simd: S, node: &Node, farthest: f32) -> (u8, [f32; LANES]) {
        let mut enter = simd.splat_f32(0.0);
        let mut leave = simd.splat_f32(farthest);
        for axis in 0..3 {
            let first = simd.load_f32(&node.planes[self.first[axis]]);
            let last = simd.load_f32(&node.planes[self.last[axis]]);
            enter = ((first - self.entering[axis]) * self.inverse[axis]).max(enter);
            leave = ((last - self.leaving[axis]) * self.inverse[axis]).min(leave);
        }
        let mut at = [0.0; LANES];
        enter.store(&mut at);
        (enter.le(leave), at)
    }

    /// Which spheres the ray may hit on its way to `farthest`, and where at the earliest.
    #[inline(always)]
    fn spheres(&self, simd: S, leaf: &Leaf, farthest: f32) -> (u8, [f32; LANES]) {
        let x = simd.load_f32(&leaf.center[0]) - self.origin[0];
        let y = simd.load_f32(&leaf.center[1]) - self.origin[1];
        let z = simd.load_f32(&leaf.center[2]) - self.origin[2];
        let [u, v, w] = self.direction;
        // Along the ray, and from there to the center. The difference of squares would be
        // shorter, and lose the digits of small spheres.
        let along = x * u + y * v + z * w;
        let (x, y, z) = (x - along * u, y - along * v, z - along * w);
        let aside = x * x + y * y + z * z;
        let radius = simd.load_f32(&leaf.radius) + self.slack;
        let square = radius * radius;
        let half = (square - aside).max(simd.splat_f32(0.0)).sqrt() + self.slack;
        let enter = along - half;
        let mut at = [0.0; LANES];
        enter.store(&mut at);
        let met = aside.le(square)
            & enter.le(simd.splat_f32(farthest))
            & simd.splat_f32(0.0).le(along + half);
        (met, at)
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
