//! Combined solids, beside what each operation keeps.

use std::{slice, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    random::{Rng, cases},
    ray::Ray,
    shape::{
        Membership, Shape,
        any::{solid, unbounded},
        cuboid::Cuboid,
        cylinder::Cylinder,
        disc::Disc,
        ellipsoid::Ellipsoid,
        face::{Crossing, FaceId, Leaving},
        instances::Instances,
        plane::Plane,
        solid::{Operation, Solid, crossings::ends_after},
        sphere::Sphere,
    },
    transform::Transform,
};

/// Number of random cases; `STRAHL_CASES` overrides it.
const CASES: usize = 20_000;

fn cube(min: f64, max: f64) -> Shape {
    let (min, max) = (DVec3::splat(min), DVec3::splat(max));
    Cuboid::new(min, max).unwrap().into()
}

fn ball(x: f64, radius: f64) -> Shape {
    Sphere::new(DVec3::X * x, radius).unwrap().into()
}

fn made(operation: Operation, operands: &[Shape]) -> Shape {
    Solid::new(operation, operands.to_vec()).unwrap().into()
}

/// Returns the crossings of a ray along x, from -9.
fn along_x(shape: &Shape) -> Vec<(f64, u64)> {
    let ray = Ray::new(DVec3::X * -9.0, DVec3::X);
    all(shape, &ray, Leaving::NOTHING)
}

fn all(shape: &Shape, ray: &Ray, leaving: Leaving) -> Vec<(f64, u64)> {
    let mut found = Vec::new();
    shape.each_crossing(ray, leaving, f64::INFINITY, |at| {
        found.push((at.t, at.face))
    });
    found
}

#[test]
fn spans_that_touch_are_joined_and_those_without_length_vanish() {
    let [one, two] = [ball(-1.0, 1.0), ball(1.0, 1.0)];
    let both = [one.clone(), two.clone()];
    assert_eq!(
        along_x(&made(Operation::Union, &both)),
        [(7.0, 0), (11.0, 8)]
    );
    assert_eq!(along_x(&made(Operation::Intersection, &both)), []);
    assert_eq!(
        along_x(&made(Operation::Difference, &both)),
        [(7.0, 0), (9.0, 0)]
    );
    let alike = [one.clone(), one.clone()];
    assert_eq!(along_x(&made(Operation::Difference, &alike)), []);
    for operation in [Operation::Union, Operation::Intersection] {
        assert_eq!(along_x(&made(operation, &alike)), [(7.0, 0), (9.0, 0)]);
    }
}

#[test]
fn a_cut_has_the_face_of_the_cutter_turned_around() {
    let shape = made(Operation::Difference, &[cube(-2.0, 2.0), ball(-2.0, 1.0)]);
    assert_eq!(along_x(&shape), [(8.0, 8), (11.0, 1)]);
    let ray = Ray::new(DVec3::X * -9.0, DVec3::X);
    let normal = |t, face| shape.normal_at(&ray, Crossing { t, face });
    assert_eq!(
        normal(8.0, 8),
        DVec3::NEG_X,
        "out of the box, into the ball"
    );
    assert_eq!(normal(11.0, 1), DVec3::X);
    // What is cut away from what is cut away remains.
    let shape = made(Operation::Difference, &[cube(-3.0, 3.0), shape]);
    let [first, second, ..] = along_x(&shape)[..] else {
        panic!("too few crossings")
    };
    assert_eq!([first, second], [(6.0, 0), (8.0, 16)]);
    assert_eq!(
        shape.normal_at(&ray, Crossing { t: 8.0, face: 16 }),
        DVec3::X
    );
}

#[test]
fn of_faces_in_one_plane_the_first_counts() {
    let [cylinder] = [DVec3::X].map(|end| Cylinder::new(-end, end, 1.0, true).unwrap());
    let both = [cube(-1.0, 1.0), cylinder.into()];
    assert_eq!(
        along_x(&made(Operation::Union, &both)),
        [(8.0, 0), (10.0, 1)]
    );
    let [cube, cylinder] = both;
    let turned = made(Operation::Intersection, &[cylinder, cube]);
    assert_eq!(along_x(&turned), [(8.0, 1), (10.0, 2)]);
}

#[test]
fn a_plane_is_the_half_space_behind_it() {
    let plane: Shape = Plane::new(DVec3::ZERO, DVec3::X * 3.0).unwrap().into();
    let half = made(Operation::Intersection, &[ball(0.0, 1.0), plane.clone()]);
    assert_eq!(along_x(&half), [(8.0, 0), (9.0, 8)]);
    assert_eq!(half.membership(DVec3::X * 0.5), Membership::Outside);
    assert!(matches!(
        half.membership(DVec3::X * -0.5),
        Membership::Inside(..)
    ));
    let ground = made(Operation::Union, &[plane, ball(5.0, 1.0)]);
    assert_eq!(along_x(&ground), [(9.0, 0), (13.0, 8), (15.0, 8)]);
    assert_eq!((ground.bounds(), ground.support(DVec3::X)), (None, None));
}

#[test]
fn a_part_that_is_placed_is_met_as_it_is_alone() {
    let mut rng = Rng(0x7e57);
    let turn = Transform::new(DVec3::X, Some((DVec3::new(1.0, 2.0, 3.0), 1.0)), DVec3::ONE);
    let turn = Arc::new(turn.unwrap());
    for shape in [cube(-1.0, 1.0), ball(0.5, 1.0)] {
        let alone = shape.placed(&turn).unwrap();
        let whole = made(Operation::Union, slice::from_ref(&alone));
        assert_eq!(whole.bounds(), alone.bounds());
        for _ in 0..cases(CASES) {
            let ray = Ray::new(rng.vector() * 3.0, rng.vector());
            let found = all(&whole, &ray, Leaving::NOTHING);
            assert_eq!(found, all(&alone, &ray, Leaving::NOTHING));
            for (t, face) in found {
                let at = Crossing { t, face };
                assert_eq!(whole.normal_at(&ray, at), alone.normal_at(&ray, at));
                let next = Ray::new(ray.at(t), rng.vector());
                let own = FaceId::of_shape(face);
                let [one, other] =
                    [&whole, &alone].map(|shape| all(shape, &next, Leaving::only(&own)));
                assert_eq!(one, other);
            }
        }
    }
}

#[test]
fn only_solids_are_put_together() {
    let disc: Shape = Disc::new(DVec3::ZERO, DVec3::X, 1.0).unwrap().into();
    let tube = Cylinder::new(DVec3::ZERO, DVec3::X, 1.0, false).unwrap();
    for shape in [disc, tube.into()] {
        let error = Solid::new(Operation::Union, [shape]);
        assert!(matches!(error, Err(GeometryError::NotSolid { .. })));
    }
    let error = Solid::new(Operation::Union, Vec::<Shape>::new());
    assert!(matches!(error, Err(GeometryError::NoOperand)));
}

/// Returns true if a point is in a solid, by what its parts say of it.
fn is_in(solid: &Solid, point: DVec3) -> bool {
    solid.root.depth(&solid.parts, point) > 0.0
}

/// Compares the crossings of a ray with points along it: behind an odd number of crossings from
/// its far end they are on the other side.
fn compare(solid: &Solid, ray: &Ray, leaving: Leaving, rng: &mut Rng) -> usize {
    let crossings = solid.crossings(ray, leaving);
    let found: Vec<_> = crossings.in_front(f64::INFINITY).map(|at| at.t).collect();
    assert!(found.is_sorted(), "{found:?}");
    let size = solid
        .bounds()
        .map_or(10.0, |[low, high]| (high - low).length());
    let unit = size / ray.direction().length();
    let crossings = solid.crossings(ray, leaving);
    let ends = ends_after(f64::NEG_INFINITY, &crossings.of_parts(0..solid.parts.len()));
    let far = ends.iter().copied().fold(0.0, f64::max) + unit;
    let beyond = is_in(solid, ray.at(far));
    let mut compared = 0;
    for _ in 0..8 {
        let near = ends
            .get(rng.below(ends.len().max(1)))
            .copied()
            .unwrap_or(0.0);
        let t = near + unit * rng.signed() * rng.magnitude(-4.0, 0.0);
        let is_clear = ends
            .iter()
            .chain([&0.0])
            .all(|end| (t - end).abs() > 1e-5 * unit);
        if t <= 0.0 || !is_clear {
            continue;
        }
        let behind = found.iter().filter(|at| **at > t).count();
        let expected = is_in(solid, ray.at(t)) ^ beyond;
        assert_eq!(
            behind % 2 == 1,
            expected,
            "at {t}, {found:?}: {solid:?} {ray:?}"
        );
        compared += 1;
    }
    compared
}

#[test]
fn crossings_are_where_points_change_sides() {
    let mut rng = Rng(0x501d);
    let (mut compared, mut left) = (0, 0);
    for _ in 0..cases(CASES) {
        let made = match rng.below(5) {
            0 => unbounded(&mut rng, DVec3::ZERO, 1.0).ok(),
            _ => solid(&mut rng, DVec3::ZERO, 1.0).ok().map(Shape::from),
        };
        let Some(shape @ Shape::Solid(solid)) = &made else {
            continue;
        };
        let is_even = solid.parts().all(|part| match part.unplaced() {
            // So flat, nothing is said of a point from its crossings.
            Shape::Ellipsoid(ellipsoid) => ellipsoid.axes().iter().all(|axis| axis.length() > 1e-4),
            Shape::Cone(cone) => (cone.to() - cone.from()).length() > 1e-4,
            _ => true,
        });
        if !is_even {
            continue;
        }
        let origin = rng.vector() * rng.one(&[0.3, 2.0, 20.0]);
        let to = rng.vector() * 0.8;
        let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]);
        let direction = rng.one(&[to - origin, to - origin, axis]);
        let ray = Ray::new(origin, direction * rng.magnitude(-2.0, 2.0));
        compared += compare(solid, &ray, Leaving::NOTHING, &mut rng);
        // And from each face that is met.
        for (t, face) in all(shape, &ray, Leaving::NOTHING) {
            let own = FaceId::of_shape(face);
            let next = Ray::new(ray.at(t), rng.vector());
            let normal = shape.normal_at(&ray, Crossing { t, face });
            if normal.dot(next.direction()).abs() > 1e-2 {
                left += compare(solid, &next, Leaving::only(&own), &mut rng);
            }
        }
    }
    assert!(compared > 2 * cases(CASES), "{compared}");
    assert!(left > cases(CASES), "{left}");
}

// Half of the parts share a face with the one before, and half of the rays leave one or two faces.
#[test]
fn intersections_of_convex_parts_are_crossed_as_any_solid_is() {
    let mut rng = Rng(0xc0);
    let (mut crossed, mut left) = (0, 0);
    for _ in 0..cases(CASES / 4) {
        let mut operands = Vec::<Shape>::new();
        for _ in 0..1 + rng.below(9) {
            let (at, size) = (0.5 * rng.vector(), rng.one(&[0.5, 1.0, 1.0]));
            operands.push(match (rng.below(7), operands.last()) {
                (0 | 1, Some(last)) => last.clone(),
                (0..=3, _) => Plane::new(at, rng.one(&[at, DVec3::X, DVec3::NEG_Y, at]))
                    .unwrap()
                    .into(),
                (4, _) => Cuboid::new(at - size, at + size).unwrap().into(),
                (5, _) => Sphere::new(at, size).unwrap().into(),
                _ => Cylinder::new(at - DVec3::X, at + DVec3::X, size, true)
                    .unwrap()
                    .into(),
            });
        }
        // Some of them in a solid of their own.
        let inner = operands.split_off(rng.below(operands.len()));
        operands.push(made(Operation::Intersection, &inner));
        let solid = Solid::new(Operation::Intersection, operands).unwrap();
        assert!(solid.is_convex);
        let origin = rng.vector() * rng.one(&[0.3, 2.0, 20.0]);
        let inward = 0.8 * rng.vector() - origin;
        let direction = rng.one(&[inward, inward, DVec3::X, DVec3::NEG_Y]);
        let mut rays = vec![(Ray::new(origin, direction), vec![])];
        for face in all(&solid.clone().into(), &rays[0].0, Leaving::NOTHING) {
            let parts = solid.parts().len() as u64;
            let other = rng.below(Solid::FACES_OF_PART as usize * parts as usize) as u64;
            let mut faces = vec![face.1, rng.one(&[other, face.1])];
            faces.sort_unstable();
            faces.dedup();
            let next = Ray::new(rays[0].0.at(face.0), rng.vector());
            rays.push((next, faces.into_iter().map(FaceId::of_shape).collect()));
        }
        for (ray, faces) in &rays {
            let crossings = solid.crossings(ray, Leaving::of(faces, 0));
            let found: Vec<_> = crossings.in_front(f64::INFINITY).collect();
            let any: Vec<_> = crossings.of_any_in_front(f64::INFINITY).collect();
            assert_eq!(found, any, "{solid:?} {ray:?} {faces:?}");
            crossed += found.len();
            left += usize::from(!faces.is_empty());
        }
    }
    assert!(crossed > cases(CASES / 4) / 2, "{crossed}");
    assert!(left > cases(CASES / 4) / 4, "{left}");
}

#[test]
fn the_support_is_beyond_every_hit() {
    let mut rng = Rng(0x5099);
    for _ in 0..cases(CASES) {
        let Ok(solid) = solid(&mut rng, DVec3::ZERO, 1.0) else {
            continue;
        };
        let shape = Shape::from(solid);
        let origin = rng.vector() * 20.0;
        let ray = Ray::new(origin, rng.vector() * 0.8 - origin);
        let direction = crate::tracer::vector::unit(rng.vector() + 1e-3 * DVec3::X);
        let far = shape.support(direction).unwrap().dot(direction);
        for (t, _) in all(&shape, &ray, Leaving::NOTHING) {
            assert!(ray.at(t).dot(direction) <= far + 1e-5, "{shape:?} {ray:?}");
        }
    }
}

#[test]
fn an_empty_solid_is_never_hit() {
    let mut rng = Rng(22);
    let (mut empty, mut hits) = (0, 0);
    for _ in 0..cases(CASES / 4) {
        let mut operand = |size: f64| solid(&mut rng, DVec3::ZERO, size);
        let (Ok(one), Ok(other)) = (operand(1.0), operand(2.0)) else {
            continue;
        };
        let operation = rng.one(&[Operation::Intersection, Operation::Difference]);
        let shift = rng.vector();
        let Ok(cube) = Cuboid::new(shift - 0.5, shift + 0.5) else {
            continue;
        };
        let cube = Shape::from(cube);
        let second = match rng.below(2) {
            0 => Shape::from(other),
            _ => cube,
        };
        let whole = Solid::new(operation, [Shape::from(one), second]).unwrap();
        if !whole.is_surely_empty() {
            continue;
        }
        empty += 1;
        for _ in 0..20 {
            let ray = Ray::new(rng.vector() * 4.0, rng.vector());
            // Where faces touch, rounding may find a speck.
            let all: Vec<_> = whole
                .crossings(&ray, Leaving::NOTHING)
                .in_front(f64::INFINITY)
                .map(|at| at.t)
                .collect();
            hits += all.windows(2).filter(|at| at[1] - at[0] > 1e-6).count();
        }
    }
    assert!(empty > cases(CASES / 4) / 50, "{empty}");
    assert_eq!(hits, 0);
}

#[test]
fn the_smallest_box_is_not_grown_by_ellipsoids() {
    let axes = [DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z];
    let ball = || Shape::from(Ellipsoid::new(DVec3::ZERO, axes).unwrap());
    let half = || Shape::from(Plane::new(DVec3::ZERO, DVec3::Y).unwrap());
    let cube = || Shape::from(Cuboid::new(DVec3::ZERO, DVec3::splat(9.0)).unwrap());
    let whole = [DVec3::new(-1.0, -2.0, -3.0), DVec3::new(1.0, 2.0, 3.0)];
    for (operation, operands, expected) in [
        (Operation::Difference, [ball(), half()], whole),
        (Operation::Intersection, [ball(), half()], whole),
        (
            Operation::Intersection,
            [cube(), ball()],
            [DVec3::ZERO, whole[1]],
        ),
        (
            Operation::Union,
            [cube(), ball()],
            [whole[0], DVec3::splat(9.0)],
        ),
    ] {
        let solid = Shape::from(Solid::new(operation, operands).unwrap());
        let grown = solid.bounds().unwrap();
        assert_ne!(grown, expected, "{operation:?}");
        assert_eq!(solid.smallest_box(grown), expected, "{operation:?}");
        // It is as small once the solid is placed, or copied.
        let turn = Some((DVec3::Z, std::f64::consts::FRAC_PI_2));
        let turn = Transform::new(DVec3::splat(7.0), turn, DVec3::splat(2.0)).unwrap();
        let [low, high] = expected.map(|corner| turn.point(corner));
        let copies = Instances::new([solid.clone()], [turn]).unwrap();
        for shape in [solid.placed(&Arc::new(turn)).unwrap(), copies.into()] {
            let [least, most] = shape.smallest_box(shape.bounds().unwrap());
            assert!((least - low.min(high)).length() < 1e-12, "{operation:?}");
            assert!((most - low.max(high)).length() < 1e-12, "{operation:?}");
        }
    }
}

#[test]
fn a_turned_intersection_lies_in_its_own_box_and_those_of_its_operands() {
    let slab = |half: DVec3| Shape::from(Cuboid::new(-half, half).unwrap());
    let slabs = [DVec3::new(9.0, 1.0, 1.0), DVec3::new(1.0, 9.0, 1.0)];
    let cross = Solid::new(Operation::Intersection, slabs.map(slab)).unwrap();
    let ball = Sphere::new(DVec3::ZERO, 1.2).unwrap();
    let turn = Some((DVec3::Z, std::f64::consts::FRAC_PI_4));
    let turn = Arc::new(Transform::new(DVec3::ZERO, turn, DVec3::ONE).unwrap());
    for (shape, x) in [
        (Shape::from(cross.clone()), 2.0_f64.sqrt()),
        (
            Solid::new(Operation::Intersection, [cross.into(), Shape::from(ball)])
                .unwrap()
                .into(),
            1.2,
        ),
    ] {
        let shape = shape.placed(&turn).unwrap();
        let [low, high] = shape.smallest_box(shape.bounds().unwrap());
        let corner = DVec3::new(x, x, 1.0);
        assert!((low + corner).length() < 1e-12 && (high - corner).length() < 1e-12);
    }
}
