//! Water that fills a ball, a cup and a pool.

use strahl::{Ray, Vec3, shape::Operation};

use crate::{
    form::Form,
    media::{CLEAR, Scene, Stuff, WATER, fresnel},
    stacks::{ground, grouped},
    support::{Rng, Tally, cases},
};

fn difference(from: Form, minus: Form) -> Form {
    Form::Solid(Operation::Difference, vec![from, minus])
}

/// A ball of glass that is full of water.
pub(crate) fn ball() -> Vec<(Form, Stuff)> {
    let center = Vec3::new(0.1, 0.2, 0.3);
    let hollow = Form::Ball(center, 0.7);
    vec![
        (difference(Form::Ball(center, 1.0), hollow.clone()), CLEAR),
        (hollow, WATER),
    ]
}

/// A cup of glass, in which water stands.
pub(crate) fn cup() -> Vec<(Form, Stuff)> {
    let at = |z: f64| Vec3::Z * z;
    let outside = Form::Cylinder(at(-1.0), at(1.0), 0.8);
    let inside = Form::Cylinder(at(-0.9), at(1.2), 0.7);
    vec![
        (difference(outside, inside), CLEAR),
        (Form::Cylinder(at(-0.9), at(0.5), 0.7), WATER),
    ]
}

/// A basin of stone, full of water up to a height.
pub(crate) fn pool(height: f64) -> Vec<(Form, Stuff)> {
    let block = Form::Cuboid(Vec3::new(-1.3, -1.2, -0.9), Vec3::new(1.3, 1.2, 0.2));
    let [low, high] = [Vec3::new(-1.1, -0.9, -0.7), Vec3::new(1.1, 1.0, height)];
    let hole = Form::Cuboid(low, Vec3::new(1.1, 1.0, 0.9));
    vec![
        (difference(block, hole), Stuff::Matte(0.8)),
        (Form::Cuboid(low, high), WATER),
    ]
}

fn count(tally: &mut Tally, rng: &mut Rng, name: &'static str, items: &[(Form, Stuff)]) {
    let mut items = items.to_vec();
    items.push(ground());
    if rng.below(2) == 0 {
        items.reverse();
    }
    let scene = Scene {
        sun: Some(Vec3::new(rng.signed(), rng.signed(), 1.0)),
        ..Scene::new(items)
    };
    let ray = |_| {
        let o = 4.0 * rng.direction();
        let o = if name == "pool" {
            Vec3::new(o.x, o.y, o.z.abs() + 0.5)
        } else {
            o
        };
        Ray::new(o, rng.vector() - o)
    };
    let rays: Vec<_> = (0..8).map(ray).collect();
    let before = tally.wrong();
    match rng.below(2) {
        0 => scene.count(tally, &rays, &scene, 1e-5),
        _ => {
            let (scene, rays) = grouped(rng, &scene, &rays);
            scene.count(tally, &rays, &scene, 1e-5);
        }
    }
    tally.note(name, before);
}

#[test]
fn water_in_a_ball_a_cup_and_a_pool() {
    let mut tally = Tally::new("water in a ball, a cup and a pool");
    let mut rng = Rng(0x5eed_0081);
    for _ in 0..cases(240) {
        count(&mut tally, &mut rng, "ball", &ball());
        count(&mut tally, &mut rng, "cup", &cup());
        let height = rng.one(&[0.2, 0.0]);
        count(&mut tally, &mut rng, "pool", &pool(height));
    }
    tally.none();
}

/// Through the middle, the parts that are passed on are those of four faces: 1 to 1.5, to 1.33 and back.
#[test]
fn a_ray_through_the_middle_of_a_ball_of_water() {
    let mut tally = Tally::new("through the middle of a ball of water");
    let [outer, inner] = [1.5, 1.33 / 1.5].map(|eta| fresnel(1.0, eta).0);
    // One pane of glass is passed by (1-R)(1-r)/(1-Rr), if light that returns is counted; two of them,
    // between which it returns too, by T/(2-T).
    let one = (1.0 - outer) * (1.0 - inner) / (1.0 - outer * inner);
    let passed = one / (2.0 - one);
    let center = Vec3::new(0.1, 0.2, 0.3);
    let right = passed * 0.25 + (1.0 - passed);
    for is_reversed in [false, true] {
        let mut items = ball();
        let quarter = strahl::Color::from_linear(strahl::Radiance::WHITE * 0.25).r();
        items.push((Form::Plane(Vec3::Z * -10.0, Vec3::Z), Stuff::Flat(quarter)));
        if is_reversed {
            items.reverse();
        }
        let scene = Scene {
            max_depth: 64,
            ..Scene::new(items)
        };
        let found = scene
            .world()
            .radiance(&Ray::new(center + Vec3::Z * 4.0, Vec3::NEG_Z));
        // What is too faint is not traced.
        tally.count([found.r(), 1e-3], Some(right), || "the middle".into());
    }
    tally.none();
}
