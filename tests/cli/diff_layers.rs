//! `strahl diff` of data other than colors: EXR channels, NPY and NPZ arrays.

use std::{
    fs,
    io::{Cursor, Write},
    path::Path,
};

use serde_json::Value;

use crate::support::{Done, Folder, RON, run};

/// `a.ron`, and as `b.ron` the same scene from slightly farther away.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.ron", RON);
    folder.write("b.ron", RON.replace("eye: (0, 0, 0)", "eye: (0, 0.5, 0)"));
    folder
}

fn render(folder: &Folder, args: &str) {
    run(&mut folder.strahl(["render"].into_iter().chain(args.split_whitespace()))).quiet_success();
}

fn diff(folder: &Folder, args: &[&str]) -> Done {
    run(folder.strahl(["diff"]).args(args))
}

fn json(folder: &Folder, args: &[&str], status: i32) -> Value {
    let done = diff(folder, &[args, &["--output-format", "json"]].concat());
    assert_eq!((done.status, &*done.stderr), (Some(status), ""), "{args:?}");
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn layers_of_one_color_differ() {
    let folder = folder();
    for (layers, ending) in [
        ("color,depth", "exr"),
        ("depth,normal", "exr"),
        ("color,depth,id", "npz"),
        ("depth", "npy"),
        ("color,position,id", "exr"),
    ] {
        for scene in ["a", "b"] {
            render(
                &folder,
                &format!("{scene}.ron --layers {layers} -o {scene}.{ending}"),
            );
        }
        // A single-layer format names its layer.
        let between = if ending == "npy" { ".depth" } else { "" };
        let [a, b] = ["a", "b"].map(|name| format!("{name}{between}.{ending}"));
        fs::copy(
            folder.path(&a),
            folder.path(Path::new("same").with_extension(ending)),
        )
        .unwrap();
        let same = json(&folder, &[&a, &format!("same.{ending}")], 0);
        let found = same["found"]["layers"].as_array().unwrap();
        assert!(!found.is_empty(), "{layers} {same}");
        assert!(
            found
                .iter()
                .all(|one| one["in_both"] == true && one["different"] == 0),
            "{same}"
        );
        let other = json(&folder, &[&a, &b], 1);
        let found = other["found"]["layers"].as_array().unwrap();
        assert!(
            found.iter().any(|one| one["different"].as_u64() > Some(0)),
            "{layers} {other}"
        );
        assert_eq!(
            other["found"]["has_colors"],
            layers.contains("color"),
            "{layers}"
        );
    }
}

#[test]
fn a_layer_in_only_one_file_is_a_difference() {
    let folder = folder();
    render(&folder, "a.ron --layers color,depth -o a.exr");
    render(&folder, "a.ron -o b.exr");
    render(&folder, "a.ron -o c.png");
    let found = json(&folder, &["a.exr", "b.exr", "--max-different", "99999"], 1);
    assert_eq!(found["found"]["different"], 0);
    assert_eq!(found["failed"], serde_json::json!(["layers"]));
    // A PNG file has no layers.
    json(&folder, &["a.exr", "c.png"], 0);
}

/// Returns an array of one row.
fn npy(kind: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], text.as_bytes(), numbers].concat()
}

#[test]
fn values_are_read_in_their_types() {
    let folder = Folder::new();
    folder.write("little.npy", npy("<i2", "(1, 2)", &[1, 0, 254, 255]));
    folder.write(
        "big.npy",
        npy(
            ">f4",
            "(1, 2)",
            &[1.0_f32, 3.5].map(f32::to_be_bytes).concat(),
        ),
    );
    let found = json(&folder, &["little.npy", "big.npy"], 1);
    let layer = &found["found"]["layers"][0];
    assert_eq!(
        (&layer["different"], &layer["max_delta"]),
        (&1.into(), &5.5.into())
    );
    json(
        &folder,
        &["little.npy", "big.npy", "--max-layer-delta", "5.5"],
        0,
    );
    json(
        &folder,
        &["little.npy", "big.npy", "--max-layer-delta", "5"],
        1,
    );
    json(
        &folder,
        &["little.npy", "big.npy", "--max-different", "1"],
        0,
    );
    json(&folder, &["little.npy", "big.npy", "--max-delta", "200"], 1);
}

/// Returns a compressed archive of an array.
fn npz(array: &[u8]) -> Vec<u8> {
    archive(array, &["depth.npy"])
}

/// Returns a compressed archive of an array with each of some names.
fn archive(array: &[u8], names: &[&str]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let options = options.compression_method(zip::CompressionMethod::Deflated);
    for name in names {
        zip.start_file(*name, options).unwrap();
        zip.write_all(array).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

// A reader would keep one of them.
#[test]
fn two_arrays_of_one_name_are_refused() {
    let folder = Folder::new();
    let array = npy("<f8", "(1, 2)", &[0; 16]);
    folder.write("named.npz", archive(&array, &["depth", "depth.npy"]));
    let mut twice = archive(&array, &["depth.npy", "dEpth.npy"]);
    for at in 0..twice.len() {
        if twice[at..].starts_with(b"dEpth.npy") {
            twice[at + 1] = b'e';
        }
    }
    folder.write("twice.npz", twice);
    for name in ["named.npz", "twice.npz"] {
        let done = diff(&folder, &[name, name]);
        done.one_line(2, &[name, "several arrays have the name `depth`"]);
    }
}

#[test]
fn compressed_archives_are_read_up_to_the_declared_size() {
    let folder = Folder::new();
    let array = npy("<f8", "(1, 2)", &[0; 16]);
    folder.write("a.npz", npz(&array));
    let found = json(&folder, &["a.npz", "a.npz"], 0);
    assert_eq!(found["found"]["layers"][0]["name"], "depth");
    folder.write("bomb.npz", npz(&[array, vec![0; 1 << 26]].concat()));
    let done = diff(&folder, &["a.npz", "bomb.npz"]);
    assert_eq!(done.status, Some(2));
    assert!(
        done.stderr.contains("after the last number"),
        "{}",
        done.stderr
    );
}

#[test]
fn other_arrays_are_rejected() {
    let folder = Folder::new();
    for (file, message) in [
        (npy("<c8", "(1, 1)", &[0; 8]), "the type is `<c8`"),
        (npy("|u1", "(4,)", &[0; 4]), "its shape"),
        (npy("|u1", "(2, 2)", &[0; 3]), "cut off"),
        (npy("|u1", "(2, 2)", &[0; 5]), "after the last"),
        (npy("<f8", "(99999, 99999)", &[0; 5]), "--max-pixels"),
        (npy("<f8", "(9999, 9999, 99999)", &[0; 5]), "--max-pixels"),
        (b"\x93NUMPY\x09\0".to_vec(), "version"),
        (b"PK\x03\x04".to_vec(), "cannot be read"),
    ] {
        folder.write("a.npy", file);
        let done = diff(&folder, &["a.npy", "a.npy"]);
        assert_eq!(done.status, Some(2), "{message}: {}", done.stderr);
        assert!(done.stderr.contains(message), "{message}: {}", done.stderr);
    }
}
