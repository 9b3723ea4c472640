//! Access to scene files and tables, and the limits on it.

use std::{
    collections::BTreeMap,
    fmt,
    fs::{self, File, Metadata},
    io::{self, Cursor, Read, Seek, SeekFrom},
    ops::Bound,
    path::{Component, Path, PathBuf},
    sync::Arc,
    time::SystemTime,
};

use crate::{
    diagnostic::{Code, Diagnostic, error::Error, reading::open_file},
    scene::foreign::Foreign,
};

/// Number of bytes read before the first check.
const FIRST_READ: usize = 4096;
/// The largest number of bytes read between two checks.
const LARGEST_READ: usize = 1 << 20;
/// The largest capacity reserved at once on the claim of a file.
const LARGEST_GUESS: usize = 1 << 28;
/// The longest text: offsets into it fit in 32 bits.
const LONGEST: usize = u32::MAX as usize;

/// A text, or the valid part of one, with the reason why the rest is not text.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct FileText {
    /// The text; if it is broken, up to that place and a little beyond.
    pub(crate) text: String,
    /// The reason why it is not text, if it is not.
    pub(crate) fault: Option<Diagnostic>,
}

/// A source of scenes and the tables and parts they name: the [`Disk`], or [`Memory`] in front of it.
pub trait Files: fmt::Debug + Send + Sync {
    /// Returns the canonical path of a file or a folder, without links.
    ///
    /// # Errors
    ///
    /// Fails if the path does not exist.
    fn resolve(&self, path: &Path) -> io::Result<PathBuf>;

    /// Returns the number of bytes of a regular file; `None` for one without a length, such as a
    /// pipe.
    ///
    /// # Errors
    ///
    /// Fails if the path is not a file.
    fn length(&self, path: &Path) -> io::Result<Option<u64>>;

    /// Opens a file for reading.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be read.
    fn open(&self, path: &Path) -> io::Result<Content>;

    /// Returns the names in a folder, each with true for a folder, in any order. A source that
    /// cannot list them returns none, which is the default.
    ///
    /// # Errors
    ///
    /// Fails if the path is not a folder.
    fn list(&self, _folder: &Path) -> io::Result<Vec<(String, bool)>> {
        Ok(Vec::new())
    }
}

/// The content of a file.
#[derive(Debug)]
pub enum Content {
    /// A file on the disk, at its start.
    File(File),
    /// Bytes in memory, at the first.
    Bytes(Cursor<Arc<[u8]>>),
}

impl Content {
    /// Returns the number of bytes of a regular file; `None` for one without a length.
    fn length(&self) -> io::Result<Option<u64>> {
        match self {
            Self::File(file) => length_of(&file.metadata()?),
            Self::Bytes(bytes) => Ok(Some(bytes.get_ref().len() as u64)),
        }
    }

    /// Returns the length and the time of a regular file.
    pub(crate) fn stamp(&self) -> Option<Stamp> {
        Some(Stamp {
            length: self.length().ok()??,
            time: match self {
                Self::File(file) => Some(file.metadata().ok()?.modified().ok()?),
                Self::Bytes(_) => None,
            },
        })
    }
}

/// The length of a regular file and the time of its last change. Bytes in memory never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stamp {
    pub(crate) length: u64,
    time: Option<SystemTime>,
}

fn length_of(about: &Metadata) -> io::Result<Option<u64>> {
    if about.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    Ok(about.is_file().then_some(about.len()))
}

impl Read for Content {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Bytes(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for Content {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(to),
            Self::Bytes(bytes) => bytes.seek(to),
        }
    }
}

/// The files on the disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        path.canonicalize()
    }

    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        length_of(&fs::metadata(path)?)
    }

    fn open(&self, path: &Path) -> io::Result<Content> {
        open_file(path).map(Content::File)
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<(String, bool)>> {
        let entries = fs::read_dir(folder)?.filter_map(|entry| {
            let entry = entry.ok()?;
            let is_folder = entry.path().is_dir();
            Some((entry.file_name().into_string().ok()?, is_folder))
        });
        Ok(entries.collect())
    }
}

/// Files in memory, such as texts that an editor has not saved, in front of those on the disk.
///
/// # Examples
///
/// ```
/// use strahl::{Document, ReadOptions, scene::Memory};
///
/// let scene = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
///     geometries: [Spheres(file: \"atoms.csv\", radius: 0.5, color: \"#f00\")])";
/// let files = Memory::new().with("mine.ron", scene).with("atoms.csv", "x,y,z\n0,0,0\n");
/// let options = ReadOptions::new().files(files);
/// assert!(Document::from_path_with("mine.ron", &options)?.diagnostics().is_empty());
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Memory(BTreeMap<PathBuf, Arc<[u8]>>);

impl Memory {
    /// Creates a set without files in memory: all are read from the disk.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, replacing any file with the same path.
    #[must_use]
    pub fn with(mut self, path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Self {
        let path = absolute(path.as_ref());
        self.0.insert(path, bytes.as_ref().into());
        self
    }

    /// Removes a file, so that the one on the disk is read again.
    #[must_use]
    pub fn without(mut self, path: impl AsRef<Path>) -> Self {
        self.0.remove(&absolute(path.as_ref()));
        self
    }

    /// Returns the files in memory at a path or below it, in front of those on the disk.
    #[must_use]
    pub fn within(&self, path: impl AsRef<Path>) -> Self {
        let path = absolute(path.as_ref());
        let all = self
            .0
            .range::<Path, _>((Bound::Included(&*path), Bound::Unbounded));
        let within = all.take_while(|(file, _)| file.starts_with(&path));
        Self(
            within
                .map(|(file, bytes)| (file.clone(), Arc::clone(bytes)))
                .collect(),
        )
    }

    fn find(&self, path: &Path) -> Option<&Arc<[u8]>> {
        self.0.get(&absolute(path))
    }
}

/// Returns an absolute path, by its text alone: it need not exist.
fn absolute(path: &Path) -> PathBuf {
    without_detours(&std::path::absolute(path).unwrap_or_else(|_| path.to_owned()))
}

/// Returns a path without folders that it leads into and out of by `..`, by its text alone.
pub(crate) fn without_detours(path: &Path) -> PathBuf {
    let mut found = PathBuf::new();
    for part in path.components() {
        let last = found.components().next_back();
        match (part, last) {
            (Component::ParentDir, Some(Component::RootDir | Component::Prefix(_))) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                found.pop();
            }
            (part, _) => found.push(part),
        }
    }
    found
}

impl Files for Memory {
    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        if self.find(path).is_none() {
            return Disk.resolve(path);
        }
        // If the folder exists on the disk, its links are resolved, so that they do not lead out of
        // it.
        let path = absolute(path);
        let folder = path.parent().and_then(|folder| folder.canonicalize().ok());
        Ok(match (folder, path.file_name()) {
            (Some(folder), Some(name)) => folder.join(name),
            _ => path,
        })
    }

    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        match self.find(path) {
            Some(bytes) => Ok(Some(bytes.len() as u64)),
            None => Disk.length(path),
        }
    }

    fn open(&self, path: &Path) -> io::Result<Content> {
        match self.find(path) {
            Some(bytes) => Ok(Content::Bytes(Cursor::new(Arc::clone(bytes)))),
            None => Disk.open(path),
        }
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<(String, bool)>> {
        let folder = absolute(folder);
        let here = self.0.keys().filter_map(|path| {
            let name = path.strip_prefix(&folder).ok()?.to_str()?;
            (!name.contains(std::path::MAIN_SEPARATOR)).then(|| (name.to_owned(), false))
        });
        let here: BTreeMap<_, _> = here.collect();
        let on_disk = match Disk.list(&folder) {
            Ok(names) => names,
            Err(_) if !here.is_empty() => Vec::new(),
            Err(error) => return Err(error),
        };
        let is_new = |(name, _): &(String, bool)| !here.contains_key(name);
        let on_disk: Vec<_> = on_disk.into_iter().filter(is_new).collect();
        Ok(here.into_iter().chain(on_disk).collect())
    }
}

/// The files that a scene may name: those in its folder, unless others are allowed.
pub(crate) struct Folder<'f> {
    files: &'f dyn Files,
    folder: PathBuf,
    outside: bool,
}

/// The reason why a file that a scene names is not opened.
#[derive(Debug, PartialEq)]
pub(crate) enum Refused {
    /// The path leads out of the folder, in this way.
    Outside(&'static str),
    /// There is nothing to read, for this reason.
    Unreadable(String),
}

impl Refused {
    fn unreadable(error: io::Error) -> Self {
        Self::Unreadable(cause(error))
    }
}

/// Returns the reason why a file could not be read, in plain words.
pub(crate) fn cause(error: io::Error) -> String {
    Error::unreadable(Path::new(""), error).cause().to_owned()
}

impl<'f> Folder<'f> {
    /// Creates access to the files in a folder and, with `outside`, to all others.
    pub(crate) fn new(files: &'f dyn Files, folder: &Path, outside: bool) -> Self {
        let is_current = folder.as_os_str().is_empty();
        let folder = if is_current { Path::new(".") } else { folder };
        Self {
            files,
            folder: folder.to_owned(),
            outside,
        }
    }

    /// Opens a file by its path from the folder. Returns its length as well.
    pub(crate) fn open(&self, name: &str) -> Result<(Content, u64), Refused> {
        self.open_found(&self.find(name)?)
    }

    /// Returns the names in a folder by its path from this one, each with true for a folder.
    pub(crate) fn list(&self, name: &str) -> Vec<(String, bool)> {
        let found = self.find(name).ok();
        let listed = found.and_then(|found| self.files.list(&found).ok());
        listed.unwrap_or_default()
    }

    /// Returns the real path of a file or a folder by its path from the folder.
    pub(crate) fn find(&self, name: &str) -> Result<PathBuf, Refused> {
        let path = Path::new(name);
        if !self.outside {
            // Checked before the disk is touched: files outside stay unknown.
            leads_out(path).map_or(Ok(()), |how| Err(Refused::Outside(how)))?;
        }
        let found = self.files.resolve(&self.folder.join(path));
        let found = found.map_err(Refused::unreadable)?;
        if !self.outside && !self.holds(&found) {
            return Err(Refused::Outside(
                "a link leads out of the folder of the scene",
            ));
        }
        Ok(found)
    }

    /// Opens a file that was found. Returns its length as well.
    pub(crate) fn open_found(&self, found: &Path) -> Result<(Content, u64), Refused> {
        // A device has no length, even if it is open already.
        let regular = |length: io::Result<Option<u64>>| {
            let length = length.map_err(Refused::unreadable)?;
            length.ok_or_else(|| Refused::Unreadable("not a regular file".to_owned()))
        };
        regular(self.files.length(found))?;
        let file = self.files.open(found).map_err(Refused::unreadable)?;
        let length = regular(file.length())?;
        Ok((file, length))
    }

    /// Returns true if a file is in the folder, which may exist in memory only.
    fn holds(&self, found: &Path) -> bool {
        let folder = self.files.resolve(&self.folder);
        found.starts_with(folder.unwrap_or_else(|_| absolute(&self.folder)))
    }
}

/// Returns how a path leads out of its starting folder, if it does.
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

/// Opens a scene file. Returns its length as well, if it is a regular file.
pub(crate) fn open(files: &dyn Files, path: &Path) -> Result<(Content, Option<u64>), Error> {
    let open = || {
        let content = files.open(path)?;
        let length = content.length()?;
        Ok((content, length))
    };
    open().map_err(|error| Error::unreadable(path, error))
}

/// Returns the length of a text that can be read in blocks.
pub(crate) fn length_of_text(length: Option<u64>) -> Option<usize> {
    let length = usize::try_from(length?).ok()?;
    (length <= LONGEST).then_some(length)
}

/// Reads a scene from any source, such as standard input; `expected` is the number of bytes, if
/// known.
///
/// Reading stops at the first byte that cannot be text, so that a picture or a disk image of many
/// gigabytes is rejected at once.
pub(crate) fn read_from(mut reader: impl Read, expected: usize) -> io::Result<FileText> {
    let mut bytes = Vec::new();
    let mut step = FIRST_READ;
    loop {
        let seen = bytes.len();
        // Reserved in advance, so that a text too large for the memory is an error and not an
        // abort; and only when needed, because fresh memory costs more than reading into it.
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
            let message = "the file is larger than 4 GiB, the maximum for a scene";
            let fault = Diagnostic::new(Code::Syntax, 0..0, message);
            return Ok(broken(&bytes[..FIRST_READ], fault));
        }
        if seen == 0 {
            // A sparse file claims more than it holds.
            let rest = expected.min(LARGEST_GUESS).saturating_sub(read);
            bytes.try_reserve_exact(rest + 1)?;
        }
        step = (step * 2).min(LARGEST_READ);
    }
}

/// Checks the bytes after the first `seen`.
fn not_text(bytes: &[u8], seen: usize) -> Option<Diagnostic> {
    if seen == 0
        && let Some(Foreign { what, help }) = Foreign::of(bytes, "")
    {
        return Some(Diagnostic::new(Code::Syntax, 0..0, what).with_help(help));
    }
    let fresh = bytes.get(seen..)?;
    // `contains` is many times as fast, and almost always enough.
    if !fresh.contains(&0) {
        return None;
    }
    let zero = fresh.iter().position(|byte| *byte == 0)?;
    let at = seen + zero;
    // The bytes before it may not be text either; that fault comes first.
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
    // The text has a replacement character in its place.
    let fault = Diagnostic::new(Code::Syntax, at..at + '\u{fffd}'.len_utf8(), message);
    Some(fault.with_help("save the file as UTF-8"))
}

fn decode(bytes: Vec<u8>) -> FileText {
    match String::from_utf8(bytes) {
        Ok(text) => FileText { text, fault: None },
        Err(error) => match not_utf_8(error.as_bytes()) {
            Some(fault) => broken(error.as_bytes(), fault),
            None => FileText {
                text: String::from_utf8_lossy(error.as_bytes()).into_owned(),
                fault: None,
            },
        },
    }
}

/// The text up to a fault and to the end of its line, which a report shows.
fn broken(bytes: &[u8], fault: Diagnostic) -> FileText {
    const BEYOND: usize = 200;
    let rest = bytes.get(fault.range.start..).unwrap_or_default();
    let line = rest
        .iter()
        .take(BEYOND)
        .take_while(|byte| **byte != b'\n')
        .count();
    let shown = bytes.get(..fault.range.start + line).unwrap_or(bytes);
    FileText {
        text: String::from_utf8_lossy(shown).into_owned(),
        fault: Some(fault),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> FileText {
        read_from(bytes, bytes.len()).unwrap()
    }

    #[test]
    fn a_detour_is_left_out() {
        for (path, short) in [
            ("a/b/../c.ron", "a/c.ron"),
            ("./a/../../c.ron", "./../c.ron"),
            ("../a/b/../../c.ron", "../c.ron"),
            ("a/../../b/c.ron", "../b/c.ron"),
            ("/../a/../c.ron", "/c.ron"),
        ] {
            let found = without_detours(Path::new(path));
            assert_eq!(found.as_os_str(), short);
        }
    }

    #[test]
    fn text_of_any_length_is_read_completely() {
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
    fn utf_16_is_reported_by_name() {
        for bytes in [b"\xff\xfe(\0", b"\xfe\xff\0("] {
            let fault = read(bytes).fault.unwrap();
            assert_eq!(fault.message, "the text is UTF-16, expected UTF-8");
        }
    }
}
