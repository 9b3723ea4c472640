//! Eight rays at a time: they walk through the tree of copies together, and into each copy they are mapped in the
//! lanes of a vector.

use crate::{
    accel::{
        bundle_of, first_of_each,
        instances::Copies,
        lanes::{bits, load3, may_meet},
        mapped_back, not_around,
        places::Met,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            around::Around,
            face::{Crossing, Leaving},
            instances::Instances,
        },
        transform::Transform,
    },
};

/// The kernel that finds the first crossing of each ray of a bundle with copies; `None` if the rays have to be traced
/// one by one.
pub(super) struct FirstOfEach<'a> {
    pub(super) index: &'a Copies,
    pub(super) copies: &'a Instances,
    pub(super) bundle: &'a Bundle,
    /// What each ray leaves.
    pub(super) leaving: &'a [Leaving<'a>; BUNDLE],
}

impl Kernel for FirstOfEach<'_> {
    type Output = Option<[Option<Crossing>; BUNDLE]>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let rays = [
            load3(simd, self.bundle.origins()),
            load3(simd, self.bundle.directions()),
        ];
        let mut met = MetCopies {
            of: &self,
            first: First {
                t: *self.bundle.t_max(),
                crossings: [None; BUNDLE],
            },
        };
        match &self.index.places {
            Some(places) => {
                let farthest = simd.load(self.bundle.t_max()).largest();
                let is_known = places.search_together(simd, rays, farthest, &mut met);
                is_known.then_some(met.first.crossings)
            }
            None => {
                (0..self.copies.len()).for_each(|copy| {
                    met.see(simd, copy);
                });
                Some(met.first.crossings)
            }
        }
    }
}

/// The first crossing of each ray so far.
struct First {
    /// The `t` before which each ray ends.
    t: [f64; BUNDLE],
    crossings: [Option<Crossing>; BUNDLE],
}

impl First {
    /// Returns the `t` before which crossings may be first: at an equal `t`, the lower number is.
    fn farthest(&self, lane: usize) -> f64 {
        match self.crossings[lane] {
            Some(_) => self.t[lane].next_up(),
            None => self.t[lane],
        }
    }

    /// Takes a crossing of a ray if it is first.
    fn take(&mut self, lane: usize, found: Crossing) {
        let is_first = self.crossings[lane].is_none_or(|first| {
            found.t < first.t || (found.t == first.t && found.face < first.face)
        });
        if is_first {
            self.t[lane] = found.t;
            self.crossings[lane] = Some(found);
        }
    }
}

/// Finds the first crossings with the copies that are met.
struct MetCopies<'a> {
    of: &'a FirstOfEach<'a>,
    first: First,
}

impl<S: Simd> Met<S> for MetCopies<'_> {
    #[inline(always)]
    fn see(&mut self, simd: S, copy: usize) -> f64 {
        simd.call(FirstOfCopy {
            of: self.of,
            copy,
            first: &mut self.first,
        });
        simd.load(&self.first.t).largest()
    }
}

/// The kernel that finds the first crossings of a bundle with a copy.
struct FirstOfCopy<'a> {
    of: &'a FirstOfEach<'a>,
    copy: usize,
    first: &'a mut First,
}

/// A copy and the rays that are mapped back to the prototype.
struct CopiedBundle<'a> {
    of: &'a FirstOfEach<'a>,
    copy: usize,
    transform: &'a Transform,
    inner: Bundle,
    /// What each ray leaves of the copy.
    leaving: [Leaving<'a>; BUNDLE],
    first: &'a mut First,
    /// The rays that have to be traced one by one.
    odd: u8,
}

impl Kernel for FirstOfCopy<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { of, copy, first } = self;
        let FirstOfEach {
            index,
            copies,
            bundle,
            leaving,
        } = *of;
        let Some(transform) = copies.transform(copy) else {
            return;
        };
        let faces = copies.faces_of_copy();
        let leaving = leaving.map(|leaving| leaving.part(copy as u64 * faces, faces));
        let (zero, rays) = (simd.splat(0.0), mapped_back(simd, &transform, bundle));
        let t = simd.load(&first.t);
        let mut near = zero.lt(t).bits();
        if let Some(around) = copies.around_prototype() {
            // Where a ray meets a copy that it leaves depends on nothing but its direction.
            let leave = (0..LANES).filter(|lane| !leaving[*lane].is_empty());
            let leave = leave.fold(0, |lanes, lane| lanes | 1 << lane);
            near &= may_meet(simd, around, rays, t) | leave;
        }
        if near == 0 {
            return;
        }
        let t_max = |lane: usize| match near >> lane & 1 {
            1 => first.farthest(lane),
            _ => 0.0,
        };
        let mut copied = CopiedBundle {
            of,
            copy,
            transform: &transform,
            inner: bundle_of(rays, std::array::from_fn(t_max)),
            leaving,
            first,
            odd: 0,
        };
        match &index.prototype {
            Some(prototype) => {
                let farthest = simd.load(copied.inner.t_max()).largest();
                let is_known = prototype.places.as_ref().is_some_and(|places| {
                    let rays = [
                        load3(simd, copied.inner.origins()),
                        load3(simd, copied.inner.directions()),
                    ];
                    places.search_together(simd, rays, farthest, &mut copied)
                });
                if !is_known {
                    copied.odd = near;
                }
            }
            None => {
                (0..copies.shapes().len()).for_each(|part| {
                    copied.see(simd, part);
                });
            }
        }
        copied.one_by_one();
    }
}

impl<S: Simd> Met<S> for CopiedBundle<'_> {
    #[inline(always)]
    fn see(&mut self, simd: S, part: usize) -> f64 {
        simd.call(FirstOfPart { copied: self, part });
        simd.load(self.inner.t_max()).largest()
    }
}

impl CopiedBundle<'_> {
    /// Tests the copy against the rays that need it, each for itself.
    fn one_by_one(&mut self) {
        let FirstOfEach {
            index,
            copies,
            bundle,
            leaving,
        } = *self.of;
        for lane in bits(self.odd) {
            let ray = bundle.ray(lane);
            let passage = copies.crossings(&ray, leaving[lane]);
            let copied = passage.copied(self.copy);
            let met = copied.and_then(|copied| index.meet(&copied, self.first.farthest(lane)));
            if let Some(met) = met {
                self.first.take(lane, met);
            }
        }
    }
}

/// The kernel that finds the first crossings of a bundle with a shape of a copy.
struct FirstOfPart<'a, 'b> {
    copied: &'a mut CopiedBundle<'b>,
    part: usize,
}

impl Kernel for FirstOfPart<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let copied = self.copied;
        let FirstOfEach { copies, bundle, .. } = *copied.of;
        let Some((shape, first_face)) = copies.part(self.part) else {
            return;
        };
        let count = shape.face_count();
        let leaving = copied
            .leaving
            .map(|leaving| leaving.part(first_face, count));
        let met = first_of_each(simd, shape, &copied.inner, &leaving);
        if met.iter().all(Option::is_none) {
            return;
        }
        let around = Around::shape(shape).and_then(|around| around.mapped(copied.transform));
        if let Some(around) = around {
            // Another crossing of these may count.
            copied.odd |= not_around(simd, &around, bundle, &met);
        }
        let number = copied.copy as u64 * copies.faces_of_copy() + first_face;
        for lane in bits(!copied.odd) {
            if let Some(crossing) = met[lane] {
                let face = number + crossing.face;
                copied.first.take(lane, Crossing { face, ..crossing });
                copied.inner.end(lane, crossing.t.next_up());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::{
        accel::{bvh::build::Builder, instances::index_copies},
        parallel::Pool,
        simd::isa::Isa,
        tracer::{
            random::{Rng, cases},
            ray::{BUNDLE, Bundle, Ray},
            shape::{
                Shape,
                any::copies,
                face::{FaceId, Leaving},
            },
        },
    };

    /// Returns eight rays through a ball around 0: from one eye, or from anywhere.
    fn rays(rng: &mut Rng, size: f64) -> [Ray; BUNDLE] {
        let (eye, middle) = (rng.vector() * 2.0 * size, rng.vector() * size);
        let spread = size * rng.magnitude(-5.0, 0.0);
        let is_beam = rng.below(3) > 0;
        std::array::from_fn(|_| {
            let (from, to) = match is_beam {
                true => (eye, middle + spread * rng.vector()),
                false => (rng.vector() * 2.0 * size, rng.vector() * size),
            };
            Ray::new(from, (to - from) * rng.one(&[1.0, 1e-3, 1e3]))
        })
    }

    #[test]
    fn eight_rays_meet_what_each_of_them_does() {
        let mut rng = Rng(0xc0b1);
        let (pool, isas) = (Pool::new(None), Isa::all());
        let mut met = 0;
        for _ in 0..cases(600) {
            let (center, size) = (DVec3::ZERO, rng.magnitude(-2.0, 2.0));
            let Ok(plain) = copies(&mut rng, center, size) else {
                continue;
            };
            let quick = plain.of_others(plain.shapes().cloned());
            index_copies(&quick, Builder::new(&pool, rng.one(&isas)));
            let [plain, quick] = [plain, quick].map(Shape::from);
            let faces = plain.face_count();
            for _ in 0..8 {
                let rays = rays(&mut rng, size);
                let of = |part: fn(&Ray) -> DVec3| {
                    std::array::from_fn(|axis| std::array::from_fn(|lane| part(&rays[lane])[axis]))
                };
                let t_max = rays.each_ref().map(|_| rng.one(&[f64::INFINITY, 1.0, 0.0]));
                let bundle = Bundle::new(of(Ray::origin), of(Ray::direction), t_max);
                let owns = rays.each_ref().map(|_| match rng.below(4) {
                    0 => Some(FaceId::of_shape(rng.below(faces as usize) as u64)),
                    _ => None,
                });
                let leaving = owns.each_ref().map(|own: &Option<FaceId>| match own {
                    Some(own) => Leaving::only(own),
                    None => Leaving::NOTHING,
                });
                let expected =
                    bundle.each(|lane, ray, t_max| plain.meet(ray, leaving[lane], t_max));
                let found = quick.first_of_each(&bundle, &leaving);
                assert_eq!(found, expected, "{plain:?} {bundle:?} {leaving:?}");
                met += found.iter().flatten().count();
            }
        }
        assert!(met > cases(600) * 4, "{met}");
    }
}
