//! The errors of the encoder.

use std::io;

use png::EncodingError;

use crate::diagnostic::error::Error;

/// Returns the error of a file for one of the crate.
pub(in crate::image_file) fn error(error: EncodingError) -> Error {
    Error::writing(match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}
