//! The tests of shapes by eight rays, by the equations of `tracer/shape/` in their
//! order of operations. Scenes with many of them are common: the bonds of molecules, clouds of surfels, blocks,
//! and the parts of solids.

use glam::DVec3;

use crate::{
    accel::{
        lanes::{across, bits, dot, load3, splat3, sub, surely_holds},
        mesh::sheared::{Sheared, ShearedApart, crossings, is_hit},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            Shape,
            around::{Around, GROWTH, Near},
            axis::Axis,
            capsule::Capsule,
            cone::Cone,
            cuboid::Cuboid,
            cylinder::Cylinder,
            disc::Disc,
            ellipsoid::Ellipsoid,
            face::{Crossing, Leaving},
            rectangle::Rectangle,
            span::Convex,
            sphere::Sphere,
            triangle::Triangle,
        },
    },
};

/// Returns true if a shape has a test for eight rays.
pub(super) const fn is_tested(shape: &Shape) -> bool {
    matches!(
        shape,
        Shape::Sphere(_)
            | Shape::Ellipsoid(_)
            | Shape::Cylinder(_)
            | Shape::Cone(_)
            | Shape::Capsule(_)
            | Shape::Cuboid(_)
            | Shape::Disc(_)
            | Shape::Rectangle(_)
            | Shape::Triangle(_)
    )
}

/// The kernel that finds the first crossing of each ray of a bundle with a shape that has a test.
pub(super) struct FirstOfEach<'a> {
    pub(super) shape: &'a Shape,
    pub(super) bundle: &'a Bundle,
    /// What each ray leaves.
    pub(super) leaving: &'a [Leaving<'a>; BUNDLE],
}

impl Kernel for FirstOfEach<'_> {
    type Output = [Option<Crossing>; BUNDLE];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            shape,
            bundle,
            leaving,
        } = self;
        let [mut wanted, mut plain] = [0; 2];
        for lane in (0..LANES).filter(|lane| bundle.t_max()[*lane] > 0.0) {
            wanted |= 1 << lane;
            plain |= u8::from(leaving[lane].is_empty()) << lane;
        }
        let around = None;
        let found = simd.call(LinesOf {
            shape,
            around,
            bundle,
        });
        let mut crossings = [None; BUNDLE];
        // Those that leave a face are tested one by one.
        let mut odd = !plain;
        if let Some(found) = found {
            let (zero, t_max) = (simd.splat(0.0), simd.load(bundle.t_max()));
            let (one, other) = (simd.load(&found.t[0]), simd.load(&found.t[1]));
            let near = found.counts[0] & (zero.lt(one) & one.lt(t_max)).bits();
            let far = found.counts[1] & (zero.lt(other) & other.lt(t_max)).bits();
            let met = (near | far) & plain;
            odd |= found.odd;
            if met != 0 {
                let t = S::F64::select(simd.mask(near), one, other);
                odd |= met & !found.holds(simd, bundle, t);
            }
            for lane in bits(met & !odd) {
                let end = usize::from(near >> lane & 1 == 0);
                let (t, face) = (found.t[end][lane], found.faces[end][lane] as u64);
                crossings[lane] = Some(Crossing { t, face });
            }
        }
        for lane in bits(odd & wanted) {
            crossings[lane] = shape.meet(&bundle.ray(lane), leaving[lane], bundle.t_max()[lane]);
        }
        crossings
    }
}

/// The kernel that finds where the lines of a bundle, of rays that leave nothing, cross a shape that has a test; `None`
/// if none does.
pub(super) struct LinesOf<'a> {
    pub(super) shape: &'a Shape,
    /// The box and the ball that the crossings with a sphere have to be near, if they have to be near one.
    pub(super) around: Option<&'a Around>,
    pub(super) bundle: &'a Bundle,
}

/// The crossings of eight lines with a shape.
pub(super) struct CrossedLines {
    /// Where each line crosses it: for a solid, where it gets inside, and out again.
    pub(super) t: [[f64; LANES]; 2],
    pub(super) faces: [[f64; LANES]; 2],
    /// The lanes in which the crossings count.
    pub(super) counts: [u8; 2],
    /// The lanes of lines that have to be tested one by one: along an axis or across it, or through numbers that
    /// are extreme.
    pub(super) odd: u8,
    /// Where crossings surely are near the shape; `None` if all are.
    near: Option<Near>,
}

impl CrossedLines {
    /// Returns lanes in which a crossing at `t` surely is near the shape.
    #[inline(always)]
    pub(super) fn holds<S: Simd>(&self, simd: S, bundle: &Bundle, t: S::F64) -> u8 {
        let rays = [
            load3(simd, bundle.origins()),
            load3(simd, bundle.directions()),
        ];
        match &self.near {
            Some(near) => surely_holds(simd, near, rays, t).bits(),
            None => u8::MAX,
        }
    }
}

impl Kernel for LinesOf<'_> {
    type Output = Option<CrossedLines>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let rays = [
            load3(simd, self.bundle.origins()),
            load3(simd, self.bundle.directions()),
        ];
        match self.shape {
            Shape::Cylinder(it) => cylinder(simd, it, rays).stored(),
            Shape::Cone(it) => cone(simd, it, rays).stored(),
            Shape::Cuboid(it) => cuboid(simd, it, rays).stored(),
            Shape::Disc(it) => disc(simd, it, rays).stored(),
            // A function of its own, so that this one stays small.
            _ => simd.call(LinesOfOther(self)),
        }
    }
}

/// The part of [`LinesOf`] for the other shapes.
struct LinesOfOther<'a>(LinesOf<'a>);

impl Kernel for LinesOfOther<'_> {
    type Output = Option<CrossedLines>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let LinesOf {
            shape,
            around,
            bundle,
        } = self.0;
        let rays = [
            load3(simd, bundle.origins()),
            load3(simd, bundle.directions()),
        ];
        let lines = match shape {
            Shape::Sphere(it) => sphere(simd, it, around, rays),
            Shape::Ellipsoid(it) => ellipsoid(simd, it, rays),
            Shape::Capsule(it) => capsule(simd, it, rays),
            Shape::Rectangle(it) => rectangle(simd, it, rays),
            Shape::Triangle(it) => triangle(simd, it, rays),
            _ => return None,
        };
        lines.stored()
    }
}

/// The same in vectors.
#[derive(Clone, Copy)]
struct Lines<S: Simd> {
    ends: [(S::F64, S::F64); 2],
    counts: [S::Mask; 2],
    odd: S::Mask,
    near: Option<Near>,
}

impl<S: Simd> Lines<S> {
    /// Returns the crossings in memory; `None` if there are none.
    #[inline(always)]
    fn stored(self) -> Option<CrossedLines> {
        let counts = [self.counts[0].bits(), self.counts[1].bits()];
        let odd = self.odd.bits();
        if counts[0] | counts[1] | odd == 0 {
            return None;
        }
        let mut crossed = CrossedLines {
            t: [[0.0; LANES]; 2],
            faces: [[0.0; LANES]; 2],
            counts,
            odd,
            near: self.near,
        };
        for (end, (t, face)) in self.ends.into_iter().enumerate() {
            t.store(&mut crossed.t[end]);
            face.store(&mut crossed.faces[end]);
        }
        Some(crossed)
    }

    /// Creates the lines that miss a shape.
    #[inline(always)]
    fn none(simd: S, odd: S::Mask) -> Self {
        let zero = simd.splat(0.0);
        Self {
            ends: [(zero, zero); 2],
            counts: [simd.mask(0); 2],
            odd,
            near: None,
        }
    }
}

#[inline(always)]
fn sphere<S: Simd>(
    simd: S,
    sphere: &Sphere,
    around: Option<&Around>,
    [origin, d]: [[S::F64; 3]; 2],
) -> Lines<S> {
    let (zero, two) = (simd.splat(0.0), simd.splat(2.0));
    let from = sub(origin, splat3(simd, sphere.center()));
    let squared = sphere.radius() * sphere.radius();
    let a = dot(d, d);
    let b = dot(d, [two * from[0], two * from[1], two * from[2]]);
    let c = dot(from, from) - simd.splat(squared);
    let discriminant = b * b - simd.splat(4.0) * a * c;
    let meets = zero.le(discriminant);
    let root = discriminant.sqrt();
    let half = two * a;
    let ends = [((-b - root) / half, zero), ((-b + root) / half, zero)];
    // All of a ball's surface is at its edge.
    let near = around.map(|around| Near {
        squared: squared * (1.0 + GROWTH),
        ..around.near()
    });
    Lines {
        ends,
        counts: [meets; 2],
        odd: simd.mask(0),
        near,
    }
}

#[inline(always)]
fn disc<S: Simd>(simd: S, disc: &Disc, [o, d]: [[S::F64; 3]; 2]) -> Lines<S> {
    let zero = simd.splat(0.0);
    let (center, normal) = (splat3(simd, disc.center()), splat3(simd, disc.normal()));
    let up = dot(d, normal);
    let t = dot(sub(center, o), normal) / up;
    let point = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
    let from_center = sub(point, center);
    let squared = simd.splat(disc.radius() * disc.radius());
    let is_inside = dot(from_center, from_center).le(squared) & !up.eq(zero);
    Lines {
        ends: [(t, zero); 2],
        counts: [is_inside, simd.mask(0)],
        ..Lines::none(simd, simd.mask(0))
    }
}

#[inline(always)]
fn cuboid<S: Simd>(simd: S, cuboid: &Cuboid, [o, d]: [[S::F64; 3]; 2]) -> Lines<S> {
    let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
    let [mut enter, mut exit] = [(-infinity, zero), (infinity, zero)];
    let mut odd = simd.mask(0);
    for axis in 0..3 {
        let low = (simd.splat(cuboid.min()[axis]) - o[axis]) / d[axis];
        let high = (simd.splat(cuboid.max()[axis]) - o[axis]) / d[axis];
        let faces = [
            simd.splat((2 * axis) as f64),
            simd.splat((2 * axis + 1) as f64),
        ];
        let is_up = zero.lt(d[axis]);
        let first = S::F64::select(is_up, low, high);
        let last = S::F64::select(is_up, high, low);
        // NaN, or along the plane.
        odd = odd | d[axis].eq(zero) | !first.le(last);
        let (is_later, is_sooner) = (enter.0.lt(first), last.lt(exit.0));
        enter.1 = S::F64::select(is_later, S::F64::select(is_up, faces[0], faces[1]), enter.1);
        exit.1 = S::F64::select(is_sooner, S::F64::select(is_up, faces[1], faces[0]), exit.1);
        enter.0 = S::F64::select(is_later, first, enter.0);
        exit.0 = S::F64::select(is_sooner, last, exit.0);
    }
    Lines {
        ends: [enter, exit],
        counts: [enter.0.le(exit.0); 2],
        odd,
        near: Some(cuboid.hull().near()),
    }
}

/// Returns the crossings with a round face, whose radius is the root of `squared`.
#[inline(always)]
fn round<S: Simd>(simd: S, [q, e]: [[S::F64; 3]; 2], squared: f64) -> Lines<S> {
    let (zero, squared) = (simd.splat(0.0), simd.splat(squared));
    let (a, h) = (dot(e, e), dot(q, e));
    let s = h / a;
    let m = [q[0] - s * e[0], q[1] - s * e[1], q[2] - s * e[2]];
    let discriminant = squared - dot(m, m);
    let mut odd = a.eq(zero);
    let meets = zero.le(discriminant);
    if (meets | odd).bits() == 0 {
        return Lines::none(simd, odd);
    }
    let root = (a * discriminant).sqrt();
    let k = -S::F64::select(h.lt(zero), h - root, h + root);
    let (one, other) = (k / a, (dot(q, q) - squared) / k);
    let is_first = one.le(other);
    let enter = S::F64::select(is_first, one, other);
    let exit = S::F64::select(is_first, other, one);
    odd = odd | (meets & (h.eq(zero) | k.eq(zero) | !enter.le(exit)));
    Lines {
        ends: [(enter, zero), (exit, zero)],
        counts: [meets; 2],
        odd,
        near: None,
    }
}

#[inline(always)]
fn ellipsoid<S: Simd>(simd: S, ellipsoid: &Ellipsoid, [o, d]: [[S::F64; 3]; 2]) -> Lines<S> {
    let from = sub(o, splat3(simd, ellipsoid.center()));
    let [mut q, mut e] = [[simd.splat(0.0); 3]; 2];
    for (number, axis) in ellipsoid.axes().iter().enumerate() {
        let (along, squared) = (splat3(simd, *axis), simd.splat(axis.dot(*axis)));
        q[number] = dot(from, along) / squared;
        e[number] = dot(d, along) / squared;
    }
    Lines {
        near: Some(ellipsoid.hull().near()),
        ..round(simd, [q, e], 1.0)
    }
}

#[inline(always)]
fn cylinder<S: Simd>(simd: S, cylinder: &Cylinder, rays: [[S::F64; 3]; 2]) -> Lines<S> {
    let side = Lines {
        near: Some(cylinder.hull().near()),
        ..round_side(simd, cylinder.axis(), cylinder.radius(), rays)
    };
    side.between_ends(simd, (cylinder.axis(), cylinder.capped()), rays)
}

/// Returns the crossings with a round face about an axis.
#[inline(always)]
fn round_side<S: Simd>(simd: S, axis: &Axis, radius: f64, [o, d]: [[S::F64; 3]; 2]) -> Lines<S> {
    let w = splat3(simd, axis.w);
    let q = across(sub(o, splat3(simd, axis.from)), w);
    round(simd, [q, across(d, w)], radius * radius)
}

#[inline(always)]
fn capsule<S: Simd>(simd: S, capsule: &Capsule, rays: [[S::F64; 3]; 2]) -> Lines<S> {
    let ([o, d], zero, infinity) = (rays, simd.splat(0.0), simd.splat(f64::INFINITY));
    let (axis, radius) = (capsule.axis(), capsule.radius());
    let side = round_side(simd, axis, radius, rays).between_ends(simd, (axis, false), rays);
    let [mut enter, mut exit] = [(infinity, zero), (-infinity, zero)];
    let [mut counts, mut odd] = [simd.mask(0); 2];
    for face in 0..3 {
        let round = match face {
            0 => side,
            _ => {
                let center = if face == 1 { axis.from } else { axis.to };
                round(simd, [sub(o, splat3(simd, center)), d], radius * radius)
            }
        };
        let face = simd.splat(f64::from(face));
        for end in 0..2 {
            let (t, meets) = (round.ends[end].0, round.counts[end]);
            let (is_sooner, is_later) = (meets & t.lt(enter.0), meets & exit.0.lt(t));
            enter.0 = S::F64::select(is_sooner, t, enter.0);
            enter.1 = S::F64::select(is_sooner, face, enter.1);
            exit.0 = S::F64::select(is_later, t, exit.0);
            exit.1 = S::F64::select(is_later, face, exit.1);
            counts = counts | meets;
        }
        odd = odd | round.odd;
    }
    Lines {
        ends: [enter, exit],
        counts: [counts; 2],
        odd,
        near: Some(capsule.hull().near()),
    }
}

/// Returns corners as eight rays see them.
#[inline(always)]
fn seen<S: Simd, const COUNT: usize>(
    simd: S,
    rays: [[S::F64; 3]; 2],
    corners: &[DVec3; COUNT],
) -> [[S::F64; 3]; COUNT] {
    let mut seen = [[simd.splat(0.0); 3]; COUNT];
    // Loops: in a kernel, a closure may be a call.
    match Sheared::new(simd, rays) {
        Some(sheared) => {
            for (seen, corner) in seen.iter_mut().zip(corners) {
                *seen = sheared.point(simd, corner);
            }
        }
        None => {
            let sheared = ShearedApart::new(simd, rays);
            for (seen, corner) in seen.iter_mut().zip(corners) {
                *seen = sheared.point(simd, corner);
            }
        }
    }
    seen
}

#[inline(always)]
fn triangle<S: Simd>(simd: S, triangle: &Triangle, rays: [[S::F64; 3]; 2]) -> Lines<S> {
    let none = simd.mask(0);
    let corners = triangle.corners();
    match crossings(simd, seen(simd, rays, &corners)) {
        Some((t, crosses)) => Lines {
            ends: [(t, simd.splat(0.0)); 2],
            counts: [crosses, none],
            odd: none,
            near: Some(Near::triangle(corners)),
        },
        None => Lines::none(simd, none),
    }
}

#[inline(always)]
fn rectangle<S: Simd>(simd: S, rectangle: &Rectangle, rays: [[S::F64; 3]; 2]) -> Lines<S> {
    let ([o, d], zero, none) = (rays, simd.splat(0.0), simd.mask(0));
    let [a, b, c, e] = seen(simd, rays, &rectangle.corners());
    let is_hit = is_hit(simd, [a, b, c]) | is_hit(simd, [a, c, e]);
    let plane = rectangle.unit_plane();
    let normal = splat3(simd, plane.normal());
    let down = dot(d, normal);
    let t = dot(sub(splat3(simd, plane.point()), o), normal) / down;
    Lines {
        ends: [(t, zero); 2],
        counts: [is_hit & !down.eq(zero), none],
        odd: none,
        near: rectangle.around().map(|around| around.near()),
    }
}

#[inline(always)]
fn cone<S: Simd>(simd: S, cone: &Cone, rays: [[S::F64; 3]; 2]) -> Lines<S> {
    let ([o, d], zero, infinity) = (rays, simd.splat(0.0), simd.splat(f64::INFINITY));
    let axis = cone.axis();
    let (w, apart) = (splat3(simd, axis.w), splat3(simd, axis.from));
    let middle = dot(sub(apart, o), d) / dot(d, d);
    let from = sub(o, apart);
    let q = [
        from[0] + middle * d[0],
        from[1] + middle * d[1],
        from[2] + middle * d[2],
    ];
    let (height, rise) = (dot(q, w), dot(d, w));
    let p = [
        q[0] - height * w[0],
        q[1] - height * w[1],
        q[2] - height * w[2],
    ];
    let e = [d[0] - rise * w[0], d[1] - rise * w[1], d[2] - rise * w[2]];
    let slope = simd.splat(cone.slope());
    let radius = simd.splat(cone.radius()) + slope * height;
    let growth = slope * rise;
    let v = [
        radius * e[0] - growth * p[0],
        radius * e[1] - growth * p[1],
        radius * e[2] - growth * p[2],
    ];
    let x = [
        e[1] * p[2] - p[1] * e[2],
        e[2] * p[0] - p[2] * e[0],
        e[0] * p[1] - p[0] * e[1],
    ];
    let a = dot(e, e) - growth * growth;
    let h = dot(p, e) - radius * growth;
    let c = dot(p, p) - radius * radius;
    let discriminant = dot(v, v) - dot(x, x);
    let is_steep = zero.lt(a);
    let meets = !(is_steep & discriminant.lt(zero));
    if meets.bits() == 0 {
        return Lines::none(simd, a.eq(zero));
    }
    let root = S::F64::select(discriminant.lt(zero), zero, discriminant).sqrt();
    let k = -S::F64::select(h.lt(zero), h - root, h + root);
    let (one, other) = (k / a, c / k);
    let is_first = one.le(other);
    let low = middle + S::F64::select(is_first, one, other);
    let high = middle + S::F64::select(is_first, other, one);
    // In the half of the double cone where the radius is above 0.
    let grows = zero.lt(growth);
    let enter = S::F64::select(is_steep, low, S::F64::select(grows, high, -infinity));
    let exit = S::F64::select(is_steep, high, S::F64::select(grows, infinity, low));
    let is_known = low.le(high) & !(a.eq(zero) | h.eq(zero) | k.eq(zero));
    let side = Lines {
        ends: [(enter, zero), (exit, zero)],
        counts: [meets; 2],
        odd: meets & !is_known,
        near: Some(cone.hull().near()),
    };
    side.between_ends(simd, (axis, cone.capped()), rays)
}

impl<S: Simd> Lines<S> {
    /// Returns the crossings of a round side, or of the solid that it bounds together with the discs at the ends of
    /// its axis.
    #[inline(always)]
    fn between_ends(
        self,
        simd: S,
        (axis, is_capped): (&Axis, bool),
        [o, d]: [[S::F64; 3]; 2],
    ) -> Self {
        let (zero, w) = (simd.splat(0.0), splat3(simd, axis.w));
        let up = dot(d, w);
        let low = dot(sub(splat3(simd, axis.from), o), w) / up;
        let high = dot(sub(splat3(simd, axis.to), o), w) / up;
        let is_up = zero.lt(up);
        let first = S::F64::select(is_up, low, high);
        let last = S::F64::select(is_up, high, low);
        let [(enter, _), (exit, _)] = self.ends;
        let [meets, _] = self.counts;
        // NaN, and signs of 0 that matter.
        let is_known = enter.le(exit) & first.le(last) & !up.eq(zero);
        let odd = self.odd | (meets & !is_known);
        if !is_capped {
            let counts = [
                meets & first.le(enter) & enter.le(last),
                meets & first.le(exit) & exit.le(last),
            ];
            return Self {
                counts,
                odd,
                ..self
            };
        }
        let (one, two) = (simd.splat(1.0), simd.splat(2.0));
        let (is_later, is_sooner) = (enter.lt(first), last.lt(exit));
        let faces = [
            S::F64::select(is_up, one, two),
            S::F64::select(is_up, two, one),
        ];
        let ends = [
            (
                S::F64::select(is_later, first, enter),
                S::F64::select(is_later, faces[0], zero),
            ),
            (
                S::F64::select(is_sooner, last, exit),
                S::F64::select(is_sooner, faces[1], zero),
            ),
        ];
        let is_inside = meets & ends[0].0.le(ends[1].0);
        Self {
            ends,
            counts: [is_inside; 2],
            odd,
            near: self.near,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{FirstOfEach, is_tested};
    use crate::{
        simd::isa::Isa,
        tracer::{
            random::{Rng, cases},
            ray::{BUNDLE, Bundle},
            shape::{Shape, any::any, face::FaceId},
            vector::unit,
        },
    };

    /// Returns a shape that has a test for eight rays.
    fn tested(rng: &mut Rng) -> Shape {
        loop {
            let size = rng.magnitude(-3.0, 3.0);
            let center = rng.vector() * rng.one(&[0.0, size, size * 1e6]);
            match any(rng, center, size) {
                Ok(shape) if is_tested(&shape) => return shape,
                _ => {}
            }
        }
    }

    /// Returns the direction of the axis and some points that are special.
    fn special(shape: &Shape) -> Option<(DVec3, Vec<DVec3>)> {
        let (axis, ends, radius) = match shape {
            Shape::Cylinder(it) => (it.axis().w, [it.from(), it.to()], it.radius()),
            Shape::Capsule(it) => (it.axis().w, [it.from(), it.to()], it.radius()),
            Shape::Cone(it) => (it.axis().w, [it.from(), it.to()], it.radius()),
            Shape::Cuboid(it) => (DVec3::X, [it.min(), it.max()], it.max().x - it.min().x),
            Shape::Disc(it) => (it.unit_normal(), [it.center(); 2], it.radius()),
            Shape::Sphere(it) => (DVec3::X, [it.center(); 2], it.radius()),
            Shape::Ellipsoid(it) => {
                let [axis, ..] = it.axes();
                (unit(axis), [it.center(); 2], axis.length())
            }
            Shape::Rectangle(it) => {
                let [a, b, c, _] = it.corners();
                (unit(b - a), [a, c], 0.3 * (b - a).length())
            }
            Shape::Triangle(it) => {
                let [a, b, c] = it.corners();
                (unit(b - a), [a, c], 0.3 * (b - a).length())
            }
            _ => return None,
        };
        let across = radius * axis.any_orthonormal_vector();
        let points = ends.map(|end| [end, end + across, end - across]);
        Some((axis, points.as_flattened().into()))
    }

    #[test]
    fn eight_rays_meet_what_each_of_them_does() {
        let mut rng = Rng(23);
        let mut met = [0; 7];
        for case in 0..cases(20_000) {
            let shape = tested(&mut rng);
            let (axis, points) = special(&shape).unwrap();
            let size = (points[0] - points[5]).length().max(1e-3);
            let eye = points[0] + rng.vector() * size * rng.magnitude(-1.0, 3.0);
            let (mut lines, mut t_max) = ([[[0.0; BUNDLE]; 3]; 2], [0.0; BUNDLE]);
            let mut owns = [None; BUNDLE];
            for lane in 0..BUNDLE {
                let mut to = points[rng.below(points.len())];
                to += rng.vector() * size * rng.one(&[0.0, 1e-9, 0.1, 0.5]);
                let across = axis.any_orthonormal_vector();
                let away = rng.one(&[axis, across, DVec3::X, axis + across * 1e-9]);
                let from = rng.one(&[eye, eye, to - away * size, to]);
                let direction = match from == to {
                    true => away,
                    false => (to - from) * rng.one(&[1.0, 1e-3, 1e3]),
                };
                for (lines, vector) in lines.iter_mut().zip([from, direction]) {
                    for (line, x) in lines.iter_mut().zip(vector.to_array()) {
                        line[lane] = x;
                    }
                }
                t_max[lane] = rng.one(&[f64::INFINITY, f64::INFINITY, 1.0, 0.0]);
                owns[lane] = match rng.below(3) {
                    0 => Some(FaceId::of_shape(rng.below(6) as u64)),
                    _ => None,
                };
            }
            let bundle = Bundle::new(lines[0], lines[1], t_max);
            let leaving = owns.each_ref().map(|own: &Option<FaceId>| match own {
                Some(own) => super::Leaving::only(own),
                None => super::Leaving::NOTHING,
            });
            let expected = shape.first_of_each(&bundle, &leaving);
            for crossing in &expected {
                met[crossing.map_or(6, |crossing| crossing.face as usize)] += 1;
            }
            for isa in Isa::all() {
                let found = isa.run(FirstOfEach {
                    shape: &shape,
                    bundle: &bundle,
                    leaving: &leaving,
                });
                assert_eq!(
                    found, expected,
                    "{case}, {isa}: {shape:?} {bundle:?} {leaving:?}"
                );
            }
        }
        let least = cases(20_000) / 400;
        assert!(met.iter().all(|count| *count > least), "{met:?}");
    }
}
