//! Text tables as programs write them: comments, separators and names.

use super::{DEFAULTS, rows, survives, survives_faults, wanted};
use crate::data::table::{Format, Request};

/// Returns the rows of two points, or the message.
fn points(text: &str) -> Result<Vec<[f64; 3]>, String> {
    let rows = rows(text.as_bytes(), Format::Csv)?;
    Ok(rows.into_iter().map(|row| row.0).collect())
}

const POINTS: [[f64; 3]; 2] = [[1.0, 2.5, -3.0], [4.0, 5.0, 6.0]];

#[test]
fn tables_of_programs_are_read() {
    for text in [
        // numpy.savetxt with a header, with commas or its own blanks.
        "# x,y,z\n1.0,2.5,-3.0\n4,5,6\n",
        "# x y z\n1.000e+00 2.5 -3.0\n4 5 6\n",
        "# x y z\n1,2.5,-3\n4,5,6\n",
        "# run 7 of 2026\n# x, y, z\n1.0 2.5 -3.0\n4 5 6\n",
        // CloudCompare.
        "//X,Y,Z\n1,2.5,-3\n4,5,6\n",
        "//X Y Z\n1 2.5 -3\n4 5 6\n",
        // Comments before a header, and blank lines.
        "# created by hand\n\n# for a test\nx,y,z\n1,2.5,-3\n4,5,6\n",
        // Tabs, and columns aligned by blanks.
        "x\ty\tz\n1\t2.5\t-3\n4\t5\t6\n",
        "  x      y     z\n  1    2.5    -3\n  4    5      6  \n",
        "x y z\r\n1 2.5 -3\r\n4 5 6",
        "x y z\n1\t2.5\t-3\n4\t5\t6\n",
        // Units.
        "x [nm],y [nm],z [nm]\n1,2.5,-3\n4,5,6\n",
        "x (nm),y (nm),z (nm)\n1,2.5,-3\n4,5,6\n",
        "x [nm] y [nm] z [nm]\n1 2.5 -3\n4 5 6\n",
        "# x [nm] y [nm] z [nm]\n1 2.5 -3\n4 5 6\n",
        // ParaView.
        "\"Points:0\",\"Points:1\",\"Points:2\"\n1,2.5,-3\n4,5,6\n",
        "\"id\",\"Points_0\",\"Points_1\",\"Points_2\"\n7,1,2.5,-3\n8,4,5,6\n",
        // Excel.
        "sep=,\r\nx,y,z\r\n1,2.5,-3\r\n4,5,6\r\n",
        "\u{feff}x,y,z\r\n1,2.5,-3\r\n4,5,6\r\n",
        "sep=\t\nx\ty\tz\n1\t2.5\t-3\n4\t5\t6\n",
        // Old Macs.
        "x,y,z\r1,2.5,-3\r4,5,6\r",
        "x y z\r1 2.5 -3\r4 5 6",
    ] {
        assert_eq!(points(text).as_deref(), Ok(&POINTS[..]), "{text:?}");
    }
}

#[test]
fn an_empty_cell_stays_empty_between_tabs() {
    let found = rows(b"x\ty\tz\tradius\n1\t2\t3\t\n4\t5\t6\t2\n", Format::Csv).unwrap();
    assert_eq!(
        found.iter().map(|row| row.1).collect::<Vec<_>>(),
        [0.75, 2.0]
    );
}

#[test]
fn names_of_the_scene_replace_a_header() {
    let columns = ["y", "x", "z"].map(Box::from);
    let request = Request {
        columns: Some(&columns),
        defaults: DEFAULTS,
        ..Request::default()
    };
    for text in [
        "2.5,1,-3\n5,4,6\n",
        "a,b,c\n2.5,1,-3\n5,4,6\n",
        "# y x z\n2.5 1 -3\n5 4 6\n",
        "sep=,\na b,\"c, d\",e\n2.5,1,-3\n5,4,6\n",
        "2.5\t1\t-3\n5\t4\t6\n",
    ] {
        let table = wanted(text.as_bytes(), Format::Csv, &request).unwrap();
        let mut found = Vec::new();
        table.any_block(|block| {
            found.extend(block.points().map(<[f64; 3]>::from));
            false
        });
        assert_eq!(found, POINTS, "{text:?}");
    }
    // A color is not a comment.
    let columns = ["color", "x", "y", "z"].map(Box::from);
    let request = Request {
        columns: Some(&columns),
        ..request
    };
    let table = wanted(b"#ff8000,1,2,3\n#000,1,2,3\n", Format::Csv, &request).unwrap();
    assert_eq!(table.rows(), 2);
}

#[test]
fn lines_are_counted_from_the_start_of_the_file() {
    for text in [
        "# x y z\n1 2 3\n1 o 3\n",
        "# a\n# x,y,z\n1 o 3\n",
        "sep=,\nx,y,z\n1,o,3\n",
        "x y z\r1 2 3\r1 o 3\r",
    ] {
        let message = points(text).unwrap_err();
        assert!(
            message.contains("(line 3), column `y`: `o` is not a number"),
            "{message}"
        );
    }
}

#[test]
fn other_tables_are_refused_with_the_cause() {
    for (text, words) in [
        ("x;y;z\n1;2;3\n", "separated by commas"),
        ("sep=;\nx;y;z\n1,5;2,5;3\n", "separated by commas"),
        ("1,2,3\n4,5,6\n", "name them in the scene"),
        ("1 2 3\n4 5 6\n", "name them in the scene"),
        ("x y z\n1,5 2 3\n", "commas in the rows"),
        ("x\ty\tz\n1,5\t2,5\t3,5\n", "decimals with points"),
        ("x,X,y\n1,2,3\n", "unknown column `X`"),
        ("# only a comment\n", "there is no column `x`"),
    ] {
        let message = points(text).expect_err(text);
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn random_faults_are_survived() {
    let files = [
        "# x y z\n1 2 3\n4 5 6\n",
        "sep=,\nx,y,z\n1,2,3\n4,5,6\n",
        "x\ty\tz\tradius\n1\t2\t3\t\n4\t5\t6\t2\n",
        "//X Y Z\r\n1  2 3 \r\n 4 5 6\r\n",
        "x [nm] y [nm] z [nm]\r1 2 3\r",
    ];
    let files = files.map(|text| text.as_bytes().to_vec());
    let pieces = [
        "\n", "\r", " ", "\t", "#", "//", "sep=", "\"", ",", "nan", "\u{e9}", ";",
    ];
    survives_faults(&files, Format::Csv, &pieces);
    let columns = ["x", "y", "z"].map(Box::from);
    let request = Request {
        columns: Some(&columns),
        defaults: DEFAULTS,
        ..Request::default()
    };
    survives(&files, Format::Csv, &request, &pieces);
}
