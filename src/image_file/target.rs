//! The destination of a file, which is written whole or not at all.

use std::{
    fs::{self, File, OpenOptions, Permissions},
    io::{self, BufRead, BufReader, BufWriter, Write},
    path::{Path, PathBuf},
};

#[cfg(unix)]
use std::{
    fs::TryLockError,
    thread,
    time::{Duration, Instant},
};

use tempfile::{NamedTempFile, TempPath};

use crate::{
    diagnostic::{
        error::Error,
        reading::{folder_of, is_at, open_file},
    },
    image_file::output::Output,
    parallel::Cancel,
};

/// The maximum number of links that a path may lead through, as on Linux.
const MOST_LINKS: usize = 40;
const BUFFER: usize = 1 << 18;
/// The longest wait for another process that replaces the same file.
#[cfg(unix)]
const LONGEST_TURN: Duration = Duration::from_secs(5);

/// A file that is being written.
///
/// A regular file is written next to its place and moved there by [`Target::finish`]. If the target
/// is dropped before that, nothing remains and an old file is unchanged. A device or a pipe is
/// written directly.
pub(crate) struct Target<'a> {
    path: &'a Path,
    writer: BufWriter<File>,
    unfinished: Option<Unfinished>,
    cancel: &'a Cancel,
}

struct Unfinished {
    temporary: TempPath,
    place: PathBuf,
    permissions: Option<Permissions>,
}

impl<'a> Target<'a> {
    /// Starts writing the file at `path`; `cancel` removes the unfinished file.
    pub(crate) fn create(path: &'a Path, cancel: &'a Cancel) -> Result<Self, Error> {
        let place = Destination::of(path).map_err(|error| Error::unwritable(path, error))?;
        Self::at(place, path, cancel)
    }

    fn at(place: Destination, path: &'a Path, cancel: &'a Cancel) -> Result<Self, Error> {
        let unwritable = |error| Error::unwritable(path, error);
        let (file, unfinished) = match place {
            // Opened without blocking other threads on `cancel`: opening a pipe may take until
            // someone reads it.
            Destination::Through(place) => {
                cancel.check()?;
                let opened = OpenOptions::new().write(true).open(place);
                (opened.map_err(unwritable)?, None)
            }
            Destination::File(place, permissions) => {
                let created = cancel.begin_file(|| {
                    let (file, temporary) = temporary_file(&place)?.into_parts();
                    let path = temporary.to_path_buf();
                    Ok(((file, temporary), path))
                })?;
                let (file, temporary) = created.map_err(unwritable)?;
                let unfinished = Unfinished {
                    temporary,
                    place,
                    permissions,
                };
                (file, Some(unfinished))
            }
        };
        Ok(Self {
            path,
            writer: BufWriter::with_capacity(BUFFER, file),
            unfinished,
            cancel,
        })
    }

    /// Returns the output for the bytes of the file.
    pub(crate) fn output(&mut self) -> Output<'_> {
        if self.unfinished.is_some() {
            Output::File(&mut self.writer)
        } else {
            Output::Stream(&mut self.writer)
        }
    }

    /// Moves the file to its place.
    pub(crate) fn finish(self) -> Result<(), Error> {
        self.finish_over(None)
    }

    /// Moves the file to its place; if there are `old` bytes, only if these are there.
    fn finish_over(mut self, old: Option<&[u8]>) -> Result<(), Error> {
        let error = |error| Error::unwritable(self.path, error);
        self.writer.flush().map_err(error)?;
        let Some(unfinished) = self.unfinished.take() else {
            return Ok(());
        };
        if let Some(permissions) = unfinished.permissions {
            self.writer
                .get_ref()
                .set_permissions(permissions)
                .map_err(error)?;
        }
        let temporary = unfinished.temporary.to_path_buf();
        let unchanged = old.map_or(Ok(None), |old| unchanged(&unfinished.place, old));
        self.cancel.end_file(&temporary, || {
            self.cancel.check()?;
            let _turn = unchanged.map_err(|error| Error::unwritable(self.path, error))?;
            let moved = unfinished.temporary.persist(&unfinished.place);
            moved.map_err(|failed| Error::unwritable(self.path, failed.error))
        })
    }
}

impl Drop for Target<'_> {
    fn drop(&mut self) {
        if let Some(unfinished) = self.unfinished.take() {
            let temporary = unfinished.temporary.to_path_buf();
            self.cancel.end_file(&temporary, || drop(unfinished));
        }
    }
}

/// Writes a file whole or not at all, as pictures are written. A file with several hard links is
/// written in its place instead, so that all of them lead to the new content.
///
/// # Errors
///
/// Fails if the file cannot be written.
pub fn write_file(path: impl AsRef<Path>, content: &[u8], cancel: &Cancel) -> Result<(), Error> {
    let path = path.as_ref();
    if let Some(place) = linked(path) {
        cancel.check()?;
        return fs::write(place, content).map_err(|error| Error::unwritable(path, error));
    }
    let mut target = Target::create(path, cancel)?;
    let written = target.output().write_all(content);
    written.map_err(|error| Error::unwritable(path, error))?;
    target.finish()
}

/// Returns the place of a regular file that has several hard links.
fn linked(path: &Path) -> Option<PathBuf> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;

        let place = follow_links(path).ok()?;
        let found = fs::metadata(&place).ok()?;
        (found.is_file() && found.nlink() > 1).then_some(place)
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        None
    }
}

/// Replaces a text that was read from a file, as [`write_file`] writes it. If another program has
/// changed the file since then, nothing is written.
///
/// # Errors
///
/// Fails if the file has changed or cannot be written.
pub fn replace_file(
    path: impl AsRef<Path>,
    read: &[u8],
    content: &[u8],
    cancel: &Cancel,
) -> Result<(), Error> {
    let path = path.as_ref();
    let unwritable = |error| Error::unwritable(path, error);
    let place = Destination::of(path).map_err(unwritable)?;
    if matches!(place, Destination::Through(_)) {
        // Opening a pipe may wait for ever.
        return Err(unwritable(io::Error::other("is not a regular file")));
    }
    if let Some(place) = linked(path) {
        let _turn = unchanged(&place, read).map_err(unwritable)?;
        cancel.check()?;
        return fs::write(place, content).map_err(unwritable);
    }
    let mut target = Target::at(place, path, cancel)?;
    target.output().write_all(content).map_err(unwritable)?;
    target.finish_over(Some(read))
}

/// Returns the file at a place if it still has these bytes. On Unix, other processes that replace
/// the file wait until it is dropped.
fn unchanged(place: &Path, read: &[u8]) -> io::Result<Option<File>> {
    let changed = || {
        let message = "another program has changed the file since it was read, so it was not \
                       overwritten; run the command again";
        io::Error::new(io::ErrorKind::ResourceBusy, message)
    };
    let file = match take_turn(place) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(changed()),
        file => file?,
    };
    match has_bytes(&file, read)? {
        true => Ok(Some(file)),
        false => Err(changed()),
    }
}

/// Opens a file that no other process is replacing, and locks it.
#[cfg(unix)]
fn take_turn(place: &Path) -> io::Result<File> {
    let start = Instant::now();
    loop {
        let file = open_file(place)?;
        match file.try_lock() {
            // Another process was faster.
            Ok(()) if !is_at(&file, place) => {}
            // The file system may have no locks.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(file),
            Err(TryLockError::WouldBlock) if start.elapsed() > LONGEST_TURN => {
                let message = "another program has locked the file";
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, message));
            }
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(1)),
        }
    }
}

#[cfg(not(unix))]
fn take_turn(place: &Path) -> io::Result<File> {
    open_file(place)
}

/// Returns true if a file has exactly these bytes.
fn has_bytes(file: &File, mut bytes: &[u8]) -> io::Result<bool> {
    let mut reader = BufReader::with_capacity(BUFFER, file);
    loop {
        let block = reader.fill_buf()?;
        if block.is_empty() {
            return Ok(bytes.is_empty());
        }
        match bytes.strip_prefix(block) {
            Some(rest) => bytes = rest,
            None => return Ok(false),
        }
        let length = block.len();
        reader.consume(length);
    }
}

/// The destination at the end of a path.
enum Destination {
    /// A device or a pipe.
    Through(PathBuf),
    /// A regular file, with its permissions to keep, or nothing yet.
    File(PathBuf, Option<Permissions>),
}

impl Destination {
    fn of(path: &Path) -> io::Result<Self> {
        let old = match fs::metadata(path) {
            Ok(old) => old,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Self::File(follow_links(path)?, None));
            }
            Err(error) => return Err(error),
        };
        if old.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        // The links of what is open already, such as /dev/stdout, lead to no place.
        if !old.is_file() {
            return Ok(Self::Through(path.to_owned()));
        }
        if old.permissions().readonly() {
            return Err(io::Error::other("the file is write-protected"));
        }
        Ok(Self::File(follow_links(path)?, Some(old.permissions())))
    }
}

/// Returns the place that the links of a path lead to; the file itself need not exist.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&place) else {
            return Ok(place);
        };
        place = place.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Creates a file in the folder of `place`, so that it can be moved there.
///
/// Its name is derived from that of `place`, so that the next process finds the leftovers of a
/// killed one. It is locked, so that a file still being written is left alone.
#[cfg(unix)]
fn temporary_file(place: &Path) -> io::Result<NamedTempFile> {
    /// The maximum number of simultaneous files for one place.
    const MOST: usize = 1000;
    let folder = folder_of(place);
    let name = place.file_name().unwrap_or_default().as_encoded_bytes();
    // FNV-1a: the file name itself may already have the maximum length.
    let hash = name.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    });
    for number in 0..MOST {
        let path = folder.join(format!("{PREFIX}{hash:016x}-{number}{SUFFIX}"));
        let created = File::options().write(true).create_new(true).open(&path);
        let file = match created {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                clear_left_behind(&path);
                match File::options().write(true).create_new(true).open(&path) {
                    Ok(file) => file,
                    Err(_) => continue,
                }
            }
            Err(error) => return Err(error),
        };
        match file.try_lock() {
            // Another process took the file for a leftover and has removed it.
            Ok(()) if !is_at(&file, &path) => {}
            Ok(()) => {
                return Ok(NamedTempFile::from_parts(
                    file,
                    TempPath::try_from_path(path)?,
                ));
            }
            // Another process takes the file for a leftover and will remove it.
            Err(TryLockError::WouldBlock) => {}
            Err(TryLockError::Error(_)) => {
                // The file system has no locks: use any other name and clear nothing away.
                let _ = fs::remove_file(&path);
                break;
            }
        }
    }
    any_temporary_file(folder)
}

/// Removes a temporary file that no process is writing any more. Only the holder of the lock
/// removes it, so that it is still the same file.
#[cfg(unix)]
fn clear_left_behind(path: &Path) {
    let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    if is_file
        && let Ok(file) = open_file(path)
        && file.try_lock().is_ok()
        && is_at(&file, path)
    {
        let _ = fs::remove_file(path);
    }
}

#[cfg(not(unix))]
fn temporary_file(place: &Path) -> io::Result<NamedTempFile> {
    any_temporary_file(folder_of(place))
}

const PREFIX: &str = ".strahl-";
const SUFFIX: &str = ".tmp";

fn any_temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // tempfile makes its files private; a picture gets the mode of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::error::ErrorKind;

    fn write(path: &Path) -> Result<(), Error> {
        let cancel = Cancel::new();
        let mut target = Target::create(path, &cancel)?;
        target.output().write_all(b"new").unwrap();
        target.finish()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect()
    }

    #[test]
    fn an_old_file_survives_until_the_new_one_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, "old").unwrap();
        let cancel = Cancel::new();
        let mut target = Target::create(&path, &cancel).unwrap();
        target.output().write_all(b"half").unwrap();
        drop(target);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.png"]);

        write(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_cancelled_file_is_removed_at_once_and_for_good() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let cancel = Cancel::new();
        let target = Target::create(&path, &cancel).unwrap();
        cancel.cancel();
        assert_eq!(names(folder.path()), [""; 0]);
        assert_eq!(target.finish().unwrap_err().kind(), ErrorKind::Interrupted);
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    fn impossible_targets_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |path: &Path| write(path).unwrap_err();
        let missing = refused(&folder.path().join("missing/a.png"));
        assert_eq!(missing.kind(), ErrorKind::Target);
        assert!(
            missing
                .to_string()
                .ends_with("missing/a.png: no such file or folder")
        );
        assert!(
            refused(folder.path())
                .to_string()
                .ends_with("is a folder, not a file")
        );
    }

    #[test]
    fn a_text_that_has_changed_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (path, cancel) = (folder.path().join("a.ron"), Cancel::new());
        fs::write(&path, "read").unwrap();
        replace_file(&path, b"read", b"new", &cancel).unwrap();
        for there in ["", "rea", "read", "new and more"] {
            fs::write(&path, there).unwrap();
            let error = replace_file(&path, b"new", b"newer", &cancel).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Unavailable);
            assert_eq!(fs::read_to_string(&path).unwrap(), there);
        }
        fs::remove_file(&path).unwrap();
        assert!(replace_file(&path, b"new", b"newer", &cancel).is_err());
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    fn of_many_that_replace_a_text_at_once_one_succeeds() {
        let folder = tempfile::tempdir().unwrap();
        let (path, cancel) = (folder.path().join("a.ron"), Cancel::new());
        for round in 0..20_u8 {
            fs::write(&path, [round]).unwrap();
            let write = |own: u8| replace_file(&path, &[round], &[100, own], &cancel).is_ok();
            let succeeded = std::thread::scope(|scope| {
                let writers = [0, 1, 2, 3].map(|own| scope.spawn(move || write(own)));
                writers.map(|writer| writer.join().unwrap())
            });
            let there = fs::read(&path).unwrap();
            let winners = (0..4_u8).filter(|own| succeeded[usize::from(*own)]);
            assert_eq!(winners.collect::<Vec<_>>(), [there[1]]);
        }
    }

    #[cfg(unix)]
    #[test]
    fn leftover_files_are_removed_and_files_in_use_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let cancel = Cancel::new();
        let mut one = Target::create(&path, &cancel).unwrap();
        one.output().write_all(b"one").unwrap();
        let mut other = Target::create(&path, &cancel).unwrap();
        other.output().write_all(b"other").unwrap();
        assert_eq!(names(folder.path()).len(), 2, "each has its own");
        one.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        // The state that a killed process leaves: the file exists and is not locked.
        let [left] = &*fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|entry| *entry != path)
            .collect::<Vec<_>>()
        else {
            panic!("the other is gone");
        };
        let left = left.clone();
        other.finish().unwrap();
        let first = left.with_file_name(
            left.file_name()
                .unwrap()
                .to_str()
                .unwrap()
                .replace("-1", "-0"),
        );
        fs::write(&first, "left behind").unwrap();
        write(&path).unwrap();
        assert_eq!(names(folder.path()), ["a.png"]);
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn links_modes_and_devices_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (
            folder.path().join("real.png"),
            folder.path().join("link.png"),
        );
        symlink("real.png", &link).unwrap();
        write(&link).unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());

        fs::set_permissions(&real, Permissions::from_mode(0o640)).unwrap();
        write(&real).unwrap();
        assert_eq!(
            fs::metadata(&real).unwrap().permissions().mode() & 0o777,
            0o640
        );

        fs::set_permissions(&real, Permissions::from_mode(0o440)).unwrap();
        assert_eq!(write(&real).unwrap_err().kind(), ErrorKind::Target);

        write(Path::new("/dev/null")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
