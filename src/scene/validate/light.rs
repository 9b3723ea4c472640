//! Checks of lights.

use std::mem;

use glam::DVec3;

use super::{camera::Eye, eye::is_glass};
use crate::{
    diagnostic::{Code, path::Path},
    parallel::Cancel,
    scene::{
        animation::frames::Frames,
        format::{
            geometry::walk::Leaf,
            light::{EnvironmentLightModel, LightModel},
            scene::Model,
            thing::Thing,
        },
        problem::{Focus, Problem},
        tables::Tables,
        validate::{found::Found, lamps::any_bright, material::WITHOUT_PATHS},
    },
    tracer::{
        geometry::Geometry,
        light::{
            Light,
            falloff::Falloff,
            source::{LightSize, Source},
        },
        shape::{Extent, Membership, Shape},
    },
};

/// The part of white below which a light is dim: half of the step between two bytes.
const DIM: f64 = 1.0 / 512.0;
/// The same for a light without an `intensity`, of which nobody thought: a fourth of the way from black
/// to white on a screen.
const DIM_BY_DEFAULT: f64 = 1.0 / 16.0;

impl Found {
    /// Checks the fields of the lights, and their names.
    pub(super) fn lights(&mut self, model: &Model, tables: &Tables) {
        let lights = model.lights.iter().flatten();
        let mut named = Vec::new();
        let mut has_surroundings = false;
        for (index, light) in lights.enumerate() {
            self.light(light, index);
            if matches!(light, LightModel::Environment(_))
                && mem::replace(&mut has_surroundings, true)
            {
                let message = "a scene has at most one `Environment`";
                let problem =
                    Problem::new(Code::DuplicateField, path_of(index), Focus::Name, message);
                self.push(problem.help("remove it"));
            }
            named.extend(light.name().map(|name| (index, name)));
        }
        self.extend(super::names::of(named, path_of));
        for (at, lights) in tables.lights_of_parts() {
            let of_part = lights
                .iter()
                .filter(|(_, light)| light.source() == Source::Surroundings);
            if of_part.count() > 0 && mem::replace(&mut has_surroundings, true) {
                let message = "the part has a second `Environment`, a scene has at most one";
                let path = model.path_of(at).field("lights");
                let problem = Problem::new(Code::DuplicateField, path, Focus::Key, message);
                self.push(problem.help("leave `lights` out, or remove the other one"));
            }
        }
    }

    /// Checks the fields of a light.
    pub(super) fn light(&mut self, light: &LightModel, index: usize) {
        let path = || path_of(index);
        light.each(|field, value| self.field(field, value, path));
        if let Some(field) = light.size().filter(|_| !self.follows_paths) {
            self.no_effect(path().field(field), WITHOUT_PATHS);
        }
        if let Some(vector) = light.to_target() {
            let what = "`look_at` - `position`";
            self.direction(vector, what, || path().field("look_at"));
        }
        if let LightModel::Environment(EnvironmentLightModel { sky: Some(sky), .. }) = light {
            sky.each(|field, value| self.field(field, value, || path().field("sky")));
        }
        let helps = match light {
            LightModel::Environment(_) => [
                "the light has one color, a sky or a picture; leave the others out",
                "add `color`, such as \"#fff\", `sky` or `image`",
            ],
            _ => [
                "`direction` is a direction, `look_at` a point; leave one of them out",
                "add `direction`, such as (0, -1, 0), or `look_at`, a point",
            ],
        };
        self.one_of(light, Code::OneOf, &path(), helps);
    }

    /// Warns about a lit scene that is black.
    pub(super) fn unlit(&mut self, model: &Model, tables: &Tables, frames: Option<&Frames>) {
        let Some(lights) = &model.lights else { return };
        let follows_paths = self.follows_paths;
        let is_bright = |light: &Light| {
            let is_seen = follows_paths || light.source() != Source::Surroundings;
            is_seen && light.glow().radiance().max_channel() > 0.0
        };
        let mut of_parts = tables.lights().flatten();
        if of_parts.any(|(_, light)| is_bright(light)) {
            return;
        }
        let shines = |(index, light): (usize, &LightModel)| {
            let changes = frames.is_some_and(|frames| frames.change_light(index));
            let light = light.build();
            changes || light.is_ok_and(|light| is_bright(&light))
        };
        if lights.iter().enumerate().any(shines)
            || any_bright(model, tables, |material| {
                material.lobes().emission.is_some()
            })
        {
            return;
        }
        let message = "no light shines: all surfaces are black";
        let path = Path::ROOT.field("lights");
        let problem = Problem::new(Code::Unlit, path, Focus::Value, message);
        self.push(problem.help("add a light, such as `Headlight()`"));
    }

    /// Warns about lights that are too far away for their intensity, and about lights inside opaque
    /// spheres.
    pub(super) fn places_of_lights(
        &mut self,
        lights: Option<&[LightModel]>,
        model: &Model,
        tables: &Tables,
        eyes: &[Eye],
    ) {
        for (index, given) in lights.into_iter().flatten().enumerate() {
            if self.is_cancelled() {
                return;
            }
            let Ok(light) = given.build() else { continue };
            let (position, falloff) = match light.source() {
                Source::Everywhere
                | Source::Surroundings
                | Source::Viewer
                | Source::Direction(_) => continue,
                Source::Point {
                    position, falloff, ..
                } => (position, falloff),
            };
            if falloff == Falloff::InverseSquare {
                let mut dim = DIM_BY_DEFAULT;
                given.each(|field, _| {
                    if field.name == "intensity" {
                        dim = DIM;
                    }
                });
                self.dim_light((&light, dim), position, index, model, tables);
            }
            if light.shadows() {
                let radius = match light.size() {
                    LightSize::Ball(radius) if self.follows_paths => radius,
                    _ => 0.0,
                };
                self.light_inside((position, radius), index, (model, tables), eyes);
            }
        }
    }

    fn dim_light(
        &mut self,
        (light, dim): (&Light, f64),
        position: DVec3,
        index: usize,
        model: &Model,
        tables: &Tables,
    ) {
        let (mut nearest, mut to_plane) = (f64::INFINITY, f64::INFINITY);
        let cancel = self.cancel.clone();
        tables.any_shape_of(model, |shape| {
            match shape.extent() {
                Extent::Ball(center, radius) => {
                    let to_ball = ((center - position).length() - radius).max(0.0);
                    if to_ball < nearest {
                        nearest = nearest.min(to_ball.max(to_box(shape, position)));
                    }
                }
                Extent::Plane(plane) => {
                    let distance = (position - plane.point()).dot(plane.unit_normal()).abs();
                    to_plane = to_plane.min(distance);
                }
            }
            cancel.as_ref().is_some_and(Cancel::is_cancelled)
        });
        let brightness = light.glow().radiance().max_channel();
        // A plane is near somewhere, which does not help what is far away.
        if !nearest.is_finite() || brightness / (nearest * nearest) >= DIM {
            nearest = nearest.min(to_plane);
        }
        let squared = nearest * nearest;
        let is_dim = brightness > 0.0 && squared.is_finite() && brightness / squared < dim;
        if !is_dim {
            return;
        }
        let message = format!(
            "this light brings less than 1/{} of white to the nearest geometry, {} away",
            1.0 / if brightness / squared < DIM { DIM } else { dim },
            rounded(nearest)
        );
        let problem = Problem::new(Code::DimLight, path_of(index), Focus::Name, message);
        let bright = rounded(light.glow().intensity() * squared / brightness);
        self.push(problem.help(format!(
            "light weakens with the square of the distance: `intensity: {bright}` brings 1, or \
             write `falloff: Constant`"
        )));
    }

    fn light_inside(
        &mut self,
        (position, radius): (DVec3, f64),
        index: usize,
        (model, tables): (&Model, &Tables),
        eyes: &[Eye],
    ) {
        let keeps_it_in = |shape: &Shape| {
            let is_inside = |point| matches!(shape.membership(point), Membership::Inside(..));
            let ends = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
            let is_whole = ends
                .map(|end| position + radius * end)
                .all(|end| radius == 0.0 || is_inside(end));
            is_inside(position) && is_whole && !eyes.iter().any(|eye| is_inside(eye.point))
        };
        let holds_it = |leaf: &Leaf| match leaf.shape() {
            Some(shape) => {
                (keeps_it_in(&shape) && !is_glass(leaf.geometry, model)).then(|| shape.kind())
            }
            None => {
                let is_it =
                    |geometry: &&Geometry| keeps_it_in(geometry.shape()) && !geometry.has_glass();
                let all = tables.get(leaf.at)?.geometries(&leaf.placement).ok()?;
                let found = all.iter().find(is_it);
                found.map(|geometry| geometry.shape().kind_of_one())
            }
        };
        let found = model
            .leaves()
            .find_map(|holder| holds_it(&holder).map(|kind| (holder, kind)));
        let Some((holder, kind)) = found else {
            return;
        };
        let message = format!("this light is inside an opaque {kind}, which keeps it in");
        let problem = Problem::new(Code::LightInside, path_of(index), Focus::Name, message);
        let label = match holder.geometry.words() {
            Some(words) => format!("the {kind} is {}", words.one),
            None => format!("the {kind}"),
        };
        self.push(
            problem
                .help("move it out, or write `shadows: false`")
                .label(model.path_of(holder.at), Focus::Name, label),
        );
    }
}

fn path_of(index: usize) -> Path {
    Path::ROOT.field("lights").index(index)
}

/// Returns the distance from a point to the box around a shape: the ball around a wide floor is as high
/// as the floor is wide.
fn to_box(shape: &Shape, point: DVec3) -> f64 {
    let beside = |[low, high]: [DVec3; 2]| (low - point).max(point - high).max(DVec3::ZERO);
    match shape {
        // Its ball is the shape.
        Shape::Sphere(_) => 0.0,
        _ => shape.bounds().map_or(0.0, |bounds| beside(bounds).length()),
    }
}

/// Formats a number with three digits.
fn rounded(number: f64) -> String {
    let text = format!("{number:.2e}");
    text.parse::<f64>()
        .map_or(text, |number| number.to_string())
}
