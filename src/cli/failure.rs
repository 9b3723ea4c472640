//! The reason why a command failed, its message and its exit status.

use std::{
    fmt::Display,
    io::{self, Write},
    path::Path,
};

use strahl::{Error, ErrorKind, text::sanitize};

use super::{interrupt, params::TableFaults};

/// The name of standard output in messages.
pub(super) const STDOUT: &str = "<stdout>";

/// The reason why a command failed.
#[derive(Debug)]
pub(super) enum Failure {
    /// Errors in a scene, or pictures that differ or are missing; already printed.
    Found,
    /// Wrong usage or an unreadable file; already printed.
    Reported,
    /// An error from the library.
    Library(Error),
    /// A wrong argument that clap does not detect.
    Usage(String),
    /// An unusable table of values.
    Table(Box<TableFaults>),
    /// A closed output: the reader of the result has seen enough. The exit status is that of the
    /// result.
    Closed { status: u8 },
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::usage(error.to_string())
    }
}

impl Failure {
    pub(super) fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    /// Returns the failure for a file that the command cannot use.
    pub(super) fn refused(path: &Path, why: impl Display) -> Self {
        Self::Usage(format!("{}: {why}", path.display()))
    }

    /// Returns the failure for text that could not be written to standard output.
    pub(super) fn stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::Closed { status: 0 }
        } else {
            Self::Library(Error::writing_failed(STDOUT, error))
        }
    }

    pub(super) fn status(&self) -> u8 {
        match self {
            Self::Closed { status } => *status,
            Self::Found => 1,
            Self::Reported | Self::Usage(_) | Self::Table(_) => 2,
            Self::Library(error) => match error.kind() {
                ErrorKind::Scene | ErrorKind::Incomplete => 1,
                ErrorKind::Unavailable => 75,
                ErrorKind::Interrupted => interrupt::STATUS,
                _ => 2,
            },
        }
    }

    /// Returns the failure that determines the exit status: 2 before 75 before 1. Prints the
    /// message of the other one.
    pub(super) fn worst(one: Result<(), Self>, other: Result<(), Self>) -> Result<(), Self> {
        let rank = |failure: &Self| match failure.status() {
            2 => 3,
            75 => 2,
            status => u8::from(status != 0),
        };
        match (one, other) {
            (Err(one), Err(other)) => {
                let (worst, other) = if rank(&one) >= rank(&other) {
                    (one, other)
                } else {
                    (other, one)
                };
                other.print();
                Err(worst)
            }
            (one, other) => one.and(other),
        }
    }

    /// Prints the message, unless it has been printed already.
    pub(super) fn print(&self) {
        if let Some(message) = self.message() {
            print_error(&message);
        }
    }

    /// Returns the message that has not been printed yet.
    pub(super) fn message(&self) -> Option<String> {
        match self {
            Self::Found | Self::Reported | Self::Closed { .. } => None,
            Self::Library(error) => Some(error.to_string()),
            Self::Usage(message) => Some(message.clone()),
            Self::Table(faults) => Some(faults.message()),
        }
    }
}

/// Prints an error message on one line of standard error.
pub(super) fn print_error(message: &str) {
    // If this cannot be written, nobody can be informed.
    let _ = writeln!(io::stderr(), "error: {}", sanitize(message));
}
