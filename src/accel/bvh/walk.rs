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
        lanes::{Divide, abs, dot, first_root, splat3, sub},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        geometry::Geometry,
        ray::Ray,
        shape::{
            Shape,
            contact::ContactPoint,
            face::{Crossing, FaceId, Leaving},
        },
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

/// The origin of a ray, which is known to lie on one geometry.
#[derive(Clone, Copy)]
pub(super) struct OriginWatch<'a> {
    pub(super) point: &'a ContactPoint,
    /// By how much the equation of a sphere may be off 0 at a point on it, or more.
    pub(super) slack: f64,
    /// True once it may lie on another one.
    pub(super) is_touched: bool,
}

impl OriginWatch<'_> {
    /// Notes whether the point may lie on a shape.
    #[inline]
    pub(super) fn see(&mut self, shape: &Shape) -> bool {
        let is_touched = &mut self.is_touched;
        shape.each_face_near(self.point, &mut |face| *is_touched |= face.is_touched);
        self.is_touched
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
    /// If it is not known whether the ray begins on other geometries too: that is watched for. The walk ends at
    /// the first on which its origin may lie.
    pub(super) watch: Option<OriginWatch<'a>>,
    /// With `ANY`, a collector of the glass that the ray crosses, which does not count as a hit.
    pub(super) glass: Option<&'a mut Crossings>,
}

impl<const ANY: bool> Kernel for Walk<'_, ANY> {
    /// Also true if what is watched for was found.
    type Output = (Nearest, bool);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let (tree, probe) = (self.tree, self.probe);
        let lanes = Lanes::new(simd, self.ray, self.watch.map_or(0.0, |watch| watch.slack));
        let mut search = Search { walk: self, lanes };
        tree.traverse(simd, &OneRay::new(simd, probe), &mut search);
        let Walk { nearest, watch, .. } = search.walk;
        (nearest, watch.is_some_and(|watch| watch.is_touched))
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
        let (mut met, t, mut near) = lanes.spheres(simd, leaf, self.nearest.t);
        while near != 0 {
            let lane = near.trailing_zeros() as usize;
            near &= near - 1;
            if self.touches(leaf, lane) {
                return true;
            }
        }
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
            if self.watch.is_some() && self.touches(leaf, lane) {
                return true;
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
    /// Returns true if the ray begins on the shape in a lane, if that is watched for. Nothing is nearer then.
    #[inline(always)]
    fn touches(&mut self, leaf: &Leaf, lane: usize) -> bool {
        let index = leaf.index[lane];
        if self.leaves(index) {
            return false;
        }
        let geometry = &self.geometries[index as usize];
        let is_touched = self
            .watch
            .as_mut()
            .is_some_and(|watch| watch.see(geometry.shape()));
        if is_touched {
            self.nearest = Nearest::before(f64::NEG_INFINITY);
        }
        is_touched
    }

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
    slack: f64,
    /// The least discriminant of a sphere that the origin may lie on.
    lowest: S::F64,
}

impl<S: Simd> Divide<S> for Lanes<S> {}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray, slack: f64) -> Self {
        let (origin, direction) = (ray.origin(), ray.direction());
        Self {
            origin: splat3(simd, origin),
            direction: splat3(simd, direction),
            a: simd.splat(direction.dot(direction)),
            slack,
            lowest: simd.splat(-8.0 * direction.dot(direction) * slack),
        }
    }

    /// Returns the spheres that the ray hits at a `t` of at most `nearest`, the values of `t`, and the spheres
    /// that its origin may lie on, if that is watched for.
    #[inline(always)]
    fn spheres(&self, simd: S, leaf: &Leaf, nearest: f64) -> (u8, [f64; LANES], u8) {
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
        let Some((t, counts)) = first_root(simd, self, self.a, (b, c), self.lowest) else {
            return (0, at, 0);
        };
        t.store(&mut at);
        let near = match self.slack > 0.0 {
            true => abs(c).le(simd.splat(self.slack)).bits(),
            false => 0,
        };
        ((counts & t.le(simd.splat(nearest))).bits(), at, near)
    }
}
