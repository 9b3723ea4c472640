//! The use of the results: heat pictures, the page, accepted pictures, the report.

use std::{
    collections::BTreeMap,
    ffi::{OsStr, OsString},
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use serde::Serialize;
use strahl::{
    Error,
    diagnostic::read_file,
    image_file::write_file,
    parallel::Cancel,
    report::{JunitFailure, JunitWriter},
    text::{Stamp, sanitize},
};

use super::{
    super::failure::Failure,
    args::{Args, Format},
    page::Page,
    row::{PicturePair, Shown, Verdict},
};

/// The results of all pictures.
pub(super) struct Results<'a> {
    args: &'a Args,
    cancel: &'a Cancel,
    /// True if names are relative to folders.
    of_folders: bool,
    page: Page,
    rows: Vec<PicturePair>,
}

impl<'a> Results<'a> {
    pub(super) fn new(args: &'a Args, cancel: &'a Cancel, of_folders: bool) -> Self {
        Self {
            args,
            cancel,
            of_folders,
            page: Page::default(),
            rows: Vec::new(),
        }
    }

    pub(super) fn page_is_full(&self) -> Arc<AtomicBool> {
        self.page.full()
    }

    /// Takes the result of a pair.
    pub(super) fn take(
        &mut self,
        mut row: PicturePair,
        shown: Option<Shown>,
    ) -> Result<(), Failure> {
        if self.of_folders
            && let Some(folder) = &self.args.output
            && let Some(heat) = shown.as_ref().and_then(|shown| shown.heat.as_deref())
        {
            self.write(&folder.join(heat_name(&row.name)), heat)?;
        }
        if self.args.html.is_some() {
            self.page.add(&row, shown.as_ref());
        }
        if self.args.update && row.result.is_taken_over() {
            let [a, b] = self.places(&row.name);
            let file = read_file(&b, u64::MAX).map_err(|error| Error::reading_failed(&b, error))?;
            self.write(&a, &file)?;
            row.updated = true;
        }
        self.rows.push(row);
        Ok(())
    }

    fn places(&self, name: &Path) -> [PathBuf; 2] {
        [&self.args.a, &self.args.b].map(|side| match self.of_folders {
            true => side.join(name),
            false => side.clone(),
        })
    }

    /// Writes a file and creates its folder.
    fn write(&self, path: &Path, file: &[u8]) -> Result<(), Failure> {
        if let Some(folder) = path.parent() {
            let made = fs::create_dir_all(folder);
            made.map_err(|error| Error::writing_failed(folder, error))?;
        }
        Ok(write_file(path, file, self.cancel)?)
    }

    /// Prints the report, writes the page, and returns the overall result.
    pub(super) fn finish(self, skipped: u64) -> Result<(), Failure> {
        let summary = Summary::new(&self.rows, skipped);
        if let Some(html) = &self.args.html {
            let sides = [&*self.args.a, &*self.args.b];
            let page = self.page.finish(sides, &self.rows, &summary.to_text());
            self.write(html, page.as_bytes())?;
        }
        let text = match self.args.output_format {
            Format::Human if self.of_folders => {
                super::super::output::for_people(&self.to_text(&summary))
            }
            Format::Human => super::super::output::for_people(&self.pair_text()),
            Format::Json => self.json(&summary)?,
            Format::Junit => junit(&self.rows)?,
        };
        let printed = super::super::output::print(&text);
        let mut rows = self.rows.iter();
        let result = if summary.counts.get(&Verdict::Unreadable) > Some(&0) {
            Err(Failure::Reported)
        } else if rows.any(PicturePair::fails) {
            Err(Failure::Found)
        } else {
            Ok(())
        };
        Failure::worst(printed, result)
    }

    fn to_text(&self, summary: &Summary) -> String {
        let mut text = String::new();
        for row in self.rows.iter().filter(|row| row.result != Verdict::Equal) {
            let kind = match (row.updated, row.result) {
                (true, Verdict::Extra) => "added",
                (true, _) => "updated",
                (false, Verdict::WithinLimits) => "within",
                (false, kind) => kind.name(),
            };
            let name = row.name.to_string_lossy();
            let name = sanitize(&name);
            let _ = match row.result {
                Verdict::Unreadable => writeln!(text, "{kind:<11} {}", row.about()),
                _ => writeln!(text, "{kind:<11} {name}: {}", row.about()),
            };
        }
        if !text.is_empty() {
            text.push('\n');
        }
        text + &summary.to_text() + "\n"
    }

    /// Returns all figures of the single pair.
    fn pair_text(&self) -> String {
        let mut text = String::new();
        for row in &self.rows {
            text.extend(row.compared.as_ref().map(|report| report.to_text()));
            if row.updated {
                let [a, b] = self.places(&row.name);
                let [a, b] = [a.to_string_lossy(), b.to_string_lossy()];
                let _ = writeln!(text, "\n{} is now {}", sanitize(&a), sanitize(&b));
            }
        }
        text
    }

    fn json(&self, summary: &Summary) -> Result<String, Failure> {
        /// A single pair.
        #[derive(Serialize)]
        struct One<'a> {
            format: u32,
            #[serde(flatten)]
            report: &'a super::pair::Report,
            updated: bool,
        }
        #[derive(Serialize)]
        struct Folders<'a> {
            a: String,
            b: String,
            summary: &'a Summary,
            pictures: &'a [PicturePair],
        }
        if let [row] = &*self.rows
            && let (false, Some(report)) = (self.of_folders, &row.compared)
        {
            let updated = row.updated;
            let one = One {
                format: 1,
                report,
                updated,
            };
            return super::super::output::json(Stamp::Diff, &one);
        }
        let [a, b] = [&self.args.a, &self.args.b].map(|side| side.to_string_lossy().into_owned());
        let folders = Folders {
            a,
            b,
            summary,
            pictures: &self.rows,
        };
        super::super::output::json(Stamp::DiffFolder, &folders)
    }
}

/// Returns the name of the heat picture, which is a PNG file.
fn heat_name(name: &Path) -> PathBuf {
    let is_png = |ending: &OsStr| ending.eq_ignore_ascii_case("png");
    if name.extension().is_some_and(is_png) {
        return name.to_owned();
    }
    let mut name = OsString::from(name);
    name.push(".png");
    name.into()
}

/// The number of pictures by result.
#[derive(Serialize)]
pub(super) struct Summary {
    #[serde(flatten)]
    counts: BTreeMap<Verdict, usize>,
    updated: usize,
    skipped: u64,
}

impl Summary {
    fn new(rows: &[PicturePair], skipped: u64) -> Self {
        let count = |kind| rows.iter().filter(|row| row.result == kind).count();
        Self {
            counts: Verdict::ALL.map(|kind| (kind, count(kind))).into(),
            updated: rows.iter().filter(|row| row.updated).count(),
            skipped,
        }
    }

    fn to_text(&self) -> String {
        // The first five are always present, so that the line has a fixed form.
        let counts = self.counts.iter();
        let counts = counts.filter(|(kind, count)| **kind != Verdict::Unreadable || **count > 0);
        let counts: Vec<_> = counts
            .map(|(kind, count)| format!("{count} {}", kind.name()))
            .collect();
        let mut text = counts.join(", ");
        if self.updated > 0 {
            let _ = write!(text, "; {} updated", self.updated);
        }
        if self.skipped > 0 {
            let _ = write!(text, " ({} files are not pictures)", self.skipped);
        }
        text
    }
}

/// Returns the JUnit XML, with a test for each picture.
fn junit(rows: &[PicturePair]) -> Result<String, Failure> {
    let mut junit = JunitWriter::new(Vec::new(), "strahl diff");
    let mut write = || {
        for row in rows {
            let about = row.about();
            let failure = JunitFailure {
                message: &about,
                kind: row.result.name(),
                text: "",
            };
            let (failures, said) = if row.fails() {
                (vec![failure], "")
            } else {
                (Vec::new(), &*about)
            };
            junit.test(&row.name.to_string_lossy(), row.time, &failures, said)?;
        }
        Ok(())
    };
    let written = write().and_then(|()| junit.finish());
    let written = written.map_err(Failure::stdout)?;
    Ok(String::from_utf8_lossy(&written).into_owned())
}
