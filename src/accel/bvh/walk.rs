//! The shapes in the leaves that a ray comes to: eight spheres at a time, by the textbook's formulas.
//! Other shapes are tested one by one.

use crate::{
    accel::{
        bvh::{
            frame::Probe,
            node::Leaf,
            traverse::{OneRay, Seek},
            tree::Tree,
        },
        lanes::{Divide, dot, first_root, splat3, sub},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        geometry::Geometry,
        ray::Ray,
        shape::face::{Crossing, FaceId, Leaving},
    },
};

/// The nearest hit so far: the smallest `t`, and at equal `t` the lower index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    pub(super) index: usize,
    pub(super) t: f64,
    face: u64,
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
    pub(super) leaves: &'a [Leaf],
    /// All geometries of the world, for shapes other than spheres.
    pub(super) geometries: &'a [Geometry],
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a Probe,
    pub(super) nearest: Nearest,
    /// The faces that the ray leaves. Their geometries are not tested.
    pub(super) left: &'a [FaceId],
    /// With `ANY`, a collector of the glass that the ray crosses, which does not count as a hit.
    pub(super) glass: Option<&'a mut Crossings>,
}

impl<const ANY: bool> Kernel for Walk<'_, ANY> {
    type Output = Nearest;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Nearest {
        let (tree, probe) = (self.tree, self.probe);
        let lanes = Lanes::new(simd, self.ray);
        let mut search = Search { walk: self, lanes };
        tree.traverse(simd, &OneRay::new(simd, probe), &mut search);
        search.walk.nearest
    }
}

/// A walk and its ray in lanes.
struct Search<'a, S: Simd, const ANY: bool> {
    walk: Walk<'a, ANY>,
    lanes: Lanes<S>,
}

impl<S: Simd, const ANY: bool> Seek<S> for Search<'_, S, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.walk.nearest.t
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        self.walk.meet_leaf(simd, &self.lanes, leaf)
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.walk.leaves[leaf]);
    }
}

impl<const ANY: bool> Walk<'_, ANY> {
    /// Tests the shapes of a leaf; returns true if one of them is hit nearer than before. With
    /// `ANY`, the others are not tested then.
    #[inline(always)]
    fn meet_leaf<S: Simd>(&mut self, simd: S, lanes: &Lanes<S>, number: usize) -> bool {
        let leaf = &self.leaves[number];
        let mut is_nearer = false;
        let (mut met, t) = lanes.spheres(simd, leaf, self.nearest.t);
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            if self.leaves(leaf.index[lane]) {
                continue;
            }
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
            if self.leaves(leaf.index[lane]) {
                continue;
            }
            let index = leaf.index[lane] as usize;
            let shape = self.geometries[index].shape();
            // At an equal t the lower index may still win.
            let farthest = self.nearest.t.next_up();
            let Some(crossing) = shape.meet(self.ray, Leaving::NOTHING, farthest) else {
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
    /// Returns true if the ray leaves a face of a geometry.
    #[inline(always)]
    fn leaves(&self, index: u32) -> bool {
        let mut left = self.left.iter();
        left.any(|face| face.geometry == index as usize)
    }

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

/// A ray, each number in all lanes.
struct Lanes<S: Simd> {
    origin: [S::F64; 3],
    direction: [S::F64; 3],
    /// `d·d`
    a: S::F64,
}

impl<S: Simd> Divide<S> for Lanes<S> {}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin(), ray.direction());
        Self {
            origin: splat3(simd, origin),
            direction: splat3(simd, direction),
            a: simd.splat(direction.dot(direction)),
        }
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
