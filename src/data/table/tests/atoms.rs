//! Atoms as programs write them: kinds, models and records.

use super::{DEFAULTS, Sphere, spheres_of, wanted};
use crate::{
    data::{
        fault::{BadRows, Fault},
        table::{Format, Request, Table},
    },
    parallel::Pool,
    text::nearest::quote,
};

/// Returns the radii of the atoms, and the messages of all faults.
fn read(text: &str, format: Format, request: &Request) -> (Vec<Sphere>, Vec<String>) {
    let length = text.len() as u64;
    let table = Table::read(text.as_bytes(), length, format, request, |_| Pool::Calling);
    let table = table.unwrap_or_else(|error| panic!("{text}{error:?}"));
    let mut rows = Vec::new();
    table.any_block(|block| {
        rows.extend(spheres_of(block));
        false
    });
    let message = |bad: &BadRows| {
        let (code, Fault { message, help, .. }) = (bad.code(), &bad.fault);
        let help = help
            .as_ref()
            .map_or(String::new(), |help| format!("; {help}"));
        format!("{code}: {message}{help}")
    };
    (rows, table.bad_rows.iter().map(message).collect())
}

fn radii(text: &str, format: Format) -> (Vec<f64>, Vec<String>) {
    let (rows, messages) = read(text, format, &Request::default());
    (rows.iter().map(|row| row.1).collect(), messages)
}

const H: f64 = 1.2;
const C: f64 = 1.77;
const N: f64 = 1.66;
const O: f64 = 1.5;
const NEUTRAL: f64 = 1.0;

/// A PDB record: its name with the serial, the atom's name, the residue, and the end of the line.
fn record(start: &str, name: &str, residue: &str, end: &str) -> String {
    let start = format!("{start:<11} {name:4} {residue:4}A   1");
    format!("{start}       1.000   2.000   3.000  1.00  0.00{end}\n")
}

#[test]
fn the_first_model_ends_in_every_way() {
    let atom = record("ATOM      1", " O  ", "HOH", "           O");
    for end in ["END", "END   ", "ENDMDL", "end", "END\r", "MODEL        2"] {
        let text = format!("MODEL        1\n{atom}TER\n{end}\n{atom}");
        assert_eq!(radii(&text, Format::Pdb), (vec![O], vec![]), "{end}");
    }
    // A model without atoms is none.
    let text = format!("END\n{atom}ENDROOT\n{atom}");
    assert_eq!(radii(&text, Format::Pdb).0, [O, O]);
    let mac = format!("{atom}{atom}").replace('\n', "\r");
    assert_eq!(radii(&mac, Format::Pdb).0, [O, O]);
}

#[test]
fn elements_follow_from_names_and_residues() {
    for (name, residue, end, radius) in [
        ("N   ", "LYS", "", N),
        ("CA  ", "LYS", "", C),
        ("CE  ", "LYS", "", C),
        // The numbers of lines, before 1996.
        (" CA ", "GLY", "      9XYZ 612", C),
        (" CA ", "ALA", "      9XYZ 799", C),
        (" N  ", "ALA", "      1CRN7708", N),
        // A charge is no number of a line.
        (" N  ", "LIG", "           N1+", N),
        ("CA  ", "LIG", "          CA2+", 2.62),
    ] {
        let text = record("ATOM      1", name, residue, end);
        assert_eq!(radii(&text, Format::Pdb), (vec![radius], vec![]), "{text}");
    }
}

#[test]
fn serials_of_any_length_are_read() {
    for (start, serial) in [
        ("ATOM      7", 7.0),
        ("ATOM 100000", 100_000.0),
        ("ATOM1234567", 1_234_567.0),
        ("ATOM  123456", 123_456.0),
        ("HETATM12345", 12_345.0),
        ("HETATM123456", 123_456.0),
    ] {
        let text = format!("{start:<12} CA  GLY A   1       1.000   2.000   3.000");
        let request = Request {
            defaults: DEFAULTS,
            value: Some("serial"),
            ..Request::default()
        };
        let table = wanted(text.as_bytes(), Format::Pdb, &request).unwrap();
        assert_eq!(table.values().unwrap().range(), Some([serial; 2]), "{text}");
    }
}

#[test]
fn no_record_is_dropped() {
    let atom = record("ATOM      1", " CA ", "GLY", "           C");
    for line in [
        " ATOM      2  CA  GLY A   1      1.000   2.000   3.000",
        "atom      2  CA  GLY A   1       1.000   2.000   3.000",
        "HETAT     2  CA  GLY A   1       1.000   2.000   3.000",
        "ATOMS     2  CA  GLY A   1       1.000   2.000   3.000",
        "ATOM\t2\tCA\tGLY\tA\t1\t1.000\t2.000\t3.000",
        "HETTAM    2  CA  GLY A   1       1.000   2.000   3.000",
    ] {
        let name = quote(line[..6].trim_end());
        let (_, messages) = radii(&format!("{atom}{line}\n"), Format::Pdb);
        let expected = format!(
            "invalid-table: line 2: {name} is not a record; write `ATOM` or `HETATM`, in capitals from \
             the first column"
        );
        assert_eq!(messages, [expected], "{line}");
    }
    for line in [
        "REMARK  ATOM 1 is strange",
        "REMARK    1  CA  GLY A   1       1.000   2.000   3.000",
        "ANISOU    1  CA  GLY A   1      688   1234    806    -19    -49    178       C",
        "SIGATM    1  CA  GLY A   1       0.100   0.200   0.300",
        "HET    LIG  A   1      12",
        "CRYST1   52.000   58.600   61.900  90.00  90.00  90.00 P 21 21 21    8",
        "ORIGX1      1.000000  0.000000  0.000000        0.00000",
        "SCALE2      0.000000  0.017065  0.000000        0.00000",
        "CONECT    1    2",
        "TER       2      GLY A   1",
    ] {
        let found = radii(&format!("{line}\n{atom}"), Format::Pdb);
        assert_eq!(found, (vec![C], vec![]), "{line}");
    }
}

#[test]
fn shifted_columns_are_named() {
    let text = "ATOM      1  CA  GLY A   1         1.000   2.000   3.000  1.00  0.00\n";
    let (_, messages) = radii(text, Format::Pdb);
    let help =
        "the columns are shifted: x, y and z end in columns 38, 46 and 54, here in 40, 48 and 56";
    assert!(messages[0].ends_with(help), "{messages:?}");
}

#[test]
fn gray_balls_stand_for_other_kinds() {
    let warning = |place: &str, kind: &str| {
        let message = format!(
            "unknown-element: row 1 ({place}): the kind `{kind}` is not an element, a gray ball stands \
             for it; write elements, or give a `radius` and `color` or `color_by`"
        );
        vec![message]
    };
    for kind in ["X", "Du", "A", "Xx", "EPW", "LP", "119", "OW"] {
        let text = format!("2\n\nH 0 0 0\n{kind} 1 0 0\n");
        let expected = (vec![H, NEUTRAL], warning("line 4", kind));
        assert_eq!(radii(&text, Format::Xyz), expected);
        // The scene needs no elements.
        let request = Request {
            defaults: DEFAULTS,
            ..Request::default()
        };
        assert_eq!(read(&text, Format::Xyz, &request).1, [""; 0]);
    }
    let water = record("ATOM      1", " OW ", "SOL", "");
    for (name, end, shown, columns) in [
        (" MW ", "", "MW", "13-16"),
        (" EPW", "", "EPW", "13-16"),
        (" Du ", "", "Du", "13-16"),
        (" LP1", "          LP", "LP", "77-78"),
        (" X  ", "           X", "X", "77-78"),
    ] {
        let text = water.clone() + &record("ATOM      2", name, "SOL", end);
        let expected = warning(&format!("line 2, columns {columns}"), shown);
        assert_eq!(radii(&text, Format::Pdb), (vec![O, NEUTRAL], expected));
    }
    // An atom's line without its kind.
    let (_, messages) = radii("1\n\n0.5 1 2 3\n", Format::Xyz);
    assert!(
        messages[0].contains("`0.5` is not an element"),
        "{messages:?}"
    );
    let number = Request {
        defaults: DEFAULTS,
        value: Some("number"),
        ..Request::default()
    };
    let text = b"3\nAtoms. Timestep: 0\n1 0 0 0\n2 1 0 0\nQ 1 0 0";
    let table = wanted(text, Format::Xyz, &number).unwrap();
    let values = table.values().unwrap();
    assert_eq!((values.range(), values.missing), (Some([1.0, 2.0]), 1));
}

#[test]
fn kinds_are_in_several_columns() {
    let xyz = |properties: &str, row: &str| {
        let text = format!("1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties={properties}\n{row}\n");
        radii(&text, Format::Xyz)
    };
    for (properties, row) in [
        ("Z:I:1:pos:R:3", "6 0 0 0"),
        ("pos:R:3:Z:I:1", "0 0 0 6"),
        ("type:S:1:pos:R:3", "C 0 0 0"),
        ("'species:S:1:pos:R:3' pbc=\"T T T\"", "C 0 0 0"),
        ("\"species:S:1:pos:R:3\"", "C 0 0 0"),
        ("species:S:1:type:I:1:Z:I:1:pos:R:3", "C 3 6 0 0 0"),
        ("Species:S:1:Pos:R:3", "C 0 0 0"),
    ] {
        assert_eq!(xyz(properties, row), (vec![C], vec![]), "{properties}");
    }
    let (found, messages) = xyz("type:I:1:pos:R:3", "6 0 0 0");
    assert_eq!(
        (found, messages.len()),
        (vec![NEUTRAL], 1),
        "a type is not an atomic number"
    );
    let (_, messages) = xyz("species:S:1:pos:R:3:charge:R:1", "C 0 0 0");
    assert_eq!(
        messages,
        ["invalid-table: row 0 (line 3): 4 columns, expected 5"]
    );
    let text = "1\nProperties=pos:R:3\n1 2 3\n";
    let message = wanted(text.as_bytes(), Format::Xyz, &Request::default()).unwrap_err();
    assert!(
        message.contains("there is no `species:S:1`, `Z:I:1` or `type:I:1`"),
        "{message}"
    );
    let request = Request {
        defaults: DEFAULTS,
        ..Request::default()
    };
    assert_eq!(read(text, Format::Xyz, &request).1, [""; 0]);
}

#[test]
fn atoms_have_colors_and_radii_of_their_own() {
    let text = "2\nProperties=species:S:1:pos:R:3:color:R:3:radius:R:1\n\
        C 0 0 0 1 0 0 0.5\nA 2 0 0 0 0 1 0.25\n";
    let red = ([0.0; 3], 0.5, [1.0, 0.0, 0.0]);
    let blue = ([2.0, 0.0, 0.0], 0.25, [0.0, 0.0, 1.0]);
    let found = read(text, Format::Xyz, &Request::default());
    assert_eq!(found, (vec![red, blue], vec![]));
    let request = Request {
        value: Some("color.3"),
        defaults: DEFAULTS,
        ..Request::default()
    };
    let table = wanted(text.as_bytes(), Format::Xyz, &request).unwrap();
    assert_eq!(table.values().unwrap().range(), Some([0.0, 1.0]));
}

#[test]
fn kinds_that_are_the_first_letters_are_types() {
    let read = |kinds: &str| {
        let rows: String = kinds
            .chars()
            .map(|kind| format!("{kind} 0 0 0\n"))
            .collect();
        radii(&format!("{}\n\n{rows}", kinds.len()), Format::Xyz)
    };
    let boron = 1.91;
    for (kinds, expected) in [
        ("AB", vec![NEUTRAL; 2]),
        ("BAABC", vec![NEUTRAL; 5]),
        ("A", vec![NEUTRAL]),
        // There is a gap, or no `A`.
        ("AC", vec![NEUTRAL, C]),
        ("ACO", vec![NEUTRAL, C, O]),
        ("BC", vec![boron, C]),
        ("B", vec![boron]),
    ] {
        assert_eq!(read(kinds).0, expected, "{kinds}");
    }
    let (_, messages) = read("AB");
    assert!(
        messages[1].contains("(line 4): the kind `B` is a type as `A` is"),
        "{messages:?}"
    );
    // Names, columns and numbers are as before.
    let named = "2\nProperties=pos:R:3:species:S:1\n0 0 0 A\n1 0 0 B\n";
    assert_eq!(radii(named, Format::Xyz).0, [NEUTRAL; 2]);
}
