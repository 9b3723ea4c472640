//! Tables of cylinders.

use std::fmt::Write as _;

use glam::DVec3;

use super::{BadKind, DEFAULTS, Defaults, Format, Request, Table, survives, totals, wanted};
use crate::{
    data::table::{kind::RowKind, layout::RADIUS},
    tracer::{
        random::{Rng, cases},
        shape::{Membership, Shape, cylinder::Cylinder},
    },
};

/// Ends, radius and color of a row.
type Row = [f64; 10];

fn request(capped: bool) -> Request<'static> {
    Request {
        defaults: Defaults {
            kind: RowKind::Cylinder { capped },
            ..DEFAULTS
        },
        ..Request::default()
    }
}

/// The first cylinders of a sequence; an f32 holds each of their numbers.
fn cylinders(count: usize) -> Vec<Row> {
    let row = |index: usize| {
        let number = index as f64;
        let [x, y, z] = [number, -0.5 * number, 4096.0 - number];
        let [r, g, b] = [0.0, 0.125 * (index % 9) as f64, 1.0];
        [x, y, z, x + 0.5, y + 1.0, z - 2.0, 0.25 + number, r, g, b]
    };
    (0..count).map(row).collect()
}

/// Returns true if a column is in a table with radii or colors.
fn is_there(column: usize, radius: bool, color: bool) -> bool {
    match column {
        0..6 => true,
        6 => radius,
        _ => color,
    }
}

fn npy(rows: &[Row], radius: bool, color: bool) -> Vec<u8> {
    let columns = (0..10).filter(|column| is_there(*column, radius, color));
    let columns: Vec<_> = columns.collect();
    let (rows_count, count) = (rows.len(), columns.len());
    let text =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows_count}, {count}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    for row in rows {
        for column in &columns {
            bytes.extend((row[*column] as f32).to_le_bytes());
        }
    }
    bytes
}

fn csv(rows: &[Row], radius: bool, color: bool) -> Vec<u8> {
    const NAMES: [&str; 10] = ["x1", "y1", "z1", "x2", "y2", "z2", "radius", "r", "g", "b"];
    let columns = (0..10).filter(|column| is_there(*column, radius, color));
    // The columns in another order than in an array.
    let columns: Vec<_> = columns.rev().collect();
    let line = |cell: &dyn Fn(usize) -> String| {
        let cells: Vec<_> = columns.iter().map(|column| cell(*column)).collect();
        cells.join(",") + "\n"
    };
    let mut text = line(&|column| NAMES[column].to_owned());
    for row in rows {
        text += &line(&|column| row[column].to_string());
    }
    text.into_bytes()
}

/// Returns the shapes and colors of a table.
fn rows_of(table: &Table) -> Vec<(Shape, [f64; 3])> {
    let mut rows = Vec::new();
    table.any_row(|row| {
        assert_eq!(row.index, rows.len());
        rows.push((row.shape.unwrap(), row.color));
        false
    });
    rows
}

#[test]
fn rows_are_read_from_arrays_and_texts() {
    for (radius, color) in [(false, false), (true, false), (false, true), (true, true)] {
        for count in [0, 1, 5, 1700] {
            let rows = cylinders(count);
            let expected = rows.iter().map(|row| {
                let [x1, y1, z1, x2, y2, z2, r, red, green, blue] = *row;
                let r = if radius { r } else { 0.75 };
                let ends = [[x1, y1, z1], [x2, y2, z2]].map(DVec3::from);
                let cylinder = Cylinder::new(ends[0], ends[1], r, !color).unwrap();
                let given = if color {
                    [red, green, blue]
                } else {
                    [0.25, 0.5, 1.0]
                };
                (Shape::from(cylinder), given)
            });
            let expected: Vec<_> = expected.collect();
            for (bytes, format) in [
                (npy(&rows, radius, color), Format::Npy),
                (csv(&rows, radius, color), Format::Csv),
            ] {
                let table = wanted(&bytes, format, &request(!color)).unwrap();
                assert_eq!(table.bad, []);
                assert_eq!(rows_of(&table), expected, "{format:?}");
            }
        }
    }
}

#[test]
fn empty_cells_take_the_defaults() {
    let text = "x1,y1,z1,x2,y2,z2,radius,color\n0,0,0,1,0,0,,\n0,0,0,1,0,0,2,\n0,0,0,1,0,0,,#f00\n";
    // The same with a quote, which the other reader reads.
    for text in [
        text.to_owned(),
        text.replace("radius", "\"radius\"")
            .replace(",2,", ",\"2\","),
    ] {
        let table = wanted(text.as_bytes(), Format::Csv, &request(true)).unwrap();
        let rows = rows_of(&table)
            .into_iter()
            .map(|(shape, color)| match shape {
                Shape::Cylinder(cylinder) => (cylinder.radius(), color),
                other => panic!("{other:?}"),
            });
        let default = DEFAULTS.color.unwrap();
        let expected = [(0.75, default), (2.0, default), (0.75, [1.0, 0.0, 0.0])];
        assert_eq!(rows.collect::<Vec<_>>(), expected, "{text}");
    }
}

#[test]
fn values_are_those_of_their_column() {
    let mut text = "x1,y1,z1,energy,x2,y2,z2\n".to_owned();
    for row in 0..1700 {
        let _ = writeln!(text, "0,0,0,{row},1,0,0");
    }
    for column in ["energy", "z2"] {
        let request = Request {
            value: Some(column),
            ..request(true)
        };
        let table = wanted(text.as_bytes(), Format::Csv, &request).unwrap();
        let mut values = Vec::new();
        table.any_row(|row| {
            values.extend(row.value);
            false
        });
        let expected = (0..1700).map(|row| if column == "z2" { 0.0 } else { f64::from(row) });
        assert!(values.into_iter().eq(expected), "{column}");
    }
}

#[test]
fn ends_without_a_direction_are_counted() {
    let mut rows = cylinders(1700);
    for row in [3, 511, 512, 1699] {
        let [x, y, z, ..] = rows[row];
        rows[row][3..6].copy_from_slice(&[x, y, z]);
    }
    rows[4][3..6].copy_from_slice(&[0.0, f64::NAN, 0.0]);
    rows[5][0..6].copy_from_slice(&[0.0, 0.0, 0.0, 1e-200, 0.0, 0.0]);
    rows[6][3] = 1e300;
    rows[7][6] = -1.0;
    let table = wanted(&csv(&rows, true, true), Format::Csv, &request(true)).unwrap();
    let mut found = totals(&table);
    found.sort_by_key(|(.., row, _)| *row);
    let distance = "have a squared distance that is 0 or not finite in an f64";
    let expected = [
        (BadKind::NoAxis("are the same point"), 3, 3, 4),
        (BadKind::NotFinite, 4, 4, 1),
        (BadKind::NoAxis(distance), 3, 5, 2),
        (BadKind::NotAboveZero, RADIUS, 7, 1),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_table_of_the_other_shape_is_recognized() {
    let spheres = Request::default();
    let cylinders = request(true);
    let two_ends = "name it by `Cylinders(file: …)`";
    let one_point = "name it by `Spheres(file: …)`";
    for (text, request, expected) in [
        ("x1,y1,z1,x2,y2,z2\n", &spheres, two_ends),
        ("x,y,z,radius\n", &cylinders, one_point),
        (
            "x1,y1,z1,x2,y2\n",
            &cylinders,
            "there is no column `z2`; the first line",
        ),
        (
            "0,0,0,1,1,1\n",
            &cylinders,
            "such as `x1,y1,z1,x2,y2,z2,radius`",
        ),
        ("x1,y1,z1,x2,y2,zz2\n", &cylinders, "did you mean `z2`?"),
    ] {
        let message = wanted(text.as_bytes(), Format::Csv, request).unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn shapes_of_arrays_are_explained() {
    for (columns, expected) in [
        (
            4,
            "expected (N, 6), (N, 7) with radius, (N, 9) with r, g, b, or (N, 10) with both; \
             `numpy.column_stack((x1, y1, z1, x2, y2, z2, radius, r, g, b))`",
        ),
        (
            8,
            "`columns: [\"x1\", \"y1\", \"z1\", \"x2\", \"y2\", \"z2\", …]`",
        ),
    ] {
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (2, {columns}), }}");
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.bytes());
        bytes.resize(bytes.len() + 16 * columns, 0);
        let message = wanted(&bytes, Format::Npy, &request(true)).unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_table_is_skipped_only_if_no_cylinder_encloses_the_point() {
    let mut rng = Rng(0xc711_de25_0000_0001);
    let (mut passed, mut enclosing) = (0, 0);
    for _ in 0..cases(20_000) {
        let mut number = |most: usize| rng.below(2 * most + 1) as f64 - most as f64;
        let mut text = "x1,y1,z1,x2,y2,z2,radius\n".to_owned();
        let point = DVec3::from([(); 3].map(|()| number(5)));
        let mut encloses = false;
        for _ in 0..4 {
            let [from, to] = [(); 2].map(|()| DVec3::from([(); 3].map(|()| number(3))));
            let radius = number(2).abs() + 0.5;
            let Ok(cylinder) = Cylinder::new(from, to, radius, true) else {
                continue;
            };
            let membership = Shape::from(cylinder).membership(point);
            encloses |= matches!(membership, Membership::Inside(..));
            let [from, to] = [from, to].map(|DVec3 { x, y, z }| format!("{x},{y},{z}"));
            let _ = writeln!(text, "{from},{to},{radius}");
        }
        let table = wanted(text.as_bytes(), Format::Csv, &request(true)).unwrap();
        assert!(table.may_enclose(point) || !encloses, "{text}{point:?}");
        passed += usize::from(!table.may_enclose(point));
        enclosing += usize::from(encloses);
    }
    assert!(passed > 0 && enclosing > 0, "{passed} {enclosing}");
}

#[test]
fn random_faults_are_survived() {
    let rows = cylinders(3);
    let request = request(true);
    let files = [npy(&rows, true, true), npy(&rows, false, false)];
    survives(&files, Format::Npy, &request, &["'", "(", "6", "7", "<f8"]);
    let files = [csv(&rows, true, true), csv(&rows, false, true)];
    survives(
        &files,
        Format::Csv,
        &request,
        &["\n", ",", "\"", "nan", "1e999", "x2"],
    );
}
