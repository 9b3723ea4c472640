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
    tracer::{
        geometry::Geometry,
        ray::Ray,
        shape::{
            face::{Crossing, Own},
            sphere::Sphere,
        },
    },
};

/// The stack size: each level pushes up to seven links.
const STACK: usize = DEPTH * (LANES - 1) + 1;

/// The nearest hit so far: the smallest `t`, and at equal `t` the lower index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    pub(super) index: usize,
    pub(super) t: f64,
    face: u32,
    /// The leaf and the lane of the hit, if it is a sphere in the tree.
    pub(super) place: Option<(usize, usize)>,
}

impl Nearest {
    /// Creates the state before any hit. Only hits nearer than `t_max` count: no index is below 0,
    /// so a hit at `t_max` itself is not taken.
    pub(super) const fn before(t_max: f64) -> Self {
        let t = t_max;
        Self::new(0, Crossing { t, face: 0 })
    }

    #[inline(always)]
    pub(super) const fn new(index: usize, Crossing { t, face }: Crossing) -> Self {
        Self {
            index,
            t,
            face,
            place: None,
        }
    }

    /// Returns the crossing of the geometry.
    pub(super) const fn crossing(&self) -> Crossing {
        let Self { t, face, .. } = *self;
        Crossing { t, face }
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

/// The glass that a ray crosses.
#[derive(Debug, Default)]
pub(super) struct Crossings(Vec<usize>);

impl Crossings {
    /// Returns true if a geometry that the ray crosses is opaque; otherwise notes it.
    pub(super) fn is_opaque(&mut self, geometry: &Geometry, index: usize) -> bool {
        let is_glass = geometry.has_glass();
        if is_glass {
            self.0.push(index);
        }
        !is_glass
    }

    /// Returns the indices of the geometries in file order.
    pub(super) fn in_order(mut self) -> Vec<usize> {
        self.0.sort_unstable();
        self.0
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
    /// The face that the ray leaves. Spheres with the numbers of its shape are not tested.
    pub(super) own: Option<&'a Own<'a>>,
    /// With `ANY`, a collector of the glass that the ray crosses, which does not count as a hit.
    pub(super) glass: Option<&'a mut Crossings>,
}

impl<const ANY: bool> Kernel for Walk<'_, ANY> {
    type Output = Nearest;

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> Nearest {
        let tree = self.tree;
        let own = self.own.and_then(|own| own.shape().sphere());
        let lanes = Lanes::new(simd, self.ray, self.probe, own);
        let mut stack = Stack {
            links: [Later(0); STACK],
            len: 0,
        };
        // The end of the ray.
        let mut farthest = self.probe.distance(self.nearest.t);
        let mut link = tree.root;
        loop {
            match link.place() {
                Place::Node(number) => {
                    let node = &tree.nodes[number];
                    let (met, enter) = lanes.boxes(simd, node, farthest);
                    if met != 0 {
                        link = stack.push_all_but_nearest(simd, tree, node, met, &enter);
                        continue;
                    }
                }
                Place::Leaf(number) => {
                    if self.meet_leaf(simd, &lanes, number) {
                        if ANY {
                            return self.nearest;
                        }
                        farthest = self.probe.distance(self.nearest.t);
                    }
                }
            }
            match stack.pop(farthest) {
                Some(next) => link = next,
                None => return self.nearest,
            }
        }
    }
}

impl<const ANY: bool> Walk<'_, ANY> {
    /// Tests the shapes of a leaf; returns true if one of them is hit nearer than before. With
    /// `ANY`, the others are not tested then.
    #[inline(always)]
    fn meet_leaf<S: Simd>(&mut self, simd: S, lanes: &Lanes<S>, number: usize) -> bool {
        let leaf = &self.tree.leaves[number];
        let mut is_nearer = false;
        let (mut met, t) = lanes.spheres(simd, leaf, self.nearest.t);
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            if ANY && t[lane] < self.nearest.t && self.goes_through(leaf, lane) {
                continue;
            }
            is_nearer |= self.nearest.or(Nearest {
                index: leaf.index[lane] as usize,
                t: t[lane],
                face: 0,
                place: Some((number, lane)),
            });
            if ANY && is_nearer {
                return true;
            }
        }
        let mut others = leaf.others;
        while others != 0 {
            let lane = others.trailing_zeros() as usize;
            others &= others - 1;
            let index = leaf.index[lane] as usize;
            let shape = self.geometries[index].shape();
            // At an equal t the lower index may still win.
            let farthest = self.nearest.t.next_up();
            let Some(crossing) = shape.meet_from(self.own, self.ray, farthest) else {
                continue;
            };
            if ANY && crossing.t < self.nearest.t && self.goes_through(leaf, lane) {
                continue;
            }
            is_nearer |= self.nearest.or(Nearest::new(index, crossing));
            if ANY && is_nearer {
                return true;
            }
        }
        is_nearer
    }
}

impl<const ANY: bool> Walk<'_, ANY> {
    /// Returns true if the shape in a lane is glass that is collected, and collects it.
    #[inline(always)]
    fn goes_through(&mut self, leaf: &Leaf, lane: usize) -> bool {
        let is_glass = leaf.glass >> lane & 1 == 1;
        match &mut self.glass {
            Some(glass) if is_glass => {
                glass.0.push(leaf.index[lane] as usize);
                true
            }
            _ => false,
        }
    }
}

/// The links still to be visited.
struct Stack {
    links: [Later; STACK],
    len: usize,
}

impl Stack {
    /// Returns the nearest child that the ray meets, and pushes the others in order, the farthest
    /// lowest. `met` has at least one lane.
    #[inline(always)]
    fn push_all_but_nearest<S: Simd>(
        &mut self,
        simd: S,
        tree: &Tree,
        node: &Node,
        mut met: u8,
        enter: &[f32; LANES],
    ) -> Link {
        let lane = met.trailing_zeros() as usize;
        met &= met - 1;
        if met == 0 {
            return node.links[lane];
        }
        let mut next = Later::new(enter[lane], node.links[lane]);
        tree.prefetch(simd, node.links[lane]);
        let first = self.len;
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            let mut other = Later::new(enter[lane], node.links[lane]);
            tree.prefetch(simd, node.links[lane]);
            if other < next {
                (next, other) = (other, next);
            }
            let mut place = self.len;
            while place > first && self.links[place - 1] < other {
                self.links[place] = self.links[place - 1];
                place -= 1;
            }
            self.links[place] = other;
            self.len += 1;
        }
        next.link()
    }

    /// Removes the topmost link that is not beyond `farthest`, and all above it.
    #[inline(always)]
    fn pop(&mut self, farthest: f32) -> Option<Link> {
        while self.len > 0 {
            self.len -= 1;
            let later = self.links[self.len];
            if later.distance() <= farthest {
                return Some(later.link());
            }
        }
        None
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
    /// The center and the radius of the sphere that the ray leaves; NaN for none.
    own: [S::F64; 4],
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
    fn new(simd: S, ray: &Ray, probe: &Probe, own: Option<&Sphere>) -> Self {
        let own = own.map_or([f64::NAN; 4], Sphere::numbers);
        let [x, y, z] = probe.inverse.map(|inverse| usize::from(inverse < 0.0) * 3);
        let (origin, direction) = (ray.origin(), ray.direction());
        Self {
            origin: splat3(simd, origin),
            direction: splat3(simd, direction),
            a: simd.splat(direction.dot(direction)),
            own: [
                simd.splat(own[0]),
                simd.splat(own[1]),
                simd.splat(own[2]),
                simd.splat(own[3]),
            ],
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
        let [x, y, z, r] = self.own;
        let is_own = center[0].eq(x) & center[1].eq(y) & center[2].eq(z) & radius.eq(r);
        ((counts & !is_own & t.le(simd.splat(nearest))).bits(), at)
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
