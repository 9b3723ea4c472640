//! Meshes from files: the same world and the same picture as meshes in the scene.

use std::fs;

use strahl::{
    Document, ErrorKind, ReadOptions, Scene, Shape, Syntax,
    diagnostic::Code,
    jobs::{Checked, Configs, check_files, find_scenes},
    scene::Memory,
};

/// The meshes of the cases: a cube in each format.
const FOLDER: &str = "tests/valid/meshes";

fn read(geometries: &str) -> Document {
    let text = format!(
        "(image: (width: 48, height: 36), camera: Perspective(eye: (2, 3, 5), look_at: (0, 0, 0), \
         fov: 60), geometries: [{geometries}])"
    );
    let options = ReadOptions::new().syntax(Syntax::Ron).folder(FOLDER);
    Document::from_reader("scene", text.as_bytes(), &options).unwrap()
}

fn scene(geometries: &str) -> Scene {
    let document = read(geometries);
    assert_eq!(document.diagnostics(), [], "{geometries}");
    document.try_into().unwrap()
}

const CUBE: &str = "Mesh(
    vertices: [
        (-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1),
        (-1, -1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, 1),
    ],
    triangles: [
        (0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
        (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5),
    ],
    color: \"#f80\",
)";

#[test]
fn meshes_of_files_equal_those_in_the_scene() {
    let listed = scene(CUBE);
    for name in ["cube.ply", "big-endian.ply", "cube.obj"] {
        let found = scene(&format!("Mesh(file: \"{name}\", color: \"#f80\")"));
        assert_eq!(found.world(), listed.world(), "{name}");
    }
    let expected = listed.render().unwrap();
    for name in ["cube.stl", "binary.stl", "cube.ply"] {
        let found = scene(&format!("Mesh(file: \"{name}\", color: \"#f80\")"));
        let [geometry] = found.world().geometries() else {
            panic!("a mesh is one geometry");
        };
        let Shape::Mesh(mesh) = geometry.shape() else {
            panic!("a mesh");
        };
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, 12));
        assert_eq!(
            found.render().unwrap().pixels(),
            expected.pixels(),
            "{name}"
        );
    }
}

#[test]
fn a_file_is_read_once() {
    let twice = "Mesh(file: \"cube.ply\", color: \"#f80\"),
        Mesh(file: \"cube.ply\", color: \"#08f\")";
    let document = read(twice);
    let codes: Vec<_> = document
        .diagnostics()
        .iter()
        .map(|each| each.code)
        .collect();
    assert_eq!(codes, [Code::DuplicateGeometry]);
    let scene: Scene = document.try_into().unwrap();
    let meshes = scene.world().geometries().iter();
    let meshes: Vec<_> = meshes
        .map(|geometry| match geometry.shape() {
            Shape::Mesh(mesh) => std::sync::Arc::as_ptr(mesh),
            _ => panic!("a mesh"),
        })
        .collect();
    assert_eq!(meshes[0], meshes[1]);
}

#[test]
fn a_document_without_files_reads_them_when_rendered() {
    let files = find_scenes(
        &["tests/valid/mesh-files.ron".into()],
        &[],
        &Configs::none(),
    );
    let mut scenes: Vec<Scene> = Vec::new();
    check_files(&files.unwrap(), &ReadOptions::new(), 1, |checked| {
        let Checked::Document(_, document) = checked else {
            panic!("it can be read");
        };
        scenes.push(document.try_into()?);
        Ok::<(), strahl::Error>(())
    })
    .unwrap();
    assert_eq!(scenes[0].world().geometries().len(), 6);

    // Read without its mesh: it has no faults until it is used.
    let options = ReadOptions::new().without_tables();
    let path = "tests/invalid/invalid-mesh/corner-of-obj.ron";
    let document = Document::from_path_with(path, &options).unwrap();
    assert_eq!(document.diagnostics(), []);
    let error = Scene::try_from(document).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Scene);
    assert!(error.to_string().contains("error[invalid-mesh]"), "{error}");
}

#[test]
fn a_scene_depends_on_its_meshes() {
    let document = Document::from_path("tests/valid/mesh-files.ron").unwrap();
    let files = document.dependencies().into_iter();
    let names: Vec<_> = files.map(|file| file.path.display().to_string()).collect();
    for name in [
        "cube.ply",
        "big-endian.ply",
        "cube.obj",
        "cube.stl",
        "binary.stl",
    ] {
        let path = format!("{FOLDER}/{name}");
        assert_eq!(
            names.iter().filter(|found| **found == path).count(),
            1,
            "{names:?}"
        );
    }
}

#[test]
fn a_changed_mesh_changes_the_world() {
    let scene = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
        geometries: [Mesh(file: \"a.obj\", color: \"#f00\")])";
    let read = |mesh: &str| {
        let files = Memory::new().with("mine.ron", scene).with("a.obj", mesh);
        let options = ReadOptions::new().files(files);
        Scene::try_from(Document::from_path_with("mine.ron", &options).unwrap()).unwrap()
    };
    let one = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let other = read("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    assert_ne!(one.world(), other.world());
    assert_ne!(
        one.render().unwrap().pixels(),
        other.render().unwrap().pixels()
    );
}

#[test]
fn values_of_vertices_are_those_of_the_scene() {
    let camera = "camera: Perspective(eye: (2, 3, 5), look_at: (0, 0, 0), fov: 60)";
    let part = "(geometries: [
        Mesh(file: \"colors.obj\"),
        Mesh(file: \"values.ply\", color_by: (column: \"z\", range: (-1, 1)), name: \"inner\"),
    ])";
    let text = format!(
        "({camera}, geometries: [
            Spheres(file: \"values.ply\", radius: 1, color_by: (column: \"y\")),
            Group(geometries: [
                Mesh(file: \"values.ply\", color_by: (column: \"energy\"), name: \"one\"),
            ]),
            Part(file: \"part.ron\", name: \"other\"),
        ])"
    );
    let of_disk = |name: &str| fs::read(format!("{FOLDER}/{name}")).unwrap();
    let files = Memory::new()
        .with("mine.ron", text)
        .with("part.ron", part)
        .with("values.ply", of_disk("values.ply"))
        .with("colors.obj", of_disk("colors.obj"));
    let options = ReadOptions::new().files(files);
    let document = Document::from_path_with("mine.ron", &options).unwrap();
    let scene = Scene::try_from(document).unwrap();
    let all: Vec<_> = scene.color_values().collect();
    let columns: Vec<_> = all.iter().map(|values| &*values.scale.column).collect();
    assert_eq!(columns, ["y", "energy", "z"]);
    let [_, one, other] = &all[..] else {
        panic!("three have values");
    };
    assert_eq!((one.name, one.missing), (Some("one"), 1));
    assert_eq!(one.data, Some([-2.0, 3.0]));
    assert_eq!(one.origin.to_string(), "geometries[1].geometries[0]");
    assert_eq!((other.name, other.data), (Some("other"), Some([1.0, 1.0])));
    let part = other.part.as_ref().unwrap();
    assert_eq!((part.name, part.origin.geometry), (Some("inner"), 1));
}

#[test]
fn faces_have_their_colors() {
    let colored = |name: &str, red: u8| {
        let scene = format!(
            "(image: (width: 32, height: 16), camera: Orthographic(eye: (1, 0.5, 5), gaze: (0, 0, -1), \
             scale: 0.5), geometries: [Mesh(file: \"{name}\")])"
        );
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty \
             float z\nelement face 2\nproperty list uchar int vertex_index\nproperty uchar red\nproperty \
             uchar green\nproperty uchar blue\nend_header\n0 0 0\n1 0 0\n2 0 0\n2 1 0\n1 1 0\n0 1 0\n4 \
             0 1 4 5 {red} 0 0\n4 1 2 3 4 0 0 255\n"
        );
        let files = Memory::new().with("mine.ron", scene).with(name, ply);
        let options = ReadOptions::new().files(files);
        let document = Document::from_path_with("mine.ron", &options).unwrap();
        assert_eq!(document.diagnostics(), []);
        Scene::try_from(document).unwrap()
    };
    let scene = colored("a.ply", 200);
    let picture = scene.render().unwrap();
    let row = [[[200, 0, 0]; 16].concat(), [[0, 0, 255]; 16].concat()].concat();
    assert!(picture.pixels().chunks(row.len()).all(|each| each == row));
    assert!(colored("a.ply", 201).world() != scene.world());
}

#[test]
fn changed_colors_of_vertices_change_the_world() {
    let world = |fields: &str, red: &str, energy: &str| {
        let scene = format!(
            "(camera: Orthographic(eye: (0, 0, 5), gaze: (0, 0, -1), scale: 3),
            geometries: [Mesh(file: \"a.ply\", {fields})])"
        );
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty \
             float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float \
             energy\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 {red} 0 0 \
             1\n1 0 0 0 0 0 {energy}\n0 1 0 0 0 0 3\n3 0 1 2\n"
        );
        let files = Memory::new().with("mine.ron", scene).with("a.ply", ply);
        let options = ReadOptions::new().files(files);
        let document = Document::from_path_with("mine.ron", &options).unwrap();
        let scene = Scene::try_from(document).unwrap();
        (
            scene.world().clone(),
            scene.render().unwrap().pixels().to_vec(),
        )
    };
    let by = "color_by: (column: \"energy\", range: (0, 4))";
    for (fields, shows_colors, shows_values) in [
        ("", true, false),
        (by, false, true),
        ("color: \"#fff\"", false, false),
    ] {
        let before = world(fields, "10", "2");
        assert!(world(fields, "10", "2") == before, "{fields}");
        assert_eq!(world(fields, "90", "2") != before, shows_colors, "{fields}");
        assert_eq!(world(fields, "10", "1") != before, shows_values, "{fields}");
    }
}

#[test]
fn a_million_triangles_are_read_completely() {
    let folder = tempfile::tempdir().unwrap();
    let side = 708_u32;
    let (vertices, squares) = (side * side, (side - 1) * (side - 1));
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\n\
         property float y\nproperty double z\nelement face {squares}\nproperty list uchar uint \
         vertex_indices\nend_header\n"
    )
    .into_bytes();
    for number in 0..vertices {
        let (x, y) = (number % side, number / side);
        bytes.extend((x as f32).to_le_bytes());
        bytes.extend((y as f32).to_le_bytes());
        bytes.extend((f64::from(x * y) / 3.0).to_le_bytes());
    }
    for square in 0..squares {
        let first = square / (side - 1) * side + square % (side - 1);
        bytes.push(4);
        for corner in [first, first + 1, first + side + 1, first + side] {
            bytes.extend(corner.to_le_bytes());
        }
    }
    fs::write(folder.path().join("many.ply"), bytes).unwrap();
    let text = "(camera: Orthographic(eye: (0, 0, 0), gaze: (0, 0, 1), scale: 1), geometries: \
                [Mesh(file: \"many.ply\", color: \"#fff\")])";
    fs::write(folder.path().join("scene.ron"), text).unwrap();
    let scene = Scene::from_path(folder.path().join("scene.ron")).unwrap();
    let Shape::Mesh(mesh) = scene.world().geometries()[0].shape() else {
        panic!("a mesh");
    };
    assert_eq!(mesh.vertices().len(), vertices as usize);
    assert_eq!(mesh.triangles().len(), 2 * squares as usize);
    for (number, vertex) in (0..vertices).zip(mesh.vertices()) {
        let (x, y) = (f64::from(number % side), f64::from(number / side));
        assert_eq!(*vertex, strahl::Vec3::new(x, y, x * y / 3.0));
    }
    let last = vertices - 1;
    assert_eq!(
        mesh.triangles().last(),
        Some(&[last - side - 1, last, last - 1])
    );
}
