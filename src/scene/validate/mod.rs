//! Checks of a well-formed scene: one function per code, and none stops at the first fault.

mod animation;
mod camera;
mod copies;
mod enclosed;
mod eye;
mod field;
mod found;
mod geometry;
mod inward;
mod lamps;
mod light;
mod material;
mod names;
mod overlap;
mod solid;
mod transform;
mod visibility;

use std::collections::HashSet;

use crate::{
    diagnostic::{Code, Severity, levels::Levels, path::Path},
    film::{samples::Samples, size::Size},
    parallel::Cancel,
    scene::{
        animation::frames::Frames,
        duplicates::Duplicates,
        format::{
            geometry::{GeometryModel, ordinal::Ordinal, placement::Placement},
            image::ImageModel,
            lighting::{LightingModel, PathModel},
            scene::Model,
            thing::Thing,
            warning::WarningName,
        },
        framing::{Framing, Known, Subject},
        problem::{Focus, Problem, Tally},
        tables::Tables,
        unknown,
        validate::{
            eye::{Surroundings, is_glass},
            found::Found,
            inward::Inward,
            material::both,
            overlap::GlassSolid,
        },
    },
};

/// What the checks of a scene depend on besides the scene.
pub(crate) struct Aspects<'a> {
    pub(crate) levels: &'a Levels,
    /// True for a part of another scene, whose camera and lights are not known.
    pub(crate) is_part: bool,
    /// True if the files that the scene names have errors.
    pub(crate) files_have_errors: bool,
    /// Ends the checks. What they found is of no use then.
    pub(crate) cancel: Option<&'a Cancel>,
}

/// Returns every problem of a scene, except those that were found in its tables and parts when they
/// were read. Expensive checks are skipped if their code is allowed. Stand-ins, given by their numbers in
/// ascending order, are skipped, as their faults have been reported.
pub(crate) fn problems(
    model: &Model,
    tables: &Tables,
    aspects: &Aspects,
    stand_ins: &[Ordinal],
    most: usize,
) -> (Vec<Problem>, Tally) {
    let is_part = aspects.is_part;
    let mut found = Found::new(most);
    found.cancel = aspects.cancel.cloned();
    found.is_lit = is_part || model.lights.is_some() || tables.lights().next().is_some();
    found.follows_paths = is_part || matches!(model.lighting, Some(LightingModel::Path(_)));
    if let Some(problem) = version(model.version) {
        found.push(problem);
        return (found.list, found.tally);
    }
    found.image(model.image.as_ref());
    found.cameras(model, is_part);
    if let Some(background) = &model.background {
        found.color(background, || Path::ROOT.field("background"));
    }
    found.backdrop(model);
    found.lights(model, tables);
    found.materials(model);
    found.unlit_fields(model);
    if let Some(outlines) = &model.outlines {
        let path = || Path::ROOT.field("outlines");
        outlines.each(|field, value| found.field(field, value, path));
    }
    if let Some(lighting) = &model.lighting {
        let path = || Path::ROOT.field("lighting");
        lighting.each(|field, value| found.field(field, value, path));
        if let LightingModel::Path(PathModel {
            filter: Some(filter),
            ..
        }) = lighting
        {
            let path = || path().field("filter");
            filter.each(|field, value| found.field(field, value, path));
        }
    }
    // Visibility is checked in the first frame; the places are those of the file.
    let frames = Frames::of(model);
    let first = frames.as_ref().map(|frames| frames.first(model));
    let start = first.as_ref().unwrap_or(model);
    let known = Known::default();
    let framing = Framing {
        subject: Subject::Scene(model, tables),
        frames: frames.as_ref(),
        known: &known,
        cancel: aspects.cancel,
    };
    let eyes = match is_part {
        true => Vec::new(),
        false => camera::eyes(start, &framing),
    };
    // Without moving geometries the copy has none.
    let moved = first.as_ref().filter(|first| !first.geometries.is_empty());
    let world = moved.unwrap_or(model);
    let mut surroundings = Surroundings::new(world, tables);
    let (mut named, mut copies) = (Vec::new(), Vec::new());
    let mut duplicates = Duplicates::of(model);
    let materials: HashSet<_> = model.names_of_materials().collect();
    let mut leaves = world.leaves().peekable();
    let warns_of_overlap =
        found.is_lit && aspects.levels.severity(Code::OverlappingGlass).is_some();
    let mut glass = Vec::new();
    let warns_of_inward = aspects.levels.severity(Code::OddMesh).is_some();
    let mut inward = warns_of_inward.then(Inward::new);
    // The end of the last solid with operands.
    let mut parts_until = Ordinal::default();
    for (at, geometry) in model.walk() {
        if found.is_cancelled() {
            break;
        }
        let leaf = leaves.next_if(|leaf| leaf.at == at);
        if let Some(leaf) = &leaf {
            duplicates.add(at, geometry, &leaf.placement);
            if warns_of_overlap {
                glass.extend(GlassSolid::of(leaf, model));
            }
        }
        let is_part = at < parts_until;
        let is_invalid = leaf
            .as_ref()
            .map_or(geometry.group().is_some() && !is_part, |leaf| {
                leaf.placement.transform().is_err()
            });
        if is_invalid && geometry.transform().is_some() && geometry.part().is_none() {
            found.placement(at, model);
        }
        if stand_ins.binary_search(&at).is_ok() {
            continue;
        }
        found.geometry(geometry, at, model);
        found.surface(geometry, model, &materials, (at, is_part), stand_ins);
        copies.extend(geometry.copies().map(|named| (at, named)));
        match geometry {
            GeometryModel::Mesh(mesh) => {
                if let Some(inward) = &mut inward
                    && is_glass(geometry, model)
                {
                    found.inward(mesh, at, model, inward);
                }
            }
            _ if geometry.operation().is_some() => {
                if !is_part {
                    parts_until = at.inside(geometry.total());
                    found.operands(geometry, at, model, &Placement::default());
                }
                found.solid(geometry, at, model);
                if !geometry.is_among(at, stand_ins) && !framing.moves(model, at) {
                    found.empty_solid(geometry, at, model);
                }
            }
            _ => {}
        }
        named.extend(geometry.name().map(|name| (at, name)));
        for (eye, leaf) in eyes.iter().filter_map(|eye| Some((eye, leaf.as_ref()?))) {
            found.eye(eye, leaf, &mut surroundings);
        }
    }
    found.extend(names::of(named, |at| model.path_of(at)));
    found.prototypes(copies, model);
    if !is_part {
        found.unlit(world, tables, frames.as_ref());
        if found.follows_paths && found.is_lit {
            found.lost_caustic(world, tables);
            if aspects.levels.severity(Code::NotAimed).is_some() {
                found.not_aimed(world, tables);
            }
        }
        found.places_of_lights(start.lights.as_deref(), world, tables, &eyes);
        found.empty_scene(model, tables);
    }
    found.allow(model.allow.as_deref().unwrap_or_default());
    found.duplicate_geometry(duplicates, model, &framing, stand_ins);
    found.overlapping_glass(glass, model, &framing);
    found.animation(model);
    // The frames of an animation with a fault are meaningless, and so is what is seen without all
    // geometries.
    let frames = frames.as_ref().filter(|_| !found.has_errors());
    if let Some(frames) = frames {
        found.frames(model, frames);
    }
    let fits = || start.all_cameras().any(|(_, camera)| camera.is_fit());
    let is_whole = || !aspects.files_have_errors && is_whole(model, tables);
    if !is_part && !found.has_errors() && fits() && is_whole() {
        found.framing(start, &framing);
    }
    let is_known = !is_part && (frames.is_some() || model.animation.is_none());
    let is_wanted = |code| is_known && aspects.levels.severity(code).is_some();
    if is_wanted(Code::NeverVisible) {
        found.never_visible(model, tables, &framing);
    }
    if is_wanted(Code::NothingVisible) && !is_empty(model, tables) {
        found.nothing_visible(model, tables, &framing);
    }
    (found.list, found.tally)
}

/// The problem of a scene of another version, which is reported alone.
pub(crate) fn version(version: Option<u32>) -> Option<Problem> {
    version.filter(|version| *version != Model::VERSION)?;
    let message = format!(
        "only version `{}` of the format is supported",
        Model::VERSION
    );
    let path = Path::ROOT.field("version");
    let problem = Problem::of_value(Code::UnsupportedVersion, path, message);
    let program = env!("CARGO_PKG_VERSION");
    Some(problem.help(format!(
        "this is strahl {program}; a newer one may read the file"
    )))
}

impl Found {
    fn image(&mut self, image: Option<&ImageModel>) {
        let Some(image) = image else { return };
        let path = Path::ROOT.field("image");
        image.each(|field, value| self.field(field, value, || path.clone()));
        self.samples(image.samples);
        let (width, height) = image.sides();
        let sides_are_fine = [width, height]
            .iter()
            .all(|side| (1..=Size::MAX_SIDE).contains(side));
        if sides_are_fine && Size::new(width, height).is_err() {
            let message = format!("a picture has at most 2^34 pixels, found {width} x {height}");
            // One of the two is given: the defaults alone are valid.
            let side = if image.height.is_some() {
                "height"
            } else {
                "width"
            };
            let problem = Problem::new(Code::OutOfRange, path.field(side), Focus::Value, message);
            self.push(problem);
        }
    }

    fn backdrop(&mut self, model: &Model) {
        let Some(backdrop) = &model.backdrop else {
            return;
        };
        let path = || Path::ROOT.field("backdrop");
        backdrop.each(|field, value| self.field(field, value, path));
        if model.background.is_some() && !self.tally.only_counts(Code::OneOf) {
            let problem = both(Code::OneOf, &Path::ROOT, ["background", "backdrop"]);
            self.push(
                problem.help("rays that hit nothing see one of them; leave the other one out"),
            );
        }
    }

    fn samples(&mut self, samples: Option<u32>) {
        if let Some(Err(error)) = samples.map(Samples::new) {
            let path = Path::ROOT.field("image").field("samples");
            let message = "`samples` must be a square of 1 to 64";
            let problem = Problem::of_value(Code::OutOfRange, path, message);
            self.push(problem.help(error.help()));
        }
    }

    fn allow(&mut self, names: &[WarningName]) {
        for (index, name) in names.iter().enumerate() {
            let WarningName::Unknown(name) = name else {
                continue;
            };
            if self.tally.only_counts(Code::UnknownVariant) {
                continue;
            }
            let path = Path::ROOT.field("allow").index(index);
            let warnings: Vec<_> = Code::WARNINGS.iter().map(|code| code.name()).collect();
            let message = match name.parse::<Code>() {
                Ok(error) if error.severity() == Severity::Error => {
                    format!("`{error}` is an error, which cannot be allowed")
                }
                Ok(_) => continue,
                Err(_) => unknown::message("warning", name, &warnings),
            };
            let problem = Problem::new(Code::UnknownVariant, path, Focus::Value, message);
            self.push(problem.help("remove it").meaning(name, &warnings));
        }
    }

    fn empty_scene(&mut self, model: &Model, tables: &Tables) {
        if is_empty(model, tables) {
            let path = Path::ROOT.field("geometries");
            let message = "the scene has no geometries: the picture is all background";
            self.push(Problem::new(Code::EmptyScene, path, Focus::Value, message));
        }
    }
}

/// Returns true if all tables, parts and meshes of a scene are read.
fn is_whole(model: &Model, tables: &Tables) -> bool {
    model.walk().all(|(at, geometry)| {
        let is_read = match geometry.mesh_file() {
            Some(file) => file.mesh.is_some(),
            None => tables.has(at),
        };
        geometry.file().is_none() || is_read
    })
}

/// Returns true if there is nothing to see: no geometries, or only tables, parts and groups without
/// any.
fn is_empty(model: &Model, tables: &Tables) -> bool {
    model.leaves().all(|leaf| tables.count(leaf.at) == 0)
}
