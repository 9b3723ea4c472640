//! What a `Fit` camera frames: every bounded geometry of a scene, in all its frames.

use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

use glam::DVec3;

use crate::{
    scene::{
        animation::frames::Frames,
        build,
        format::{
            camera::CameraModel, field::Slot, fit::FitModel, geometry::nesting::Ordinal,
            scene::Model,
        },
        tables::Tables,
    },
    tracer::{
        camera::{
            Camera,
            fit::{Extremes, Turntable},
        },
        error::GeometryError,
        shape::Shape,
        world::World,
    },
};

/// The geometries that are framed.
#[derive(Clone, Copy)]
pub(crate) enum Subject<'a> {
    /// Those of a world, none of which moves.
    World(&'a World),
    /// Those of a scene, with its tables.
    Scene(&'a Model, &'a Tables),
}

/// A scene as its `Fit` cameras see it.
#[derive(Clone, Copy)]
pub(crate) struct Framing<'a> {
    pub(crate) subject: Subject<'a>,
    pub(crate) frames: Option<&'a Frames>,
    pub(crate) known: &'a Known,
}

/// The last results. They are the same for all frames of an animation that does not change the
/// camera.
#[derive(Debug, Default)]
pub(crate) struct Known(Mutex<Vec<Framed>>);

/// A camera, the size of its picture, and the camera that it becomes.
type Framed = (FitModel, (u32, u32), Result<CameraModel, GeometryError>);

/// The field of a table that its rows without a radius take.
const RADIUS: &str = "radius";

/// The number of results that are kept.
const KEPT: usize = 16;

impl Framing<'_> {
    /// Builds a camera at a frame, for a picture of this size.
    ///
    /// # Errors
    ///
    /// A camera that is invalid, or cannot frame the scene.
    pub(crate) fn build(
        &self,
        camera: &CameraModel,
        size: (u32, u32),
        number: u32,
    ) -> Result<Camera, GeometryError> {
        let CameraModel::Fit(fit) = camera else {
            return camera.build();
        };
        let mut explicit = self.explicit(fit, size)?;
        if let Some(frames) = self.frames {
            frames.turn(&mut explicit, number);
        }
        explicit.build()
    }

    /// Returns the camera that a `Fit` becomes, before it orbits.
    ///
    /// # Errors
    ///
    /// As [`Framing::build`].
    pub(crate) fn explicit(
        &self,
        fit: &FitModel,
        size: (u32, u32),
    ) -> Result<CameraModel, GeometryError> {
        // The lock is held meanwhile, so that threads do not compute the same.
        let mut known = self.known.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = known.iter();
        if let Some((.., found)) = all.find(|(other, of, _)| other == fit && *of == size) {
            return found.clone();
        }
        let mut content = Content::new(self);
        let found = fit.explicit(size, |directions| content.search(directions));
        known.truncate(KEPT - 1);
        known.insert(0, (fit.clone(), size, found.clone()));
        found
    }
}

/// All shapes that are framed.
struct Content<'a> {
    subject: Subject<'a>,
    turntable: Option<Turntable>,
    /// The geometries that move, with their frames and a copy of the scene to show them in.
    moving: Option<(&'a Frames, Vec<Ordinal>, Model)>,
    /// The tables, with the largest of the default radii that they ever have.
    tables: Option<Tables>,
    count: usize,
}

impl<'a> Content<'a> {
    fn new(framing: &Framing<'a>) -> Self {
        let Framing {
            subject, frames, ..
        } = *framing;
        let moving = match (frames, subject) {
            (Some(frames), Subject::Scene(model, _)) => {
                let moved = frames.moved_leaves(model);
                (!moved.is_empty()).then(|| (frames, moved, frames.copy(model)))
            }
            _ => None,
        };
        let mut content = Self {
            subject,
            turntable: frames.and_then(Frames::turntable),
            moving,
            tables: None,
            count: frames.map_or(1, |frames| frames.count() as usize),
        };
        content.tables = content.largest_tables();
        content
    }

    /// Returns the tables with the largest of their default radii, if these change.
    fn largest_tables(&mut self) -> Option<Tables> {
        let Subject::Scene(_, tables) = self.subject else {
            return None;
        };
        let (frames, moved, shown) = self.moving.as_mut()?;
        let changing = moved.iter().copied();
        let changing: Vec<_> = changing
            .filter(|at| tables.of(*at).is_some() && frames.move_geometry(*at))
            .collect();
        moved.retain(|at| !changing.contains(at) || frames.carry(shown, *at));
        let radius = |model: &Model, at: Ordinal| model.geometry(at)?.table()?.radius;
        if changing.is_empty() {
            return None;
        }
        let mut largest = vec![f64::NEG_INFINITY; changing.len()];
        for number in 0..frames.count() {
            frames.show(number, shown);
            for (largest, at) in largest.iter_mut().zip(&changing) {
                *largest = largest.max(radius(shown, *at).unwrap_or(*largest));
            }
        }
        for (largest, at) in largest.into_iter().zip(changing) {
            let geometry = shown.geometry_mut(at);
            if let Some(Slot::Number(radius)) = geometry.and_then(|table| table.slot(RADIUS)) {
                *radius = largest;
            }
        }
        let mut tables = tables.clone();
        tables.set_defaults(shown);
        Some(tables)
    }

    fn search(&mut self, directions: &[DVec3]) -> Extremes {
        let mut extremes = Extremes::new(directions);
        let turntable = self.turntable.as_ref();
        let mut add = |shape: &Shape, frames: Range<usize>| match turntable {
            None => extremes.add(shape),
            Some(turntable) => extremes.add_turned(shape, turntable, frames),
        };
        let always = 0..self.count;
        match self.subject {
            Subject::World(world) => {
                for geometry in world.geometries() {
                    add(geometry.shape(), always.clone());
                }
            }
            Subject::Scene(model, tables) => {
                let tables = self.tables.as_ref().unwrap_or(tables);
                let moved = self.moving.as_ref().map_or(&[][..], |(_, moved, _)| moved);
                for leaf in model.leaves() {
                    if moved.binary_search(&leaf.at).is_err() {
                        tables.any_shape(&leaf, |shape| {
                            add(shape, always.clone());
                            false
                        });
                    }
                }
            }
        }
        if let (Some((frames, moved, shown)), Subject::Scene(_, tables)) =
            (&mut self.moving, self.subject)
        {
            let tables = self.tables.as_ref().unwrap_or(tables);
            let mut parts = tables.some_parts(moved);
            for number in 0..frames.count() {
                frames.show(number, shown);
                // A part that a frame cannot place is an error of that frame.
                let _ = parts.place(shown);
                build::renew_copies(shown, &mut parts);
                for leaf in moved.iter().filter_map(|at| shown.leaf(*at)) {
                    let tables = if parts.has(leaf.at) { &parts } else { tables };
                    tables.any_shape(&leaf, |shape| {
                        add(shape, number as usize..number as usize + 1);
                        false
                    });
                }
            }
        }
        extremes
    }
}
