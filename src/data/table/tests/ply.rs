use std::io::{self, Read};

use super::{
    DEFAULTS, Format, ReadError, Request, Table, bad_spheres, finds_bad_spheres,
    neither_shorter_nor_longer, rows, spheres, survives_faults, table,
};
use crate::data::table::tests::{Sphere, with_defaults};
use crate::parallel::Pool;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Little, Encoding::Big];

/// Writes a file, value by value.
struct Writer {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Writer {
    fn new(encoding: Encoding, header: &str) -> Self {
        let name = match encoding {
            Encoding::Ascii => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let text = format!("ply\nformat {name} 1.0\n{header}end_header\n");
        Self {
            encoding,
            bytes: text.into_bytes(),
        }
    }

    fn put(&mut self, kind: &str, number: f64) {
        macro_rules! put {
            ($type:ty) => {
                match self.encoding {
                    Encoding::Ascii => self.bytes.extend(format!("{} ", number as $type).bytes()),
                    Encoding::Little => self.bytes.extend((number as $type).to_le_bytes()),
                    Encoding::Big => self.bytes.extend((number as $type).to_be_bytes()),
                }
            };
        }
        match kind {
            "char" | "int8" => put!(i8),
            "uchar" | "uint8" => put!(u8),
            "short" | "int16" => put!(i16),
            "ushort" | "uint16" => put!(u16),
            "int" | "int32" => put!(i32),
            "uint" | "uint32" => put!(u32),
            "float" | "float32" => put!(f32),
            _ => put!(f64),
        }
    }

    fn end_row(&mut self) {
        if self.encoding == Encoding::Ascii {
            self.bytes.push(b'\n');
        }
    }
}

/// Returns a file with only center, radius and color, of these types.
fn plain(encoding: Encoding, kinds: [&str; 3], spheres: &[Sphere]) -> Vec<u8> {
    let [center, radius, color] = kinds;
    let header = format!(
        "comment spheres\nelement vertex {}\nproperty {center} x\nproperty {center} y\n\
         property {center} z\nproperty {radius} radius\nproperty {color} red\n\
         property {color} green\nproperty {color} blue\n",
        spheres.len()
    );
    let mut writer = Writer::new(encoding, &header);
    for (at, r, channels) in spheres {
        at.iter().for_each(|number| writer.put(center, *number));
        writer.put(radius, *r);
        let factor = if color == "uchar" { 255.0 } else { 1.0 };
        channels
            .iter()
            .for_each(|number| writer.put(color, *number * factor));
        writer.end_row();
    }
    writer.bytes
}

#[test]
fn every_type_and_encoding_is_read() {
    let all = spheres(700);
    for encoding in ENCODINGS {
        for kinds in [
            ["float", "float", "float"],
            ["double", "float64", "float32"],
            ["float32", "ushort", "double"],
        ] {
            let mut expected = all.clone();
            if kinds[1] == "ushort" {
                expected
                    .iter_mut()
                    .for_each(|sphere| sphere.1 = sphere.1.floor());
            }
            let read = rows(&plain(encoding, kinds, &all), Format::Ply);
            assert!(read == Ok(expected), "{encoding:?}, {kinds:?}");
        }
    }
    let small = [([-3.0, 2.0, 1.0], 5.0, [1.0, 0.0, 1.0])];
    for encoding in ENCODINGS {
        for center in ["char", "int8", "short", "int16", "int", "int32"] {
            for radius in ["uchar", "uint8", "uint16", "uint", "uint32"] {
                let bytes = plain(encoding, [center, radius, "float"], &small);
                assert_eq!(
                    rows(&bytes, Format::Ply),
                    Ok(small.to_vec()),
                    "{center} {radius}"
                );
            }
        }
    }
}

#[test]
fn bytes_of_color_are_divided_by_255() {
    for encoding in ENCODINGS {
        let part = |byte: u8| f64::from(byte) / 255.0;
        let sphere = ([0.0, 1.0, 2.0], 1.0, [part(0), part(200), part(255)]);
        let bytes = plain(encoding, ["float", "float", "uchar"], &[sphere]);
        assert_eq!(rows(&bytes, Format::Ply), Ok(vec![sphere]));
    }
}

#[test]
fn colors_have_many_names_and_types() {
    let orange = [1.0, 128.0 / 255.0, 0.0];
    let float = format!("{:e}", f32::from_bits(0x00ff_8000));
    for (properties, values) in [
        ("ushort red, ushort green, ushort blue", "65535 32896 0"),
        ("int red, uint green, short blue", "255 128 0"),
        (
            "uchar diffuse_red, uchar diffuse_green, uchar diffuse_blue",
            "255 128 0",
        ),
        ("uint rgb", "16744448"),
        ("int rgba", "-32768"),
        ("float rgb", &float),
    ] {
        let numbers = values.split(' ').map(|word| word.parse().unwrap());
        let numbers: Vec<f64> = numbers.collect();
        for encoding in ENCODINGS {
            let mut header = "element vertex 1\n".to_owned();
            let names = "float x, float y, float z, ".to_owned() + properties;
            for name in names.split(", ") {
                header += &format!("property {name}\n");
            }
            let mut writer = Writer::new(encoding, &header);
            let kinds = names
                .split(", ")
                .map(|name| name.split(' ').next().unwrap());
            for (kind, number) in kinds.zip([&[1.0, 2.0, 3.0], &numbers[..]].concat()) {
                writer.put(kind, number);
            }
            writer.end_row();
            let sphere = ([1.0, 2.0, 3.0], DEFAULTS.radius.unwrap(), orange);
            assert_eq!(
                rows(&writer.bytes, Format::Ply),
                Ok(vec![sphere]),
                "{encoding:?} {properties}"
            );
        }
    }
}

/// Returns a file with much else: lists and properties between those that are read, and elements
/// before and after, so that all rows have the same size or not.
fn crowded(encoding: Encoding, with_list: bool, spheres: &[Sphere]) -> Vec<u8> {
    let rows = spheres.len();
    let list = if with_list {
        "property list uchar short tags\n"
    } else {
        ""
    };
    let header = format!(
        "obj_info made by hand\nelement camera 2\nproperty double gain\nproperty list ushort float \
         k\nelement nothing 9\nelement vertex {rows}\nproperty uchar flag\nproperty float x\n\
         {list}property double nx\nproperty double ny\nproperty double nz\nproperty double mass\n\
         property double charge\nproperty float y\nproperty double time\nproperty float z\n\
         element face 2\nproperty list uchar int vertex_indices\n"
    );
    let mut writer = Writer::new(encoding, &header);
    for count in [0, 3] {
        writer.put("double", 2.5);
        writer.put("ushort", f64::from(count));
        (0..count).for_each(|_| writer.put("float", 1.0));
        writer.end_row();
    }
    for (row, ([x, y, z], ..)) in spheres.iter().enumerate() {
        writer.put("uchar", 7.0);
        writer.put("float", *x);
        if with_list {
            writer.put("uchar", (row % 4) as f64);
            (0..row % 4).for_each(|tag| writer.put("short", tag as f64));
        }
        (0..5).for_each(|_| writer.put("double", 0.5));
        writer.put("float", *y);
        writer.put("double", 1.0);
        writer.put("float", *z);
        writer.end_row();
    }
    for _ in 0..2 {
        writer.put("uchar", 3.0);
        (0..3).for_each(|corner| writer.put("int", f64::from(corner)));
        writer.end_row();
    }
    writer.bytes
}

#[test]
fn other_content_is_skipped() {
    let spheres = spheres(20);
    let expected = with_defaults(spheres.clone(), true, true);
    for encoding in ENCODINGS {
        for with_list in [false, true] {
            let bytes = crowded(encoding, with_list, &spheres);
            assert_eq!(
                rows(&bytes, Format::Ply),
                Ok(expected.clone()),
                "{encoding:?} {with_list}"
            );
        }
    }
}

#[test]
fn numbers_are_checked_while_they_are_read() {
    for encoding in ENCODINGS {
        let bytes = plain(encoding, ["float", "double", "float"], &bad_spheres());
        finds_bad_spheres(&bytes, Format::Ply);
        finds_bad_spheres(&crowded_by_lists(encoding), Format::Ply);
    }
}

/// [`bad_spheres`] with a list in each row.
fn crowded_by_lists(encoding: Encoding) -> Vec<u8> {
    let spheres = bad_spheres();
    let header = format!(
        "element vertex {}\nproperty list uchar short tags\nproperty float x\nproperty float y\n\
         property float z\nproperty float radius\nproperty float red\nproperty float green\n\
         property float blue\n",
        spheres.len()
    );
    let mut writer = Writer::new(encoding, &header);
    for (row, ([x, y, z], radius, [r, g, b])) in spheres.into_iter().enumerate() {
        writer.put("uchar", (row % 3) as f64);
        (0..row % 3).for_each(|tag| writer.put("short", tag as f64));
        for number in [x, y, z, radius, r, g, b] {
            writer.put("float", number);
        }
        writer.end_row();
    }
    writer.bytes
}

#[test]
fn data_after_the_vertices_is_not_kept_in_memory() {
    let spheres = spheres(700);
    let header = "element camera 3\nproperty double gain\nelement vertex 700\nproperty float x\n\
                  property float y\nproperty float z\nelement face 5\n\
                  property list uchar int vertex_indices\n";
    for encoding in [Encoding::Little, Encoding::Big] {
        let mut writer = Writer::new(encoding, header);
        (0..3).for_each(|_| writer.put("double", 0.5));
        for (center, ..) in &spheres {
            center
                .iter()
                .for_each(|number| writer.put("float", *number));
        }
        let end = writer.bytes.len();
        for _ in 0..5 {
            writer.put("uchar", 3.0);
            (0..3).for_each(|corner| writer.put("int", f64::from(corner)));
        }
        let expected = with_defaults(spheres.clone(), true, true);
        assert_eq!(rows(&writer.bytes, Format::Ply), Ok(expected));
        let table = table(&writer.bytes, Format::Ply, &DEFAULTS).unwrap();
        assert_eq!(table.bytes.len(), end);
        neither_shorter_nor_longer(&writer.bytes, Format::Ply);
    }
}

#[test]
fn parts_of_a_file_are_rejected() {
    for encoding in [Encoding::Little, Encoding::Big] {
        for with_list in [false, true] {
            neither_shorter_nor_longer(&crowded(encoding, with_list, &spheres(5)), Format::Ply);
        }
        let bytes = plain(encoding, ["float", "double", "uchar"], &spheres(3));
        neither_shorter_nor_longer(&bytes, Format::Ply);
    }
    // The last number of a text has no end mark: half of it is a number, too.
    let bytes = crowded(Encoding::Ascii, true, &spheres(5));
    let whole = bytes.trim_ascii_end().len();
    for end in 0..whole - 1 {
        assert!(rows(&bytes[..end], Format::Ply).is_err(), "{end}");
    }
    let longer = table(&[&bytes[..], b"1\n"].concat(), Format::Ply, &DEFAULTS).unwrap();
    let message = longer.behind.unwrap().message;
    assert!(
        message.ends_with("text after the last row is not read"),
        "{message}"
    );
    assert_eq!(longer.layout.rows, 5);
}

#[test]
fn lines_may_end_with_crlf_or_cr() {
    let text = "ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float \
                y\r\nproperty float z\r\nend_header\r\n1 2 3\r\n\r\n4 5 6\r\n";
    let (radius, color) = (DEFAULTS.radius.unwrap(), DEFAULTS.color.unwrap());
    let expected = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]].map(|center| (center, radius, color));
    for text in [text.to_owned(), text.replace("\r\n", "\r")] {
        assert_eq!(rows(text.as_bytes(), Format::Ply), Ok(expected.to_vec()));
    }
}

#[test]
fn a_float_in_text_equals_that_in_a_binary_file() {
    let sphere = ([0.1, -0.7, 1e-3], 0.3, [0.1, 0.2, 0.3]);
    let read = ENCODINGS.map(|encoding| {
        let kinds = ["float", "double", "float"];
        rows(&plain(encoding, kinds, &[sphere]), Format::Ply).unwrap()
    });
    assert_eq!(read[0][0].0[0], f64::from(0.1_f32));
    assert_eq!(read[0][0].1, 0.3);
    assert!(read[0] == read[1] && read[1] == read[2]);
}

#[test]
fn a_byte_order_mark_and_comments_of_any_encoding_are_skipped() {
    for encoding in ENCODINGS {
        let bytes = plain(encoding, ["float", "double", "uchar"], &spheres(3));
        let at = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        let (first, rest) = bytes.split_at(at);
        let mark = "\u{feff}".as_bytes();
        let comments = b"comment cr\xe9\xe9\nobj_info \xff\n";
        let changed = [mark, first, comments, rest].concat();
        assert_eq!(rows(&changed, Format::Ply), rows(&bytes, Format::Ply));
    }
    let text = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float \xe9\nend_header\n1\n";
    let message = rows(text, Format::Ply).unwrap_err();
    assert_eq!(message, "line 4: `property float \u{fffd}` is not UTF-8");
}

#[test]
fn a_header_without_end_is_not_read_to_the_end_of_the_file() {
    let start = b"ply\nformat ascii 1.0\n";
    let length = 1 << 26;
    let mut rest = io::repeat(b'\n').take(length - start.len() as u64);
    let file = start.chain(&mut rest);
    let read = Table::read(file, length, Format::Ply, &Request::default(), |_| {
        Pool::Calling
    });
    let Err(ReadError::Invalid(fault)) = read else {
        panic!("{read:?}");
    };
    assert_eq!(
        fault.message,
        "the header is longer than 1 MiB: there is no line `end_header` in it"
    );
    assert!(rest.limit() > length - (1 << 22));
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let message = rows(text.as_bytes(), Format::Ply).expect_err(text);
    for word in words {
        assert!(message.contains(word), "no {word:?} in: {message}");
    }
}

#[test]
fn headers_are_rejected_with_a_reason() {
    const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
    let with = |lines: &str| format!("ply\nformat ascii 1.0\n{lines}end_header\n1 2 3\n");
    refused("solid a stl file\n", &["not a PLY file"]);
    refused("plywood\n", &["not a PLY file"]);
    refused("ply\nformat ascii 1.0\n", &["no end"]);
    refused("ply\nelement vertex 0\nend_header\n", &["no line `format`"]);
    refused("ply\nformat ascii 2.0\n", &["line 2", "`format ascii 2.0`"]);
    refused("ply\nformat utf8 1.0\n", &["line 2"]);
    refused(&with(""), &["no element `vertex`"]);
    refused(
        &with("element face 1\nproperty int a\n"),
        &["no element `vertex`"],
    );
    refused(&with(XYZ), &["line 3"]);
    refused(&with("element vertex -1\n"), &["line 3"]);
    refused(
        &with("element vertex 1\nproperty float x\nproperty float y\n"),
        &["`z`"],
    );
    refused(
        &with(&format!("element vertex 1\n{XYZ}property float x\n")),
        &["`x`", "twice"],
    );
    refused(
        &with(&format!("element vertex 1\n{XYZ}element vertex 1\n")),
        &["`vertex`", "twice"],
    );
    refused(
        &with("element vertex 1\nproperty long x\n"),
        &["`property long x`"],
    );
    refused(
        &with("element vertex 1\nproperty list float int x\n"),
        &["line 4"],
    );
    refused(
        &with("element vertex 1\nproperty list int float x\nproperty float y\nproperty float z\n"),
        &["`x`", "list"],
    );
    let color = "property uchar red\nproperty uchar green\n";
    refused(
        &with(&format!("element vertex 1\n{XYZ}{color}")),
        &["only some"],
    );
}

#[test]
fn rows_of_a_text_are_rejected_with_their_line() {
    let with = |rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty double y\nproperty \
             uchar z\nproperty list char int tags\nend_header\n{rows}"
        )
    };
    refused(&with("1 2 3 0\n"), &["cut off: 1 of 2 rows of `vertex`"]);
    refused(&with("1 2 3 0\n1 2\n"), &["row 1 (line 10): too few"]);
    refused(&with("1 2 3 0\n1 2 3 2 1\n"), &["row 1 (line 10): too few"]);
    refused(
        &with("1 2 3 0\n\n1 2 3 1 1 1\n"),
        &["row 1 (line 11): too many"],
    );
    refused(
        &with("1 2 3 -1\n"),
        &["row 0 (line 9): `-1` is not the length"],
    );
    refused(
        &with("1 two 3 0\n"),
        &["row 0 (line 9), column `y`: `two` is not a number"],
    );
    refused(
        &with("1 2 256 0\n"),
        &["row 0 (line 9), column `z`: `256` is not a number of its type"],
    );
}

#[test]
fn impossible_sizes_are_rejected() {
    for rows in ["4", "768614336404564651", "18446744073709551615"] {
        for list in ["", "property list uint double tags\n"] {
            let header = format!(
                "element vertex {rows}\nproperty double x\nproperty double y\nproperty double \
                 z\n{list}"
            );
            let mut bytes = Writer::new(Encoding::Little, &header).bytes;
            bytes.extend([0xff; 30]);
            let message = super::rows(&bytes, Format::Ply).unwrap_err();
            assert!(message.contains("cut off"), "{message}");
        }
    }
    let header = "element nothing 18446744073709551615\nelement vertex 1\nproperty char x\n\
                  property char y\nproperty char z\n";
    let mut bytes = Writer::new(Encoding::Big, header).bytes;
    bytes.extend([1, 2, 3]);
    assert_eq!(
        super::rows(&bytes, Format::Ply).unwrap()[0].0,
        [1.0, 2.0, 3.0]
    );
}

#[test]
fn random_faults_are_survived() {
    let mut files = Vec::new();
    for encoding in ENCODINGS {
        files.push(crowded(encoding, true, &spheres(5)));
        files.push(plain(encoding, ["float", "double", "uchar"], &spheres(4)));
    }
    let pieces = [
        "\n",
        " ",
        "property",
        "list",
        "element x 3\n",
        "99999999999",
        "-1",
        "uchar",
        "float",
        "vertex",
        "end_header\n",
        "comment",
        "nan",
        "\r\n",
    ];
    survives_faults(&files, Format::Ply, &pieces);
}
