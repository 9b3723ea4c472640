//! Comparison of binned shadows with the plain loop, on random worlds.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    accel::{
        bvh::build::Builder,
        index::index_shapes,
        kept::Kept,
        shadow::{
            Casting, Points,
            casters::{Casters, Toward},
            occluders::Occluders,
        },
    },
    parallel::Pool,
    simd::{F64x8, Kernel, LANES, Simd, isa::Isa},
    tracer::{
        color::Color,
        contact::Departure,
        geometry::Geometry,
        material::{Glass, Material},
        radiance::Radiance,
        random::{Rng, cases},
        ray::Ray,
        shape::{
            Extent, Shape,
            any::{any, place_some, unbounded},
            disc::Disc,
            face::{Crossing, FaceId, Leaving},
            plane::Plane,
            sphere::Sphere,
        },
        world::World,
    },
};

/// Number of random worlds; `STRAHL_CASES` overrides it.
const CASES: usize = 200;

/// A point that is not asked for.
const NOTHING: u32 = u32::MAX;

/// Returns random places and sizes, of one of several kinds, about 1 in size.
fn balls(rng: &mut Rng) -> Vec<(DVec3, f64)> {
    let (count, size) = (rng.below(300), rng.magnitude(-3.0, 0.0));
    let one = |rng: &mut Rng, kind: usize| match kind {
        0 | 1 => (rng.vector(), size * (1.001 + rng.signed())),
        // All sizes.
        2 => (rng.vector(), rng.magnitude(-6.0, 1.0)),
        // On a grid: equal, touching and overlapping.
        3 => {
            let mut place = || f64::from(rng.below(5) as u32) * 0.5 - 1.0;
            let center = DVec3::new(place(), place(), place());
            (center, rng.one(&[0.125, 0.25, 0.5]))
        }
        // Nested.
        4 => (rng.vector() * 0.1, rng.magnitude(-2.0, 0.5)),
        // On a floor.
        5 => {
            let radius = 0.02 + 0.1 * rng.signed().abs();
            (DVec3::new(rng.signed(), radius, rng.signed()), radius)
        }
        // Small ones, and large ones around all of them.
        _ => {
            let radius = if rng.below(9) == 0 { 30.0 } else { 0.01 };
            (rng.vector() * radius, radius)
        }
    };
    let kind = rng.below(7);
    (0..count).map(|_| one(rng, kind)).collect()
}

fn world(rng: &mut Rng, scale: f64, offset: DVec3) -> World {
    let mixed = rng.below(3) == 0;
    let glass = rng.one(&[0, 0, 2, 4]);
    let planes = rng.one(&[0, 0, 1, 6]);
    let mut shapes: Vec<Shape> = Vec::new();
    for (center, radius) in balls(rng) {
        let (center, radius) = (center * scale + offset, radius * scale);
        let shape = match mixed {
            true => any(rng, center, radius),
            false => Sphere::new(center, radius).map(Shape::from),
        };
        shapes.extend(shape);
        if rng.below(100) < planes {
            let point = offset + rng.vector() * scale;
            let normal = rng.one(&[DVec3::Y, DVec3::NEG_Y * 2.0, DVec3::ONE]);
            let in_one_plane = [
                Plane::new(point, normal).map(Shape::from),
                Plane::new(point, normal * -0.5).map(Shape::from),
                Disc::new(point, normal, scale).map(Shape::from),
                Disc::new(point, normal * 2.0, scale * 0.5).map(Shape::from),
            ];
            shapes.extend(place_some(
                rng,
                DVec3::ZERO,
                in_one_plane.into_iter().flatten(),
            ));
            if mixed {
                shapes.extend(unbounded(rng, point, scale));
            }
        }
    }
    if rng.below(2) == 0 {
        shapes.extend(Plane::new(offset, DVec3::Y).map(Shape::from));
    }
    if rng.below(9) == 0 {
        let extreme = rng.magnitude(-300.0, 300.0);
        shapes.extend(Sphere::new(rng.vector() * extreme, extreme).map(Shape::from));
    }
    let tint = Color::new(0.5, 0.7, 0.9);
    let geometries = shapes.into_iter().map(|shape| {
        let material = match rng.below(6) < glass {
            true => Glass::new(tint, 1.5).unwrap().into(),
            false => Material::Matte(tint),
        };
        Geometry::new(shape, material)
    });
    World::new(geometries.collect(), Color::BLACK)
}

/// Returns the end of shadow rays: anywhere, on a surface, inside of a shape.
fn toward(rng: &mut Rng, world: &World, scale: f64, offset: DVec3) -> Toward {
    let some = match world.geometries() {
        [] => (offset, scale),
        all => match all[rng.below(all.len())].shape().extent() {
            Extent::Ball(center, radius) if radius.is_finite() => (center, radius),
            Extent::Ball(..) => (offset, scale),
            Extent::Plane(plane) => (plane.point(), scale),
        },
    };
    let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]);
    match rng.below(8) {
        0 => Toward::Direction(rng.vector() * rng.magnitude(-3.0, 3.0)),
        1 => Toward::Direction(axis * rng.magnitude(-60.0, 60.0)),
        2 => Toward::Point(some.0 + axis * some.1),
        3 => Toward::Point(some.0 + rng.vector() * 0.5 * some.1),
        4 => Toward::Point(offset + rng.vector() * scale * rng.magnitude(0.0, 7.0)),
        5 => Toward::Point(offset + DVec3::Y * 3.0 * scale),
        _ => Toward::Point(offset + rng.vector() * 4.0 * scale),
    }
}

/// A point that a camera sees.
struct Seen {
    ray: Ray,
    t: f64,
    /// Where rays begin there; `None` if nothing is asked of it.
    start: Option<Departure>,
}

/// The points that a camera sees, row by row, and some others.
fn points(rng: &mut Rng, world: &World, scale: f64, offset: DVec3) -> Vec<Seen> {
    let mut points = Vec::new();
    let eye = offset + rng.vector() * scale * rng.one(&[0.5, 3.0, 3.0, 3.0, 100.0, 1e5]);
    let away = (eye - offset).length().max(scale);
    let side = rng.one(&[1, 7, 16, 24]);
    let (right, up) = ((eye - offset).normalize_or(DVec3::Z)).any_orthonormal_pair();
    for place in 0..side * side {
        let [x, y] = [place % side, place / side].map(|at| 3.0 * at as f64 / side as f64 - 1.5);
        let mut to = offset + (x * right + y * up) * scale;
        if rng.below(30) == 0 {
            to = rng.vector() * scale * rng.magnitude(-3.0, 9.0);
        }
        let ray = Ray::new(eye, (to - eye) / away);
        let hit = world.hit(&ray).filter(|_| rng.below(9) > 0);
        let start = hit.and_then(|(geometry, hit)| {
            let (t, face) = (hit.t, hit.face);
            let at = (geometry, Crossing { t, face });
            // That it lies on no other face of its geometry is found before.
            let is_alone = world.contact(&ray, at, |_, see| see(geometry)).is_none();
            let contact = world.contact_among_all(&ray, at).map(Arc::new);
            let own = FaceId { geometry, face };
            is_alone.then(|| Departure::at_hit(own, contact, ray.direction()))
        });
        let t = hit.map_or(f64::NAN, |(_, hit)| hit.t);
        points.push(Seen { ray, t, start });
    }
    points
}

/// The kernel that asks for the shadows on points: true for dark ones, false for open ones.
struct Ask<'a> {
    casting: &'a Casting<'a>,
    points: &'a [Seen],
}

impl Kernel for Ask<'_> {
    type Output = Vec<Option<bool>>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Vec<Option<bool>> {
        let (mut found, mut last) = (vec![None; self.points.len()], NOTHING);
        for start in (0..self.points.len()).step_by(LANES) {
            let width = LANES.min(self.points.len() - start);
            let (mut own, mut faces) = ([NOTHING; LANES], [0; LANES]);
            let (mut rays, mut t) = ([[[f64::NAN; LANES]; 3]; 2], [f64::NAN; LANES]);
            let (mut center, mut is_sphere, mut asked) = ([[0.0; LANES]; 3], [0.0; LANES], 0);
            for (lane, seen) in self.points[start..][..width].iter().enumerate() {
                for (to, from) in rays
                    .iter_mut()
                    .zip([seen.ray.origin(), seen.ray.direction()])
                {
                    for (axis, x) in to.iter_mut().zip(from.to_array()) {
                        axis[lane] = x;
                    }
                }
                t[lane] = seen.t;
                let Some(start) = &seen.start else {
                    continue;
                };
                asked |= 1 << lane;
                let FaceId { geometry, face } = start.own();
                (own[lane], faces[lane]) = (geometry as u32, face);
                if let Some(sphere) = self.casting.world.geometries()[geometry].shape().sphere() {
                    is_sphere[lane] = 1.0;
                    for (center, x) in center.iter_mut().zip(sphere.center().to_array()) {
                        center[lane] = x;
                    }
                }
            }
            let load = |x: [[f64; LANES]; 3]| x.each_ref().map(|x| simd.load(x));
            let (rays, t) = (rays.map(load), simd.load(&t));
            let at = [0, 1, 2].map(|axis| rays[0][axis] + t * rays[1][axis]);
            let points = Points {
                at,
                own: &own,
                faces: &faces,
                center: load(center),
                is_sphere: simd.splat(0.0).lt(simd.load(&is_sphere)),
                rays: (rays, t),
                asked,
                most: Points::most_of(simd, asked, [at, rays[0]]),
            };
            let shadows = self.casting.meet(simd, &points, &mut last);
            for lane in 0..width {
                let is = |lanes: u8| lanes >> lane & 1 == 1;
                found[start + lane] = match (is(shadows.dark), is(shadows.open)) {
                    (true, _) => Some(true),
                    (_, true) => Some(false),
                    _ => None,
                };
            }
        }
        found
    }
}

/// Returns true if a geometry that casts shadows is in the way.
fn is_dark(
    world: &World,
    casters: Casters,
    toward: Toward,
    start: &Departure,
    point: DVec3,
) -> bool {
    let (ray, t_max) = (toward.ray(point), toward.t_max());
    let at_origin = world.at_origin(&ray, start);
    let mut all = world.geometries().iter().enumerate();
    at_origin.is_some_and(|passed| casters.hold(&world.geometries()[passed.face.geometry]))
        || all.any(|(index, geometry)| {
            let leaving = Leaving::of(start.left(), index);
            casters.hold(geometry) && geometry.shape().meet(&ray, leaving, t_max).is_some()
        })
}

#[test]
fn every_point_agrees_with_the_plain_loop() {
    let mut rng = Rng(1119);
    let (mut dark, mut asked, mut open) = (0, 0, 0);
    for case in 0..cases(CASES) {
        let scale = match rng.below(3) {
            0 => rng.magnitude(-6.0, 8.0),
            _ => 1.0,
        };
        let offset = match rng.below(3) {
            0 => rng.vector() * scale * rng.magnitude(0.0, 7.0),
            _ => DVec3::ZERO,
        };
        let world = world(&mut rng, scale, offset);
        let toward = toward(&mut rng, &world, scale, offset);
        let casters = rng.one(&[Casters::Opaque, Casters::Opaque, Casters::Glass]);
        let size = scale * rng.magnitude(0.0, 4.0);
        let far = [offset - size, offset + size];
        let others = rng.one(&[Occluders::NOWHERE, far]);
        let points = points(&mut rng, &world, scale, offset);
        let expected = points.iter().map(|seen| {
            let start = seen.start.as_ref();
            start.is_some_and(|it| is_dark(&world, casters, toward, it, seen.ray.at(seen.t)))
        });
        let expected: Vec<_> = expected.collect();
        let pool = Pool::new(Some(rng.one(&[1, 3])));
        let indexed = world.without_indices();
        index_shapes(indexed.geometries(), Builder::new(&pool, Isa::best()));
        let frames = Kept::of_some(&indexed, &mut Rng(case as u64 + 1));
        let kept = frames.as_ref().map(|(kept, other)| {
            let builder = Builder::new(&pool, Isa::best());
            let _ = Casting::new((other, Some(kept)), casters, (0, toward), others, builder);
            kept
        });
        let frames = kept.map(|kept| (Isa::best(), Some(kept)));
        let alone = Isa::all().into_iter().map(|isa| (isa, None));
        for (isa, kept) in alone.chain(frames) {
            let (world, builder) = ((&indexed, kept), Builder::new(&pool, isa));
            let Some(casting) = Casting::new(world, casters, (0, toward), others, builder) else {
                assert!(!expected.contains(&true));
                continue;
            };
            let found = isa.run(Ask {
                casting: &casting,
                points: &points,
            });
            for (place, found) in found.into_iter().enumerate() {
                let is_right = match found {
                    Some(true) => expected[place],
                    // Open.
                    Some(false) => points[place].start.is_some(),
                    None => !expected[place],
                };
                let Seen { ray, t, start } = &points[place];
                assert!(
                    is_right,
                    "case {case}, {}, {kept:?}: {ray:?} at {t} is {found:?}, {start:?} to {toward:?} in {indexed:?}",
                    isa.name(),
                );
                asked += usize::from(start.is_some());
                dark += usize::from(found == Some(true));
                open += usize::from(found == Some(false));
            }
        }
    }
    assert!(dark * 10 > asked, "only {dark} of {asked} points are dark");
    assert!(open * 5 < asked, "{open} of {asked} points are open");
}

#[test]
fn a_dark_point_lets_no_light_through() {
    let mut rng = Rng(7);
    for _ in 0..cases(CASES) / 20 {
        let world = world(&mut rng, 1.0, DVec3::ZERO);
        let toward = toward(&mut rng, &world, 1.0, DVec3::ZERO);
        for Seen { ray, t, start } in points(&mut rng, &world, 1.0, DVec3::ZERO) {
            if let Some(start) = start {
                let point = ray.at(t);
                let (ray, t_max) = (toward.ray(point), toward.t_max());
                let transmission = world.transmission(&ray, t_max, &start);
                let has_glass = || world.geometries().iter().any(|it| it.has_glass());
                match is_dark(&world, Casters::Opaque, toward, &start, point) {
                    true => assert_eq!(transmission, Radiance::BLACK),
                    false => assert!(transmission == Radiance::WHITE || has_glass()),
                }
            }
        }
    }
}
