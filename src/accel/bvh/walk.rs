//! Traversal of the tree by one ray, eight lanes at a time: boxes are tested in f32, which only
//! excludes misses (see `frame.rs`), the spheres in them by the textbook's formulas. Other shapes
//! are tested one by one.

use crate::{
    accel::{
        bvh::{
            DEPTH, Tree,
            frame::Probe,
            node::{Leaf, Link, Node, Place},
        },
        lanes::{Divide, dot, first_root, splat3, sub},
    },
    simd::{F32x8, F64x8, Kernel, LANES, Mask, Simd},
    tracer::{geometry::Geometry, ray::Ray},
};

/// The stack size: each level pushes up to seven links.
const STACK: usize = DEPTH * (LANES - 1) + 1;

/// The nearest hit so far: the smallest `t`, and at equal `t` the lower index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    pub(super) index: usize,
    pub(super) t: f64,
    /// The leaf and the lane of the hit, if it is a sphere in the tree.
    pub(super) place: Option<(usize, usize)>,
}

impl Nearest {
    /// Creates the state before any hit. Only hits nearer than `t_max` count: no index is below 0,
    /// so a hit at `t_max` itself is not taken.
    pub(super) const fn before(t_max: f64) -> Self {
        Self {
            index: 0,
            t: t_max,
            place: None,
        }
    }

    /// Replaces this hit by the other if that is nearer; returns true if so.
    #[inline(always)]
    pub(super) fn or(&mut self, other: Self) -> bool {
        let nearer = other.t < self.t || (other.t == self.t && other.index < self.index);
        if nearer {
            *self = other;
        }
        nearer
    }
}

/// The kernel that finds the nearest hit or, with `ANY`, the first one nearer than the known hit.
pub(super) struct Walk<'a, const ANY: bool> {
    pub(super) tree: &'a Tree,
    /// All geometries of the world, for shapes other than spheres.
    pub(super) geometries: &'a [Geometry],
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a Probe,
    pub(super) nearest: Nearest,
}

impl<const ANY: bool> Kernel for Walk<'_, ANY> {
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
        let lanes = Lanes::new(simd, ray, probe);
        // The end of the ray, and the stack of links still to be visited.
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
                        // The nearest is next; the others are pushed in order, the farthest lowest.
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
                    let (mut met, t) = lanes.spheres(simd, leaf, nearest.t);
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let sphere = Nearest {
                            index: leaf.index[lane] as usize,
                            t: t[lane],
                            place: Some((number, lane)),
                        };
                        if nearest.or(sphere) {
                            if ANY {
                                return nearest;
                            }
                            farthest = probe.distance(nearest.t);
                        }
                    }
                    let mut others = leaf.others;
                    while others != 0 {
                        let lane = others.trailing_zeros() as usize;
                        others &= others - 1;
                        let index = leaf.index[lane] as usize;
                        let shape = geometries[index].shape();
                        // At an equal t the lower index may still win.
                        let Some(t) = shape.intersect(ray, nearest.t.next_up()) else {
                            continue;
                        };
                        let place = None;
                        if nearest.or(Nearest { index, t, place }) {
                            if ANY {
                                return nearest;
                            }
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
    /// Prefetches a node or a leaf: a ray mostly waits for memory.
    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S, link: Link) {
        match link.place() {
            Place::Node(number) => simd.prefetch(&self.nodes[number]),
            Place::Leaf(number) => simd.prefetch(&self.leaves[number]),
        }
    }
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

/// A ray and its probe, each number in all lanes.
struct Lanes<S: Simd> {
    origin: [S::F64; 3],
    direction: [S::F64; 3],
    /// `d·d`
    a: S::F64,
    inverse: [S::F32; 3],
    entering: [S::F32; 3],
    leaving: [S::F32; 3],
    /// The index of the plane of a node that the ray meets first, for each axis; `last` is the
    /// opposite one.
    first: [usize; 3],
    last: [usize; 3],
}

impl<S: Simd> Divide<S> for Lanes<S> {}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray, probe: &Probe) -> Self {
        let [x, y, z] = probe.inverse.map(|inverse| usize::from(inverse < 0.0) * 3);
        let (origin, direction) = (ray.origin(), ray.direction());
        Self {
            origin: splat3(simd, origin),
            direction: splat3(simd, direction),
            a: simd.splat(direction.dot(direction)),
            inverse: splat(simd, &probe.inverse),
            entering: splat(simd, &probe.entering),
            leaving: splat(simd, &probe.leaving),
            first: [x, 1 + y, 2 + z],
            last: [3 - x, 4 - y, 5 - z],
        }
    }

    /// Returns the boxes that the ray meets before `farthest`, and the distances at which it enters
    /// them.
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

    /// Returns the spheres that the ray hits at a `t` of at most `nearest`, and the values of `t`.
    #[inline(always)]
    fn spheres(&self, simd: S, leaf: &Leaf, nearest: f64) -> (u8, [f64; LANES]) {
        let center = [
            simd.load(&leaf.center[0]),
            simd.load(&leaf.center[1]),
            simd.load(&leaf.center[2]),
        ];
        let (radius, two) = (simd.load(&leaf.radius), simd.splat(2.0));
        let oc = sub(self.origin, center);
        let b = dot(self.direction, [two * oc[0], two * oc[1], two * oc[2]]);
        let c = dot(oc, oc) - radius * radius;
        let mut at = [0.0; LANES];
        let Some((t, counts)) = first_root(simd, self, self.a, (b, c)) else {
            return (0, at);
        };
        t.store(&mut at);
        ((counts & t.le(simd.splat(nearest))).bits(), at)
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
