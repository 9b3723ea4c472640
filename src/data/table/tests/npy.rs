use super::{DEFAULTS, Format, neither_shorter_nor_longer, rows, spheres, survives_faults};
use crate::data::table::tests::{Sphere, bad_spheres, finds_bad_spheres, with_defaults};

/// The variations between files of the same array.
#[derive(Clone, Copy, Debug)]
struct Kind {
    version: u8,
    descr: &'static str,
    fortran_order: bool,
    columns: usize,
}

const USUAL: Kind = Kind {
    version: 1,
    descr: "<f8",
    fortran_order: false,
    columns: 7,
};

fn header(version: u8, text: &str) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((text.len() as u16).to_le_bytes()),
        _ => bytes.extend((text.len() as u32).to_le_bytes()),
    }
    bytes.extend(text.bytes());
    bytes
}

fn npy(kind: Kind, spheres: &[Sphere]) -> Vec<u8> {
    let Kind {
        version,
        descr,
        fortran_order,
        columns,
    } = kind;
    let order = if fortran_order { "True" } else { "False" };
    let rows = spheres.len();
    let text = format!(
        "{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({rows}, {columns}), }}    \n"
    );
    let mut bytes = header(version, &text);
    let row = |((center, radius, color), columns): (&Sphere, usize)| -> Vec<f64> {
        let mut row = center.to_vec();
        row.extend(matches!(columns, 4 | 7).then_some(radius));
        row.extend(color.iter().filter(|_| columns > 4));
        row
    };
    let all: Vec<_> = spheres
        .iter()
        .map(|sphere| row((sphere, columns)))
        .collect();
    let cell = |row: usize, column: usize| {
        let number: f64 = all[row][column];
        match descr {
            "<f4" => (number as f32).to_le_bytes().to_vec(),
            ">f4" => (number as f32).to_be_bytes().to_vec(),
            ">f8" => number.to_be_bytes().to_vec(),
            _ => number.to_le_bytes().to_vec(),
        }
    };
    if fortran_order {
        for column in 0..columns {
            (0..rows).for_each(|row| bytes.extend(cell(row, column)));
        }
    } else {
        for row in 0..rows {
            (0..columns).for_each(|column| bytes.extend(cell(row, column)));
        }
    }
    bytes
}

#[test]
fn every_type_order_version_and_shape_is_read() {
    for count in [0, 1, 5, 1500] {
        let spheres = spheres(count);
        for version in [1, 2, 3] {
            for descr in ["<f4", "<f8", ">f4", ">f8"] {
                for fortran_order in [false, true] {
                    for columns in [3, 4, 6, 7] {
                        let kind = Kind {
                            version,
                            descr,
                            fortran_order,
                            columns,
                        };
                        let (no_radius, no_color) = (matches!(columns, 3 | 6), columns < 6);
                        let expected = with_defaults(spheres.clone(), no_radius, no_color);
                        let read = rows(&npy(kind, &spheres), Format::Npy);
                        assert!(read == Ok(expected), "{kind:?}, {count} rows");
                    }
                }
            }
        }
    }
}

#[test]
fn numbers_are_checked_while_they_are_read() {
    for descr in ["<f4", ">f8"] {
        for fortran_order in [false, true] {
            let kind = Kind {
                descr,
                fortran_order,
                ..USUAL
            };
            finds_bad_spheres(&npy(kind, &bad_spheres()), Format::Npy);
        }
    }
}

#[test]
fn a_short_float_widens_exactly() {
    let sphere = ([0.1, 1e-40, 3.4e38], 0.3, [0.7, 0.0, 1.0]);
    let kind = Kind {
        descr: "<f4",
        ..USUAL
    };
    let widened = |number: f64| f64::from(number as f32);
    let expected = (
        sphere.0.map(widened),
        widened(sphere.1),
        sphere.2.map(widened),
    );
    assert_eq!(rows(&npy(kind, &[sphere]), Format::Npy), Ok(vec![expected]));
}

#[test]
fn parts_of_a_file_are_rejected() {
    for descr in ["<f8", ">f4"] {
        let kind = Kind { descr, ..USUAL };
        neither_shorter_nor_longer(&npy(kind, &spheres(3)), Format::Npy);
    }
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let mut bytes = header(1, text);
    bytes.extend([0; 64]);
    let message = rows(&bytes, Format::Npy).expect_err(text);
    for word in words {
        assert!(message.contains(word), "no {word:?} in: {message}");
    }
}

#[test]
fn headers_are_rejected_with_a_reason() {
    let with = |descr: &str, order: &str, shape: &str| {
        format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}}}")
    };
    for descr in ["<i4", "|u1", "<f2", "=f8", "<U3", "|O", ""] {
        let text = with(&format!("'{descr}'"), "False", "(2, 4)");
        refused(&text, &[&format!("`{descr}`"), "`<f8`", "astype"]);
    }
    for (descr, cause) in [
        ("|O", "Python objects"),
        ("<c16", "complex numbers"),
        ("<U3", "text"),
    ] {
        refused(
            &with(&format!("'{descr}'"), "False", "(2, 3)"),
            &[descr, cause],
        );
    }
    refused(
        &with("[('x', '<f4'), ('y', '<f4', (2, 3))]", "False", "(2,)"),
        &["`y` has 2 times 3 numbers", "numpy.dtype"],
    );
    for shape in ["(1, 8)", "(1, 5)"] {
        refused(
            &with("'<f8'", "False", shape),
            &["shape", "(N, 7)", "`columns: "],
        );
    }
    for shape in ["()", "(8,)", "(2, 2, 2)", "(8, 1)"] {
        refused(
            &with("'<f8'", "False", shape),
            &["shape", "(N, 7)", "column_stack"],
        );
    }
    refused(
        &with("'<f8'", "False", "(3, 100)"),
        &["(3, 100)", "array.T"],
    );
    // More rows than given, than an address can hold, and than a number can hold.
    for rows in [
        "3",
        "99999999",
        "768614336404564651",
        "18446744073709551615",
    ] {
        refused(
            &with("'<f8'", "False", &format!("({rows}, 3)")),
            &["cut off", rows],
        );
    }
    refused(
        &with("'<f8'", "False", "(99999999999999999999, 3)"),
        &["dictionary"],
    );
    refused(&with("'<f8'", "0", "(2, 4)"), &["dictionary"]);
    refused(&with("'<f8'", "'False'", "(2, 4)"), &["`fortran_order`"]);
    refused(&with("'<f8'", "False", "'(2, 4)'"), &["`shape`"]);
    refused("{'descr': '<f8', 'fortran_order': False}", &["no `shape`"]);
    for text in [
        "",
        "{",
        "{}}",
        "{'a'}",
        "{'a': }",
        "[]",
        "{'a': 'b', 'a': 'b'}",
        "{'a: 'b'}",
    ] {
        refused(text, &["dictionary"]);
    }
}

#[test]
fn other_files_are_refused() {
    for (bytes, word) in [
        (
            &b"PK\x03\x04 a zip file, as numpy.savez writes it"[..],
            "numpy.save",
        ),
        (b"\x93NUMPY", "cut off"),
        (b"\x93NUMPY\x01\x00", "cut off"),
        (b"\x93NUMPY\x04\x00\x00\x00", "`4.0`"),
        (b"\x93NUMPY\x01\x01\x00\x00", "`1.1`"),
        (
            b"\x93NUMPY\x02\x00\xff\xff\xff\xff",
            "header of 4294967295 bytes",
        ),
        (b"\x93NUMPY\x03\x00\x01\x00\x00\x00\xff", "not UTF-8"),
        (b"\x93NUMPY\x02\x00\x01\x00\x00\x00\xff", "dictionary"),
        (b"", "empty"),
    ] {
        let message = rows(bytes, Format::Npy).unwrap_err();
        assert!(message.contains(word), "no {word:?} in: {message}");
    }
}

#[test]
fn names_in_old_headers_are_latin_1() {
    let text = "{'descr': [('x', '<f8'), ('y', '<f8'), ('z', '<f8'), ('t \u{e9}C', '<f8')], \
                'fortran_order': False, 'shape': (1,)}";
    let mut bytes = header(1, text);
    // The two bytes of the letter become one, and the header as much longer.
    let at = bytes
        .windows(2)
        .position(|two| two == "\u{e9}".as_bytes())
        .unwrap();
    bytes.splice(at..at + 2, [0xe9]);
    bytes.push(b'\n');
    bytes.extend(2.5_f64.to_le_bytes().repeat(4));
    let expected = ([2.5; 3], DEFAULTS.radius.unwrap(), DEFAULTS.color.unwrap());
    assert_eq!(rows(&bytes, Format::Npy), Ok(vec![expected]));
}

#[test]
fn old_and_unusual_headers_are_read() {
    let data = 2.5_f64.to_le_bytes().repeat(3);
    for text in [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1L, 3L)}",
        "{\"shape\": (1, 3,), \"fortran_order\": True, \"descr\": \"<f8\",}\n",
        " { 'descr' : '<f8' ,'fortran_order':False,'shape':( 1 , 3 ) } ",
    ] {
        let bytes = [header(1, text), data.clone()].concat();
        let expected = ([2.5; 3], DEFAULTS.radius.unwrap(), DEFAULTS.color.unwrap());
        assert_eq!(rows(&bytes, Format::Npy), Ok(vec![expected]), "{text}");
    }
}

#[test]
fn random_faults_are_survived() {
    let mut files = Vec::new();
    for descr in ["<f8", ">f4"] {
        for columns in [3, 7] {
            let kind = Kind {
                descr,
                columns,
                ..USUAL
            };
            files.push(npy(kind, &spheres(4)));
        }
    }
    let pieces = [
        "(",
        ")",
        "'",
        "[",
        "]",
        "99999999999",
        "-1",
        "True",
        ":",
        ",",
        "<f4",
        "L",
    ];
    survives_faults(&files, Format::Npy, &pieces);
}
