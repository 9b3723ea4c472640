//! Faster versions of [`World::hit`](crate::tracer::world::World::hit) with bit-identical results.
//!
//! [`raster`] serves the rays of a camera, which are known in advance. [`bvh`] serves rays that
//! start anywhere: a tree over all bounded shapes. Both have fast paths for spheres, and the raster
//! for planes; any other shape is tested by its own equation, and only where it may be hit.
//! A mesh is one shape to both, with a tree of its own over its triangles, in [`mesh`]; so are a list of
//! copies, in [`instances`], and a solid of many parts, in [`solid`]: their trees are [`places`].
//! [`shadow`] finds which of many points lie in the shadow of a light.
//! [`index`] gives meshes, copies and solids their trees.
//! [`kept`] holds what the frames of an animation share, and [`runs`] the parts of a world that it is of.
//! [`near_faces`] excludes faces that points do not lie on.
//! [`convex`] tests shapes by eight rays, and [`few`] worlds of a few such shapes.
//! [`lanes`] holds the equations for eight lanes, [`pow`] their powers, and [`pages`] the memory of trees.

pub(crate) mod bvh;
mod convex;
pub(crate) mod few;
mod index;
pub(crate) mod instances;
pub(crate) mod kept;
pub(crate) mod lanes;
pub(crate) mod mesh;
pub(crate) mod near_faces;
pub(crate) mod pages;
mod places;
pub(crate) mod pow;
pub(crate) mod raster;
pub(crate) mod runs;
pub(crate) mod shadow;
mod solid;

use glam::DVec3;

use crate::{
    accel::{
        convex::{FirstOfEach, is_tested},
        lanes::{bits, dot, load3, splat3, sub, surely_holds},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            Shape,
            around::Around,
            face::{Crossing, Faces, Leaving},
            placed::Placed,
        },
        transform::Transform,
    },
};

/// Returns the first crossing of each ray of a bundle with a shape.
pub(crate) fn first_of_each<S: Simd>(
    simd: S,
    shape: &Shape,
    bundle: &Bundle,
    leaving: &[Leaving; BUNDLE],
) -> [Option<Crossing>; BUNDLE] {
    match shape {
        Shape::Placed(placed) => simd.call(FirstOfPlaced {
            placed,
            bundle,
            leaving,
        }),
        _ if is_tested(shape) => simd.call(FirstOfEach {
            shape,
            bundle,
            leaving,
        }),
        _ => shape.first_of_each(bundle, leaving),
    }
}

/// Prefetches what a shape refers to, which is not in its place among the others.
#[inline(always)]
fn prefetch_inside<S: Simd>(simd: S, shape: &Shape) {
    match shape {
        Shape::Cylinder(it) => simd.prefetch(&**it),
        Shape::Cone(it) => simd.prefetch(&**it),
        Shape::Cuboid(it) => simd.prefetch(&**it),
        Shape::Disc(it) => simd.prefetch(&**it),
        Shape::Capsule(it) => simd.prefetch(&**it),
        Shape::Ellipsoid(it) => simd.prefetch(&**it),
        Shape::Rectangle(it) => simd.prefetch(&**it),
        Shape::Triangle(it) => simd.prefetch(&**it),
        _ => {}
    }
}

/// Returns the faces that the rays of [`Bundle::to`] meet.
pub(crate) fn face_of_each<S: Simd>(simd: S, shape: &Shape, bundle: &Bundle) -> [u64; BUNDLE] {
    match shape.faces() {
        Faces::Flat | Faces::Curved => [0; BUNDLE],
        Faces::Several | Faces::Copies => {
            let met = first_of_each(simd, shape, bundle, &[Leaving::NOTHING; BUNDLE]);
            met.map(|met| met.map_or(0, |crossing| crossing.face))
        }
    }
}

/// The kernel that finds the first crossing of each ray of a bundle with a shape that is placed.
struct FirstOfPlaced<'a> {
    placed: &'a Placed,
    bundle: &'a Bundle,
    /// What each ray leaves.
    leaving: &'a [Leaving<'a>; BUNDLE],
}

impl Kernel for FirstOfPlaced<'_> {
    type Output = [Option<Crossing>; BUNDLE];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            placed,
            bundle,
            leaving,
        } = self;
        let rays = mapped_back(simd, placed.transform(), bundle);
        let inner = bundle_of(rays, *bundle.t_max());
        let mut met = first_of_each(simd, placed.shape(), &inner, leaving);
        if let Some(around) = placed.around() {
            for lane in bits(not_around(simd, &around, bundle, &met)) {
                let ray = bundle.ray(lane);
                let passage = placed.crossings(&ray, leaving[lane]);
                met[lane] = passage.in_front(bundle.t_max()[lane]).next();
            }
        }
        met
    }
}

/// Returns the rays whose crossings do not lie around a shape.
#[inline(always)]
fn not_around<S: Simd>(
    simd: S,
    around: &Around,
    bundle: &Bundle,
    met: &[Option<Crossing>; BUNDLE],
) -> u8 {
    let (mut t, mut lanes) = ([0.0; LANES], 0_u8);
    for (lane, crossing) in met.iter().enumerate() {
        if let Some(crossing) = crossing {
            t[lane] = crossing.t;
            lanes |= 1 << lane;
        }
    }
    if lanes == 0 {
        return 0;
    }
    let rays = [
        load3(simd, bundle.origins()),
        load3(simd, bundle.directions()),
    ];
    lanes &= !surely_holds(simd, &around.near(), rays, simd.load(&t)).bits();
    let beside = bits(lanes).filter(|lane| !around.holds(&bundle.ray(*lane), t[*lane]));
    beside.fold(0, |beside, lane| beside | 1 << lane)
}

/// Returns a bundle of rays in lanes.
#[inline(always)]
fn bundle_of<V: F64x8>(rays: [[V; 3]; 2], t_max: [f64; LANES]) -> Bundle {
    let mut lines = [[[0.0; LANES]; 3]; 2];
    for (lines, vectors) in lines.iter_mut().zip(rays) {
        for (line, axis) in lines.iter_mut().zip(vectors) {
            axis.store(line);
        }
    }
    let [origins, directions] = lines;
    Bundle::new(origins, directions, t_max)
}

/// Returns the origins and directions of the rays of a bundle that a transform maps to them, as
/// [`Transform::ray_back`] does.
#[inline(always)]
fn mapped_back<S: Simd>(simd: S, transform: &Transform, bundle: &Bundle) -> [[S::F64; 3]; 2] {
    let origin = load3(simd, bundle.origins());
    let origin = sub(origin, splat3(simd, transform.shift()));
    let direction = load3(simd, bundle.directions());
    let (mut lines, rows) = ([origin, direction], transform.inverse());
    for (number, row) in rows.iter().enumerate() {
        let row = splat3(simd, *row);
        lines[0][number] = dot(row, origin);
        lines[1][number] = dot(row, direction);
    }
    lines
}

/// Returns the margin by which to grow a box or a ball whose points have coordinates of at most
/// these, so that it also holds the points `o + t·d` of a shape in it: each coordinate is the sum
/// of two rounded numbers.
fn rounding(coordinates: DVec3) -> f64 {
    8.0 * f64::EPSILON * coordinates.max_element()
}
