//! Walls of bricks of glass: each is one block.

use strahl::{Ray, Vec3, shape::Operation};

use crate::{
    copies::box_of_triangles,
    form::Form,
    media::{CLEAR, Scene, Stuff},
    stacks::{ground, shift, shuffled},
    support::{Rng, Tally, cases},
};

/// Returns rays to points of the outer faces of a wall of bricks, half of them on joints.
fn rays_to_bricks(rng: &mut Rng, sides: [usize; 3], size: Vec3, count: usize) -> Vec<Ray> {
    let ray = |_| {
        let mut through = [0, 1, 2].map(|axis| {
            let side = sides[axis];
            match rng.below(2) {
                0 if side > 1 => (1 + rng.below(side - 1)) as f64 * size[axis],
                _ => rng.between(0.0, side as f64) * size[axis],
            }
        });
        let axis = rng.below(3);
        through[axis] = rng.one(&[0.0, sides[axis] as f64 * size[axis]]);
        let through = Vec3::from(through);
        let o = 0.4 + 3.0 * rng.direction();
        Ray::new(o, through - o)
    };
    (0..count).map(ray).collect()
}

/// A wall: the way in which it is made, its bricks, the block that it is, and rays to it.
type Wall = (&'static str, Vec<(Form, Stuff)>, Form, Vec<Ray>);

fn wall(rng: &mut Rng, stuff: Stuff, are_copies: bool) -> Wall {
    let size = Vec3::new(0.3, 0.2, 0.1);
    let sides = [2 + rng.below(2), 1 + rng.below(3), 2];
    let corner = |at: [usize; 3]| Vec3::from(at.map(|step| step as f64)) * size;
    let places: Vec<_> = (0..sides[0] * sides[1] * sides[2])
        .map(|number| {
            let (x, rest) = (number % sides[0], number / sides[0]);
            [x, rest % sides[1], rest / sides[1]]
        })
        .collect();
    let order = shuffled(rng, places.len());
    let all = order.iter().map(|number| places[*number]);
    let end = |at: [usize; 3]| corner([at[0] + 1, at[1] + 1, at[2] + 1]);
    let brick = Form::Cuboid(Vec3::ZERO, size);
    let boxes = all.clone().map(|at| Form::Cuboid(corner(at), end(at)));
    let moved = all.map(|at| shift(corner(at)));
    let (name, items): (_, Vec<_>) = match rng.below(3) {
        0 if are_copies => {
            let copies = Form::Copies(Box::new(brick), moved.collect());
            ("copies", vec![(copies, stuff)])
        }
        _ if are_copies => {
            let each = moved.map(|by| (brick.clone().placed(by), stuff));
            ("groups", each.collect())
        }
        0 => ("list", boxes.map(|form| (form, stuff)).collect()),
        1 => {
            let mut number = 0;
            let either = boxes.map(|form| match form {
                Form::Cuboid(low, high) => {
                    number += 1;
                    let is_mesh = number % 2 == 0;
                    let mesh = is_mesh.then(|| box_of_triangles(low, high));
                    (mesh.unwrap_or(form), stuff)
                }
                form => (form, stuff),
            });
            ("boxes and meshes", either.collect())
        }
        _ => {
            let union = Form::Solid(Operation::Union, boxes.collect());
            ("union", vec![(union, stuff)])
        }
    };
    let one = Form::Cuboid(Vec3::ZERO, corner(sides));
    let rays = rays_to_bricks(rng, sides, size, 24);
    (name, items, one, rays)
}

fn bricks(class: &'static str, seed: u64, (stuff, are_copies): (Stuff, bool)) -> Tally {
    let mut tally = Tally::new(class);
    let mut rng = Rng(seed);
    while tally.rays() < cases(1728) {
        let (name, mut items, one, rays) = wall(&mut rng, stuff, are_copies);
        items.insert(rng.below(items.len() + 1), ground());
        let whole = Scene {
            sun: Some(rng.direction()),
            ..Scene::new(vec![(one, stuff), ground()])
        };
        let before = tally.wrong();
        whole.with(items).count(&mut tally, &rays, &whole, 1e-6);
        tally.note(name, before);
    }
    tally
}

/// Returns rays to points of the floor at z = -0.5 whose shadow rays meet the points at which others end.
fn rays_to_shadows(rng: &mut Rng, l: Vec3, rays: &[Ray]) -> Vec<Ray> {
    let to_shadow = |ray: &Ray| {
        let on_joint = ray.origin() + ray.direction();
        let shadow = on_joint - (on_joint.z + 0.5) / l.z * l;
        let side = rng.direction();
        let o = shadow + 3.0 * Vec3::new(side.x, side.y, 0.05 + 0.05 * side.z);
        Ray::new(o, shadow - o)
    };
    rays.iter().map(to_shadow).collect()
}

/// The light that falls through a wall of bricks is that through one block. A ray that meets two faces of a
/// brick at once finds one of them; where its neighbor is not met at all, that may be the one between them.
#[test]
fn the_shadow_of_a_wall_of_bricks_is_that_of_one_block() {
    let mut tally = Tally::new("shadows of bricks");
    let mut rng = Rng(0x5eed_0066);
    let floor = || (Form::Plane(Vec3::Z * -0.5, Vec3::Z), Stuff::Matte(0.8));
    while tally.rays() < cases(1728) {
        let are_copies = rng.below(2) == 0;
        let (name, mut items, one, rays) = wall(&mut rng, CLEAR, are_copies);
        let l = Vec3::new(rng.signed(), rng.signed(), 0.8);
        items.insert(rng.below(items.len() + 1), floor());
        let whole = Scene {
            sun: Some(l),
            ..Scene::new(vec![(one, CLEAR), floor()])
        };
        let rays = rays_to_shadows(&mut rng, l, &rays);
        let before = tally.wrong();
        whole.with(items).count(&mut tally, &rays, &whole, 1e-6);
        tally.note(name, before);
    }
    tally.at_most_of(1728, [20, 20]);
}

/// On the outside, the joints do not show. Where a ray grazes a face and meets a joint, the place of the
/// hit is uncertain.
#[test]
fn a_wall_of_bricks_is_one_block() {
    bricks("bricks", 0x5eed_0063, (CLEAR, false)).at_most_of(1728, [1, 1]);
}

#[test]
fn a_wall_of_copies_of_a_brick_is_one_block() {
    bricks("bricks by copies", 0x5eed_0064, (CLEAR, true)).at_most_of(1728, [1, 1]);
}

/// Of equals, the first that is hit is seen: on a joint, that may be a face between the bricks, with its
/// own normal.
#[test]
fn walls_of_stone_are_nearly_one_block() {
    for are_copies in [false, true] {
        bricks(
            "bricks of stone",
            0x5eed_0065,
            (Stuff::Matte(0.8), are_copies),
        )
        .at_most_of(1728, [50, 50]);
    }
}
