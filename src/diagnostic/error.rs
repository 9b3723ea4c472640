//! The error type of the library.

use std::{
    error::Error as StdError,
    fmt, io,
    path::{Path, PathBuf},
};

use crate::{
    diagnostic::{Diagnostic, Severity},
    text::sanitize::sanitize,
};

/// The kind of an [`Error`], by the possible reactions of a caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The scene has errors; [`Error::diagnostics`] holds them.
    Scene,
    /// A file cannot be read: it is missing, is a folder, or its permissions forbid it.
    Unreadable,
    /// The request is invalid: a size out of range, an unknown file format.
    Usage,
    /// The target cannot be written: the folder does not exist, or its permissions forbid it.
    Target,
    /// The target could not be written now: the disk is full, the file is busy. A later attempt may
    /// succeed.
    Unavailable,
    /// The picture cannot be assembled because parts of it are missing.
    Incomplete,
    /// The work was cancelled.
    Interrupted,
}

/// The reason why a scene was not read, rendered or saved.
///
/// `Display` writes one line with the file and the cause. `Debug`, which prints an error that
/// `main` returns, writes every fault of a scene with its place and help, or else that line and the
/// help.
pub struct Error(Box<Inner>);

struct Inner {
    kind: ErrorKind,
    path: Option<PathBuf>,
    message: String,
    source: Option<Box<dyn StdError + Send + Sync>>,
    diagnostics: Vec<Diagnostic>,
    /// The faults with their places, as plain text.
    listing: String,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self(Box::new(Inner {
            kind,
            path: None,
            message: message.into(),
            source: None,
            diagnostics: Vec::new(),
            listing: String::new(),
        }))
    }

    /// Creates the error of a faulty scene: `message` is the first fault with its place, `listing`
    /// has all of them.
    pub(crate) fn scene(
        message: impl Into<String>,
        diagnostics: Vec<Diagnostic>,
        listing: String,
    ) -> Self {
        let mut error = Self::new(ErrorKind::Scene, message);
        error.0.diagnostics = diagnostics;
        error.0.listing = listing;
        error
    }

    /// Creates the error for a request that cannot be met.
    pub(crate) fn refused(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// Creates the error of an invalid option.
    pub(crate) fn usage(fault: Diagnostic) -> Self {
        let mut error = Self::new(ErrorKind::Usage, &*fault.message);
        error.0.diagnostics.push(fault);
        error
    }

    /// Creates the error of a file that could not be read.
    pub(crate) fn unreadable(path: &Path, source: io::Error) -> Self {
        // A reader that is cancelled fails with the error of the cancellation.
        let error = source.downcast::<Self>().unwrap_or_else(|source| {
            Self::new(ErrorKind::Unreadable, reason(&source)).caused_by(source)
        });
        error.at(path)
    }

    /// Creates the error of a file that could not be written.
    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Self {
        Self::writing(source).at(path)
    }

    /// Creates the error of a stream or a file with this name that could not be read.
    pub fn reading_failed(path: impl AsRef<Path>, source: io::Error) -> Self {
        Self::unreadable(path.as_ref(), source)
    }

    /// Creates the error of a stream or a file with this name that could not be written.
    pub fn writing_failed(path: impl AsRef<Path>, source: io::Error) -> Self {
        Self::unwritable(path.as_ref(), source)
    }

    /// Creates the error of a failed write; whoever knows the name adds it.
    pub(crate) fn writing(source: io::Error) -> Self {
        let kind = match source.kind() {
            io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
            | io::ErrorKind::FileTooLarge
            | io::ErrorKind::ResourceBusy
            | io::ErrorKind::ExecutableFileBusy
            | io::ErrorKind::Interrupted
            | io::ErrorKind::TimedOut
            | io::ErrorKind::WouldBlock
            | io::ErrorKind::OutOfMemory => ErrorKind::Unavailable,
            _ => ErrorKind::Target,
        };
        Self::new(kind, reason(&source)).caused_by(source)
    }

    pub(crate) fn interrupted() -> Self {
        Self::new(ErrorKind::Interrupted, "interrupted")
    }

    /// Returns the error with the name of its file or stream.
    #[must_use]
    pub fn of_file(self, path: impl AsRef<Path>) -> Self {
        self.at(path.as_ref())
    }

    #[must_use]
    pub(crate) fn at(mut self, path: &Path) -> Self {
        self.0.path = Some(path.to_owned());
        self
    }

    #[must_use]
    pub(crate) fn caused_by(mut self, source: impl StdError + Send + Sync + 'static) -> Self {
        self.0.source = Some(Box::new(source));
        self
    }

    /// Returns the message without the file, which [`Error::path`] returns.
    pub fn cause(&self) -> &str {
        &self.0.message
    }

    /// Returns the kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Returns the file concerned, if any.
    pub fn path(&self) -> Option<&Path> {
        self.0.path.as_deref()
    }

    /// Returns every fault of the scene, in file order, if [`Error::kind`] is [`ErrorKind::Scene`].
    /// For [`ErrorKind::Usage`] it is the fault of the given text, if known.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.0.diagnostics
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.0.path {
            write!(f, "{}: ", sanitize(&path.to_string_lossy()))?;
        }
        f.write_str(&sanitize(&self.0.message))?;
        let errors = self.0.diagnostics.iter();
        match errors
            .filter(|fault| fault.severity == Severity::Error)
            .count()
        {
            0 | 1 => Ok(()),
            2 => write!(f, " (and one more error)"),
            count => write!(f, " (and {} more errors)", count - 1),
        }
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.listing.is_empty() {
            return f.write_str(&self.0.listing);
        }
        fmt::Display::fmt(self, f)?;
        let faults = self.0.diagnostics.iter();
        let mut helps = faults.filter_map(|fault| fault.help.as_deref());
        helps.try_for_each(|help| write!(f, "\nhelp: {}", sanitize(help)))
    }
}

impl StdError for Error {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        self.0.source.as_deref().map(|source| source as _)
    }
}

/// Returns the cause in plain words: in lower case, and without the operating system's error
/// number.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::IsADirectory => "is a folder, not a file".to_owned(),
        io::ErrorKind::NotADirectory => "a part of the path is a file, not a folder".to_owned(),
        io::ErrorKind::StorageFull => "no space left on the disk".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
        io::ErrorKind::BrokenPipe => "the reader closed the pipe".to_owned(),
        _ => {
            let text = error.to_string();
            let text = text.split(" (os error").next().unwrap_or(&text);
            let mut letters = text.chars();
            letters.next().map_or_else(String::new, |first| {
                first.to_lowercase().chain(letters).collect()
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_with_file_and_cause() {
        let source = io::Error::from(io::ErrorKind::NotFound);
        let error = Error::unreadable(Path::new("a.ron"), source);
        assert_eq!(error.to_string(), "a.ron: no such file or folder");
        assert_eq!(error.kind(), ErrorKind::Unreadable);
        assert!(error.source().is_some());
    }

    #[test]
    fn a_full_disk_may_have_space_later() {
        let full = Error::unwritable(Path::new("a.png"), io::ErrorKind::StorageFull.into());
        assert_eq!(full.kind(), ErrorKind::Unavailable);
        let folder = Error::unwritable(Path::new("a.png"), io::ErrorKind::NotFound.into());
        assert_eq!(folder.kind(), ErrorKind::Target);
    }
}
