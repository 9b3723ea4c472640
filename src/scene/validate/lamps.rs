//! Checks of what lights a scene whose light follows paths.

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{lighting::LightingModel, material::Surface, scene::Model},
        problem::{Focus, Problem},
        tables::Tables,
        validate::{eye::is_glass, found::Found},
    },
    tracer::{
        geometry::Geometry,
        light::{
            Light,
            source::{LightSize, Source},
        },
        material::Material,
        shape::Shape,
    },
};

/// Returns true if `is_it` holds for the material of a geometry of a scene, of those that are bright by themselves.
pub(super) fn any_bright(
    model: &Model,
    tables: &Tables,
    is_it: impl Fn(&Material) -> bool,
) -> bool {
    let parts = tables.contents().filter_map(|(_, content)| content.part());
    let mut in_parts = parts.flat_map(|part| &part.geometries);
    let mut own = model.walk();
    in_parts.any(|geometry| geometry.materials().any(&is_it))
        || own.any(|(_, geometry)| is_bright(&geometry.surface(), model, &is_it))
}

/// The same for the material of a surface.
fn is_bright(surface: &Surface, model: &Model, is_it: impl Fn(&Material) -> bool) -> bool {
    let material = surface.material;
    let material = material.and_then(|material| material.resolve(model.materials.as_ref()));
    // Most materials are not built.
    let material = material.filter(|material| material.emits());
    material.is_some_and(|material| material.build().is_ok_and(|material| is_it(&material)))
}

/// Returns true if a material lights others.
fn is_lamp(material: &Material) -> bool {
    material.lamp().is_some()
}

/// Returns true if paths can aim at a face of a shape.
fn is_target(shape: &Shape) -> bool {
    let mut is_target = false;
    shape.each_target(&mut |_, _, _| is_target = true);
    is_target
}

impl Found {
    /// Warns about geometries that shine but that no path aims at.
    pub(super) fn not_aimed(&mut self, model: &Model, tables: &Tables) {
        for leaf in model.leaves() {
            if self.is_cancelled() {
                return;
            }
            let kind = match tables.get(leaf.at) {
                Some(content) => content.geometries(&leaf.placement).ok().and_then(|all| {
                    let is_it =
                        |of: &&Geometry| of.materials().any(is_lamp) && !is_target(of.shape());
                    all.iter().find(is_it).map(|of| of.shape().kind_of_one())
                }),
                None if (leaf.geometry.surfaces().iter())
                    .any(|of| is_bright(of, model, is_lamp)) =>
                {
                    let shape = leaf.shape().filter(|shape| !is_target(shape));
                    shape.map(|shape| shape.kind())
                }
                None => None,
            };
            let Some(kind) = kind else { continue };
            if self.tally.only_counts(Code::NotAimed) {
                continue;
            }
            let message =
                format!("paths cannot aim at this {kind} that shines, so its light is noisy");
            let problem =
                Problem::new(Code::NotAimed, model.path_of(leaf.at), Focus::Name, message);
            self.push(problem.help(
                "let a rectangle, a disc, a sphere, a box, a cylinder, a capsule or a mesh shine instead",
            ));
        }
    }

    /// Warns about solid glass that no light gets through.
    pub(super) fn lost_caustic(&mut self, model: &Model, tables: &Tables) {
        let Some(LightingModel::Path(path)) = &model.lighting else {
            return;
        };
        if !path.caustics() {
            return;
        }
        let own = model
            .lights
            .iter()
            .flatten()
            .filter_map(|light| light.build().ok());
        let of_parts = tables.lights().flatten().map(|(_, light)| light.clone());
        let lights: Vec<Light> = own.chain(of_parts).collect();
        let shines = |light: &&Light| light.glow().radiance().max_channel() > 0.0;
        // True for a light that no path finds, false for one that paths find.
        let is_lost = |light: &Light| match light.source() {
            Source::Viewer => None,
            Source::Everywhere | Source::Surroundings => Some(false),
            Source::Direction(_) | Source::Point { .. } => {
                Some(light.size() == LightSize::None && light.shadows())
            }
        };
        let mut lost = lights.iter().filter(shines).filter_map(is_lost).peekable();
        if lost.peek().is_none() || !lost.all(|is_lost| is_lost) {
            return;
        }
        let is_solid_glass = |of: &Geometry| of.has_glass() && !of.shape().is_flat();
        let has_glass = model.leaves().any(|leaf| match tables.get(leaf.at) {
            Some(content) => {
                let all = content.geometries(&leaf.placement);
                all.is_ok_and(|all| all.iter().any(is_solid_glass))
            }
            None => {
                is_glass(leaf.geometry, model) && leaf.shape().is_some_and(|shape| !shape.is_flat())
            }
        });
        if !has_glass || any_bright(model, tables, is_lamp) {
            return;
        }
        let message = "no light gets through solid glass: paths find only lights with a size";
        let path = Path::ROOT.field("lighting");
        let problem = Problem::new(Code::LostCaustic, path, Focus::Value, message);
        self.push(problem.help(
            "give a light a `radius` or an `angle`, or write `lighting: Path(caustics: false)`",
        ));
    }
}
