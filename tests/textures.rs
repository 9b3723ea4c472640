//! Textures beside the color of a geometry: the same world and the same picture as in a `Matte` material.

use std::fs;

use strahl::{
    Document, ErrorKind, ReadOptions, Scene, Syntax,
    scene::{Memory, Setting},
};

/// The meshes and pictures of golden scenes.
const FOLDER: &str = "tests/golden/textures";

/// Geometries, without their surfaces.
const KINDS: &[&str] = &[
    "Plane(point: (0, -1, 0), normal: (0, 1, 0), ",
    "Sphere(center: (0, 0, 0), radius: 1, ",
    "Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 1, ",
    "Rectangle(corner: (-1, -1, 0), edge_u: (2, 0, 0), edge_v: (0, 2, 0), ",
    "Triangle(a: (-1, -1, 0), b: (1, -1, 0), c: (0, 1, 0), ",
    "Box(min: (-1, -1, -1), max: (1, 1, 1), ",
    "Cylinder(from: (0, -1, 0), to: (0, 1, 0), radius: 1, ",
    "Cone(from: (0, -1, 0), to: (0, 1, 0), radius: 1, ",
    "Capsule(from: (0, -1, 0), to: (0, 1, 0), radius: 0.5, ",
    "Ellipsoid(center: (0, 0, 0), axes: [(1, 0, 0), (0, 0.8, 0), (0, 0, 0.6)], ",
    "Torus(center: (0, 0, 0), axis: (0, 0.6, 0.8), radius: 0.8, tube_radius: 0.4, ",
    "Mesh(file: \"meshes/crate.obj\", ",
    "Spheres(file: \"balls.csv\", radius: 1, ",
    "Spheres(file: \"colored.csv\", radius: 1, ",
    "Cylinders(file: \"rods.csv\", radius: 1, ",
];

const TEXTURES: [&str; 2] = [
    "Checker(size: 0.1)",
    "Image(file: \"pictures/corners.png\", mapping: Planar(origin: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0.5)))",
];

/// The parts of a scene that determine how it is lit, if it is.
const LIGHTINGS: [&str; 3] = [
    "",
    "lights: [Headlight()],",
    "lights: [Ambient()], lighting: Path(samples: 2),",
];

fn document(lighting: &str, geometries: &str) -> Document {
    let text = format!(
        "(image: (width: 32, height: 24), camera: Perspective(eye: (1, 2, 5), look_at: (0, 0, 0), \
         fov: 40), {lighting} geometries: [{geometries}])"
    );
    let files = Memory::new()
        .with(format!("{FOLDER}/balls.csv"), "x,y,z\n0,0,0\n1,0,-1\n")
        .with(
            format!("{FOLDER}/colored.csv"),
            "x,y,z,color\n0,0,0,#ff0000\n1,0,-1,\n",
        )
        .with(
            format!("{FOLDER}/rods.csv"),
            "x1,y1,z1,x2,y2,z2\n0,-1,0,0,1,0\n",
        );
    let options = ReadOptions::new()
        .syntax(Syntax::Ron)
        .folder(FOLDER)
        .files(files);
    Document::from_reader("scene", text.as_bytes(), &options).unwrap()
}

#[track_caller]
fn scene(lighting: &str, geometries: &str) -> Scene {
    let document = document(lighting, geometries);
    assert_eq!(document.diagnostics(), [], "{geometries}");
    document.try_into().unwrap()
}

#[test]
fn a_texture_beside_a_color_is_that_of_a_matte_material() {
    for lighting in LIGHTINGS {
        for kind in KINDS {
            let picture = |surface: &str| {
                let scene = scene(lighting, &format!("{kind}{surface})"));
                let pixels = scene.render().unwrap().pixels().to_vec();
                (scene.world().clone(), pixels)
            };
            let (_, plain) = picture("color: \"#f80\"");
            for texture in TEXTURES {
                let (world, pixels) = picture(&format!("color: \"#f80\", texture: {texture}"));
                assert!(pixels != plain, "{kind}");
                let material = format!("material: Matte(color: \"#f80\", texture: {texture})");
                assert!((world, pixels) == picture(&material), "{kind}");
                let material = format!("material: Matte(texture: {texture})");
                let (world, pixels) = picture(&format!("texture: {texture}"));
                assert!((world, pixels) == picture(&material), "{kind}");
            }
        }
    }
}

#[test]
fn a_texture_stays_in_groups_and_copies() {
    for texture in TEXTURES {
        let list = |surface: &str| {
            scene(
                "",
                &format!(
                    "Group(transform: (rotate: (axis: (0, 1, 0), angle: 30), scale: (1, 2, 1)), geometries: [
                         Sphere(center: (0, 0, 0), radius: 1, {surface}, transform: (scale: 0.5), name: \"ball\"),
                     ]),
                     Instances(of: \"ball\", transforms: [(translate: (2, 0, 0))])"
                ),
            )
        };
        let beside = list(&format!("texture: {texture}"));
        let inside = list(&format!("material: Matte(texture: {texture})"));
        assert_eq!(beside.world(), inside.world());
        assert_eq!(
            beside.render().unwrap().pixels(),
            inside.render().unwrap().pixels()
        );
    }
}

#[test]
fn the_picture_of_a_part_is_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("parts")).unwrap();
    let picture = format!("{FOLDER}/pictures/corners.png");
    fs::copy(&picture, path("parts/corners.png")).unwrap();
    fs::write(
        path("scene.ron"),
        "(camera: Perspective(eye: (1, 2, 5), look_at: (0, 0, 0), fov: 40), image: (width: 32, height: 24),
          geometries: [Part(file: \"parts/ball.ron\", transform: (scale: 2))])",
    )
    .unwrap();
    let part = |surface: &str| {
        let text = format!("(geometries: [Sphere(center: (0, 0, 0), radius: 0.5, {surface})])");
        fs::write(path("parts/ball.ron"), text).unwrap();
        Scene::from_path(path("scene.ron"))
    };
    let beside = part("texture: Image(file: \"corners.png\")").unwrap();
    let inside = part("material: Matte(texture: Image(file: \"corners.png\"))").unwrap();
    assert_eq!(beside.world(), inside.world());
    assert_ne!(
        beside.world(),
        part("color: \"#fff\"").unwrap().world(),
        "the picture is read"
    );
    // It is one of the files that the scene depends on.
    let depends = |surface: &str| {
        drop(part(surface));
        let options = ReadOptions::new();
        let document = Document::from_path_with(path("scene.ron"), &options).unwrap();
        let mut files = document.dependencies().into_iter();
        files.any(|file| file.path.ends_with("corners.png"))
    };
    assert!(depends("texture: Image(file: \"corners.png\")"));
    assert!(!depends("color: \"#fff\""));
    fs::remove_file(path("parts/corners.png")).unwrap();
    let missing = part("texture: Image(file: \"corners.png\")").unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::Scene);
}

#[test]
fn values_reach_into_a_texture() {
    let text =
        |surface: &str| format!("Sphere(center: (0, 0, 0), radius: 1, {surface}, name: \"ball\")");
    let set = |surface: &str, setting: &str| -> Result<Scene, _> {
        let setting: Setting = setting.parse().unwrap();
        document("", &text(surface)).with([setting]).try_into()
    };
    let expected = scene("", &text("color: \"#f80\", texture: Checker(size: 0.25)"));
    let plain = "color: \"#f80\"";
    let checker = "color: \"#f80\", texture: Checker()";
    for (surface, setting) in [
        (checker, "geometries.ball.texture.size=0.25"),
        (checker, "geometries[0].texture=Checker(size: 0.25)"),
        (plain, "geometries.ball.texture=Checker(size: 0.25)"),
    ] {
        let found = set(surface, setting).unwrap();
        assert_eq!(found.world(), expected.world(), "{setting}");
    }
    let none = set(checker, "geometries.ball.texture=null").unwrap();
    assert_eq!(none.world(), scene("", &text(plain)).world());
    assert!(set("material: Mirror()", "geometries.ball.texture=Checker()").is_err());
}

#[test]
fn a_texture_changes_over_time() {
    let animated = |surface: &str, place: &str| {
        let animation = format!(
            "animation: (fps: 1, frames: 3, tracks: {{\"{place}.size\": [(0, 1), (2, 0.5)]}}),"
        );
        scene(
            &animation,
            &format!("Sphere(center: (0, 0, 0), radius: 1, {surface})"),
        )
    };
    let beside = animated(
        "color: \"#f80\", texture: Checker()",
        "geometries[0].texture",
    );
    let inside = animated(
        "material: Matte(color: \"#f80\", texture: Checker())",
        "geometries[0].material.texture",
    );
    for frame in 0..3 {
        let [beside, inside] = [&beside, &inside].map(|scene| scene.frame(frame).unwrap());
        assert_eq!(beside.world(), inside.world(), "{frame}");
    }
    assert_ne!(
        beside.frame(0).unwrap().world(),
        beside.frame(2).unwrap().world()
    );
}

#[test]
fn both_syntaxes_keep_a_texture() {
    let text = "Sphere(center: (0, 0, 0), radius: 1, color: \"#f80\", texture: Checker(size: 0.5), \
                transform: (scale: 2), name: \"ball\")";
    let json = document("", text).convert(Syntax::Json).unwrap().text;
    let texture = json.find("\"texture\"").unwrap();
    assert!(
        json.find("\"color\"").unwrap() < texture && texture < json.find("\"transform\"").unwrap()
    );
    let back = Document::from_text("scene", json, Syntax::Json);
    assert_eq!(back.diagnostics(), []);
    let back = back.convert(Syntax::Ron).unwrap().text;
    assert_eq!(back, document("", text).convert(Syntax::Ron).unwrap().text);
}
