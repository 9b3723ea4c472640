//! Eight rays at a time: they walk through the tree together, and their spans inside the parts are combined
//! in the lanes of a vector.

use smallvec::SmallVec;

use crate::{
    accel::{
        convex::{LinesOf, is_tested},
        lanes::{bits, load3},
        places::Met,
        solid::Parts,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            face::{Crossing, Leaving},
            solid::Solid,
            span::{Side, Span},
        },
    },
};

/// The kernel that finds the first crossing of each ray of a bundle with a solid.
pub(super) struct FirstOfEach<'a> {
    pub(super) index: &'a Parts,
    pub(super) solid: &'a Solid,
    pub(super) bundle: &'a Bundle,
    /// What each ray leaves.
    pub(super) leaving: &'a [Leaving<'a>; BUNDLE],
}

/// The spans of eight rays inside a part: where each begins and ends, and the faces there.
#[derive(Clone, Copy)]
struct SpanOfEach {
    t: [[f64; LANES]; 2],
    faces: [[u8; LANES]; 2],
    /// Whether it holds the points right before and after a `t`, lane i as bit i.
    holds: [u8; 2],
}

/// Those inside some parts.
type SpansOfParts = SmallVec<[(usize, SpanOfEach); 8]>;

impl SpanOfEach {
    /// The spans of rays that miss a part.
    const NONE: Self = Self {
        t: [[f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]],
        faces: [[0; LANES]; 2],
        holds: [0; 2],
    };

    fn set(&mut self, lane: usize, span: Span) {
        for (end, at) in [span.enter, span.exit].into_iter().enumerate() {
            self.t[end][lane] = at.t;
            self.faces[end][lane] = at.face as u8;
        }
    }
}

impl Kernel for FirstOfEach<'_> {
    type Output = [Option<Crossing>; BUNDLE];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let t_max = simd.load(self.bundle.t_max());
        let rays = [
            load3(simd, self.bundle.origins()),
            load3(simd, self.bundle.directions()),
        ];
        let wanted = simd.splat(0.0).lt(t_max).bits();
        let mut all = SpansOfParts::new();
        // A loop, because the search is inlined wherever it stands.
        let mut up_to_first = self.index.is_union;
        loop {
            if self.search(simd, rays, wanted, up_to_first, &mut all) {
                sort(&mut all);
                let (crossings, are_first) = self.first(simd, &mut all, wanted);
                if are_first || !up_to_first {
                    return crossings;
                }
            }
            up_to_first = false;
            all.clear();
        }
    }
}

/// Sorts spans by their parts.
#[inline(never)]
fn sort(all: &mut SpansOfParts) {
    all.sort_by_key(|(part, _)| *part);
}

impl FirstOfEach<'_> {
    /// Adds the spans of some rays inside the parts that they may meet: of a union, if asked for, only up to where
    /// each ray first gets into a part. Returns false if that is too few, because a ray begins in one.
    #[inline(always)]
    fn search<S: Simd>(
        &self,
        simd: S,
        rays: [[S::F64; 3]; 2],
        wanted: u8,
        up_to_first: bool,
        all: &mut SpansOfParts,
    ) -> bool {
        let end = simd.load(self.bundle.t_max());
        let farthest = end.largest();
        let mut met = MetParts {
            of: self,
            wanted,
            up_to_first,
            all,
            end,
            is_enough: true,
        };
        let is_known = match &self.index.places {
            Some(places) => places.search_together(simd, rays, farthest, &mut met),
            None => false,
        };
        let is_enough = met.is_enough;
        let rest = match is_known {
            true => &self.index.others[..],
            false => &self.index.all[..],
        };
        for part in rest {
            self.add(simd, *part, wanted, all);
        }
        is_enough
    }

    /// Adds the spans of some rays inside a part.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, part: usize, lanes: u8, all: &mut SpansOfParts) {
        simd.call(SpansOfPart {
            of: self,
            part,
            lanes,
            all,
        });
    }

    /// Returns the first crossing of some rays, given their spans, and false if one did not count.
    #[inline(always)]
    fn first<S: Simd>(
        &self,
        simd: S,
        spans: &mut SpansOfParts,
        mut lanes: u8,
    ) -> ([Option<Crossing>; BUNDLE], bool) {
        let mut are_first = true;
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let t_max = simd.load(self.bundle.t_max());
        let mut crossings = [None; BUNDLE];
        let mut t = zero;
        while !spans.is_empty() {
            // The next `t` at which a span begins or ends.
            let last = t;
            t = infinity;
            for (_, span) in &*spans {
                for end in &span.t {
                    let end = simd.load(end);
                    t = S::F64::select(last.lt(end) & end.lt(t), end, t);
                }
            }
            lanes &= t.lt(t_max).bits();
            if lanes == 0 {
                break;
            }
            for (_, span) in &mut *spans {
                let (enter, exit) = (simd.load(&span.t[0]), simd.load(&span.t[1]));
                let before = enter.lt(t) & t.le(exit);
                let after = enter.le(t) & t.lt(exit);
                span.holds = [before.bits(), after.bits()];
            }
            let mut at = [0.0; LANES];
            t.store(&mut at);
            let (found, count) = self.crossed(spans, &at, lanes, &mut crossings);
            are_first &= count;
            lanes &= !found;
        }
        (crossings, are_first)
    }

    /// Adds the crossings of some rays at a `t` of each, given whether the spans hold the points before and after it.
    /// Returns their lanes, and false if one did not count.
    #[inline(never)]
    fn crossed(
        &self,
        spans: &[(usize, SpanOfEach)],
        at: &[f64; LANES],
        lanes: u8,
        crossings: &mut [Option<Crossing>; BUNDLE],
    ) -> (u8, bool) {
        let (mut done, mut count) = (0, true);
        let sides = |span: &SpanOfEach, side| {
            let holds = match side {
                Side::Before => span.holds[0],
                Side::After => span.holds[1],
            };
            [holds, !holds]
        };
        let mut see = |own: &[(usize, SpanOfEach)], found| {
            for lane in bits(found) {
                let t = at[lane];
                let ends = own.iter().flat_map(|(part, span)| {
                    let ends = span.t.iter().zip(&span.faces);
                    ends.map(move |(t, faces)| (t[lane], (*part, faces[lane])))
                });
                let mut ends = ends.filter(|(end, _)| *end == t);
                if let Some((_, (part, face))) = ends.next() {
                    if !self.solid.holds(&self.bundle.ray(lane), t) {
                        count = false;
                        continue;
                    }
                    let face = part as u64 * Solid::FACES_OF_PART + u64::from(face);
                    crossings[lane] = Some(Crossing { t, face });
                    done |= 1 << lane;
                }
            }
        };
        self.solid.root().crossed(spans, &sides, lanes, &mut see);
        (done, count)
    }
}

/// Adds the spans of the parts that are met, and knows up to where they matter.
struct MetParts<'a, S: Simd> {
    of: &'a FirstOfEach<'a>,
    wanted: u8,
    up_to_first: bool,
    all: &'a mut SpansOfParts,
    end: S::F64,
    /// False if a ray begins in a part.
    is_enough: bool,
}

impl<S: Simd> Met<S> for MetParts<'_, S> {
    #[inline(always)]
    fn see(&mut self, simd: S, part: usize) -> f64 {
        let before = self.all.len();
        self.of.add(simd, part, self.wanted, self.all);
        if self.up_to_first {
            let zero = simd.splat(0.0);
            for (_, span) in &self.all[before..] {
                let (enter, exit) = (simd.load(&span.t[0]), simd.load(&span.t[1]));
                let begins = (enter.le(zero) & zero.lt(exit)).bits();
                self.is_enough &= begins & self.wanted == 0;
                let is_first = zero.lt(enter) & enter.lt(self.end);
                self.end = S::F64::select(is_first, enter, self.end);
            }
        }
        self.end.largest()
    }
}

/// The kernel that adds the spans of some rays inside a part.
struct SpansOfPart<'a> {
    of: &'a FirstOfEach<'a>,
    part: usize,
    lanes: u8,
    all: &'a mut SpansOfParts,
}

impl Kernel for SpansOfPart<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self {
            of,
            part,
            mut lanes,
            all,
        } = self;
        let FirstOfEach { solid, bundle, .. } = *of;
        let mut first = SpanOfEach::NONE;
        let (shape, around) = solid.part(part);
        if is_tested(shape) && (shape.sphere().is_none() || around.is_some()) {
            let leave_nothing = bits(lanes).filter(|lane| of.leaving[*lane].is_empty());
            let plain = leave_nothing.fold(0, |lanes, lane| lanes | 1 << lane);
            let mut sure = u8::MAX;
            if let Some(found) = simd.call(LinesOf {
                shape,
                around,
                bundle,
            }) {
                let (enter, exit) = (simd.load(&found.t[0]), simd.load(&found.t[1]));
                let meets = found.counts[0] & enter.lt(exit).bits();
                sure &= !found.odd;
                if meets & plain != 0 {
                    let both = found.holds(simd, bundle, enter) & found.holds(simd, bundle, exit);
                    sure &= !meets | both;
                    for end in 0..2 {
                        let (t, nowhere) = (simd.load(&found.t[end]), simd.load(&first.t[end]));
                        let t = S::F64::select(simd.mask(meets), t, nowhere);
                        t.store(&mut first.t[end]);
                        first.faces[end] = found.faces[end].map(|face| face as u8);
                    }
                }
            }
            lanes &= !(sure & plain);
        }
        let mut second = SpanOfEach::NONE;
        let mut seconds = 0;
        for lane in bits(lanes) {
            let (ray, leaving) = (bundle.ray(lane), of.leaving[lane]);
            [first.t[0][lane], first.t[1][lane]] = [f64::INFINITY, f64::NEG_INFINITY];
            let mut number = 0;
            solid.each_span(part, &ray, leaving, |span| {
                number += 1;
                match number {
                    1 => first.set(lane, span),
                    _ => {
                        second.set(lane, span);
                        seconds |= 1 << lane;
                    }
                }
            });
        }
        let (enter, exit) = (simd.load(&first.t[0]), simd.load(&first.t[1]));
        if enter.lt(exit).bits() != 0 {
            all.push((part, first));
        }
        if seconds != 0_u8 {
            all.push((part, second));
        }
    }
}
