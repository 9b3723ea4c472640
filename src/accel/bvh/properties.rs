//! Comparison of the tree with the plain loop, on random worlds and all kinds of awkward rays.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    accel::{
        bvh::{Bvh, Hierarchy, build::Builder},
        kept::Kept,
    },
    parallel::{Cancel, Pool},
    simd::isa::Isa,
    tracer::{
        color::Color,
        contact::Departure,
        geometry::Geometry,
        hit::Hit,
        material::{Glass, Material},
        radiance::Radiance,
        random::{Rng, cases},
        ray::Ray,
        shape::{
            Extent, Shape,
            any::{any, place_some, unbounded},
            face::{Crossing, FaceId},
            plane::Plane,
            sphere::Sphere,
        },
        world::World,
    },
};

/// Number of random worlds; `STRAHL_CASES` overrides it.
const CASES: usize = 1500;
/// Number of rays for each world.
const RAYS: usize = 40;

/// Numbers that may break a formula.
const AWKWARD: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    3.0,
    f64::MIN_POSITIVE,
    5e-324,
    -2e-310,
    1e-160,
    1e155,
    -1e200,
    f64::MAX,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Returns a random world: one of several kinds, at some place.
fn world(rng: &mut Rng) -> World {
    let mixed = rng.below(2) == 0;
    let places: Vec<(DVec3, f64)> = match rng.below(12) {
        0 => Vec::new(),
        1 => vec![(rng.vector(), rng.magnitude(-12.0, 12.0))],
        // Random positions, from one leaf to several levels.
        2..=4 => {
            let (count, size) = (rng.below(400), rng.magnitude(-3.0, 0.0));
            let ball = |rng: &mut Rng| (rng.vector(), size * (1.001 + rng.signed()));
            (0..count).map(|_| ball(rng)).collect()
        }
        // All sizes.
        5 => {
            let count = rng.below(200);
            let ball = |rng: &mut Rng| {
                let reach = rng.magnitude(-6.0, 12.0);
                (rng.vector() * reach, rng.magnitude(-12.0, 12.0))
            };
            (0..count).map(|_| ball(rng)).collect()
        }
        // On a grid, many of them twice: exact ties.
        6 | 7 => {
            let place = |rng: &mut Rng| f64::from(rng.below(4) as u32);
            let ball = |rng: &mut Rng| {
                let center = DVec3::new(place(rng), place(rng), place(rng));
                (center, rng.one(&[0.25, 0.5, 1.0]))
            };
            (0..rng.below(150)).map(|_| ball(rng)).collect()
        }
        // Shells around small spheres.
        8 => {
            let ball = |rng: &mut Rng| match rng.below(5) {
                0 => (rng.vector(), rng.magnitude(0.0, 8.0)),
                _ => (rng.vector(), 0.05),
            };
            (0..100).map(|_| ball(rng)).collect()
        }
        // All at one point.
        9 => {
            let (center, count) = (rng.vector(), rng.below(60));
            let radius = |rng: &mut Rng| rng.one(&[0.1, 0.3, 0.3, 0.7]);
            (0..count).map(|_| (center, radius(rng))).collect()
        }
        // Each at half the distance of the previous one: the deepest possible tree.
        10 => {
            let ball = |i: i32| (DVec3::X * libm::ldexp(1.0, -i), libm::ldexp(0.3, -i));
            (0..300).map(ball).collect()
        }
        // Too large for products.
        _ => {
            let size = |rng: &mut Rng| {
                let (low, high) = rng.one(&[(-307.0, 300.0), (-60.0, -40.0), (40.0, 60.0)]);
                rng.magnitude(low, high)
            };
            let ball = |rng: &mut Rng| (rng.vector() * size(rng), size(rng));
            (0..50).map(|_| ball(rng)).collect()
        }
    };
    let offset = match rng.below(3) {
        0 => rng.vector() * rng.magnitude(0.0, 15.0),
        _ => DVec3::ZERO,
    };
    let mut geometries: Vec<Geometry> = Vec::new();
    for (center, radius) in places {
        if rng.below(40) == 0 {
            let plane = Plane::new(offset + rng.vector(), rng.vector() + DVec3::Z);
            let planes = place_some(rng, offset, plane.map(Shape::from));
            geometries.extend(planes.into_iter().map(|it| Geometry::new(it, Color::WHITE)));
        }
        let shape = match mixed {
            true => any(rng, center + offset, radius),
            false => Sphere::new(center + offset, radius).map(Shape::from),
        };
        geometries.extend(shape.map(|shape| Geometry::new(shape, Color::WHITE)));
        if mixed && rng.below(60) == 0 {
            let shape = unbounded(rng, center + offset, radius);
            geometries.extend(shape.map(|shape| Geometry::new(shape, Color::WHITE)));
        }
    }
    if geometries.is_empty() && rng.below(2) == 0 {
        geometries.extend(Plane::new(offset, DVec3::Y).map(|it| Geometry::new(it, Color::WHITE)));
    }
    World::new(geometries, Color::BLACK)
}

/// Returns a ray at or near a sphere of the world, if there is one.
fn ray(rng: &mut Rng, world: &World) -> Ray {
    let (center, radius) = match world.geometries() {
        [] => (DVec3::ZERO, 1.0),
        some => match some[rng.below(some.len())].shape().extent() {
            Extent::Ball(center, radius) if radius.is_finite() => (center, radius),
            Extent::Ball(..) => (DVec3::ZERO, 1.0),
            Extent::Plane(plane) => (plane.point(), 1.0),
        },
    };
    let axis = rng.one(&[DVec3::X, DVec3::Y, DVec3::Z]) * rng.one(&[1.0, -1.0]);
    let away = rng.vector();
    let origin = match rng.below(9) {
        0 => center,
        1 => center + axis * radius,
        2 => center + away * radius,
        3 => rng.vector(),
        4 => center + away * rng.magnitude(-3.0, 3.0),
        5 => center + away * radius * rng.magnitude(0.0, 9.0),
        6 => center + away * rng.magnitude(3.0, 9.0),
        7 => center + axis * rng.one(&[2.0, 1e5, 1e7, 1e9, 1e15, 1e60, 1e300]),
        _ => DVec3::new(rng.one(&AWKWARD), rng.signed(), rng.one(&AWKWARD)),
    };
    let to = center - origin;
    let direction = match rng.below(8) {
        0 => rng.vector(),
        1 => axis,
        2 => DVec3::new(rng.one(&AWKWARD), rng.one(&AWKWARD), rng.one(&AWKWARD)),
        3 => to,
        // At its edge, as close as rounding can distinguish, and a little beyond.
        _ => {
            let aside = to.cross(rng.vector());
            let widened = radius + rng.one(&[0.0, 1e-9, 3e-8, 1e-7]) * to.length() * rng.signed();
            to + aside * (widened / aside.length())
        }
    };
    let length = match rng.below(6) {
        0 => rng.magnitude(-30.0, 30.0),
        1 => rng.magnitude(-300.0, 300.0),
        2 => 1.0,
        _ => 1.0 / direction.length(),
    };
    Ray::new(origin, direction * length)
}

/// Returns a `t_max`: any number, or one close to a hit.
fn t_max(rng: &mut Rng, t: Option<f64>) -> f64 {
    match (rng.below(6), t) {
        (0, Some(t)) => t,
        (1, Some(t)) => t.next_up(),
        (2, Some(t)) => t.next_down(),
        (3, Some(t)) => t * rng.magnitude(-1.0, 1.0),
        (4, _) => rng.one(&AWKWARD),
        _ => rng.magnitude(-9.0, 9.0),
    }
}

/// Returns everything that must be equal: the index and all bits of the hit.
fn bits(nearest: Option<(usize, Hit<'_>)>) -> Option<(usize, bool, Vec<u64>)> {
    nearest.map(|(index, hit)| {
        let numbers = [hit.point.to_array(), hit.normal.to_array(), [hit.t; 3]];
        let bits = numbers.as_flattened().iter().map(|x| x.to_bits());
        (index, hit.front_face, bits.collect())
    })
}

#[test]
fn every_ray_that_leaves_a_surface_agrees_with_the_plain_loop() {
    let mut rng = Rng(19);
    let isas = Isa::all();
    let (mut hits, mut tinted, mut alone) = (0, 0, 0);
    for case in 0..cases(CASES) {
        let bare = world(&mut rng);
        let glass = rng.one(&[0, 2, 2, 5]);
        let tint = Color::new(0.5, 0.7, 0.9);
        let geometries = bare.geometries().iter().map(|geometry| {
            let mut material = || match rng.below(6) < glass {
                true => Glass::new(tint, 1.5).unwrap().into(),
                false => Material::Matte(tint),
            };
            let faces = [material(), material()];
            Geometry::new(geometry.shape().clone(), material()).by_face(faces)
        });
        let world = World::new(geometries.collect(), Color::BLACK);
        if world.geometries().is_empty() {
            continue;
        }
        let pool = Pool::new(Some(1));
        let indexed = world.without_indices();
        let trees = isas
            .iter()
            .map(|isa| Hierarchy::new((&indexed, None), Builder::new(&pool, *isa)));
        let mut trees: Vec<_> = trees.collect();
        if let Some((kept, other)) = Kept::of_some(&indexed, &mut Rng(case as u64 + 1)) {
            let builder = Builder::new(&pool, isas[case % isas.len()]);
            Hierarchy::new((&other, Some(&kept)), builder);
            trees.push(Hierarchy::new((&indexed, Some(&kept)), builder));
        }
        for _ in 0..RAYS {
            let mut ray = ray(&mut rng, &world);
            let arriving = ray.direction();
            let geometry = rng.below(world.geometries().len());
            let mut own = FaceId { geometry, face: 0 };
            let (mut contact, mut unknown) = (None, None);
            // Mostly from a surface, inwards and outwards.
            if let Some((index, hit)) = world.hit(&ray).filter(|_| rng.below(4) > 0) {
                (own.geometry, own.face) = (index, hit.face);
                let (t, face) = (hit.t, hit.face);
                unknown = Some(Departure::unknown(own, &ray, t));
                contact = world.contact_among_all(&ray, (index, Crossing { t, face }));
                let length = rng.magnitude(-2.0, 2.0);
                ray = Ray::new(hit.point, rng.vector() * length);
            }
            let t_max = rng.one(&[f64::INFINITY, 1.0, 1.0 - 2e-10]);
            let start = Departure::at_hit(own, contact.map(Arc::new), arriving);
            let nearest = world.nearest(&ray, f64::INFINITY, start.left());
            let bits_of = |(index, Crossing { t, face })| (index, face, t.to_bits());
            let nearest = nearest.map(bits_of);
            let through = world.transmission(&ray, t_max, &start);
            hits += usize::from(nearest.is_some());
            tinted += usize::from(![Radiance::BLACK, Radiance::WHITE].contains(&through));
            for tree in &trees {
                let place = format!("case {case}, {}: {ray:?} from {own:?}", tree.isa.name());
                let found = tree.nearest_before(&indexed, &ray, f64::INFINITY, start.left());
                assert_eq!(found.map(bits_of), nearest, "{place} in {world:?}");
                let found = tree.transmission(&indexed, &ray, t_max, &start);
                let bits = |light: Radiance| light.channels.map(f64::to_bits);
                assert_eq!(bits(found), bits(through), "{place}, {t_max} in {world:?}");
                // Without knowing on how many faces it begins.
                let Some(unknown) = &unknown else {
                    continue;
                };
                if let Some(found) = tree.nearest_alone(&indexed, &ray, unknown) {
                    assert_eq!(found.map(bits_of), nearest, "{place} in {world:?}");
                    alone += 1;
                }
                if let Some(found) = tree.transmission_alone(&indexed, &ray, t_max, unknown) {
                    assert_eq!(bits(found), bits(through), "{place}, {t_max} in {world:?}");
                }
            }
        }
    }
    assert!(hits > cases(CASES) * RAYS / 10, "only {hits} hits");
    assert!(tinted > cases(CASES), "only {tinted} rays go through glass");
    assert!(
        alone > cases(CASES),
        "only {alone} rays are known to leave one face"
    );
}

#[test]
fn every_ray_agrees_with_the_plain_loop() {
    let mut rng = Rng(2026);
    let isas = Isa::all();
    let mut hits = 0;
    for case in 0..cases(CASES) {
        let world = world(&mut rng);
        let indexed = Arc::new(world.without_indices());
        let pool = Pool::new(Some(rng.one(&[1, 3])));
        let trees: Vec<Bvh> = isas
            .iter()
            .map(|isa| Bvh::build(indexed.clone(), &pool, *isa))
            .collect();
        for _ in 0..RAYS {
            let ray = ray(&mut rng, &world);
            let expected = bits(world.hit(&ray));
            hits += usize::from(expected.is_some());
            let t_max = t_max(&mut rng, world.hit(&ray).map(|(_, hit)| hit.t));
            let nearer = bits(world.hit(&ray).filter(|(_, hit)| hit.t < t_max));
            for tree in &trees {
                let place = format!(
                    "case {case}, {}: {ray:?}, {t_max:?}",
                    tree.hierarchy.isa.name()
                );
                let all = bits(tree.nearest(&ray, f64::INFINITY));
                assert_eq!(all, expected, "{place} in {world:?}");
                let found = bits(tree.nearest(&ray, t_max));
                assert_eq!(found, nearer, "{place} in {world:?}");
                let occluded = tree.occluded(&ray, t_max);
                assert_eq!(occluded, nearer.is_some(), "{place} in {world:?}");
            }
        }
    }
    assert!(hits > cases(CASES) * RAYS / 10, "only {hits} hits");
}

#[test]
fn any_number_of_threads_gives_the_same_hits() {
    let mut rng = Rng(99);
    let ball = |rng: &mut Rng| {
        let sphere = Sphere::new(rng.vector(), 0.02 + 0.01 * rng.signed()).unwrap();
        Geometry::new(sphere, Color::WHITE)
    };
    // More than a single thread takes at once.
    let world = World::new((0..40_000).map(|_| ball(&mut rng)).collect(), Color::BLACK);
    let world = Arc::new(world);
    let trees = [1, 2, 3, 16].map(|threads| Bvh::with_threads(world.clone(), threads).unwrap());
    for _ in 0..100 {
        let ray = Ray::new(rng.vector(), rng.vector());
        let expected = world.hit(&ray);
        for tree in &trees {
            assert_eq!(tree.nearest(&ray, f64::INFINITY), expected, "{ray:?}");
        }
    }
    let away = Ray::new(DVec3::ONE * 2.0, DVec3::ONE);
    assert_eq!(trees[0].nearest(&away, f64::INFINITY), None);
}

#[test]
fn a_cancelled_hierarchy_has_the_hits_of_the_loop() {
    let ball = |place: u32| {
        let center = DVec3::new(f64::from(place), f64::from(place % 7), -9.0);
        Geometry::new(Sphere::new(center, 1.0).unwrap(), Color::WHITE)
    };
    let world = World::new((0..300).map(ball).collect(), Color::BLACK);
    let (pool, cancel) = (Pool::new(Some(2)), Cancel::new());
    let builder = Builder {
        cancel: Some(&cancel),
        ..Builder::new(&pool, Isa::best())
    };
    let whole = Hierarchy::new((&world, None), builder);
    assert!(whole.shapes().count() == 1 && whole.apart.is_empty());
    cancel.cancel();
    let none = Hierarchy::new((&world, None), builder);
    assert_eq!((none.shapes().count(), none.apart.len()), (0, 300));
    let ray = Ray::new(DVec3::new(3.0, 3.0, 0.0), DVec3::NEG_Z);
    let own = FaceId {
        geometry: 0,
        face: 0,
    };
    let found =
        [&whole, &none].map(|tree| tree.nearest_before(&world, &ray, f64::INFINITY, &[own]));
    assert!(found[0].is_some() && found[0] == found[1]);
}
