//! Worlds of a few geometries, which all are tested by eight rays.

use std::slice;

use crate::{
    accel::{
        convex::is_tested,
        first_of_each,
        lanes::{abs, bits, dot, load3, splat3, sub},
        mesh::sheared::{ShearedApart, is_hit},
        near_faces::{NearFaces, TINY, slack_of_ball},
        shadow::WRONG,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd, isa::Isa},
    tracer::{
        geometry::Geometry,
        ray::{BUNDLE, Bundle, Ray},
        shape::{
            Shape,
            around::{Around, GROWTH, ROUNDING},
            contact::REACH,
            face::{FaceId, Leaving},
            plane::Plane,
            rectangle::Rectangle,
            sphere::Sphere,
        },
    },
};

/// The largest number of geometries of which this is faster than a tree.
const MOST: usize = 16;

/// The largest number of triangles of a mesh that rays are tested with one by one.
const TRIANGLES: usize = 64;

/// The geometries of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Few<'a> {
    geometries: &'a [Geometry],
    isa: Isa,
}

/// What eight shadow rays meet, lane i as bit i.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct InTheWay {
    /// Those that meet something opaque.
    pub(crate) dark: u8,
    /// The others that meet glass.
    pub(crate) glass: u8,
}

/// Points where rays have arrived.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrivals {
    /// Their coordinates, by axis.
    pub(crate) at: [[f64; LANES]; 3],
    /// The largest coordinate of each point and of the origin of its ray.
    pub(crate) most: [f64; LANES],
    /// The faces that were hit.
    pub(crate) own: [FaceId; LANES],
    /// Those that are asked for, lane i as bit i.
    pub(crate) asked: u8,
}

impl Arrivals {
    pub(crate) const NONE: Self = Self {
        at: [[0.0; LANES]; 3],
        most: [0.0; LANES],
        own: [FaceId {
            geometry: 0,
            face: 0,
        }; LANES],
        asked: 0,
    };

    /// Asks for the point of a ray at `t`, on a face.
    pub(crate) fn set(&mut self, lane: usize, ray: &Ray, (own, t): (FaceId, f64)) {
        let (point, origin) = (ray.at(t), ray.origin());
        for axis in 0..3 {
            self.at[axis][lane] = point[axis];
        }
        self.most[lane] = point.abs().max(origin.abs()).max_element();
        self.own[lane] = own;
        self.asked |= 1 << lane;
    }
}

/// Returns true if eight rays are tested with a shape, or one by one as soon.
pub(crate) fn has_test(shape: &Shape) -> bool {
    match shape {
        Shape::Plane(_) => true,
        Shape::Mesh(mesh) => mesh.triangles().len() <= TRIANGLES,
        Shape::Placed(placed) => is_tested(placed.shape()),
        _ => is_tested(shape),
    }
}

impl<'a> Few<'a> {
    /// Returns the geometries of a world if they are few and have tests for eight rays, and if there are instructions
    /// for these.
    pub(crate) fn new(geometries: &'a [Geometry], isa: Isa) -> Option<Self> {
        let all_have = || geometries.iter().all(|geometry| has_test(geometry.shape()));
        let pays = isa.has_vectors() && geometries.len() <= MOST && all_have();
        pays.then_some(Self { geometries, isa })
    }

    /// Returns the nearest crossing of each ray of a bundle, as [`World::nearest`](crate::tracer::world::World)
    /// does; each ray may leave a face.
    pub(crate) fn nearest(
        self,
        bundle: Bundle,
        left: &[Option<FaceId>; BUNDLE],
    ) -> [Option<(FaceId, f64)>; BUNDLE] {
        let found = self.isa.run_with_vectors(NearestOfEach {
            few: self,
            bundle,
            left,
        });
        found.unwrap_or_default()
    }

    /// Returns what is in the way of the rays of a bundle; each may leave a face.
    pub(crate) fn in_the_way(self, bundle: Bundle, left: &[Option<FaceId>; BUNDLE]) -> InTheWay {
        let found = self.isa.run_with_vectors(InTheWayOfEach {
            few: self,
            bundle: bundle.any(),
            left,
        });
        found.unwrap_or_default()
    }

    /// Returns the points that may lie on more faces than the one that was hit: all others surely do not.
    pub(crate) fn touching(self, arrivals: &Arrivals) -> u8 {
        let found = self.isa.run_with_vectors(Touching {
            few: self,
            arrivals,
        });
        found.unwrap_or(u8::MAX)
    }
}

/// RayLanes rays in lanes.
struct RayLanes<'a, S: Simd> {
    bundle: Bundle,
    rays: [[S::F64; 3]; 2],
    /// The rays as the tests of flat shapes with corners need them.
    sheared: ShearedApart<S>,
    left: &'a [Option<FaceId>; BUNDLE],
    /// The index of the geometry of each of these faces.
    of: S::F64,
}

/// Where rays first meet a shape.
#[derive(Clone, Copy)]
struct MetLanes<S: Simd> {
    t: S::F64,
    face: S::F64,
    lanes: S::Mask,
}

impl<'a, S: Simd> RayLanes<'a, S> {
    #[inline(always)]
    fn new(simd: S, bundle: Bundle, left: &'a [Option<FaceId>; BUNDLE]) -> Self {
        let rays = [
            load3(simd, bundle.origins()),
            load3(simd, bundle.directions()),
        ];
        let mut of = [-1.0; LANES];
        for (of, left) in of.iter_mut().zip(left) {
            if let Some(face) = left {
                *of = face.geometry as f64;
            }
        }
        Self {
            sheared: ShearedApart::new(simd, rays),
            bundle,
            rays,
            left,
            of: simd.load(&of),
        }
    }

    /// Returns where the rays first meet a geometry at `0 < t < t_max`, as [`Shape::meet`] does.
    #[inline(always)]
    fn meet(&mut self, simd: S, (index, shape): (usize, &Shape), t_max: S::F64) -> MetLanes<S> {
        let zero = simd.splat(0.0);
        let leaves = self.of.eq(simd.splat(index as f64));
        let (t, lanes) = match shape {
            Shape::Sphere(it) => self.sphere(simd, it, (leaves, t_max)),
            Shape::Plane(it) => {
                let (t, crosses) = self.plane(simd, it);
                (t, crosses & !leaves & zero.lt(t) & t.lt(t_max))
            }
            Shape::Rectangle(it) => self.rectangle(simd, it, (leaves, t_max)),
            _ => return self.other(simd, (index, shape), t_max),
        };
        let face = zero;
        MetLanes { t, face, lanes }
    }

    #[inline(always)]
    fn sphere(
        &self,
        simd: S,
        sphere: &Sphere,
        (leaves, t_max): (S::Mask, S::F64),
    ) -> (S::F64, S::Mask) {
        let (zero, two) = (simd.splat(0.0), simd.splat(2.0));
        let [origin, d] = self.rays;
        let from = sub(origin, splat3(simd, sphere.center()));
        let a = dot(d, d);
        let b = dot(d, [two * from[0], two * from[1], two * from[2]]);
        let c = dot(from, from) - simd.splat(sphere.radius() * sphere.radius());
        let discriminant = b * b - simd.splat(4.0) * a * c;
        let meets = zero.le(discriminant) & !leaves;
        if (meets | leaves).bits() == 0 {
            return (zero, meets);
        }
        let (root, double) = (discriminant.sqrt(), two * a);
        let (near, far) = ((-b - root) / double, (-b + root) / double);
        let is_near = meets & zero.lt(near) & near.lt(t_max);
        // Of a ray that leaves the sphere, one solution is 0.
        let far = S::F64::select(leaves, -b / a, far);
        let is_far = (meets | leaves) & zero.lt(far) & far.lt(t_max);
        (S::F64::select(is_near, near, far), is_near | is_far)
    }

    /// Returns where the lines of the rays cross a plane, and whether they do.
    #[inline(always)]
    fn plane(&self, simd: S, plane: &Plane) -> (S::F64, S::Mask) {
        let ([o, d], normal) = (self.rays, splat3(simd, plane.normal()));
        let up = dot(d, normal);
        let t = dot(sub(splat3(simd, plane.point()), o), normal) / up;
        (t, !up.eq(simd.splat(0.0)))
    }

    #[inline(always)]
    fn rectangle(
        &self,
        simd: S,
        rectangle: &Rectangle,
        (leaves, t_max): (S::Mask, S::F64),
    ) -> (S::F64, S::Mask) {
        let (t, crosses) = self.plane(simd, rectangle.unit_plane());
        let mut lanes = crosses & !leaves & simd.splat(0.0).lt(t) & t.lt(t_max);
        if lanes.bits() == 0 {
            return (t, lanes);
        }
        let (held, odd) = held(simd, rectangle.ball(), self.rays, t);
        lanes = lanes & (held | odd);
        if lanes.bits() == 0 {
            return (t, lanes);
        }
        let [a, b, c, e] = &rectangle.corners();
        let [a, b, c, e] = [
            self.sheared.point(simd, a),
            self.sheared.point(simd, b),
            self.sheared.point(simd, c),
            self.sheared.point(simd, e),
        ];
        let is_hit = is_hit(simd, [a, b, c]) | is_hit(simd, [a, c, e]);
        lanes = lanes & is_hit;
        let odd = (lanes & odd).bits();
        if odd != 0 {
            let beside = bits(odd).filter(|lane| {
                let mut at = [0.0; LANES];
                t.store(&mut at);
                !rectangle.ball().holds(&self.bundle.ray(*lane), at[*lane])
            });
            lanes = lanes & !simd.mask(beside.fold(0, |beside, lane| beside | 1 << lane));
        }
        (t, lanes)
    }

    /// The same for a shape without a test here.
    #[inline(always)]
    fn other(&mut self, simd: S, (index, shape): (usize, &Shape), t_max: S::F64) -> MetLanes<S> {
        let mut ends = [0.0; LANES];
        t_max.store(&mut ends);
        for (lane, t_max) in ends.iter().enumerate() {
            self.bundle.end(lane, *t_max);
        }
        let mut leaving = [Leaving::NOTHING; BUNDLE];
        for (leaving, left) in leaving.iter_mut().zip(self.left) {
            if let Some(face) = left {
                *leaving = Leaving::of(slice::from_ref(face), index);
            }
        }
        let met = match shape {
            // The rays may have nothing in common.
            Shape::Mesh(_) => {
                let mut met = [None; BUNDLE];
                for (lane, met) in met.iter_mut().enumerate() {
                    if ends[lane] > 0.0 {
                        *met = shape.meet(&self.bundle.ray(lane), leaving[lane], ends[lane]);
                    }
                }
                met
            }
            _ => first_of_each(simd, shape, &self.bundle, &leaving),
        };
        let (mut t, mut faces, mut lanes) = ([0.0; LANES], [0.0; LANES], 0);
        for (lane, crossing) in met.into_iter().enumerate() {
            if let Some(crossing) = crossing {
                t[lane] = crossing.t;
                faces[lane] = crossing.face as f64;
                lanes |= 1 << lane;
            }
        }
        MetLanes {
            t: simd.load(&t),
            face: simd.load(&faces),
            lanes: simd.mask(lanes),
        }
    }
}

/// Returns the lanes in which the points of rays at `t` lie in a box and a ball, as [`Around::holds`] finds it, and those
/// in which this is not known because numbers are extreme.
#[inline(always)]
fn held<S: Simd>(
    simd: S,
    around: &Around,
    [origin, d]: [[S::F64; 3]; 2],
    t: S::F64,
) -> (S::Mask, S::Mask) {
    let (center, [low, high], radius) = around.middle();
    let from = sub(origin, splat3(simd, center));
    let point = [from[0] + t * d[0], from[1] + t * d[1], from[2] + t * d[2]];
    let far = abs(from[0]).max(abs(from[1])).max(abs(from[2]));
    let slack =
        simd.splat(GROWTH) * far.max(simd.splat(radius)) + simd.splat(ROUNDING * around.most());
    let radius = simd.splat(radius) + slack;
    let squared = dot(point, point);
    let (low, high) = (splat3(simd, low), splat3(simd, high));
    let mut holds = squared.le(radius * radius);
    for axis in 0..3 {
        holds = holds & low[axis].le(point[axis] + slack) & (point[axis] - slack).le(high[axis]);
    }
    (holds, !squared.lt(simd.splat(f64::INFINITY)))
}

struct NearestOfEach<'a> {
    few: Few<'a>,
    bundle: Bundle,
    left: &'a [Option<FaceId>; BUNDLE],
}

impl Kernel for NearestOfEach<'_> {
    type Output = [Option<(FaceId, f64)>; BUNDLE];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let mut t = simd.load(self.bundle.t_max());
        let mut eight = RayLanes::new(simd, self.bundle, self.left);
        let (mut index, mut face) = (simd.splat(-1.0), simd.splat(0.0));
        for (number, geometry) in self.few.geometries.iter().enumerate() {
            let met = eight.meet(simd, (number, geometry.shape()), t);
            t = S::F64::select(met.lanes, met.t, t);
            index = S::F64::select(met.lanes, simd.splat(number as f64), index);
            face = S::F64::select(met.lanes, met.face, face);
        }
        let mut numbers = [[0.0; LANES]; 3];
        for (numbers, found) in numbers.iter_mut().zip([t, index, face]) {
            found.store(numbers);
        }
        let [t, index, face] = numbers;
        std::array::from_fn(|lane| {
            let id = FaceId {
                geometry: index[lane] as usize,
                face: face[lane] as u64,
            };
            (index[lane] >= 0.0).then_some((id, t[lane]))
        })
    }
}

struct InTheWayOfEach<'a> {
    few: Few<'a>,
    bundle: Bundle,
    left: &'a [Option<FaceId>; BUNDLE],
}

impl Kernel for InTheWayOfEach<'_> {
    type Output = InTheWay;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> InTheWay {
        let (zero, mut t_max) = (simd.splat(0.0), simd.load(self.bundle.t_max()));
        let asked = zero.lt(t_max).bits();
        let mut eight = RayLanes::new(simd, self.bundle, self.left);
        let mut found = InTheWay::default();
        for (number, geometry) in self.few.geometries.iter().enumerate() {
            let met = eight.meet(simd, (number, geometry.shape()), t_max);
            if geometry.has_glass() {
                found.glass |= met.lanes.bits();
                continue;
            }
            found.dark |= met.lanes.bits();
            if found.dark == asked {
                break;
            }
            // Nothing more is asked of a ray in the dark.
            t_max = S::F64::select(met.lanes, zero, t_max);
        }
        found.glass &= !found.dark;
        found
    }
}

/// Returns the points that may lie on a shape of one face, as [`NearFaces`] does; `None` if it has no test here.
#[inline(always)]
fn near_one_face<S: Simd>(
    simd: S,
    shape: &Shape,
    at: &[[f64; LANES]; 3],
    reach: f64,
) -> Option<u8> {
    let at = load3(simd, at);
    let reach = reach + TINY;
    let (height, slack, corners) = match shape {
        Shape::Sphere(it) => {
            let q = sub(at, splat3(simd, it.center()));
            let height = dot(q, q).sqrt() - simd.splat(it.radius());
            (height, slack_of_ball(reach, it.center(), it.radius()), None)
        }
        Shape::Plane(it) => {
            let (height, size) = above(simd, it, at);
            (height, reach + WRONG * size, None)
        }
        Shape::Rectangle(it) => {
            let (height, size) = above(simd, it.unit_plane(), at);
            (height, reach + WRONG * size, it.ball().bounds())
        }
        _ => return None,
    };
    let slack = simd.splat(slack);
    // NaN excludes nothing.
    let mut near = !(height.lt(-slack) | slack.lt(height)).bits();
    if let Some([low, high]) = corners {
        let reach = simd.splat(reach);
        for axis in 0..3 {
            let (low, high) = (simd.splat(low[axis]), simd.splat(high[axis]));
            near &= (low.le(at[axis] + reach) & at[axis].le(high + reach)).bits();
        }
    }
    Some(near)
}

/// Returns the heights of points above a plane, or more, and how large its numbers are.
#[inline(always)]
fn above<S: Simd>(simd: S, plane: &Plane, at: [S::F64; 3]) -> (S::F64, f64) {
    let (point, normal) = (plane.point(), plane.normal());
    // No shorter than at unit length.
    let normal = normal * (1.0 / normal.abs().max_element());
    let q = sub(at, splat3(simd, point));
    (dot(q, splat3(simd, normal)), point.abs().max_element())
}

struct Touching<'a> {
    few: Few<'a>,
    arrivals: &'a Arrivals,
}

/// How much larger than the smallest the coordinates of points are that are asked for together.
const ALIKE: f64 = 16.0;

impl Kernel for Touching<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u8 {
        let Arrivals {
            at,
            most,
            own,
            asked,
        } = self.arrivals;
        let is_asked = |lane: &usize| asked >> lane & 1 != 0;
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for lane in (0..LANES).filter(is_asked) {
            smallest = smallest.min(most[lane]);
        }
        let mut lanes = 0;
        for lane in (0..LANES).filter(is_asked) {
            if most[lane] <= ALIKE * smallest {
                lanes |= 1 << lane;
                largest = largest.max(most[lane]);
            }
        }
        let mut touching = asked & !lanes;
        for (index, geometry) in self.few.geometries.iter().enumerate() {
            let (mut of_it, mut faces) = (0, [0.0; LANES]);
            for (lane, own) in own.iter().enumerate() {
                if own.geometry == index {
                    of_it |= 1 << lane;
                    faces[lane] = own.face as f64;
                }
            }
            let shape = geometry.shape();
            if let Some(near) = near_one_face(simd, shape, at, REACH * largest) {
                touching |= near & lanes & !of_it;
                continue;
            }
            let near = |lanes, except| NearFaces {
                shape,
                at,
                lanes,
                reach: REACH * largest,
                except,
            };
            let others = lanes & !of_it & !touching;
            if others != 0 {
                touching |= others & simd.call(near(others, None));
            }
            let of_it = lanes & of_it & !touching;
            if of_it != 0 && shape.has_faces() {
                touching |= of_it & simd.call(near(of_it, Some(&faces)));
            }
        }
        touching
    }
}
