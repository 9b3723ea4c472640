//! The scene at a given time.

use std::ops::RangeInclusive;

use super::{
    curve,
    target::{Aspect, Target},
};
use crate::{
    diagnostic::path::Path,
    scene::{
        copies::Prototypes,
        format::{
            animation::{AnimationModel, Track},
            camera::CameraModel,
            cameras::CamerasModel,
            field::Slot,
            geometry::{GeometryModel, ordinal::Ordinal, walk::Leaf},
            scene::Model,
        },
    },
    tracer::camera::fit::Turntable,
};

/// The frames of a scene, without the scene itself.
#[derive(Clone, Debug)]
pub(crate) struct Frames {
    animation: AnimationModel,
    /// The target of each track.
    targets: Vec<Target>,
    /// The cameras as in the file, if they orbit.
    cameras: Option<(Option<CameraModel>, Option<CamerasModel>)>,
    /// The copies in the scene, and what each is a copy of, with all that is inside of that.
    copies: Vec<(Ordinal, RangeInclusive<Ordinal>)>,
}

impl Frames {
    /// Returns the frames of a scene, if it has an animation, with a valid number of frames, and all
    /// its paths are valid.
    pub(crate) fn of(model: &Model) -> Option<Self> {
        let animation = AnimationModel::clone(model.animation.as_deref()?);
        if !(1..=AnimationModel::MOST_FRAMES).contains(&animation.frames) {
            return None;
        }
        let paths = animation.tracks().iter();
        let targets = paths.map(|(path, _)| Target::of(model, path).ok());
        let targets = targets.collect::<Option<_>>()?;
        let orbits = animation.orbit.is_some();
        Some(Self {
            copies: copies(model),
            animation,
            targets,
            cameras: orbits.then(|| (model.camera.clone(), model.cameras.clone())),
        })
    }

    /// Returns the number of frames per second.
    pub(crate) fn fps(&self) -> f64 {
        self.animation.fps()
    }

    /// Returns the number of frames.
    pub(crate) fn count(&self) -> u32 {
        self.animation.frames
    }

    /// Returns the time of a frame in seconds.
    pub(crate) fn seconds(&self, number: u32) -> f64 {
        f64::from(number) / self.fps()
    }

    /// Returns the target of each track with its path.
    pub(crate) fn targets(&self) -> impl Iterator<Item = (&str, &Target)> {
        let paths = self.animation.tracks().iter().map(|(path, _)| &**path);
        paths.zip(&self.targets)
    }

    /// Returns the tracks with their targets.
    pub(super) fn tracks(&self) -> impl Iterator<Item = (&Target, &Track)> {
        let tracks = self.animation.tracks().iter();
        self.targets.iter().zip(tracks.map(|(_, track)| track))
    }

    /// Returns true if nothing in the scene is a copy.
    pub(super) fn copies_nothing(&self) -> bool {
        self.copies.is_empty()
    }

    /// Returns true if all cameras orbit.
    pub(crate) const fn orbit_cameras(&self) -> bool {
        self.cameras.is_some()
    }

    /// Returns true if the world changes, and not only cameras and the picture.
    pub(crate) fn move_the_world(&self) -> bool {
        self.targets.iter().any(Target::is_of_world)
    }

    /// Returns true if a geometry changes.
    pub(crate) fn move_geometry(&self, at: Ordinal) -> bool {
        let mut targets = self.targets.iter();
        targets.any(|target| target.geometry == Some(at) && target.aspect != Aspect::ColorBy)
    }

    /// Returns true if a geometry changes, one inside of it, or the transform of a group around it.
    pub(crate) fn move_leaf(&self, model: &Model, at: Ordinal) -> bool {
        let mut moved = self.moved_geometries().into_iter();
        self.move_geometry(at)
            || moved.any(|moved| model.holds(moved, at) || model.holds(at, moved))
    }

    /// Returns true if the transform of a group around a geometry changes.
    pub(crate) fn carry(&self, model: &Model, at: Ordinal) -> bool {
        let mut moved = self.moved_geometries().into_iter();
        moved.any(|moved| model.holds(moved, at))
    }

    /// Returns the leaves that move or change their size, in ascending order.
    pub(crate) fn moved_leaves(&self, model: &Model) -> Vec<Ordinal> {
        leaves(model, self.moved_geometries())
    }

    /// Returns the leaves that change in any way, in ascending order.
    pub(crate) fn changed_leaves(&self, model: &Model) -> Vec<Ordinal> {
        let mut changed: Vec<_> = self.targets.iter().filter_map(|it| it.geometry).collect();
        let materials = self
            .targets
            .iter()
            .filter(|it| it.aspect == Aspect::Material);
        let materials = materials.filter_map(|target| target.owner.steps().get(1)?.name());
        let materials: Vec<_> = materials.collect();
        if !materials.is_empty() {
            let has = |geometry: &GeometryModel| {
                let name = geometry
                    .surface()
                    .material
                    .and_then(|material| material.named());
                name.is_some_and(|name| materials.contains(&name))
            };
            let all = model.walk().filter(|(_, geometry)| has(geometry));
            changed.extend(all.map(|(at, _)| at));
        }
        leaves(model, self.with_copies(changed))
    }

    /// Adds the copies of geometries to these, and puts all in ascending order.
    fn with_copies(&self, mut changed: Vec<Ordinal>) -> Vec<Ordinal> {
        changed.sort_unstable();
        changed.dedup();
        let copies = self.copies.iter().filter(|(_, of)| {
            let first = changed.partition_point(|at| at < of.start());
            changed.get(first).is_some_and(|at| of.contains(at))
        });
        let copies: Vec<_> = copies.map(|(at, _)| *at).collect();
        changed.extend(copies);
        changed.sort_unstable();
        changed.dedup();
        changed
    }

    /// Returns the geometries that move or change their size, in ascending order.
    pub(crate) fn moved_geometries(&self) -> Vec<Ordinal> {
        let moved = self.targets.iter().filter_map(Target::moved_geometry);
        self.with_copies(moved.collect())
    }

    /// Returns true if a light changes.
    pub(crate) fn change_light(&self, index: usize) -> bool {
        let light = Path::ROOT.field("lights").index(index);
        self.targets.iter().any(|target| target.owner == light)
    }

    /// Copies the parts of the scene that [`Frames::show`] needs: without geometries if the world
    /// does not change, so that a million of them cost nothing.
    pub(crate) fn copy(&self, model: &Model) -> Model {
        Model {
            schema: None,
            version: None,
            image: model.image.clone(),
            camera: model.camera.clone(),
            cameras: model.cameras.clone(),
            background: model.background.clone(),
            backdrop: model.backdrop.clone(),
            lights: model.lights.clone(),
            materials: model.materials.clone(),
            lighting: model.lighting.clone(),
            outlines: model.outlines.clone(),
            geometries: if self.move_the_world() {
                model.geometries.clone()
            } else {
                Vec::new()
            },
            animation: None,
            allow: None,
        }
    }

    /// Returns the scene at the first frame.
    pub(crate) fn first(&self, model: &Model) -> Model {
        let mut first = self.copy(model);
        self.show(0, &mut first);
        first
    }

    /// Sets a scene to a frame, regardless of its frame before.
    pub(crate) fn show(&self, number: u32, model: &mut Model) {
        self.orbit(number, model);
        let time = self.seconds(number);
        for (target, (_, track)) in self.targets.iter().zip(self.animation.tracks()) {
            target.change(model, &mut |slot| write(track, time, slot));
        }
    }

    /// Calls `see` with the number of each frame, the scene as it is then, and the world in it, until it
    /// returns false. A scene without frames is seen once.
    pub(crate) fn each(
        frames: Option<&Self>,
        model: &Model,
        mut see: impl FnMut(u32, &Model, &Model) -> bool,
    ) {
        let Some(frames) = frames else {
            see(0, model, model);
            return;
        };
        let mut shown = frames.copy(model);
        for number in 0..frames.count() {
            frames.show(number, &mut shown);
            let world = match frames.move_the_world() {
                true => &shown,
                false => model,
            };
            if !see(number, &shown, world) {
                return;
            }
        }
    }

    /// Turns all cameras from their places in the file.
    fn orbit(&self, number: u32, model: &mut Model) {
        let (Some(orbit), Some((camera, cameras))) = (&self.animation.orbit, &self.cameras) else {
            return;
        };
        model.camera.clone_from(camera);
        model.cameras.clone_from(cameras);
        let named = model.cameras.iter_mut().flat_map(|cameras| &mut cameras.0);
        let cameras = model
            .camera
            .iter_mut()
            .chain(named.map(|(_, camera)| camera));
        for camera in cameras {
            orbit.turn(camera, number, self.count());
        }
    }

    /// Turns a camera from its place in the file to its place at a frame, if the cameras orbit.
    pub(crate) fn turn(&self, camera: &mut CameraModel, number: u32) {
        if let Some(orbit) = &self.animation.orbit {
            orbit.turn(camera, number, self.count());
        }
    }

    /// Returns the turns of the cameras at some frames, if they orbit.
    pub(crate) fn turntable(&self, numbers: &[u32]) -> Option<Turntable> {
        let orbit = self.animation.orbit.as_ref()?;
        Some(orbit.turntable(numbers, self.count()))
    }
}

/// Writes the value of a track into its slot.
fn write(track: &Track, time: f64, slot: Slot) {
    // The end of the path determines the kind, so the two match. Without keys the value stays.
    let _ = match (track, slot) {
        (Track::Numbers(keys), Slot::Number(to)) => curve::number(keys, time).map(|it| *to = it),
        (Track::Scales(keys), Slot::Scale(to)) => curve::scale(keys, time).map(|it| *to = it),
        (Track::Points(keys), Slot::Vector(to)) => curve::point(keys, time).map(|it| *to = it),
        (Track::Directions(keys), Slot::Vector(to)) => {
            curve::direction(keys, time).map(|it| *to = it)
        }
        (Track::Intervals(keys), Slot::Interval(to)) => {
            curve::interval(keys, time).map(|it| *to = it)
        }
        (Track::Colors(keys), Slot::Color(to)) => curve::color(keys, time).map(|it| *to = it),
        _ => None,
    };
}

/// Returns the leaves of a scene that are some geometries, are in them, or hold them, in ascending
/// order.
fn leaves(model: &Model, changed: Vec<Ordinal>) -> Vec<Ordinal> {
    let is_leaf = |at: &Ordinal| {
        let geometry = model.geometry(*at);
        at.inner == 0 && geometry.is_some_and(GeometryModel::is_single)
    };
    if changed.iter().all(is_leaf) {
        return changed;
    }
    let mut outermost: Vec<RangeInclusive<Ordinal>> = Vec::new();
    for at in &changed {
        if !outermost.last().is_some_and(|last| last.contains(at)) {
            outermost.extend(model.geometry(*at).map(|geometry| geometry.span(*at)));
        }
    }
    let moves = |leaf: &Leaf| {
        let before = outermost.partition_point(|around| around.start() <= &leaf.at);
        let around = before.checked_sub(1).and_then(|last| outermost.get(last));
        around.is_some_and(|around| around.contains(&leaf.at))
            || leaf.geometry.is_among(leaf.at, &changed)
    };
    let leaves = model.leaves().filter(moves);
    leaves.map(|leaf| leaf.at).collect()
}

/// Returns the copies in a scene, and what each is a copy of, with all that is inside of that.
fn copies(model: &Model) -> Vec<(Ordinal, RangeInclusive<Ordinal>)> {
    let lists: Vec<_> = model.copies().collect();
    if lists.is_empty() {
        return Vec::new();
    }
    let mut prototypes = Prototypes::new(model);
    let copies = lists.into_iter().filter_map(|(at, named)| {
        let of = prototypes.of(named.of, at).ok()?;
        Some((at, model.geometry(of)?.span(of)))
    });
    copies.collect()
}
