//! Random worlds and cameras.

use glam::DVec3;

use crate::tracer::{
    camera::{Camera, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
    color::Color,
    geometry::Geometry,
    light::{
        Ambient, Backdrop, Cone, Directional, Environment, Headlight, Light, Point, Sky, Spot,
        falloff::Falloff, picture::SkyPicture,
    },
    material::{
        Emissive, Glass, Material, Phong, Principled,
        texture::{Checkerboard, ImageTexture, Texture, TextureMapping},
    },
    random::Rng,
    shape::{
        Shape,
        any::{any, touching, unbounded},
        cuboid::Cuboid,
        plane::Plane,
        sphere::Sphere,
    },
    texels::{TexelWrap, Texels},
    world::{Lighting, World},
};

pub(super) fn color(random: &mut Rng) -> Color {
    let mut channel = || random.one(&[0.0, 0.2, 0.5, 128.0 / 255.0, 0.9, 1.0]);
    Color::new(channel(), channel(), channel())
}

pub(super) fn material(random: &mut Rng) -> Material {
    let first = color(random);
    match random.below(10) {
        0 => Material::Mirror(first),
        6 => {
            let (metallic, roughness) =
                (random.one(&[0.0, 0.5, 1.0]), random.one(&[0.0, 0.1, 0.6]));
            Principled::new(first, metallic, roughness, random.one(&[1.0, 1.5, 3.0]))
                .unwrap()
                .into()
        }
        1 => {
            let ior = random.one(&[0.25, 0.7, 1.0, 1.33, 1.5, 4.0]);
            let glass = Glass::new(first, ior).unwrap();
            let roughness = random.one(&[0.0, 0.0, 0.3]);
            glass.with_roughness(roughness).unwrap().into()
        }
        2 => Material::Flat(first),
        3 => Emissive::new(first, random.magnitude(-1.0, 2.0))
            .unwrap()
            .into(),
        4 | 5 => {
            let (specular, reflection) = (color(random), color(random));
            let reflection = random.one(&[Color::BLACK, reflection]);
            let exponent = random.magnitude(-1.0, 5.0);
            Phong::new(first, specular, exponent, reflection)
                .unwrap()
                .into()
        }
        _ => Material::Matte(first),
    }
}

/// Returns a light near a place of a size; it may lie on a surface or inside of one.
pub(super) fn light(random: &mut Rng, middle: DVec3, size: f64, geometries: &[Geometry]) -> Light {
    let (hue, intensity) = (color(random), random.magnitude(-1.0, 2.0));
    let shadows = random.below(5) > 0;
    let falloff = random.one(&[Falloff::InverseSquare, Falloff::Constant]);
    let mut position = middle + random.vector() * size * random.one(&[0.5, 1.0, 3.0, 1e4]);
    if let Some(geometry) = geometries.get(random.below(3 * geometries.len().max(1)))
        && let Some(sphere) = geometry.shape().sphere()
    {
        let out = random.one(&[0.0, 0.5, 1.0]) * sphere.radius();
        position = sphere.center() + out * DVec3::Y;
    }
    let towards = random.vector() + 1e-9 * DVec3::X;
    match random.below(7) {
        6 => match random.below(3) {
            0 => {
                let (width, height) =
                    (random.one(&[1, 3, 8]) as u32, random.one(&[1, 2, 5]) as u32);
                let mut light = || [random.signed().abs(), 0.5, 9.0].map(|part| part as f32);
                let light = (0..width * height).map(|_| light()).collect();
                let picture = SkyPicture::new(Texels::new(width, height, light).unwrap()).unwrap();
                let turn = random.one(&[0.0, 77.0]);
                Environment::of_picture(&picture, towards, turn, intensity)
                    .unwrap()
                    .into()
            }
            _ => Environment::new(hue, intensity).unwrap().into(),
        },
        0 => Ambient::new(hue, intensity).unwrap().into(),
        1 => Headlight::new(hue, intensity).unwrap().into(),
        2 => Directional::new(towards, hue, intensity, shadows)
            .unwrap()
            .with_angle(random.one(&[0.0, 5.0, 90.0]))
            .unwrap()
            .into(),
        3 => {
            let cone = Cone {
                direction: middle - position + 1e-9 * towards,
                angle: random.one(&[1e-3, 20.0, 60.0, 179.0]),
                blend: random.one(&[0.0, 0.15, 1.0]),
            };
            let spot = Spot::new(position, cone, hue, intensity, falloff, shadows);
            spot.unwrap().into()
        }
        _ => Point::new(position, hue, intensity, falloff, shadows)
            .unwrap()
            .with_radius(random.one(&[0.0, 0.3 * size]))
            .unwrap()
            .into(),
    }
}

/// Gives a geometry a texture.
fn textured(random: &mut Rng, geometry: Geometry, (middle, size): (DVec3, f64)) -> Geometry {
    let texture = match random.below(2) {
        0 => {
            let cell = random.one(&[0.1, 0.3 * size]);
            Texture::Checker(Checkerboard::new(color(random), color(random), cell).unwrap())
        }
        _ => {
            let mut light = || [random.signed().abs(), 0.5, 0.1].map(|part| part as f32);
            let light = (0..6).map(|_| light()).collect();
            Texture::Image(ImageTexture {
                texels: Texels::new(3, 2, light).unwrap(),
                is_smooth: random.below(2) == 0,
                wrap: random.one(&[TexelWrap::Repeat, TexelWrap::Clamp]),
            })
        }
    };
    let mapping = match random.below(4) {
        0 => TextureMapping::planar(middle, [DVec3::X * size, DVec3::new(0.1, 1.0, 0.2) * size]),
        1 => TextureMapping::spherical(middle, DVec3::Y, DVec3::new(1.0, 0.5, 0.0)),
        _ => Ok(TextureMapping::Natural),
    };
    geometry.textured(texture, mapping.unwrap())
}

pub(super) fn world(random: &mut Rng, middle: DVec3, size: f64) -> World {
    let count = random.one(&[0, 1, 2, 9, 40, 300]);
    let mut geometries = Vec::new();
    let (mut center, mut radius) = (middle, size);
    for _ in 0..count {
        match random.below(8) {
            // Touches the last.
            0 => center.x += 2.0 * radius,
            // Inside of the last.
            1 => radius *= 0.9,
            // Equal to the last.
            2 => {}
            _ => {
                center = middle + random.vector() * size;
                radius = size * random.magnitude(-2.0, -0.2);
            }
        }
        let shape = match random.below(4) {
            0 => match random.below(20) {
                0 => unbounded(random, center, radius),
                _ => any(random, center, radius),
            }
            .unwrap(),
            _ => Sphere::new(center, radius).unwrap().into(),
        };
        let faces = (0..random.one(&[0, 0, 1, 3])).map(|_| material(random));
        let faces: Vec<_> = faces.collect();
        let geometry = Geometry::new(shape, material(random)).by_face(faces);
        geometries.push(match random.below(8) {
            0 => textured(random, geometry, (middle, size)),
            _ => geometry,
        });
    }
    for _ in 0..random.one(&[0, 1, 1, 2, 4]) {
        let anywhere = random.vector();
        let point = middle + random.one(&[DVec3::NEG_Y, anywhere]) * size;
        let normal = random.one(&[DVec3::Y, DVec3::Z, DVec3::new(0.1, 1.0, 0.3)]);
        let plane = Plane::new(point, normal * random.magnitude(-3.0, 3.0)).unwrap();
        let at = random.below(geometries.len() + 1);
        let plane = Geometry::new(plane, material(random));
        let plane = match random.below(4) {
            0 => textured(random, plane, (middle, size)),
            _ => plane,
        };
        geometries.insert(at, plane);
    }
    let lights = (0..random.one(&[0, 1, 1, 2, 5]))
        .map(|_| light(random, middle, size, &geometries))
        .collect();
    let lighting = Lighting {
        max_depth: random.one(&[0, 1, 3, 8]) as u32,
        ..Lighting::new(lights)
    };
    let world = World::new(geometries, color(random));
    let world = match random.below(4) {
        0 => world.with_backdrop(backdrop(random)),
        _ => world,
    };
    match random.below(6) {
        0 => world,
        _ => world.lit(lighting),
    }
}

/// Returns surroundings whose light may be brighter than all lights.
fn backdrop(random: &mut Rng) -> Backdrop {
    let up = random.vector() + 1e-9 * DVec3::X;
    let backdrop = match random.below(2) {
        0 => {
            let [zenith, horizon, ground] = [(); 3].map(|()| color(random));
            let sky = Sky {
                zenith,
                horizon,
                ground,
            };
            Backdrop::of_sky(sky, up)
        }
        _ => {
            let most = random.one(&[1.0, 1e6]);
            let mut light = || [random.signed().abs() * most, 0.5, 0.0].map(|part| part as f32);
            let light = (0..12).map(|_| light()).collect();
            Backdrop::of_picture(Texels::new(4, 3, light).unwrap(), up, 50.0)
        }
    };
    backdrop.unwrap()
}

pub(super) fn camera(random: &mut Rng, middle: DVec3, size: f64) -> Camera {
    let away = random.vector() + DVec3::new(0.01, 0.02, 3.0);
    let eye = middle + away * size * random.one(&[0.3, 1.0, 2.0, 2.0, 1e3, 1e6]);
    let gaze = middle - eye;
    if random.below(4) == 0 {
        let camera = OrthographicCamera::with_square_pixels(eye, gaze, DVec3::Y, 2.0 * size);
        return camera.unwrap().into();
    }
    let angle = (size / gaze.length()).clamp(1e-7, 1.2);
    PerspectiveCamera::new(eye, gaze, DVec3::Y, angle)
        .unwrap()
        .into()
}

/// Returns a world in which half of the geometries touch others, and points that lie on several.
pub(super) fn touching_world(random: &mut Rng) -> (World, Vec<DVec3>) {
    let mut shapes: Vec<Shape> = Vec::new();
    for _ in 0..random.one(&[2, 4, 6, 12]) {
        let number = random.below(shapes.len().max(1));
        let grid = |x: f64| (x * 4.0).round() / 4.0;
        let place = random.vector() * 1.5;
        let shape = match shapes.get(number).filter(|_| random.below(2) == 0) {
            Some(other) => touching(random, other),
            None => {
                let round = DVec3::new(grid(place.x), grid(place.y), grid(place.z));
                let center = random.one(&[round, round, place]);
                let (half, turn) = (random.one(&[0.25, 0.5, 0.3]), random.below(3));
                match turn {
                    0 => any(random, center, half),
                    1 => Sphere::new(center, half).map(Shape::from),
                    _ => Cuboid::new(center - half, center + half).map(Shape::from),
                }
            }
        };
        shapes.extend(shape);
    }
    let corners = shapes
        .iter()
        .filter_map(Shape::bounds)
        .flat_map(|[low, high]| {
            let middle = (low + high) * 0.5;
            let edge = DVec3::new(high.x, middle.y, high.z);
            let side = DVec3::new(middle.x, middle.y, high.z);
            [low, high, edge, side, DVec3::new(middle.x, low.y, high.z)]
        });
    let corners = corners.collect();
    let glass: Material = Glass::new(color(random), 1.5).unwrap().into();
    let geometries = shapes.into_iter().map(|shape| {
        let of = match random.below(3) {
            0 => glass.clone(),
            _ => material(random),
        };
        Geometry::new(shape, of)
    });
    let geometries: Vec<_> = geometries.collect();
    let lights = (0..random.one(&[1, 2]))
        .map(|_| light(random, DVec3::ZERO, 1.0, &geometries))
        .collect();
    let lighting = Lighting {
        max_depth: random.one(&[1, 3, 6]) as u32,
        ..Lighting::new(lights)
    };
    let world = World::new(geometries, color(random)).lit(lighting);
    (world, corners)
}
