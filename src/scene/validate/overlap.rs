//! Solids of glass that overlap.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::{
            geometry::{ordinal::Ordinal, walk::Leaf},
            material::Surface,
            scene::Model,
        },
        framing::Framing,
        problem::{Focus, Problem},
        validate::{eye::is_of_glass, found::Found},
    },
    tracer::shape::{Membership, Shape},
};

/// The number of solids that are compared with each other.
const MOST: usize = 1000;

/// The number of pairs in which points are searched.
const MOST_PAIRS: usize = 1000;

/// The number of points along each side of a box in which points are searched.
const POINTS: usize = 9;

/// The part of the size of two solids by which a point must be inside or outside of them: what touches does
/// not overlap, whatever rounding makes of it.
const SLACK: f64 = 1e-6;

/// A solid of glass.
pub(super) struct GlassSolid {
    at: Ordinal,
    shape: Shape,
    bounds: [DVec3; 2],
}

impl GlassSolid {
    pub(super) fn of(leaf: &Leaf, model: &Model) -> Option<Self> {
        // Without a list: most geometries are not of glass.
        let (is_glass, mut is_all) = (is_of_glass(model), true);
        leaf.geometry
            .each_surface(Surface::default(), &mut |surface| {
                is_all &= is_glass(&surface)
            });
        if !is_all {
            return None;
        }
        let shape = leaf.shape()?;
        Some(Self {
            at: leaf.at,
            bounds: shape.bounds()?,
            shape,
        })
    }

    /// Returns true if a point and those at a distance around it lie inside, or all outside.
    fn is_all(&self, is_inside: bool, point: DVec3, distance: f64) -> bool {
        let axes = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        axes.iter().all(|axis| {
            [point + distance * axis, point - distance * axis]
                .iter()
                .all(|point| {
                    matches!(self.shape.membership(*point), Membership::Inside(..)) == is_inside
                })
        })
    }

    /// Returns true if some points surely lie in both, and others in each of the two alone.
    fn overlaps(&self, other: &Self) -> bool {
        let ([low, high], [least, most]) = (self.bounds, other.bounds);
        let common = [low.max(least), high.min(most)];
        let size = (high.max(most) - low.min(least)).max_element();
        let slack = SLACK * size;
        if (common[1] - common[0]).min_element() <= slack {
            return false;
        }
        let has = |bounds, [in_one, in_other]: [bool; 2]| {
            grid(bounds).any(|point| {
                self.is_all(in_one, point, slack) && other.is_all(in_other, point, slack)
            })
        };
        has(common, [true, true])
            && has(self.bounds, [true, false])
            && has(other.bounds, [false, true])
    }
}

/// Returns points in a box, in rows.
fn grid([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    let at = |step: usize| (step as f64 + 0.5) / POINTS as f64;
    (0..POINTS.pow(3)).map(move |number| {
        let steps = [number, number / POINTS, number / POINTS.pow(2)];
        low + DVec3::from(steps.map(|step| at(step % POINTS))) * (high - low)
    })
}

impl Found {
    /// Warns of solids of glass that overlap. Rows of tables, parts, copies and what moves are not looked
    /// at.
    pub(super) fn overlapping_glass(
        &mut self,
        glass: Vec<GlassSolid>,
        model: &Model,
        framing: &Framing,
    ) {
        let still = glass
            .into_iter()
            .filter(|solid| !framing.moves(model, solid.at));
        let solids: Vec<_> = still.take(MOST).collect();
        let mut pairs = 0;
        for (number, solid) in solids.iter().enumerate() {
            let meets = |other: &&GlassSolid| {
                let ([low, high], [least, most]) = (solid.bounds, other.bounds);
                low.cmplt(most).all() && least.cmplt(high).all()
            };
            let first = solids[..number].iter().filter(meets).find(|other| {
                pairs += 1;
                pairs <= MOST_PAIRS && !framing.is_cancelled() && other.overlaps(solid)
            });
            let Some(first) = first else {
                continue;
            };
            let place = model.path_of(first.at);
            let message = format!("this glass overlaps that of `{place}`");
            let own = model.path_of(solid.at);
            let problem = Problem::new(Code::OverlappingGlass, own, Focus::Name, message);
            self.push(
                problem
                    .help(
                        "make them one with `Union`, cut one out of the other with `Difference`, or \
                         move them apart until they touch",
                    )
                    .label(place, Focus::Name, "the other glass"),
            );
        }
    }
}
