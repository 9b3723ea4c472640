//! The cells of single rows.

use std::io::{Cursor, Write};

use zip::{ZipWriter, write::SimpleFileOptions};

use crate::data::{
    fault::ReadError,
    table::{Format, Request, row_cells::RowCells},
};

fn read(bytes: &[u8], format: Format, row: usize) -> Result<RowCells, ReadError> {
    let length = bytes.len() as u64;
    RowCells::read(Cursor::new(bytes), length, format, &Request::default(), row)
}

/// Returns the cells of a row as text. A file that is cut off anywhere may be refused.
fn cells(bytes: impl AsRef<[u8]>, format: Format, row: usize) -> String {
    let bytes = bytes.as_ref();
    for length in 0..bytes.len() {
        let _ = read(&bytes[..length], format, row);
    }
    let cells = read(bytes, format, row).unwrap();
    assert_eq!((cells.more, cells.is_from_file), (0, true));
    let shown = cells.shown.iter();
    let shown: Vec<_> = shown.map(|(name, text)| format!("{name}={text}")).collect();
    shown.join(" ")
}

#[test]
fn texts_are_split_as_their_tables() {
    let csv = |text: &str, row| cells(text, Format::Csv, row);
    let text = "label,X [m],y,z\na,1.50,2,3\n\n\"b, c\",4,5,6\n";
    assert_eq!(csv(text, 0), "label=a x=1.50 y=2 z=3");
    assert_eq!(csv(text, 1), "label=b, c x=4 y=5 z=6");
    let text = "# made by hand\n#x y  z id\n1 2 3  0x1\r\n 4 5 6 0x2 \r\n";
    assert_eq!(csv(text, 1), "x=4 y=5 z=6 id=0x2");
    let text = "\u{feff}x\ty\tz\tname\n1\t2\t3\tä \u{1b}[2J\n";
    assert_eq!(csv(text, 0), "x=1 y=2 z=3 name=ä ␛[2J");
    assert_eq!(csv("x,y,z,k\r1,2,3,4\r5,6,7,8", 1), "x=5 y=6 z=7 k=8");
}

#[test]
fn long_rows_and_cells_are_cut() {
    let names: Vec<_> = (0..30).map(|at| format!("c{at}")).collect();
    let long = "é".repeat(41);
    let text = format!("{}\n{long}{}\n", names.join(","), ",1".repeat(29));
    let cells = read(text.as_bytes(), Format::Csv, 0).unwrap();
    assert_eq!((cells.shown.len(), cells.more), (20, 10));
    assert_eq!(cells.shown[0].1, format!("{}…", "é".repeat(40)));
    assert_eq!(cells.shown[19], ("c19".to_owned(), "1".to_owned()));
}

#[test]
fn atoms_have_the_columns_of_their_files() {
    let text = "2\n\nC 0 0 0\nO12 1 2.0 3 0.5 -7 \n";
    let usual = "species=O12 x=1 y=2.0 z=3";
    let text = text.replace("C 0 0 0", "C 0 0 0 1 2");
    let expected = format!("{usual} column5=0.5 column6=-7");
    assert_eq!(cells(&text, Format::Xyz, 1), expected);
    let text = "1\nProperties=id:I:1:species:S:1:pos:R:3:name:S:1:force:R:2\n7 C 1 2 3 CA 4 5\n";
    let expected = "id=7 species=C x=1 y=2 z=3 name=CA force.1=4 force.2=5";
    assert_eq!(cells(text, Format::Xyz, 0), expected);
    let atom = |serial, name, x| {
        format!(
            "ATOM  {serial:>5} {name} LYS A  17    {x:>8}   2.000   3.000  1.00 20.50           C\n"
        )
    };
    let text = format!(
        "HEADER\n{}{}END\n",
        atom(8, " N  ", "1.0"),
        atom(9, " CA ", "4.0")
    );
    let text = text.replace("HEADER", "HEADER\nREMARK");
    assert_eq!(
        cells(text, Format::Pdb, 1),
        "serial=9 name=CA residue name=LYS residue=17 x=4.0 y=2.000 z=3.000 occupancy=1.00 \
         b_factor=20.50 element=C"
    );
}

/// Returns an .npy file.
fn npy(descr: &str, order: &str, shape: &str, elements: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes().chain(elements.iter().copied()));
    bytes
}

#[test]
fn records_have_the_digits_of_their_types() {
    let descr = "[('x', '<f4'), ('', '|V4'), ('y', '>f8'), ('z', '|u1'), ('id', '<i8'), \
                 ('name', '<U2'), ('tag', '|S3'), ('ok', '|b1'), ('when', '<M8[s]')]";
    let mut elements = Vec::new();
    for x in [0.1_f32, 0.3] {
        elements.extend(x.to_le_bytes());
        elements.extend([9; 4]);
        elements.extend(1e300_f64.to_be_bytes());
        elements.push(200);
        elements.extend(9_007_199_254_740_993_i64.to_le_bytes());
        elements.extend([0xe9, 0, 0, 0, 0, 0, 0, 0]);
        elements.extend(*b"ab\0");
        elements.push(1);
        elements.extend(5_i64.to_le_bytes());
    }
    assert_eq!(
        cells(npy(descr, "False", "(2,)", &elements), Format::Npy, 1),
        "x=0.3 y=1e300 z=200 id=9007199254740993 name=é tag=ab ok=true when=(<M8[s])"
    );
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0_f64];
    let numbers: Vec<_> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    let rows = npy("'<f8'", "False", "(2, 4)", &numbers);
    let expected = "x=5.0 y=6.0 z=7.0 radius=8.0";
    assert_eq!(cells(&rows, Format::Npy, 1), expected);
    let columns = npy("'<f8'", "True", "(2, 4)", &numbers);
    let expected = "x=2.0 y=4.0 z=6.0 radius=8.0";
    assert_eq!(cells(&columns, Format::Npy, 1), expected);

    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let charge = npy("'<i2'", "False", "(2,)", &[1, 0, 2, 0]);
    let other = npy("'<i2'", "False", "(3,)", &[0; 6]);
    for (name, file) in [("points", &columns), ("charge", &charge), ("other", &other)] {
        let options = SimpleFileOptions::default();
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(file).unwrap();
    }
    let file = writer.finish().unwrap().into_inner();
    let expected = format!("{expected} charge=2");
    assert_eq!(cells(file, Format::Npz, 1), expected);
}

#[test]
fn vertices_have_all_their_properties() {
    let header = |encoding: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement part 2\nproperty list uchar uchar ids\n\
             element vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
             property list uchar uchar near\nproperty uchar red\nend_header\n"
        )
    };
    let expected = "x=0.5 y=2.5 z=3.5 near=a list of 2 red=7";
    let text = header("ascii") + "1 4\n0\n\n9 9 9 0 9\n0.5 2.5 3.5 2 8 8 7\n";
    assert_eq!(cells(text, Format::Ply, 1), expected);
    let mut bytes = header("binary_big_endian").into_bytes();
    bytes.extend([1, 4, 0]);
    let vertex = |point: [f32; 3], rest: &[u8]| {
        let point = point.iter().flat_map(|number| number.to_be_bytes());
        point.chain(rest.iter().copied()).collect::<Vec<_>>()
    };
    bytes.extend(vertex([9.0; 3], &[0, 9]));
    bytes.extend(vertex([0.5, 2.5, 3.5], &[2, 8, 8, 7]));
    assert_eq!(cells(bytes, Format::Ply, 1), expected);
}
