//! The only door to the disk for scenes, and what may come through it.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

use crate::diagnostic::{Code, Diagnostic, error::Error};

/// How much is read before the first look at it.
const FIRST_READ: usize = 4096;
/// How much is read between two looks.
const LARGEST_READ: usize = 1 << 20;
/// How much room is made at once for a file that claims to be so long.
const LARGEST_GUESS: usize = 1 << 28;
/// The longest text: offsets into it fit into 32 bits.
const LONGEST: usize = u32::MAX as usize;

/// A text, or as much of it as is text, with the reason why the rest is not.
#[derive(Debug, PartialEq)]
pub(crate) struct Source {
    /// The text; where it is broken, up to that place and a little beyond.
    pub(crate) text: String,
    /// Why it is not text, if it is not.
    pub(crate) fault: Option<Diagnostic>,
}

/// The files that a scene may name: those in its folder, unless others are allowed.
#[derive(Clone, Debug)]
pub(crate) struct Files {
    folder: PathBuf,
    outside: bool,
}

/// Why a file that a scene names is not opened.
#[derive(Debug, PartialEq)]
pub(crate) enum Refused {
    /// How the path leads out of the folder.
    Outside(&'static str),
    /// Why there is nothing to read.
    Unreadable(String),
}

impl Refused {
    fn unreadable(error: io::Error) -> Self {
        Self::Unreadable(cause(error))
    }
}

/// Why a file could not be read, in plain words.
pub(crate) fn cause(error: io::Error) -> String {
    Error::unreadable(Path::new(""), error).cause().to_owned()
}

impl Files {
    /// The files in a folder, and with `outside` all others.
    pub(crate) fn in_folder(folder: &Path, outside: bool) -> Self {
        let is_current = folder.as_os_str().is_empty();
        let folder = if is_current { Path::new(".") } else { folder };
        Self {
            folder: folder.to_owned(),
            outside,
        }
    }

    /// Opens a file by its path from the folder; tells its length.
    pub(crate) fn open(&self, name: &str) -> Result<(File, u64), Refused> {
        let path = Path::new(name);
        if !self.outside {
            // Looked at before the disk: what lies outside stays unknown.
            leads_out(path).map_or(Ok(()), |how| Err(Refused::Outside(how)))?;
        }
        let found = self.folder.join(path).canonicalize();
        let found = found.map_err(Refused::unreadable)?;
        if !self.outside {
            let folder = self.folder.canonicalize().map_err(Refused::unreadable)?;
            if !found.starts_with(folder) {
                return Err(Refused::Outside(
                    "a link leads out of the folder of the scene",
                ));
            }
        }
        let about = fs::metadata(&found).map_err(Refused::unreadable)?;
        if about.is_dir() {
            return Err(Refused::unreadable(io::ErrorKind::IsADirectory.into()));
        }
        // Opening a pipe would wait for ever, and a device has no length.
        if !about.is_file() {
            return Err(Refused::Unreadable("is no regular file".to_owned()));
        }
        let file = File::open(&found).map_err(Refused::unreadable)?;
        let length = file.metadata().map_err(Refused::unreadable)?.len();
        Ok((file, length))
    }
}

/// How a path leads out of the folder that it starts in, if it does.
fn leads_out(path: &Path) -> Option<&'static str> {
    let mut depth = 0_usize;
    for part in path.components() {
        match part {
            Component::Prefix(_) | Component::RootDir => return Some("the path is absolute"),
            Component::ParentDir if depth == 0 => {
                return Some("`..` leads out of the folder of the scene");
            }
            Component::ParentDir => depth -= 1,
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
        }
    }
    None
}

/// Opens a scene file.
pub(crate) fn open(path: &Path) -> Result<File, Error> {
    let unreadable = |error| Error::unreadable(path, error);
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.is_dir() {
        return Err(unreadable(io::ErrorKind::IsADirectory.into()));
    }
    Ok(file)
}

/// How long a text is that stands in a regular file, and can be read again.
pub(crate) fn length_of_text(file: &File) -> Option<usize> {
    let about = file.metadata().ok().filter(fs::Metadata::is_file)?;
    let length = usize::try_from(about.len()).ok()?;
    (length <= LONGEST).then_some(length)
}

/// Reads a scene file that has been opened.
pub(crate) fn read(file: &File, path: &Path) -> Result<Source, Error> {
    let length = file.metadata().map_or(0, |about| about.len());
    let expected = usize::try_from(length).unwrap_or(LONGEST);
    read_from(file, expected).map_err(|error| Error::unreadable(path, error))
}

/// Reads a scene from any source, such as standard input; `expected` bytes, where that is
/// known.
///
/// It stops at the first byte that cannot be text, so that a picture or a disk image of many
/// gigabytes is refused at once.
pub(crate) fn read_from(mut reader: impl Read, expected: usize) -> io::Result<Source> {
    let mut bytes = Vec::new();
    let mut step = FIRST_READ;
    loop {
        let seen = bytes.len();
        // Asked for in advance, so that a text too large for the memory is an error and no abort;
        // and only when it is needed, for fresh memory costs more than reading into it.
        if bytes.len() == bytes.capacity() {
            bytes.try_reserve(step)?;
        }
        let asked = step.min(bytes.capacity() - bytes.len());
        let read = reader.by_ref().take(asked as u64).read_to_end(&mut bytes)?;
        if let Some(fault) = not_text(&bytes, seen) {
            return Ok(broken(&bytes, fault));
        }
        if read < asked {
            return Ok(decode(bytes));
        }
        if bytes.len() > LONGEST {
            let message = "the file is larger than 4 GiB, the most that a scene may have";
            let fault = Diagnostic::new(Code::Syntax, 0..0, message);
            return Ok(broken(&bytes[..FIRST_READ], fault));
        }
        if seen == 0 {
            // A sparse file claims more than it has to say.
            let rest = expected.min(LARGEST_GUESS).saturating_sub(read);
            bytes.try_reserve_exact(rest + 1)?;
        }
        step = (step * 2).min(LARGEST_READ);
    }
}

/// Looks at what has been read beyond `seen` bytes.
fn not_text(bytes: &[u8], seen: usize) -> Option<Diagnostic> {
    if seen == 0 && (bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])) {
        let fault = Diagnostic::new(Code::Syntax, 0..0, "the text is UTF-16, expected UTF-8");
        return Some(fault.with_help("save the file with the encoding UTF-8"));
    }
    let fresh = bytes.get(seen..)?;
    // `contains` is many times as fast, and nearly always all there is to do.
    if !fresh.contains(&0) {
        return None;
    }
    let zero = fresh.iter().position(|byte| *byte == 0)?;
    let at = seen + zero;
    // What stands before it may not be text either, and comes first.
    let fault = bytes.get(..at).and_then(not_utf_8);
    fault.or_else(|| {
        let fault = Diagnostic::new(Code::Syntax, at..at + 1, "a NUL byte is not text");
        Some(fault.with_help("a scene is RON or JSON text in UTF-8"))
    })
}

fn not_utf_8(bytes: &[u8]) -> Option<Diagnostic> {
    let at = std::str::from_utf8(bytes).err()?.valid_up_to();
    let byte = bytes.get(at).copied().unwrap_or_default();
    let message = format!("the byte `0x{byte:02x}` is not UTF-8");
    // In the text a replacement character stands for it.
    let fault = Diagnostic::new(Code::Syntax, at..at + '\u{fffd}'.len_utf8(), message);
    Some(fault.with_help("save the file with the encoding UTF-8"))
}

fn decode(bytes: Vec<u8>) -> Source {
    match String::from_utf8(bytes) {
        Ok(text) => Source { text, fault: None },
        Err(error) => match not_utf_8(error.as_bytes()) {
            Some(fault) => broken(error.as_bytes(), fault),
            None => Source {
                text: String::from_utf8_lossy(error.as_bytes()).into_owned(),
                fault: None,
            },
        },
    }
}

/// The text up to a fault and to the end of its line, which a report shows.
fn broken(bytes: &[u8], fault: Diagnostic) -> Source {
    const BEYOND: usize = 200;
    let rest = bytes.get(fault.range.start..).unwrap_or_default();
    let line = rest
        .iter()
        .take(BEYOND)
        .take_while(|byte| **byte != b'\n')
        .count();
    let shown = bytes.get(..fault.range.start + line).unwrap_or(bytes);
    Source {
        text: String::from_utf8_lossy(shown).into_owned(),
        fault: Some(fault),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Source {
        read_from(bytes, bytes.len()).unwrap()
    }

    #[test]
    fn text_of_any_length_is_read_whole() {
        for length in [0, 1, 4095, 4096, 4097, 12_288, 3_000_000] {
            let text = "x".repeat(length);
            let source = read(text.as_bytes());
            assert_eq!(source.text.len(), length);
            assert_eq!(source.fault, None);
        }
    }

    #[test]
    fn reading_stops_at_the_first_byte_that_is_not_text() {
        struct Endless(usize);
        impl Read for Endless {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                self.0 += buffer.len();
                assert!(self.0 < 100_000, "read on and on");
                buffer.fill(0);
                Ok(buffer.len())
            }
        }
        let source = read_from(Endless(0), usize::MAX).unwrap();
        assert_eq!(source.fault.unwrap().range, 0..1);

        let mut bytes = vec![b'x'; 5000];
        bytes.push(0);
        assert_eq!(read(&bytes).fault.unwrap().range, 5000..5001);
    }

    #[test]
    fn a_byte_that_is_not_utf_8_is_named() {
        let source = read(b"ab\xffcd\nef");
        assert_eq!(source.text, "ab\u{fffd}cd");
        let fault = source.fault.unwrap();
        assert_eq!(fault.range, 2..5);
        assert_eq!(fault.message, "the byte `0xff` is not UTF-8");
    }

    #[test]
    fn utf_16_is_told_by_its_name() {
        for bytes in [b"\xff\xfe(\0", b"\xfe\xff\0("] {
            let fault = read(bytes).fault.unwrap();
            assert_eq!(fault.message, "the text is UTF-16, expected UTF-8");
        }
    }
}
