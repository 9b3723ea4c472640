//! The one way to open a file that is read.
//!
//! A file is a regular file. What is open already may be a pipe or a device as well: standard input
//! and `<(…)`, by their paths in `/dev` and `/proc`. Nothing else is opened, because a named pipe may
//! never get a writer, and a device may have no end. Opening never waits.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, Read},
    path::Path,
};

/// The folders of what is open already.
const OPEN: [&str; 2] = ["/dev", "/proc"];

/// Returns the folder of a file, `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Returns true if an open file is still the one at a path; elsewhere than on Unix, if there is any.
pub fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let inode = |found: Metadata| (found.dev(), found.ino());
        let there = fs::symlink_metadata(path).map(inode);
        there.is_ok_and(|there| file.metadata().map(inode).is_ok_and(|open| open == there))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Opens a file for reading: a regular one, or standard input and the like by a path in `/dev` or
/// `/proc`.
///
/// # Errors
///
/// Fails for a folder, a named pipe, another device, and a file that cannot be opened.
pub fn open_file(path: impl AsRef<Path>) -> io::Result<File> {
    let path = path.as_ref();
    // Opening some devices already has an effect.
    check(path, &fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // A pipe may be there by now.
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    }
    let file = options.open(path)?;
    let about = file.metadata()?;
    check(path, &about)?;
    #[cfg(unix)]
    if !about.is_file() {
        // Whoever reads waits for the writer.
        let flags = rustix::fs::fcntl_getfl(&file)?;
        rustix::fs::fcntl_setfl(&file, flags - rustix::fs::OFlags::NONBLOCK)?;
    }
    Ok(file)
}

/// Reads a file of at most this many bytes, opened as by [`open_file`].
///
/// # Errors
///
/// As [`open_file`], and for a longer file.
pub fn read_file(path: impl AsRef<Path>, most: u64) -> io::Result<Vec<u8>> {
    let file = open_file(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(longer_than(most));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(length).unwrap_or(0))?;
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(longer_than(most));
    }
    Ok(bytes)
}

/// Reads a text of at most this many bytes, opened as by [`open_file`].
///
/// # Errors
///
/// As [`read_file`], and for a file that is not UTF-8.
pub fn read_text(path: impl AsRef<Path>, most: u64) -> io::Result<String> {
    let text = String::from_utf8(read_file(path, most)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, NOT_UTF_8))
}

const NOT_UTF_8: &str = "not UTF-8; save the file as UTF-8";

fn longer_than(most: u64) -> io::Error {
    let message = match most >> 20 {
        0 => format!("is larger than {} KiB", most >> 10),
        mebibytes => format!("is larger than {mebibytes} MiB"),
    };
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}

/// Checks that this is a file to read.
fn check(path: &Path, about: &Metadata) -> io::Result<()> {
    if about.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if about.is_file() || is_open_already(path) {
        return Ok(());
    }
    let message = match is_pipe(about) {
        true => "is a named pipe, not a file",
        false => "is a device, not a file",
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

fn is_open_already(path: &Path) -> bool {
    OPEN.iter().any(|folder| path.starts_with(folder))
}

/// Returns true for a pipe with a name, which may never get another end, unlike `<(…)` and `>(…)`.
pub fn is_named_pipe(path: impl AsRef<Path>) -> bool {
    let path = path.as_ref();
    !is_open_already(path) && fs::metadata(path).is_ok_and(|about| is_pipe(&about))
}

/// Returns true for a pipe, with a name or without.
#[cfg_attr(not(unix), expect(unused_variables))]
pub(crate) fn is_pipe(about: &Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        about.file_type().is_fifo()
    }
    #[cfg(not(unix))]
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, [b'a'; 2048]).unwrap();
        assert_eq!(read_text(&path, 2048).unwrap().len(), 2048);
        let error = read_file(&path, 1024).unwrap_err();
        assert_eq!(error.to_string(), "is larger than 1 KiB");
        fs::write(&path, [0xff]).unwrap();
        assert!(read_text(&path, 1).is_err());
        let error = open_file(folder.path()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::IsADirectory);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_not_opened() {
        use std::os::unix::fs::symlink;

        let folder = tempfile::tempdir().unwrap();
        let (pipe, link) = (folder.path().join("pipe"), folder.path().join("link"));
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|status| status.success()) {
            let error = open_file(&pipe).unwrap_err();
            assert!(error.to_string().starts_with("is a named pipe"), "{error}");
        }
        symlink("/dev/zero", &link).unwrap();
        let error = open_file(&link).unwrap_err();
        assert_eq!(error.to_string(), "is a device, not a file");
        // An endless device is read no further than the limit.
        let error = read_file("/dev/zero", 1 << 20).unwrap_err();
        assert_eq!(error.to_string(), "is larger than 1 MiB");
    }
}
