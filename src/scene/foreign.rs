//! Recognition of files that are something else than their names say.

use std::io::{self, Cursor, Read};

/// The number of bytes at the start of a file that tell what it is.
const START: usize = 4096;

/// Something else than the file that was expected: what it is, and what to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Foreign {
    pub(crate) what: &'static str,
    pub(crate) help: &'static str,
}

/// A list of the first bytes of files, each with the extension that a format of this program has, if it
/// reads them, with what that is, and what to do.
macro_rules! files {
    ($($start:literal $(in $ending:literal)? => $what:literal, $help:literal;)*) => {
        &[$(($start, &[$($ending)?], Foreign { what: $what, help: $help })),*]
    };
}

/// The first bytes of files.
const STARTS: &[(&[u8], &[&str], Foreign)] = files! {
    b"\xff\xfe" => "the text is UTF-16, expected UTF-8", "save the file as UTF-8";
    b"\xfe\xff" => "the text is UTF-16, expected UTF-8", "save the file as UTF-8";
    b"\x1f\x8b" => "the file is compressed with gzip", "decompress it with `gunzip`";
    b"BZh" => "the file is compressed with bzip2", "decompress it with `bunzip2`";
    b"\xfd7zXZ\0" => "the file is compressed with xz", "decompress it with `unxz`";
    b"\x28\xb5\x2f\xfd" => "the file is compressed with zstd", "decompress it with `unzstd`";
    b"version https://git-lfs" =>
        "the file is a Git LFS pointer, not the data", "fetch the data with `git lfs pull`";
    b"/annex/objects/" =>
        "the file is a git-annex pointer, not the data", "fetch the data with `git annex get`";
    b"<!DOCTYPE html" =>
        "the file is a web page, not the data", "download the data itself, such as the raw file";
    b"<!doctype html" =>
        "the file is a web page, not the data", "download the data itself, such as the raw file";
    b"<html" =>
        "the file is a web page, not the data", "download the data itself, such as the raw file";
    b"\x89HDF" => "the file is HDF5",
        "save its columns as CSV, or as a numpy array with `h5py` and `numpy.save`";
    b"MATLAB 5.0 MAT-file" => "the file is a MAT-file of MATLAB",
        "save the columns with `writematrix(…, \"points.csv\")`";
    b"# vtk DataFile" => "the file is VTK", "save it as CSV or PLY in ParaView";
    b"# .PCD" => "the file is PCD, of the Point Cloud Library", "save it as PLY";
    b"LASF" => "the file is a LAS or LAZ cloud", "save it as PLY or CSV";
    b"glTF" => "the file is glTF", "save it as PLY, OBJ or STL";
    b"ITEM: TIMESTEP" => "the file is a LAMMPS dump",
        "write atoms with `dump … xyz`, or the rows alone as CSV";
    b"%PDF" => "the file is a PDF document", "save the data itself";
    b"\x93NUMPY" in "npy" => "the file is a numpy array", "call it `.npy`";
    b"PK\x03\x04" in "npz" => "the file is a zip archive, such as .npz or .xlsx",
        "call arrays of numpy `.npz`; save a sheet of Excel as CSV";
    b"ply\n" in "ply" => "the file is PLY", "call it `.ply`";
    b"ply\r" in "ply" => "the file is PLY", "call it `.ply`";
};

const UTF_16: Foreign = STARTS[0].2;
const MMCIF: Foreign = Foreign {
    what: "the file is mmCIF, not PDB",
    help: "download or save it in the PDB format",
};
const CR: Foreign = Foreign {
    what: "the lines end with CR alone, as on old Macs",
    help: "convert the file, such as by `tr '\\r' '\\n'`",
};

impl Foreign {
    /// Recognizes a file by its start, unless the format of its name reads such files.
    pub(crate) fn of(start: &[u8], name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.').unwrap_or_default();
        let has = |endings: &[&str]| endings.iter().any(|each| each.eq_ignore_ascii_case(ending));
        let text = start.strip_prefix("\u{feff}".as_bytes()).unwrap_or(start);
        let is_it =
            |(bytes, own, _): &&(&[u8], &[&str], Self)| text.starts_with(bytes) && !has(own);
        if let Some((.., foreign)) = STARTS.iter().find(is_it) {
            return Some(*foreign);
        }
        if has(&["csv", "xyz", "pdb", "obj"]) && is_utf_16(start) {
            return Some(UTF_16);
        }
        let first = text.split(|byte| matches!(byte, b'\n' | b'\r')).next();
        let first = first.unwrap_or_default().trim_ascii();
        let is_cif = first.starts_with(b"data_") && !first.contains(&b',');
        (has(&["pdb", "xyz"]) && is_cif).then_some(MMCIF)
    }

    /// Recognizes a text whose lines end with CR alone, for a format that does not read them.
    pub(crate) fn of_lines(start: &[u8]) -> Option<Self> {
        let end = start
            .iter()
            .position(|byte| matches!(byte, b'\n' | b'\r'))?;
        let is_mac = start
            .get(end..end + 2)
            .is_some_and(|two| matches!(two, [b'\r', after] if *after != b'\n'));
        is_mac.then_some(CR)
    }
}

/// Returns true for UTF-16 without a mark of the order of bytes: every other byte of ASCII is 0.
fn is_utf_16(start: &[u8]) -> bool {
    let (pairs, _) = start
        .get(..64.min(start.len()))
        .unwrap_or_default()
        .as_chunks::<2>();
    let is = |zero: usize| {
        pairs
            .iter()
            .all(|pair| pair[zero] == 0 && pair[1 - zero] != 0)
    };
    pairs.len() >= 4 && (is(0) || is(1))
}

/// Reads the start of a file. Returns it, and a reader of the whole file.
pub(crate) fn start_of<R: Read>(mut reader: R) -> io::Result<(Vec<u8>, impl Read + use<R>)> {
    let mut start = Vec::new();
    reader.by_ref().take(START as u64).read_to_end(&mut start)?;
    let again = Cursor::new(start.clone()).chain(reader);
    Ok((start, again))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_recognized() {
        let of = |bytes: &[u8], name| Foreign::of(bytes, name).map(|foreign| foreign.what);
        for (bytes, name, expected) in [
            (&b"\xff\xfex\0,\0y\0"[..], "a.csv", "UTF-16"),
            (b"x\0,\0y\0,\0z\0\n\0", "a.csv", "UTF-16"),
            (b"\x1f\x8b\x08\0", "a.pdb", "gzip"),
            (
                b"version https://git-lfs.github.com/spec/v1\noid",
                "a.npy",
                "Git LFS",
            ),
            (b"data_1CRN\n#\nloop_\n", "1crn.pdb", "mmCIF"),
            (b"<!DOCTYPE html><html>", "a.obj", "web page"),
            (b"\x93NUMPY\x01\0", "a.csv", "numpy array"),
            (b"PK\x03\x04", "a.csv", "zip archive"),
            (b"ply\nformat", "a.obj", "PLY"),
        ] {
            let found = of(bytes, name).unwrap_or_default();
            assert!(found.contains(expected), "{name} {found}");
        }
        for (bytes, name) in [
            (&b""[..], "a.csv"),
            (b"x,y,z\r\n", "a.csv"),
            (b"x,y,z\r1,2,3\r", "a.csv"),
            (b"data_x,y,z\n", "a.csv"),
            (b"\x93NUMPY\x01\0", "a.NPY"),
            (b"PK\x03\x04", "a.npz"),
            (b"ply\r\nformat ascii 1.0", "a.ply"),
            (b"solid \0\0\0\0\0\0\0\0", "a.stl"),
        ] {
            assert_eq!(of(bytes, name), None, "{name}");
        }
        let is_mac = |bytes: &[u8]| Foreign::of_lines(bytes).is_some();
        assert!(is_mac(b"ply\rformat ascii 1.0\r"));
        assert!(!is_mac(b"ply\r\nformat") && !is_mac(b"ply\nformat") && !is_mac(b"ply"));
    }
}
