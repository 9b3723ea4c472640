//! The cells of the row of a table that `strahl pixel` shows.

use serde_json::{Value, json};

use crate::support::{Folder, run};

/// Returns the line of the columns and the JSON of the hit in the middle of a scene with this table.
fn middle(folder: &Folder, geometry: &str) -> (String, Value) {
    let scene = format!(
        "(
    image: (width: 9, height: 9),
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    geometries: [{geometry}],
)
"
    );
    folder.write("scene.ron", scene);
    let args = ["pixel", "scene.ron", "4,4"];
    let text = run(&mut folder.strahl(args));
    assert_eq!(text.status, Some(0), "{}", text.stderr);
    let text = String::from_utf8(text.stdout).unwrap();
    let mut lines = text.lines().filter(|line| line.starts_with("  columns "));
    let line = lines.next().unwrap_or_default().to_owned();
    let mut command = folder.strahl(args);
    let output = run(command.args(["--output-format", "json"])).stdout;
    let json: Value = serde_json::from_slice(&output).unwrap();
    (line, json["hit"].clone())
}

#[test]
fn all_columns_of_the_row_are_shown() {
    let folder = Folder::new();
    let rows = "id,x,y,z,charge,note\n7,5,0,0,1,\n8,0,0,0,-1.50,\"a, b\"\n";
    folder.write("a.csv", rows);
    let table = "Spheres(file: \"a.csv\", radius: 1, color: \"#f00\")";
    let (line, hit) = middle(&folder, table);
    let expected = "  columns      id = 8, x = 0, y = 0, z = 0, charge = -1.50, note = a, b";
    assert_eq!(line, expected);
    assert_eq!(
        hit["columns"][4],
        json!({"name": "charge", "text": "-1.50"})
    );
    assert_eq!(hit.get("more_columns"), None);

    // In a group, and in a part.
    let group = format!("Group(transform: (scale: 2), geometries: [{table}])");
    assert_eq!(middle(&folder, &group).0, expected);
    folder.write("part.ron", format!("(geometries: [{table}])"));
    assert_eq!(middle(&folder, "Part(file: \"part.ron\")").0, expected);

    folder.write(
        "a.xyz",
        "1\nProperties=species:S:1:pos:R:3:site:S:1\nC 0 0 0 A1\n",
    );
    let (line, _) = middle(&folder, "Spheres(file: \"a.xyz\")");
    assert_eq!(
        line,
        "  columns      species = C, x = 0, y = 0, z = 0, site = A1"
    );

    let names: Vec<_> = (0..30).map(|at| format!("c{at}")).collect();
    let text = format!("x,y,z,{}\n0,0,0{}\n", names.join(","), ",5".repeat(30));
    folder.write("a.csv", text);
    let (line, hit) = middle(&folder, table);
    assert!(line.ends_with("c15 = 5, c16 = 5, and 13 more"), "{line}");
    assert_eq!(hit["more_columns"], 13);
    assert_eq!(hit["columns"].as_array().map(Vec::len), Some(20));

    let (line, hit) = middle(
        &folder,
        "Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")",
    );
    assert_eq!((&*line, hit.get("columns")), ("", None));
}

#[test]
fn an_array_shows_what_the_scene_does_not_use() {
    let folder = Folder::new();
    let header = "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('t', '<f4'), ('k', '<i8')], \
                  'fortran_order': False, 'shape': (2,), }";
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    for (x, k) in [(5.0_f32, 1_i64), (0.0, 9_007_199_254_740_993)] {
        let numbers = [x, 0.0, 0.0, 0.1];
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend(k.to_le_bytes());
    }
    folder.write("a.npy", bytes);
    let (line, _) = middle(
        &folder,
        "Spheres(file: \"a.npy\", radius: 1, color: \"#f00\")",
    );
    let expected = "  columns      x = 0.0, y = 0.0, z = 0.0, t = 0.1, k = 9007199254740993";
    assert_eq!(line, expected);
}
