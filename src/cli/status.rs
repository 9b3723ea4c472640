//! `strahl status`: the finished part of a job.

use std::{collections::HashSet, fmt, path::PathBuf};

use serde::Serialize;
use strahl::text::{Stamp, sanitize};

use super::{
    failure::Failure,
    output::OutputFormat,
    record::{FOLDER, Failed, Plan, Records},
};

/// The maximum number of names shown of each kind.
const MOST: usize = 20;
/// The maximum number of unstarted parts listed in JSON.
const MOST_PARTS: usize = 10_000;

/// Show finished, missing and damaged pictures of a folder
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The folder, as in `strahl render -o FOLDER/`
    folder: PathBuf,
    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    output_format: OutputFormat,
}

#[derive(Serialize)]
struct Status {
    format: u32,
    /// Number of pictures of all parts of the job.
    total: u64,
    shards: u32,
    /// The first parts that have not been started.
    not_begun: Vec<u32>,
    /// Number of parts that have not been started.
    #[serde(skip)]
    parts_not_begun: u32,
    done: usize,
    /// Number of files that are not scenes.
    skipped: usize,
    missing: Vec<String>,
    damaged: Vec<String>,
    failed: Vec<Failed>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let folder = &args.folder;
    let records = Records::read(folder)?;
    let Some(newest) = records.plans.last() else {
        let message = "there is no record of a run in this folder";
        return Err(Failure::refused(&folder.join(FOLDER), message));
    };
    let status = Status::of(&records, newest, folder);
    let printed = super::output::print_as(args.output_format, Stamp::Status, &status);
    let result = match status.is_done() {
        true => Ok(()),
        false => Err(Failure::Found),
    };
    Failure::worst(printed, result)
}

impl Status {
    fn of(records: &Records, newest: &Plan, folder: &std::path::Path) -> Self {
        let begun: HashSet<_> = records.plans.iter().map(|plan| plan.shard).collect();
        let not_begun = (0..newest.shards).filter(|shard| !begun.contains(shard));
        let mut status = Self {
            format: 1,
            total: newest.total,
            shards: newest.shards,
            not_begun: not_begun.take(MOST_PARTS).collect(),
            parts_not_begun: newest.shards.saturating_sub(begun.len() as u32),
            done: 0,
            skipped: 0,
            missing: Vec::new(),
            damaged: Vec::new(),
            failed: Vec::new(),
        };
        for picture in records.plans.iter().flat_map(|plan| &plan.pictures) {
            let mut done = records.done(picture, None).peekable();
            let is_known = done.peek().is_some();
            let is_whole = done.any(|done| done.files.iter().all(|file| file.is_there(folder)));
            let mut files = records.done(picture, None).flat_map(|done| &done.files);
            let is_there = files.any(|file| folder.join(&file.file).exists());
            if is_whole {
                status.done += 1;
            } else if records.skipped.contains(picture) {
                status.skipped += 1;
            } else if let (Some(failed), false) = (records.failed.get(picture), is_there) {
                status.failed.push(failed.clone());
            } else if is_known && is_there {
                status.damaged.push(picture.clone());
            } else {
                status.missing.push(picture.clone());
            }
        }
        status
    }

    fn is_done(&self) -> bool {
        let lists = [&self.missing, &self.damaged];
        lists.iter().all(|list| list.is_empty())
            && self.failed.is_empty()
            && self.not_begun.is_empty()
    }
}

impl fmt::Display for Status {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let total = self.total.saturating_sub(self.skipped as u64);
        writeln!(out, "{} of {total} pictures are done", self.done)?;
        let failed = self.failed.iter();
        let failed = failed.map(|failed| format!("{}: {}", failed.picture, failed.error));
        let not_begun = self.not_begun.iter();
        let not_begun = not_begun.map(|shard| format!("{shard}/{}", self.shards));
        let parts = self.parts_not_begun as usize;
        let lists = [
            ("parts not started", parts, not_begun.collect()),
            ("missing", self.missing.len(), self.missing.clone()),
            ("damaged", self.damaged.len(), self.damaged.clone()),
            ("failed", self.failed.len(), failed.collect::<Vec<_>>()),
        ];
        for (what, count, list) in lists.iter().filter(|(_, count, _)| *count > 0) {
            writeln!(out, "{count} {what}")?;
            for name in list.iter().take(MOST) {
                writeln!(out, "  {}", sanitize(name))?;
            }
            if let Some(more) = count.checked_sub(MOST).filter(|more| *more > 0) {
                writeln!(out, "  and {more} more")?;
            }
        }
        Ok(())
    }
}
