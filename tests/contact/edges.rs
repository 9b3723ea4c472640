//! Rays to the edges of random scenes, found by bisection: of two neighbors, one hits one face and the
//! other another one.

use strahl::{Ray, Vec3, World, shape::Operation};

use crate::{
    form::Form,
    shadow::{Lamp, count_ray},
    support::{Rng, Tally, cases, lit_by, unit, white},
};

/// Returns a star of eight triangles around the origin.
fn star(rng: &mut Rng) -> Form {
    let mut corner =
        |x: f64, y: f64, z: f64| (rng.between(0.4, 1.0) * Vec3::new(x, y, z)).to_array();
    let vertices = [
        corner(1.0, 0.1, 0.0),
        corner(0.0, 1.0, 0.1),
        corner(-1.0, 0.1, 0.2),
        corner(0.1, -1.0, 0.0),
        corner(0.0, 0.1, 1.0),
        corner(0.2, 0.0, -1.0),
    ];
    let sides = [[0, 1], [1, 2], [2, 3], [3, 0]];
    let triangles = sides.map(|[a, b]| [[a, b, 4], [b, a, 5]]).concat();
    Form::mesh(&vertices, &triangles)
}

/// Returns a hilly patch of four by four squares.
fn patch(rng: &mut Rng) -> Form {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..5_u32 {
        for j in 0..5 {
            let [x, z] = [i, j].map(|step: u32| f64::from(step) * 0.3 - 0.6);
            vertices.push([x, 0.3 * rng.signed(), z]);
            if i < 4 && j < 4 {
                let a = 5 * i + j;
                triangles.extend([[a, a + 1, a + 5], [a + 1, a + 6, a + 5]]);
            }
        }
    }
    Form::mesh(&vertices, &triangles)
}

fn cube(low: f64, high: f64) -> Form {
    Form::Cuboid(Vec3::splat(low), Vec3::splat(high))
}

/// Returns forms of size 1 around the origin that touch and cut each other.
fn scene(rng: &mut Rng) -> Vec<Form> {
    let near = |rng: &mut Rng| 0.4 * rng.vector();
    let ball = |rng: &mut Rng| Form::Ball(near(rng), rng.between(0.3, 0.7));
    let block = |rng: &mut Rng| {
        let [low, high] = [-1.0, 1.0].map(|side| Vec3::splat(0.5 * side) + 0.3 * rng.vector());
        Form::Cuboid(low, high)
    };
    let rod = |rng: &mut Rng| {
        let (axis, middle) = (rng.direction(), near(rng));
        Form::Cylinder(middle - axis, middle + axis, rng.between(0.2, 0.5))
    };
    let capsule = |rng: &mut Rng| {
        let (axis, middle) = (0.7 * rng.direction(), near(rng));
        Form::Capsule(middle - axis, middle + axis, rng.between(0.2, 0.4))
    };
    let plane = |rng: &mut Rng| Form::Plane(near(rng), rng.direction());
    match rng.below(12) {
        0 => vec![star(rng)],
        1 => vec![star(rng).smooth()],
        2 => vec![patch(rng), plane(rng)],
        3 => vec![block(rng), ball(rng)],
        4 => vec![ball(rng), ball(rng), plane(rng)],
        5 => vec![rod(rng), plane(rng)],
        6 => {
            let operations = [
                Operation::Union,
                Operation::Intersection,
                Operation::Difference,
            ];
            let second = match rng.below(3) {
                0 => ball(rng),
                1 => rod(rng),
                _ => block(rng),
            };
            let first = block(rng);
            vec![Form::Solid(rng.one(&operations), vec![first, second])]
        }
        7 => vec![capsule(rng), block(rng)],
        8 => {
            let disc = {
                let middle = near(rng);
                Form::Disc(middle, rng.direction(), 0.8)
            };
            let (u, v) = (rng.direction(), rng.direction());
            vec![disc, Form::Rectangle(-0.5 * (u + v), u, v)]
        }
        9 => {
            let [a, b] = [rng.direction(), rng.direction()];
            let third = [(); 3].map(|()| rng.direction());
            third.map(|c| Form::Triangle([a, b, c])).to_vec()
        }
        10 => {
            // Equal faces, and one that stands on another.
            let upper = Form::Cuboid(Vec3::new(-0.7, 0.3, -0.7), Vec3::new(0.3, 0.9, 0.3));
            vec![
                cube(-0.7, 0.3),
                upper,
                Form::Plane(Vec3::splat(-0.7), Vec3::Y),
            ]
        }
        _ => vec![rod(rng), rod(rng), star(rng)],
    }
}

/// The ways in which scenes are placed.
const PLACES: [&str; 6] = ["plain", "group", "copies", "stretched", "offset", "size"];

/// Returns forms in a place, with the middle and the size of all.
fn place(rng: &mut Rng, forms: &[Form], place: &str) -> (Vec<Form>, Vec3, f64) {
    let each = |of: &dyn Fn(&Form) -> Form| forms.iter().map(of).collect::<Vec<_>>();
    let turned = |rng: &mut Rng, scale| {
        let shift = 0.3 * rng.direction();
        rng.turned(scale, shift)
    };
    match place {
        "group" => {
            let by = turned(rng, Vec3::splat(0.7));
            (
                each(&|form| form.clone().placed(by)),
                by.point(Vec3::ZERO),
                0.7,
            )
        }
        "copies" => {
            let by = turned(rng, Vec3::ONE);
            let second = turned(rng, Vec3::splat(0.8));
            let copies = |form: &Form| Form::Copies(Box::new(form.clone()), vec![by, second]);
            (each(&copies), by.point(Vec3::ZERO), 1.0)
        }
        "stretched" => {
            let thin = 1.0 / rng.one(&[7.0, 40.0, 200.0]);
            let scale = rng.one(&[
                Vec3::new(1.0, thin, 1.0),
                Vec3::new(1.0, thin, thin),
                Vec3::new(thin, 1.0, 1.0),
            ]);
            let by = turned(rng, scale);
            (
                each(&|form| form.clone().placed(by)),
                by.point(Vec3::ZERO),
                0.7,
            )
        }
        "offset" => {
            let far = rng.one(&[10.0, 1e3, 1e5]) * rng.direction();
            match rng.below(2) {
                0 => (each(&|form| form.moved(1.0, far)), far, 1.0),
                _ => {
                    let by = rng.turned(Vec3::ONE, far);
                    (each(&|form| form.clone().placed(by)), far, 1.0)
                }
            }
        }
        "size" => {
            let size = rng.one(&[1e-6, 1e-3, 1e3, 1e6]);
            match rng.below(2) {
                0 => (each(&|form| form.moved(size, Vec3::ZERO)), Vec3::ZERO, size),
                _ => {
                    let by = rng.turned(Vec3::splat(size), Vec3::ZERO);
                    (each(&|form| form.clone().placed(by)), Vec3::ZERO, size)
                }
            }
        }
        _ => (forms.to_vec(), Vec3::ZERO, 1.0),
    }
}

/// Returns two neighbors among the directions from one to another, the first of which hits another face
/// than the last.
fn neighbors(world: &World, o: Vec3, [from, to]: [Vec3; 2]) -> Option<[Ray; 2]> {
    let at = |part: f64| Ray::new(o, from + part * (to - from));
    let face = |ray: &Ray| world.hit(ray).map(|(index, hit)| (index, hit.face));
    let (mut low, mut high) = (0.0, 1.0);
    let first = face(&at(low));
    if face(&at(high)) == first {
        return None;
    }
    loop {
        let middle = (low + high) / 2.0;
        if middle <= low || middle >= high {
            return Some([at(low), at(high)]);
        }
        match face(&at(middle)) == first {
            true => low = middle,
            false => high = middle,
        }
    }
}

/// Counts rays to edges, from a camera at a distance in sizes of the scene.
fn count_edges(
    tally: &mut Tally,
    rng: &mut Rng,
    whole: usize,
    mut distance: impl FnMut(&mut Rng) -> f64,
) {
    let rays = cases(whole);
    while tally.rays() < rays {
        let name = PLACES[rng.below(PLACES.len())];
        let forms = scene(rng);
        let (forms, middle, size) = place(rng, &forms, name);
        let l = rng.direction();
        let lamp = Lamp::Sun(l);
        let world = lit_by(&white(&forms), lamp.light());
        let before = tally.wrong();
        for _ in 0..6 {
            let o = middle + size * distance(rng) * rng.direction();
            let through = [(); 2].map(|()| middle + 0.9 * size * rng.vector() - o);
            for ray in neighbors(&world, o, through).into_iter().flatten() {
                let Some((_, hit)) = world.hit(&ray) else {
                    continue;
                };
                // At the outline of a curved surface, the hit itself is uncertain.
                let slope = hit.normal.dot(unit(ray.direction())).abs();
                if slope > 1e-3 {
                    count_ray(tally, &forms, (&world, lamp), &ray);
                }
            }
        }
        tally.note(name, before);
    }
}

#[test]
fn rays_to_edges() {
    let mut tally = Tally::new("edge rays");
    count_edges(&mut tally, &mut Rng(0x5eed_0011), 9412, |rng| {
        rng.between(3.0, 8.0)
    });
    tally.none();
}

/// The first hits of some are uncertain.
#[test]
fn rays_to_edges_from_afar() {
    let mut tally = Tally::new("edge rays from afar");
    count_edges(&mut tally, &mut Rng(0x5eed_0012), 4164, |rng| {
        rng.one(&[1e2, 1e3, 1e4, 1e5, 1e6])
    });
    tally.at_most_of(4164, [2, 24]);
}
