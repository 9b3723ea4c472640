//! The result of a command on standard output.

use std::{
    fmt::Display,
    io::{self, Write},
};

use clap::ValueEnum;
use serde::Serialize;
use strahl::text::{Stamp, Stamped, sanitize};

use super::failure::Failure;

/// The output format of a command's result.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum OutputFormat {
    /// Human-readable text
    Human,
    /// One JSON object
    Json,
}

/// Returns a result as indented JSON.
pub(super) fn json(stamp: Stamp, result: &impl Serialize) -> Result<String, Failure> {
    let json = serde_json::to_string_pretty(&Stamped::new(stamp, result))?;
    Ok(json + "\n")
}

/// Prints a result in the requested format.
pub(super) fn print_as<T: Serialize + Display>(
    format: OutputFormat,
    stamp: Stamp,
    result: &T,
) -> Result<(), Failure> {
    print(&match format {
        OutputFormat::Human => for_people(&result.to_string()),
        OutputFormat::Json => json(stamp, result)?,
    })
}

/// Returns a text for people, in which nothing acts on a terminal, whatever names it contains.
pub(super) fn for_people(text: &str) -> String {
    let lines = text.lines();
    lines
        .flat_map(|line| [sanitize(line), "\n".into()])
        .collect()
}

/// Prints a command's result.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes());
    written
        .and_then(|()| stdout.flush())
        .map_err(Failure::stdout)
}
