//! The frames of a scene that changes over time.

use std::sync::Arc;

use super::{
    Scene,
    cameras::{Cameras, framing},
    refused,
};
use crate::{
    diagnostic::error::{Error, ErrorKind},
    scene::{
        animation::frames::Frames,
        build::{self, Built},
        format::{image::ImageModel, outlines::OutlinesModel, scene::Model},
        framing::Subject,
        tables::Tables,
    },
    tracer::error::GeometryError,
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
}

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
            frames,
        })
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
    pub(super) fn show(
        &self,
        number: u32,
        model: &mut Model,
        tables: &mut Tables,
    ) -> Result<(), GeometryError> {
        self.frames.show(number, model);
        if self.frames.move_the_world() {
            tables.set_defaults(model);
            tables.place(model).map_err(|(_, error)| error)?;
            build::renew_copies(model, tables);
        }
        Ok(())
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
            return Err(Error::new(ErrorKind::Usage, message));
        }
        match &self.moving {
            None => Ok(self.clone()),
            Some(moving) => self.at(moving, number),
        }
    }

    fn at(&self, moving: &Moving, number: u32) -> Result<Self, Error> {
        let mut model = moving.model.clone();
        let mut tables = moving.tables.clone();
        let shown = moving.show(number, &mut model, &mut tables);
        shown.map_err(|error| refused(&self.file, &error))?;
        let tone = model
            .image
            .as_ref()
            .map(ImageModel::tone)
            .unwrap_or_default();
        let outlines = model.outlines.as_ref().map(OutlinesModel::build);
        let framing = framing(&self.world, Some(moving), &self.known, None);
        let mut cameras = Cameras::of(&model, &framing, number, &self.file)?;
        if let Some(index) = self.cameras.index {
            cameras.choose(index);
        }
        let (mut world, mut world_hash) = (Arc::clone(&self.world), Arc::clone(&self.world_hash));
        let mut scales = Arc::clone(&self.scales);
        if moving.frames.move_the_world() {
            let built = build::world(model, tables, None);
            let moved: Built = built.map_err(|error| refused(&self.file, &error))?;
            (world, world_hash) = (Arc::new(moved.world), Arc::default());
            scales = Arc::new(moved.scales);
        }
        Ok(Self {
            cameras,
            world,
            world_hash,
            scales,
            tone,
            outlines,
            frame: number,
            ..self.clone()
        })
    }
}
