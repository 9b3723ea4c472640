//! Copies beside shapes that are placed.

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    random::{Rng, cases},
    ray::Ray,
    shape::{
        Membership, Shape,
        any::copies,
        cuboid::Cuboid,
        disc::Disc,
        face::{Crossing, FaceId, Leaving},
        instances::Instances,
        sphere::Sphere,
    },
    transform::Transform,
};

fn shift(x: f64) -> Transform {
    Transform::new(DVec3::new(x, 0.0, 0.0), None, DVec3::ONE).unwrap()
}

// A copy is hit where the same shapes are that are placed by its transform, and what is hit is the
// same.
#[test]
fn copies_are_placed_shapes() {
    let mut rng = Rng(41);
    let mut hits = 0;
    for _ in 0..cases(300) {
        let Ok(all) = copies(&mut rng, DVec3::ZERO, 2.0) else {
            continue;
        };
        if all
            .shapes()
            .any(|shape| shape.transform().is_some() || shape.copies().is_some())
        {
            continue;
        }
        let places = (0..all.len()).map(|copy| Arc::new(all.transform(copy).unwrap()));
        let placed: Vec<Shape> = places
            .flat_map(|place| {
                let shapes = all.shapes().cloned();
                shapes.map(move |shape| shape.placed(&place).unwrap())
            })
            .collect();
        let shape = Shape::from(all);
        for _ in 0..20 {
            let origin = rng.vector() * 4.0;
            let ray = Ray::new(origin, rng.vector() - origin);
            let mut nearest: Option<(&Shape, Crossing)> = None;
            for other in &placed {
                let t_max = nearest.map_or(f64::INFINITY, |(_, met)| met.t);
                let met = other.meet(&ray, Leaving::NOTHING, t_max);
                nearest = met.map(|met| (other, met)).or(nearest);
            }
            let found = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY);
            assert_eq!(
                found.map(|met| met.t.to_bits()),
                nearest.map(|(_, met)| met.t.to_bits()),
                "{shape:?} {ray:?}"
            );
            let (Some(found), Some((other, met))) = (found, nearest) else {
                continue;
            };
            hits += 1;
            assert_eq!(shape.normal_at(&ray, found), other.normal_at(&ray, met));
        }
    }
    assert!(hits > cases(300) / 4, "{hits}");
}

#[test]
fn faces_are_numbered_through() {
    let ball: Shape = Sphere::new(DVec3::ZERO, 1.0).unwrap().into();
    let cube: Shape = Cuboid::new(DVec3::splat(-0.5), DVec3::splat(0.5))
        .unwrap()
        .into();
    let all = Instances::new([ball, cube], [shift(0.0), shift(4.0), shift(4.0)]).unwrap();
    assert_eq!((all.len(), all.copy_of(all.face_count() - 1)), (3, 2));
    let shape = Shape::from(all);
    let ray = Ray::new(DVec3::new(9.0, 0.0, 0.0), DVec3::NEG_X);
    let met = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY).unwrap();
    let copies = shape.copies().unwrap();
    let (part, inner, face) = copies.part_of(met.face).unwrap();
    assert_eq!(
        (met.t, copies.copy_of(met.face)),
        (4.0, 1),
        "the first of two"
    );
    assert_eq!((part, inner.kind(), face), (0, "sphere", 0));
    let [low, high] = shape.bounds().unwrap();
    assert!(
        (low - DVec3::new(-1.0, -1.0, -1.0)).length() < 1e-12,
        "{low}"
    );
    assert!(
        (high - DVec3::new(5.0, 1.0, 1.0)).length() < 1e-12,
        "{high}"
    );
    assert_eq!(shape.support(DVec3::X), Some(DVec3::new(5.0, 0.0, 0.0)));
    assert_eq!(
        shape.membership(DVec3::new(4.2, 0.9, 0.0)).clone(),
        shape.membership(DVec3::new(4.0, 0.9, 0.0))
    );
    assert_eq!(
        shape.membership(DVec3::new(2.0, 0.0, 0.0)),
        Membership::Outside
    );
}

// What a ray leaves is a surface of its copy, and of no other: a copy in its place has a face of its own.
#[test]
fn a_ray_leaves_its_own_copy() {
    let disc: Shape = Disc::new(DVec3::ZERO, DVec3::Z, 1.0).unwrap().into();
    let other: Shape = Disc::new(DVec3::X * 0.5, DVec3::Z, 1.0).unwrap().into();
    let places = [shift(0.0), shift(0.25), shift(0.0)];
    let shape: Shape = Instances::new([disc.clone(), other], places)
        .unwrap()
        .into();
    let ray = Ray::new(DVec3::new(0.1, 0.1, 1e-20), DVec3::NEG_Z);
    let met = |face| {
        let own = FaceId::of_shape(face);
        let mut faces = Vec::new();
        shape.each_crossing(&ray, Leaving::only(&own), f64::INFINITY, |at| {
            faces.push(at.face)
        });
        faces
    };
    assert_eq!(met(0), [1, 2, 3, 4, 5]);
    assert_eq!(met(3), [0, 1, 2, 4, 5]);
}

#[test]
fn nothing_is_no_copy() {
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    assert!(Instances::new([ball], []).is_err());
    assert!(Instances::new(Vec::<Shape>::new(), [shift(0.0)]).is_err());
}
