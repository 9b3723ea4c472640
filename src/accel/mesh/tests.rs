//! Comparison of the index with the loop, and the tightness of closed meshes.

use std::{collections::HashMap, sync::Arc};

use glam::DVec3;

use crate::{
    accel::{
        bvh::build::Builder,
        mesh::{Triangles, bundle::FirstOfEach, index_mesh},
    },
    parallel::{Cancel, Pool},
    simd::isa::Isa,
    tracer::{
        random::{Rng, cases},
        ray::{BUNDLE, Bundle, Ray},
        shape::{
            any::{any_mesh, torus},
            contact::ContactPoint,
            face::{Crossing, FaceId, Leaving},
            mesh::{Index, Mesh, Passage},
            triangle::Triangle,
        },
        vector::unit,
    },
};

/// Number of random meshes; `STRAHL_CASES` overrides it.
const CASES: usize = 600;
/// Number of rays for each.
const RAYS: usize = 30;

/// Returns a mesh of any size at any place.
fn mesh(rng: &mut Rng) -> Mesh {
    loop {
        let size = match rng.below(10) {
            0 => rng.magnitude(-60.0, 60.0),
            _ => rng.magnitude(-3.0, 3.0),
        };
        let center = rng.vector() * rng.one(&[0.0, size, size * 1e6, 1.0]);
        if let Ok(mesh) = any_mesh(rng, center, size) {
            return mesh;
        }
    }
}

/// Returns a ray that often goes through a corner, along an edge, or in the plane of a triangle.
fn ray(rng: &mut Rng, mesh: &Mesh) -> Ray {
    let corner = |rng: &mut Rng| mesh.vertices()[rng.below(mesh.vertices().len())];
    let face = rng.below(mesh.triangles().len()) as u64;
    let [a, b, c] = mesh.corners(face).unwrap();
    let [low, high] = mesh.bounds().unwrap();
    let size = (high - low).length();
    let share = rng.one(&[0.0, 0.5, 1.0, 0.3]);
    let edge = a + (b - a) * share;
    let inward = (c - edge) * rng.one(&[0.0, 0.3]);
    let to = rng.one(&[a, edge, edge + inward]);
    let away = rng.vector() * size * rng.magnitude(-3.0, 2.0);
    let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]) * size;
    let from = match rng.below(8) {
        0 => corner(rng),
        1 => to + axis,
        2 => c + (c - a) * 3.0,
        3 => low + away * 1e7,
        _ => low + away,
    };
    let direction = match rng.below(12) {
        0 => axis,
        1 => rng.vector(),
        2 => DVec3::ZERO,
        _ => to - from,
    };
    Ray::new(from, direction * rng.one(&[1.0, 1.0, 1e-3, 1e60]))
}

/// Returns the results of a passage with all their bits.
fn bits(crossing: Option<Crossing>) -> Option<(u64, u64)> {
    crossing.map(|crossing| (crossing.t.to_bits(), crossing.face))
}

fn all(passage: &Passage) -> Vec<Option<(u64, u64)>> {
    let all = passage.in_front(f64::INFINITY);
    all.map(|crossing| bits(Some(crossing))).collect()
}

#[test]
fn the_index_agrees_with_the_loop() {
    let mut rng = Rng(31);
    let (mut hits, mut ties, mut indexed, mut spilled) = (0, 0, 0, 0);
    for case in 0..cases(CASES) {
        let plain = mesh(&mut rng);
        let pool = Pool::new(Some(rng.one(&[1, 3])));
        let triangles: Vec<Triangles> = Isa::all()
            .into_iter()
            .filter_map(|isa| Triangles::new(&plain, Builder::new(&pool, isa)))
            .collect();
        indexed += usize::from(!triangles.is_empty());
        let mut patches = triangles.iter().flat_map(|it| &*it.patches);
        spilled += usize::from(patches.any(|patch| patch.has_more()));
        for _ in 0..RAYS {
            let ray = ray(&mut rng, &plain);
            let face = rng.below(plain.triangles().len()) as u64;
            let own = FaceId::of_shape(face);
            let leaving = match rng.below(2) {
                0 => Leaving::NOTHING,
                _ => Leaving::only(&own),
            };
            let passage = plain.crossings(&ray, leaving);
            let expected = passage.first_of_all(f64::INFINITY);
            let mut every = all(&passage);
            let first = every.first().copied().flatten();
            assert_eq!(bits(expected), first);
            hits += usize::from(first.is_some());
            let at = |place: usize| every.get(place).copied().flatten().map(|(t, _)| t);
            ties += usize::from(first.is_some() && at(0) == at(1));
            let t = expected.map_or(1.0, |crossing| crossing.t);
            for triangles in &triangles {
                assert_eq!(triangles.corners(face), plain.corners(face));
                for t_max in [f64::INFINITY, t, t.next_up(), 0.5 * t] {
                    let expected = bits(passage.first_of_all(t_max));
                    let found = bits(triangles.first(&passage, t_max));
                    assert_eq!(found, expected, "case {case}: {ray:?} {t_max} {plain:?}");
                }
                let mut found = Vec::new();
                triangles.each(&passage, f64::INFINITY, &mut |crossing| {
                    found.push(bits(Some(crossing)));
                });
                found.sort_unstable();
                every.sort_unstable();
                assert_eq!(found, every, "case {case}: {ray:?} {plain:?}");
            }
        }
    }
    assert!(hits > cases(CASES) * RAYS / 4, "{hits}");
    assert!(ties > cases(CASES) / 2, "{ties}");
    assert!(indexed > cases(CASES) / 2, "{indexed}");
    assert!(spilled > cases(CASES) / 100, "{spilled}");
}

/// Returns rays to points near to each other, some of them to any point at all.
fn bundle(rng: &mut Rng, mesh: &Mesh) -> Bundle {
    let size = mesh
        .bounds()
        .map_or(1.0, |[low, high]| (high - low).length());
    let spread = size * rng.one(&[0.0, 1e-3, 0.03, 1.0]);
    let first = ray(rng, mesh);
    let [mut origins, mut directions] = [[[0.0; BUNDLE]; 3]; 2];
    for lane in 0..BUNDLE {
        let other = match rng.below(30) {
            0 => ray(rng, mesh),
            _ => match rng.below(2) {
                0 => Ray::new(first.origin() + rng.vector() * spread, first.direction()),
                _ => Ray::new(first.origin(), first.direction() + rng.vector() * spread),
            },
        };
        for (axis, (o, d)) in
            std::iter::zip(other.origin().to_array(), other.direction().to_array()).enumerate()
        {
            (origins[axis][lane], directions[axis][lane]) = (o, d);
        }
    }
    let t_max = [(); BUNDLE].map(|()| match rng.below(6) {
        0 => 0.0,
        1 => rng.magnitude(-3.0, 3.0),
        _ => f64::INFINITY,
    });
    Bundle::new(origins, directions, t_max)
}

#[test]
fn bundles_meet_what_their_rays_do() {
    let mut rng = Rng(35);
    let (mut hits, mut together) = (0, 0);
    for case in 0..cases(CASES) {
        let plain = mesh(&mut rng);
        let pool = Pool::new(Some(1));
        for isa in Isa::all() {
            let Some(triangles) = Triangles::new(&plain, Builder::new(&pool, isa)) else {
                continue;
            };
            for _ in 0..RAYS / 3 {
                let bundle = bundle(&mut rng, &plain);
                let own = [(); BUNDLE].map(|()| {
                    let face = rng.below(plain.triangles().len()) as u64;
                    FaceId::of_shape(face)
                });
                let leaves = rng.below(2) == 0;
                let leaving = own.each_ref().map(|own| match leaves {
                    true => Leaving::only(own),
                    false => Leaving::NOTHING,
                });
                let expected = bundle.each(|lane, ray, t_max| {
                    plain.crossings(ray, leaving[lane]).first_of_all(t_max)
                });
                let found = triangles.first_of_each(&plain, &bundle, &leaving);
                assert_eq!(
                    found.map(bits),
                    expected.map(bits),
                    "case {case}: {bundle:?} {plain:?}"
                );
                hits += found.iter().flatten().count();
                together += usize::from(
                    isa.run(FirstOfEach {
                        triangles: &triangles,
                        bundle: &bundle,
                        leaving: &leaving,
                    })
                    .is_some(),
                );
                // The same with the knowledge of the crossings.
                let t = expected.map(|crossing| crossing.map_or(1.0, |crossing| crossing.t));
                let is_hit = expected.map(|crossing| crossing.is_some());
                let known = Bundle::to(*bundle.origins(), *bundle.directions(), &t, is_hit);
                let found = triangles.first_of_each(&plain, &known, &leaving);
                assert_eq!(
                    found.map(bits),
                    expected.map(bits),
                    "case {case}: {known:?} {plain:?}"
                );
            }
        }
    }
    assert!(hits > cases(CASES) * RAYS / 3, "{hits}");
    assert!(together > cases(CASES) * RAYS / 9, "{together}");
}

#[test]
fn a_mesh_is_hit_where_its_triangles_are() {
    let mut rng = Rng(32);
    let mut hits = 0;
    for _ in 0..cases(CASES) {
        let mesh = mesh(&mut rng);
        let ray = ray(&mut rng, &mesh);
        let mut expected: Option<Crossing> = None;
        for face in 0..mesh.triangles().len() as u64 {
            let [a, b, c] = mesh.corners(face).unwrap();
            let t_max = expected.map_or(f64::INFINITY, |crossing| crossing.t);
            let t = Triangle::new(a, b, c).ok();
            let t = t.and_then(|triangle| triangle.intersect(&ray, t_max));
            expected = t.map(|t| Crossing { t, face }).or(expected);
        }
        let found = mesh.crossings(&ray, Leaving::NOTHING).first(f64::INFINITY);
        assert_eq!(bits(found), bits(expected), "{mesh:?} {ray:?}");
        hits += usize::from(found.is_some());
    }
    assert!(hits > cases(CASES) / 4, "{hits}");
}

/// Returns an octahedron whose triangles are divided in four some times, as a sphere.
fn sphere(levels: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut vertices = vec![x, y, -x, -y, z, -z];
    let upper = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let lower = upper.map(|[a, b, _]| [b, a, 5]);
    let mut triangles: Vec<[u32; 3]> = [upper, lower].concat();
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                vertices.push(unit(vertices[a as usize] + vertices[b as usize]));
                vertices.len() as u32 - 1
            })
        };
        let divided = triangles.iter().flat_map(|[a, b, c]| {
            let (a, b, c) = (*a, *b, *c);
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        });
        triangles = divided.collect();
    }
    (vertices, triangles)
}

/// Counts the rays that leak through a closed mesh, each to a corner, the middle of an edge, or any
/// point of one.
fn leaks(rng: &mut Rng, levels: usize, rays: usize) -> usize {
    let (mut vertices, triangles) = sphere(levels);
    let (center, size) = (rng.vector() * 10.0, rng.magnitude(-3.0, 3.0));
    // As rough as the triangles are small, so that few of them are near a ray.
    let roughness = 0.6 / f64::from(1_u32 << levels);
    for vertex in &mut vertices {
        // Seen from the middle, none hides another.
        *vertex = center + *vertex * size * (1.0 + roughness * rng.signed());
    }
    let mesh = Mesh::new(vertices, triangles).unwrap();
    index_mesh(&mesh, Builder::new(&Pool::new(None), Isa::best()));
    let leaks = (0..rays).filter(|_| {
        let face = rng.below(mesh.triangles().len()) as u64;
        let [a, b, _] = mesh.corners(face).unwrap();
        let share = rng.signed().abs();
        let to = a + (b - a) * rng.one(&[0.0, 0.5, share]);
        let from = center + 1e-3 * size * rng.vector();
        let passage = Ray::new(from, to - from);
        let passage = mesh.crossings(&passage, Leaving::NOTHING);
        passage.first(f64::INFINITY).is_none()
    });
    leaks.count()
}

#[test]
fn a_closed_mesh_has_no_gaps() {
    let mut rng = Rng(33);
    const MESHES: usize = 60;
    for case in 0..MESHES {
        assert_eq!(leaks(&mut rng, 1 + case % 4, cases(24_000) / MESHES), 0);
    }
}

/// A million triangles; `.ci/run` sends ten million rays.
#[test]
fn a_large_closed_mesh_has_no_gaps() {
    let rays = cases(1000);
    let levels = if rays < 1_000_000 { 5 } else { 9 };
    // Eight triangles, of which each becomes four.
    let triangles = 8 << (2 * levels);
    let leaks = leaks(&mut Rng(36), levels, rays);
    assert_eq!(
        leaks, 0,
        "{leaks} of {rays} rays through {triangles} triangles"
    );
}

#[test]
fn a_smooth_normal_is_that_of_the_corner_on_the_side_of_the_face() {
    let mut rng = Rng(34);
    let (vertices, triangles) = sphere(3);
    let flat = Mesh::new(vertices.clone(), triangles.clone()).unwrap();
    let smooth = Mesh::new(vertices, triangles).unwrap().smooth();
    let mut turned = 0;
    for _ in 0..cases(1000) {
        let corner = smooth.vertices()[rng.below(smooth.vertices().len())];
        let from = corner * 3.0 + rng.vector() * 2.0;
        let to = corner + 0.3 * rng.vector();
        for ray in [Ray::new(corner * 3.0, -corner), Ray::new(from, to - from)] {
            let passage = smooth.crossings(&ray, Leaving::NOTHING);
            let Some(Crossing { t, face }) = passage.first(f64::INFINITY) else {
                continue;
            };
            let [normal, own] = [&smooth, &flat].map(|mesh| mesh.normal_on(face, &ray, t));
            assert!((normal.length() - 1.0).abs() < 1e-12);
            let is_front = |normal: DVec3| ray.direction().dot(normal) < 0.0;
            assert_eq!(is_front(normal), is_front(own), "{ray:?}");
            let off = (normal - unit(ray.at(t))).length();
            turned += usize::from(off > 0.1);
            assert!(off < 0.3, "{off} {ray:?}");
            if ray.direction() == -corner {
                let faces = 0..flat.triangles().len() as u64;
                let around = faces.filter_map(|face| {
                    let corners = flat.corners(face)?;
                    corners.contains(&corner).then_some(corners)
                });
                let sum: DVec3 = around.map(|[a, b, c]| (b - a).cross(c - a)).sum();
                assert!((normal - unit(sum)).length() < 1e-9, "{normal} {corner}");
            }
        }
    }
    assert!(turned < cases(1000) / 20, "{turned}");
}

// However far the rays come from: no box in f32 may become one that holds all, even the lanes without a box.
#[test]
fn the_faces_near_a_point_are_those_of_the_loop() {
    let mut rng = Rng(43);
    let pool = Pool::new(Some(1));
    let isas = Isa::all();
    let (mut near, mut far) = (0, 0);
    let near_faces = |mesh: &Mesh, point: &ContactPoint| {
        let mut faces = Vec::new();
        mesh.each_face(point, &mut |face| faces.push(face.face));
        faces.sort_unstable();
        faces
    };
    for case in 0..cases(CASES) {
        let mesh = mesh(&mut rng);
        let points = [(); RAYS].map(|()| {
            let target = ray(&mut rng, &mesh).origin();
            let away = rng.vector() * rng.magnitude(-9.0, 60.0);
            far += usize::from(away.length() > 1e45);
            ContactPoint::vague(&Ray::new(target - away, away), 1.0)
        });
        let faces = points.each_ref().map(|point| near_faces(&mesh, point));
        let builder = Builder::new(&pool, isas[case % isas.len()]);
        mesh.index_with(|mesh| Some(Box::new(Triangles::new(mesh, builder)?)));
        for (point, expected) in points.iter().zip(faces) {
            assert_eq!(near_faces(&mesh, point), expected, "{point:?} of {mesh:?}");
            near += usize::from(!expected.is_empty());
        }
    }
    assert!(near > cases(CASES), "only {near} points are near a face");
    assert!(far > cases(CASES), "only {far} rays come from far away");
}

#[test]
fn a_mesh_is_indexed_once() {
    let (vertices, triangles) = torus(9, 9, 0.5);
    let mesh = Arc::new(Mesh::new(vertices, triangles).unwrap());
    let pool = Pool::new(Some(1));
    let mut built = 0;
    for _ in 0..2 {
        mesh.index_with(|mesh| {
            built += 1;
            Some(Box::new(Triangles::new(
                mesh,
                Builder::new(&pool, Isa::best()),
            )?))
        });
    }
    assert_eq!(built, 1);
}

// A mesh is shared by scenes, so it must not keep a part of an index.
#[test]
fn a_cancelled_mesh_has_no_index() {
    let (vertices, triangles) = torus(24, 24, 0.3);
    let mesh = Mesh::new(vertices, triangles).unwrap();
    let (pool, cancel) = (Pool::new(Some(2)), Cancel::new());
    let builder = Builder {
        cancel: Some(&cancel),
        ..Builder::new(&pool, Isa::best())
    };
    assert!(Triangles::new(&mesh, builder).is_some());
    cancel.cancel();
    assert!(Triangles::new(&mesh, builder).is_none());
}
