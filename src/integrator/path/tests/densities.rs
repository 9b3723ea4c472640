//! Directions are chosen as often as their densities say: a test of chi-square for lamps, for lights of a size,
//! for surroundings and for each kind of surface, in cells of equal solid angle or of the surface of a lamp.

use std::f64::consts::PI;

use glam::DVec3;

use super::{by_paths, half};
use crate::{
    integrator::path::emitters::Emitters,
    tracer::{
        color::Color,
        contact::Departure,
        geometry::Geometry,
        light::{
            Directional, Environment, Falloff, Light, Point, Sky, picture::SkyPicture,
            transport::PathOptions,
        },
        material::{
            Emissive, Material, Phong, Principled,
            bsdf::{Bsdf, LobeColors, Onto},
            microfacet::Microfacets,
            rough_glass::RoughGlass,
        },
        radiance::Radiance,
        random::Rng,
        ray::Ray,
        sampling::{LocalFrame, UnitPair},
        shape::{
            Shape, capsule::Capsule, cone::Cone, cuboid::Cuboid, cylinder::Cylinder, disc::Disc,
            face::FaceId, plane::Plane, rectangle::Rectangle, sphere::Sphere, triangle::Triangle,
        },
        texels::Texels,
        vector::unit,
        world::World,
    },
};

/// The number of cells around an axis and along it.
const CELLS: [usize; 2] = [64, 32];
/// The number of directions that are chosen.
const COUNT: u32 = 1_000_000;
/// The number of places in a cell, each way, at which the density is known.
const FINE: usize = 40;
/// A cell with fewer expected directions is counted with the others of this kind.
const FEW: f64 = 10.0;
/// The largest value of the normal distribution: 40 tests of which one fails by chance in ten thousand runs.
const MOST: f64 = 4.6;

/// The cell of a vector, given heights along the z axis between which there are cells.
fn cell(at: DVec3, [low, high]: [f64; 2]) -> usize {
    let place = |part: f64, count: usize| ((part * count as f64) as usize).min(count - 1);
    let turn = libm::atan2(at.y, at.x) / (2.0 * PI) + 0.5;
    place(turn, CELLS[0]) + CELLS[0] * place((at.z - low) / (high - low), CELLS[1])
}

/// The integral over each cell of a density by angle and height, which is given a unit vector at a right angle to
/// the z axis, and the height.
fn integrals([low, high]: [f64; 2], density: impl Fn(DVec3, f64) -> f64) -> Vec<f64> {
    let [around, along] = CELLS.map(|count| count * FINE);
    let one = 2.0 * PI * (high - low) / (around * along) as f64;
    let mut parts = vec![0.0; CELLS[0] * CELLS[1]];
    for i in 0..along {
        let z = low + (i as f64 + 0.5) / along as f64 * (high - low);
        for j in 0..around {
            let (sine, cosine) = libm::sincos(((j as f64 + 0.5) / around as f64 - 0.5) * 2.0 * PI);
            let out = DVec3::new(cosine, sine, 0.0);
            parts[cell(out + z * DVec3::Z, [low, high])] += density(out, z) * one;
        }
    }
    parts
}

/// Asserts that directions are chosen by a density, whose sum is 1 without those that are lost.
#[track_caller]
fn assert_chosen(
    name: &str,
    sample: impl Fn(f64, UnitPair) -> Option<DVec3>,
    density: impl Fn(DVec3) -> f64,
) {
    let heights = [-1.0, 1.0];
    let expected = integrals(heights, |out, z| {
        density((1.0 - z * z).sqrt() * out + z * DVec3::Z)
    });
    let sample = |u, pair| sample(u, pair).map(|l| cell(l, heights));
    assert_counts(name, sample, &expected);
}

/// Asserts that cells are chosen as often as expected; the sum is 1 without those that are lost.
#[track_caller]
fn assert_counts(name: &str, sample: impl Fn(f64, UnitPair) -> Option<usize>, expected: &[f64]) {
    let mut random = Rng(0x5eed);
    let mut number = || (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut found = vec![0_u32; CELLS[0] * CELLS[1]];
    let mut lost = 0;
    for _ in 0..COUNT {
        match sample(number(), [number(), number()]) {
            Some(cell) => found[cell] += 1,
            None => lost += 1,
        }
    }
    let all = expected.iter().sum::<f64>() + f64::from(lost) / f64::from(COUNT);
    assert!(
        (all - 1.0).abs() < 3e-3,
        "{name}: the densities add up to {all}"
    );
    let mut apart: Vec<_> = expected
        .iter()
        .zip(&found)
        .enumerate()
        .map(|(cell, (expected, found))| {
            let (found, expected) = (f64::from(*found), expected * f64::from(COUNT));
            let part = (found - expected) * (found - expected) / expected.max(FEW);
            (
                part as u32,
                cell % CELLS[0],
                cell / CELLS[0],
                found,
                expected,
            )
        })
        .collect();
    apart.sort_by_key(|apart| std::cmp::Reverse(apart.0));
    apart.truncate(6);
    let (mut chi, mut cells, mut rest) = (0.0, -1.0, [0.0, 0.0]);
    let mut add = |found: f64, expected: f64| {
        chi += (found - expected) * (found - expected) / expected;
        cells += 1.0;
    };
    for (found, expected) in found.into_iter().zip(expected) {
        let (found, expected) = (f64::from(found), expected * f64::from(COUNT));
        match expected >= FEW {
            true => add(found, expected),
            false => rest = [rest[0] + found, rest[1] + expected],
        }
    }
    if rest[1] >= FEW {
        add(rest[0], rest[1]);
    } else {
        assert!(
            rest[0] <= 5.0 * FEW,
            "{name}: {} where none is expected",
            rest[0]
        );
    }
    // E. B. Wilson and M. M. Hilferty, The distribution of chi-square, PNAS 17, 684 (1931).
    let ninth = 2.0 / (9.0 * cells);
    let normal = (libm::cbrt(chi / cells) - (1.0 - ninth)) / ninth.sqrt();
    assert!(
        normal < MOST,
        "{name}: {chi} of {cells} cells, {normal}, lost {lost}, worst {apart:?}"
    );
}

/// Where paths aim from.
const FROM: DVec3 = DVec3::new(0.1, -0.2, 0.3);

/// A world, its emitters, and the start of rays from where paths aim.
type Aiming = (World, Emitters, Departure);

/// The emitters of a world, and the start of rays that leave a plane at the point.
fn aiming(mut geometries: Vec<Geometry>, lights: Vec<Light>) -> Aiming {
    let own = FaceId {
        geometry: geometries.len(),
        face: 0,
    };
    let plane = Plane::new(FROM, DVec3::Y).unwrap();
    geometries.push(Geometry::new(plane, half()));
    let world = by_paths(geometries, lights, (PathOptions::default(), 4));
    let emitters = Emitters::new(&world);
    (world, emitters, Departure::at_hit(own, None, DVec3::Y))
}

/// The world of a lamp.
fn aiming_at(shape: Shape) -> Aiming {
    let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
    aiming(vec![Geometry::new(shape, lamp)], vec![])
}

/// Returns a direction to a lamp; `None` if what it is aimed at lies behind another face.
fn aim((world, emitters, start): &Aiming, u: f64, pair: UnitPair) -> Option<DVec3> {
    let (number, _) = emitters.weights(FROM).choose(u)?;
    let aimed = emitters.aim(world, number, (FROM, start), pair)?;
    let (_, t_max) = aimed.shadow?;
    let is_first = world.transmission(&Ray::new(FROM, aimed.l), t_max, start);
    (is_first != Radiance::BLACK).then_some(aimed.l)
}

/// Returns the point of a lamp in a direction, and the density of the direction.
fn meet((world, emitters, _): &Aiming, l: DVec3) -> Option<(DVec3, f64)> {
    let (geometry, hit) = world.hit(&Ray::new(FROM, l))?;
    let face = FaceId {
        geometry,
        face: hit.face,
    };
    let (number, density) = emitters.of_face(face, (hit.point, hit.normal), FROM)?;
    Some((
        hit.point,
        density * emitters.probability((FROM, emitters.weights(FROM).sum()), number),
    ))
}

#[test]
fn lamps_are_aimed_at_by_their_densities() {
    let v = DVec3::new;
    let shapes: [(&str, Shape); 6] = [
        ("sphere", Sphere::new(v(1.0, 0.5, 1.0), 1.1).unwrap().into()),
        (
            "disc",
            Disc::new(v(0.0, 0.3, 1.2), v(0.3, 0.1, 1.0), 1.3)
                .unwrap()
                .into(),
        ),
        (
            "rectangle",
            Rectangle::new(v(-1.0, -1.0, 1.0), v(2.0, 0.2, 0.3), v(0.1, 2.0, 0.0))
                .unwrap()
                .into(),
        ),
        (
            "triangle",
            Triangle::new(v(-1.0, -1.0, 1.0), v(2.0, -1.0, 1.5), v(0.0, 2.0, 0.6))
                .unwrap()
                .into(),
        ),
        (
            "box",
            Cuboid::new(v(0.8, -0.7, -0.5), v(1.9, 0.6, 1.0))
                .unwrap()
                .into(),
        ),
        (
            "small sphere",
            Sphere::new(v(3.0, 2.0, -2.0), 0.7).unwrap().into(),
        ),
    ];
    for (name, shape) in shapes {
        let aiming = aiming_at(shape);
        assert_chosen(
            name,
            |u, pair| aim(&aiming, u, pair),
            |l| meet(&aiming, l).map_or(0.0, |(_, density)| density),
        );
    }
}

// The density of directions grows without bound to where a round side turns away, as does the area that they
// cover. So these cells are parts of the side, whose expected counts have no poles.
#[test]
fn round_lamps_are_aimed_at_by_their_densities() {
    let (from, to) = (DVec3::new(-0.4, 0.3, 1.0), DVec3::new(0.9, 0.8, 1.7));
    let length = (to - from).length();
    // The radius r at a height, and r times its growth.
    type Profile<'a> = &'a dyn Fn(f64) -> [f64; 2];
    let cone = |radius: f64, top: f64| {
        let growth = (top - radius) / length;
        move |height| {
            let radius = radius + growth * height;
            [radius, radius * growth]
        }
    };
    let capsule = |height: f64| {
        let beyond = height - height.clamp(0.0, length);
        [(0.16 - beyond * beyond).sqrt(), -beyond]
    };
    let lamps: [(&str, Shape, [f64; 2], Profile); 4] = [
        (
            "cylinder",
            Cylinder::new(from, to, 0.4, false).unwrap().into(),
            [0.0, length],
            &cone(0.4, 0.4),
        ),
        (
            "cone",
            Cone::new(from, to, 0.6, 0.2, false).unwrap().into(),
            [0.0, length],
            &cone(0.6, 0.2),
        ),
        (
            "pointed cone",
            Cone::new(from, to, 0.6, 0.0, false).unwrap().into(),
            [0.0, length],
            &cone(0.6, 0.0),
        ),
        (
            "capsule",
            Capsule::new(from, to, 0.4).unwrap().into(),
            [-0.4, length + 0.4],
            &capsule,
        ),
    ];
    let axes = LocalFrame::new(unit(to - from));
    for (name, shape, heights, profile) in lamps {
        let aiming = aiming_at(shape);
        let expected = integrals(heights, |out, height| {
            let [radius, growth] = profile(height);
            let at = from + axes.outward(radius * out + height * DVec3::Z);
            let (to, across) = (at - FROM, axes.outward(radius * out - growth * DVec3::Z));
            let l = unit(to);
            let met = meet(&aiming, l).filter(|(first, _)| first.distance(at) < 1e-6);
            met.map_or(0.0, |(_, density)| {
                density * l.dot(across).abs() / to.dot(to)
            })
        });
        let sample = |u, pair| {
            let (at, _) = meet(&aiming, aim(&aiming, u, pair)?)?;
            Some(cell(axes.inward(at - from), heights))
        };
        assert_counts(name, sample, &expected);
    }
}

#[test]
fn lights_of_a_size_are_aimed_at_by_their_densities() {
    let ball = Point::new(
        DVec3::new(1.0, -0.5, 0.8),
        Color::WHITE,
        2.0,
        Falloff::InverseSquare,
        true,
    );
    let sun = Directional::new(DVec3::new(0.3, -0.5, 0.4), Color::WHITE, 1.0, true);
    for (name, light) in [
        ("ball", Light::from(ball.unwrap().with_radius(0.9).unwrap())),
        ("sun", Light::from(sun.unwrap().with_angle(70.0).unwrap())),
    ] {
        let (world, emitters, start) = aiming(vec![], vec![light]);
        assert_chosen(
            name,
            |_, pair| Some(emitters.aim(&world, 0, (FROM, &start), pair)?.l),
            |l| {
                let mut density = 0.0;
                emitters.each_passed(&Ray::new(FROM, l), (FROM, f64::INFINITY), |passing| {
                    density += passing.density;
                });
                density
            },
        );
    }
}

#[test]
fn surroundings_are_aimed_at_by_their_densities() {
    let gray = |light| Color::from_linear(Radiance::WHITE * light);
    let sky = Sky {
        zenith: gray(0.9),
        horizon: gray(0.3),
        ground: gray(0.05),
    };
    let up = DVec3::new(0.2, 1.0, -0.3);
    let mut light: Vec<_> = (0..16 * 8)
        .map(|i| [0.1 + (i % 7) as f32 * 0.2; 3])
        .collect();
    light[37] = [9.0; 3];
    let picture = SkyPicture::new(Texels::new(16, 8, light).unwrap()).unwrap();
    for (name, environment) in [
        ("even", Environment::new(Color::WHITE, 1.0).unwrap()),
        ("sky", Environment::of_sky(sky, up, 1.0).unwrap()),
        (
            "picture",
            Environment::of_picture(&picture, up, 25.0, 1.0).unwrap(),
        ),
    ] {
        assert_chosen(
            name,
            |_, pair| Some(environment.sample(pair).0),
            |l| environment.density(l),
        );
    }
}

#[test]
fn surfaces_scatter_by_their_densities() {
    let principled = |metallic, roughness| {
        Material::from(Principled::new(half(), metallic, roughness, 1.5).unwrap())
    };
    let phong = |exponent| Phong::new(half(), Color::WHITE, exponent, Color::BLACK).unwrap();
    for (name, material) in [
        ("metal 0.3", principled(1.0, 0.3)),
        ("metal 1", principled(1.0, 1.0)),
        ("plastic 0.4", principled(0.0, 0.4)),
        ("both 0.6", principled(0.5, 0.6)),
        ("phong 5", phong(5.0).into()),
        ("phong 60", phong(60.0).into()),
    ] {
        for v in [DVec3::new(0.3, 0.1, 1.0), DVec3::new(-1.0, 0.4, 0.25)] {
            let lobes = material.lobes();
            let bsdf = Bsdf::new(&lobes, &LobeColors::new(&lobes), unit(v));
            assert_chosen(
                name,
                |u, pair| match bsdf.sample(u, pair) {
                    Onto::Direction(l, _) => (l.z > 0.0).then_some(l),
                    Onto::Mirror(_) => None,
                },
                |l| bsdf.from(l).density,
            );
        }
    }
}

#[test]
fn rough_glass_scatters_by_its_densities() {
    for (name, eta, is_pane) in [
        ("into", 1.5, false),
        ("out of", 1.0 / 1.5, false),
        ("pane", 1.5, true),
    ] {
        for v in [DVec3::new(0.3, 0.1, 1.0), DVec3::new(-1.0, 0.4, 0.5)] {
            let facets = Microfacets::of_alpha(0.3);
            let glass = RoughGlass::new(unit(v), facets, (eta, Radiance::WHITE), is_pane);
            assert_chosen(
                name,
                |u, pair| glass.sample(u, pair),
                |l| glass.from(l).density,
            );
        }
    }
}
