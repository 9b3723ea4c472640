//! Narrow gaps: what does not touch is not one.

use strahl::{Ray, Vec3};

use crate::{
    form::Form,
    media::{CLEAR, Scene, Stuff, WATER},
    stacks::{ground, rays_into},
    support::{Rng, Tally, cases},
};

fn pane(low: f64, high: f64) -> Form {
    Form::Cuboid(Vec3::new(-90.0, -90.0, low), Vec3::new(90.0, 90.0, high))
}

/// Returns the scene evaluated with a narrower limit.
fn narrow(items: Vec<(Form, Stuff)>) -> Scene {
    Scene {
        touch: 2e-14,
        doubt: 0.0,
        sun: Some(Vec3::new(0.2, 0.3, 1.0)),
        ..Scene::new(items)
    }
}

#[test]
fn gaps_stay_gaps() {
    let mut tally = Tally::new("gaps of 1e-9 and 1e-12");
    let mut rng = Rng(0x5eed_0091);
    for _ in 0..cases(120) {
        for gap in [1e-9, 1e-12] {
            let stack = [(pane(0.0, 0.1), CLEAR), (pane(0.1 + gap, 0.2), WATER)];
            let floor = (Form::Plane(Vec3::ZERO, Vec3::Z), Stuff::Matte(0.8));
            let on_floor = [(pane(gap, 0.1), CLEAR), floor];
            let center = Vec3::new(0.1, 0.2, 0.3);
            let balls = [
                (Form::Ball(center, 0.5), CLEAR),
                (Form::Ball(center, 0.5 - gap), WATER),
            ];
            let scenes = [
                ("stack", stack),
                ("floor", on_floor),
                ("nested balls", balls),
            ];
            for (name, items) in scenes {
                let mut items = items.to_vec();
                if name != "floor" {
                    items.push(ground());
                }
                if rng.below(2) == 0 {
                    items.reverse();
                }
                let mut rays = rays_into(&mut rng, 0.2, 6);
                if name == "nested balls" {
                    let o = 3.0 * rng.direction();
                    rays = vec![Ray::new(o, center + 0.3 * rng.vector() - o)];
                }
                if name == "floor" {
                    rays.retain(|ray| ray.origin().z > 0.0);
                }
                let before = tally.wrong();
                let scene = narrow(items);
                scene.count(&mut tally, &rays, &scene, 1e-6);
                tally.note(name, before);
            }
        }
    }
    tally.none();
}

/// At a foot of a wall that is this far from its edge, the light from behind the wall is in shadow, and
/// just above an edge it is not.
#[test]
fn shadows_of_near_walls_are_shadows() {
    use crate::shadow::Lamp;
    use crate::support::{lit_by, white};
    let mut tally = Tally::new("walls at 1e-9 and 1e-12");
    for gap in [1e-9, 1e-12] {
        let floor = Form::Plane(Vec3::ZERO, Vec3::Z);
        // The wall stands at x = gap, and floats above the floor by half of it.
        let wall = Form::Rectangle(
            Vec3::new(gap, -2.0, gap / 2.0),
            Vec3::new(0.0, 4.0, 0.0),
            Vec3::Z,
        );
        let forms = [floor, wall];
        for (slope, is_lit) in [(0.25, true), (1.0, false), (4.0, false), (-1.0, true)] {
            let l = Vec3::new(f64::signum(slope), 0.1, f64::abs(slope));
            let world = lit_by(&white(&forms), Lamp::Sun(l).light());
            let ray = Ray::new(Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -1.0));
            let right = if is_lit { l.z / l.length() } else { 0.0 };
            let found = world.radiance(&ray).r();
            tally.count([found, 1e-9], Some(right), || format!("{gap} {slope}"));
        }
    }
    tally.none();
}
