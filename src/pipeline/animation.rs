//! The frames of a scene that changes over time.

use std::{
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use super::{
    Scene,
    cameras::{Cameras, framing},
    fingerprint::WorldHash,
    refused,
};
use crate::{
    diagnostic::error::Error,
    scene::{
        animation::frames::Frames,
        build,
        format::{
            geometry::ordinal::Ordinal, image::ImageModel, outlines::OutlinesModel, scene::Model,
        },
        framing::Subject,
        scales::Scales,
        tables::{Content, Tables},
    },
    tracer::{error::GeometryError, world::World},
};

/// The frame count and frame rate of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    fps: f64,
    frames: u32,
}

impl Animation {
    /// Number of frames per second: above 0 and finite.
    pub const fn fps(self) -> f64 {
        self.fps
    }

    /// Number of frames: at least 1. The first frame is number 0.
    pub const fn frames(self) -> u32 {
        self.frames
    }

    /// Returns the time of a frame in seconds from the start: its number divided by
    /// [`Animation::fps`].
    pub fn seconds(self, frame: u32) -> f64 {
        f64::from(frame) / self.fps
    }
}

/// The data that the frames of a scene are built from.
#[derive(Debug)]
pub(super) struct Moving {
    frames: Frames,
    model: Model,
    /// Empty if the world does not change.
    tables: Tables,
    /// The leaves that change.
    changed: Vec<Ordinal>,
    /// The same with the indices of their geometries in the world.
    places: Vec<(Ordinal, Range<usize>)>,
    /// Worlds of frames, maybe still shown.
    stages: Mutex<Vec<Stage>>,
}

/// A world that changes from frame to frame, and what it is built from: a frame costs as much as that
/// which changes.
#[derive(Debug)]
struct Stage {
    model: Model,
    tables: Tables,
    world: Arc<World>,
    scales: Arc<Scales>,
}

/// The number of stages that are kept; with more threads, some build theirs for each frame.
const KEPT: usize = 64;

impl Moving {
    /// Returns the data for a scene without faults, or `None` if nothing in it changes.
    pub(super) fn of(model: &Model, tables: &Tables) -> Option<Self> {
        let frames = Frames::of(model)?;
        Some(Self {
            model: frames.copy(model),
            tables: if frames.move_the_world() {
                tables.clone()
            } else {
                Tables::default()
            },
            changed: frames.changed_leaves(model),
            places: Vec::new(),
            stages: Mutex::default(),
            frames,
        })
    }

    /// Sets a scene to the first frame, whose world is built whole.
    ///
    /// # Errors
    ///
    /// As [`Moving::show`].
    pub(super) fn start(
        &mut self,
        model: &mut Model,
        tables: &mut Tables,
    ) -> Result<(), GeometryError> {
        self.show(0, model, tables)?;
        let mut changed = self.changed.iter().peekable();
        let mut first = 0;
        for leaf in model.leaves() {
            if changed.peek().is_none() {
                break;
            }
            let length = tables.get(leaf.at).map_or(1, Content::length);
            if let Some(at) = changed.next_if_eq(&&leaf.at) {
                self.places.push((*at, first..first + length));
            }
            first += length;
        }
        Ok(())
    }

    /// Returns the indices of the geometries that change.
    pub(super) fn places(&self) -> impl Iterator<Item = Range<usize>> {
        self.places.iter().map(|(_, place)| place.clone())
    }

    /// Returns the frames.
    pub(super) const fn frames(&self) -> &Frames {
        &self.frames
    }

    /// Returns the scene, if any geometry in it moves.
    pub(super) fn subject(&self) -> Option<Subject<'_>> {
        let is_moving = !self.frames.moved_geometries().is_empty();
        is_moving.then_some(Subject::Scene(&self.model, &self.tables))
    }

    /// Sets a scene to its state at a frame.
    ///
    /// # Errors
    ///
    /// Returns an error if a part cannot be placed.
    fn show(
        &self,
        number: u32,
        model: &mut Model,
        tables: &mut Tables,
    ) -> Result<(), GeometryError> {
        self.frames.show(number, model);
        build::renew(model, tables, &self.changed)
    }

    /// Returns a stage that is not shown any more, or one that begins with the world of a scene at any
    /// frame.
    fn stage(&self, scene: &Scene) -> Stage {
        let mut stages = self.stages();
        let mut all = stages.iter();
        match all.position(|stage| Arc::strong_count(&stage.world) == 1) {
            Some(free) => stages.swap_remove(free),
            None => Stage {
                model: self.model.clone(),
                tables: self.tables.clone(),
                world: Arc::clone(&scene.world),
                scales: Arc::clone(&scene.scales),
            },
        }
    }

    fn stages(&self) -> MutexGuard<'_, Vec<Stage>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Scene {
    /// Returns the frame count and frame rate, or `None` if the scene has no animation.
    pub fn animation(&self) -> Option<Animation> {
        let frames = &self.moving.as_ref()?.frames;
        Some(Animation {
            fps: frames.fps(),
            frames: frames.count(),
        })
    }

    /// Returns the scene at a frame, counted from 0. A scene without an animation has only frame 0.
    /// The result depends only on the scene and the number, not on other frames.
    ///
    /// A scene that has just been read is at frame 0. A camera chosen with [`Scene::with_camera`]
    /// stays chosen. If nothing in the world changes, all frames share it.
    ///
    /// # Errors
    ///
    /// A frame number past the last frame.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
    ///     animation: (fps: 10, frames: 21, tracks: {
    ///         "camera.eye": [(0, (0, 0, 5)), (2, (0, 0, 9))],
    ///     }),
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// let frames = scene.animation().map_or(1, |animation| animation.frames());
    /// assert_eq!(frames, 21);
    /// assert_eq!(scene.frame(10)?.camera().eye().z, 7.0);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn frame(&self, number: u32) -> Result<Self, Error> {
        let count = self.animation().map_or(1, Animation::frames);
        if number >= count {
            let message = match &self.moving {
                None => format!("there is no frame {number}, the scene has no animation"),
                Some(_) => format!(
                    "there is no frame {number}, the animation has {count}: 0 to {}",
                    count - 1
                ),
            };
            return Err(Error::refused(message));
        }
        match &self.moving {
            None => Ok(self.clone()),
            Some(moving) => self.at(moving, number),
        }
    }

    fn at(&self, moving: &Moving, number: u32) -> Result<Self, Error> {
        let mut stage = moving.stage(self);
        let shown = stage.show(moving, number);
        let is_reusable = shown.map_err(|error| refused(&self.file, &error))?;
        let model = &stage.model;
        let tone = model.image.as_ref();
        let tone = tone.map(ImageModel::tone).unwrap_or_default();
        let outlines = model.outlines.as_ref().map(OutlinesModel::build);
        let framing = framing(&self.world, Some(moving), &self.known, None);
        let mut cameras = Cameras::of(model, &framing, number, &self.file)?;
        if let Some(index) = self.cameras.index {
            cameras.choose(index);
        }
        let (world, scales) = (Arc::clone(&stage.world), Arc::clone(&stage.scales));
        let kept = || self.kept.clone();
        let (world_hash, kept) = match is_reusable {
            true => (self.world_hash.replaced(moving.places()).into(), kept()),
            false if moving.frames.move_the_world() => (WorldHash::new(&world).into(), None),
            false => (Arc::clone(&self.world_hash), kept()),
        };
        let mut stages = moving.stages();
        if is_reusable && stages.len() < KEPT {
            stages.push(stage);
        }
        Ok(Self {
            cameras,
            world_hash,
            kept,
            world,
            scales,
            tone,
            outlines,
            frame: number,
            ..self.clone()
        })
    }
}

impl Stage {
    /// Shows a frame, whatever was shown before. Returns true if it can show others.
    fn show(&mut self, moving: &Moving, number: u32) -> Result<bool, GeometryError> {
        let Self {
            model,
            tables,
            world,
            scales,
        } = self;
        moving.show(number, model, tables)?;
        if !moving.frames.move_the_world() {
            return Ok(false);
        }
        let changed = Arc::make_mut(world);
        let is_replaced = build::replace(&moving.places, (model, tables), changed, scales)?;
        if !is_replaced {
            let built = build::world(model.clone(), tables.clone(), None)?;
            *world = built.world.into();
            *scales = built.scales.into();
        }
        Ok(is_replaced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::syntax::Syntax;

    /// One of each kind of change, beside geometries that stay.
    const TEXT: &str = r##"(
        image: (width: 32, height: 24),
        camera: Perspective(eye: (0, 0, 15), look_at: (0, 0, 0), fov: 60),
        background: "#000",
        lights: [Point(position: (0, 9, 0))],
        materials: {"red": Matte(color: "#f00"), "grey": Mirror(color: "#888")},
        geometries: [
            Sphere(center: (0, 0, 0), radius: 1, material: Named("grey")),
            Sphere(center: (0, 0, 0), radius: 1, color: "#0f0", name: "ball"),
            Group(transform: (translate: (0, 0, 0)), name: "pair", geometries: [
                Sphere(center: (1, 0, 0), radius: 1, color: "#00f"),
                Group(geometries: [Sphere(center: (2, 0, 0), radius: 1, material: Named("red"))]),
                Box(min: (0, 0, 0), max: (1, 1, 1), color: "#ff0", name: "cube"),
            ]),
            Instances(of: "cube", transforms: [(translate: (0, 3, 0)), (translate: (0, 4, 0))]),
            Instances(of: "ball", transforms: [(translate: (0, 6, 0), scale: 1)], name: "balls"),
            Union(of: [
                Sphere(center: (0, 0, 0), radius: 1, color: "#f0f"),
                Sphere(center: (0, 1, 0), radius: 1, color: "#f0f"),
            ]),
            Sphere(center: (0, 0, 9), radius: 1, color: "#0ff", texture: Checker(), name: "last"),
        ],
        animation: (fps: 1, frames: 5, tracks: {TRACKS}),
    )"##;

    const TRACKS: &[&str] = &[
        r##""background": [(0, "#000"), (4, "#fff")]"##,
        r#""lights[0].intensity": [(0, 1), (4, 2)]"#,
        r##""materials.red.color": [(0, "#f00"), (4, "#00f")]"##,
        r#""geometries.ball.radius": [(0, 1), (4, 2)]"#,
        r##""geometries.cube.color": [(0, "#000"), (4, "#fff")]"##,
        r#""geometries.cube.max": [(0, (1, 1, 1)), (4, (2, 2, 2))]"#,
        r#""geometries.pair.transform.translate": [(0, (0, 0, 0)), (4, (2, 2, 2))]"#,
        r#""geometries.balls.transforms[0].scale": [(0, 1), (4, 2)]"#,
        r#""geometries[5].of[1].radius": [(0, 1), (4, 2)]"#,
        r#""geometries.last.center": [(0, (0, 0, 9)), (4, (0, 9, 9))]"#,
        r#""geometries.last.texture.size": [(0, 1), (4, 2)]"#,
    ];

    #[test]
    fn a_frame_is_the_same_as_one_that_is_built_whole() {
        let sets = TRACKS.iter().map(|track| (*track).to_owned());
        let flat = sets.clone().filter(|track| !track.contains("lights"));
        let all = sets.chain([TRACKS.join(", ")]);
        let lights = "lights: [Point(position: (0, 9, 0))],";
        for (tracks, lights) in all
            .map(|all| (all, lights))
            .chain(flat.map(|one| (one, "")))
        {
            let text = TEXT.replace("TRACKS", &tracks);
            let text = text.replace("lights: [Point(position: (0, 9, 0))],", lights);
            let scene = Scene::from_text(text, Syntax::Ron).unwrap();
            let moving = scene.moving.as_deref().unwrap();
            assert!(
                moving.changed.len() < 7 || tracks.contains(", \""),
                "{tracks}"
            );
            let mut shown: Option<Scene> = None;
            for number in [3, 1, 4, 4, 0, 2] {
                let frame = scene.frame(number).unwrap();
                let (mut model, mut tables) = (moving.model.clone(), moving.tables.clone());
                moving.frames.show(number, &mut model);
                let all: Vec<_> = model.leaves().map(|leaf| leaf.at).collect();
                build::renew(&model, &mut tables, &all).unwrap();
                let whole = build::world(model, tables, None).unwrap().world;
                assert!(*frame.world == whole, "frame {number} of {tracks}");
                let (hash, expected) = (&frame.world_hash, WorldHash::new(&whole));
                assert_eq!(hash.of(&frame.world), expected.of(&whole), "{tracks}");
                let alone = Scene {
                    kept: None,
                    ..frame.clone()
                };
                let pictures = [frame.render(), alone.render()].map(Result::unwrap);
                let [picture, alone] = pictures.each_ref().map(|picture| picture.pixels());
                assert!(picture == alone, "frame {number} of {tracks} with {lights}");
                let last = shown.replace(frame);
                assert!(last.is_none_or(|last| *last.world != whole || number == 4));
            }
            assert_eq!(moving.stages().len(), 2, "{tracks}");
        }
    }
}
