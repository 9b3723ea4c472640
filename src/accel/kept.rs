//! What the frames of a scene share: all that is built over the geometries that stand still.
//!
//! A frame builds the same over its moved geometries alone, and every search sees both: the entries of a
//! tile come from two bins, a point has two lists of shadows, a ray meets two trees. Each search finds the
//! smallest `t` and at equal `t` the lower index, whichever of the two the geometry is in.

use std::{
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

#[cfg(test)]
use crate::tracer::random::Rng;
use crate::{
    accel::{
        bvh::portion::Portion,
        raster::{bins::Bins, view::ViewKey},
        shadow::{
            casters::{Casters, Toward},
            occluders::Occluders,
        },
    },
    film::colors::ColorTable,
    parallel::Cancel,
    tracer::{material::lobes::LightOfMaterials, world::World},
};

/// Below this number of geometries, all is built as soon. Tests use less.
const FEW: usize = if cfg!(test) { 2 } else { 1 << 10 };
/// The number of geometries for each that moves from which two searches are faster than another
/// building. Tests use less.
const SHARE: usize = if cfg!(test) { 2 } else { 64 };

/// The structures over the geometries that stand still in an animation.
#[derive(Debug)]
pub(crate) struct Kept {
    /// The indices of the geometries that stand still.
    still: Vec<Range<usize>>,
    /// All others.
    moved: Vec<Range<usize>>,
    /// By the fineness of the view.
    pub(super) bins: Slots<u32, ViewKey, Bins>,
    /// By the number of the light.
    pub(super) occluders: Slots<(usize, Casters), Toward, Occluders>,
    pub(super) portion: Slots<(), (), Portion>,
    /// What the materials do with light, by whether the world is lit.
    pub(crate) light: Slots<(), bool, LightOfMaterials>,
    /// The colors of all geometries in some frame.
    pub(crate) colors: Slots<(), (), ColorTable<3>>,
}

impl Kept {
    /// Prepares the frames of a world of which only the geometries in these places change, in ascending
    /// order; `None` if that does not pay.
    pub(crate) fn new(world: &World, places: impl Iterator<Item = Range<usize>>) -> Option<Self> {
        let count = world.geometries().len();
        let (mut still, mut moved) = (Vec::new(), Vec::new());
        let (mut next, mut moving) = (0, 0);
        for place in places.filter(|place| !place.is_empty()) {
            still.push(next..place.start);
            (next, moving) = (place.end, moving + place.len());
            moved.push(place);
        }
        still.push(next..count);
        still.retain(|run| !run.is_empty());
        (count >= FEW && moving * SHARE <= count).then(|| Self {
            still,
            moved,
            bins: Slots::default(),
            occluders: Slots::default(),
            portion: Slots::default(),
            light: Slots::default(),
            colors: Slots::default(),
        })
    }

    /// Returns the indices of the geometries that change.
    pub(crate) fn moved(&self) -> &[Range<usize>] {
        &self.moved
    }
}

/// A world, and what its frames share; `None` for a world alone.
pub(crate) type WorldOfFrame<'a> = (&'a World, Option<&'a Kept>);

/// Returns what is built over all geometries of a world: one value or, for a frame, that over those which
/// stand still, as long as the key is the same, and that over all others. `build` may look at the
/// former for the latter.
pub(crate) fn built<S: PartialEq, K: PartialEq, V>(
    (world, kept): WorldOfFrame,
    slots: impl Fn(&Kept) -> &Slots<S, K, V>,
    key: (S, K),
    cancel: Option<&Cancel>,
    build: impl Fn(&[Range<usize>], Option<&V>) -> Option<V>,
) -> Option<Vec<Arc<V>>> {
    let Some(kept) = kept else {
        let all = 0..world.geometries().len();
        return Some(vec![build(&[all], None)?.into()]);
    };
    let still = slots(kept).get(key, cancel, || build(&kept.still, None))?;
    let moved = build(&kept.moved, Some(&still))?;
    Some(vec![still, moved.into()])
}

/// Values that are built once for a key; a slot keeps the last one.
#[derive(Debug)]
pub(crate) struct Slots<S, K, V>(Mutex<Vec<(S, K, Arc<V>)>>);

impl<S, K, V> Default for Slots<S, K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<S: PartialEq, K: PartialEq, V> Slots<S, K, V> {
    /// Returns the value of a key, which is built unless its slot has it.
    pub(crate) fn get(
        &self,
        (slot, key): (S, K),
        cancel: Option<&Cancel>,
        build: impl FnOnce() -> Option<V>,
    ) -> Option<Arc<V>> {
        {
            let mut slots = self.lock();
            // The memory of the last one is free before the next one is built.
            slots.retain(|(in_slot, of, _)| *in_slot != slot || *of == key);
            if let Some((.., value)) = slots.iter().find(|(in_slot, ..)| *in_slot == slot) {
                return Some(Arc::clone(value));
            }
        }
        // No thread waits for the building of another one, which would be a deadlock if it ran a part of
        // this work.
        let value = Arc::new(build()?);
        if !cancel.is_some_and(Cancel::is_cancelled) {
            let mut slots = self.lock();
            slots.retain(|(in_slot, ..)| *in_slot != slot);
            slots.push((slot, key, Arc::clone(&value)));
        }
        Some(value)
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(S, K, Arc<V>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
impl Kept {
    /// Returns what the frames of a world share in which some geometries change, and another frame.
    pub(crate) fn of_some(world: &World, random: &mut Rng) -> Option<(Self, World)> {
        let mut geometries = world.geometries().to_vec();
        let most = random.one(&[3, 3, 9, 1000]);
        let places = (0..geometries.len()).filter(|_| random.below(most) == 0);
        let places: Vec<_> = places.collect();
        for place in &places {
            geometries[*place] = world.geometries()[random.below(geometries.len())].clone();
        }
        let mut other = World::new(geometries, world.background());
        other.surround(world.clone());
        let places = places.into_iter().map(|place| place..place + 1);
        Some((Self::new(world, places)?, other.without_indices()))
    }
}
