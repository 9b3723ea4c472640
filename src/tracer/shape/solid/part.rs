//! The parts of a solid: simple solids.

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{
        Shape,
        around::Around,
        face::{Crossing, Leaving},
        of_solid,
        span::{Convex, Span, Spans},
        working::{Term, Working},
    },
};

#[derive(Clone, Debug, PartialEq)]
pub(super) struct SolidPart {
    pub(super) shape: Shape,
    /// True if it is cut away, so that its normals point the other way.
    pub(super) is_cut: bool,
    /// The box and the ball around it, if it is bounded.
    pub(super) around: Option<Around>,
}

impl SolidPart {
    /// Creates the part; `None` if the shape is not a simple solid.
    pub(super) fn new(shape: Shape) -> Option<Self> {
        if !of_solid!(shape.unplaced(), _solid => true, else false) {
            return None;
        }
        Some(Self {
            around: Around::shape(&shape),
            shape,
            is_cut: false,
        })
    }

    /// Returns the first part of a ray's line inside that has a length, and calls `more` with a second one.
    /// A ray that leaves a face begins on it.
    #[inline]
    pub(super) fn span(&self, ray: &Ray, leaving: Leaving, more: impl FnMut(Span)) -> Option<Span> {
        // Convex parts apart, so that their spans are not copied.
        let span = match &self.shape {
            Shape::Torus(_) | Shape::Placed(_) => match self.other_spans(ray, leaving) {
                Spans::Convex(span) => span,
                Spans::Several(spans) => {
                    let [first, second] = spans.map(|span| span.filter(|it| self.holds(ray, it)));
                    second.map(more);
                    return first;
                }
            },
            shape => {
                of_solid!(shape, solid => Spans::from(solid.span(ray, leaving)).convex(), else None)
            }
        };
        let mut span = span?;
        if !leaving.is_empty() {
            span = span.around_origin();
        }
        self.holds(ray, &span).then_some(span)
    }

    /// Returns true if a span has a length and both of its ends are near the part.
    #[inline]
    fn holds(&self, ray: &Ray, span: &Span) -> bool {
        let around = self.around.as_ref();
        let is_near = |at: Crossing| around.is_none_or(|around| around.holds(ray, at.t));
        span.enter.t < span.exit.t && is_near(span.enter) && is_near(span.exit)
    }

    /// Returns the spans inside a part that is not convex or that is placed.
    #[inline(never)]
    fn other_spans(&self, ray: &Ray, leaving: Leaving) -> Spans {
        let (shape, transform) = (self.shape.unplaced(), self.shape.transform());
        let before = transform.map(|transform| transform.ray_back(ray));
        let ray = before.as_ref().unwrap_or(ray);
        of_solid!(shape, solid => solid.span(ray, leaving).into(), else None.into())
    }

    /// Returns its parameters and the terms of its equation, which begin with its number, and its spans.
    pub(super) fn working<'a>(
        &self,
        number: usize,
        ray: &Ray,
        spans: impl Iterator<Item = &'a Span>,
    ) -> Vec<Vec<Term>> {
        let name = |name: &str| format!("part_{number}_{name}");
        let called = format!("{} {number}", self.shape.kind());
        let Working {
            parts, mut lines, ..
        } = self.shape.working(ray);
        lines.insert(0, parts);
        for term in lines.iter_mut().flatten() {
            term.name = name(&term.name).into();
        }
        for line in &mut lines {
            if let Some(first) = line.first_mut() {
                first.symbol = format!("{called}: {}", first.symbol).into();
            }
        }
        for ([enter, exit], span) in [["enter", "exit"], ["enter_2", "exit_2"]].iter().zip(spans) {
            lines.push(vec![
                Term::number(name(enter), format!("into {called} at t"), span.enter.t),
                Term::number(name(exit), format!("out of {called} at t"), span.exit.t),
            ]);
        }
        lines
    }

    /// Returns the depth of a point below the surface: above 0 inside, 0 on it and below 0 outside.
    pub(super) fn depth(&self, point: DVec3) -> f64 {
        let transform = self.shape.transform();
        let point = transform.map_or(point, |transform| transform.point_back(point));
        let shape = self.shape.unplaced();
        of_solid!(shape, solid => solid.depth(point), else f64::NEG_INFINITY)
    }
}
