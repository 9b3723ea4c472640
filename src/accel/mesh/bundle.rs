//! Eight rays at a time: they walk through the tree together and are tested against a triangle in
//! the lanes of a vector, by the equations of the format in their order of operations.

use glam::DVec3;

use crate::{
    accel::{
        bvh::traverse::{Seek, Together},
        lanes::{load3, surely_holds},
        mesh::{
            Triangles,
            patch::{CORNERS, PLACES, Patch, patches_of},
            sheared::{Sheared, crossings},
        },
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            around::{Near, triangle_holds},
            face::{Crossing, Leaving},
            mesh::plane_of,
        },
    },
};

/// The kernel that finds the first crossing of each ray of a bundle; `None` if the rays have to be
/// traced one by one.
pub(super) struct FirstOfEach<'a> {
    pub(super) triangles: &'a Triangles,
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
            bundle,
            leaving,
        } = self;
        let rays = [
            load3(simd, bundle.origins()),
            load3(simd, bundle.directions()),
        ];
        let beam = triangles.frame.beam(simd, rays, bundle.start())?;
        let mut search = Search {
            patches: &triangles.patches,
            bundle,
            leaving,
            lines: rays,
            rays: Sheared::new(simd, rays)?,
            t: *bundle.t_max(),
            end: simd.load(bundle.t_max()).largest(),
            faces: [0.0; BUNDLE],
            leaves_nothing: leaving.iter().all(Leaving::is_empty),
            corners: [[simd.splat(0.0); 3]; PLACES],
        };
        let together = Together::new(simd, &beam);
        triangles.tree.traverse(simd, &together, &mut search);
        let Search { t, faces, .. } = search;
        Some(std::array::from_fn(|lane| {
            let (t, face) = (t[lane], faces[lane] as u64);
            (t < bundle.t_max()[lane]).then_some(Crossing { t, face })
        }))
    }
}

/// The rays of a bundle and the first crossing of each so far. Nothing at `t_max` itself is taken,
/// because no number is below 0.
struct Search<'a, S: Simd> {
    patches: &'a [Patch],
    bundle: &'a Bundle,
    leaving: &'a [Leaving<'a>; BUNDLE],
    lines: [[S::F64; 3]; 2],
    rays: Sheared<S>,
    t: [f64; BUNDLE],
    /// The largest of them.
    end: f64,
    /// The numbers of their triangles.
    faces: [f64; BUNDLE],
    /// True if no ray leaves a triangle.
    leaves_nothing: bool,
    /// The corners of a patch, as the rays see them.
    corners: [[S::F64; 3]; PLACES],
}

impl<S: Simd> Seek<S> for Search<'_, S> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.end
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        let mut is_nearer = false;
        for patch in patches_of(self.patches, leaf) {
            for place in 0..usize::from(patch.count).min(CORNERS) {
                self.corners[place] = self.rays.corner(simd, patch, place);
            }
            for lane in 0..usize::from(patch.triangles).min(LANES) {
                is_nearer |= self.meet(simd, patch, lane);
            }
        }
        if is_nearer {
            self.end = simd.load(&self.t).largest();
        }
        is_nearer
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.patches[leaf]);
    }
}

impl<S: Simd> Search<'_, S> {
    /// Tests a triangle of a patch; returns true if a ray crosses it first so far.
    #[inline(always)]
    fn meet(&mut self, simd: S, patch: &Patch, triangle: usize) -> bool {
        let [a, b, c] = patch.places_of(triangle);
        let corners = [self.corners[a], self.corners[b], self.corners[c]];
        let Some((t, crosses)) = crossings(simd, corners) else {
            return false;
        };
        let last = simd.load(&self.t);
        let crosses = crosses & t.le(last);
        if crosses.bits() == 0 {
            return false;
        }
        let face = patch.faces[triangle];
        let corners = patch.corners_of(triangle);
        let near = surely_holds(simd, &Near::triangle(corners), self.lines, t);
        let is_tied_or_far = crosses & !(t.lt(last) & near);
        if self.leaves_nothing && is_tied_or_far.bits() == 0 && plane_of(corners).is_some() {
            let (number, faces) = (simd.splat(face.into()), simd.load(&self.faces));
            S::F64::select(crosses, t, last).store(&mut self.t);
            S::F64::select(crosses, number, faces).store(&mut self.faces);
            return true;
        }
        let mut at = [0.0; LANES];
        t.store(&mut at);
        self.take(face, corners, [crosses.bits(), near.bits()], &at)
    }

    /// Takes the crossings of some lanes with a triangle that are first so far; returns true if there
    /// is one. In the lanes of `near`, the triangle is known to hold the point at `t`.
    #[cold]
    #[inline(never)]
    fn take(
        &mut self,
        face: u32,
        corners: [DVec3; 3],
        [lanes, near]: [u8; 2],
        t: &[f64; LANES],
    ) -> bool {
        if plane_of(corners).is_none() {
            return false;
        }
        let mut is_nearer = false;
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let is_first = t[lane] < self.t[lane] || f64::from(face) < self.faces[lane];
            if is_first
                && !self.leaving[lane].has(face.into())
                && (near >> lane & 1 == 1
                    || triangle_holds(corners, &self.bundle.ray(lane), t[lane]))
            {
                (self.t[lane], self.faces[lane]) = (t[lane], face.into());
                is_nearer = true;
            }
        }
        is_nearer
    }
}
