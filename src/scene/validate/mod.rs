//! Checks of a well-formed scene: one function per code, and none stops at the first fault.

mod animation;
mod camera;
mod eye;
mod instances;
mod light;
mod material;
mod names;
mod solid;
mod transform;
mod values;
mod visibility;

use std::collections::HashSet;

use glam::DVec3;

use crate::{
    diagnostic::{Code, Severity, levels::Levels, path::Path},
    film::{samples::Samples, size::Size},
    scene::{
        animation::frames::Frames,
        duplicates::Duplicates,
        format::{
            color::ColorModel,
            field::{Field, Fields, Interval, Kind, Range, Triple, Value},
            geometry::{
                GeometryModel, MeshModel,
                nesting::{Leaf, Ordinal},
            },
            image::ImageModel,
            lighting::LightingModel,
            scene::Model,
            warning::WarningName,
        },
        framing::{Framing, Known, Subject},
        problem::{Cure, Focus, Problem, Tally},
        surroundings::Surroundings,
        tables::Tables,
        validate::material::both,
    },
    text::nearest::{list, nearest, quote},
    tracer::vector::is_direction,
};

/// What the checks of a scene depend on besides the scene.
pub(crate) struct Aspects<'a> {
    pub(crate) levels: &'a Levels,
    /// True for a part of another scene, whose camera and lights are not known.
    pub(crate) is_part: bool,
}

/// Returns every problem of a scene, except those that were found in its tables and parts when they
/// were read. Expensive checks are skipped if their code is allowed. Stand-ins are skipped, as their
/// faults have been reported.
pub(crate) fn problems(
    model: &Model,
    tables: &Tables,
    aspects: &Aspects,
    stand_ins: &StandIns,
    most: usize,
) -> (Vec<Problem>, Tally) {
    let is_part = aspects.is_part;
    let mut found = Found::new(most);
    found.is_lit = is_part || model.lights.is_some() || tables.lights().next().is_some();
    if let Some(problem) = version(model.version) {
        found.push(problem);
        return (found.list, found.tally);
    }
    found.image(model.image.as_ref());
    found.cameras(model, is_part);
    if let Some(background) = &model.background {
        found.color(background, || Path::ROOT.field("background"));
    }
    found.lights(model);
    found.materials(model);
    found.unlit_fields(model);
    if let Some(outlines) = &model.outlines {
        let path = || Path::ROOT.field("outlines");
        outlines.each(|field, value| found.field(field, value, path));
    }
    if let Some(LightingModel::Direct(direct)) = &model.lighting {
        let path = || Path::ROOT.field("lighting");
        direct.each(|field, value| found.field(field, value, path));
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
    for (at, geometry) in model.walk() {
        let leaf = leaves.next_if(|leaf| leaf.at == at);
        if let Some(Leaf { placement, .. }) = &leaf {
            duplicates.add(at, geometry, placement);
        }
        if stand_ins.has(at) {
            continue;
        }
        found.geometry(geometry, at, model);
        found.surface(geometry, model, &materials, at);
        match geometry {
            GeometryModel::Instances(instances) => copies.push((at, &**instances)),
            _ if geometry.operation().is_some() => found.solid(geometry, at, model),
            _ => {}
        }
        named.extend(geometry.name().map(|name| (at, name)));
        for (eye, leaf) in eyes.iter().filter_map(|eye| Some((eye, leaf.as_ref()?))) {
            found.eye(eye, leaf, tables, model, &mut surroundings);
        }
    }
    found.extend(names::of(named, |at| model.path_of(at)));
    found.prototypes(copies, model);
    if !is_part {
        found.unlit(world, tables, frames.as_ref());
        found.places_of_lights(start.lights.as_deref(), world, tables, &eyes);
        found.empty_scene(model, tables);
    }
    found.allow(model.allow.as_deref().unwrap_or_default());
    found.duplicate_geometry(duplicates, model, frames.as_ref(), stand_ins);
    found.animation(model);
    // The frames of an animation with a fault are meaningless, and so is what is seen without all
    // geometries.
    let frames = frames.as_ref().filter(|_| !found.has_errors());
    if let Some(frames) = frames {
        found.frames(model, frames);
    }
    let fits = || start.all_cameras().any(|(_, camera)| camera.is_fit());
    if !is_part && !found.has_errors() && fits() && is_whole(model, tables) {
        found.framing(start, &framing);
    }
    let is_known = !is_part && (frames.is_some() || model.animation.is_none());
    let is_wanted = |code| is_known && aspects.levels.severity(code).is_some();
    if is_wanted(Code::NeverVisible) {
        found.never_visible(model, tables, frames, &framing);
    }
    if is_wanted(Code::NothingVisible) && !is_empty(model, tables) {
        found.nothing_visible(model, tables, frames);
    }
    (found.list, found.tally)
}

/// The numbers of the geometries that are stand-ins, in ascending order.
#[derive(Default)]
pub(crate) struct StandIns(pub(crate) Vec<Ordinal>);

impl StandIns {
    #[inline]
    fn has(&self, at: Ordinal) -> bool {
        self.0.binary_search(&at).is_ok()
    }
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

/// Collects problems. The functions are called for each of a million values, so paths are built
/// only for faults.
struct Found {
    list: Vec<Problem>,
    tally: Tally,
    /// True if lights may fall on the scene.
    is_lit: bool,
}

impl Found {
    /// Keeps at most this many problems of each code.
    fn new(most: usize) -> Self {
        Self {
            list: Vec::new(),
            tally: Tally::new(most),
            is_lit: false,
        }
    }

    fn push(&mut self, problem: Problem) {
        if self.tally.keeps(problem.code()) {
            self.list.push(problem);
        }
    }

    fn extend(&mut self, problems: impl IntoIterator<Item = Problem>) {
        for problem in problems {
            self.push(problem);
        }
    }

    fn has_errors(&self) -> bool {
        let mut codes = self.list.iter().map(Problem::code);
        codes.any(|code| code.severity() == Severity::Error)
    }

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

    fn samples(&mut self, samples: Option<u32>) {
        if let Some(Err(error)) = samples.map(Samples::new) {
            let path = Path::ROOT.field("image").field("samples");
            let message = "`samples` must be a square of 1 to 64";
            let problem = Problem::of_value(Code::OutOfRange, path, message);
            self.push(problem.help(error.help()));
        }
    }

    fn direction(&mut self, vector: DVec3, what: &str, path: impl Fn() -> Path) -> bool {
        let fine = is_direction(vector);
        if !fine {
            let length = if vector == DVec3::ZERO {
                "is 0"
            } else {
                "is 0 or not finite in an f64"
            };
            let message = format!("{what} has no direction, its squared length {length}");
            let problem = Problem::new(Code::ZeroVector, path(), Focus::Value, message);
            self.push(problem);
        }
        fine
    }

    fn geometry(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        let path = || model.path_of(at);
        geometry.each(|field, value| self.field(field, value, path));
        // The fields of a sphere have nothing to do with each other, and it may be one of a million.
        if !matches!(geometry, GeometryModel::Sphere(_)) {
            self.between_fields(geometry, at, model);
        }
    }

    fn between_fields(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        let path = || model.path_of(at);
        for clash in geometry.clashes() {
            if self.tally.only_counts(clash.code) {
                continue;
            }
            let place = path().field(clash.field);
            let place = clash
                .indices
                .iter()
                .fold(place, |place, index| place.index(*index));
            let problem = Problem::new(clash.code, place, Focus::Value, clash.message);
            self.push(problem.help(clash.help));
        }
        if let Some(transform) = geometry.transform() {
            self.transform(transform, &path().field("transform"));
            self.placement(transform, at, model);
        }
        if geometry
            .group()
            .is_some_and(|group| group.geometries.is_empty())
        {
            let message = "this has no effect: the group has no geometries";
            let place = path().field(Model::LONG);
            let problem = Problem::new(Code::NoEffect, place, Focus::Value, message);
            self.push(problem.help("add geometries to the group, or remove it"));
        }
        match geometry {
            GeometryModel::Mesh(mesh) => self.one_mesh(mesh, path),
            GeometryModel::Instances(instances) => self.instances(instances, at, model),
            _ => {}
        }
    }

    /// Checks that a mesh is in a file or in the scene.
    fn one_mesh(&mut self, mesh: &MeshModel, path: impl Fn() -> Path) {
        let given = (
            mesh.file.is_some(),
            mesh.vertices.is_some(),
            mesh.triangles.is_some(),
        );
        let twice = |field| {
            let problem = both(&path(), ["file", field]);
            problem.help("a mesh is in a file, or in the scene: leave one of them out")
        };
        let missing = |field| {
            let message = format!("missing field `{field}`");
            Problem::new(Code::MissingField, path(), Focus::Name, message)
                .help("a mesh in the scene has `vertices` and `triangles`")
        };
        let problem = match given {
            (false, true, true) if mesh.color_by.is_some() => {
                let message = "missing field `file`: `color_by` names a property of its vertices";
                Problem::new(Code::MissingField, path(), Focus::Name, message)
                    .help("put the mesh into a .ply file, or give it one `color`")
            }
            (true, false, false) | (false, true, true) => return,
            (true, true, _) => twice("vertices"),
            (true, false, true) => twice("triangles"),
            (false, true, false) => missing("triangles"),
            (false, false, true) => missing("vertices"),
            (false, false, false) => {
                let message = "neither `file` nor `vertices` is given, expected one of them";
                Problem::new(Code::OneOf, path(), Focus::Name, message)
                    .help("name a .ply, .obj or .stl `file`, or give `vertices` and `triangles`")
            }
        };
        self.push(problem);
    }

    /// Checks a value against the kind of its field.
    #[inline]
    fn field(&mut self, (name, kind): Field, value: Value, path: impl Fn() -> Path) {
        let is_fine = match value {
            Value::Number(number) => {
                number.is_finite() && kind.range().is_none_or(|range| range.holds(number))
            }
            Value::Vector(vector) => {
                kind != Kind::Direction && vector.iter().all(|number| number.is_finite())
            }
            Value::Interval([low, high]) => low.is_finite() && high.is_finite() && low < high,
            Value::Color(color) => matches!(color, ColorModel::Hex(_)),
        };
        if !is_fine {
            self.fault((name, kind), value, &path);
        }
    }

    /// Reports what is wrong with a value, if anything is.
    #[cold]
    fn fault(&mut self, (name, kind): Field, value: Value, path: &dyn Fn() -> Path) {
        let path = || path().field(name);
        match value {
            Value::Number(number) => self.number_of(kind, number, path, name),
            Value::Vector(vector) => {
                if self.finite(vector, path) && kind == Kind::Direction {
                    let what = format!("`{name}`");
                    self.direction(DVec3::from(*vector), &what, path);
                }
            }
            Value::Interval(range) => self.interval(range, name, path),
            Value::Color(color) => self.color(color, path),
        }
    }

    /// Checks a range.
    fn interval(&mut self, [low, high]: Interval, name: &str, path: impl Fn() -> Path) {
        let mut is_finite = true;
        for (index, number) in [low, high].into_iter().enumerate() {
            is_finite &= self.number(number, || path().index(index));
        }
        if !is_finite || low < high {
            return;
        }
        let message = format!("`{name}` must rise, found `{low}` to `{high}`");
        let problem = Problem::new(Code::OutOfRange, path(), Focus::Value, message);
        self.push(if low == high {
            problem.help("write the values of the first and the last color, such as (0, 1)")
        } else {
            problem.help(format!(
                "write `{high}` first, then `{low}`; to reverse the colors, list them in \
                 `map: Colors([…])`"
            ))
        });
    }

    /// Checks one number against a kind.
    fn number_of(&mut self, kind: Kind, number: f64, path: impl Fn() -> Path, name: &str) {
        let is_wrong = |range: &Range| !range.holds(number);
        let is_finite = self.number(number, &path);
        let range = kind.range().filter(|range| is_finite && is_wrong(range));
        let Some(range) = range.filter(|_| !self.tally.only_counts(Code::OutOfRange)) else {
            return;
        };
        let message = format!("`{name}` must be {range}");
        let problem = Problem::of_value(Code::OutOfRange, path(), message);
        self.push(match kind {
            Kind::Angle if name == "fov" => problem.help(format!(
                "`{name}` is the full vertical angle of view, in degrees"
            )),
            _ => problem,
        });
    }

    fn number(&mut self, number: f64, path: impl Fn() -> Path) -> bool {
        if !number.is_finite() && !self.tally.only_counts(Code::NotFinite) {
            let problem = Problem::of_value(Code::NotFinite, path(), "expected a finite number");
            let largest = "numbers are finite 64-bit floats, up to about 1.8e308";
            self.push(problem.help(largest));
        }
        number.is_finite()
    }

    fn finite(&mut self, vector: &Triple, path: impl Fn() -> Path) -> bool {
        let mut finite = true;
        for (index, number) in vector.iter().enumerate() {
            finite &= self.number(*number, || path().index(index));
        }
        finite
    }

    fn color(&mut self, color: &ColorModel, path: impl Fn() -> Path) {
        match color {
            ColorModel::Hex(_) => {}
            ColorModel::Channels(channels) => {
                for (index, channel) in channels.iter().enumerate() {
                    let path = || path().index(index);
                    let is_wrong = self.number(*channel, path) && !(0.0..=1.0).contains(channel);
                    if is_wrong && !self.tally.only_counts(Code::ColorClamped) {
                        self.push(color_clamped(channels, path()));
                    }
                }
            }
            ColorModel::Invalid(text) => self.push(invalid_color(text, path())),
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
                Err(_) => {
                    let known = list(&warnings);
                    format!("unknown warning {}, expected one of {known}", quote(name))
                }
            };
            let problem = Problem::new(Code::UnknownVariant, path, Focus::Value, message);
            self.push(match nearest(name, &warnings) {
                Some(name) => problem
                    .help(format!("did you mean `{name}`?"))
                    .cure(Cure::Write(format!("\"{name}\""))),
                None => problem.help("remove it"),
            });
        }
    }

    fn empty_scene(&mut self, model: &Model, tables: &Tables) {
        if is_empty(model, tables) {
            let path = Path::ROOT.field("geometries");
            let message = "the scene has no geometries: the picture is all background";
            self.push(Problem::new(Code::EmptyScene, path, Focus::Value, message));
        }
    }

    fn duplicate_geometry(
        &mut self,
        duplicates: Duplicates,
        model: &Model,
        frames: Option<&Frames>,
        stand_ins: &StandIns,
    ) {
        // A moving geometry separates from its duplicate.
        let moves = |at| frames.is_some_and(|frames| frames.move_leaf(model, at));
        for (first, at) in duplicates.found(model) {
            if stand_ins.has(first) || stand_ins.has(at) {
                continue;
            }
            let geometry = model.geometry(at);
            let Some(geometry) = geometry.filter(|_| !moves(first) && !moves(at)) else {
                continue;
            };
            let place = model.path_of(first);
            let named = model.geometry(first).and_then(GeometryModel::name);
            let named = named.map_or_else(String::new, |name| format!(" ({})", quote(name)));
            let message = format!("equal to `{place}`{named}, which hides it");
            // Tracks refer to geometries by index, so a removal would shift them.
            let is_needless = frames.is_none() && geometry.name().is_none();
            let problem = Problem::new(
                Code::DuplicateGeometry,
                model.path_of(at),
                Focus::Name,
                message,
            );
            self.push(
                problem
                    .help("remove one of the two; at equal distance the first is visible")
                    .cure(is_needless.then_some(Cure::Remove))
                    .label(place, Focus::Name, "the first of them"),
            );
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

fn clamped(path: Path) -> Problem {
    let message = "a color channel is clamped to 0..1";
    Problem::of_value(Code::ColorClamped, path, message)
}

fn color_clamped(channels: &Triple, path: Path) -> Problem {
    let problem = clamped(path);
    let is_byte = |channel: &f64| (0.0..=255.0).contains(channel) && channel.fract() == 0.0;
    if channels.iter().all(is_byte) {
        let [r, g, b] = channels.map(|channel| channel as u8);
        let hex = format!("\"#{r:02x}{g:02x}{b:02x}\"");
        let problem = problem.help(format!("8-bit values? write `{hex}`, or divide by 255"));
        // Small numbers may be light meant to be bright.
        problem.cure((r.max(g).max(b) >= 32).then_some(Cure::WriteAround(hex)))
    } else {
        problem
    }
}

fn invalid_color(text: &str, path: Path) -> Problem {
    let shown: String = text.chars().take(40).collect();
    let message = match &*shown {
        "" => "an empty string is not a color".to_owned(),
        shown => format!("`{}` is not a color", shown.escape_debug()),
    };
    let digits = text.strip_prefix('#').unwrap_or(text);
    let hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let is_bare = hex && matches!(digits.len(), 3 | 6);
    let problem = Problem::new(Code::InvalidColor, path, Focus::Value, message)
        .cure(is_bare.then(|| Cure::Write(format!("\"#{digits}\""))));
    problem.help(match digits.len() {
        8 if hex => format!("a color has no alpha: write `#{}`", &digits[..6]),
        4 if hex => format!("a color has no alpha: write `#{}`", &digits[..3]),
        3 | 6 if hex => format!("write `#{digits}`"),
        _ if !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphabetic()) => {
            "color names are not supported; write `#rrggbb`, `#rgb` or three numbers in 0..1"
                .to_owned()
        }
        _ => "write `#rrggbb`, `#rgb` or three numbers in 0..1".to_owned(),
    })
}
