//! Tables of every kind, whole and broken.

mod atoms;
mod csv;
mod cylinders;
mod npy;
mod npz;
mod ply;
mod row_cells;
mod texts;
mod values;

use glam::DVec3;

use super::{
    Bad, BadKind, Block, COLORS, Column, Defaults, Fault, Format, RADIUS, ReadError, Request,
    Table, check::Check, layout::BLOCK,
};
use crate::{
    data::table::kind::RowKind,
    parallel::Pool,
    tracer::random::{Rng, cases},
};

/// Center, radius and color of a row.
pub(super) type Sphere = ([f64; 3], f64, [f64; 3]);

/// Defaults for every row.
pub(super) const DEFAULTS: Defaults = Defaults {
    kind: RowKind::Sphere,
    radius: Some(0.75),
    color: Some([0.25, 0.5, 1.0]),
};

pub(super) fn table(bytes: &[u8], format: Format, defaults: &Defaults) -> Result<Table, String> {
    let request = Request {
        defaults: *defaults,
        ..Request::default()
    };
    wanted(bytes, format, &request)
}

/// Reads a table as a scene wants it.
pub(super) fn wanted(bytes: &[u8], format: Format, request: &Request) -> Result<Table, String> {
    let read = Table::read(bytes, bytes.len() as u64, format, request, |_| {
        Pool::Calling
    });
    let described = |fault: Fault| match fault.help {
        Some(help) => format!("{}; {help}", fault.message),
        None => fault.message,
    };
    match read {
        Ok(table) => match table.bad_rows.iter().find(|bad| bad.is_error()) {
            Some(bad) => Err(described(bad.fault.clone())),
            None => Ok(table),
        },
        Err(ReadError::Io(error)) => panic!("{error}"),
        Err(ReadError::Invalid(fault)) => Err(described(fault)),
    }
}

pub(super) fn rows(bytes: &[u8], format: Format) -> Result<Vec<Sphere>, String> {
    let table = table(bytes, format, &DEFAULTS)?;
    let mut rows = Vec::new();
    table.any_block(|block| {
        rows.extend(spheres_of(block));
        false
    });
    assert_eq!(rows.len(), table.rows());
    Ok(rows)
}

/// Returns center, radius and color of each row.
pub(super) fn spheres_of(block: &Block) -> impl Iterator<Item = Sphere> {
    let [.., radius, r, g, b, _] = &block.columns;
    let colors = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]);
    let rows = block.points().zip(radius).zip(colors);
    rows.map(|((center, radius), color)| (center.into(), *radius, color))
}

/// Returns the first spheres of a sequence; an f32 holds each of their numbers.
pub(super) fn spheres(count: usize) -> Vec<Sphere> {
    let number = |index: usize, factor: f64| (index as f64 - 3.0) * factor;
    let sphere = |index| {
        let center = [
            number(index, 0.5),
            number(index, -1024.25),
            number(index, 4096.0),
        ];
        let color = [0.0, 0.125 * (index % 9) as f64, 1.0];
        (center, 0.25 + index as f64, color)
    };
    (0..count).map(sphere).collect()
}

/// Replaces the radii or the colors of spheres by the defaults.
pub(super) fn with_defaults(spheres: Vec<Sphere>, radius: bool, color: bool) -> Vec<Sphere> {
    let given = |(center, r, c)| {
        let radius = if radius { DEFAULTS.radius.unwrap() } else { r };
        (
            center,
            radius,
            if color { DEFAULTS.color.unwrap() } else { c },
        )
    };
    spheres.into_iter().map(given).collect()
}

/// Checks that neither a part of a file nor one with trailing bytes is read as a whole.
pub(super) fn neither_shorter_nor_longer(bytes: &[u8], format: Format) {
    assert!(rows(bytes, format).is_ok());
    for end in 0..bytes.len() {
        let message = rows(&bytes[..end], format).expect_err("a part of a file");
        assert!(!message.is_empty() && !message.contains('\n'), "{message}");
    }
    let longer = [bytes, b"1"].concat();
    let longer = table(&longer, format, &DEFAULTS);
    let message = match format {
        Format::Ply | Format::Npy => longer.unwrap().behind.unwrap().message,
        _ => longer.expect_err("a file with more behind it"),
    };
    assert!(message.contains("after the last row"), "{message}");
}

/// Checks that a single pass over all bytes finds the same faults as the passes while reading.
fn assert_checked(table: &Table) {
    let mut check = Check::new(table.layout);
    check.look(&table.bytes);
    assert_eq!(format!("{:?}", check.found), format!("{:?}", table.bad));
}

/// Returns spheres of several blocks, with wrong numbers in rows at the ends and starts of blocks.
pub(super) fn bad_spheres() -> Vec<Sphere> {
    let mut bad = spheres(3 * BLOCK + 7);
    for row in [0, BLOCK - 1, BLOCK, 2 * BLOCK + 1, 3 * BLOCK + 6] {
        let (center, radius, color) = &mut bad[row];
        center[2] = f64::NAN;
        *radius = -1.0;
        color[1] = 2.0;
    }
    bad
}

/// Returns the faults of the numbers in a table: the first row of each kind in a column, and how many
/// there are.
pub(super) fn totals(table: &Table) -> Vec<(BadKind, usize, usize, usize)> {
    let mut totals: Vec<(BadKind, usize, usize, usize)> = Vec::new();
    for bad in &table.bad {
        let mut known = totals.iter_mut();
        match known.find(|(kind, column, ..)| (*kind, *column) == (bad.kind, bad.column)) {
            Some((.., count)) => *count += bad.count,
            None => totals.push((bad.kind, bad.column, bad.row, bad.count)),
        }
    }
    totals
}

/// Checks that the faults of [`bad_spheres`] are found while reading.
pub(super) fn finds_bad_spheres(bytes: &[u8], format: Format) {
    let table = table(bytes, format, &DEFAULTS).unwrap();
    assert_checked(&table);
    let found = totals(&table);
    let expected = [
        (BadKind::NotFinite, 2, 0, 5),
        (BadKind::NotAboveZero, RADIUS, 0, 5),
        (BadKind::Clamped, COLORS.start + 1, 0, 5),
    ];
    assert_eq!(found, expected);
}

/// Checks that any bytes are either read as a table or rejected.
pub(super) fn survives_faults(files: &[Vec<u8>], format: Format, pieces: &[&str]) {
    survives(files, format, &Request::default(), pieces);
}

/// The same for a table as a scene wants it.
pub(super) fn survives(files: &[Vec<u8>], format: Format, request: &Request, pieces: &[&str]) {
    let mut rng = Rng(0x7ab1_e5ee_d000_0001);
    let (mut read, count) = (0, cases(20_000));
    for round in 0..count {
        let mut bytes = files[round % files.len()].clone();
        for _ in 0..=rng.below(3) {
            // Most faults are possible in the header.
            let length = if rng.below(2) == 0 {
                bytes.len()
            } else {
                bytes.len().min(150)
            };
            let at = rng.below(length + 1).min(bytes.len());
            let end = (at + rng.below(9)).min(bytes.len());
            match rng.below(5) {
                0 => drop(bytes.drain(at..end)),
                1 => bytes.insert(at, rng.next() as u8),
                2 if at < bytes.len() => bytes[at] = rng.next() as u8,
                3 if rng.below(8) == 0 => bytes.truncate(at),
                _ => {
                    let piece = pieces[rng.below(pieces.len())].bytes();
                    bytes.splice(at..end, piece);
                }
            }
        }
        if let Ok(table) = wanted(&bytes, format, request) {
            read += 1;
            let mut rows = 0;
            table.any_row(|_| {
                rows += 1;
                false
            });
            assert_eq!(rows, table.rows());
            assert_checked(&table);
        }
    }
    assert!(read > count / 50, "nearly everything is refused: {read}");
}

#[test]
fn extensions_select_the_format() {
    assert_eq!(Format::of_name("a/b.CSV"), Some(Format::Csv));
    assert_eq!(Format::of_name("x.npy"), Some(Format::Npy));
    assert_eq!(Format::of_name(".Ply"), Some(Format::Ply));
    assert_eq!(Format::of_name("x.npz"), Some(Format::Npz));
    assert_eq!(Format::of_name("x.XYZ"), Some(Format::Xyz));
    assert_eq!(Format::of_name("1abc.pdb"), Some(Format::Pdb));
    for name in ["", "csv", "a.csv.gz", "a.npx", "a.csv/"] {
        assert_eq!(Format::of_name(name), None, "{name}");
    }
}

/// Creates a table from the numbers of three columns: x, radius and red.
fn table_of(numbers: &[[f64; 3]]) -> Table {
    let mut text = "x,y,z,radius,r,g,b\n".to_owned();
    for [x, radius, red] in numbers {
        text += &format!("{x},0,0,{radius},{red},0,1\n");
    }
    table(text.as_bytes(), Format::Csv, &Defaults::default()).unwrap()
}

#[test]
fn bad_numbers_are_listed_by_column() {
    let mut numbers = vec![[0.0, 1.0, 1.0]; 3000];
    numbers[700][0] = f64::NAN;
    numbers[5][1] = f64::INFINITY;
    numbers[6][1] = -0.0;
    numbers[2999][1] = -2.0;
    numbers[1500][1] = 0.0;
    numbers[600][2] = 1.0000000000000002;
    numbers[601][2] = -0.5;
    numbers[9][2] = f64::NEG_INFINITY;
    let table = table_of(&numbers);
    let expected = [
        (BadKind::NotFinite, RADIUS, 5, f64::INFINITY, 0),
        (BadKind::NotAboveZero, RADIUS, 6, -0.0, 0),
        (BadKind::NotAboveZero, RADIUS, 1500, 0.0, 1),
        (BadKind::NotAboveZero, RADIUS, 2999, -2.0, 2),
        (BadKind::NotFinite, COLORS.start, 9, f64::NEG_INFINITY, 0),
        (BadKind::NotFinite, 0, 700, f64::NAN, 0),
        (BadKind::Clamped, COLORS.start, 600, 1.0000000000000002, 0),
        (BadKind::Clamped, COLORS.start, 601, -0.5, 1),
    ];
    let expected = expected.map(|(kind, column, row, value, before)| Bad {
        kind,
        column,
        row,
        value,
        before,
        count: 1,
    });
    let sorted = |mut found: Vec<String>| {
        found.sort();
        found
    };
    let shown = |all: &[Bad]| sorted(all.iter().map(|bad| format!("{bad:?}")).collect());
    assert_eq!(shown(&table.bad), shown(&expected));
    assert_eq!(table_of(&[[0.0, 5e-324, 0.0], [-1e300, 1.0, 1.0]]).bad, []);
}

#[test]
fn the_numbers_beyond_the_listed_ones_are_counted() {
    let table = table_of(&vec![[0.0, -1.0, 0.0]; 3000]);
    let counts: Vec<_> = table.bad.iter().map(|bad| (bad.row, bad.count)).collect();
    assert_eq!(counts.len(), 100);
    assert_eq!(
        (counts[0], counts[98], counts[99]),
        ((0, 1), (98, 1), (99, 2901))
    );
}

#[test]
fn values_for_all_rows_are_not_checked_again() {
    let defaults = Defaults {
        radius: Some(-1.0),
        color: Some([f64::NAN; 3]),
        ..Defaults::default()
    };
    let table = table(b"x,y,z\n1,2,3\n", Format::Csv, &defaults).unwrap();
    assert_eq!(table.bad, []);
    assert!(table.has_radius() && table.has_color());
    assert_eq!(table.layout.columns[RADIUS], Some(Column::Constant(-1.0)));
}

#[test]
fn blocks_stop_on_request() {
    let table = table_of(&vec![[0.0, 1.0, 1.0]; 5000]);
    let mut seen = Vec::new();
    let stopped = table.any_block(|block: &Block| {
        seen.push(block.first);
        block.first > 0
    });
    assert!(stopped);
    assert_eq!(seen, [0, BLOCK]);
    assert!(!table.any_block(|_| false));
}

#[test]
fn a_table_is_skipped_only_if_it_encloses_nothing() {
    let mut rng = Rng(0xe77e_9700_0000_0001);
    let (mut passed, mut enclosing) = (0, 0);
    for _ in 0..cases(20_000) {
        // Points on a coarse grid often touch; those of all magnitudes round in every way.
        let magnitude = [1.0, 1.0, 1.0, 1e-170, 1e-8, 1e160][rng.below(6)];
        let mut number = |most: usize| {
            let grid = rng.below(2 * most + 1) as f64 - most as f64;
            let off = [0.0, 0.0, f64::EPSILON, -0.1][rng.below(4)];
            (grid + off) * magnitude
        };
        let spheres = [(); 10].map(|()| ([(); 3].map(|()| number(3)), number(2).abs()));
        let point = DVec3::from([(); 3].map(|()| number(5)));
        let mut text = "x,y,z,radius\n".to_owned();
        for ([x, y, z], radius) in &spheres {
            text += &format!("{x:?},{y:?},{z:?},{radius:?}\n");
        }
        let table = table(text.as_bytes(), Format::Csv, &DEFAULTS).unwrap();
        let encloses = spheres
            .iter()
            .any(|(center, radius)| (point - DVec3::from(*center)).length() < *radius);
        assert!(table.may_enclose(point) || !encloses, "{text}{point:?}");
        passed += usize::from(!table.may_enclose(point));
        enclosing += usize::from(encloses);
    }
    assert!(passed > 0 && enclosing > 0, "{passed} {enclosing}");
}

#[test]
fn a_larger_radius_given_later_may_enclose_more() {
    let far = DVec3::new(9.0, 0.0, 0.0);
    for text in ["x,y,z\n1,0,0\n", "x,y,z,radius\n1,0,0,\n"] {
        let mut table = table(text.as_bytes(), Format::Csv, &DEFAULTS).unwrap();
        assert!(!table.may_enclose(far), "{text}");
        table.set_defaults(&Defaults {
            radius: Some(8.5),
            ..DEFAULTS
        });
        assert!(table.may_enclose(far), "{text}");
    }
}
