//! Lit pictures, made with the library.

use strahl::{
    Camera, Color, Geometry, Lighting, PerspectiveCamera, Plane, RayTracer, Sphere, Vec3, World,
    film::Outlines,
    light::{Ambient, Falloff, Light, Point},
    material::{Glass, Material, Phong},
    render::{Tone, ToneMapping},
};

const SIZE: (u32, u32) = (48, 36);

fn world() -> World {
    let grey = Color::new(0.8, 0.8, 0.8);
    let ball = |x: f64, z: f64, r: f64, material: Material| {
        Geometry::new(Sphere::new(Vec3::new(x, r, z), r).unwrap(), material)
    };
    let gold = Phong::new(
        Color::new(0.7, 0.5, 0.1),
        Color::new(1.0, 0.9, 0.6),
        60.0,
        Color::new(0.3, 0.3, 0.3),
    );
    let glass = Glass::new(Color::WHITE, 1.5).unwrap();
    let world = World::new(
        vec![
            Geometry::new(Plane::new(Vec3::ZERO, Vec3::Y).unwrap(), grey),
            ball(-1.2, 0.0, 1.0, gold.unwrap().into()),
            ball(1.0, 0.5, 0.8, glass.into()),
            ball(0.0, 1.6, 0.4, Material::Mirror(Color::WHITE)),
            ball(2.2, -1.0, 0.7, Color::new(0.8, 0.1, 0.1).into()),
        ],
        Color::new(0.6, 0.7, 0.9),
    );
    let position = Vec3::new(3.0, 5.0, 4.0);
    let point = Point::new(position, Color::WHITE, 30.0, Falloff::InverseSquare, true);
    world.lit(Lighting::new(vec![
        Light::from(Ambient::new(Color::WHITE, 0.2).unwrap()),
        Light::from(point.unwrap()),
    ]))
}

fn camera() -> Camera {
    let (eye, gaze) = (Vec3::new(0.0, 2.0, 7.0), Vec3::new(0.0, -0.2, -1.0));
    PerspectiveCamera::new(eye, gaze, Vec3::Y, 0.35)
        .unwrap()
        .into()
}

#[test]
fn each_pixel_is_the_radiance_of_its_ray() {
    let (camera, world) = (camera(), world());
    let (width, height) = SIZE;
    let tone = Tone::new(-0.5, ToneMapping::Neutral);
    let tracer = RayTracer::new(&camera, &world, width, height).unwrap();
    let image = tracer.tone(tone).draw();
    for row in 0..height {
        for column in 0..width {
            let y = f64::from(height - 1 - row);
            let ray = camera.ray_for(width, height, column.into(), y);
            let color = tone.color(world.radiance(&ray));
            let found = image.pixel(column, row);
            assert_eq!(found, Some(color.to_rgb8()), "pixel {column},{row}");
        }
    }
}

#[test]
fn outlines_are_where_a_geometry_ends() {
    let (camera, world) = (camera(), world());
    let outlines = Outlines {
        color: Color::new(1.0, 0.0, 1.0),
        ..Outlines::default()
    };
    let tracer = RayTracer::new(&camera, &world, SIZE.0, SIZE.1).unwrap();
    let (plain, inked) = (tracer.draw(), tracer.outlines(outlines).draw());
    let pixels = plain.pixels().chunks(3).zip(inked.pixels().chunks(3));
    let changed: Vec<_> = pixels.filter(|(plain, inked)| plain != inked).collect();
    assert!(changed.iter().all(|(_, inked)| *inked == [255, 0, 255]));
    assert!((60..400).contains(&changed.len()), "{}", changed.len());
}
