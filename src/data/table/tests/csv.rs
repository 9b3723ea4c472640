use std::{
    fmt::Write as _,
    io::{self, Read},
};

use super::{
    DEFAULTS, Defaults, Format, ReadError, Request, Table, rows, spheres_of, survives_faults,
    table, wanted,
};
use crate::{
    data::table::kind::RowKind,
    parallel::Pool,
    tracer::random::{Rng, cases},
};

#[test]
fn columns_can_be_in_any_order() {
    let expected = Ok(vec![
        ([1.0, 2.0, 3.0], 0.5, [1.0, 0.0, 0.2]),
        ([-1e3, 0.25, 0.1], 7.0, [0.0, 0.4, 1.0]),
    ]);
    for text in [
        "x,y,z,radius,r,g,b\n1,2,3,0.5,1,0,0.2\n-1e3,.25,1e-1,7,0,0.4,1\n",
        "b,g,r,radius,z,y,x\n0.2,0,1,0.5,3,2,1\n1,0.4,0,7,0.1,0.25,-1000\n",
        "\u{feff}x, y, z, radius, color\r\n1, 2 ,3,0.5,#ff0033\r\n-1e3,+.25,.1,7,#0066FF",
        "color,\"x\",y,z,radius\n\n\"#f03\",1.,2.0,\"3\",0.5\n\n#06f,-1000,0.25,0.1,7.0\n\n",
    ] {
        assert_eq!(rows(text.as_bytes(), Format::Csv), expected, "{text}");
    }
}

#[test]
fn the_scene_gives_defaults_for_missing_columns() {
    let (radius, color) = (DEFAULTS.radius.unwrap(), DEFAULTS.color.unwrap());
    for (text, expected) in [
        ("x,y,z\n1,2,3\n", vec![([1.0, 2.0, 3.0], radius, color)]),
        (
            "x,y,z,radius,color\n1,2,3,,#000\n1,2,3,4,\n",
            vec![
                ([1.0, 2.0, 3.0], radius, [0.0; 3]),
                ([1.0, 2.0, 3.0], 4.0, color),
            ],
        ),
        (
            "x,y,z,r,g,b\n1,2,3,,,\n",
            vec![([1.0, 2.0, 3.0], radius, color)],
        ),
        ("x,y,z\n", vec![]),
        ("x,y,z,radius", vec![]),
    ] {
        assert_eq!(rows(text.as_bytes(), Format::Csv), Ok(expected), "{text}");
    }
    let none = |text: &str| table(text.as_bytes(), Format::Csv, &Defaults::default());
    let bare = none("x,y,z\n1,2,3\n").unwrap();
    assert!(!bare.has_radius() && !bare.has_color());
    let message = none("x,y,z,radius\n1,2,3,1\n1,2,3,\n").unwrap_err();
    assert!(
        message.starts_with("row 1 (line 3), column `radius`: the cell is empty"),
        "{message}"
    );
    let message = none("x,y,z,color\n1,2,3,\n").unwrap_err();
    assert!(
        message.starts_with("row 0 (line 2), column `color`: the cell is empty"),
        "{message}"
    );
    let message = none("x,y,z,r,g,b\n1,2,3,,0,\n").unwrap_err();
    assert!(
        message.starts_with("row 0 (line 2), column `r`: the cell is empty"),
        "{message}"
    );
}

#[test]
fn faults_name_row_line_and_column() {
    for (text, expected) in [
        (
            "x,y,z\n1,2,3\n\n1,two,3\n",
            "row 1 (line 4), column `y`: `two` is not a number",
        ),
        (
            "x,y,z\r\n1,2,3\r\n\r\n1,2,!",
            "row 1 (line 4), column `z`: `!` is not a number",
        ),
        (
            "x,y,z\n1,,3\n",
            "row 0 (line 2), column `y`: the cell is empty",
        ),
        ("x,y,z\n1,2\n", "row 0 (line 2): 2 columns, expected 3"),
        ("x,y,z\n1,2,3,\n", "row 0 (line 2): 4 columns, expected 3"),
        (
            "x,y,z\n0x1,2,3\n",
            "row 0 (line 2), column `x`: `0x1` is not a number",
        ),
        (
            "x,y,z\n\"1,5\",2,3\n",
            "row 0 (line 2), column `x`: `1,5` is not a number",
        ),
        (
            "x,y,z,color\n1,2,3,red\n",
            "row 0 (line 2), column `color`: `red` is not a color, expected `#rrggbb` or `#rgb`",
        ),
        (
            "x,y,z,radius,radius\n",
            "the column `radius` is given twice; remove one of the two",
        ),
        (
            "x,y,z,r,g\n",
            "of the columns `r`, `g` and `b` only some are given; give all three, or none",
        ),
        (
            "x,y,z,r,g,b,color\n",
            "the color is given twice, as `color` and as `r`, `g` and `b`; remove one of the two",
        ),
    ] {
        assert_eq!(
            rows(text.as_bytes(), Format::Csv),
            Err(expected.to_owned()),
            "{text}"
        );
    }
    for (text, words) in [
        ("x,y,radios\n", ["`radios`", "did you mean `radius`?"]),
        (
            "x,y,material\n",
            ["`z`", "the first line names the columns"],
        ),
        ("x;y;z\n1;2;3\n", ["`x;y;z`", "separated by commas"]),
        (
            "1,2,3\n4,5,6\n",
            ["`1`", "the first line names the columns"],
        ),
        (
            "x,y\n1,2\n",
            ["no column `z`", "the first line names the columns"],
        ),
        (
            "\n\n",
            ["no column `x`", "the first line names the columns"],
        ),
    ] {
        let message = rows(text.as_bytes(), Format::Csv).unwrap_err();
        for word in words {
            assert!(message.contains(word), "no {word:?} in: {message}");
        }
    }
    let message = rows(b"x,y,\xff\n1,2,3\n", Format::Csv).unwrap_err();
    assert_eq!(message, "the header is not UTF-8");
    let message = rows(b"x,y,z\n1,2,\xff\n", Format::Csv).unwrap_err();
    assert!(
        message.starts_with("row 0 (line 2), column `z`"),
        "{message}"
    );
}

#[test]
fn all_unreadable_rows_are_reported_at_once() {
    let text = "x,y,z,radius\n1,2,3\n1,a,3,\n1,2,3,4\n1,b,c,-1\n1,2,3,4,5\n";
    let read = Table::read(
        text.as_bytes(),
        text.len() as u64,
        Format::Csv,
        &Request::default(),
        |_| Pool::Calling,
    );
    let table = read.unwrap();
    let described = table.bad_rows.iter();
    let described: Vec<_> = described
        .map(|bad| (bad.row, bad.count, bad.fault.message.as_str()))
        .collect();
    let expected = [
        (0, 1, "row 0 (line 2): 3 columns, expected 4"),
        (1, 1, "row 1 (line 3), column `y`: `a` is not a number"),
        (1, 1, "row 1 (line 3), column `radius`: the cell is empty"),
        (3, 1, "row 3 (line 5), column `y`: `b` is not a number"),
        (3, 1, "row 3 (line 5), column `z`: `c` is not a number"),
        (4, 1, "row 4 (line 6): 5 columns, expected 4"),
    ];
    assert_eq!(described, expected);
    assert_eq!((table.rows(), table.bad.len()), (5, 1));
}

#[test]
fn a_line_without_end_is_not_read_to_the_end_of_the_file() {
    let usual = "0,0,0,a\n".repeat(40);
    let quoted = "\"0\",0,0,a\n".repeat(40);
    for (start, line) in [
        ("x,y,".to_owned(), 1),
        ("x,y,z,a\n".to_owned(), 2),
        (format!("x,y,z,a\n{usual}0,0,0,"), 42),
        (format!("x,y,z,a\r\n{usual}{quoted}{usual}0,0,0,"), 122),
    ] {
        let length = 1 << 26;
        let mut rest = io::repeat(b'0').take(length - start.len() as u64);
        let file = start.as_bytes().chain(&mut rest);
        let request = Request {
            defaults: DEFAULTS,
            ..Request::default()
        };
        let read = Table::read(file, length, Format::Csv, &request, |_| Pool::Calling);
        let Err(ReadError::Invalid(fault)) = read else {
            panic!("{read:?}");
        };
        assert_eq!(fault.message, format!("line {line}: longer than 1 MiB"));
        assert!(rest.limit() > length - (1 << 24), "line {line}");
    }
    // The same for one that ends, in a column that is not read.
    let name = |length| format!("x,y,z,a\n{usual}0,0,0,{}\n{usual}", "b".repeat(length));
    let rows = |length: usize| rows(name(length).as_bytes(), Format::Csv).map(|rows| rows.len());
    assert_eq!(rows((1 << 20) - "0,0,0,".len()), Ok(81));
    let longer = "line 42: longer than 1 MiB; a row of a table is one line";
    assert_eq!(rows(1 << 20), Err(longer.to_owned()));
}

#[test]
fn an_empty_angle_of_a_copy_is_an_empty_cell() {
    let request = Request {
        defaults: Defaults {
            kind: RowKind::Copy,
            radius: Some(1.0),
            color: None,
        },
        ..Request::default()
    };
    let read = |text: &str| wanted(text.as_bytes(), Format::Csv, &request);
    for row in ["1,2,3,,", "1,2,3,2,", "\"1\",2,3,2,"] {
        assert_eq!(
            read(&format!("x,y,z,scale,angle\n1,2,3,4,5\n{row}\n")).unwrap_err(),
            "row 1 (line 3), column `angle`: the cell is empty"
        );
    }
    let table = read("x,y,z,scale,angle\n1,2,3,,5\n").unwrap();
    assert_eq!((table.rows(), table.bad.len()), (1, 0));
}

#[test]
fn a_row_has_its_line_if_none_is_skipped() {
    let read = |text: &str| table(text.as_bytes(), Format::Csv, &Defaults::default()).unwrap();
    assert_eq!(read("x,y,z\n1,2,3\n4,5,6\n").line(1), Some(3));
    assert_eq!(read("x,y,z\n1,2,3\n\n4,5,6\n").line(1), None);
}

#[test]
fn random_faults_are_survived() {
    let files = [
        b"x,y,z,radius,r,g,b\n1,2,3,0.5,1,0,0.2\n-1e3,.25,1e-1,7,0,0.4,1\n".to_vec(),
        b"color,x,y,z\n#f03,1,2,3\n\"#06f\",-1000,0.25,0.1\n".to_vec(),
    ];
    let pieces = [
        "\"", ",", "\n", "\r", "nan", "inf", "1e999", "#", ";", "\u{feff}", "\0", "é",
    ];
    survives_faults(&files, Format::Csv, &pieces);
}

/// Returns the content of a table as text: its rows with two sets of defaults, its faults, and its
/// first line.
fn described(table: &mut Table) -> String {
    let mut described = format!("{:?} {:?} {:?}", table.bad, table.bad_rows, table.line(0));
    for radius in [0.75, 3.0] {
        table.set_defaults(&Defaults {
            radius: Some(radius),
            color: Some([radius / 4.0; 3]),
            ..Defaults::default()
        });
        table.any_block(|block| {
            for (center, radius, color) in spheres_of(block) {
                let bits = [
                    center[0], center[1], center[2], radius, color[0], color[1], color[2],
                ];
                write!(described, " {:x?}", bits.map(f64::to_bits)).expect("text");
            }
            false
        });
    }
    described
}

/// Reads the table in a text on all threads, or returns its faults.
fn outcome(text: &[u8]) -> Result<String, String> {
    let pool = |_| Pool::new(None);
    let request = Request {
        defaults: DEFAULTS,
        ..Request::default()
    };
    let read = Table::read(text, text.len() as u64, Format::Csv, &request, pool);
    let mut table = read.map_err(|error| format!("{error:?}"))?;
    let described = described(&mut table);
    match &*table.bad_rows {
        [] => Ok(described),
        _ => Err(described),
    }
}

#[test]
fn blocks_are_read_like_the_whole_by_the_crate_csv() {
    let headers = [
        "x,y,z",
        "z,x,y,radius",
        "x,y,z,radius,r,g,b",
        "x,b,g,r,radius,z,y",
        "x,y,z,color",
        "x,color,y,z,radius",
    ];
    let usual = [
        "1",
        "-0.5",
        "2.25",
        "1e-3",
        "-0",
        "123456789.123456789",
        "0.1",
    ];
    let unusual = [
        "",
        "+1",
        ".5",
        "1.",
        " 1",
        "1 ",
        "\t2\t",
        "1e999",
        "inf",
        "NaN",
        "-inf",
        "\"1\"",
        "\"\"",
        "\"1\"\"\"",
        "\"1\n\"",
        "1\"",
        " \"1\"",
        "#fff",
        "x",
        "\u{feff}1",
        "é",
        "1,",
        "1\n",
        "\r",
        "# 1",
        "\0",
        "1_0",
        "01",
    ];
    let (mut read, mut refused) = (0, 0);
    let mut rng = Rng(17);
    for _ in 0..cases(500) {
        let header = rng.one(&headers);
        let line_end = rng.one(&["\n", "\n", "\r\n", "\r"]);
        let oddness = rng.one(&[0, 0, 1, 3]);
        let mut body = String::new();
        for row in 0..1 + rng.below(12) {
            for (column, name) in header.split(',').enumerate() {
                body += if column == 0 { "" } else { "," };
                // The first row stays in common form, so that it can be quoted.
                body += if row > 0 && rng.below(100) < oddness {
                    rng.one(&unusual)
                } else if row > 0 && matches!(name, "radius" | "color") && rng.below(20) == 0 {
                    ""
                } else if name == "color" {
                    rng.one(&["#fff", "#FF8000", "#123456"])
                } else {
                    rng.one(&usual)
                };
            }
            body += line_end;
            if rng.below(100) < oddness {
                body += line_end;
            }
        }
        if rng.below(2) == 0 {
            body.truncate(body.trim_end_matches(['\n', '\r']).len());
        }
        let mut text = format!("{header}{line_end}{body}").into_bytes();
        if rng.below(100) < oddness {
            let at = text.len() - rng.below(body.len());
            text.insert(at, b'\xff');
        }
        // The same text, with a first record that only the crate can read.
        let first = text.len() - body.len() - usize::from(text.contains(&b'\xff'));
        let end = first + text[first..].iter().position(|byte| *byte == b',').unwrap();
        let mut quoted = text.clone();
        quoted.insert(end, b'"');
        quoted.insert(first, b'"');
        let expected = outcome(&quoted);
        *(if expected.is_ok() {
            &mut read
        } else {
            &mut refused
        }) += 1;
        let shown = String::from_utf8_lossy(&text).into_owned();
        assert_eq!(outcome(&text), expected, "{shown:?}");
    }
    assert!(read > 0 && refused > 0, "{read} read, {refused} refused");
}
