//! Copies in the place of their originals, equal faces of different shapes, and chains of capsules.

use strahl::{PerspectiveCamera, Ray, Vec3, shape::Operation, shape::Transform};

use crate::{
    form::Form,
    shadow::{Lamp, count, count_ray},
    support::{Rng, Tally, cases, lit_by, white},
};

fn here() -> Transform {
    Transform::new(Vec3::ZERO, None, Vec3::ONE).unwrap()
}

fn copies(form: &Form, by: Vec<Transform>) -> Form {
    Form::Copies(Box::new(form.clone()), by)
}

fn union(of: &[Form]) -> Form {
    Form::Solid(Operation::Union, of.to_vec())
}

/// Returns a box as a mesh, with outward normals.
pub(crate) fn box_of_triangles(low: Vec3, high: Vec3) -> Form {
    let corner = |number: u32| {
        let pick = |bit: u32, axis: usize| match number >> bit & 1 {
            0 => low[axis],
            _ => high[axis],
        };
        [pick(0, 0), pick(1, 1), pick(2, 2)]
    };
    let vertices: Vec<_> = (0..8).map(corner).collect();
    let squares = [
        [0, 2, 6, 4],
        [1, 5, 7, 3],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 1, 3, 2],
        [4, 6, 7, 5],
    ];
    let halves = squares.map(|[a, b, c, d]| [[a, c, b], [a, d, c]]);
    Form::mesh(&vertices, &halves.concat())
}

/// Returns scenes in which surfaces lie on each other.
pub(crate) fn scenes(rng: &mut Rng) -> Vec<(&'static str, Vec<Form>)> {
    let ball = Form::Ball(Vec3::new(0.3, 0.1, 0.2), 1.1);
    let other = Form::Ball(Vec3::new(-0.6, 0.4, 0.3), 0.7);
    let cube = Form::Cuboid(Vec3::new(-0.7, -0.6, -0.5), Vec3::new(0.4, 0.3, 0.6));
    let larger = Form::Cuboid(Vec3::new(-0.7, -0.6, -0.5), Vec3::new(0.4, 0.9, 0.6));
    let turned = rng.turned(Vec3::new(1.0, 0.8, 1.2), Vec3::new(0.3, 0.1, 0.2));
    let group = |form: &Form| form.clone().placed(turned);
    let [low, high] = [Vec3::new(-0.7, -0.6, -0.5), Vec3::new(0.4, 0.3, 0.6)];
    let mesh = box_of_triangles(low, high);
    let [a, b] = [Vec3::new(-0.5, -0.3, 0.1), Vec3::new(0.6, 0.5, 0.2)];
    let both = [ball.clone(), other.clone()];
    vec![
        ("two balls", vec![ball.clone(), ball.clone()]),
        (
            "copy of a ball",
            vec![ball.clone(), copies(&ball, vec![here()])],
        ),
        (
            "copies of a ball",
            vec![copies(&ball, vec![here(), here()])],
        ),
        (
            "turned copies",
            vec![group(&ball), copies(&ball, vec![turned])],
        ),
        ("ball and union", vec![ball.clone(), union(&both)]),
        ("union and ball", vec![union(&both), ball.clone()]),
        ("equal boxes", vec![cube.clone(), cube.clone()]),
        ("box in a box", vec![cube.clone(), larger.clone()]),
        ("boxes in a group", vec![group(&cube), group(&larger)]),
        (
            "box and union",
            vec![union(&[cube.clone(), other]), cube.clone()],
        ),
        ("box and mesh", vec![cube.clone(), mesh.clone()]),
        ("mesh and mesh", vec![mesh.clone(), mesh.clone()]),
        (
            "copy of a mesh",
            vec![mesh.clone(), copies(&mesh, vec![here()])],
        ),
        (
            "discs",
            vec![
                Form::Disc(Vec3::ZERO, Vec3::new(0.1, 1.0, 0.2), 0.8),
                Form::Disc(Vec3::ZERO, Vec3::new(-0.2, -2.0, -0.4), 1.0),
            ],
        ),
        (
            "a picture on a wall",
            vec![
                cube,
                Form::Rectangle(Vec3::new(-0.5, -0.4, 0.6), 0.6 * Vec3::X, 0.5 * Vec3::Y),
                Form::Disc(Vec3::new(0.1, 0.3, 0.1), Vec3::Y, 0.5),
            ],
        ),
        (
            "cylinder and capsule",
            vec![Form::Cylinder(a, b, 0.4), Form::Capsule(a, b, 0.4)],
        ),
        (
            "capsule and ball",
            vec![Form::Capsule(a, b, 0.4), Form::Ball(b, 0.4)],
        ),
    ]
}

/// Returns the rays of a small picture.
fn picture(rng: &mut Rng, width: u32, height: u32) -> Vec<Ray> {
    let eye = 4.5 * rng.direction();
    let camera = PerspectiveCamera::new(eye, -eye, Vec3::new(0.1, 1.0, 0.3), 0.3).unwrap();
    let all = (0..width).flat_map(|x| (0..height).map(move |y| (x, y)));
    all.map(|(x, y)| camera.ray_for(width, height, x.into(), y.into()))
        .collect()
}

#[test]
fn surfaces_on_each_other() {
    let mut tally = Tally::new("copies in place, equal faces");
    let mut rng = Rng(0x5eed_0031);
    let pictures = cases(12).min(12);
    for _ in 0..pictures {
        for (name, forms) in scenes(&mut rng) {
            let lamp = Lamp::Sun(rng.direction());
            let rays = picture(&mut rng, 24, 18);
            let before = tally.wrong();
            count(&mut tally, &forms, lamp, rays);
            tally.note(name, before);
        }
    }
    tally.none();
}

/// A ball and what is equal to it are as one ball.
#[test]
fn the_picture_of_a_copy_in_place_is_that_of_one() {
    let mut tally = Tally::new("copy.ron");
    let mut rng = Rng(0x5eed_0032);
    let ball = Form::Ball(Vec3::new(0.3, 0.1, 0.2), 1.1);
    let copy = copies(&ball, vec![here()]);
    let lists = [
        vec![ball.clone(), ball.clone()],
        vec![ball.clone(), copy.clone()],
        vec![copy, ball.clone()],
        vec![
            ball.clone(),
            union(&[ball.clone(), Form::Ball(Vec3::ZERO, 0.3)]),
        ],
    ];
    for _ in 0..cases(16).min(16) {
        let lamp = Lamp::Sun(rng.direction());
        let one = lit_by(&white(std::slice::from_ref(&ball)), lamp.light());
        let rays = picture(&mut rng, 24, 18);
        for forms in &lists {
            let world = lit_by(&white(forms), lamp.light());
            // Mapped back, a ray is rounded.
            let is_ball = matches!(forms[0], Form::Ball(..));
            let tolerance = if is_ball { 0.0 } else { 1e-12 };
            for ray in &rays {
                let [found, right] = [&world, &one].map(|world| world.radiance(ray).r());
                tally.count([found, tolerance], Some(right), || format!("{forms:?}"));
            }
        }
    }
    tally.none();
}

/// Returns a chain of capsules, each of which begins in the ball where the last one ends.
fn chain(rng: &mut Rng, links: usize) -> Vec<Form> {
    let mut joints = vec![0.6 * rng.vector()];
    for _ in 0..links {
        let last = joints[joints.len() - 1];
        joints.push(last + rng.between(0.2, 0.6) * rng.direction());
    }
    let links = joints.windows(2);
    links
        .map(|ends| Form::Capsule(ends[0], ends[1], 0.25))
        .collect()
}

#[test]
fn chains_of_capsules() {
    let mut tally = Tally::new("chains of capsules");
    let mut rng = Rng(0x5eed_0033);
    let rays = cases(6000);
    while tally.rays() < rays {
        let links = 2 + rng.below(3);
        let forms = chain(&mut rng, links);
        let (name, forms) = match rng.below(3) {
            0 => ("list", forms),
            1 => {
                let by = rng.turned(Vec3::splat(0.8), Vec3::ZERO);
                let placed = forms.into_iter().map(|form| form.placed(by));
                ("group", placed.collect())
            }
            _ => {
                let placed = forms.iter().map(|form| copies(form, vec![here()]));
                ("copies", placed.chain(forms.clone()).collect())
            }
        };
        let lamp = Lamp::Sun(rng.direction());
        let world = lit_by(&white(&forms), lamp.light());
        let before = tally.wrong();
        for ray in picture(&mut rng, 12, 9) {
            count_ray(&mut tally, &forms, (&world, lamp), &ray);
        }
        tally.note(name, before);
    }
    tally.none();
}
