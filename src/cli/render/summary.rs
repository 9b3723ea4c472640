//! The results of a run of many pictures.

use std::{
    collections::HashSet,
    fmt::Write as _,
    io::{self, Write as _},
    time::Duration,
};

use serde::Serialize;
use strahl::{ErrorKind, text::Stamp};

use super::{items::Item, list::List};
use crate::cli::{
    failure::Failure,
    record::{Done, Written},
};

/// The outcome of a picture.
#[derive(Debug)]
pub(super) enum Outcome {
    /// Left to all threads together.
    Later,
    Drawn(Done),
    /// Kept from an earlier run.
    Kept(Done),
    /// The file is not a scene.
    Skipped,
    Failed {
        /// The exit status for this failure.
        status: u8,
        message: String,
    },
}

impl Outcome {
    pub(super) fn of_failure(failure: &Failure) -> Self {
        let message = failure.message();
        Self::Failed {
            status: failure.status(),
            message: message.unwrap_or_else(|| "the scene has errors".to_owned()),
        }
    }

    const fn name(&self) -> &'static str {
        match self {
            Self::Later => "later",
            Self::Drawn(_) => "drawn",
            Self::Kept(_) => "kept",
            Self::Skipped => "skipped",
            Self::Failed { .. } => "failed",
        }
    }
}

/// The results of a run.
pub(super) struct Summary<'a> {
    counts: Counts,
    has_wrong_usage: bool,
    /// The faults of options that have been reported.
    reported: HashSet<String>,
    /// All outcomes, if they are wanted.
    all: Option<Vec<(&'a Item, Outcome)>>,
}

#[derive(Clone, Copy, Default, Serialize)]
struct Counts {
    drawn: u64,
    kept: u64,
    failed: u64,
    skipped: u64,
}

#[derive(Serialize)]
struct PictureTerms<'a> {
    status: &'static str,
    /// The name in the folder of the pictures.
    picture: String,
    scene: String,
    row: Option<usize>,
    frame: Option<u32>,
    hash: Option<&'a str>,
    files: &'a [Written],
    error: Option<&'a str>,
}

impl<'a> Summary<'a> {
    pub(super) fn new(is_kept: bool) -> Self {
        Self {
            counts: Counts::default(),
            has_wrong_usage: false,
            reported: HashSet::new(),
            all: is_kept.then(Vec::new),
        }
    }

    /// Returns true if a failure should be reported. A fault of the options that affects all
    /// pictures is reported for the first one only.
    pub(super) fn is_new(&mut self, failure: &Failure) -> bool {
        let Failure::Library(error) = failure else {
            return true;
        };
        if error.kind() != ErrorKind::Usage {
            return true;
        }
        self.reported.insert(error.cause().to_owned())
    }

    pub(super) fn add(&mut self, item: &'a Item, outcome: Outcome) {
        let Counts {
            drawn,
            kept,
            failed,
            skipped,
        } = &mut self.counts;
        match &outcome {
            Outcome::Later => {}
            Outcome::Drawn(_) => *drawn += 1,
            Outcome::Kept(_) => *kept += 1,
            Outcome::Skipped => *skipped += 1,
            Outcome::Failed { status, .. } => {
                *failed += 1;
                self.has_wrong_usage |= *status == 2;
            }
        }
        if let Some(all) = &mut self.all {
            all.push((item, outcome));
        }
    }

    /// Returns the failure of the run that results from its pictures.
    pub(super) fn failure(&self) -> Result<(), Failure> {
        match self.counts.failed {
            0 => Ok(()),
            _ if self.has_wrong_usage => Err(Failure::Reported),
            _ => Err(Failure::Found),
        }
    }

    /// Prints a summary line on standard error.
    pub(super) fn print(&self, time: Duration) {
        let counts = &self.counts;
        let parts = [
            (counts.drawn, "drawn"),
            (counts.kept, "kept"),
            (counts.failed, "failed"),
            (counts.skipped, "skipped (not scenes)"),
        ];
        let parts = parts.iter().enumerate();
        let parts = parts.filter(|(at, (count, _))| *at == 0 || *count > 0);
        let parts: Vec<_> = parts
            .map(|(_, (count, what))| format!("{count} {what}"))
            .collect();
        let (parts, seconds) = (parts.join(", "), time.as_secs_f64());
        // Whoever closed standard error does not want the message.
        let _ = writeln!(io::stderr(), "pictures: {parts} in {seconds:.1} s");
    }

    /// Returns the report of the run, with each picture on its own line.
    pub(super) fn json(&self, list: &List) -> serde_json::Result<String> {
        let mut text = format!(
            "{{\n  {},\n  \"format\": 1,\n  \"version\": {},\n  \"summary\": {},\n  \"pictures\": [",
            Stamp::Run,
            serde_json::to_string(env!("CARGO_PKG_VERSION"))?,
            serde_json::to_string(&self.counts)?
        );
        for (index, (item, outcome)) in self.all.iter().flatten().enumerate() {
            let (done, error) = match outcome {
                Outcome::Drawn(done) | Outcome::Kept(done) => (Some(done), None),
                Outcome::Failed { message, .. } => (None, Some(&**message)),
                Outcome::Later | Outcome::Skipped => (None, None),
            };
            let terms = PictureTerms {
                status: outcome.name(),
                picture: list.name(item).unwrap_or_default(),
                scene: list.scenes[item.scene].path.display().to_string(),
                row: item.row,
                frame: item.frame,
                hash: done.map(|done| &*done.hash),
                files: done.map_or(&[], |done| &done.files),
                error,
            };
            let comma = if index == 0 { "" } else { "," };
            // Writing to a string never fails.
            let _ = write!(text, "{comma}\n    {}", serde_json::to_string(&terms)?);
        }
        text.push_str("\n  ]\n}\n");
        Ok(text)
    }
}
