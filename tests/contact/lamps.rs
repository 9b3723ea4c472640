//! Lamps over and on edges.

use strahl::{Ray, Vec3, World};

use crate::{
    columns::{column, roof},
    form::Form,
    shadow::{Lamp, count_ray},
    support::{Rng, Tally, cases, lit_by, white},
};

/// Returns a box on a floor beside a roof, and points of their edges.
fn scene(rise: f64) -> (Vec<Form>, Vec<Vec3>) {
    let [low, high] = [Vec3::new(-1.3, -0.7, -0.4), Vec3::new(-0.6, 0.4, 0.3)];
    let forms = vec![
        roof(rise),
        Form::Cuboid(low, high),
        Form::Plane(Vec3::new(0.0, -0.7, 0.0), Vec3::Y),
        Form::Ball(Vec3::new(0.9, -0.2, 0.6), 0.5),
    ];
    let on = |part: f64| Vec3::new(0.0, 0.05 + 0.05 * part, part);
    let edges = vec![
        on(0.0),
        on(0.5),
        on(-0.25),
        Vec3::new(0.0, 0.0, -1.0),
        high,
        Vec3::new(high.x, high.y, 0.1),
        Vec3::new(low.x, high.y, -0.2),
        Vec3::new(high.x, 0.1, high.z),
        Vec3::new(0.2, high.y, high.z),
        Vec3::new(high.x, low.y, 0.1),
    ];
    (forms, edges)
}

#[test]
fn lamps_over_and_on_edges() {
    let mut tally = Tally::new("lamps over and on edges");
    let mut rng = Rng(0x5eed_0041);
    let count = cases(40).min(40);
    for rise in [0.3, -0.3] {
        let (forms, edges) = scene(rise);
        for edge in &edges {
            for height in [0.0, 1e-6, 1e-3, 0.1, 1.0] {
                let lamp = Lamp::At(*edge + height * Vec3::Y);
                let world: World = lit_by(&white(&forms), lamp.light());
                let eye = 3.0 * rng.direction();
                let eye = Vec3::new(eye.x, eye.y.abs() + 0.5, eye.z);
                let mut to_edges = Vec::new();
                for other in &edges {
                    to_edges.push(Ray::new(eye, *other - eye));
                }
                let anywhere = (0..count).map(|_| Ray::new(eye, rng.vector() - eye));
                let anywhere: Vec<_> = anywhere.collect();
                let middle = column(Vec3::new(0.0, 2.0, 3.0), count as u32);
                let before = tally.wrong();
                for ray in to_edges.iter().chain(&anywhere).chain(&middle) {
                    count_ray(&mut tally, &forms, (&world, lamp), ray);
                }
                tally.note(if height == 0.0 { "on" } else { "over" }, before);
            }
        }
    }
    tally.none();
}
