//! Values that determine colors, and files of atoms and named arrays.

use std::fmt::Write as _;

use super::{
    DEFAULTS, Defaults, Format, Request, Table, rows, spheres_of, survives_faults, wanted,
};

const MANY: usize = 1700;

fn request(value: &str) -> Request<'_> {
    Request {
        defaults: DEFAULTS,
        value: Some(value),
        ..Request::default()
    }
}

fn values(table: &Table) -> Vec<f64> {
    let mut values = Vec::new();
    table.any_block(|block| {
        values.extend(block.values());
        false
    });
    values
}

/// Values with gaps, of several blocks.
fn energies() -> impl Iterator<Item = Option<f64>> {
    (0..MANY).map(|row| (row % 7 != 3).then_some(row as f64 * 0.5 - 100.0))
}

#[test]
fn every_format_has_the_same_values() {
    let mut csv = "energy,x,y,z,name\n".to_owned();
    let mut quoted = csv.clone();
    let mut ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {MANY}\nproperty float x\nproperty float y\n\
         property float z\nproperty double energy\nend_header\n"
    );
    let mut xyz = format!("{MANY}\nProperties=energy:R:1:species:S:1:pos:R:3\n");
    for energy in energies() {
        let text = energy.map_or_else(String::new, |energy| energy.to_string());
        let _ = writeln!(csv, "{text},1,2,3,a name");
        let _ = writeln!(quoted, "{text},1,2,3,\"a, name\"");
        let number = energy.unwrap_or(f64::NAN);
        let _ = writeln!(ply, "1 2 3 {number}");
        let _ = writeln!(xyz, "{number} C 1 2 3");
    }
    for (text, format) in [
        (csv, Format::Csv),
        (quoted, Format::Csv),
        (ply, Format::Ply),
        (xyz, Format::Xyz),
    ] {
        let table = wanted(text.as_bytes(), format, &request("energy")).unwrap();
        let expected = energies().map(|energy| energy.unwrap_or(f64::NAN).to_bits());
        assert!(
            values(&table).into_iter().map(f64::to_bits).eq(expected),
            "{format:?}"
        );
        let about = table.values().unwrap();
        assert_eq!(
            about.range(),
            Some([-100.0, (MANY - 1) as f64 * 0.5 - 100.0])
        );
        assert_eq!(about.missing, energies().filter(Option::is_none).count());
        // A coordinate, and a radius that the scene gives.
        let table = wanted(text.as_bytes(), format, &request("y")).unwrap();
        assert_eq!(values(&table), vec![2.0; MANY], "{format:?}");
        let table = wanted(text.as_bytes(), format, &request("Y")).unwrap();
        assert!(table.values().is_none() && table.names.all.contains(&"energy".to_owned()));
    }
}

#[test]
fn a_column_may_be_radius_and_value() {
    for text in [
        "radius,x,y,z\n2,1,1,1\n,1,1,1\n",
        "x,y,z,radius\n\"1\",1,1,2\n1,1,1,\n",
    ] {
        let table = wanted(text.as_bytes(), Format::Csv, &request("radius")).unwrap();
        assert_eq!(values(&table), [2.0, DEFAULTS.radius.unwrap()]);
    }
}

#[test]
fn columns_are_named_by_the_scene() {
    let columns = ["_", "z", "y", "x", "radius"].map(Box::from);
    let read = |text: &str| {
        let request = Request {
            defaults: DEFAULTS,
            columns: Some(&columns),
            ..Request::default()
        };
        wanted(text.as_bytes(), Format::Csv, &request)
    };
    for text in [
        "a,3,2,1,0.5\nb,6,5,4,\n",
        "\u{feff}\"a\",3,2,1,0.5\r\n\"b\",6,5,4,\r\n",
    ] {
        let table = read(text).unwrap();
        assert_eq!((table.rows(), table.line(1)), (2, Some(2)), "{text:?}");
        assert!(table.names.unused.is_empty());
    }
    let message = read("a,3,2,1,0.5\nb,six,5,4,1\n").unwrap_err();
    assert_eq!(message, "row 1 (line 2), column `z`: `six` is not a number");
}

#[test]
fn other_columns_are_unused() {
    let unused = |text: &str, value: Option<&str>| {
        let request = Request {
            value,
            ..request("")
        };
        wanted(text.as_bytes(), Format::Csv, &request)
            .unwrap()
            .names
            .unused
            .join(" ")
    };
    assert_eq!(unused("x,y,z,a,b2,_c\n", None), "a b2");
    assert_eq!(unused("x,y,z,a,b2,_c\n", Some("a")), "b2");
    assert_eq!(unused("x,y,z,r,g,b,a\n", Some("a")), "r g b");
    assert_eq!(unused(",x,y,z\n", None), "");
}

#[test]
fn atoms_may_start_with_a_byte_order_mark() {
    let pdb = "ATOM      1  CA  GLY A   1       1.000   2.000   3.000  1.00  0.00           C\n";
    let pdb = pdb.repeat(2);
    for (text, format) in [
        ("2\n\nC 1 2 3\nO 1 2 4\n", Format::Xyz),
        (&pdb, Format::Pdb),
    ] {
        let read = |text: &str| rows(text.as_bytes(), format).unwrap();
        assert_eq!(read(text).len(), 2);
        assert_eq!(read(&format!("\u{feff}{text}")), read(text));
    }
}

#[test]
fn elements_give_radii_and_colors() {
    let atoms = |text: &str, format, defaults: Defaults| {
        let request = Request {
            defaults,
            ..Request::default()
        };
        let table = wanted(text.as_bytes(), format, &request).unwrap();
        let mut rows = Vec::new();
        table.any_block(|block| {
            rows.extend(spheres_of(block));
            false
        });
        rows
    };
    let byte = |byte: u8| f64::from(byte) / 255.0;
    let carbon = ([1.0, 2.0, 3.0], 1.77, [byte(0x90); 3]);
    let calcium = ([1.0, 2.0, 3.0], 2.62, [byte(0x3d), 1.0, 0.0]);
    for text in [
        "1\n\nC 1 2 3\n",
        "1\r\ncomment\r\n6 1 2 3 9\r\n",
        "1\n\nC12 1 2 3\n1\n\nH 0 0 0",
    ] {
        assert_eq!(
            atoms(text, Format::Xyz, Defaults::default()),
            [carbon],
            "{text}"
        );
    }
    let red = Defaults {
        radius: Some(0.25),
        color: Some([1.0, 0.0, 0.0]),
        ..Defaults::default()
    };
    let found = atoms("1\n\nC 1 2 3\n", Format::Xyz, red);
    assert_eq!(found, [([1.0, 2.0, 3.0], 0.25, [1.0, 0.0, 0.0])]);
    for (name, expected) in [(" CA ", carbon), ("CA  ", calcium), (" C1'", carbon)] {
        let line = format!("HETATM    1 {name} LIG A   1       1.000   2.000   3.000\n");
        assert_eq!(
            atoms(&line, Format::Pdb, Defaults::default()),
            [expected],
            "{name}"
        );
    }
    let own = "2\nProperties=species:S:1:pos:R:3:radius:R:1\nC 1 2 3 0.5\nC 1 2 3 0.25\n";
    let radii: Vec<_> = atoms(own, Format::Xyz, Defaults::default())
        .iter()
        .map(|atom| atom.1)
        .collect();
    assert_eq!(radii, [0.5, 0.25]);
    let hydrogen = "ATOM      1 HG11 VAL A   1       1.000   2.000   3.000\n";
    assert_eq!(atoms(hydrogen, Format::Pdb, Defaults::default())[0].1, 1.2);
}

#[test]
fn faults_of_atoms_name_line_and_column() {
    for (text, format, expected) in [
        (
            "two\n",
            Format::Xyz,
            "line 1: `two` is not the number of atoms; the first lines are the number of atoms and a \
             comment",
        ),
        (
            "2\n1 2 3\n4 5 6\n",
            Format::Xyz,
            "line 3: three numbers, expected an element and three numbers; a cloud of points has no number \
             of atoms: remove the first line",
        ),
        (
            "2\n\nC 0 0 0\n",
            Format::Xyz,
            "the file is cut off: 1 of 2 atoms",
        ),
        (
            "99999999999\n\n",
            Format::Xyz,
            "the file is cut off: 0 of 99999999999 atoms",
        ),
        (
            "1\n\nC 0 0 0\nC 0 0 0",
            Format::Xyz,
            "line 4: text after the last of 1 atoms",
        ),
        // With atomic numbers, an atom's line begins like a count.
        (
            "1\n\n6 0 0 0\n8 1 0 0",
            Format::Xyz,
            "line 4: text after the last of 1 atoms",
        ),
        // Each column takes memory.
        (
            "1\nProperties=species:S:1:pos:R:3:q:R:65535\nC 0 0 0\n",
            Format::Xyz,
            "line 2: too many columns in `Properties`; they are names, types and counts, such as \
             `species:S:1:pos:R:3:energy:R:1`",
        ),
        (
            "1\nProperties=species:S:1:pos:R:3:x:R:1\nC 0 0 0 0\n",
            Format::Xyz,
            "line 2: `x` is given twice in `Properties`",
        ),
        (
            "1\nProperties=species:S:1:pos:R:3:q:R:1:q:R:1\nC 0 0 0 0 0\n",
            Format::Xyz,
            "line 2: `q` is given twice in `Properties`",
        ),
        (
            "ATOM      1  C   ALA A   1       1.000   2.000   3.0",
            Format::Pdb,
            "row 0 (line 1, columns 47-54): the line is cut off after `3.0`",
        ),
        (
            "1\n\nC 0 b 0\n",
            Format::Xyz,
            "row 0 (line 3), column `y`: `b` is not a number",
        ),
        (
            "1\n\nC 0 0\n",
            Format::Xyz,
            "row 0 (line 3), column `z`: a number is missing",
        ),
        (
            "HEADER\nATOM      1  C   ALA A   1       1.000   2.0x0   3.000",
            Format::Pdb,
            "row 0 (line 2, columns 39-46): `2.0x0` is not a number",
        ),
        (
            "HEADER\n",
            Format::Pdb,
            "there is no `ATOM` or `HETATM` record",
        ),
    ] {
        assert_eq!(
            rows(text.as_bytes(), format),
            Err(expected.to_owned()),
            "{text}"
        );
    }
}

#[test]
fn random_faults_are_survived() {
    let npz = |name: &str| std::fs::read(format!("tests/valid/tables/{name}.npz")).unwrap();
    let files = [
        "values",
        "numpy-columns-xyz-radius-color",
        "numpy-fields-xyz-color",
    ]
    .map(npz);
    survives_faults(&files, Format::Npz, &["PK", "NUMPY", "(", "99999999999"]);
    let files = [
        b"2\nProperties=species:S:1:pos:R:3:f:R:3\nC 1 2 3 4 5 6\nO 1 2 3 4 5 6\n".to_vec(),
        b"1\n\nC 1 2 3\n1\n".to_vec(),
        b"1\nAtoms. Timestep: 0\n1 1 2 3\n".to_vec(),
        b"1\nProperties='Z:I:1:pos:R:3:color:R:3:type:I:1'\n6 1 2 3 1 0 0 7\n".to_vec(),
    ];
    survives_faults(
        &files,
        Format::Xyz,
        &[
            "\n", " ", ":", "9999999", "R", "nan", "\u{e9}", "Z", "color", "'", "\r",
        ],
    );
    let files = [std::fs::read("tests/valid/tables/water.pdb").unwrap()];
    survives_faults(
        &files,
        Format::Pdb,
        &[
            "\n", "ATOM  ", "HETAT", "ENDMDL", "END", "nan", "\u{e9}", "999999", "\r", "\t",
        ],
    );
}
