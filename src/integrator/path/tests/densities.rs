//! Directions are chosen as often as their densities say: a test of chi-square for lamps, for lights of a size,
//! for surroundings and for each kind of surface, in cells of equal solid angle.

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
            bsdf::{Bsdf, Onto},
            microfacet::Microfacets,
            rough_glass::RoughGlass,
        },
        radiance::Radiance,
        random::Rng,
        ray::Ray,
        sampling::UnitPair,
        shape::{
            Shape, cuboid::Cuboid, disc::Disc, face::FaceId, plane::Plane, rectangle::Rectangle,
            sphere::Sphere, triangle::Triangle,
        },
        texels::Texels,
        vector::unit,
        world::World,
    },
};

/// The number of cells around the z axis and along it.
const CELLS: [usize; 2] = [64, 32];
/// The number of directions that are chosen.
const COUNT: u32 = 1_000_000;
/// The number of directions in a cell, each way, at which the density is known.
const FINE: usize = 40;
/// A cell with fewer expected directions is counted with the others of this kind.
const FEW: f64 = 10.0;
/// The largest value of the normal distribution: 40 tests of which one fails by chance in ten thousand runs.
const MOST: f64 = 4.6;

/// The cell of a direction.
fn cell(l: DVec3) -> usize {
    let at = |part: f64, count: usize| ((part * count as f64) as usize).min(count - 1);
    let turn = libm::atan2(l.y, l.x) / (2.0 * PI) + 0.5;
    at(turn, CELLS[0]) + CELLS[0] * at(f64::midpoint(l.z, 1.0), CELLS[1])
}

/// The mean of a density over each cell, times its solid angle.
fn expected(density: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let [around, along] = CELLS.map(|count| count * FINE);
    let mut parts = vec![0.0; CELLS[0] * CELLS[1]];
    for i in 0..along {
        let z = (i as f64 + 0.5) / along as f64 * 2.0 - 1.0;
        let radius = (1.0 - z * z).sqrt();
        for j in 0..around {
            let (sine, cosine) = libm::sincos(((j as f64 + 0.5) / around as f64 - 0.5) * 2.0 * PI);
            let l = DVec3::new(radius * cosine, radius * sine, z);
            parts[cell(l)] += density(l) * 4.0 * PI / (around * along) as f64;
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
    let mut random = Rng(0x5eed);
    let mut number = || (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut found = vec![0_u32; CELLS[0] * CELLS[1]];
    let mut lost = 0;
    for _ in 0..COUNT {
        match sample(number(), [number(), number()]) {
            Some(l) => found[cell(l)] += 1,
            None => lost += 1,
        }
    }
    let expected = expected(density);
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

/// The emitters of a world, and the start of rays that leave a plane at the point.
fn aiming(mut geometries: Vec<Geometry>, lights: Vec<Light>) -> (World, Emitters, Departure) {
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

// Not those with round sides: where these end, their densities grow without bound.
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
        let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
        let (world, emitters, start) = aiming(vec![Geometry::new(shape, lamp)], vec![]);
        let first = |l: DVec3| {
            let (index, hit) = world.hit(&Ray::new(FROM, l))?;
            let face = FaceId {
                geometry: index,
                face: hit.face,
            };
            let (number, density) = emitters.of_face(face, (hit.point, hit.normal), FROM)?;
            Some(density * emitters.probability((FROM, emitters.weights(FROM).sum()), number))
        };
        assert_chosen(
            name,
            |u, pair| {
                let (number, _) = emitters.weights(FROM).choose(u)?;
                let aimed = emitters.aim(&world, number, (FROM, &start), pair)?;
                // A face may lie behind another one of the lamp.
                let (_, t_max) = aimed.shadow?;
                let is_first = world.transmission(&Ray::new(FROM, aimed.l), t_max, &start);
                (is_first != Radiance::BLACK).then_some(aimed.l)
            },
            |l| first(l).unwrap_or(0.0),
        );
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
            let bsdf = Bsdf::new(&material.lobes(), unit(v));
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
