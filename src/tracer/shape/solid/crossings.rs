//! Where a ray's line crosses a solid.

use smallvec::SmallVec;

use crate::tracer::{
    ray::Ray,
    shape::{
        face::{Crossing, Leaving, in_front},
        solid::Solid,
        span::{Side, Span},
    },
};

/// The crossings of a ray's line with a solid.
#[derive(Clone, Copy)]
pub(crate) struct Crossings<'a> {
    pub(super) solid: &'a Solid,
    pub(super) ray: &'a Ray,
    pub(super) leaving: Leaving<'a>,
}

/// The spans of a ray inside parts, in their order.
pub(super) type PartSpans = SmallVec<[(usize, Span); 6]>;

impl<'a> Crossings<'a> {
    /// Returns true if the ray is inside just before or just after its origin.
    pub(crate) fn is_inside(&self, side: Side) -> bool {
        let sides = |span: &Span| sides_of(span, 0.0, side);
        let [inside, _] = self.solid.root.sides(&self.spans(0.0), &sides);
        inside & 1 == 1
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline]
    pub(crate) fn first(self, t_max: f64) -> Option<Crossing> {
        match self.solid.is_convex {
            true => self.of_convex_in_front(t_max).next(),
            false => self.of_any_in_front(t_max).next(),
        }
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far.
    pub(crate) fn in_front(self, t_max: f64) -> impl Iterator<Item = Crossing> + use<'a> {
        let is_convex = self.solid.is_convex;
        let of_convex = is_convex.then(|| self.of_convex_in_front(t_max));
        let others = (!is_convex).then(|| self.of_any_in_front(t_max));
        of_convex
            .into_iter()
            .flatten()
            .chain(others.into_iter().flatten())
    }

    /// Returns those of an intersection of convex parts.
    fn of_convex_in_front(self, t_max: f64) -> impl Iterator<Item = Crossing> + use<'a> {
        let span = self.inside_all().into_iter();
        let ends = span.flat_map(|span| [span.enter, span.exit]);
        ends.filter(move |at| in_front(at.t, t_max).is_some() && self.solid.holds(self.ray, at.t))
    }

    /// Returns the span inside all parts, which are convex. Where several begin or end at one `t`, the face of the first
    /// counts.
    fn inside_all(&self) -> Option<Span> {
        let mut inside = Span::WHOLE;
        for part in 0..self.solid.parts.len() {
            let mut own = None;
            self.solid
                .each_span(part, self.ray, self.leaving, |span| own = Some(span));
            inside = inside.and(own?.with_faces_from(part as u64 * Solid::FACES_OF_PART))?;
        }
        (inside.enter.t < inside.exit.t).then_some(inside)
    }

    /// Returns the crossings of any solid with `0 < t < t_max`, from near to far.
    pub(super) fn of_any_in_front(self, t_max: f64) -> impl Iterator<Item = Crossing> + use<'a> {
        let spans = self.spans(t_max);
        // Of an intersection of many parts, nearly all ends lie outside of the others.
        let [low, high] = self.solid.root.range(&spans);
        let ends = ends_after(0.0, &spans).into_iter();
        let ends = ends.filter(move |t| (low..=high).contains(t));
        let ends = ends.take_while(move |t| in_front(*t, t_max).is_some());
        ends.filter_map(move |t| self.at(t, &spans))
    }

    /// Returns the crossing at a `t` where the ray gets inside or outside of a part.
    pub(super) fn at(&self, t: f64, spans: &[(usize, Span)]) -> Option<Crossing> {
        let sides = |span: &Span, side| sides_of(span, t, side);
        let mut face = None;
        self.solid.root.crossed(spans, &sides, 1, &mut |own, _| {
            let ends = own.iter().flat_map(|(part, span)| {
                let ends = [span.enter, span.exit].into_iter();
                ends.map(|end| (end.t, *part as u64 * Solid::FACES_OF_PART + end.face))
            });
            face = ends
                .filter(|(end, _)| *end == t)
                .map(|(_, face)| face)
                .next();
        });
        let face = face?;
        let holds = self.solid.holds(self.ray, t);
        holds.then_some(Crossing { t, face })
    }

    /// Returns the spans inside the parts that the ray may meet at a `t` with `0 ≤ t ≤ t_max`.
    fn spans(&self, t_max: f64) -> PartSpans {
        let Some(index) = self.solid.index.get() else {
            return self.of_parts(0..self.solid.parts.len());
        };
        let mut met = SmallVec::<[usize; 16]>::new();
        index.each(self.ray, t_max, &mut |part| met.push(part));
        met.sort_unstable();
        self.of_parts(met)
    }

    /// Returns the spans inside some parts, in their order.
    pub(super) fn of_parts(&self, parts: impl IntoIterator<Item = usize>) -> PartSpans {
        let mut spans = PartSpans::new();
        for part in parts {
            let see = |span| spans.push((part, span));
            self.solid.each_span(part, self.ray, self.leaving, see);
        }
        spans
    }
}

/// Returns whether a line is inside of a span or outside just before or just after a `t`, in lane 0.
fn sides_of(span: &Span, t: f64, side: Side) -> [u8; 2] {
    let holds = span.holds(t, side);
    [u8::from(holds), u8::from(!holds)]
}

/// Returns the finite `t` above one at which spans begin or end, in ascending order.
pub(super) fn ends_after(t: f64, spans: &[(usize, Span)]) -> SmallVec<[f64; 12]> {
    let spans = spans.iter().map(|(_, span)| span);
    let ends = spans.flat_map(|span| [span.enter.t, span.exit.t]);
    let mut ends: SmallVec<_> = ends
        .filter(|end| *end > t && *end < f64::INFINITY)
        .collect();
    ends.sort_unstable_by(f64::total_cmp);
    ends.dedup();
    ends
}
