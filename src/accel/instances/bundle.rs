//! Eight rays at a time: they walk through the tree of copies together, and into each copy they are mapped in the
//! lanes of a vector.

use smallvec::SmallVec;

use crate::{
    accel::{
        bundle_of, first_of_each,
        lanes::{bits, load3, may_meet},
        mapped_back, not_around,
        places::{Met, Places},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            around::Around,
            face::{Crossing, Leaving},
            instances::{Instances, passage::Copied},
        },
        transform::Transform,
    },
};

/// The kernel that finds the first crossing of each ray of a bundle with copies; `None` if the rays have to be traced
/// one by one.
pub(super) struct FirstOfEach<'a> {
    /// The tree over the copies; `None` for few of them.
    pub(super) places: Option<&'a Places>,
    /// The tree over the shapes of the prototype; `None` for few of them.
    pub(super) shapes: Option<&'a Places>,
    /// Returns the first crossing of a single ray with a copy.
    pub(super) meet: &'a dyn Fn(&Copied, f64) -> Option<Crossing>,
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
                is_any: self.bundle.is_any(),
            },
        };
        match self.places {
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
    /// True if any will do.
    is_any: bool,
}

impl First {
    /// Returns the `t` before which crossings may be first: at an equal `t`, the lower number is.
    fn farthest(&self, lane: usize) -> f64 {
        match self.crossings[lane] {
            Some(_) if !self.is_any => self.t[lane].next_up(),
            _ => self.t[lane],
        }
    }

    /// Takes a crossing of a ray if it is first.
    fn take(&mut self, lane: usize, found: Crossing) {
        let is_first = self.crossings[lane].is_none_or(|first| {
            found.t < first.t || (found.t == first.t && found.face < first.face)
        });
        if is_first {
            self.t[lane] = if self.is_any { 0.0 } else { found.t };
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
            copies,
            bundle,
            leaving,
            ..
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
        match of.shapes {
            Some(shapes) => {
                // Where a ray meets a shape that it leaves depends on nothing but its direction.
                for part in copied.left() {
                    copied.see(simd, part);
                }
                let farthest = simd.load(copied.inner.t_max()).largest();
                let rays = [
                    load3(simd, copied.inner.origins()),
                    load3(simd, copied.inner.directions()),
                ];
                if !shapes.search_together(simd, rays, farthest, &mut copied) {
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
    /// Returns the shapes of the copy that rays leave.
    fn left(&self) -> SmallVec<[usize; LANES]> {
        let faces = self.leaving.iter().flat_map(Leaving::faces);
        let first = self.copy as u64 * self.of.copies.faces_of_copy();
        let parts = faces.filter_map(|face| self.of.copies.part_of(first + face));
        let mut all: SmallVec<_> = parts.map(|(part, ..)| part).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Tests the copy against the rays that need it, each for itself.
    fn one_by_one(&mut self) {
        let FirstOfEach {
            meet,
            copies,
            bundle,
            leaving,
            ..
        } = *self.of;
        for lane in bits(self.odd) {
            let ray = bundle.ray(lane);
            let passage = copies.crossings(&ray, leaving[lane]);
            let copied = passage.copied(self.copy);
            let met = copied.and_then(|copied| meet(&copied, self.first.farthest(lane)));
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
                copied.inner.end(lane, copied.first.farthest(lane));
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

    /// A ray and the face that it leaves.
    type Line = (Ray, Option<FaceId>);

    /// Compares what copies with an index answer to some rays with what those without do. Returns the rays that go on
    /// to a light.
    fn compare(
        [plain, quick]: [&Shape; 2],
        rays: &[Line],
        (t_max, light): (f64, DVec3),
    ) -> Vec<Line> {
        let line = |lane: usize| &rays[lane.min(rays.len() - 1)];
        let of = |part: fn(&Ray) -> DVec3| {
            std::array::from_fn(|axis| std::array::from_fn(|lane| part(&line(lane).0)[axis]))
        };
        let bundle = Bundle::new(of(Ray::origin), of(Ray::direction), [t_max; BUNDLE]);
        let leaving: [_; BUNDLE] = std::array::from_fn(|lane| match &line(lane).1 {
            Some(own) => Leaving::only(own),
            None => Leaving::NOTHING,
        });
        let of =
            |shape: &Shape| bundle.each(|lane, ray, t_max| shape.meet(ray, leaving[lane], t_max));
        let expected = of(quick);
        if rays.iter().all(|(_, own)| own.is_none()) {
            assert_eq!(of(plain), expected, "{plain:?} {bundle:?}");
        }
        let found = quick.first_of_each(&bundle, &leaving);
        assert_eq!(found, expected, "{plain:?} {bundle:?} {leaving:?}");
        let any = quick.first_of_each(&bundle.clone().any(), &leaving);
        let are_met = any.map(|met| met.is_some());
        assert_eq!(
            are_met,
            expected.map(|met| met.is_some()),
            "{plain:?} {bundle:?}"
        );
        let next = (0..BUNDLE).filter_map(|lane| {
            let first = found[lane]?;
            let at = bundle.ray(lane).at(first.t);
            Some((Ray::new(at, light - at), Some(FaceId::of_shape(first.face))))
        });
        next.collect()
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
            for _ in 0..8 {
                let t_max = rng.one(&[f64::INFINITY, f64::INFINITY, 1.0]);
                let all = rays(&mut rng, size).map(|ray| (ray, None));
                let light = rng.vector() * 3.0 * size;
                let next = compare([&plain, &quick], &all, (t_max, light));
                met += next.len();
                if !next.is_empty() {
                    compare([&plain, &quick], &next, (1.0, light));
                }
            }
        }
        assert!(met > cases(600) * 4, "{met}");
    }
}
