//! Comparison with the plain loop: no pixel may differ in any scene.

use std::{iter, ops::Range};

use glam::DVec3;

use crate::{
    accel::{
        kept::Kept,
        lanes::Divide,
        raster::{
            first_hits::{FirstHits, Work, cut},
            rays::Parallel,
        },
    },
    film::{
        Centers, Film, Run, Wanted,
        colors::NOTHING,
        resolve::{Resolved, Resolver},
        samples::Samples,
        size::Size,
    },
    parallel::{
        Cancel, Pool,
        timings::{Stage, Timings},
    },
    simd::{F64x8, Kernel, LANES, Simd, isa::Isa},
    tracer::{
        camera::{Camera, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
        color::Color,
        geometry::Geometry,
        random::{Rng, cases},
        shape::{
            Extent,
            any::{any, place_some, unbounded},
            disc::Disc,
            face::Crossing,
            plane::Plane,
            sphere::Sphere,
        },
        world::World,
    },
};

fn ball(center: DVec3, radius: f64) -> Geometry {
    Geometry::new(Sphere::new(center, radius).unwrap(), Color::WHITE)
}

fn disc(center: DVec3, normal: DVec3, radius: f64) -> Geometry {
    Geometry::new(Disc::new(center, normal, radius).unwrap(), Color::WHITE)
}

fn wall(point: DVec3, normal: DVec3) -> Geometry {
    Geometry::new(Plane::new(point, normal).unwrap(), Color::WHITE)
}

/// Returns the geometry of each pixel by the plain loop.
fn plain(camera: &Camera, world: &World, size: Size) -> Vec<u32> {
    plain_hits(camera, &world.without_indices(), size)
        .iter()
        .map(|(id, _)| *id)
        .collect()
}

/// Returns the geometry and the bits of t for each pixel by the plain loop.
fn plain_hits(camera: &Camera, world: &World, size: Size) -> Vec<(u32, u64)> {
    let (width, height) = (size.width(), size.height());
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let seen = pixels.map(|(column, row)| {
        let y = f64::from(height - 1 - row);
        let ray = camera.ray_for(width, height, column.into(), y);
        let nearest = world.nearest(&ray, f64::INFINITY, &[]);
        nearest.map_or(
            (NOTHING, f64::INFINITY.to_bits()),
            |(index, Crossing { t, face })| (world.id_of(index, face) as u32, t.to_bits()),
        )
    });
    seen.collect()
}

/// Returns the fast result for a rectangle of the picture.
fn part(
    hits: &FirstHits,
    columns: Range<u32>,
    rows: Range<u32>,
    (pool, kept): (&Pool, Option<&Kept>),
) -> Vec<u32> {
    let mut indices = Vec::new();
    let centers = (Centers::Unneeded, kept);
    draw(hits, columns, rows, pool, centers, |run| {
        indices.extend(run.pixels)
    });
    indices
}

/// Calls `each` with the runs of a rectangle of the picture.
fn draw(
    hits: &FirstHits,
    columns: Range<u32>,
    rows: Range<u32>,
    pool: &Pool,
    (centers, kept): (Centers, Option<&Kept>),
    mut each: impl FnMut(Run),
) {
    let (timings, world) = (Timings::new(), World::default());
    let work = Work {
        pool,
        cancel: &Cancel::new(),
        progress: None,
        watch: &timings.shared_watch(Stage::Trace),
        kept,
        resolver: Resolver::new(&world),
        centers,
        wanted: Wanted::Hits,
    };
    let mut take = |film: Film| {
        assert_eq!(film.width(), columns.len());
        film.runs().for_each(&mut each);
        Ok(())
    };
    hits.draw(columns.clone(), rows, work, &mut take).unwrap();
}

/// Returns the fast result, drawn in slabs of this many rows.
fn fast(camera: &Camera, world: &World, size: Size, isa: Isa, pool: &Pool, rows: u32) -> Vec<u32> {
    let hits = FirstHits::new(camera, world, size, Samples::ONE, isa);
    let slabs = cut(0..size.height(), rows);
    slabs
        .flat_map(|rows| part(&hits, 0..size.width(), rows, (pool, None)))
        .collect()
}

/// Compares the two on all instruction sets; returns the number of pixels that see a geometry.
fn check(name: &str, camera: &Camera, world: &World, width: u32, height: u32) -> usize {
    let size = Size::new(width, height).unwrap();
    let expected = plain(camera, world, size);
    for isa in Isa::all() {
        for rows in [16, 48, 1 << 15] {
            let found = fast(camera, world, size, isa, &Pool::Calling, rows);
            let wrong = (0..expected.len()).find(|at| expected[*at] != found[*at]);
            if let Some(at) = wrong {
                let all = (0..expected.len()).filter(|at| expected[*at] != found[*at]);
                panic!(
                    "{name}, {} in slabs of {rows} rows: {} of {} pixels differ, the first at \
                     {}, {}: expected {}, found {}\n{camera:?}\n{:?}",
                    isa.name(),
                    all.count(),
                    expected.len(),
                    at as u32 % width,
                    at as u32 / width,
                    expected[at],
                    found[at],
                    world.geometries().get(expected[at].min(found[at]) as usize),
                );
            }
        }
    }
    if let Some((kept, other)) = Kept::of_some(world, &mut Rng(world.geometries().len() as u64 + 1))
    {
        let found = [&other, world].map(|world| {
            let hits = FirstHits::new(camera, world, size, Samples::ONE, Isa::best());
            part(&hits, 0..width, 0..height, (&Pool::Calling, Some(&kept)))
        });
        assert!(
            found[1] == expected,
            "{name}, after another frame: {camera:?} {kept:?}"
        );
    }
    check_hits(name, camera, world, size);
    check_samples(name, camera, world, size);
    expected.iter().filter(|index| **index != NOTHING).count()
}

/// Compares the hits of center rays with the plain loop, bit for bit, for any number of samples.
fn check_hits(name: &str, camera: &Camera, world: &World, size: Size) {
    let expected = plain_hits(camera, &world.without_indices(), size);
    for (isa, samples) in Isa::all().into_iter().zip([1, 4, 9].into_iter().cycle()) {
        let hits = FirstHits::new(camera, world, size, Samples::new(samples).unwrap(), isa);
        let mut found = Vec::new();
        let (columns, rows) = (0..size.width(), 0..size.height());
        let centers = (Centers::Hits, None);
        draw(&hits, columns, rows, &Pool::Calling, centers, |run| {
            let bits = run.t.iter().map(|t| t.to_bits());
            found.extend(run.ids.iter().copied().zip(bits));
        });
        let wrong = (0..expected.len()).find(|at| expected[*at] != found[*at]);
        assert_eq!(wrong, None, "{name}, {isa}, {samples} samples: {camera:?}");
    }
}

/// The geometries that the samples of a pixel see.
#[derive(Debug, PartialEq)]
enum Seen {
    One(u32),
    Several(Resolved),
}

/// Compares the samples with the plain loop on all instruction sets.
fn check_samples(name: &str, camera: &Camera, world: &World, size: Size) {
    // Each geometry has its own color, so that the order of the samples matters.
    let color = |index: usize| Color::new((index % 97) as f64 / 97.0, 0.3, index as f64 / 1e3);
    let geometries = world.geometries().iter().enumerate();
    let colored =
        geometries.map(|(index, geometry)| Geometry::new(geometry.shape().clone(), color(index)));
    let world = &World::new(colored.collect(), Color::BLACK);
    let resolver = Resolver {
        ranks: true,
        ..Resolver::new(world)
    };
    let samples = Samples::new([4, 9, 16, 64][(name.len() + size.width() as usize) % 4]).unwrap();
    let rows = 0..size.height().min(2048 / size.width() + 1);
    let plain = world.without_indices();
    let expected = plain_samples(camera, &plain, size, samples, rows.clone(), resolver);
    let frames = Kept::of_some(world, &mut Rng(u64::from(size.width()) + 1));
    let kept = frames.as_ref().map(|(kept, other)| {
        let hits = FirstHits::new(camera, other, size, samples, Isa::best());
        let resolver = Resolver {
            world: other,
            ..resolver
        };
        let pool = (&Pool::Calling, Some(kept));
        seen(&hits, 0..size.width(), rows.clone(), pool, resolver);
        (Isa::best(), Some(kept))
    });
    let alone = Isa::all().into_iter().map(|isa| (isa, None));
    for (isa, kept) in alone.chain(kept) {
        let hits = FirstHits::new(camera, world, size, samples, isa);
        let pool = (&Pool::Calling, kept);
        let found = seen(&hits, 0..size.width(), rows.clone(), pool, resolver);
        let wrong = (0..expected.len()).find(|at| expected[*at] != found[*at]);
        if let Some(at) = wrong {
            panic!(
                "{name}, {}, {samples:?}: {} pixels differ, the first at {}, {}: expected {:?}, found {:?}\n{camera:?}",
                isa.name(),
                (0..expected.len())
                    .filter(|at| expected[*at] != found[*at])
                    .count(),
                at as u32 % size.width(),
                at as u32 / size.width(),
                expected[at],
                found[at],
            );
        }
    }
}

/// Returns the result of the plain loop for samples.
fn plain_samples(
    camera: &Camera,
    world: &World,
    size: Size,
    samples: Samples,
    rows: Range<u32>,
    resolver: Resolver,
) -> Vec<Seen> {
    let (width, height) = (size.width(), size.height());
    let pixels = rows.flat_map(|row| (0..width).map(move |column| (column, row)));
    let n = f64::from(samples.side());
    let pixels = pixels.map(|(column, row)| {
        let mut seen = Vec::new();
        for j in 0..samples.side() {
            for i in 0..samples.side() {
                let x = f64::from(column) + (f64::from(i) + 0.5) / n - 0.5;
                let y = f64::from(height - 1 - row) + (f64::from(j) + 0.5) / n - 0.5;
                let nearest =
                    world.nearest(&camera.ray_for(width, height, x, y), f64::INFINITY, &[]);
                let id = |(index, met): (usize, Crossing)| world.id_of(index, met.face) as u32;
                seen.push(nearest.map_or(NOTHING, id));
            }
        }
        if seen.iter().all(|index| *index == seen[0]) {
            return Seen::One(seen[0]);
        }
        let mut resolved = resolver.resolve(&seen, iter::once(seen.len()));
        Seen::Several(resolved.next().unwrap())
    });
    pixels.collect()
}

/// Returns the fast result for a rectangle of the picture.
fn seen(
    hits: &FirstHits,
    columns: Range<u32>,
    rows: Range<u32>,
    (pool, kept): (&Pool, Option<&Kept>),
    resolver: Resolver,
) -> Vec<Seen> {
    let mut found = Vec::new();
    let timings = Timings::new();
    let work = Work {
        pool,
        cancel: &Cancel::new(),
        progress: None,
        watch: &timings.shared_watch(Stage::Trace),
        kept,
        resolver,
        centers: Centers::Unneeded,
        wanted: Wanted::Hits,
    };
    let mut take = |film: Film| {
        for run in film.runs() {
            found.extend(run.pixels.iter().map(|index| match run.resolved(*index) {
                Some(resolved) => Seen::Several(resolved.clone()),
                None => Seen::One(*index),
            }));
        }
        Ok(())
    };
    hits.draw(columns, rows, work, &mut take).unwrap();
    found
}

/// Returns a random picture size, small enough for the plain loop.
fn size(random: &mut Rng) -> (u32, u32) {
    random.one(&[
        (1, 1),
        (1, 40),
        (40, 1),
        (33, 17),
        (64, 48),
        (16, 16),
        (15, 31),
        (200, 16),
    ])
}

fn camera(random: &mut Rng, eye: DVec3, gaze: DVec3, scale: f64) -> Camera {
    let up = loop {
        let up = random.one(&[DVec3::Y, DVec3::X, DVec3::Z, DVec3::ONE]);
        if PerspectiveCamera::new(eye, gaze, up, 0.5).is_ok() {
            break up;
        }
        random.next();
    };
    match random.below(4) {
        0 => OrthographicCamera::new(eye, gaze, up, scale)
            .unwrap()
            .into(),
        1 => OrthographicCamera::with_square_pixels(eye, gaze, up, scale)
            .unwrap()
            .into(),
        _ => {
            let half_angle = random.one(&[0.1, 0.4, 0.7, 1.0, 1.4]);
            PerspectiveCamera::new(eye, gaze, up, half_angle)
                .unwrap()
                .into()
        }
    }
}

/// Returns a sphere, or a shape of any kind.
fn some(random: &mut Rng, mixed: bool, center: DVec3, size: f64) -> Geometry {
    match mixed {
        true => {
            let shape = match random.below(40) {
                0 => unbounded(random, center, size),
                _ => any(random, center, size),
            };
            Geometry::new(shape.unwrap(), Color::WHITE)
        }
        false => ball(center, size),
    }
}

/// Returns a world of shapes in a cube around `middle`, sometimes with planes among them.
fn crowd(random: &mut Rng, middle: DVec3, size: f64, radii: (f64, f64)) -> World {
    let count = random.one(&[0, 1, 2, 9, 60, 200]);
    let mixed = random.below(2) == 0;
    let mut geometries: Vec<Geometry> = (0..count)
        .map(|_| {
            let center = middle + random.vector() * size;
            let size = size * random.magnitude(radii.0, radii.1);
            some(random, mixed, center, size)
        })
        .collect();
    for _ in 0..random.one(&[0, 0, 1, 2, 5]) {
        let normal = random.one(&[DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::new(0.1, 1.0, 0.3)]);
        let plane = wall(
            middle + random.vector() * size,
            normal * random.magnitude(-3.0, 3.0),
        );
        let at = random.below(geometries.len() + 1);
        for shape in place_some(random, middle, [plane.shape().clone()]) {
            geometries.insert(at, Geometry::new(shape, Color::WHITE));
        }
    }
    // Exact ties: the same geometries again, and elsewhere in the list.
    for _ in 0..random.one(&[0, 0, 7]) {
        if !geometries.is_empty() {
            let again = geometries[random.below(geometries.len())].clone();
            let at = random.below(geometries.len() + 1);
            geometries.insert(at, again);
        }
    }
    World::new(geometries, Color::BLACK)
}

/// Runs `case` for many seeds.
fn many(cases_each: usize, mut case: impl FnMut(&mut Rng, u64) -> usize) {
    let seen: usize = (0..(cases(cases_each * 100) / 100) as u64)
        .map(|seed| case(&mut Rng(seed.wrapping_mul(0x1234_5677) | 1), seed))
        .sum();
    assert!(seen > 1000, "only {seen} pixels see anything");
}

#[test]
fn many_spheres_in_front_of_the_camera() {
    many(60, |random, seed| {
        let middle = DVec3::new(0.0, 0.0, -4.0);
        let world = crowd(random, middle, 1.5, (-2.5, -0.3));
        let camera = camera(random, DVec3::ZERO, DVec3::NEG_Z, 3.0);
        let (width, height) = size(random);
        check(&format!("crowd {seed}"), &camera, &world, width, height)
    });
}

#[test]
fn the_camera_among_many_spheres() {
    many(60, |random, seed| {
        let world = crowd(random, DVec3::ZERO, 1.0, (-2.0, -0.2));
        // In the middle, on a surface, and in the center of a sphere.
        let eye = match (random.below(3), world.geometries().first()) {
            (0, Some(first)) => match first.shape().extent() {
                Extent::Ball(center, radius) if radius.is_finite() => {
                    center + radius * random.one(&[DVec3::X, DVec3::ZERO, DVec3::NEG_Z])
                }
                Extent::Plane(plane) => plane.point(),
                Extent::Ball(..) => DVec3::ZERO,
            },
            _ => random.vector(),
        };
        let gaze = random.vector();
        let camera = camera(random, eye, gaze, 1.0);
        let (width, height) = size(random);
        check(&format!("inside {seed}"), &camera, &world, width, height)
    });
}

#[test]
fn far_from_the_origin_and_far_away() {
    many(80, |random, seed| {
        let offset = random.vector() * random.magnitude(0.0, 9.0);
        let world = crowd(random, offset, 1.0, (-2.0, -0.3));
        let distance = random.magnitude(0.0, 9.0);
        let gaze = random.vector();
        let eye = offset - gaze * distance;
        let half_angle = (1.0 / distance).min(1.2);
        let camera = match random.below(2) {
            0 => camera(random, eye, gaze, 2.5),
            _ => PerspectiveCamera::new(eye, gaze, DVec3::new(0.3, 1.0, 0.2), half_angle)
                .unwrap()
                .into(),
        };
        let (width, height) = size(random);
        check(&format!("far {seed}"), &camera, &world, width, height)
    });
}

// The point of a disc is o + t·d as it is rounded, which may lie well beside the disc.
#[test]
fn points_that_round_beyond_their_shape() {
    many(40, |random, seed| {
        let eye = random.vector() * random.magnitude(9.0, 16.0);
        let shapes = (0..40).map(|_| {
            let center = eye + random.vector() * 4.0;
            let size = random.magnitude(-1.0, 0.0);
            some(random, true, center, size)
        });
        let world = World::new(shapes.collect(), Color::BLACK);
        let gaze = random.vector();
        let camera = camera(random, eye, gaze, 8.0);
        let (width, height) = size(random);
        check(&format!("round {seed}"), &camera, &world, width, height)
    });
}

#[test]
fn radii_of_every_magnitude() {
    many(80, |random, seed| {
        let count = 1 + random.below(60);
        let mixed = random.below(2) == 0;
        let geometries = (0..count).map(|_| {
            let radius = random.magnitude(-12.0, 12.0);
            // Just touching the surroundings of the eye, from any side.
            let away = radius * random.one(&[0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 3.0]);
            let direction = random.vector();
            let center = direction / direction.length() * away + random.vector() * 1e-3;
            some(random, mixed, center, radius)
        });
        let world = World::new(geometries.collect(), Color::BLACK);
        let (eye, gaze) = (random.vector(), random.vector());
        let scale = random.magnitude(-6.0, 6.0);
        let camera = camera(random, eye, gaze, scale);
        let (width, height) = size(random);
        check(&format!("radii {seed}"), &camera, &world, width, height)
    });
}

#[test]
fn angles_near_0_and_near_180() {
    many(60, |random, seed| {
        let small = random.magnitude(-14.0, -1.0);
        let half_angle = random.one(&[small, std::f64::consts::FRAC_PI_2 - small]);
        let half_angle = half_angle.clamp(1e-300, std::f64::consts::FRAC_PI_2.next_down());
        let distance = (1.0 / small).min(1e9);
        let world = crowd(random, DVec3::new(0.0, 0.0, -distance), 2.0, (-1.0, 0.0));
        let around = crowd(random, DVec3::ZERO, 5.0, (-1.0, -0.5));
        let mut geometries = world.geometries().to_vec();
        geometries.extend_from_slice(around.geometries());
        let world = World::new(geometries, Color::BLACK);
        let camera = PerspectiveCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, half_angle);
        let (width, height) = size(random);
        check(
            &format!("angle {seed}"),
            &camera.unwrap().into(),
            &world,
            width,
            height,
        )
    });
}

#[test]
fn shells_around_everything() {
    let mut geometries: Vec<Geometry> = (0..300)
        .map(|n| {
            ball(
                DVec3::new(0.0, 0.0, -1e-3 * f64::from(n)),
                10.0 + f64::from(n % 7),
            )
        })
        .collect();
    geometries.push(ball(DVec3::new(0.0, 0.0, -5.0), 1.0));
    geometries.extend((0..40).map(|n| ball(DVec3::ZERO, 1e3 * f64::from(n + 1))));
    let world = World::new(geometries, Color::BLACK);
    let camera = PerspectiveCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 0.7).unwrap();
    assert_eq!(check("shells", &camera.into(), &world, 70, 50), 70 * 50);
}

#[test]
fn planes_edge_on_and_many() {
    many(40, |random, seed| {
        let eye = random.one(&[DVec3::ZERO, DVec3::new(0.0, 1e-12, 0.0), DVec3::Y]);
        let count = random.one(&[1, 2, 3, 40]);
        let planes = (0..count).map(|_| {
            let point = random.one(&[DVec3::ZERO, DVec3::NEG_Y, random_point(seed), DVec3::NEG_Z]);
            let slope = random.one(&[0.0, 1e-15, 1e-9, 0.3]);
            let normal = random.one(&[DVec3::Y, DVec3::X, DVec3::new(slope, 1.0, slope), DVec3::Z]);
            wall(point, normal * random.magnitude(-100.0, 100.0))
        });
        let mut geometries: Vec<Geometry> = planes.collect();
        geometries.push(ball(DVec3::new(0.0, 0.0, -3.0), 0.5));
        let world = World::new(geometries, Color::BLACK);
        let camera = camera(random, eye, DVec3::NEG_Z, 4.0);
        let (width, height) = size(random);
        check(&format!("planes {seed}"), &camera, &world, width, height)
    });
}

fn random_point(seed: u64) -> DVec3 {
    Rng(seed + 99).vector() * 3.0
}

#[test]
fn cameras_with_extreme_numbers() {
    let world = |scale: f64| {
        World::new(
            vec![
                ball(DVec3::new(0.0, 0.0, -3.0) * scale, scale),
                ball(DVec3::new(1.0, 0.5, -2.0) * scale, 0.25 * scale),
                disc(DVec3::new(-1.0, 0.5, -2.0) * scale, DVec3::ONE, 0.5 * scale),
                wall(DVec3::NEG_Y * scale, DVec3::Y),
            ],
            Color::BLACK,
        )
    };
    let mut seen = 0;
    for scale in [1e-170, 1e-120, 1e-60, 1.0, 1e60, 1e120, 1e152, 1e170, 1e300] {
        for (eye, gaze, up) in [
            (DVec3::ZERO, DVec3::NEG_Z, DVec3::Y),
            (DVec3::new(0.0, 0.0, scale), DVec3::NEG_Z * 1e-160, DVec3::Y),
            (
                DVec3::ZERO,
                DVec3::NEG_Z * 1e150,
                DVec3::new(0.0, 3e-9, 1.0),
            ),
            (
                DVec3::X * scale,
                DVec3::new(1e-3, 1e-3, -1.0),
                DVec3::Y * 1e-155,
            ),
        ] {
            for half_angle in [
                5e-324,
                1e-300,
                1e-20,
                0.6,
                std::f64::consts::FRAC_PI_2.next_down(),
            ] {
                let camera = PerspectiveCamera::new(eye, gaze, up, half_angle).unwrap();
                seen += check("beyond", &camera.into(), &world(scale), 20, 20);
            }
            let camera = OrthographicCamera::new(eye, gaze, up, scale).unwrap();
            seen += check("beyond", &camera.into(), &world(scale), 20, 20);
        }
    }
    assert!(seen > 1000);
}

#[test]
fn threads_and_slabs_do_not_change_the_result() {
    let mut random = Rng(5);
    let world = crowd(&mut random, DVec3::new(0.0, 0.0, -4.0), 2.0, (-2.0, -0.5));
    for (width, height) in [(1000, 70), (4096, 16), (16, 900), (513, 33)] {
        let camera = camera(&mut random, DVec3::ZERO, DVec3::NEG_Z, 4.0);
        let size = Size::new(width, height).unwrap();
        let expected = plain(&camera, &world, size);
        for threads in [1, 2, 3, 16] {
            let pool = Pool::new(Some(threads));
            for rows in [16, 64, 4096] {
                let found = fast(&camera, &world, size, Isa::best(), &pool, rows);
                assert!(found == expected, "{threads} threads, slabs of {rows} rows");
            }
        }
    }
}

#[test]
fn the_crops_of_a_tiling_form_the_whole_picture() {
    let mut random = Rng(8);
    let world = crowd(&mut random, DVec3::new(0.0, 0.0, -4.0), 2.0, (-2.0, -0.5));
    let (width, height) = (133, 71);
    let size = Size::new(width, height).unwrap();
    for _ in 0..4 {
        let camera = camera(&mut random, DVec3::ZERO, DVec3::NEG_Z, 4.0);
        let expected = plain(&camera, &world, size);
        let hits = FirstHits::new(&camera, &world, size, Samples::ONE, Isa::best());
        for (across, down) in [(17, 23), (1, 71), (133, 1), (16, 16), (64, 5)] {
            for rows in cut(0..height, down) {
                for columns in cut(0..width, across) {
                    let found = part(&hits, columns.clone(), rows.clone(), (&Pool::Calling, None));
                    for (row, found) in rows.clone().zip(found.chunks(columns.len())) {
                        let start = (row * width + columns.start) as usize;
                        assert_eq!(found, &expected[start..start + found.len()], "{columns:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn one_pixel_of_parallel_rays_from_within_a_sphere() {
    let world = World::new(
        vec![
            ball(DVec3::ZERO, 0.3),
            ball(DVec3::new(0.3, 0.2, -1.5), 0.2),
            ball(DVec3::new(-0.4, -0.3, -2.0), 0.15),
        ],
        Color::BLACK,
    );
    let camera = OrthographicCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0).unwrap();
    // The length of the name selects the number of samples.
    for name in ["1", "12", "123", "1234"] {
        assert_eq!(check(name, &camera.into(), &world, 1, 1), 1);
    }
}

#[test]
fn at_equal_t_the_first_is_visible() {
    // On the axis, the rays hit all of these at t = 3.
    let touching = [
        ball(DVec3::new(0.0, 0.0, -5.0), 2.0),
        wall(DVec3::new(0.0, 0.0, -3.0), DVec3::Z),
        ball(DVec3::new(0.0, 0.0, -4.0), 1.0),
        ball(DVec3::new(0.0, 0.0, 13.0), 16.0),
        wall(DVec3::new(7.0, 0.0, -3.0), DVec3::NEG_Z * 4.0),
        disc(DVec3::new(0.0, 0.1, -3.0), DVec3::Z * 3.0, 0.5),
    ];
    let camera = PerspectiveCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 0.5).unwrap();
    let other = OrthographicCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0).unwrap();
    for first in 0..touching.len() {
        for second in 0..touching.len() {
            let both = vec![touching[first].clone(), touching[second].clone()];
            let world = World::new(both, Color::BLACK);
            for camera in [camera.into(), other.into()] {
                check("ties", &camera, &world, 3, 3);
                let middle = plain(&camera, &world, Size::new(1, 1).unwrap());
                assert_eq!(middle, [0], "both are met at the same t");
                check("ties", &camera, &world, 1, 1);
            }
        }
    }
}

#[test]
fn parallel_rays_divide_like_the_formula() {
    struct Quotient(DVec3, [f64; LANES]);
    impl Kernel for Quotient {
        type Output = [f64; LANES];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> [f64; LANES] {
            let a = simd.splat(self.0.dot(self.0));
            let mut found = [0.0; LANES];
            let quotient = Parallel::new(self.0).over_2a(simd, simd.load(&self.1), a);
            quotient.store(&mut found);
            found
        }
    }
    let mut random = Rng(8);
    let mut units = 0;
    for _ in 0..cases(20_000) {
        let direction = random.vector();
        let direction = direction / direction.length();
        let a = direction.dot(direction);
        units += usize::from(a == 1.0);
        let x = std::array::from_fn(|_| random.magnitude(-320.0, 300.0));
        for isa in Isa::all() {
            let found = isa.run(Quotient(direction, x));
            assert_eq!(found, x.map(|x| x / (2.0 * a)), "{isa} {direction}");
        }
    }
    let all = cases(20_000);
    assert!(all / 10 < units && units < all * 9 / 10, "{units} of {all}");
}
