//! Lit pictures, made with the library.

use strahl::{
    Camera, Color, Geometry, ImageFormat, Lighting, PerspectiveCamera, Plane, RayTracer,
    RenderOptions, Scene, Sphere, Syntax, Vec3, World,
    film::{Outlines, Samples},
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

/// Returns the ink of each row of two white balls that cut each other, by lines from the left.
fn ink_of_rows(centers: [Vec3; 2], outlines: Outlines) -> Vec<Vec<f64>> {
    let radii = [1.0, 0.8];
    let balls = centers
        .iter()
        .zip(radii)
        .map(|(center, radius)| Geometry::new(Sphere::new(*center, radius).unwrap(), Color::WHITE));
    let world = World::new(balls.collect(), Color::WHITE);
    let eye = Vec3::new(0.0, 0.0, 8.0);
    let camera = PerspectiveCamera::new(eye, -eye, Vec3::Y, 0.2).unwrap();
    let camera = Camera::from(camera);
    let image = RayTracer::new(&camera, &world, 150, 100)
        .unwrap()
        .samples(Samples::new(16).unwrap())
        .outlines(outlines)
        .draw();
    let rows = (0..100).map(|row| {
        let mut lines = vec![0.0];
        for column in 0..150 {
            let [level, _, _] = image.pixel(column, row).unwrap();
            let level = f64::from(level) / 255.0;
            let ink = 1.0 - Color::new(level, 0.0, 0.0).to_linear().r();
            match lines.last_mut() {
                Some(line) if ink > 0.001 => *line += ink,
                Some(line) if *line > 0.0 => lines.push(0.0),
                _ => {}
            }
        }
        lines.retain(|line| *line > 0.0);
        lines
    });
    rows.collect()
}

#[test]
fn a_line_where_balls_cut_each_other_is_as_wide_as_any_other() {
    let outlines = Outlines {
        width: 2.0,
        ..Outlines::default()
    };
    // Beside each other, and one before the other by more and more.
    for depth in [0.0, 0.05, 0.1, 0.3, 0.5, -0.02, -0.2, -0.4] {
        let centers = [Vec3::new(-0.6, 0.0, depth), Vec3::new(0.6, 0.0, -depth)];
        let rows = ink_of_rows(centers, outlines);
        // Through the middle of both, all three lines are upright.
        for lines in &rows[42..58] {
            assert_eq!(lines.len(), 3, "{depth}: {lines:?}");
            for line in lines {
                assert!((1.4..2.4).contains(line), "{depth}: {lines:?}");
            }
        }
        // No line is missing, and there are no specks.
        let ink: f64 = rows.iter().flatten().sum();
        for lines in &rows {
            assert!(lines.len() <= 4, "{depth}: {lines:?}");
        }
        assert!(ink > 300.0, "{depth}: {ink}");
    }
}

/// A box with a small lamp and a ball of glass, whose caustic is noisy.
const LAMP: &str = include_str!("golden/paths/noise.ron");

/// Returns the mean light of a picture.
fn mean_light(lighting: &str) -> f64 {
    let text = LAMP.replace("samples: 256, noise: 0.1", lighting);
    let text = text.replace("width: 48, height: 36", "width: 32, height: 24");
    let scene = Scene::from_text(text, Syntax::Ron).unwrap();
    let mut file = Vec::new();
    scene
        .write_with(&mut file, ImageFormat::PFM, &RenderOptions::new())
        .unwrap();
    let numbers = &file[file.len() - 32 * 24 * 3 * 4..];
    let numbers = numbers.as_chunks::<4>().0.iter();
    numbers
        .map(|bytes| f64::from(f32::from_le_bytes(*bytes)))
        .sum()
}

// A block that is dark by chance ends early: a slight bias, which is much larger with single pixels in place of
// blocks.
#[test]
fn less_noise_does_not_change_the_mean() {
    let all = mean_light("samples: 1024");
    let fewer = mean_light("samples: 1024, noise: 0.05");
    let bias = fewer / all - 1.0;
    assert!(bias != 0.0 && bias.abs() < 0.002, "{bias}");
}
