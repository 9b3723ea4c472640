//! Spheres and cylinders from tables: the same world and the same picture as if they were listed in the
//! scene.

use std::{fs, path::Path, time::Duration};

use strahl::{
    Document, ErrorKind, Geometry, ReadOptions, Scene, Syntax,
    diagnostic::Levels,
    jobs::{check_files, find_scenes},
    parallel::Cancel,
    scene::{Memory, Origin},
};

/// The tables that numpy and other tools have written, by `make.py` in their folder.
const TABLES: &str = "tests/valid/tables";

/// The content of each of these tables: center, radius, color.
const SPHERES: [([f64; 3], f64, [u8; 3]); 5] = [
    ([0.0, 0.0, -4.0], 0.5, [1, 0, 0]),
    ([-1.5, 0.25, -5.0], 0.75, [0, 1, 0]),
    ([1.25, -0.5, -4.5], 0.625, [0, 0, 1]),
    ([0.5, 1.125, -6.0], 1.0, [1, 1, 0]),
    ([-0.75, -1.0, -3.5], 0.25, [1, 1, 1]),
];

/// Returns a scene of these geometries, in the folder of the tables.
fn scene(geometries: &str) -> Scene {
    scene_of(
        geometries,
        "Perspective(eye: (0, 0, 1), gaze: (0, 0, -1), fov: 60)",
    )
}

/// The same with another camera.
fn scene_of(geometries: &str, camera: &str) -> Scene {
    let text =
        format!("(image: (width: 48, height: 36), geometries: [{geometries}], camera: {camera})");
    let options = ReadOptions::new().syntax(Syntax::Ron).folder(TABLES);
    let document = Document::from_reader("scene", text.as_bytes(), &options).unwrap();
    assert_eq!(document.diagnostics(), [], "{geometries}");
    document.try_into().unwrap()
}

fn inline(has_radius: bool, has_color: bool) -> String {
    let sphere = |([x, y, z], radius, [r, g, b]): &([f64; 3], f64, [u8; 3])| {
        let radius = if has_radius { *radius } else { 0.375 };
        let [r, g, b] = if has_color { [*r, *g, *b] } else { [1, 0, 1] };
        format!("Sphere(center: ({x}, {y}, {z}), radius: {radius}, color: ({r}, {g}, {b})),")
    };
    SPHERES.iter().map(sphere).collect()
}

#[test]
fn tables_of_other_tools_equal_listed_spheres() {
    let mut count = 0;
    for entry in fs::read_dir(TABLES).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let Some((stem, "npy" | "npz" | "ply")) = name.rsplit_once('.') else {
            continue;
        };
        if !stem.contains("-xyz") {
            continue;
        }
        let (has_radius, has_color) = (stem.contains("-radius"), stem.contains("-color"));
        let radius = if has_radius { "" } else { ", radius: 0.375" };
        let color = if has_color { "" } else { ", color: \"#f0f\"" };
        let table = scene(&format!("Spheres(file: \"{name}\"{radius}{color})"));
        let listed = scene(&inline(has_radius, has_color));
        assert_eq!(table.world(), listed.world(), "{name}");
        let (drawn, expected) = (table.render().unwrap(), listed.render().unwrap());
        assert_eq!(drawn.pixels(), expected.pixels(), "{name}");
        count += 1;
    }
    assert!(count >= 23, "{count}");
}

/// Returns the cylinders of the tables: from the points of the spheres to the right, up and back.
fn listed_cylinders(has_radius: bool, has_color: bool, capped: bool) -> String {
    let cylinder = |([x, y, z], radius, [r, g, b]): &([f64; 3], f64, [u8; 3])| {
        let to = format!("({}, {}, {})", x + 1.0, y + 0.5, z - 1.5);
        let radius = if has_radius { *radius } else { 0.375 };
        let [r, g, b] = if has_color { [*r, *g, *b] } else { [1, 0, 1] };
        format!(
            "Cylinder(from: ({x}, {y}, {z}), to: {to}, radius: {radius}, color: ({r}, {g}, {b}), \
             capped: {capped}),"
        )
    };
    SPHERES.iter().map(cylinder).collect()
}

#[test]
fn tables_of_numpy_equal_listed_cylinders() {
    let mut count = 0;
    for entry in fs::read_dir(TABLES).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !name.contains("-ends") {
            continue;
        }
        let (has_radius, has_color) = (name.contains("-radius"), name.contains("-color"));
        let radius = if has_radius { "" } else { ", radius: 0.375" };
        let color = if has_color { "" } else { ", color: \"#f0f\"" };
        for (capped, field) in [(true, ""), (false, ", capped: false")] {
            let table = format!("Cylinders(file: \"{name}\"{radius}{color}{field})");
            let listed = listed_cylinders(has_radius, has_color, capped);
            assert_eq!(scene(&table).world(), scene(&listed).world(), "{name}");
            let camera = "Fit(from: (1, 2, 3))";
            let [drawn, expected] =
                [table, listed].map(|all| scene_of(&all, camera).render().unwrap());
            assert_eq!(drawn.pixels(), expected.pixels(), "{name}");
        }
        count += 1;
    }
    assert_eq!(count, 7);
}

#[test]
fn the_same_spheres_give_the_same_picture() {
    let picture = |name: &str| {
        let path = Path::new("tests/golden/tables").join(name);
        Scene::from_path(path).unwrap().render().unwrap()
    };
    let listed = picture("inline.ron");
    for name in ["csv.ron", "npy.ron", "ply.ron"] {
        assert_eq!(picture(name).pixels(), listed.pixels(), "{name}");
    }
}

#[test]
fn rows_take_the_place_of_their_table() {
    const TABLE: &str = "numpy-littlef8-F-v2-xyz-radius.npy";
    let plane = "Plane(point: (0, -9, 0), normal: (0, 1, 0), color: \"#fff\"),";
    let table = format!("Spheres(file: \"{TABLE}\", color: \"#00f\"),");
    let found = scene(&format!("{plane}{table}{plane}").replacen("-9", "-8", 1));
    assert_eq!(found.world().geometries().len(), 7);
    let origin = |index| found.origin(index).to_string();
    assert_eq!(origin(0), "geometries[0]");
    assert_eq!(origin(1), "geometries[1] row 0");
    assert_eq!(origin(5), "geometries[1] row 4");
    assert_eq!(origin(6), "geometries[2]");
    let last = Origin {
        geometry: 1,
        row: Some(4),
        ..Origin::default()
    };
    assert_eq!(found.origin(5), last);
    // At equal distance the first is visible, whether listed in the scene or in a table.
    let sphere = "Sphere(center: (0, 0, -4), radius: 0.5, color: \"#f00\"),";
    let center = |geometries: String| scene(&geometries).render().unwrap().pixel(24, 18);
    assert_eq!(center(format!("{sphere}{table}")), Some([255, 0, 0]));
    assert_eq!(center(format!("{table}{sphere}")), Some([0, 0, 255]));
}

#[test]
fn a_document_without_tables_reads_them_when_rendered() {
    let files = find_scenes(
        &["tests/golden/tables/npy.ron".into()],
        &[],
        &strahl::jobs::Configs::none(),
    )
    .unwrap();
    let mut scenes: Vec<Scene> = Vec::new();
    check_files(&files, &ReadOptions::new(), 1, |checked| {
        let strahl::jobs::Checked::Document(_, document) = checked else {
            panic!("it can be read");
        };
        scenes.push(document.try_into()?);
        Ok::<(), strahl::Error>(())
    })
    .unwrap();
    let listed = Scene::from_path("tests/golden/tables/inline.ron").unwrap();
    let shapes = |scene: &Scene| -> Vec<Geometry> { scene.world().geometries().to_vec() };
    assert_eq!(
        shapes(&scenes[0]).len(),
        shapes(&listed).len() + 1,
        "one stands there twice"
    );

    // Read without its tables: they have no faults until they are used.
    let options = ReadOptions::new()
        .without_tables()
        .levels(Levels::default());
    let path = "tests/invalid/invalid-table/cell-is-no-number.ron";
    let document = Document::from_path_with(path, &options).unwrap();
    assert_eq!(document.diagnostics(), []);
    assert_eq!(
        document.table_names().collect::<Vec<_>>(),
        ["tables/cells.csv"]
    );
    let error = Scene::try_from(document).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Scene);
    assert!(
        error.to_string().contains("error[invalid-table]"),
        "{error}"
    );
}

#[test]
fn many_rows_are_read_completely() {
    let folder = tempfile::tempdir().unwrap();
    let rows = 70_001_i32;
    let mut bytes = b"ply\nformat binary_big_endian 1.0\n".to_vec();
    bytes.extend(format!("element vertex {rows}\n").bytes());
    bytes.extend(b"property float x\nproperty int y\nproperty double z\nend_header\n");
    for row in 0..rows {
        bytes.extend((row as f32).to_be_bytes());
        bytes.extend((-row).to_be_bytes());
        bytes.extend((f64::from(row) / 3.0).to_be_bytes());
    }
    fs::write(folder.path().join("many.ply"), bytes).unwrap();
    let text = "(camera: Orthographic(eye: (0, 0, 0), gaze: (0, 0, 1), scale: 1), geometries: \
                [Spheres(file: \"many.ply\", radius: 1, color: \"#fff\")])";
    fs::write(folder.path().join("scene.ron"), text).unwrap();
    let scene = Scene::from_path(folder.path().join("scene.ron")).unwrap();
    assert_eq!(
        scene.world().geometries().len(),
        usize::try_from(rows).unwrap()
    );
    for (row, geometry) in scene.world().geometries().iter().enumerate() {
        let strahl::Shape::Sphere(sphere) = geometry.shape() else {
            panic!("a sphere");
        };
        let row = row as f64;
        assert_eq!(sphere.center(), strahl::Vec3::new(row, -row, row / 3.0));
    }
}

#[test]
fn a_row_is_read_again_unless_its_file_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let (file, table) = (folder.path().join("scene.ron"), folder.path().join("a.csv"));
    let text = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
        geometries: [Spheres(file: \"a.csv\", radius: 0.5, color: \"#f00\")])";
    fs::write(&file, text).unwrap();
    fs::write(&table, "id,x,y,z\na,nan,nan,nan\nb,1,2,3\n").unwrap();
    let shown = |scene: &Scene, cancel: &Cancel| {
        let shape = scene.world().geometries()[0].shape();
        let cells = scene.row_cells_in_file(0, shape, cancel);
        assert_eq!(cells.more, 0);
        let shown = cells.shown.iter();
        let shown: Vec<_> = shown.map(|(name, text)| format!("{name} {text}")).collect();
        (cells.is_from_file, shown.join(" "))
    };
    let scene = Scene::from_path(&file).unwrap();
    let of_file = |cells: &str| (true, cells.to_owned());
    let of_scene = (false, "x 1.0 y 2.0 z 3.0 radius 0.5".to_owned());
    // The row without a point counts.
    assert_eq!(shown(&scene, &Cancel::new()), of_file("id b x 1 y 2 z 3"));
    let cancelled = Cancel::new();
    cancelled.cancel();
    assert_eq!(shown(&scene, &cancelled), of_scene);
    let old = fs::metadata(&table).unwrap().modified().unwrap();
    let write = |text: &str, time| {
        fs::write(&table, text).unwrap();
        let file = fs::File::options().write(true).open(&table).unwrap();
        file.set_modified(time).unwrap();
    };
    // Another time, another length, and no file.
    write(
        "id,x,y,z\na,nan,nan,nan\nc,1,2,3\n",
        old + Duration::from_secs(1),
    );
    assert_eq!(shown(&scene, &Cancel::new()), of_scene);
    write("id,x,y,z\nc,1,2,3\n", old);
    assert_eq!(shown(&scene, &Cancel::new()), of_scene);
    fs::remove_file(&table).unwrap();
    assert_eq!(shown(&scene, &Cancel::new()), of_scene);

    let files = Memory::new().with(&table, "id,x,y,z\nm,1,2,3\n");
    let options = ReadOptions::new().files(files);
    let scene = Scene::try_from(Document::from_path_with(&file, &options).unwrap()).unwrap();
    assert_eq!(shown(&scene, &Cancel::new()), of_file("id m x 1 y 2 z 3"));
}
