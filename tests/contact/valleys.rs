//! Mirrors and highlights in valleys, where two surfaces meet.

use std::f64::consts::PI;

use strahl::{
    Color, Geometry, Lighting, Radiance, Ray, Vec3, World,
    material::{Material, Phong},
};

use crate::{
    bounces::{Bounces, Finish},
    columns::{column, halves, roof},
    form::Form,
    shadow::Lamp,
    support::{Rng, Tally, cases, example},
};

pub(crate) const MIRROR: Finish = Finish {
    diffuse: 0.0,
    specular: 0.0,
    exponent: 1.0,
    mirror: 0.5,
};

const MATTE: Finish = Finish {
    diffuse: 0.8,
    mirror: 0.0,
    ..MIRROR
};

pub(crate) const GLOSSY: Finish = Finish {
    diffuse: 0.6,
    specular: 0.3,
    exponent: 12.0,
    mirror: 0.4,
};

fn gray(linear: f64) -> Color {
    Color::from_linear(Radiance::WHITE * linear)
}

fn material(finish: Finish) -> Material {
    let Finish {
        diffuse,
        specular,
        exponent,
        mirror,
    } = finish;
    if diffuse == 0.0 && specular == 0.0 {
        return Material::Mirror(gray(mirror));
    }
    Phong::new(gray(diffuse), gray(specular), exponent, gray(mirror))
        .unwrap()
        .into()
}

pub(crate) fn world(items: &[(Form, Finish)], lamp: Lamp, max_depth: u32) -> World {
    let geometries = items
        .iter()
        .map(|(form, finish)| Geometry::new(form.shape(), material(*finish)));
    let lighting = Lighting {
        max_depth,
        ..Lighting::new(vec![lamp.light()])
    };
    World::new(geometries.collect(), Color::WHITE).lit(lighting)
}

/// Returns two forms whose common edge lies in the plane x = 0.
pub(crate) fn valleys() -> Vec<(&'static str, Vec<Form>)> {
    let mut all = Vec::new();
    for slope in [0.3, 0.8, 1.7, 3.0] {
        let n = |x: f64| Vec3::new(-slope * x, 1.0, 0.1);
        all.push(("planes", halves(|x| Form::Plane(Vec3::ZERO, n(x)))));
        let [low, high] = [Vec3::new(0.0, 0.0, -1.2), Vec3::new(0.0, 0.1, 1.2)];
        let sheet = |x: f64| Form::Rectangle(low, high - low, Vec3::new(x, slope, 0.05));
        all.push(("rectangles", halves(sheet)));
        let of_mesh = roof(0.5 * slope);
        all.push(("mesh", vec![of_mesh]));
    }
    for r in [0.6, 0.8] {
        let ball = |x: f64| Form::Ball(Vec3::new(0.5 * x, 0.0, 0.1), r);
        all.push(("balls", halves(ball)));
    }
    let arm = |x: f64| [Vec3::new(-x, -0.4, 0.1), Vec3::new(x, 0.4, 0.1)];
    all.push((
        "cylinders",
        halves(|x| Form::Cylinder(arm(x)[0], arm(x)[1], 0.3)),
    ));
    all.push(("floor and wall", {
        let wall = Form::Cuboid(Vec3::new(0.3, 0.0, -0.9), Vec3::new(0.9, 1.0, 0.9));
        vec![Form::Plane(Vec3::ZERO, Vec3::Y), wall]
    }));
    all
}

#[test]
fn mirrors_and_highlights_in_valleys() {
    let mut tally = Tally::new("mirrors and Phong in valleys");
    let mut rng = Rng(0x5eed_0051);
    let rows = cases(48).min(48) as u32;
    let finishes = [
        ("mirrors", [MIRROR, MIRROR]),
        ("mirror and matte", [MIRROR, MATTE]),
        ("matte and mirror", [MATTE, MIRROR]),
        ("glossy", [GLOSSY, GLOSSY]),
        ("glossy and mirror", [GLOSSY, MIRROR]),
    ];
    for (shapes, forms) in valleys() {
        for (name, of) in finishes {
            let mut items: Vec<_> = forms.iter().cloned().zip(of).collect();
            items.push((Form::Ball(Vec3::new(1.6, 2.5, 0.4), 0.6), MATTE));
            for _ in 0..2 {
                let lamp = Lamp::Sun(Vec3::new(rng.signed(), rng.between(0.1, 1.0), rng.signed()));
                let world = world(&items, lamp, 8);
                let right = Bounces {
                    items: &items,
                    background: 1.0,
                    lamp,
                    max_depth: 8,
                };
                let mut rays = column(Vec3::new(0.0, 2.0, 3.0), rows);
                if shapes == "floor and wall" {
                    let eye = Vec3::new(-2.0, 1.5, 0.4);
                    let foot =
                        |row: u32| Vec3::new(0.3, 0.0, f64::from(row) / f64::from(rows) - 0.5);
                    rays = (0..rows)
                        .map(|row| Ray::new(eye, foot(row) - eye))
                        .collect();
                }
                let before = tally.wrong();
                for ray in &rays {
                    let Some((index, hit)) = world.hit(ray) else {
                        continue;
                    };
                    let expected = right.light(ray, (index, &hit));
                    let found = world.radiance(ray).r();
                    tally.count([found, 1e-6], expected, || {
                        example(&items, ray, format!("{lamp:?}"))
                    });
                }
                tally.note(name, before);
                tally.note(shapes, before);
            }
        }
    }
    tally.none();
}

/// A ray down the middle of a wedge with an opening of θ is mirrored π/θ times, rounded: unfolded, it is
/// a straight line.
#[test]
fn mirrored_rays_count_their_mirrors() {
    let mut tally = Tally::new("wedges of mirrors");
    for degrees in [150.0, 100.0, 90.0, 80.0, 60.0, 47.0, 42.0, 33.0] {
        let half = degrees / 2.0 * (PI / 180.0);
        let (sin, cos) = libm::sincos(half);
        let plane = |x: f64| Form::Plane(Vec3::ZERO, Vec3::new(-x * cos, sin, 0.0));
        let sheet = |x: f64| {
            let [from, along] = [Vec3::new(0.0, 0.0, -2.0), Vec3::new(0.0, 0.0, 4.0)];
            Form::Rectangle(from, along, Vec3::new(3.0 * x * sin, 3.0 * cos, 0.0))
        };
        for forms in [halves(plane), halves(sheet)] {
            let items: Vec<_> = forms.into_iter().map(|form| (form, MIRROR)).collect();
            let world = world(&items, Lamp::Sun(Vec3::Y), 8);
            let count = (180.0_f64 / degrees).round() as usize;
            let right = [0.5; 8][..count].iter().product();
            for ray in column(Vec3::new(0.0, 2.0, 1.0), 24) {
                let found = world.radiance(&ray).r();
                tally.count([found, 1e-9], Some(right), || {
                    example(&items, &ray, format!("{degrees} degrees"))
                });
            }
        }
    }
    tally.none();
}

/// Light that comes from behind one of the faces does not reach the edge, however low it stands.
#[test]
fn grazing_suns_in_a_valley() {
    let mut tally = Tally::new("grazing suns in valleys, by the signs of n·l");
    for slope in [0.1, 0.5, 2.0] {
        let n = |x: f64| Vec3::new(-slope * x, 1.0, 0.0);
        let plane = |x: f64| Form::Plane(Vec3::ZERO, n(x));
        let sheet = |x: f64| {
            let [from, along] = [Vec3::new(0.0, 0.0, -2.0), Vec3::new(0.0, 0.0, 4.0)];
            Form::Rectangle(from, along, Vec3::new(x, slope, 0.0))
        };
        for forms in [halves(plane), halves(sheet)] {
            for part in [1e-2, 1e-4, 1e-6, 1e-8] {
                for (sign, side) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    // A little above or below one of the faces, up along it.
                    let along = Vec3::new(side, slope, 0.3);
                    let l = along + sign * part * n(side);
                    let items: Vec<_> = forms.iter().cloned().map(|form| (form, MATTE)).collect();
                    let world = world(&items, Lamp::Sun(l), 8);
                    for ray in column(Vec3::new(0.0, 2.0, 1.0), 24) {
                        let (_, hit) = world.hit(&ray).unwrap();
                        let facing = hit.normal * -hit.normal.dot(ray.direction()).signum();
                        let is_lit = sign > 0.0;
                        let right = if is_lit {
                            0.8 * facing.dot(l) / l.length()
                        } else {
                            0.0
                        };
                        let found = world.radiance(&ray).r();
                        tally.count([found, 1e-12], Some(right), || {
                            example(&items, &ray, format!("{l:?}"))
                        });
                    }
                }
            }
        }
    }
    tally.none();
}
