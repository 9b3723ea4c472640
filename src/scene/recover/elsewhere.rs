//! Fields by which other programs describe a shape, and what only other programs have.

use crate::{
    diagnostic::Fix,
    scene::recover::text::{Text, name_of},
    text::{
        edit::Edit,
        syntax::{NodeId, NodeKind, float},
    },
};

/// What is meant by a field: the help, its fix, and the field that it stands for.
pub(super) struct Meant {
    pub(super) help: String,
    pub(super) fix: Option<Fix>,
    pub(super) field: Option<&'static str>,
}

/// Returns what is meant by a field of `owner` that is not one of `known`, if other programs have it.
pub(super) fn field(
    document: Text<'_>,
    owner: NodeId,
    spelt: &str,
    known: &[&'static str],
) -> Option<Meant> {
    let has = |fields: &[&str]| fields.iter().all(|field| known.contains(field));
    let value = |names: &[&str]| {
        let mut fields = document.tree.fields(owner);
        fields.find(|(key, _)| names.contains(&&*name_of(document.text, document.tree, *key)))
    };
    let meant = |help: &str, fix, field| {
        Some(Meant {
            help: help.to_owned(),
            fix,
            field,
        })
    };
    let syntax = document.tree.syntax();
    let (middle, sides) = (["center", "position"], ["size", "side", "dimensions"]);
    let heights = ["height", "length"];
    if has(&["min", "max"]) && (middle.contains(&spelt) || sides.contains(&spelt)) {
        let is_first = middle.contains(&spelt);
        let pair = value(&middle).zip(value(&sides)).filter(|_| is_first);
        let fix = pair.and_then(|pair| corners(document, pair, ["min", "max"], |size| size));
        let help =
            "write two opposite corners, `min` and `max`: center - size / 2 and center + size / 2";
        return meant(help, fix, Some(if is_first { "min" } else { "max" }));
    }
    if has(&["from", "to", "radius"]) && (middle.contains(&spelt) || heights.contains(&spelt)) {
        let is_first = middle.contains(&spelt);
        let pair = value(&middle).zip(value(&heights)).filter(|_| is_first);
        let along = |[_, height, _]: [f64; 3]| [0.0, height, 0.0];
        let fix = pair.and_then(|pair| corners(document, pair, ["from", "to"], along));
        let help = "write the centers of both ends, `from` and `to`; for a cylinder along y, these are \
                    height / 2 below and above its center";
        return meant(help, fix, Some(if is_first { "from" } else { "to" }));
    }
    if has(&["point", "normal"]) && ["distance", "offset", "constant"].contains(&spelt) {
        let help =
            "write any point of the plane as `point`, such as the distance times the unit normal";
        return meant(help, None, Some("point"));
    }
    let moves = ["translate", "rotate", "scale"];
    if has(&["transform"]) && moves.contains(&spelt) {
        let others = moves.iter().filter(|name| value(&[name]).is_some()).count();
        let alone = value(&[spelt]).filter(|_| others == 1 && value(&["transform"]).is_none());
        let fix = alone.map(|(key, value)| {
            let end = document.tree.node(value).range().end;
            let start = document.tree.node(key).range().start;
            let [open, close] = syntax.brackets();
            let open = syntax.key("transform") + open;
            Fix::safe([Edit::insert(start, open), Edit::insert(end, close)])
        });
        let inside = syntax.object(&(syntax.key(spelt) + "…"));
        let key = syntax.key("transform");
        let help = format!("write it in the transform: `{key}{inside}`");
        return meant(&help, fix, None);
    }
    if spelt == "texture" && has(&["transform"]) {
        let help = match has(&["color"]) {
            true => "solids of several parts show no texture; remove it",
            false => "write it in the geometries themselves",
        };
        return meant(help, None, None);
    }
    // A movie may be meant to repeat.
    let is_movie = has(&["frames"]);
    let absent = absent(spelt).filter(|_| !is_movie);
    let is_texture = has(&["texture"]) && TEXTURES.split(' ').any(|name| name == spelt);
    absent.and_then(|help| meant(&help, None, is_texture.then_some("texture")))
}

/// Returns the fix that replaces a center and a size by two points.
fn corners(
    document: Text<'_>,
    (middle, apart): ((NodeId, NodeId), (NodeId, NodeId)),
    names: [&str; 2],
    along: impl Fn([f64; 3]) -> [f64; 3],
) -> Option<Fix> {
    let (center, size) = (
        numbers(document, middle.1)?,
        along(numbers(document, apart.1)?),
    );
    let edits =
        [(middle, names[0], -0.5), (apart, names[1], 0.5)].map(|((key, value), name, half)| {
            let [key, value] = [key, value].map(|id| document.tree.node(id).range());
            let range = key.start..value.end;
            let point = center
                .iter()
                .zip(size)
                .map(|(center, size)| center + half * size);
            let point: Vec<_> = point.map(|number| number.to_string()).collect();
            let point = point.join(", ");
            let has_comments = !document.tree.comments_in(range.clone()).is_empty();
            let syntax = document.tree.syntax();
            let text = syntax.key(name) + &syntax.tuple(&point);
            (!has_comments).then(|| Edit::replace(range, text))
        });
    let [Some(one), Some(other)] = edits else {
        return None;
    };
    let mut edits = [one, other];
    edits.sort_by_key(|edit| edit.range.start);
    Some(Fix::safe(edits))
}

/// Returns three finite numbers; a single one stands for three that are equal.
fn numbers(document: Text<'_>, id: NodeId) -> Option<[f64; 3]> {
    let tree = document.tree;
    let number = |id| {
        let number = float(document.source(id), tree.syntax()).ok()?;
        (tree.node(id).kind() == NodeKind::Number && number.is_finite()).then_some(number)
    };
    match tree.node(id).kind() {
        NodeKind::Number => number(id).map(|number| [number; 3]),
        NodeKind::Tuple | NodeKind::List if tree.node(id).name().is_none() => {
            let all: Option<Vec<_>> = tree.children(id).map(number).collect();
            all?.try_into().ok()
        }
        _ => None,
    }
}

/// Names of textures in other programs.
const TEXTURES: &str = "texture textures pigment finish uv image_map checker";

/// Names of what only other programs have, in lower case, with the nearest way here.
const ABSENT: &[(&str, &str)] = &[
    (
        "prism lathe heightfield height_field blob bicubic_patch nurbs isosurface text superellipsoid \
         julia_fractal sor",
        "this shape is not supported; export it as a PLY, OBJ or STL file and use `Mesh(file: …)`",
    ),
    (
        TEXTURES,
        "a texture stands beside a color or in a material: `texture: Checker()`, or `Image(file: …)` in place of `Checker()`",
    ),
    (
        "normal_map bump bump_map",
        "only colors have textures; remove it",
    ),
    (
        "gltf glb fbx usd collada dae blend 3ds",
        "this file format is not supported; convert the file to PLY, OBJ or STL and use `Mesh(file: …)`",
    ),
    (
        "for while loop repeat array if macro declare define let var",
        "loops and variables are not supported; use `Instances`, a table, or write the file with a script",
    ),
    (
        "area_light arealight rectarealight hemispherelight quadlight",
        "lights with a size are a `Point` or `Spot` with a `radius`, a `Directional` with an `angle`, or an `Emissive` \
         geometry, under `lighting: Path()`",
    ),
    (
        "environment fog media volume atmosphere",
        "the surroundings are a color, `background`, or a sky or a picture, `backdrop`; they shine as the light \
         `Environment` under `lighting: Path()`; fog is not supported",
    ),
    (
        "focal_blur dof depth_of_field",
        "depth of field is `aperture` of a `Perspective` camera, under `lighting: Path()`",
    ),
    (
        "shutter motion_blur",
        "motion blur is not supported; remove it",
    ),
    (
        "near far near_clip far_clip clip_start clip_end",
        "nothing is clipped; remove it",
    ),
    (
        "aspect aspect_ratio right",
        "the aspect ratio is that of the picture: `width` and `height` of `image`",
    ),
    (
        "global_settings max_trace_level max_bounces",
        "the depth of reflections is `max_depth` of `lighting`",
    ),
];

/// Returns the help for something that only other programs have.
pub(super) fn absent(spelt: &str) -> Option<String> {
    let name = spelt.to_ascii_lowercase();
    let name = name.trim_start_matches('#');
    let mut absent = ABSENT.iter();
    let (_, help) = absent.find(|(names, _)| names.split(' ').any(|other| other == name))?;
    Some(format!("{help}; see {PAGE}"))
}

/// The page about other programs.
const PAGE: &str = concat!(
    env!("CARGO_PKG_REPOSITORY"),
    "/blob/v",
    env!("CARGO_PKG_VERSION"),
    "/docs/coming-from.md"
);
