//! Eight rays at a time: they walk through the tree together and are tested against a triangle in
//! the lanes of a vector, by the equations of the format in their order of operations.

use crate::{
    accel::{
        bvh::traverse::{Seek, Together},
        lanes::load3,
        mesh::{Triangles, sheared::Sheared},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            around::triangle_holds,
            face::{Crossing, Leaving},
            mesh::Mesh,
        },
    },
};

/// The kernel that finds the first crossing of each ray of a bundle; `None` if the rays have to be
/// traced one by one.
pub(super) struct FirstOfEach<'a> {
    pub(super) triangles: &'a Triangles,
    pub(super) mesh: &'a Mesh,
    pub(super) bundle: &'a Bundle,
    /// What each ray leaves.
    pub(super) leaving: &'a [Leaving<'a>; BUNDLE],
}

impl Kernel for FirstOfEach<'_> {
    type Output = Option<[Option<Crossing>; BUNDLE]>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            triangles,
            mesh,
            bundle,
            leaving,
        } = self;
        let rays = [
            load3(simd, bundle.origins()),
            load3(simd, bundle.directions()),
        ];
        let beam = triangles.frame.beam(simd, rays, bundle.start())?;
        let mut search = Search {
            mesh,
            bundle,
            leaving,
            rays: Sheared::new(simd, rays)?,
            t: *bundle.t_max(),
            end: simd.load(bundle.t_max()).largest(),
            faces: [0; BUNDLE],
        };
        let together = Together::new(simd, &beam);
        triangles.tree.traverse(simd, &together, &mut search);
        let Search { t, faces, .. } = search;
        Some(std::array::from_fn(|lane| {
            let (t, face) = (t[lane], faces[lane]);
            (t < bundle.t_max()[lane]).then_some(Crossing {
                t,
                face: face.into(),
            })
        }))
    }
}

/// The rays of a bundle and the first crossing of each so far. Nothing at `t_max` itself is taken,
/// because no number is below 0.
struct Search<'a, S: Simd> {
    mesh: &'a Mesh,
    bundle: &'a Bundle,
    leaving: &'a [Leaving<'a>; BUNDLE],
    rays: Sheared<S>,
    t: [f64; BUNDLE],
    /// The largest of them.
    end: f64,
    faces: [u32; BUNDLE],
}

impl<S: Simd> Seek<S> for Search<'_, S> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.end
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        let Some(corners) = self.mesh.corners_in_place(leaf as u64) else {
            return false;
        };
        let [a, b, c] = corners;
        let lanes = [
            self.rays.splat(simd, a),
            self.rays.splat(simd, b),
            self.rays.splat(simd, c),
        ];
        let Some((t, crosses)) = self.rays.crossings(simd, lanes) else {
            return false;
        };
        let counts = crosses & t.le(simd.load(&self.t));
        match counts.bits() {
            0 => false,
            lanes => {
                let mut at = [0.0; LANES];
                t.store(&mut at);
                let is_nearer = self.take(leaf as u32, lanes, &at);
                if is_nearer {
                    self.end = simd.load(&self.t).largest();
                }
                is_nearer
            }
        }
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.mesh.triangles()[leaf]);
    }
}

impl<S: Simd> Search<'_, S> {
    /// Takes the crossings of some lanes with a triangle that are first so far; returns true if there
    /// is one.
    #[inline(never)]
    fn take(&mut self, face: u32, lanes: u8, t: &[f64; LANES]) -> bool {
        let number = face.into();
        let (Some(corners), Some(plane)) = (self.mesh.corners(number), self.mesh.plane(number))
        else {
            return false;
        };
        let mut is_nearer = false;
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let is_first = t[lane] < self.t[lane] || face < self.faces[lane];
            if is_first
                && !self.leaving[lane].is_in(&plane)
                && triangle_holds(corners, &self.bundle.ray(lane), t[lane])
            {
                (self.t[lane], self.faces[lane]) = (t[lane], face);
                is_nearer = true;
            }
        }
        is_nearer
    }
}
