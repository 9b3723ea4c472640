//! What moves in a scene, for the search of its extremes: shapes that move as one are searched as
//! one.

use std::sync::Arc;

use crate::{
    scene::{
        animation::frames::Frames,
        build,
        format::{
            geometry::{ordinal::Ordinal, placement::Placement, walk::Leaf},
            scene::Model,
            transform::TransformModel,
        },
        tables::Tables,
    },
    tracer::{
        camera::{
            fit::{Extremes, Turntable},
            rigid::{Rigid, RigidPlace},
        },
        shape::Shape,
        transform::Transform,
    },
};

/// The leaves of a scene that move, in the order of the file.
#[derive(Default)]
pub(crate) struct Movers {
    all: Vec<Mover>,
    /// The leaves whose tables, parts and copies change: those alone, and all if some of them are
    /// copies, maybe of others.
    renewed: Vec<Ordinal>,
}

enum Mover {
    /// A leaf that changes its size, or copies that change.
    Alone(Ordinal),
    /// The first of leaves that move as one, and the shapes of all.
    Together(Ordinal, Rigid),
}

/// Leaves that move as one: the first, its placement unless it is a part, and the shapes of all.
type Gathered = (Ordinal, Option<Placement>, Vec<Shape>);

impl Movers {
    /// Gathers the leaves that move. `shown` is the scene at any frame.
    pub(crate) fn new(
        frames: &Frames,
        moved: &[Ordinal],
        (shown, tables): (&Model, &Tables),
        is_cancelled: &impl Fn() -> bool,
    ) -> Self {
        let changed = frames.moved_geometries();
        let mut movers = Vec::new();
        let mut last: Option<Gathered> = None;
        let finish = |gathered: Option<Gathered>, movers: &mut Vec<_>| {
            movers.extend(gathered.map(|(first, _, shapes)| {
                Mover::Together(first, Rigid::new(shapes, is_cancelled))
            }));
        };
        let leaves = shown.leaves();
        for leaf in leaves.filter(|leaf| moved.binary_search(&leaf.at).is_ok()) {
            if is_cancelled() {
                break;
            }
            if !is_rigid(&leaf, &changed, tables) {
                finish(last.take(), &mut movers);
                movers.push(Mover::Alone(leaf.at));
                continue;
            }
            let placement = tables.part(leaf.at).is_none().then_some(&leaf.placement);
            let goes_on = last.as_ref().is_some_and(|(_, last, _)| {
                let (last, this) = (last.as_ref(), placement);
                last.zip(this)
                    .is_some_and(|(last, this)| last.is_of_group(this))
            });
            if !goes_on {
                finish(last.take(), &mut movers);
            }
            let (.., shapes) =
                last.get_or_insert_with(|| (leaf.at, placement.cloned(), Vec::new()));
            tables.any_own_shape(&leaf, |shape| {
                shapes.push(shape);
                is_cancelled()
            });
        }
        finish(last, &mut movers);
        let alone = movers.iter().filter_map(|mover| match mover {
            Mover::Alone(at) => Some(*at),
            Mover::Together(..) => None,
        });
        let alone: Vec<_> = alone.collect();
        let has_copies = alone.iter().any(|at| tables.copies(*at).is_some());
        Self {
            renewed: if has_copies { moved.into() } else { alone },
            all: movers,
        }
    }

    /// Adds all that moves as it is in a frame that is shown, with its tables; for a camera that orbits,
    /// the place of the frame among its turns.
    pub(crate) fn add(
        &self,
        extremes: &mut Extremes,
        shown: &Model,
        tables: &mut Tables,
        turned: Option<(&Turntable, usize)>,
    ) {
        // A part that a frame cannot place is an error of that frame.
        let _ = build::renew(shown, tables, &self.renewed);
        for mover in &self.all {
            match mover {
                Mover::Alone(at) => {
                    let Some(leaf) = shown.leaf(*at) else {
                        continue;
                    };
                    tables.any_shape(&leaf, |shape| {
                        match turned {
                            None => extremes.add(shape),
                            Some((turns, place)) => {
                                extremes.add_turned(shape, turns, place..place + 1);
                            }
                        }
                        false
                    });
                }
                Mover::Together(first, rigid) => {
                    let is_part = tables.part(*first).is_some();
                    if let Some(mut place) = levels(shown, *first, is_part)
                        .as_deref()
                        .and_then(RigidPlace::new)
                    {
                        extremes.add_rigid(rigid, &mut place, turned);
                    }
                }
            }
        }
    }
}

/// Returns true if only transforms change a leaf: the size of a table is the largest that it ever has.
fn is_rigid(leaf: &Leaf, changed: &[Ordinal], tables: &Tables) -> bool {
    if tables.of(leaf.at).is_some() || tables.part(leaf.at).is_some() {
        return true;
    }
    if tables
        .copies(leaf.at)
        .is_some_and(|copies| !copies.are_few())
    {
        return false;
    }
    !leaf.geometry.is_among(leaf.at, changed)
}

/// Returns the transforms that place a leaf, from outermost to innermost, if they are valid: those of a
/// part one by one, for others their product.
fn levels(shown: &Model, at: Ordinal, is_part: bool) -> Option<Vec<Arc<Transform>>> {
    if is_part {
        let all = shown.transforms(at).into_iter().map(TransformModel::build);
        return all.map(|transform| transform.ok().map(Arc::new)).collect();
    }
    let leaf = shown.leaf(at)?;
    let product = leaf.placement.transform().ok()?;
    Some(product.into_iter().cloned().collect())
}
