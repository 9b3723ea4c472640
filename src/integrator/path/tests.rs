mod densities;

use std::{f64::consts::PI, iter, sync::Arc};

use glam::DVec3;

use crate::{
    integrator::path::{
        PathTracer,
        emitters::{EmittedBy, Emitters},
        sampler::Sampler,
    },
    tracer::{
        color::Color,
        geometry::Geometry,
        light::{
            Ambient, Backdrop, Directional, Environment, Falloff, Headlight, Light, Point, Sky,
            picture::SkyPicture,
            transport::{PathOptions, Transport},
        },
        material::{Emissive, Glass, Material, Phong, Principled},
        radiance::Radiance,
        random::{Rng, cases},
        ray::Ray,
        sampling::{LocalFrame, cosine_weighted, disc},
        shape::{
            Shape, cuboid::Cuboid, cylinder::Cylinder, disc::Disc, plane::Plane,
            rectangle::Rectangle, sphere::Sphere,
        },
        texels::Texels,
        vector::unit,
        world::{Lighting, World},
    },
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
        let direct = World::new(geometries(), half()).lit(Lighting::new(vec![light.clone()]));
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

// A backdrop lights nothing, and is seen as sharply as the background.
#[test]
fn only_sharp_rays_see_a_backdrop() {
    let sky = Sky {
        zenith: half(),
        horizon: Color::BLACK,
        ground: Color::WHITE,
    };
    let backdrop = Backdrop::of_sky(sky, DVec3::Y).unwrap();
    let world = |material: Material, lights: Vec<Light>| {
        by_paths(vec![floor(material)], lights, (options(16), 32)).with_backdrop(backdrop.clone())
    };
    let ray = down(0.0);
    let up = Ray::new(DVec3::ZERO, -ray.direction());
    let height = up.direction().y;
    let near = |found: Radiance, expected: f64| {
        assert!((found.r() - expected).abs() < 1e-14, "{found:?} {expected}");
    };
    let mirror = world(Material::Mirror(half()), vec![]);
    near(mirror.radiance(&ray), 0.25 * height);
    near(mirror.radiance(&up), 0.5 * height);
    let chalk = world(half().into(), vec![]);
    assert_eq!(chalk.radiance(&ray), Radiance::BLACK);
    near(world(half().into(), vec![ambient()]).radiance(&ray), 0.5);
    // The surroundings that shine hide it from all but the camera.
    let light = Environment::new(Color::WHITE, 3.0).unwrap();
    for (is_visible, expected) in [(true, 3.0), (false, 0.5 * height)] {
        let light = light.clone().visible(is_visible).into();
        let mirror = world(Material::Mirror(half()), vec![light]);
        near(mirror.radiance(&up), expected);
        near(mirror.radiance(&ray), 1.5);
    }
}

// Half of the light comes from the sky, and half from a wall that gets all of the light.
#[test]
fn ambient_light_is_darker_in_corners() {
    let wall = Plane::new(DVec3::ZERO, DVec3::X).unwrap();
    let world = |max_depth| {
        by_paths(
            vec![floor(half()), Geometry::new(wall, Color::BLACK)],
            vec![ambient()],
            (options(1 << 14), max_depth),
        )
    };
    let ray = Ray::new(DVec3::new(1.0, 1.0, 0.0), DVec3::NEG_Y);
    assert_mean(mean(&world(1), &ray), 0.25);
}

/// Returns the light of a matte floor below a lamp.
fn below(lamp: impl Into<Shape>, max_depth: u32) -> (f64, f64) {
    let emissive = Emissive::new(Color::WHITE, 1.0).unwrap();
    let world = by_paths(
        vec![floor(half()), Geometry::new(lamp, emissive)],
        vec![],
        (options(1 << 14), max_depth),
    );
    let eye = DVec3::new(3.0, 1.0, 0.0);
    mean(&world, &Ray::new(eye, unit(-eye)))
}

// The irradiance of a ball is π r²/d², that of a disc above π R²/(R² + h²).
#[test]
fn lamps_light_a_floor_as_their_closed_forms_say() {
    for max_depth in [1, 8] {
        let ball = Sphere::new(DVec3::new(0.0, 2.0, 0.0), 0.5).unwrap();
        assert_mean(below(ball, max_depth), 0.5 * 0.25 / 4.0);
        let disc = Disc::new(DVec3::new(0.0, 2.0, 0.0), DVec3::Y, 1.0).unwrap();
        assert_mean(below(disc, max_depth), 0.5 / 5.0);
        let corner = DVec3::new(0.0, 2.0, 0.0);
        let rectangle = Rectangle::new(corner, DVec3::X, 3.0 * DVec3::Z).unwrap();
        let side = |a: f64, b: f64| {
            let slant = (a * a + 4.0).sqrt();
            a / slant * libm::atan(b / slant)
        };
        let expected = 0.5 * (side(1.0, 3.0) + side(3.0, 1.0)) / (2.0 * PI);
        assert_mean(below(rectangle, max_depth), expected);
    }
}

// An upright tube seen from its foot, at the distance d from its axis: the form factor of a cylinder to an
// element (J. Howell, A catalog of radiation heat transfer configuration factors, B-30) is checked against
// directions that are not aimed.
#[test]
fn round_sides_bring_the_light_that_is_found_without_aiming() {
    let tube = |center: DVec3| {
        let up = DVec3::new(0.3, 1.0, 0.1);
        Cylinder::new(center, center + up, 0.4, true).unwrap()
    };
    let emissive = Emissive::new(Color::WHITE, 1.0).unwrap();
    let world = |samples| {
        let lamp = Geometry::new(tube(DVec3::new(0.0, 0.7, 0.0)), emissive);
        by_paths(
            vec![floor(Color::WHITE), lamp],
            vec![],
            (options(samples), 1),
        )
    };
    let eye = DVec3::new(3.0, 1.0, 0.0);
    let ray = Ray::new(eye, unit(-eye));
    let aimed = mean(&world(1 << 14), &ray);
    let scene = world(1);
    let lighting = scene.lighting().unwrap();
    let mut paths = PathTracer::new(&scene, lighting, options(1), &scene, false);
    paths.emitters = Arc::default();
    let (mut sum, count) = (0.0, 1 << 16);
    for sample in 0..count {
        let sampler = Sampler::new([1, 1], sample, 0);
        sum += paths.sample(ray, &sampler).light.parts.sum().r();
    }
    let by_chance = sum / f64::from(count);
    assert!(aimed.1 < 0.01 * by_chance, "{aimed:?}");
    assert!(
        (aimed.0 / by_chance - 1.0).abs() < 0.01,
        "{aimed:?} {by_chance}"
    );
}

// Lights of a size bring as much light as those without, as long as all of it is above the surface.
#[test]
fn size_does_not_change_the_light_of_a_light() {
    let position = DVec3::new(0.0, 2.0, 1.0);
    let at = |light: Light| {
        let world = by_paths(vec![floor(half())], vec![light], (options(1 << 14), 1));
        let eye = DVec3::new(3.0, 1.0, 0.0);
        mean(&world, &Ray::new(eye, unit(-eye)))
    };
    for falloff in [Falloff::InverseSquare, Falloff::Constant] {
        let of_size = |radius| {
            let point = Point::new(position, Color::WHITE, 3.0, falloff, true).unwrap();
            at(point.with_radius(radius).unwrap().into())
        };
        let (expected, _) = of_size(0.0);
        for radius in [0.01, 0.5, 1.5] {
            assert_mean(of_size(radius), expected);
        }
    }
    for angle in [0.53, 30.0] {
        let sun = Directional::new(DVec3::new(1.0, -1.0, 0.0), Color::WHITE, 1.0, true).unwrap();
        let expected = 0.5 * std::f64::consts::FRAC_1_SQRT_2;
        assert_mean(at(sun.with_angle(angle).unwrap().into()), expected);
    }
}

// The light of a lamp in a matte hollow: L = ρ r²/(1 - ρ (1 - r²)).
#[test]
fn a_lamp_fills_a_hollow() {
    let radius: f64 = 0.3;
    for albedo in [0.5, 0.9] {
        let color = Color::from_linear(Radiance::WHITE * albedo);
        let emissive = Emissive::new(Color::WHITE, 1.0).unwrap();
        let hollow = vec![
            sphere(DVec3::ZERO, 1.0, color),
            sphere(DVec3::ZERO, radius, emissive),
        ];
        let world = by_paths(hollow, vec![], (options(1 << 14), 400));
        let ray = Ray::new(DVec3::new(0.0, 0.5, 0.2), unit(DVec3::new(0.3, 1.0, 0.4)));
        let squared = radius * radius;
        let expected = albedo * squared / (1.0 - albedo * (1.0 - squared));
        assert_mean(mean(&world, &ray), expected);
    }
}

// A floor below a pane: its light is that of direct lighting, whatever part of it is found by chance.
#[test]
fn emitters_have_their_own_weights_inside_of_a_tree_too() {
    let sun = Directional::new(-DVec3::Y, Color::WHITE, 0.2, true).unwrap();
    let points = (0..40).map(|place| point(DVec3::new(f64::from(place), 3.0, 0.0), 1.0));
    let lights = iter::once(Light::from(sun)).chain(points).collect();
    let world = by_paths(vec![floor(half())], lights, (options(1), 1));
    let emitters = Emitters::new(&world);
    let first: Vec<_> = emitters.first_chances(&world, DVec3::ZERO).collect();
    let sum = emitters.weights(DVec3::ZERO).sum();
    assert_eq!(first.len(), 8);
    assert_eq!(first[0].emitter, EmittedBy::Light(0));
    assert!((first[0].weight - 0.2 * PI).abs() < 1e-15);
    assert_eq!(first[0].probability, first[0].weight / sum);
    for (place, of) in (0..).zip(&first[1..]) {
        let squared = f64::from(place * place + 9);
        assert!((of.weight - PI / squared).abs() < 1e-14, "{of:?}");
        assert!(of.probability > 0.0 && of.probability != of.weight / sum);
    }
    let all = (0..41).map(|number| emitters.probability((DVec3::ZERO, sum), number));
    assert!((all.sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn panes_let_the_light_of_lamps_straight_through() {
    let glass = Glass::new(half(), 1.5).unwrap();
    let pane = Geometry::new(
        Plane::new(DVec3::new(0.0, 1.0, 0.0), DVec3::Y).unwrap(),
        glass,
    );
    let emissive = Emissive::new(Color::WHITE, 1.0).unwrap();
    let lamp = sphere(DVec3::new(0.0, 200.0, 0.0), 50.0, emissive);
    let eye = DVec3::new(0.3, 0.5, 0.0);
    let ray = Ray::new(eye, unit(-eye));
    for caustics in [false, true] {
        let options = PathOptions {
            caustics,
            diffuse_depth: Some(0),
            ..options(1 << 14)
        };
        let geometries = vec![
            floor(half()),
            pane.clone(),
            lamp.clone(),
            // Solid glass elsewhere, so that shadow rays ask for it.
            sphere(DVec3::new(90.0, 0.0, 0.0), 1.0, glass),
        ];
        let world = by_paths(geometries, vec![], (options, 9));
        // Averaged over the cosines, nearly 1.
        let passes = |cosine| 1.0 - glass.fresnel(cosine, true).reflected;
        let expected = 0.5 * 0.5 * passes(0.98) / 16.0;
        let (found, error) = mean(&world, &ray);
        assert!(
            (found / expected - 1.0).abs() < 0.004 + 3.0 * error / expected,
            "{found} {expected}"
        );
    }
}

/// Returns the mean light of a ball in white light, over the rays of a picture of it.
fn furnace(material: impl Into<Material>) -> (f64, f64) {
    let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
    let world = by_paths(
        vec![
            sphere(DVec3::ZERO, 50.0, lamp),
            sphere(DVec3::ZERO, 1.0, material),
        ],
        vec![],
        (options(1 << 16), 32),
    );
    mean_of(&world, |sampler| {
        let [x, y] = disc(sampler.pair(0));
        Ray::new(DVec3::new(x, y, 3.0), DVec3::NEG_Z)
    })
}

#[test]
fn white_surfaces_send_back_all_light() {
    for roughness in [0.1, 0.3, 0.5, 0.75, 1.0, 0.0] {
        for (metallic, ior) in [(1.0, 1.5), (0.0, 1.5), (0.0, 2.0), (0.5, 1.5)] {
            let white = Principled::new(Color::WHITE, metallic, roughness, ior).unwrap();
            let (found, error) = furnace(white);
            assert!(
                (found - 1.0).abs() < 0.002,
                "{metallic} {ior} {roughness}: {found} ± {error}"
            );
        }
    }
}

// It sends back what its parts say, and loses only what tiny mirrors throw to each other.
#[test]
fn phong_sends_back_no_more_light_than_arrives() {
    for exponent in [0.5, 5.0, 50.0, 5000.0] {
        for reflection in [Color::BLACK, half()] {
            let phong = Phong::new(half(), Color::WHITE, exponent, reflection).unwrap();
            let (found, _) = furnace(phong);
            assert!(
                found > 0.4 && found < 1.001,
                "{exponent} {reflection:?}: {found}"
            );
        }
    }
}

// Under one light, what paths and direct lighting show of it differs by the mirrored ray alone.
#[test]
fn principled_surfaces_scatter_the_same_under_direct_lighting() {
    let plastic = Principled::new(half(), 0.3, 0.4, 1.5).unwrap();
    let light = point(DVec3::new(1.0, 3.0, -2.0), 9.0);
    let world = World::new(vec![floor(plastic)], Color::BLACK);
    let direct = world.clone().lit(Lighting::new(vec![light.clone()]));
    let paths = by_paths(vec![floor(plastic)], vec![light], (options(4), 1));
    let ray = down(0.3);
    let [one, other] = [&direct, &paths].map(|world| world.radiance(&ray).r());
    assert!((one - other).abs() < 1e-12 && one > 0.1, "{one} {other}");
}

// The irradiance of a sky on a level floor: π (h + 2/3 (z - h)).
#[test]
fn surroundings_light_a_floor_and_are_seen() {
    let gray = |light| Color::from_linear(Radiance::WHITE * light);
    let white = Environment::new(Color::WHITE, 0.5).unwrap();
    let sky = Sky {
        zenith: gray(0.8),
        horizon: gray(0.2),
        ground: gray(0.5),
    };
    let sky = Environment::of_sky(sky, 3.0 * DVec3::Y, 2.0).unwrap();
    for (light, expected, above) in [(white, 0.25, 0.5), (sky, 0.5 * 2.0 * 0.6, 1.6)] {
        let world = |light: Environment, geometries| {
            by_paths(geometries, vec![light.into()], (options(1 << 12), 8))
        };
        let scene = world(light.clone(), vec![floor(half())]);
        assert_mean(mean(&scene, &down(0.0)), expected);
        let up = Ray::new(DVec3::Y, DVec3::Y);
        assert!((mean(&scene, &up).0 - above).abs() < 1e-12);
        assert_eq!(
            mean(&world(light.clone().visible(false), vec![]), &up).0,
            0.0
        );
        let direct = scene.lit(Lighting::new(vec![light.into()]));
        assert_eq!(direct.radiance(&down(0.0)), Radiance::BLACK);
    }
}

#[test]
fn a_picture_of_the_surroundings_lights_a_floor() {
    // A few bright pixels, some of them above the horizon.
    let mut light = vec![[0.1, 0.1, 0.1]; 8 * 6];
    light[8 + 3] = [60.0, 30.0, 20.0];
    light[2 * 8 + 7] = [7.0, 0.0, 0.0];
    light[4 * 8] = [50.0, 50.0, 50.0];
    let picture = SkyPicture::new(Texels::new(8, 6, light).unwrap()).unwrap();
    let up = DVec3::new(0.2, 1.0, -0.3);
    let environment = Environment::of_picture(&picture, up, 130.0, 0.5).unwrap();
    let steps = 600;
    let (mut expected, part) = (0.0, 1.0 / f64::from(steps));
    for row in 0..steps {
        for column in 0..steps {
            let pair = [row, column].map(|step| (f64::from(step) + 0.5) * part);
            let d = LocalFrame::new(DVec3::Y).outward(cosine_weighted(pair));
            expected += 0.5 * environment.radiance(d).r() * part * part;
        }
    }
    let lights = vec![environment.into()];
    let world = by_paths(vec![floor(half())], lights, (options(1 << 14), 8));
    assert_mean(mean(&world, &down(0.0)), expected);
}

// Light stays inside for long, so that a few paths end before.
#[test]
fn rough_glass_sends_on_all_light() {
    for roughness in [0.1, 0.3, 0.5, 0.75, 1.0] {
        let glass = Glass::new(Color::WHITE, 1.5).unwrap();
        let (found, error) = furnace(glass.with_roughness(roughness).unwrap());
        assert!(
            (found - 1.0).abs() < 0.012,
            "{roughness}: {found} ± {error}"
        );
    }
    // Between parallel panes, nothing is lost but at grazing angles.
    let pane = Glass::new(Color::WHITE, 1.5).unwrap().with_roughness(0.4);
    let disc = Disc::new(DVec3::ZERO, DVec3::Z, 4.0).unwrap();
    let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
    let scene = vec![
        sphere(DVec3::ZERO, 50.0, lamp),
        Geometry::new(disc, pane.unwrap()),
    ];
    let world = by_paths(scene, vec![], (options(1 << 14), 32));
    let ray = Ray::new(DVec3::new(0.1, 0.2, 3.0), unit(DVec3::new(0.3, 0.1, -1.0)));
    let (found, error) = mean(&world, &ray);
    assert!((found - 1.0).abs() < 0.002 + error, "{found} ± {error}");
}

// A lamp seen through rough glass is as bright by aiming as by chance.
#[test]
fn rough_glass_scatters_what_is_aimed_at_as_what_is_found() {
    for is_pane in [false, true] {
        let glass = Glass::new(half(), 1.5)
            .unwrap()
            .with_roughness(0.5)
            .unwrap();
        let shape: Shape = match is_pane {
            true => Disc::new(DVec3::ZERO, DVec3::Z, 2.0).unwrap().into(),
            false => Plane::new(DVec3::ZERO, DVec3::Z).unwrap().into(),
        };
        let lamp = Emissive::new(Color::WHITE, 1.0).unwrap();
        for z in [-3.0, 3.0] {
            let lamp = sphere(DVec3::new(0.5, 0.3, z), 1.0, lamp);
            let scene = vec![Geometry::new(shape.clone(), glass), lamp];
            let world = by_paths(scene, vec![], (options(1 << 14), 1));
            let ray = Ray::new(DVec3::new(0.0, 2.0, 3.0), unit(DVec3::new(0.0, -2.0, -3.0)));
            let aimed = mean(&world, &ray);
            let lighting = world.lighting().unwrap();
            let options = *world.paths().unwrap();
            let mut paths = PathTracer::new(&world, lighting, options, &world, false);
            paths.emitters = Arc::default();
            let count = 1 << 17;
            let sum = (0..count).fold(0.0, |sum, sample| {
                let sampler = Sampler::new([1, 1], sample, 0);
                sum + paths.sample(ray, &sampler).light.parts.sum().r()
            });
            let by_chance = sum / f64::from(count);
            let apart = (aimed.0 / by_chance - 1.0).abs();
            assert!(apart < 0.03, "{is_pane} {z} {aimed:?} {by_chance}");
        }
    }
}

/// Returns the mean light of a floor under a lamp with something between them, to 1 %.
fn under_a_lamp(between: Vec<Geometry>, caustics: bool) -> f64 {
    let lamp = Rectangle::new(DVec3::new(-1.0, 3.0, -1.0), 2.0 * DVec3::X, 2.0 * DVec3::Z);
    let lamp = Geometry::new(lamp.unwrap(), Emissive::new(Color::WHITE, 4.0).unwrap());
    let options = PathOptions {
        caustics,
        ..options(1 << 14)
    };
    let geometries = [floor(half()), lamp].into_iter().chain(between);
    let world = by_paths(geometries.collect(), vec![], (options, 16));
    let ray = Ray::new(DVec3::new(4.0, 0.4, 0.0), unit(DVec3::new(-4.0, -0.4, 0.1)));
    mean(&world, &ray).0
}

fn block(ior: f64, roughness: f64) -> Geometry {
    let glass = Glass::new(Color::WHITE, ior).unwrap();
    let block = Cuboid::new(DVec3::new(-1.5, 1.0, -1.5), DVec3::new(1.5, 2.0, 1.5)).unwrap();
    Geometry::new(block, glass.with_roughness(roughness).unwrap())
}

#[test]
fn glass_that_does_not_bend_light_changes_nothing() {
    for caustics in [true, false] {
        let free = under_a_lamp(vec![], caustics);
        for roughness in [0.0, 0.4] {
            let found = under_a_lamp(vec![block(1.0, roughness)], caustics);
            assert!(
                (found / free - 1.0).abs() < 0.02,
                "{caustics} {roughness}: {found} {free}"
            );
        }
    }
}

#[test]
fn panes_on_a_block_of_glass_are_in_it_in_any_order() {
    let pane = |y: f64| {
        let disc = Disc::new(DVec3::new(0.0, y, 0.0), DVec3::Y, 5.0).unwrap();
        Geometry::new(disc, Glass::new(Color::WHITE, 1.5).unwrap())
    };
    let block = || block(1.5, 0.0);
    let last = under_a_lamp(vec![block(), pane(1.0), pane(2.0)], true);
    let first = under_a_lamp(vec![pane(1.0), pane(2.0), block()], true);
    assert!((first / last - 1.0).abs() < 1e-12, "{first} {last}");
}
