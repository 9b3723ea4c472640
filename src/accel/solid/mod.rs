//! The index of a solid: a tree over the boxes of its parts.

mod bundle;

use glam::DVec3;
use smallvec::SmallVec;

use crate::{
    accel::{bvh::build::Builder, places::Places, solid::bundle::FirstOfEach},
    simd::isa::Isa,
    tracer::{
        ray::{BUNDLE, Bundle, Ray},
        shape::{
            face::{Crossing, Leaving},
            solid::{Index, Solid},
        },
    },
};

/// Below this many parts there is no tree.
const FEW: usize = 2;

/// Gives a solid an index, if it has none.
pub(crate) fn index_solid(solid: &Solid, builder: Builder<'_>) {
    solid.index_with(|solid| {
        let index = Parts::new(solid, builder);
        // One that was cancelled may be a part only.
        (!builder.is_cancelled()).then(|| Box::new(index) as Box<dyn Index>)
    });
}

/// The index of a solid.
#[derive(Debug)]
struct Parts {
    isa: Isa,
    /// The numbers of all parts.
    all: Vec<usize>,
    /// `None` for few parts and for extreme numbers.
    places: Option<Places>,
    /// The parts that are not in the tree.
    others: Vec<usize>,
    /// True for the union of parts in the tree.
    is_union: bool,
}

impl Parts {
    fn new(solid: &Solid, builder: Builder<'_>) -> Self {
        let all: Vec<_> = (0..solid.parts().len()).collect();
        let is_bounded = |part: &usize| solid.box_of(*part).is_some();
        let (bounded, others): (Vec<_>, Vec<_>) = all.iter().partition(|part| is_bounded(part));
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let boxes = bounded.iter().filter_map(|part| solid.box_of(*part));
        let whole = boxes.fold(none, |[low, high], [least, most]| {
            [low.min(least), high.max(most)]
        });
        let places = (bounded.len() >= FEW).then(|| {
            Places::new(
                whole,
                bounded.iter().copied(),
                |part| solid.box_of(part),
                builder,
            )
        });
        Self {
            isa: builder.isa,
            all,
            places: places.flatten(),
            is_union: solid.root().is_union() && others.is_empty(),
            others,
        }
    }
}

impl Index for Parts {
    fn each(&self, ray: &Ray, t_max: f64, see: &mut dyn FnMut(usize)) {
        let mut found = |part, end| {
            see(part);
            end
        };
        let places = self.places.as_ref();
        if places.is_some_and(|places| places.search(self.isa, ray, t_max, &mut found)) {
            self.others.iter().copied().for_each(see);
        } else {
            self.all.iter().copied().for_each(see);
        }
    }

    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        let Some(places) = &self.places else {
            return self.all.iter().copied().for_each(see);
        };
        let mut near: SmallVec<[usize; 16]> = self.others.iter().copied().collect();
        places.each_near(self.isa, corners, &mut |part| near.push(part));
        near.sort_unstable();
        near.into_iter().for_each(see);
    }

    fn first_of_each(
        &self,
        solid: &Solid,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        self.isa.run(FirstOfEach {
            index: self,
            solid,
            bundle,
            leaving,
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::index_solid;
    use crate::{
        accel::bvh::build::Builder,
        parallel::Pool,
        simd::isa::Isa,
        tracer::{
            random::{Rng, cases},
            ray::{BUNDLE, Bundle, Ray},
            shape::{
                Shape,
                any::{any, solid, touching, unbounded},
                contact::ContactPoint,
                face::{Crossing, FaceId, Leaving},
                solid::{Operation, Solid},
                span::Side,
            },
        },
    };

    /// Number of random solids; `STRAHL_CASES` overrides it.
    const CASES: usize = 300;
    /// Number of bundles for each.
    const BUNDLES: usize = 6;

    /// Returns a solid of many parts, some of which touch or are combined themselves.
    fn many(rng: &mut Rng) -> Solid {
        let count = match rng.below(60) {
            0 => 2000,
            _ => rng.one(&[3, 10, 30, 100]) + rng.below(10),
        };
        let room = match rng.below(20) {
            0 => rng.magnitude(-60.0, 60.0),
            _ => rng.magnitude(-3.0, 3.0),
        };
        let center = rng.vector() * rng.one(&[0.0, 0.0, room * 1e5, 1.0]);
        let is_union = rng.below(3) == 0;
        // In some each part overlaps the next one.
        let axis = (rng.below(4) == 0).then(|| rng.vector().normalize_or(DVec3::X));
        let mut operands = Vec::<Shape>::new();
        while operands.len() < count {
            let (place, size) = match axis {
                Some(axis) => {
                    let step = room / count as f64;
                    (center + axis * step * operands.len() as f64, 1.5 * step)
                }
                None => (
                    center + rng.vector() * room,
                    room * rng.magnitude(-2.0, -0.3),
                ),
            };
            let shape = match rng.below(12) {
                0..3 if is_union => any(rng, place, size),
                0..3 => solid(rng, place, size).map(Shape::from),
                3..6 if !operands.is_empty() => {
                    let other = operands[rng.below(operands.len())].clone();
                    touching(rng, &other)
                }
                6 if rng.below(8) == 0 && !is_union => unbounded(rng, place, size),
                _ => any(rng, place, size),
            };
            let is_solid = |shape: &Shape| Solid::new(Operation::Union, [shape.clone()]).is_ok();
            operands.extend(shape.ok().filter(is_solid));
        }
        let operation = |rng: &mut Rng| {
            rng.one(&[
                Operation::Union,
                Operation::Union,
                Operation::Difference,
                Operation::Intersection,
            ])
        };
        if is_union {
            return Solid::new(Operation::Union, operands).unwrap();
        }
        let all = operation(rng);
        if rng.below(2) == 0 {
            return Solid::new(all, operands).unwrap();
        }
        let mut groups = Vec::<Shape>::new();
        while !operands.is_empty() {
            let size = 1 + rng.below(operands.len());
            let group = operands.split_off(operands.len() - size);
            groups.push(Solid::new(operation(rng), group).unwrap().into());
        }
        Solid::new(all, groups).unwrap()
    }

    /// The first crossing, all of them, and whether the ray is inside before and after its origin.
    type Asked = (Option<Crossing>, Vec<Crossing>, [bool; 2]);

    /// Returns what is asked of a ray that leaves some faces.
    fn asked(shape: &Shape, ray: &Ray, leaving: Leaving, t_max: f64) -> Asked {
        let mut all = Vec::new();
        shape.each_crossing(ray, leaving, t_max, |at| all.push(at));
        let first = shape.meet(ray, leaving, t_max);
        let sides = [Side::Before, Side::After];
        (
            first,
            all,
            sides.map(|side| shape.is_inside(ray, leaving, side, 0)),
        )
    }

    /// Returns the faces that a point lies on.
    fn faces(shape: &Shape, at: &ContactPoint) -> Vec<u64> {
        let mut faces = Vec::new();
        shape.each_face(at, &mut |found| faces.push(found.face));
        faces.sort_unstable();
        faces
    }

    /// Returns a point in or on the box around one of some parts.
    fn place(rng: &mut Rng, parts: &[[DVec3; 2]]) -> DVec3 {
        let [low, high] = parts[rng.below(parts.len())];
        let on_side = rng.one(&[DVec3::ZERO, DVec3::ONE, DVec3::splat(0.5)]);
        let anywhere = rng.vector() * 0.5 + 0.5;
        low + (high - low) * rng.one(&[on_side, anywhere])
    }

    /// A ray and the face that it leaves.
    type Line = (Ray, Option<FaceId>);

    /// Returns eight rays: all from one eye to places nearby, or any.
    fn rays(rng: &mut Rng, parts: &[[DVec3; 2]]) -> Vec<Line> {
        let (from, to) = (place(rng, parts), place(rng, parts));
        let eye = from + (from - to) * rng.one(&[0.0, 0.0, 1.0, 1e3]);
        let spread = (to - from).length() * rng.magnitude(-6.0, -0.5);
        let is_beam = rng.below(3) > 0;
        let line = |_| {
            if is_beam {
                return (Ray::new(eye, to + spread * rng.vector() - eye), None);
            }
            let (from, to) = (place(rng, parts), place(rng, parts));
            let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]) * (to - from).length();
            let direction = rng.one(&[to - from, axis]) * rng.magnitude(-1.0, 1.0);
            let away = direction * rng.one(&[0.0, 1.0, 1e3]);
            (Ray::new(from - away, direction), None)
        };
        (0..BUNDLE).map(line).collect()
    }

    /// Compares what a solid with an index answers to eight rays with what one without does. Returns those that
    /// go on to a light, and the number of rays that begin inside.
    fn compare(
        [plain, quick]: [&Shape; 2],
        rays: &[Line],
        (t_max, light): (f64, DVec3),
    ) -> (Vec<Line>, usize) {
        let line = |lane: usize| &rays[lane.min(rays.len() - 1)];
        let of = |part: fn(&Ray) -> DVec3| {
            std::array::from_fn(|axis| std::array::from_fn(|lane| part(&line(lane).0)[axis]))
        };
        let bundle = Bundle::new(of(Ray::origin), of(Ray::direction), [t_max; BUNDLE]);
        let leaving: [_; BUNDLE] = std::array::from_fn(|lane| match &line(lane).1 {
            Some(own) => Leaving::only(own),
            None => Leaving::NOTHING,
        });
        let together = quick.first_of_each(&bundle, &leaving);
        let (mut next, mut inside) = (Vec::new(), 0);
        for lane in 0..BUNDLE {
            let (ray, leaving) = (&line(lane).0, leaving[lane]);
            let [one, other] = [plain, quick].map(|it| asked(it, ray, leaving, t_max));
            assert!(one == other, "{ray:?}, {leaving:?}");
            assert_eq!(together[lane], one.0, "{ray:?}, {leaving:?}");
            inside += usize::from(one.2[1]);
            if let Some(first) = one.0 {
                let at = ContactPoint::vague(ray, first.t);
                assert_eq!(faces(plain, &at), faces(quick, &at), "{ray:?}");
                let at = ray.at(first.t);
                let own = FaceId::of_shape(first.face);
                next.push((Ray::new(at, light - at), Some(own)));
            }
        }
        (next, inside)
    }

    #[test]
    fn an_index_finds_what_the_loop_over_all_parts_does() {
        let mut rng = Rng(0x501d);
        let (pool, isas) = (Pool::new(None), Isa::all());
        let (mut met, mut inside) = (0, 0);
        for _ in 0..cases(CASES) {
            let plain = many(&mut rng);
            let quick = plain.clone();
            let isa = isas[rng.below(isas.len())];
            index_solid(&quick, Builder::new(&pool, isa));
            let parts: Vec<_> = plain.parts().filter_map(Shape::bounds).collect();
            let [plain, quick] = [plain, quick].map(Shape::from);
            for _ in 0..BUNDLES {
                let light = place(&mut rng, &parts) * rng.one(&[1.0, 100.0]);
                let t_max = rng.one(&[f64::INFINITY, f64::INFINITY, 1.0]);
                let all = rays(&mut rng, &parts);
                let (next, begin) = compare([&plain, &quick], &all, (t_max, light));
                inside += begin;
                if !next.is_empty() {
                    met += 1;
                    inside += compare([&plain, &quick], &next, (1.0, light)).1;
                }
            }
        }
        let all = cases(CASES);
        assert!(met > all && inside > all, "{met} {inside}");
    }
}
