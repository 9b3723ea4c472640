//! Files with rows of a picture that are to be joined with others. No other program reads them.
//!
//! The first line states what the rows belong to. Blocks of rows in zlib format follow, each
//! preceded by its length in four bytes; a length of 0 ends them. The file ends with the SHA-256 of
//! everything before it, so that a truncated or damaged file is detected.

use std::{
    io::{self, BufRead, BufReader, Read, Seek, Write},
    path::Path,
};

use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use sha2::{Digest, Sha256};

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        reading::open_file,
    },
    image_file::{Compression, deflate, output::Sink},
};

const SUM: usize = 32;

/// Writes the rows that `draw` passes on.
pub(crate) fn write(
    mut writer: impl Write,
    title: &str,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut sum = Sha256::new();
    let mut put = |bytes: &[u8]| {
        sum.update(bytes);
        writer.write_all(bytes).map_err(Error::writing)
    };
    put(format!("{title}\n").as_bytes())?;
    draw(&mut |rows| {
        let packed = deflate::zlib(rows, Compression::Fast);
        let length = u32::try_from(packed.len()).map_err(|_| too_long())?;
        put(&length.to_le_bytes())?;
        put(&packed)
    })?;
    put(&[0; 4])?;
    let sum = sum.finalize();
    writer.write_all(&sum).map_err(Error::writing)
}

/// Returns true if a file holds rows with this title, and all of them.
pub(crate) fn is_whole(path: &Path, title: &str) -> bool {
    verify(path, title).unwrap_or(false)
}

fn verify(path: &Path, title: &str) -> io::Result<bool> {
    let file = open_file(path)?;
    let Some(mut left) = file.metadata()?.len().checked_sub(SUM as u64) else {
        return Ok(false);
    };
    let mut reader = BufReader::with_capacity(1 << 18, file);
    if read_title(&mut reader)?.as_deref() != Some(title) {
        return Ok(false);
    }
    reader.rewind()?;
    let mut sum = Sha256::new();
    while left > 0 {
        let bytes = reader.fill_buf()?;
        let length = (bytes.len() as u64).min(left) as usize;
        let bytes = bytes.get(..length).unwrap_or_default();
        if bytes.is_empty() {
            return Ok(false);
        }
        sum.update(bytes);
        reader.consume(length);
        left -= length as u64;
    }
    let mut expected = [0; SUM];
    reader.read_exact(&mut expected)?;
    Ok(sum.finalize()[..] == expected)
}

/// Passes the rows of a whole file to the sink. `left` is the number of bytes that the picture still
/// lacks: no more are unpacked, whatever the file holds.
pub(crate) fn read(path: &Path, left: &mut usize, sink: Sink) -> Result<(), Error> {
    let unreadable = |error| Error::unreadable(path, error);
    let damaged = || Error::new(ErrorKind::Unreadable, "the file is damaged").at(path);
    let mut reader = BufReader::new(open_file(path).map_err(unreadable)?);
    read_title(&mut reader).map_err(unreadable)?;
    loop {
        let mut length = [0; 4];
        reader.read_exact(&mut length).map_err(unreadable)?;
        let length = u32::from_le_bytes(length);
        if length == 0 {
            return Ok(());
        }
        let mut packed = Vec::new();
        let mut block = reader.by_ref().take(length.into());
        block.read_to_end(&mut packed).map_err(unreadable)?;
        let rows = decompress_to_vec_zlib_with_limit(&packed, *left).map_err(|_| damaged())?;
        *left = left.saturating_sub(rows.len());
        sink(&rows)?;
    }
}

/// Returns the first line, if it is UTF-8 and shorter than 1000 bytes.
fn read_title(reader: &mut impl BufRead) -> io::Result<Option<String>> {
    let mut line = Vec::new();
    reader.by_ref().take(1000).read_until(b'\n', &mut line)?;
    let line = String::from_utf8(line).ok();
    Ok(line.and_then(|line| line.strip_suffix('\n').map(str::to_owned)))
}

fn too_long() -> Error {
    Error::writing(io::ErrorKind::FileTooLarge.into())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn rows_round_trip_and_damage_is_detected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.part");
        let rows: Vec<Vec<u8>> = (0..5).map(|row| vec![row; 1000]).collect();
        let mut file = Vec::new();
        let draw = |sink: Sink| rows.iter().try_for_each(|row| sink(row));
        write(&mut file, "mine", draw).unwrap();
        fs::write(&path, &file).unwrap();
        assert!(is_whole(&path, "mine") && !is_whole(&path, "yours"));
        let mut found = Vec::new();
        let mut sink = |bytes: &[u8]| {
            found.extend_from_slice(bytes);
            Ok(())
        };
        let mut left = 5000;
        read(&path, &mut left, &mut sink).unwrap();
        assert_eq!((found.len(), left), (5000, 0));
        assert_eq!(found, rows.concat());
        let mut ignore = |_: &[u8]| Ok(());
        let most = read(&path, &mut 4999, &mut ignore).unwrap_err();
        assert!(most.to_string().contains("the file is damaged"), "{most}");
        for length in 0..file.len() {
            fs::write(&path, &file[..length]).unwrap();
            assert!(!is_whole(&path, "mine"), "torn at {length}");
        }
        for place in 0..file.len() {
            let mut other = file.clone();
            other[place] ^= 1;
            fs::write(&path, other).unwrap();
            assert!(!is_whole(&path, "mine"), "another byte at {place}");
        }
    }
}
