//! Texts that a command reads besides scenes, such as lists of paths, up to a sensible size.

use std::io::{self, BufRead, BufReader, Read};

/// The maximum length of a line.
const LONGEST_LINE: u64 = 1 << 20;

/// Reads a text of at most this many MiB. Fails at a line that is too long, so that an endless
/// device or pipe does not fill the memory.
pub(super) fn read(text: impl Read, mebibytes: u64) -> io::Result<Vec<u8>> {
    let (mut text, mut bytes) = (BufReader::new(text), Vec::new());
    loop {
        let line = text.by_ref().take(LONGEST_LINE + 1);
        let length = { line }.read_until(b'\n', &mut bytes)? as u64;
        if length > LONGEST_LINE && !bytes.ends_with(b"\n") {
            return Err(too_long("has a line longer than 1 MiB".to_owned()));
        }
        if bytes.len() as u64 > mebibytes << 20 {
            return Err(too_long(format!(
                "is longer than {mebibytes} MiB; split it"
            )));
        }
        if length == 0 {
            return Ok(bytes);
        }
    }
}

fn too_long(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}
