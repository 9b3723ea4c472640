//! Checks of an animation: of its keys, and of faults that appear only between them.

use std::collections::HashMap;

use glam::DVec3;

use crate::{
    diagnostic::{
        Code,
        path::{Path, Step},
    },
    scene::{
        animation::{
            frames::Frames,
            target::{Aspect, Target},
        },
        format::{
            animation::{Interpolation, Key, Track, of_keys},
            field::{FieldKind, Held, Value},
            numbers::Triple,
            scene::Model,
            thing::Thing,
        },
        problem::{Focus, Problem},
        validate::found::Found,
    },
    tracer::{camera::basis::are_parallel, vector::is_direction},
};

fn path_of_track(path: &str) -> Path {
    Path::ROOT.field("animation").field("tracks").key(path)
}

fn path_of_orbit() -> Path {
    Path::ROOT.field("animation").field("orbit")
}

/// Returns the problem of a track that moves an orbiting camera.
fn against_orbit(path: &str) -> Problem {
    let message = "`orbit` changes this as well: it turns all cameras";
    let place = path_of_track(path);
    let problem = Problem::new(Code::DuplicateField, place, Focus::Key, message);
    let problem = problem.help("remove one of the two; `fov` and `scale` may change in an orbit");
    problem.label(path_of_orbit(), Focus::Key, "the orbit")
}

impl Found {
    /// Checks the numbers, the paths and the keys.
    pub(super) fn animation(&mut self, model: &Model) {
        let Some(animation) = &model.animation else {
            return;
        };
        let (tracks, orbit) = (&animation.tracks, &animation.orbit);
        let root = || Path::ROOT.field("animation");
        animation.each(|field, value| self.field(field, value, root));
        if tracks.is_none() && orbit.is_none() {
            let (path, message) = (root().field("tracks"), "missing field `tracks` or `orbit`");
            let problem = Problem::new(Code::MissingField, path, Focus::Bracket, message);
            let help = "add `tracks` with keys, or an `orbit` of the cameras";
            self.push(problem.help(help));
        }
        if let Some(orbit) = orbit {
            orbit.each(|field, value| self.field(field, value, path_of_orbit));
        }
        let mut earlier = Earlier::default();
        for (path, track) in animation.tracks() {
            let place = path_of_track(path);
            match Target::of(model, path) {
                Ok(target) => {
                    let orbits = orbit.is_some() && target.is_turned_by_orbit();
                    self.extend(orbits.then(|| against_orbit(path)));
                    self.extend(earlier.add(path, &target));
                    self.track(&target, track, &place);
                }
                Err(fault) => {
                    let problem = Problem::new(fault.code, place, Focus::Key, fault.message);
                    self.push(problem.help_of(fault.help));
                }
            }
        }
    }

    fn track(&mut self, target: &Target, track: &Track, path: &Path) {
        of_keys!(track, keys => self.keys(keys, path, target), _ => {});
        if let Track::Directions(keys) = track {
            self.opposite(keys, path);
        }
    }

    /// Checks the times of keys and their values.
    fn keys<T: Held>(&mut self, keys: &[Key<T>], path: &Path, target: &Target) {
        if keys.is_empty() {
            let message = "expected at least one key, found an empty list";
            let problem = Problem::new(Code::WrongType, path.clone(), Focus::Value, message);
            self.push(problem.help("write a key, such as the time 0 with a value, or remove it"));
        }
        let time_of = |index| path.index(index).index(0);
        let mut before: Option<(usize, f64)> = None;
        for (index, key) in keys.iter().enumerate() {
            if self.number(key.time, || time_of(index)) {
                self.time(
                    key.time,
                    time_of(index),
                    before.map(|(at, time)| (time_of(at), time)),
                );
                before = Some((index, key.time));
            }
            if let Some(value) = key.value.value() {
                self.value(target, value, &path.index(index).index(1));
            }
        }
    }

    /// Checks the time of a key; `before` is that of the previous key.
    fn time(&mut self, time: f64, path: Path, before: Option<(Path, f64)>) {
        if time < 0.0 {
            let message = "the time of a key must not be below 0";
            self.push(Problem::of_value(Code::OutOfRange, path, message));
        } else if let Some((place, before)) = before
            && time <= before
        {
            let message = format!("the times of keys must ascend, expected more than `{before}`");
            let problem = Problem::of_value(Code::UnsortedKeys, path, message);
            let problem = problem.help("keys are in the order of their times, one for each time");
            self.push(problem.label(place, Focus::Value, "the key before"));
        }
    }

    /// Checks a value for a field, or for one number of it.
    fn value(&mut self, target: &Target, value: Value, path: &Path) {
        let path = || path.clone();
        match (value, target.component) {
            (Value::Number(number), Some(_)) => {
                let is_color = target.kind == FieldKind::Color;
                if self.number(number, path) && is_color && !(0.0..=1.0).contains(&number) {
                    self.push(super::field::clamped(path()));
                }
            }
            (value, _) => self.fault(target.kind, target.field, value, &path),
        }
    }

    /// Reports opposite directions, between which the way is not unique.
    fn opposite(&mut self, keys: &[Key<Triple>], path: &Path) {
        for (index, pair) in keys.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let [a, b] = [from.value, to.value].map(DVec3::from);
            let jumps = to.step == Some(Interpolation::Step);
            if jumps || !is_direction(a) || !is_direction(b) {
                continue;
            }
            if are_parallel(a, b) && a.dot(b) < 0.0 {
                let value = |index| path.index(index).index(1);
                let message = "this direction is opposite to that of the key before: \
                               it may be reached on any side";
                let place = value(index + 1);
                let problem = Problem::new(Code::ParallelVectors, place, Focus::Value, message);
                let problem = problem.help("give a direction between the two, or `Step`");
                let before = "the direction before";
                self.push(problem.label(value(index), Focus::Value, before));
            }
        }
    }

    /// Reports faults that appear only between keys: the first frame with an invalid camera,
    /// light or plane. Of very many frames, evenly spaced ones are checked; each is checked again
    /// before it is drawn.
    pub(super) fn frames(&mut self, model: &Model, frames: &Frames) {
        let mut owners = Vec::new();
        if frames.orbit_cameras() {
            let cameras = model.all_cameras();
            owners.extend(cameras.map(|(name, _)| (Aspect::Camera, Model::path_of_camera(name))));
        }
        for (_, target) in frames.targets() {
            let is_watched = match target.aspect {
                Aspect::Camera => true,
                // The numbers of a direction may all be 0 at once, and two points may meet; all other
                // values stay between their keys.
                Aspect::Geometry => target.kind.is_vector(),
                // One end of a range may pass the other.
                Aspect::ColorBy => target.component.is_some(),
                // A scale may be 0 between a positive and a negative one.
                Aspect::Transform => target.kind != FieldKind::Point,
                // A light may meet the point that it is aimed at.
                Aspect::Light => matches!(target.kind, FieldKind::Direction | FieldKind::Point),
                Aspect::Scene | Aspect::Picture | Aspect::Material => false,
            };
            let owner = (target.aspect, target.owner.clone());
            if is_watched && !owners.contains(&owner) {
                owners.push(owner);
            }
        }
        let mut shown = frames.copy(model);
        for number in frames.sample(model) {
            if owners.is_empty() || self.is_cancelled() {
                return;
            }
            frames.show(number, &mut shown);
            owners.retain(|owner| {
                let fault = fault_of(owner, &shown);
                let is_fine = fault.is_none();
                let placed = fault.and_then(|fault| at_frame(fault, owner, frames, number));
                self.extend(placed);
                is_fine
            });
        }
    }
}

/// The first error of a camera, a light or a geometry.
fn fault_of((aspect, owner): &(Aspect, Path), model: &Model) -> Option<Problem> {
    let mut found = Found::new(1);
    let mut cameras = model.all_cameras();
    let camera = cameras.find(|(name, _)| owner.is_in(&Model::path_of_camera(*name)));
    if let Some((_, camera)) = camera {
        found.camera(camera, Model::path_of_camera(None));
    } else if let Some((at, _)) = model.geometry_on(owner.steps())
        && let Some(geometry) = model.geometry(at)
    {
        match aspect {
            Aspect::ColorBy => found.color_by(geometry, at, model),
            _ => found.geometry(geometry, at, model),
        }
    } else if let [_, Step::Index(index)] = *owner.steps()
        && let Some(light) = model.lights.as_ref().and_then(|lights| lights.get(index))
    {
        found.light(light, index);
    }
    found.list.into_iter().find(Problem::is_error)
}

/// Moves a fault at a frame to the track that causes it, or to the orbit.
fn at_frame(
    fault: Problem,
    (aspect, owner): &(Aspect, Path),
    frames: &Frames,
    number: u32,
) -> Option<Problem> {
    let fault = fault.diagnostic;
    let field = fault.path.steps().last().and_then(Step::name);
    let is_cause = |target: &Target| field == Some(target.field);
    let of_owner = || {
        frames
            .targets()
            .filter(|(_, target)| target.owner == *owner)
    };
    let cause = of_owner().find(|(_, target)| is_cause(target));
    let orbits = frames.orbit_cameras() && *aspect == Aspect::Camera;
    let place = match cause {
        None if orbits => path_of_orbit(),
        cause => path_of_track(cause.or_else(|| of_owner().next())?.0),
    };
    let seconds = frames.seconds(number);
    let message = format!("{}, at frame {number} ({seconds:.3} s)", fault.message);
    let problem = Problem::new(fault.code, place, Focus::Key, message);
    Some(problem.help_of(fault.help))
}

/// The changes of the tracks so far, by field.
#[derive(Default)]
struct Earlier<'a>(HashMap<(Path, &'static str), Vec<Changed<'a>>>);

/// One number of a field or, with `None`, all of it, and the path of the track.
type Changed<'a> = (Option<usize>, &'a str);

impl<'a> Earlier<'a> {
    /// Adds a track; it is a problem if another track already changes the same value.
    fn add(&mut self, path: &'a str, target: &Target) -> Option<Problem> {
        let value = (target.owner.clone(), target.field);
        let tracks = self.0.entry(value).or_default();
        let one = target.component;
        let mut others = tracks.iter();
        let other = others.find(|(other, _)| one.is_none() || other.is_none() || *other == one);
        let problem = other.map(|(_, first)| {
            let message = "another track changes this as well";
            let place = path_of_track(path);
            let problem = Problem::new(Code::DuplicateField, place, Focus::Key, message);
            let problem = problem.help("remove one of the two");
            problem.label(path_of_track(first), Focus::Key, "the first of them")
        });
        tracks.push((one, path));
        problem
    }
}
