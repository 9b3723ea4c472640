//! Arrays with names.

use std::io::{Cursor, Write};

use zip::{ZipWriter, write::SimpleFileOptions};

use super::{DEFAULTS, table};
use crate::data::table::Format;

fn message(file: &[u8]) -> String {
    table(file, Format::Npz, &DEFAULTS)
        .err()
        .unwrap_or_default()
}

/// Returns a file with arrays of zeros, packed.
fn packed(arrays: &[(&str, usize)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, rows) in arrays {
        let file = format!("{name}.npy");
        writer
            .start_file(file, SimpleFileOptions::default())
            .unwrap();
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows},), }}");
        let header = format!("{header:<117}\n");
        writer.write_all(b"\x93NUMPY\x01\0\x76\0").unwrap();
        writer.write_all(header.as_bytes()).unwrap();
        writer.write_all(&vec![0; 8 * rows]).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

#[test]
fn two_arrays_of_one_name_are_refused() {
    let mut file = packed(&[("x", 2), ("y", 2), ("z", 2), ("Z", 2)]);
    assert!(table(&file, Format::Npz, &DEFAULTS).is_ok());
    let places: Vec<_> = (0..file.len())
        .filter(|at| file[*at..].starts_with(b"Z.npy"))
        .collect();
    assert_eq!(places.len(), 2);
    places.iter().for_each(|at| file[*at] = b'z');
    assert_eq!(
        message(&file),
        "several arrays have the name `z`; write the file again, each array once"
    );
}

#[test]
fn a_small_file_does_not_fill_the_memory() {
    let arrays = |rows| packed(&["x", "y", "z"].map(|name| (name, rows)));
    assert!(table(&arrays(600), Format::Npz, &DEFAULTS).is_ok());
    let bomb = arrays(200_000);
    assert!(bomb.len() < 20_000);
    let found = message(&bomb);
    assert!(
        found.contains("unpacked, the arrays have more than"),
        "{found}"
    );
}
