//! A pair of pictures and its result.

use std::{
    io::{self, BufRead, BufReader},
    path::{Path, PathBuf},
    time::Duration,
};

use serde::{Serialize, Serializer};
use strahl::{
    Error,
    compare::{CompareOptions, Picture},
    diagnostic::open_file,
};

use super::{args::Args, pair::Report};

/// The result of comparing two pictures, in the order of the summary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    Equal,
    WithinLimits,
    Different,
    Missing,
    Extra,
    Unreadable,
}

impl Verdict {
    pub(super) const ALL: [Self; 6] = [
        Self::Equal,
        Self::WithinLimits,
        Self::Different,
        Self::Missing,
        Self::Extra,
        Self::Unreadable,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Equal => "equal",
            Self::WithinLimits => "within the limits",
            Self::Different => "different",
            Self::Missing => "missing",
            Self::Extra => "extra",
            Self::Unreadable => "unreadable",
        }
    }

    /// Returns true if `--update` accepts the new picture.
    pub(super) const fn is_taken_over(self) -> bool {
        matches!(self, Self::Different | Self::Extra)
    }
}

/// A pair of pictures with the same name.
#[derive(Serialize)]
pub(super) struct PicturePair {
    #[serde(rename = "file", serialize_with = "lossy")]
    pub(super) name: PathBuf,
    pub(super) result: Verdict,
    /// True if `--update` accepted the new picture.
    pub(super) updated: bool,
    #[serde(skip)]
    pub(super) time: Duration,
    pub(super) error: Option<String>,
    pub(super) compared: Option<Box<Report>>,
}

fn lossy<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

impl PicturePair {
    pub(super) fn new(name: &Path, result: Verdict) -> Self {
        Self {
            name: name.to_owned(),
            result,
            updated: false,
            time: Duration::ZERO,
            error: None,
            compared: None,
        }
    }

    /// Returns the row of two pictures that have been compared.
    pub(super) fn compared(name: &Path, report: Report) -> Self {
        let row = Self::new(name, report.kind());
        Self {
            compared: Some(report.into()),
            ..row
        }
    }

    /// Returns the row of a picture that could not be read.
    pub(super) fn unreadable(name: &Path, error: &Error) -> Self {
        Self {
            error: Some(error.to_string()),
            ..Self::new(name, Verdict::Unreadable)
        }
    }

    /// Returns true if the pictures differ too much and `--update` did not accept that.
    pub(super) fn fails(&self) -> bool {
        !matches!(self.result, Verdict::Equal | Verdict::WithinLimits) && !self.updated
    }

    /// Returns the details besides the kind and the name.
    pub(super) fn about(&self) -> String {
        match self.result {
            Verdict::Missing => "no new picture".to_owned(),
            Verdict::Extra => "no golden picture".to_owned(),
            _ => {
                let compared = self.compared.as_ref().map(|report| report.line());
                compared.or_else(|| self.error.clone()).unwrap_or_default()
            }
        }
    }
}

/// The PNG files to show: both pictures and their heat picture.
pub(super) struct Shown {
    pub(super) golden: Vec<u8>,
    pub(super) new: Vec<u8>,
    pub(super) heat: Option<Vec<u8>>,
}

/// The images to make of pictures that fail.
#[derive(Clone, Copy, Default)]
pub(super) struct Images {
    pub(super) heat: bool,
    pub(super) pictures: bool,
}

/// Compares two existing files.
pub(super) fn compare(
    [a_path, b_path]: [&Path; 2],
    args: &Args,
    options: &CompareOptions,
    images: Images,
) -> Result<(Report, Option<Shown>), Error> {
    let reading = args.reading();
    let read = |path| Picture::read_with(path, &reading);
    let (a, b) = (read(a_path)?, read(b_path)?);
    let (found, heat) = if images.heat || images.pictures {
        a.compare_with_heat(&b, options)?.unzip()
    } else {
        (a.compare(&b, options)?, None)
    };
    let report = Report::new((a_path, &a), (b_path, &b), found, &args.limits);
    if report.failed.is_empty() {
        return Ok((report, None));
    }
    let png = |picture: &Picture| {
        if images.pictures && picture.has_colors() {
            picture.to_png()
        } else {
            Ok(Vec::new())
        }
    };
    let (golden, new) = (png(&a)?, png(&b)?);
    let heat = heat.filter(|_| a.has_colors() && b.has_colors());
    Ok((report, Some(Shown { golden, new, heat })))
}

/// Returns true if two files have the same bytes.
pub(super) fn same_bytes(a: &Path, b: &Path) -> io::Result<bool> {
    // A pipe would be consumed, and a device has no end.
    if ![a, b].iter().all(|path| path.is_file()) {
        return Ok(false);
    }
    let (a, b) = (open_file(a)?, open_file(b)?);
    if a.metadata()?.len() != b.metadata()?.len() {
        return Ok(false);
    }
    let (mut a, mut b) = (BufReader::new(a), BufReader::new(b));
    loop {
        let (ours, theirs) = (a.fill_buf()?, b.fill_buf()?);
        let count = ours.len().min(theirs.len());
        if ours[..count] != theirs[..count] {
            return Ok(false);
        }
        if count == 0 {
            return Ok(true);
        }
        a.consume(count);
        b.consume(count);
    }
}
