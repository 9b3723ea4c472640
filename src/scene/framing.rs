//! What a `Fit` camera frames: every bounded geometry of a scene, in all its frames. Of the frames,
//! those are looked at that matter.

use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

use glam::DVec3;

use crate::{
    parallel::Cancel,
    scene::{
        animation::frames::Frames,
        format::{
            camera::CameraModel, field::Slot, fit::FitModel, geometry::ordinal::Ordinal,
            scene::Model, thing::Thing,
        },
        movers::Movers,
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
    /// Ends the search. Its result is of no use then.
    pub(crate) cancel: Option<&'a Cancel>,
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
        self.known.explicit(std::slice::from_ref(self), fit, size)
    }

    /// Returns true if a leaf of a scene changes in any frame.
    pub(crate) fn moves(&self, model: &Model, at: Ordinal) -> bool {
        self.frames
            .is_some_and(|frames| frames.move_leaf(model, at))
    }

    /// Returns true if the search should end.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(Cancel::is_cancelled)
    }
}

impl Known {
    /// Returns the camera that a `Fit` becomes to see all of some scenes, always the same ones.
    ///
    /// # Errors
    ///
    /// As [`Framing::build`].
    pub(crate) fn explicit(
        &self,
        scenes: &[Framing],
        fit: &FitModel,
        size: (u32, u32),
    ) -> Result<CameraModel, GeometryError> {
        // The lock is held meanwhile, so that threads do not compute the same.
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = known.iter();
        if let Some((.., found)) = all.find(|(other, of, _)| other == fit && *of == size) {
            return found.clone();
        }
        let mut contents: Vec<_> = scenes.iter().map(Content::new).collect();
        let found = fit.explicit(size, |directions| {
            let mut extremes = Extremes::new(directions);
            for content in &mut contents {
                extremes.add_all(&content.search(directions));
            }
            extremes
        });
        if scenes.iter().any(Framing::is_cancelled) {
            return Err(GeometryError::CannotFit);
        }
        known.truncate(KEPT - 1);
        known.insert(0, (fit.clone(), size, found.clone()));
        found
    }
}

/// All shapes that are framed.
struct Content<'a> {
    framing: Framing<'a>,
    turntable: Option<Turntable>,
    /// The geometries that move, with their frames and a copy of the scene to show them in.
    moving: Option<(&'a Frames, Vec<Ordinal>, Model)>,
    /// The tables, with the largest of the default radii that they ever have.
    tables: Option<Tables>,
    /// What moves, as it is searched.
    movers: Movers,
    /// The frames that are looked at.
    numbers: Vec<u32>,
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
        let count = moving.as_ref().map_or(1, |(_, moved, _)| moved.len());
        let nothing = Model::default();
        let model = moving.as_ref().map_or(&nothing, |(.., model)| model);
        let numbers = frames.map_or_else(|| vec![0], |frames| frames.places(model, count));
        let mut content = Self {
            framing: *framing,
            turntable: frames.and_then(|frames| frames.turntable(&numbers)),
            moving,
            tables: None,
            movers: Movers::default(),
            numbers,
        };
        content.tables = content.largest_tables();
        content.movers = content.movers();
        content
    }

    fn movers(&self) -> Movers {
        let (Some((frames, moved, shown)), Subject::Scene(_, tables)) =
            (&self.moving, self.framing.subject)
        else {
            return Movers::default();
        };
        let tables = self.tables.as_ref().unwrap_or(tables);
        let is_cancelled = || self.framing.is_cancelled();
        Movers::new(frames, moved, (shown, tables), &is_cancelled)
    }

    /// Returns the tables with the largest of their default radii, if these change.
    fn largest_tables(&mut self) -> Option<Tables> {
        let Subject::Scene(_, tables) = self.framing.subject else {
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
        for number in &self.numbers {
            if self.framing.is_cancelled() {
                return None;
            }
            frames.show(*number, shown);
            for (largest, at) in largest.iter_mut().zip(&changing) {
                *largest = largest.max(radius(shown, *at).unwrap_or(*largest));
            }
        }
        let mut tables = tables.clone();
        for (largest, at) in largest.into_iter().zip(changing) {
            let geometry = shown.geometry_mut(at);
            if let Some(Slot::Number(radius)) = geometry.and_then(|table| table.slot(RADIUS)) {
                *radius = largest;
            }
            // A table is always placed.
            let _ = tables.renew(at, shown);
        }
        Some(tables)
    }

    fn search(&mut self, directions: &[DVec3]) -> Extremes {
        let mut extremes = Extremes::new(directions);
        let turntable = self.turntable.as_ref();
        let framing = self.framing;
        // Returns true if that is enough.
        let mut add = |shape: &Shape, places: Range<usize>| {
            match turntable {
                None => extremes.add(shape),
                Some(turntable) => extremes.add_turned(shape, turntable, places),
            }
            framing.is_cancelled()
        };
        let always = 0..self.numbers.len();
        match framing.subject {
            Subject::World(world) => {
                let mut all = world.geometries().iter();
                all.any(|geometry| add(geometry.shape(), always.clone()));
            }
            Subject::Scene(model, tables) => {
                let tables = self.tables.as_ref().unwrap_or(tables);
                let moved = self.moving.as_ref().map_or(&[][..], |(_, moved, _)| moved);
                let mut rest = model
                    .leaves()
                    .filter(|leaf| moved.binary_search(&leaf.at).is_err());
                rest.any(|leaf| tables.any_shape(&leaf, |shape| add(shape, always.clone())));
            }
        }
        if let (Some((frames, _, shown)), Subject::Scene(_, tables)) =
            (&mut self.moving, framing.subject)
        {
            let tables = self.tables.as_ref().unwrap_or(tables);
            let mut moved = tables.clone();
            for (place, number) in self.numbers.iter().enumerate() {
                if framing.is_cancelled() {
                    break;
                }
                frames.show(*number, shown);
                let turned = turntable.map(|turntable| (turntable, place));
                self.movers.add(&mut extremes, shown, &mut moved, turned);
            }
        }
        extremes
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::scene::build;
    use crate::tracer::random::{Rng, cases};

    fn scene(geometries: &[serde_json::Value], animation: serde_json::Value) -> Model {
        serde_json::from_value(json!({
            "camera": {"Fit": {}},
            "geometries": geometries,
            "animation": animation,
        }))
        .unwrap()
    }

    fn framing<'a>(
        model: &'a Model,
        (tables, frames): (&'a Tables, &'a Frames),
        known: &'a Known,
        cancel: &'a Cancel,
    ) -> Framing<'a> {
        Framing {
            subject: Subject::Scene(model, tables),
            frames: Some(frames),
            known,
            cancel: Some(cancel),
        }
    }

    /// Returns the number of frames that are looked at, and checks that all frames reach no farther.
    fn looked_at(model: &Model, directions: &[DVec3]) -> usize {
        let (mut tables, frames) = (Tables::default(), Frames::of(model).unwrap());
        build::copy(model, &mut tables, model.copies().collect(), |_, _| true);
        let (known, cancel) = (Known::default(), Cancel::new());
        let framing = framing(model, (&tables, &frames), &known, &cancel);
        let mut few = Content::new(&framing);
        let mut all = Content::new(&framing);
        all.numbers = (0..frames.count()).collect();
        all.turntable = frames.turntable(&all.numbers);
        assert_eq!(
            few.search(directions).found(),
            one_by_one(&mut few, directions).found()
        );
        let distances = |content: &mut Content| content.search(directions).distances();
        for (few, all) in distances(&mut few).into_iter().zip(distances(&mut all)) {
            assert!(
                few <= all && all - few <= 1e-12 * all.abs().max(1.0),
                "{few} of {all}"
            );
        }
        few.numbers.len()
    }

    /// Adds each shape at each frame that is looked at, those that move after the others.
    fn one_by_one(content: &mut Content, directions: &[DVec3]) -> Extremes {
        let mut extremes = Extremes::new(directions);
        let Subject::Scene(model, tables) = content.framing.subject else {
            return extremes;
        };
        let (frames, mut tables) = (content.framing.frames.unwrap(), tables.clone());
        let mut add = |shape: &Shape, places: Range<usize>| {
            match &content.turntable {
                None => extremes.add(shape),
                Some(turns) => extremes.add_turned(shape, turns, places),
            }
            false
        };
        let moved = frames.moved_leaves(model);
        for leaf in model.leaves().filter(|leaf| !moved.contains(&leaf.at)) {
            tables.any_shape(&leaf, |shape| add(shape, 0..content.numbers.len()));
        }
        let mut shown = frames.copy(model);
        for (place, number) in content.numbers.iter().enumerate() {
            frames.show(*number, &mut shown);
            build::renew(&shown, &mut tables, &moved).unwrap();
            for leaf in shown.leaves().filter(|leaf| moved.contains(&leaf.at)) {
                tables.any_shape(&leaf, |shape| add(shape, place..place + 1));
            }
        }
        extremes
    }

    fn sphere() -> serde_json::Value {
        json!({"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#f00"}})
    }

    #[test]
    fn a_track_between_two_keys_needs_few_frames() {
        let tracks: serde_json::Map<_, _> = (0..50)
            .map(|index| {
                let keys = json!([[0, 1], [1000, 2, "Smooth"]]);
                (format!("geometries[{index}].radius"), keys)
            })
            .collect();
        let balls = vec![sphere(); 50];
        let model = scene(&balls, json!({"frames": 100_000, "tracks": tracks}));
        assert!(looked_at(&model, &[DVec3::X]) < 20);
        let turning = json!({"Group": {
            "transform": {"rotate": {"axis": [0, 1, 0], "angle": 0}},
            "geometries": balls,
        }});
        let tracks = json!({"geometries[0].transform.rotate.angle": [[0, 0], [4e4, 1e7]]});
        let turning = scene(&[turning], json!({"frames": 1_000_000, "tracks": tracks}));
        let frames = Frames::of(&turning).unwrap();
        let count = frames.places(&turning, 50).len();
        assert!((4_000..=6_000).contains(&count), "{count}");
        let orbit = json!({"frames": 1_000_000, "orbit": {"around": [0, 0, 0]}});
        let orbit = scene(&[sphere()], orbit);
        let count = Frames::of(&orbit).unwrap().places(&orbit, 1).len();
        assert!((10_000..=17_000).contains(&count), "{count}");
    }

    #[test]
    fn the_frames_that_are_looked_at_hold_the_extremes() {
        let mut rng = Rng(0x0f17_f17f);
        for _ in 0..cases(300) {
            let group = json!({"Group": {
                "transform": {
                    "scale": [1, 2, 3],
                    "rotate": {"axis": [1, 2, 3], "angle": 20},
                    "translate": [0, 0, 0],
                },
                "geometries": [sphere(), {"Box": {
                    "min": [-1, -2, -3], "max": [1, 2, 3], "color": "#f00",
                }}],
            }});
            let copies = json!({"Group": {
                "transform": {"rotate": {"axis": [1, 0, 2], "angle": 0}},
                "geometries": [
                    {"Instances": {"of": "one", "transforms": [
                        {}, {"translate": [2, 0, 0]}, {"scale": 2}, {"translate": [0, -1, 3]},
                    ]}},
                    sphere(),
                    {"Group": {"geometries": [sphere()]}},
                ],
            }});
            let mut one = sphere();
            one["Sphere"]["name"] = json!("one");
            let geometries = [one, group, sphere(), copies];
            let mut tracks = serde_json::Map::new();
            for (path, kind) in [
                ("geometries[0].center", 3),
                ("geometries[0].radius", 1),
                ("geometries[1].transform.translate", 3),
                ("geometries[1].transform.scale", 3),
                ("geometries[1].transform.rotate.angle", 1),
                ("geometries[1].geometries[0].center[1]", 1),
                ("geometries[2].center[0]", 1),
                ("geometries[3].transform.rotate.angle", 1),
                ("geometries[3].geometries[0].transforms[1].translate", 3),
                ("geometries[3].geometries[1].radius", 1),
                ("geometries[2].center[2]", 1),
            ] {
                if rng.below(3) > 0 {
                    continue;
                }
                let mut time = 0.0;
                let keys = (0..1 + rng.below(4)).map(|_| {
                    time += rng.magnitude(-2.0, 1.0);
                    let mut number = || rng.magnitude(-1.0, 1.0);
                    let value = match kind {
                        1 => json!(number()),
                        _ => json!([number(), number(), number()]),
                    };
                    let step = rng.one(&["Linear", "Smooth", "Step"]);
                    json!([time, value, step])
                });
                let keys: Vec<_> = keys.collect();
                tracks.insert(path.to_owned(), keys.into());
            }
            let mut animation = json!({"frames": 1 + rng.below(300), "fps": rng.one(&[5.0, 24.0])});
            match tracks.is_empty() || rng.below(4) == 0 {
                true => animation["orbit"] = json!({"around": [1, 0, 0], "turns": 1.3}),
                false => animation["tracks"] = tracks.into(),
            }
            let model = scene(&geometries, animation);
            let directions: Vec<_> = (0..9)
                .map(|_| crate::tracer::vector::unit(rng.vector() + DVec3::splat(1e-3)))
                .collect();
            looked_at(&model, &directions);
        }
    }

    #[test]
    fn a_cancelled_search_ends_and_is_not_kept() {
        let orbit = json!({"frames": 1_000_000, "orbit": {"around": [0, 0, 0]}});
        let model = scene(&[sphere()], orbit);
        let (tables, frames) = (Tables::default(), Frames::of(&model).unwrap());
        let (known, cancel) = (Known::default(), Cancel::new());
        cancel.cancel();
        let framing = framing(&model, (&tables, &frames), &known, &cancel);
        let camera = model.camera.as_ref().unwrap();
        assert!(framing.build(camera, (100, 100), 0).is_err());
        assert!(known.0.lock().unwrap().is_empty());
    }
}
