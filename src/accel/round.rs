//! The tests of cylinders and discs by eight rays, by the equations of `tracer/shape/` in their order of
//! operations. Scenes with many of them are common: the bonds of molecules, and clouds of surfels.

use crate::{
    accel::lanes::{across, dot, load3, splat3, sub, surely_holds},
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            Shape,
            cylinder::Cylinder,
            disc::Disc,
            face::{Crossing, Leaving},
            plane::Planar,
            span::Convex,
        },
    },
};

/// A shape with a test for eight rays.
#[derive(Clone, Copy)]
pub(super) enum Round<'a> {
    Cylinder(&'a Cylinder),
    Disc(&'a Disc),
}

impl<'a> Round<'a> {
    /// Returns the shape if it is one.
    pub(super) fn new(shape: &'a Shape) -> Option<Self> {
        match shape {
            Shape::Cylinder(cylinder) => Some(Self::Cylinder(cylinder)),
            Shape::Disc(disc) => Some(Self::Disc(disc)),
            _ => None,
        }
    }

    /// Returns the first crossing of one ray.
    #[cold]
    #[inline(never)]
    fn first(self, bundle: &Bundle, lane: usize, leaving: Leaving) -> Option<Crossing> {
        let (ray, t_max) = (bundle.ray(lane), bundle.t_max()[lane]);
        match self {
            Self::Cylinder(cylinder) => cylinder.crossings(&ray, leaving).first(t_max),
            Self::Disc(disc) => disc.crossings(&ray, leaving).first(t_max),
        }
    }
}

/// The kernel that finds the first crossing of each ray of a bundle.
pub(super) struct FirstOfEach<'a> {
    pub(super) shape: Round<'a>,
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
        let found = match shape {
            Round::Cylinder(cylinder) => meet_cylinder(simd, cylinder, bundle, plain),
            Round::Disc(disc) => meet_disc(simd, disc, bundle, plain),
        };
        let odd = found.odd | (wanted & !plain);
        if found.met | odd == 0 {
            return [None; BUNDLE];
        }
        let (mut t, mut faces) = ([0.0; LANES], [0.0; LANES]);
        found.t.store(&mut t);
        found.face.store(&mut faces);
        let mut crossings = [None; BUNDLE];
        for (lane, crossing) in crossings.iter_mut().enumerate() {
            if found.met >> lane & 1 == 1 {
                let (t, face) = (t[lane], faces[lane] as u64);
                *crossing = Some(Crossing { t, face });
            } else if odd >> lane & 1 == 1 {
                *crossing = shape.first(bundle, lane, leaving[lane]);
            }
        }
        crossings
    }
}

/// The first crossings of eight rays.
struct FirstCrossings<S: Simd> {
    t: S::F64,
    face: S::F64,
    /// The lanes that have a crossing.
    met: u8,
    /// The lanes of rays that have to be tested one by one: along the axis or across it, or through
    /// numbers that are extreme.
    odd: u8,
}

/// Returns the first crossings of some rays that leave nothing.
#[inline(always)]
fn meet_disc<S: Simd>(simd: S, disc: &Disc, bundle: &Bundle, rays: u8) -> FirstCrossings<S> {
    let zero = simd.splat(0.0);
    let [o, d] = [
        load3(simd, bundle.origins()),
        load3(simd, bundle.directions()),
    ];
    let (center, normal) = (splat3(simd, disc.center()), splat3(simd, disc.normal()));
    let up = dot(d, normal);
    let t = dot(sub(center, o), normal) / up;
    let point = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
    let from_center = sub(point, center);
    let squared = simd.splat(disc.radius() * disc.radius());
    let is_inside = dot(from_center, from_center).le(squared) & !up.eq(zero);
    let met = is_inside & zero.lt(t) & t.lt(simd.load(bundle.t_max()));
    FirstCrossings {
        t,
        face: zero,
        met: met.bits() & rays,
        odd: 0,
    }
}

/// Returns the first crossings of some rays that leave nothing.
#[inline(always)]
fn meet_cylinder<S: Simd>(
    simd: S,
    cylinder: &Cylinder,
    bundle: &Bundle,
    rays: u8,
) -> FirstCrossings<S> {
    let zero = simd.splat(0.0);
    let [o, d] = [
        load3(simd, bundle.origins()),
        load3(simd, bundle.directions()),
    ];
    let w = splat3(simd, cylinder.unit_axis());
    let [from, to] = [splat3(simd, cylinder.from()), splat3(simd, cylinder.to())];
    let (q, e) = (across(sub(o, from), w), across(d, w));
    let (a, h) = (dot(e, e), dot(q, e));
    let s = h / a;
    let m = [q[0] - s * e[0], q[1] - s * e[1], q[2] - s * e[2]];
    let squared = simd.splat(cylinder.radius() * cylinder.radius());
    let discriminant = squared - dot(m, m);
    let mut odd = a.eq(zero);
    let meets = zero.le(discriminant);
    if (meets | odd).bits() & rays == 0 {
        return FirstCrossings {
            t: zero,
            face: zero,
            met: 0,
            odd: 0,
        };
    }
    // The side.
    let root = (a * discriminant).sqrt();
    let k = -S::F64::select(h.lt(zero), h - root, h + root);
    let (one, other) = (k / a, (dot(q, q) - squared) / k);
    let is_first = one.le(other);
    let enter = S::F64::select(is_first, one, other);
    let exit = S::F64::select(is_first, other, one);
    // The ends.
    let up = dot(d, w);
    let (low, high) = (dot(sub(from, o), w) / up, dot(sub(to, o), w) / up);
    let is_up = zero.lt(up);
    let first = S::F64::select(is_up, low, high);
    let last = S::F64::select(is_up, high, low);
    // NaN, and signs of 0 that matter.
    odd = odd | (meets & (h.eq(zero) | k.eq(zero) | up.eq(zero)));
    odd = odd | (meets & !(enter.le(exit) & first.le(last)));

    let mut ends = [(enter, zero), (exit, zero)];
    let mut counts = [meets & !odd; 2];
    if cylinder.capped() {
        let [one, two] = [1.0, 2.0].map(|face| simd.splat(face));
        let is_later = enter.lt(first);
        let is_sooner = last.lt(exit);
        let faces = [
            S::F64::select(is_up, one, two),
            S::F64::select(is_up, two, one),
        ];
        ends = [
            (
                S::F64::select(is_later, first, enter),
                S::F64::select(is_later, faces[0], zero),
            ),
            (
                S::F64::select(is_sooner, last, exit),
                S::F64::select(is_sooner, faces[1], zero),
            ),
        ];
        let is_inside = ends[0].0.le(ends[1].0);
        counts = counts.map(|counts| counts & is_inside);
    } else {
        for (counts, (t, _)) in counts.iter_mut().zip(ends) {
            *counts = *counts & first.le(t) & t.le(last);
        }
    }
    let t_max = simd.load(bundle.t_max());
    for (counts, (t, _)) in counts.iter_mut().zip(ends) {
        *counts = *counts & zero.lt(t) & t.lt(t_max);
    }
    let [near, far] = counts;
    let t = S::F64::select(near, ends[0].0, ends[1].0);
    let met = near | far;
    if met.bits() & rays != 0 {
        odd = odd | (met & !surely_holds(simd, &cylinder.near(), [o, d], t));
    }
    FirstCrossings {
        t,
        face: S::F64::select(near, ends[0].1, ends[1].1),
        met: (met & !odd).bits() & rays,
        odd: odd.bits() & rays,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{FirstOfEach, Round};
    use crate::{
        simd::isa::Isa,
        tracer::{
            random::{Rng, cases},
            ray::{BUNDLE, Bundle},
            shape::{Shape, any::any, face::FaceId},
        },
    };

    /// Returns a cylinder or a disc.
    fn round(rng: &mut Rng) -> Shape {
        loop {
            let size = rng.magnitude(-3.0, 3.0);
            let center = rng.vector() * rng.one(&[0.0, size, size * 1e6]);
            match any(rng, center, size) {
                Ok(shape) if Round::new(&shape).is_some() => return shape,
                _ => {}
            }
        }
    }

    /// Returns the direction of the axis and some points that are special.
    fn special(shape: &Shape) -> Option<(DVec3, Vec<DVec3>)> {
        let (axis, ends, radius) = match Round::new(shape)? {
            Round::Cylinder(it) => (it.unit_axis(), [it.from(), it.to()], it.radius()),
            Round::Disc(it) => (it.unit_normal(), [it.center(); 2], it.radius()),
        };
        let across = radius * axis.any_orthonormal_vector();
        let points = ends.map(|end| [end, end + across, end - across]);
        Some((axis, points.as_flattened().into()))
    }

    #[test]
    fn eight_rays_meet_what_each_of_them_does() {
        let mut rng = Rng(23);
        let mut met = [0; 4];
        for case in 0..cases(20_000) {
            let shape = round(&mut rng);
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
                    0 => Some(FaceId::of_shape(rng.below(3) as u64)),
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
                met[crossing.map_or(3, |crossing| crossing.face as usize)] += 1;
            }
            for isa in Isa::all() {
                let found = isa.run(FirstOfEach {
                    shape: Round::new(&shape).unwrap(),
                    bundle: &bundle,
                    leaving: &leaving,
                });
                assert_eq!(
                    found, expected,
                    "{case}, {isa}: {shape:?} {bundle:?} {leaving:?}"
                );
            }
        }
        assert!(met.iter().all(|count| *count > 100), "{met:?}");
    }
}
