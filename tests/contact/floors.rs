//! A box of glass that stands on a floor, and windows.

use std::f64::consts::PI;

use strahl::{Ray, Vec3};

use crate::{
    form::Form,
    media::{CLEAR, Scene, Stuff, fresnel},
    stacks::{grouped, middle},
    support::{Rng, Tally, cases},
};

const FLOOR: Stuff = Stuff::Matte(0.8);

/// Returns floors with the height 0.
fn floors() -> [(&'static str, Form); 4] {
    let corners = [
        [-4.0, -4.0, 0.0],
        [5.0, -4.0, 0.0],
        [5.0, 4.0, 0.0],
        [-4.0, 4.0, 0.0],
    ];
    [
        ("plane", Form::Plane(Vec3::ZERO, Vec3::Z)),
        (
            "box",
            Form::Cuboid(Vec3::new(-5.0, -5.0, -1.0), Vec3::new(5.0, 5.0, 0.0)),
        ),
        ("mesh", Form::mesh(&corners, &[[0, 1, 2], [0, 2, 3]])),
        (
            "rectangle",
            Form::Rectangle(Vec3::new(-4.0, -4.0, 0.0), 8.0 * Vec3::X, 8.0 * Vec3::Y),
        ),
    ]
}

fn tinted(rng: &mut Rng) -> Stuff {
    Stuff::Glass {
        ior: rng.one(&[1.33, 1.5, 1.9]),
        color: rng.one(&[1.0, 0.9]),
    }
}

#[test]
fn a_box_of_glass_on_a_floor_shows_the_floor() {
    let mut tally = Tally::new("a box of glass on a floor");
    let mut rng = Rng(0x5eed_0071);
    for _ in 0..cases(160) {
        for (name, floor) in floors() {
            let [low, high] = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.1, 0.9, 0.3)];
            let cube = Form::Cuboid(low, high);
            let mut items = vec![(cube, tinted(&mut rng)), (floor, FLOOR)];
            if rng.below(2) == 0 {
                items.reverse();
            }
            let scene = Scene {
                sun: (rng.below(3) > 0)
                    .then(|| Vec3::new(rng.signed(), rng.signed(), rng.between(0.3, 1.0))),
                ..Scene::new(items)
            };
            let ray = |_| {
                let through = rng.vector() * Vec3::new(1.2, 1.2, 0.15) + Vec3::Z * 0.15;
                let o = 4.0 * rng.direction();
                let o = Vec3::new(o.x, o.y, o.z.abs() + 0.5);
                Ray::new(o, through - o)
            };
            let rays: Vec<_> = (0..6).map(ray).collect();
            let before = tally.wrong();
            match rng.below(2) {
                0 => scene.count(&mut tally, &rays, &scene, 1e-6),
                _ => {
                    let (scene, rays) = grouped(&mut rng, &scene, &rays);
                    scene.count(&mut tally, &rays, &scene, 1e-6);
                }
            }
            tally.note(name, before);
        }
    }
    tally.none();
}

/// The picture of floor.ron, with the list both ways and turned.
#[test]
fn the_picture_of_a_box_on_a_floor() {
    let things = [
        "Box(min: (-1, 0, -1), max: (1, 0.3, 1), material: Glass())",
        r##"Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#ff0000")"##,
    ];
    let orders = [[0, 1], [1, 0]].map(|order| order.map(|at| things[at]).join(", "));
    let group = format!(
        "Group(transform: (rotate: (axis: (0, 1, 0), angle: 20)), geometries: [{}])",
        orders[0]
    );
    for list in orders.iter().chain([&group]) {
        let text = format!(
            r##"(image: (width: 3, height: 3), background: "#0000ff",
            camera: Perspective(eye: (0, 2, 0.001), look_at: (0, 0, 0), fov: 1),
            lights: [Ambient(intensity: 1)], geometries: [{list}])"##
        );
        assert_eq!(middle(&text), [250, 0, 56], "{list}");
    }
}

/// Returns panes that touch each other, in the air above the floor.
fn window(count: usize) -> Vec<(Form, Stuff)> {
    let heights = [1.0, 1.1, 1.2, 1.3];
    let pane = |at: usize| {
        let [low, high] = [heights[at], heights[at + 1]];
        Form::Cuboid(Vec3::new(-90.0, -90.0, low), Vec3::new(90.0, 90.0, high))
    };
    (0..count).map(|at| (pane(at), CLEAR)).collect()
}

/// A window lets (1-F)² through, also one of several panes that touch.
#[test]
fn the_shadow_of_a_window_is_that_of_two_faces() {
    let mut tally = Tally::new("windows");
    // By the contract, to three digits.
    let rounded = [0.922, 0.902, 0.830, 0.558, 0.150];
    for (degrees, rounded) in [0.0, 45.0, 60.0, 75.0, 85.0].into_iter().zip(rounded) {
        let (sin, cos) = libm::sincos(degrees * (PI / 180.0));
        let passed = 1.0 - fresnel(cos, 1.5).0;
        assert!((passed * passed - rounded).abs() < 6e-4, "{degrees}");
        for count in 1..=3 {
            for is_reversed in [false, true] {
                let mut items = window(count);
                items.push((Form::Plane(Vec3::ZERO, Vec3::Z), Stuff::Matte(1.0)));
                if is_reversed {
                    items.reverse();
                }
                let scene = Scene {
                    ambient: 0.0,
                    sun: Some(Vec3::new(sin, 0.0, cos)),
                    ..Scene::new(items)
                };
                let ray = Ray::new(Vec3::new(0.0, 0.3, 0.8), Vec3::new(0.1, 0.0, -0.8));
                let found = scene.world().radiance(&ray).r();
                tally.count([found, 1e-9], Some(passed * passed * cos), || {
                    format!("{degrees} degrees, {count} panes")
                });
            }
        }
    }
    tally.none();
}

/// Pale, 0.92 in the middle and 0.79 at nine tenths of the radius.
#[test]
fn the_shadow_of_a_ball_is_pale() {
    let mut tally = Tally::new("the shadow of a ball");
    for (away, rounded) in [(0.0, 0.92), (0.5, 0.91), (0.9, 0.79)] {
        let cos = f64::sqrt(1.0 - away * away);
        let passed = 1.0 - fresnel(cos, 1.5).0;
        let right = passed * passed;
        assert!((right - rounded).abs() < 0.01, "{away}: {right}");
        let ball = (Form::Ball(Vec3::new(0.0, 0.0, 2.0), 1.0), CLEAR);
        let floor = (Form::Plane(Vec3::ZERO, Vec3::Z), Stuff::Matte(1.0));
        for items in [vec![ball.clone(), floor.clone()], vec![floor, ball]] {
            let scene = Scene {
                ambient: 0.0,
                sun: Some(Vec3::Z),
                ..Scene::new(items)
            };
            let ray = Ray::new(Vec3::new(3.0, 0.0, 1.0), Vec3::new(away - 3.0, 0.0, -1.0));
            let found = scene.world().radiance(&ray).r();
            tally.count([found, 1e-9], Some(right), || format!("at {away} radii"));
        }
    }
    tally.none();
}
