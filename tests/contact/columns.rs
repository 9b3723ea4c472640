//! Columns of pixels along edges.
//!
//! The scenes are their own mirror images, and the middle column of the camera lies in the plane between
//! the halves: all of its rays end exactly on the edge where these meet.

use strahl::{PerspectiveCamera, Ray, Vec3, shape::Operation, shape::Transform};

use crate::{
    form::Form,
    shadow::{Lamp, count},
    support::{Rng, Tally, cases, lit_by, unit, white},
};

/// The parts of the normal in the direction to a grazing sun.
const GRAZING: [f64; 8] = [1e-2, -1e-2, 1e-4, -1e-4, 1e-6, -1e-6, 1e-8, -1e-8];

/// Returns the rays of the middle column of a camera above the plane x = 0.
pub(crate) fn column(eye: Vec3, count: u32) -> Vec<Ray> {
    let camera = PerspectiveCamera::new(eye, -eye, Vec3::Y, 0.28).unwrap();
    let rows = 0..count;
    rows.map(|row| camera.ray_for(3, count, 1.0, row.into()))
        .collect()
}

/// Returns two of a form that is made for either side of the plane x = 0.
pub(crate) fn halves(of: impl Fn(f64) -> Form) -> Vec<Form> {
    vec![of(1.0), of(-1.0)]
}

/// A mesh along the plane x = 0: a valley, or a ridge if `rise` is below 0.
pub(crate) fn roof(rise: f64) -> Form {
    let vertices = [
        [0.0, 0.0, -1.0],
        [0.0, 0.1, 1.0],
        [-1.0, rise, 0.0],
        [1.0, rise, 0.0],
    ];
    Form::mesh(&vertices, &[[0, 2, 1], [0, 1, 3]])
}

/// A mesh of several pieces along the plane x = 0.
fn strip(rise: f64) -> Form {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for step in 0..7_u32 {
        let z = f64::from(step) / 3.0 - 1.0;
        let wave = 0.1 * f64::from(step % 3);
        vertices.extend([
            [-1.0, rise + wave, z],
            [0.0, wave, z],
            [1.0, rise + wave, z],
        ]);
    }
    for first in (0..18).step_by(3) {
        for [a, b] in [[0, 1], [2, 1]] {
            triangles.push([first + a, first + b, first + a + 3]);
            triangles.push([first + b, first + b + 3, first + a + 3]);
        }
    }
    Form::mesh(&vertices, &triangles)
}

fn rise(x: f64) -> f64 {
    0.4 * x
}

/// Returns scenes by their names.
pub(crate) fn scenes() -> Vec<(&'static str, Vec<Form>)> {
    let mut scenes = Vec::new();
    let mut add = |name, forms: Vec<Form>| scenes.push((name, forms));
    for up in [0.3, -0.3, 0.05, -0.8] {
        add("mesh", vec![roof(up)]);
        add("smooth mesh", vec![roof(up).smooth()]);
        add("strip", vec![strip(up)]);
        add("smooth strip", vec![strip(up).smooth()]);
    }
    let normal = |x: f64| Vec3::new(rise(x), 1.0, 0.1);
    add("planes", halves(|x| Form::Plane(Vec3::ZERO, normal(x))));
    add("discs", halves(|x| Form::Disc(Vec3::ZERO, normal(x), 1.1)));
    for up in [0.4, -0.4] {
        let [low, high] = [Vec3::new(0.0, 0.0, -1.2), Vec3::new(0.0, 0.1, 1.2)];
        let side = |x: f64| Vec3::new(x, up, 0.05);
        let rectangle = |x: f64| Form::Rectangle(low, high - low, side(x) - low);
        add("rectangles", halves(rectangle));
        let triangle = |x: f64| Form::Triangle([low, high, side(x)]);
        add("triangles", halves(triangle));
    }
    let ball = |r: f64| move |x: f64| Form::Ball(Vec3::new(0.5 * x, 0.0, 0.1), r);
    add("balls", halves(ball(0.8)));
    add(
        "lens",
        vec![Form::Solid(Operation::Intersection, halves(ball(0.9)))],
    );
    add(
        "union",
        vec![Form::Solid(Operation::Union, halves(ball(0.8)))],
    );
    let arm = |x: f64| [Vec3::new(-x, -0.4, 0.1), Vec3::new(x, 0.4, 0.1)];
    add(
        "cylinders",
        halves(|x| Form::Cylinder(arm(x)[0], arm(x)[1], 0.3)),
    );
    add(
        "capsules",
        halves(|x| Form::Capsule(arm(x)[0], arm(x)[1], 0.3)),
    );
    let turned = |x: f64| {
        let turn = Transform::new(Vec3::ZERO, Some((Vec3::Z, 0.4 * x)), Vec3::ONE).unwrap();
        Form::Cuboid(Vec3::new(-0.7, -0.9, -0.9), Vec3::new(0.7, 0.3, 0.9)).placed(turn)
    };
    let both = || halves(turned);
    add("boxes", both());
    add("joined boxes", vec![Form::Solid(Operation::Union, both())]);
    add(
        "common box",
        vec![Form::Solid(Operation::Intersection, both())],
    );
    let block = Form::Cuboid(Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 0.5, 1.0));
    let notched = [vec![block], both()].concat();
    add("notch", vec![Form::Solid(Operation::Difference, notched)]);
    let sides = halves(|x| Form::Plane(Vec3::ZERO, normal(2.0 * x)));
    let tent = [sides, vec![Form::Ball(Vec3::new(0.0, -0.3, 0.0), 1.0)]].concat();
    add("tent", vec![Form::Solid(Operation::Intersection, tent)]);
    scenes
}

/// Returns directions to suns, high and low.
fn suns(rng: &mut Rng) -> Vec<Vec3> {
    let high = (0..4).map(|_| Vec3::new(0.6 * rng.signed(), 1.0, 0.6 * rng.signed()));
    let high: Vec<_> = high.collect();
    let low = (0..8).map(|_| Vec3::new(rng.signed(), rng.between(0.01, 0.5), 0.4 * rng.signed()));
    high.into_iter().chain(low).collect()
}

#[test]
fn columns_under_high_and_low_suns() {
    let mut tally = Tally::new("columns");
    let mut rng = Rng(0x5eed_0001);
    let rows = cases(96).min(96) as u32;
    for (name, mut forms) in scenes() {
        for eye in [
            Vec3::new(0.0, 2.0, 3.0),
            Vec3::new(0.0, 4.0, 0.5),
            Vec3::new(0.0, 0.7, 3.3),
        ] {
            let rays = column(eye, rows);
            forms.reverse();
            for l in suns(&mut rng) {
                let before = tally.wrong();
                count(&mut tally, &forms, Lamp::Sun(l), rays.iter().copied());
                tally.note(name, before);
            }
        }
    }
    tally.none();
}

#[test]
fn columns_under_a_grazing_sun() {
    let mut tally = Tally::new("columns, grazing sun");
    let mut rng = Rng(0x5eed_0002);
    let rows = cases(48).min(48) as u32;
    for (name, forms) in scenes() {
        let rays = column(Vec3::new(0.0, 2.0, 3.0), rows);
        let world = lit_by(&white(&forms), Lamp::Sun(Vec3::Y).light());
        for part in GRAZING {
            let ray = rays[rng.below(rays.len())];
            let Some((_, hit)) = world.hit(&ray) else {
                continue;
            };
            let n = if hit.front_face {
                hit.normal
            } else {
                -hit.normal
            };
            for side in [1.0, -1.0] {
                let along = Vec3::new(side, 0.0, 0.7 * rng.signed());
                let tangent = unit(along - along.dot(n) * n);
                let before = tally.wrong();
                let sun = Lamp::Sun(tangent + part * n);
                count(&mut tally, &forms, sun, rays.iter().copied());
                tally.note(name, before);
            }
        }
    }
    tally.none();
}

/// The same with the lights of edges.ron, whose column has a value for each row: the faces are lit with
/// values between those of the columns beside it.
#[test]
fn the_column_of_a_mesh_is_as_bright_as_those_beside_it() {
    let world = lit_by(
        &white(&[roof(0.3)]),
        Lamp::Sun(Vec3::new(0.3, 1.0, 0.2)).light(),
    );
    let camera = {
        let eye = Vec3::new(0.0, 2.0, 3.0);
        PerspectiveCamera::new(
            eye,
            -eye,
            Vec3::Y,
            15.0_f64 * (std::f64::consts::PI / 180.0),
        )
    };
    let camera = camera.unwrap();
    let mut tally = Tally::new("the column of edges.ron");
    for row in 0..41 {
        let [left, middle, right] =
            [0.0, 1.0, 2.0].map(|x| world.radiance(&camera.ray_for(3, 41, x, row.into())).r());
        if left == 0.0 || right == 0.0 {
            continue;
        }
        let nearest = if (middle - left).abs() < (middle - right).abs() {
            left
        } else {
            right
        };
        tally.count([middle, 1e-9], Some(nearest), || format!("row {row}"));
    }
    tally.none();
}
