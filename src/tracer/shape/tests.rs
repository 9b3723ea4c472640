//! What holds for every shape.

use glam::DVec3;

use crate::tracer::{
    random::{Rng, cases},
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        Extent, Membership, Shape,
        any::any,
        capsule::Capsule,
        cone::Cone,
        cuboid::Cuboid,
        cylinder::Cylinder,
        ellipsoid::Ellipsoid,
        face::{Crossing, FaceId, Leaving},
        mesh::{Mesh, MeshGroup},
        rectangle::Rectangle,
        solid::{Operation, Solid},
        torus::Torus,
        triangle::Triangle,
    },
    vector::unit,
};

/// Number of random cases; `STRAHL_CASES` overrides it.
const CASES: usize = 20_000;

fn shape(rng: &mut Rng) -> Shape {
    let center = rng.vector() * rng.one(&[0.0, 1.0, 100.0]);
    let size = rng.magnitude(-2.0, 1.0);
    any(rng, center, size).unwrap()
}

/// Returns a ray that mostly points at a shape.
fn ray(rng: &mut Rng, shape: &Shape) -> Ray {
    let [low, high] = shape.bounds().unwrap();
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let size = half.length();
    let origin = middle + rng.vector() * size * rng.magnitude(-1.0, 3.0);
    let to = middle + rng.vector() * half * 1.1;
    let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]);
    let direction = if rng.below(9) == 0 { axis } else { to - origin };
    Ray::new(origin, direction * rng.magnitude(-2.0, 2.0))
}

fn crossings(shape: &Shape, ray: &Ray, leaving: Leaving, t_max: f64) -> Vec<Crossing> {
    let mut all = Vec::new();
    shape.each_crossing(ray, leaving, t_max, |crossing| all.push(crossing));
    let first = shape.meet(ray, leaving, t_max);
    assert_eq!(all.first().copied(), first, "{shape:?} {ray:?}");
    all
}

#[test]
fn the_first_crossing_is_the_hit_and_all_are_in_order() {
    let mut rng = Rng(11);
    let mut hits = 0;
    for _ in 0..cases(CASES) {
        let shape = shape(&mut rng);
        let ray = ray(&mut rng, &shape);
        let all = crossings(&shape, &ray, Leaving::NOTHING, f64::INFINITY);
        let met = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY);
        assert_eq!(shape.intersect(&ray, f64::INFINITY), met.map(|it| it.t));
        assert!(all.is_sorted_by_key(|crossing| crossing.t), "{all:?}");
        if let Some(Crossing { t, face }) = met {
            hits += 1;
            assert_eq!(shape.face_at(&ray, t), face);
            assert_eq!(shape.meet(&ray, Leaving::NOTHING, t), None);
            let length = shape.normal_at(&ray, Crossing { t, face }).length();
            assert!((length - 1.0).abs() < 1e-12, "{length}");
        }
    }
    assert!(hits > cases(CASES) / 3, "{hits}");
}

// Culling needs this: see `accel/bvh/frame.rs`.
#[test]
fn hits_lie_in_the_box_and_in_the_ball() {
    let mut rng = Rng(12);
    for _ in 0..cases(CASES) {
        let shape = shape(&mut rng);
        let Extent::Ball(center, radius) = shape.extent() else {
            continue;
        };
        let ray = ray(&mut rng, &shape);
        let [low, high] = shape.bounds().unwrap();
        let slack =
            1.42e-7 * (ray.origin() - center).length().max(radius) + 1e-15 * center.length();
        for Crossing { t, .. } in crossings(&shape, &ray, Leaving::NOTHING, f64::INFINITY) {
            let point = ray.at(t);
            let beyond = (low - point).max(point - high).max_element();
            assert!(beyond <= slack, "{beyond} > {slack}: {shape:?} {ray:?}");
            assert!(
                (point - center).length() <= radius + slack,
                "{shape:?} {ray:?}"
            );
        }
    }
}

/// Returns true if a ray that leaves a point of a solid goes inward.
fn goes_inward(shape: &Shape, from: &Ray, crossing: Crossing, direction: DVec3) -> Option<bool> {
    let slope = shape.normal_at(from, crossing).dot(direction) / direction.length();
    (slope.abs() > 1e-3).then_some(slope < 0.0)
}

/// Returns true if a shape is closed, and not so flat that the normal at a point of the other side is
/// as good.
fn is_closed(shape: &Shape) -> bool {
    let is_thick = |lengths: [f64; 3]| {
        let [most, least] = [f64::max, f64::min].map(|of| lengths.into_iter().reduce(of).unwrap());
        most < 1e5 * least
    };
    match shape {
        Shape::Cylinder(cylinder) => cylinder.capped(),
        Shape::Cone(cone) => cone.capped(),
        Shape::Ellipsoid(ellipsoid) => is_thick(ellipsoid.axes().map(DVec3::length)),
        Shape::Placed(placed) => {
            let map = placed.transform();
            let back = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| map.normal(axis).length());
            back.into_iter().all(|back| back * map.stretch() < 1e5) && is_closed(placed.shape())
        }
        // A ray that leaves a hollow, or a copy, may meet another side.
        Shape::Torus(_) | Shape::Mesh(_) | Shape::Solid(_) | Shape::Instances(_) => false,
        shape => !shape.is_flat(),
    }
}

#[test]
fn a_ray_that_leaves_a_closed_shape_meets_it_only_inward() {
    let mut rng = Rng(13);
    let (mut inward, mut outward) = (0, 0);
    for _ in 0..cases(CASES) {
        let shape = shape(&mut rng);
        if !is_closed(&shape) {
            continue;
        }
        let ray = ray(&mut rng, &shape);
        let Some(crossing) = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY) else {
            continue;
        };
        let next = Ray::new(ray.at(crossing.t), rng.vector());
        let own = FaceId::of_shape(crossing.face);
        let found = crossings(&shape, &next, Leaving::only(&own), f64::INFINITY);
        match goes_inward(&shape, &ray, crossing, next.direction()) {
            Some(true) => {
                inward += 1;
                // At the edge of two faces there may be nothing left of the way through.
                assert!(found.len() <= 1, "{found:?} {shape:?}");
            }
            Some(false) => {
                outward += 1;
                assert_eq!(found, [], "{shape:?} {next:?}");
            }
            None => {}
        }
    }
    assert!(
        inward.min(outward) > cases(CASES) / 20,
        "{inward} {outward}"
    );
}

// Where two faces meet, rounding may put the crossing of the other one behind or before the origin.
#[test]
fn a_ray_that_leaves_from_an_edge_meets_no_other_face_there() {
    let mut rng = Rng(16);
    let [cylinder, cone, capsule, cuboid, _] = solids();
    for _ in 0..cases(CASES) {
        let (sin, cos) = libm::sincos(rng.signed() * 4.0);
        let rim = DVec3::new(cos, 0.0, sin);
        let corner = DVec3::new(1.0, rng.signed(), 1.0);
        let nudge = rng.vector() * 1e-16;
        let (x, z) = (DVec3::X, DVec3::Z);
        for (shape, point, normals) in [
            (&cylinder, rim + nudge, [rim, DVec3::NEG_Y, DVec3::NEG_Y]),
            (
                &cone,
                rim + nudge,
                [rim * 2.0 + DVec3::Y, DVec3::NEG_Y, DVec3::NEG_Y],
            ),
            (&capsule, rim + nudge, [rim, rim, rim]),
            (&cuboid, corner + nudge, [x, x, z]),
        ] {
            let faces: [u64; 3] = if point == corner + nudge {
                [1, 1, 5]
            } else {
                [0, 1, 1]
            };
            let along = rng.vector().cross(normals[0]) * rng.magnitude(-6.0, 0.0);
            let outward = normals[0] + normals[1] * rng.signed().abs() + along;
            let is_outward = normals.iter().all(|normal| normal.dot(outward) > 0.0);
            for face in faces {
                let own = FaceId::of_shape(face);
                let leave = |direction| {
                    let ray = Ray::new(point, direction);
                    crossings(shape, &ray, Leaving::only(&own), f64::INFINITY)
                };
                if is_outward {
                    assert_eq!(leave(outward), [], "{shape:?} {point} {outward}");
                }
                let inward = leave(DVec3::new(0.01, 0.5, 0.02) - point);
                assert!(inward.iter().all(|at| at.t > 1e-3), "{shape:?} {inward:?}");
            }
        }
    }
}

fn down(x: f64, z: f64) -> Ray {
    Ray::new(DVec3::new(x, 10.0, z), DVec3::new(0.0, -2.0, 0.0))
}

fn hit(shape: &Shape, ray: &Ray) -> Option<(f64, u64, DVec3)> {
    let crossing = shape.meet(ray, Leaving::NOTHING, f64::INFINITY)?;
    Some((crossing.t, crossing.face, shape.normal_at(ray, crossing)))
}

fn solids() -> [Shape; 5] {
    let (o, top) = (DVec3::ZERO, DVec3::Y * 2.0);
    [
        Cylinder::new(o, top, 1.0, true).unwrap().into(),
        Cone::new(o, top, 1.0, 0.0, true).unwrap().into(),
        Capsule::new(o, top, 1.0).unwrap().into(),
        Cuboid::new(DVec3::NEG_ONE, DVec3::ONE).unwrap().into(),
        Ellipsoid::new(o, [DVec3::X * 2.0, DVec3::Y * 4.0, DVec3::Z])
            .unwrap()
            .into(),
    ]
}

#[test]
fn solids_are_met_where_they_should_be() {
    let [cylinder, cone, capsule, cuboid, ellipsoid] = solids();
    assert_eq!(hit(&cylinder, &down(0.5, 0.0)), Some((4.0, 2, DVec3::Y)));
    assert_eq!(hit(&cylinder, &down(1.5, 0.0)), None);
    assert_eq!(hit(&cone, &down(0.0, 0.0)).unwrap().0, 4.0, "the tip");
    let (t, face, normal) = hit(&cone, &down(0.5, 0.0)).unwrap();
    assert_eq!((t, face), (4.5, 0));
    assert!((normal - unit(DVec3::new(2.0, 1.0, 0.0))).length() < 1e-15);
    assert_eq!(hit(&capsule, &down(0.0, 0.0)), Some((3.5, 2, DVec3::Y)));
    assert_eq!(hit(&cuboid, &down(0.5, 0.5)), Some((4.5, 3, DVec3::Y)));
    assert_eq!(hit(&ellipsoid, &down(0.0, 0.0)), Some((3.0, 0, DVec3::Y)));
    let up = Ray::new(DVec3::new(0.5, -4.0, 0.0), DVec3::Y);
    assert_eq!(hit(&cylinder, &up), Some((4.0, 1, DVec3::NEG_Y)));
    assert_eq!(hit(&cone, &up), Some((4.0, 1, DVec3::NEG_Y)));
    let beside = Ray::new(DVec3::new(-4.0, 1.0, 0.0), DVec3::X);
    assert_eq!(hit(&cylinder, &beside), Some((3.0, 0, DVec3::NEG_X)));
    assert_eq!(hit(&capsule, &beside), Some((3.0, 0, DVec3::NEG_X)));
    assert_eq!(hit(&cuboid, &beside), Some((3.0, 0, DVec3::NEG_X)));
    for solid in solids() {
        let inside = DVec3::Y * 0.25;
        assert!(
            matches!(solid.membership(inside), Membership::Inside(..)),
            "{solid:?}"
        );
        assert_eq!(solid.membership(DVec3::Y * 4.0), Membership::Outside);
    }
}

#[test]
fn a_point_on_the_surface_is_not_inside() {
    let [from, to] = [DVec3::ZERO, DVec3::new(0.3, 0.7, 0.1)];
    let cylinder = Shape::from(Cylinder::new(from, to, 0.5, true).unwrap());
    let cone = Shape::from(Cone::new(from, to, 0.5, 0.2, true).unwrap());
    let block = Cuboid::new(DVec3::splat(-2.0), DVec3::splat(2.0)).unwrap();
    for shape in [cylinder, cone] {
        let union = Solid::new(Operation::Union, [shape.clone()]).unwrap();
        let cut = Solid::new(Operation::Difference, [block.into(), shape.clone()]).unwrap();
        for shape in [shape, union.into(), cut.into()] {
            assert_eq!(shape.membership(from), Membership::Outside, "{shape:?}");
            assert_eq!(shape.membership(to), Membership::Outside, "{shape:?}");
            let is_cut = shape.membership(to * 0.5) == Membership::Outside;
            let beyond = shape.membership(to * 1.001);
            assert_eq!(
                matches!(beyond, Membership::Inside(..)),
                is_cut,
                "{shape:?}"
            );
        }
    }
}

#[test]
fn the_mirrored_half_of_a_cone_is_never_met() {
    let cone = |top, capped| Cone::new(DVec3::ZERO, DVec3::Y, 1.0, top, capped).unwrap();
    let across = |y: f64| Ray::new(DVec3::new(-9.0, y, 0.0), DVec3::X);
    for capped in [true, false] {
        let pointed = cone(0.0, capped);
        assert_eq!(pointed.intersect(&across(0.5), f64::INFINITY), Some(8.5));
        for y in [1.0 + 1e-9, 1.5, 2.0, 5.0, -1e-9, -1.0] {
            assert_eq!(pointed.intersect(&across(y), f64::INFINITY), None, "{y}");
        }
        // Steep, through both halves; along the axis; parallel to the side.
        let steep = Ray::new(DVec3::new(0.1, 5.0, 0.0), DVec3::new(0.0, -1.0, 0.0));
        let t = pointed.intersect(&steep, f64::INFINITY).unwrap();
        assert!((t - 4.1).abs() < 1e-12, "{t}");
        let along = Ray::new(DVec3::new(-0.5, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0) * 0.5);
        let t = pointed.intersect(&along, f64::INFINITY);
        assert!(t.is_some(), "{capped}");
    }
    let wide = cone(3.0, true);
    assert_eq!(wide.intersect(&across(-0.9), f64::INFINITY), None);
    assert_eq!(wide.intersect(&across(0.5), f64::INFINITY), Some(7.0));
}

#[test]
fn an_open_tube_is_seen_from_inside() {
    let tube = Cylinder::new(DVec3::ZERO, DVec3::Y * 2.0, 1.0, false).unwrap();
    assert_eq!(tube.intersect(&down(0.5, 0.0), f64::INFINITY), None);
    let into = Ray::new(DVec3::new(0.0, 3.0, 0.0), DVec3::new(1.0, -2.0, 0.0));
    assert_eq!(tube.intersect(&into, f64::INFINITY), Some(1.0));
    let closed = Cylinder::new(DVec3::ZERO, DVec3::Y * 2.0, 1.0, true).unwrap();
    assert_eq!(closed.intersect(&into, f64::INFINITY), Some(0.5));
}

// The rim is where the caps and the side meet, and the edges of a box where its faces do.
#[test]
fn nothing_slips_through_the_edges() {
    let mut rng = Rng(14);
    let [cylinder, _, _, cuboid, _] = solids();
    for _ in 0..cases(CASES) {
        let angle = rng.signed() * 4.0;
        let rim = DVec3::new(libm::cos(angle), 2.0, libm::sin(angle));
        let inside = DVec3::new(0.0, 1.0, 0.0);
        let ray = Ray::new(rim + (rim - inside) * 3.0, inside - rim);
        assert!(cylinder.intersect(&ray, f64::INFINITY).is_some());
        let mut edge = rng.vector();
        edge[rng.below(3)] = 1.0;
        edge[rng.below(3)] = -1.0;
        let ray = Ray::new(edge * 3.0, -edge * rng.magnitude(-1.0, 1.0));
        assert!(cuboid.intersect(&ray, f64::INFINITY).is_some(), "{ray:?}");
    }
}

#[test]
fn triangles_that_share_an_edge_or_a_corner_leave_no_gap() {
    let mut rng = Rng(15);
    for _ in 0..cases(CASES) {
        let scale = rng.magnitude(-3.0, 3.0);
        let at = rng.vector() * scale;
        let around: Vec<_> = (0..5)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 5.0)
            .map(|angle| at + DVec3::new(libm::cos(angle), libm::sin(angle), 0.1 * rng.signed()))
            .collect();
        let fan = (0..5).map(|k| Triangle::new(at, around[k], around[(k + 1) % 5]).unwrap());
        let fan: Vec<_> = fan.collect();
        let k = rng.below(5);
        let to = at + (around[k] - at) * rng.one(&[0.0, 0.5, 0.3]);
        let origin = at + DVec3::new(rng.signed(), rng.signed(), 3.0);
        let ray = Ray::new(origin, to - origin);
        let is_met = fan
            .iter()
            .any(|triangle| triangle.intersect(&ray, f64::INFINITY).is_some());
        assert!(is_met, "{fan:?} {ray:?}");
    }
}

#[test]
fn a_rectangle_is_a_parallelogram() {
    let corner = DVec3::new(1.0, 0.0, 1.0);
    let leaning = DVec3::new(1.0, 0.0, 2.0);
    let rectangle = Rectangle::new(corner, DVec3::X * 2.0, leaning).unwrap();
    let hits = |x, z| rectangle.intersect(&down(x, z), f64::INFINITY);
    for (x, z) in [(1.0, 1.0), (3.0, 1.0), (4.0, 3.0), (2.0, 3.0), (2.5, 2.0)] {
        assert_eq!(hits(x, z), Some(5.0), "{x} {z}");
    }
    for (x, z) in [(0.9, 1.0), (3.1, 1.0), (1.4, 2.0), (2.0, 3.1)] {
        assert_eq!(hits(x, z), None, "{x} {z}");
    }
    assert_eq!(
        rectangle.bounds(),
        Some([corner, DVec3::new(4.0, 0.0, 3.0)])
    );
}

#[test]
fn boxes_around_shapes_are_tight() {
    let expected = [
        [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0)],
        [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0)],
        [DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 3.0, 1.0)],
        [DVec3::NEG_ONE, DVec3::ONE],
        [DVec3::new(-2.0, -4.0, -1.0), DVec3::new(2.0, 4.0, 1.0)],
    ];
    for (solid, [low, high]) in solids().iter().zip(expected) {
        let bounds = solid.bounds().unwrap();
        assert!((bounds[0] - low).length() < 3e-4, "{bounds:?}");
        assert!((bounds[1] - high).length() < 3e-4, "{bounds:?}");
        let far = solid.farthest_from(DVec3::NEG_Y * 9.0);
        let highest = (DVec3::Y * high.y + DVec3::Y * 9.0).length();
        assert!(far >= highest - 1e-9, "{far} {highest}");
    }
}

#[test]
fn impossible_shapes_are_refused() {
    let (o, x, y) = (DVec3::ZERO, DVec3::X, DVec3::Y);
    assert!(Cylinder::new(o, o, 1.0, true).is_err());
    assert!(Cylinder::new(o, x, 0.0, true).is_err());
    assert!(Cone::new(o, x, 1.0, -0.1, true).is_err());
    assert!(Capsule::new(x, x, 1.0).is_err());
    assert!(Cuboid::new(o, DVec3::new(1.0, 0.0, 1.0)).is_err());
    assert!(Triangle::new(o, x, x * 2.0).is_err());
    assert!(Rectangle::new(o, x, x * -3.0).is_err());
    assert!(Ellipsoid::new(o, [x, y, o]).is_err());
    assert!(Ellipsoid::new(o, [x, y + 1e-3 * x, DVec3::Z]).is_err());
    assert!(Ellipsoid::new(o, [x, y + 1e-7 * x, DVec3::Z]).is_ok());
    assert!(Torus::new(o, o, 2.0, 1.0).is_err());
    assert!(Torus::new(o, x, 2.0, 0.0).is_err());
    assert!(Torus::new(o, x, 2.0, 2.0).is_err());
}

#[test]
fn a_bundle_meets_what_its_rays_do() {
    let mut rng = Rng(61);
    let mut hits = 0;
    for _ in 0..cases(CASES / 4) {
        let shape = shape(&mut rng);
        let (mut lines, mut owns) = ([[[0.0; BUNDLE]; 3]; 2], [None; BUNDLE]);
        for lane in 0..BUNDLE {
            let ray = ray(&mut rng, &shape);
            for (lines, vector) in lines.iter_mut().zip([ray.origin(), ray.direction()]) {
                for (line, x) in lines.iter_mut().zip(vector.to_array()) {
                    line[lane] = x;
                }
            }
            let face = rng.below(shape.face_count() as usize) as u64;
            owns[lane] = (rng.below(3) == 0).then(|| FaceId::of_shape(face));
        }
        let t_max = [(); BUNDLE].map(|()| rng.one(&[f64::INFINITY, 1.0, 0.0]));
        let bundle = Bundle::new(lines[0], lines[1], t_max);
        let leaving = owns.each_ref().map(|own: &Option<FaceId>| match own {
            Some(own) => Leaving::only(own),
            None => Leaving::NOTHING,
        });
        let expected = bundle.each(|lane, ray, t_max| shape.meet(ray, leaving[lane], t_max));
        assert_eq!(
            shape.first_of_each(&bundle, &leaving),
            expected,
            "{shape:?}"
        );
        hits += expected.iter().flatten().count();
    }
    assert!(hits > cases(CASES) / 8, "{hits}");
}

#[test]
fn names_of_triangles_last_up_to_the_next() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].to_vec();
    let group = |name: &str, first| MeshGroup {
        name: name.to_owned(),
        first,
    };
    let groups = vec![
        group("roof", 3),
        group("none", 1),
        group("wall", 1),
        group("end", 5),
    ];
    let mesh = Mesh::new(corners.clone(), vec![[0, 1, 2]; 5]).unwrap();
    let named = mesh.with_groups(groups);
    assert_eq!(named.groups(), [group("wall", 1), group("roof", 3)]);
    let names = [0, 1, 2, 3, 4].map(|at| named.group_of(at).map(|group| group.name.as_str()));
    let [wall, roof] = [Some("wall"), Some("roof")];
    assert_eq!(names, [None, wall, wall, roof, roof]);
    assert_eq!(named, Mesh::new(corners, vec![[0, 1, 2]; 5]).unwrap());
}
