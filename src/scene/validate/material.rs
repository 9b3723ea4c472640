//! Checks of materials and of the surfaces of geometries.

use std::collections::HashSet;

use glam::DVec3;

use super::solid::is_covered;
use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            color_by::{ColorByModel, ColormapModel},
            geometry::{GeometryModel, ordinal::Ordinal},
            image::ImageModel,
            lighting::LightingModel,
            material::MaterialModel,
            scene::Model,
            texture::{MappingModel, TextureModel},
            thing::{Needs, Set, Thing},
        },
        problem::{Focus, Problem},
        unknown,
        validate::found::Found,
    },
    text::nearest::{list, quote},
    tracer::{camera::basis::are_parallel, vector::is_direction},
};

impl Found {
    /// Checks the named materials.
    pub(super) fn materials(&mut self, model: &Model) {
        for (name, material) in model.materials.iter().flat_map(|materials| &materials.0) {
            let path = Path::ROOT.field("materials").key(name);
            if name.is_empty() {
                let (place, message) = (path.clone(), "an empty string is not a name");
                self.push(Problem::new(Code::InvalidName, place, Focus::Key, message));
            }
            if material.named().is_some() {
                let message = "a material in `materials` cannot be a name itself";
                let problem = Problem::new(Code::WrongType, path.clone(), Focus::Value, message);
                self.push(problem.help("write the material, such as `Matte(color: …)`"));
            }
            self.material(material, || path.clone());
        }
    }

    /// Checks the color and the material of a geometry.
    #[inline]
    pub(super) fn surface(
        &mut self,
        geometry: &GeometryModel,
        model: &Model,
        names: &HashSet<&str>,
        (at, is_part): (Ordinal, bool),
        stand_ins: &[Ordinal],
    ) {
        let surface = geometry.surface();
        self.color_by(geometry, at, model);
        // Most have a color alone.
        if surface.color.is_some() && surface.texture.is_none() && surface.material.is_none() {
            return;
        }
        if surface.is_plain() == surface.material.is_some() {
            self.one_of_color_and_material(geometry, (at, is_part), model, stand_ins);
        }
        if let Some(texture) = surface.texture {
            self.texture(texture, || model.path_of(at).field("texture"));
        }
        if let Some(material) = surface.material {
            let path = || model.path_of(at).field("material");
            let name = material.named().filter(|name| !names.contains(name));
            if let Some(name) = name {
                self.unknown_name(name, model, path);
            }
            self.material(material, path);
        }
        if let Some(texture) = surface.texture(model.materials.as_ref()) {
            let path = surface.path_of_texture(model.path_of(at));
            match is_part {
                true => self.no_effect(path, OF_SOLID),
                false => self.shown_texture(geometry, texture, path),
            }
        }
    }

    fn one_of_color_and_material(
        &mut self,
        geometry: &GeometryModel,
        (at, is_part): (Ordinal, bool),
        model: &Model,
        stand_ins: &[Ordinal],
    ) {
        let surface = geometry.surface();
        // The rows of a table and the vertices of a mesh in a file may have colors; `tables.rs` and
        // `meshes.rs` report those without.
        // The parts of a solid may have that of the whole, and the whole needs none if they all have
        // their own.
        let is_covered = geometry.operation().is_some() && is_covered(geometry, at, stand_ins);
        let needs_none = geometry.may_have_colors() || !geometry.has_surface() || is_covered;
        let needs_none = needs_none || is_part;
        if (!surface.is_given() && needs_none) || self.tally.only_counts(Code::OneOf) {
            return;
        }
        let helps = [
            match surface.texture {
                Some(_) => "write the texture inside of the material, and its color as well",
                None => "`color: c` is `material: Matte(color: c)`; leave one of them out",
            },
            "add `color`, such as \"#ff8000\", or `material`",
        ];
        self.one_of(geometry, Code::OneOf, &model.path_of(at), helps);
    }

    /// Checks the fields of a material.
    fn material(&mut self, material: &MaterialModel, path: impl Fn() -> Path) {
        material.each(|field, value| self.field(field, value, &path));
        let described = material.described().ok();
        let sets = material.sets().into_iter();
        for (set, are_given) in sets.filter(|(set, _)| set.needs == Needs::Any) {
            if let Some(color) = set.first()
                && are_given.iter().all(Option::is_none)
                && !self.tally.only_counts(Code::MissingField)
            {
                let message = format!("missing field `{color}`");
                self.push(Problem::new(
                    Code::MissingField,
                    path(),
                    Focus::Name,
                    message,
                ));
            }
        }
        if let Some(texture) = described.and_then(|material| material.texture()) {
            self.texture(texture, || path().field("texture"));
        }
        if let Some([field, why]) = described.and_then(|material| material.moot_field()) {
            self.no_effect(path().field(field), why);
        }
        if !self.is_lit {
            self.no_effect_without_lights(material, &path);
        }
    }

    /// Checks the fields of a texture.
    fn texture(&mut self, texture: &TextureModel, path: impl Fn() -> Path) {
        texture.each(|field, value| self.field(field, value, &path));
        let Some(mapping) = texture.mapping() else {
            return;
        };
        let path = || path().field("mapping");
        mapping.each(|field, value| self.field(field, value, path));
        if let MappingModel::Spherical(spherical) = mapping {
            let [up, front] = [spherical.up(), spherical.front()].map(DVec3::from);
            if is_direction(up) && is_direction(front) && are_parallel(front, up) {
                let message = "`front` is parallel to `up`";
                let place = path().field("front");
                let problem = Problem::of_value(Code::ParallelVectors, place, message);
                self.push(problem.help("give a direction beside the pole"));
            }
        }
    }

    /// Reports a texture that a geometry does not show.
    fn shown_texture(&mut self, geometry: &GeometryModel, texture: &TextureModel, path: Path) {
        if geometry.operation().is_some() {
            self.no_effect(path, OF_SOLID);
        } else if let GeometryModel::Mesh(mesh) = geometry {
            // `meshes.rs` reports a file without coordinates.
            if mesh.color_by.is_some() {
                self.no_effect(path, "the colors of `color_by` replace the texture");
            } else if mesh.file.is_none()
                && texture.is_natural()
                && !self.tally.only_counts(Code::MissingUv)
            {
                let message = "the mesh has no texture coordinates";
                let problem = Problem::new(Code::MissingUv, path, Focus::Value, message);
                self.push(problem.help(
                    "give the texture a `mapping`: `Planar(origin: …, u: …, v: …)` or `Spherical(center: …)`",
                ));
            }
        }
    }

    fn unknown_name(&mut self, name: &str, model: &Model, path: impl Fn() -> Path) {
        if self.tally.only_counts(Code::UnknownName) {
            return;
        }
        let known: Vec<&str> = model.names_of_materials().collect();
        let message = match &*known {
            [] => {
                let name = quote(name);
                format!("unknown material {name}, the scene has no `materials`")
            }
            known => unknown::message("material", name, known),
        };
        let problem = Problem::new(Code::UnknownName, path(), Focus::Content, message);
        self.push(problem.meaning(name, &known));
    }

    /// Warns about what only lights show of a material: all but its first color.
    fn no_effect_without_lights(&mut self, material: &MaterialModel, path: impl Fn() -> Path) {
        let first = material.fields().first().map(|field| field.name);
        let mut fields = Vec::new();
        material.each(|field, _| fields.push(field.name));
        for name in fields.into_iter().filter(|name| Some(*name) != first) {
            self.no_effect(path().field(name), WITHOUT_LIGHTS);
        }
    }

    /// Warns about fields of a scene without lights that only matter in a lit one.
    pub(super) fn unlit_fields(&mut self, model: &Model) {
        if self.is_lit {
            let image = model.image.as_ref();
            let is_given = image.is_some_and(|image| image.samples.is_some());
            let is_known = matches!(model.lighting, Some(LightingModel::Path(_)));
            if is_given && is_known && model.outlines.is_none() {
                self.no_effect(Path::ROOT.field("image").field("samples"), OWN_SAMPLES);
            }
            return;
        }
        if model.lighting.is_some() {
            self.no_effect(Path::ROOT.field("lighting"), WITHOUT_LIGHTS);
        }
        let Some(ImageModel {
            exposure,
            tone_mapping,
            ..
        }) = &model.image
        else {
            return;
        };
        for (is_given, name) in [
            (exposure.is_some(), "exposure"),
            (tone_mapping.is_some(), "tone_mapping"),
        ] {
            if is_given {
                self.no_effect(Path::ROOT.field("image").field(name), WITHOUT_LIGHTS);
            }
        }
    }

    pub(super) fn no_effect(&mut self, path: Path, why: &str) {
        if self.tally.only_counts(Code::NoEffect) {
            return;
        }
        let message = format!("this has no effect: {why}");
        let problem = Problem::new(Code::NoEffect, path, Focus::Key, message);
        self.push(match why {
            WITHOUT_LIGHTS => problem.help("add `lights: [Headlight()]`, or remove it"),
            WITHOUT_PATHS => problem.help("write `lighting: Path()`, or remove it"),
            _ => problem.help("remove it"),
        });
    }
}

/// Why the size of a light has no effect.
pub(super) const WITHOUT_PATHS: &str = "only light that follows paths shows it";

/// Why the texture of a solid has no effect.
const OF_SOLID: &str = "solids of several parts show no texture";

/// Why the samples of an image have no effect.
const OWN_SAMPLES: &str = "the paths of a pixel are `samples` of `lighting: Path()`";

const WITHOUT_LIGHTS: &str = "the scene has no `lights`";

impl Found {
    /// Requires one of the first fields that are given in place of each other, and not both; returns true if
    /// so. The helps are for both and for none.
    pub(super) fn one_of(
        &mut self,
        thing: &impl Thing,
        code: Code,
        path: &Path,
        [leave_out, add]: [&str; 2],
    ) -> bool {
        let mut sets = thing.sets().into_iter();
        let set = sets.find(|(set, _)| set.needs != Needs::Any);
        let Some((Set { fields, .. }, are_given)) = set else {
            return true;
        };
        let mut given = are_given.into_iter().flatten();
        self.push(match (given.next(), given.next()) {
            (Some(_), None) => return true,
            (Some(one), Some(other)) => both(code, path, [one, other]).help(leave_out),
            (None, _) => {
                let firsts = fields.iter().filter_map(|list| list.first().copied());
                let none = match &*firsts.collect::<Vec<_>>() {
                    [first, other] => format!("neither `{first}` nor `{other}`"),
                    all => format!("none of {}", list(all)),
                };
                let message = format!("{none} is given, expected one of them");
                Problem::new(code, path.clone(), Focus::Name, message).help(add)
            }
        });
        false
    }
}

/// Creates the problem of two fields that are both given; the later one of them in the text is
/// reported.
pub(super) fn both(code: Code, path: &Path, [first, other]: [&'static str; 2]) -> Problem {
    let message = format!("`{first}` and `{other}` are both given, expected one of them");
    Problem::new(code, path.field(other), Focus::Key, message).label(
        path.field(first),
        Focus::Key,
        "the other one",
    )
}

impl Found {
    /// Checks the colors by value of a geometry, if it has them.
    #[inline]
    pub(super) fn color_by(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        if let Some(by) = geometry.color_by() {
            self.values(geometry, by, model.path_of(at));
        }
    }

    fn values(&mut self, geometry: &GeometryModel, by: &ColorByModel, geometry_path: Path) {
        let path = || geometry_path.clone().field("color_by");
        if geometry.surface().color.is_some() {
            let problem = both(Code::OneOf, &geometry_path, ["color", "color_by"]);
            self.push(problem.help("values have colors of their own; leave one of them out"));
        }
        by.each(|field, value| self.field(field, value, path));
        if let Some(ColormapModel::Colors(colors)) = &by.map {
            if colors.len() < 2 {
                let count = colors.len();
                let message = format!("expected at least 2 colors, found {count}");
                let path = path().field("map");
                self.push(Problem::new(Code::WrongType, path, Focus::Content, message));
            }
            for (index, color) in colors.iter().enumerate() {
                self.color(color, || path().field("map").index(index));
            }
        }
    }
}
