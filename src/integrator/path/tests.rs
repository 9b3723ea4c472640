use super::*;
use crate::tracer::{
    color::Color,
    geometry::Geometry,
    light::{Ambient, Directional, Falloff, Headlight, Light, Point, transport::Transport},
    material::{Emissive, Material},
    random::{Rng, cases},
    shape::{plane::Plane, sphere::Sphere},
    vector::unit,
};

/// Half of the light of white.
fn half() -> Color {
    Color::from_linear(Radiance::WHITE * 0.5)
}

fn sphere(center: DVec3, radius: f64, material: impl Into<Material>) -> Geometry {
    Geometry::new(Sphere::new(center, radius).unwrap(), material)
}

fn floor(material: impl Into<Material>) -> Geometry {
    Geometry::new(Plane::new(DVec3::ZERO, DVec3::Y).unwrap(), material)
}

fn point(position: DVec3, intensity: f64) -> Light {
    let point = Point::new(
        position,
        Color::WHITE,
        intensity,
        Falloff::InverseSquare,
        true,
    );
    point.unwrap().into()
}

fn ambient() -> Light {
    Ambient::new(Color::WHITE, 1.0).unwrap().into()
}

fn options(samples: u32) -> PathOptions {
    PathOptions {
        samples,
        ..PathOptions::default()
    }
}

/// Returns a world whose light follows paths.
fn by_paths(
    geometries: Vec<Geometry>,
    lights: Vec<Light>,
    (options, max_depth): (PathOptions, u32),
) -> World {
    World::new(geometries, Color::BLACK).lit(Lighting {
        max_depth,
        transport: Transport::Path(options),
        ..Lighting::new(lights)
    })
}

/// Returns the mean of a channel along a ray and its standard error.
fn mean(world: &World, ray: &Ray) -> (f64, f64) {
    mean_of(world, |_| *ray)
}

/// The same along the rays of samples.
fn mean_of(world: &World, ray: impl Fn(&Sampler) -> Ray) -> (f64, f64) {
    let lighting = world.lighting().unwrap();
    let options = *world.paths().unwrap();
    let paths = PathTracer::new(world, lighting, options, world, false);
    let (mut sum, mut squares) = (0.0, 0.0);
    for sample in 0..options.samples {
        let sampler = Sampler::new([3, 5], sample, options.seed);
        let light = paths.sample(ray(&sampler), &sampler).light.parts.sum().r();
        sum += light;
        squares += light * light;
    }
    let count = f64::from(options.samples);
    let mean = sum / count;
    let variance = (squares / count - mean * mean).max(0.0);
    (mean, (variance / count).sqrt())
}

/// Asserts that a mean is what it should be: to 0.1 %, or to three standard errors.
#[track_caller]
fn assert_mean((mean, error): (f64, f64), expected: f64) {
    let apart = (mean - expected).abs();
    assert!(
        apart <= (3.0 * error).max(0.001 * expected),
        "{mean} ± {error}, not {expected}"
    );
}

fn down(x: f64) -> Ray {
    Ray::new(DVec3::new(x, 3.0, 0.5), unit(DVec3::new(0.2, -1.0, -0.1)))
}

#[test]
fn a_matte_surface_in_white_light_has_its_color() {
    for max_depth in [1, 32] {
        let world = by_paths(
            vec![sphere(DVec3::ZERO, 1.0, half())],
            vec![ambient()],
            (options(64), max_depth),
        );
        let (mean, _) = mean(&world, &down(0.0));
        assert!((mean - 0.5).abs() < 1e-14, "{mean}");
    }
}

// L = 1 + ρ L from all sides.
#[test]
fn light_goes_back_and_forth_inside_of_a_shining_hollow() {
    let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
    let world = by_paths(
        vec![
            sphere(DVec3::ZERO, 9.0, lamp),
            sphere(DVec3::ZERO, 1.0, half()),
        ],
        vec![],
        (options(64), 32),
    );
    let (mean, _) = mean(&world, &Ray::new(DVec3::new(0.0, 0.0, 3.0), DVec3::NEG_Z));
    assert!((mean - 0.5).abs() < 1e-14, "{mean}");
}

#[test]
fn lights_without_size_are_those_of_direct_lighting() {
    let position = DVec3::new(1.0, 3.0, -2.0);
    let sun = Directional::new(DVec3::new(0.3, -1.0, 0.2), half(), 0.7, true);
    let lights = [
        point(position, 9.0),
        sun.unwrap().into(),
        Headlight::new(half(), 0.4).unwrap().into(),
    ];
    let geometries = || {
        vec![
            floor(half()),
            sphere(DVec3::new(0.4, 1.0, 0.0), 0.6, half()),
        ]
    };
    let mut random = Rng(8);
    for light in lights {
        let direct = World::new(geometries(), half()).lit(Lighting::new(vec![light]));
        let lighting = Lighting {
            max_depth: 1,
            transport: Transport::Path(options(2)),
            ..Lighting::new(vec![light])
        };
        let paths = direct.clone().lit(lighting);
        for _ in 0..cases(400) {
            let eye = DVec3::new(0.0, 2.0, 4.0);
            let ray = Ray::new(eye, unit(random.vector() * 2.0 - eye));
            let [one, other] = [&direct, &paths].map(|world| world.radiance(&ray));
            let apart = (one - other).channels.map(f64::abs);
            assert!(apart.into_iter().all(|it| it < 1e-12), "{one:?} {other:?}");
        }
    }
}

// A mirror shows what is behind it, times its color.
#[test]
fn mirrors_and_glass_show_what_they_meet() {
    let mirror = vec![floor(Material::Mirror(half()))];
    let white = World::new(mirror, Color::WHITE).lit(Lighting {
        transport: Transport::Path(options(4)),
        ..Lighting::new(vec![])
    });
    assert_eq!(white.radiance(&down(0.0)), Radiance::WHITE * 0.5);

    let glass = Glass::new(Color::WHITE, 1.5).unwrap();
    let ball = World::new(vec![sphere(DVec3::ZERO, 1.0, glass)], Color::WHITE);
    let ball = ball.lit(Lighting {
        max_depth: 400,
        transport: Transport::Path(options(256)),
        ..Lighting::new(vec![])
    });
    assert_mean(mean(&ball, &down(-0.3)), 1.0);
}

// Half of the light comes from the sky, and half from a wall that gets all of the light.
#[test]
fn ambient_light_is_darker_in_corners() {
    let wall = Plane::new(DVec3::ZERO, DVec3::X).unwrap();
    let world = |max_depth| {
        by_paths(
            vec![floor(half()), Geometry::new(wall.clone(), Color::BLACK)],
            vec![ambient()],
            (options(1 << 14), max_depth),
        )
    };
    let ray = Ray::new(DVec3::new(1.0, 1.0, 0.0), DVec3::NEG_Y);
    assert_mean(mean(&world(1), &ray), 0.25);
}
