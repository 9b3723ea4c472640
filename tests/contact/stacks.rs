//! Stacks of panes: joined glass is one piece, in any order.

use strahl::{Ray, Syntax, Vec3, shape::Operation, shape::Transform};

use crate::{
    form::Form,
    media::{CLEAR, Scene, Stuff, fresnel},
    support::{Rng, Tally, cases},
};

pub(crate) fn shift(by: Vec3) -> Transform {
    Transform::new(by, None, Vec3::ONE).unwrap()
}

/// A floor far below, which is darker than the background.
pub(crate) fn ground() -> (Form, Stuff) {
    (Form::Plane(Vec3::Z * -10.0, Vec3::Z), Stuff::Flat(0.3))
}

/// Returns the numbers below `count` in a random order.
pub(crate) fn shuffled(rng: &mut Rng, count: usize) -> Vec<usize> {
    let mut order: Vec<_> = (0..count).collect();
    for last in (1..count).rev() {
        order.swap(last, rng.below(last + 1));
    }
    order
}

/// A pane from one height to another, so wide that nothing passes beside it.
fn pane(low: f64, high: f64) -> Form {
    Form::Cuboid(Vec3::new(-90.0, -90.0, low), Vec3::new(90.0, 90.0, high))
}

/// Returns the height of a joint. The numbers are rounded, as those in a file are.
fn height(joint: usize) -> f64 {
    [0.0, 0.1, 0.2, 0.3, 0.4, 0.5][joint]
}

/// Returns rays into a stack, from above and from below.
pub(crate) fn rays_into(rng: &mut Rng, top: f64, count: usize) -> Vec<Ray> {
    let ray = |_| {
        let through = 0.3 * rng.vector() * Vec3::new(1.0, 1.0, 0.0);
        let slope = rng.one(&[0.0, 0.3, 1.0, 3.0]);
        let side = rng.one(&[3.0, 3.0, -2.0]);
        let away = slope * rng.vector() * Vec3::new(1.0, 1.0, 0.0);
        let o = through + 3.0 * away + Vec3::Z * (side + top * f64::from(side > 0.0));
        Ray::new(o, through - o)
    };
    (0..count).map(ray).collect()
}

/// Returns rays and forms in a group, turned and stretched.
pub(crate) fn grouped(rng: &mut Rng, scene: &Scene, rays: &[Ray]) -> (Scene, Vec<Ray>) {
    let scale = rng.one(&[Vec3::ONE, Vec3::new(1.3, 0.8, 0.6), Vec3::splat(2.0)]);
    let shift = rng.vector();
    let by = rng.turned(scale, shift);
    let items = scene.items.iter();
    let items = items.map(|(form, stuff)| (form.clone().placed(by), *stuff));
    let rays = rays
        .iter()
        .map(|ray| Ray::new(by.point(ray.origin()), by.direction(ray.direction())));
    let sun = scene.sun.map(|l| by.direction(l));
    let placed = Scene {
        sun,
        ..scene.with(items.collect())
    };
    (placed, rays.collect())
}

#[test]
fn panes_of_one_glass_in_any_order_are_one_pane() {
    let mut tally = Tally::new("stacks of one glass");
    let mut rng = Rng(0x5eed_0061);
    for _ in 0..cases(240) {
        let count = 2 + rng.below(4);
        let order = shuffled(&mut rng, count);
        let boxes: Vec<_> = order
            .iter()
            .map(|at| pane(height(*at), height(at + 1)))
            .collect();
        let copies = order.iter().map(|at| shift(Vec3::Z * (0.1 * *at as f64)));
        let (name, mut items): (_, Vec<_>) = match rng.below(4) {
            0 => (
                "list",
                boxes.into_iter().map(|form| (form, CLEAR)).collect(),
            ),
            1 => ("union", vec![(Form::Solid(Operation::Union, boxes), CLEAR)]),
            2 => {
                let all = Form::Copies(Box::new(pane(0.0, 0.1)), copies.collect());
                ("copies", vec![(all, CLEAR)])
            }
            _ => {
                let each = copies.map(|by| (pane(0.0, 0.1).placed(by), CLEAR));
                ("groups", each.collect())
            }
        };
        items.insert(rng.below(items.len() + 1), ground());
        let whole = Scene::new(vec![(pane(0.0, height(count)), CLEAR), ground()]);
        let rays = rays_into(&mut rng, height(count), 12);
        let stack = whole.with(items);
        let before = tally.wrong();
        match rng.below(2) {
            0 => stack.count(&mut tally, &rays, &whole, 1e-6),
            _ => {
                let seed = rng.next() | 1;
                let (stack, rays_there) = grouped(&mut Rng(seed), &stack, &rays);
                let (whole, _) = grouped(&mut Rng(seed), &whole, &rays);
                stack.count(&mut tally, &rays_there, &whole, 1e-6);
            }
        }
        tally.note(name, before);
    }
    tally.none();
}

/// At a joint, both colors count, and what is reflected is what both indices say.
#[test]
fn panes_of_several_glasses_in_any_order() {
    let mut tally = Tally::new("stacks of several glasses");
    let mut rng = Rng(0x5eed_0062);
    for _ in 0..cases(240) {
        let count = 2 + rng.below(3);
        let stuff = |rng: &mut Rng| Stuff::Glass {
            ior: rng.one(&[1.33, 1.5, 1.5, 1.9, 0.8]),
            color: rng.one(&[1.0, 0.9, 0.7]),
        };
        let panes: Vec<_> = (0..count)
            .map(|at| (pane(height(at), height(at + 1)), stuff(&mut rng)))
            .collect();
        let order = shuffled(&mut rng, count);
        let mut items: Vec<_> = order.iter().map(|at| panes[*at].clone()).collect();
        items.insert(rng.below(items.len() + 1), ground());
        let rays = rays_into(&mut rng, height(count), 12);
        let stack = Scene::new(items);
        let before = tally.wrong();
        match rng.below(2) {
            0 => stack.count(&mut tally, &rays, &stack, 1e-6),
            _ => {
                let (stack, rays) = grouped(&mut rng, &stack, &rays);
                stack.count(&mut tally, &rays, &stack, 1e-6);
            }
        }
        tally.note(if count == 2 { "two" } else { "more" }, before);
    }
    tally.none();
}

/// R = F + (1-F)²·F·(1 + F² + …) = 2F/(1+F) head-on.
#[test]
fn a_stack_reflects_as_much_as_one_pane() {
    let mut tally = Tally::new("2F/(1+F)");
    let f = fresnel(1.0, 1.5).0;
    let reflected = 2.0 * f / (1.0 + f);
    let red = (Form::Plane(Vec3::Z * -10.0, Vec3::Z), Stuff::Flat(0.0));
    for count in 1..=5 {
        for reversed in [false, true] {
            let mut items: Vec<_> = (0..count)
                .map(|at| (pane(height(at), height(at + 1)), CLEAR))
                .collect();
            items.push(red.clone());
            if reversed {
                items.reverse();
            }
            let scene = Scene {
                max_depth: 64,
                ..Scene::new(items)
            };
            let world = scene.world();
            let ray = Ray::new(Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
            let found = world.radiance(&ray).r();
            // What is too faint to be seen is not traced.
            tally.count([found, 1e-4], Some(reflected), || format!("{count} panes"));
        }
    }
    tally.none();
}

/// Panes without thickness and paint, on each other and on the faces of boxes: one pane counts, none on a
/// solid, and paint hides the glass.
#[test]
fn panes_and_paint_on_glass() {
    let mut tally = Tally::new("panes and paint on glass");
    let mut rng = Rng(0x5eed_0065);
    let square = |size: f64, z: f64| {
        let corner = Vec3::new(-size, -size, z);
        Form::Rectangle(corner, 2.0 * size * Vec3::X, 2.0 * size * Vec3::Y)
    };
    let disc = |size: f64, z: f64| Form::Disc(Vec3::Z * z, Vec3::NEG_Z, size);
    for _ in 0..cases(160) {
        let sheet = |rng: &mut Rng, z: f64| match rng.below(2) {
            0 => square(rng.one(&[0.2, 90.0]), z),
            _ => disc(rng.one(&[0.2, 90.0]), z),
        };
        let tint = Stuff::Glass {
            ior: 1.7,
            color: 0.9,
        };
        let z = height(rng.below(3));
        let paint = Stuff::Matte(0.6);
        let (name, mut items) = match rng.below(4) {
            0 => (
                "panes",
                vec![(sheet(&mut rng, z), CLEAR), (sheet(&mut rng, z), tint)],
            ),
            1 => (
                "pane on a box",
                vec![(pane(z, z + 0.1), CLEAR), (sheet(&mut rng, z), tint)],
            ),
            2 => (
                "paint on a box",
                vec![(pane(z, z + 0.1), CLEAR), (sheet(&mut rng, z), paint)],
            ),
            _ => (
                "paint in a stack",
                vec![
                    (pane(0.0, height(1)), CLEAR),
                    (pane(height(1), height(2)), tint),
                    (sheet(&mut rng, height(1)), paint),
                ],
            ),
        };
        if rng.below(2) == 0 {
            items.reverse();
        }
        items.insert(rng.below(items.len() + 1), ground());
        let scene = Scene::new(items);
        let rays = rays_into(&mut rng, 0.3, 10);
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
    tally.none();
}

/// Returns the bytes of the middle of a scene.
pub(crate) fn middle(text: &str) -> [u8; 3] {
    let scene = strahl::Scene::from_text(text, Syntax::Ron).unwrap();
    let image = scene.render().unwrap();
    let size = scene.size();
    image.pixel(size.width() / 2, size.height() / 2).unwrap()
}

#[test]
fn the_picture_of_a_stack() {
    let panes = [
        "Box(min: (-9, -9, -0.1), max: (9, 9, 0), material: Glass())",
        "Box(min: (-9, -9, -0.2), max: (9, 9, -0.1), material: Glass())",
    ];
    let orders = [[0, 1], [1, 0]].map(|order| order.map(|at| panes[at]).join(", "));
    let group = format!(
        "Group(transform: (rotate: (axis: (0, 0, 1), angle: 30)), geometries: [{}])",
        orders[0]
    );
    for list in orders.iter().chain([&group]) {
        let text = format!(
            r##"(image: (width: 3, height: 3), background: "#0000ff",
            camera: Perspective(eye: (0, 0, 3), look_at: (0, 0, 0), fov: 0.001),
            lights: [Ambient(intensity: 1)], geometries: [{list},
            Plane(point: (0, 0, -10), normal: (0, 0, 1), color: "#ff0000")])"##
        );
        // 1-R = 0.92308 and R = 0.07692
        assert_eq!(middle(&text), [246, 0, 78], "{list}");
    }
}
