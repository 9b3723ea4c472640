//! A file that has been read and checked.

use std::io;

use crate::{
    parallel::timings::{Stage, Watch},
    scene::{
        check::{Checked, CheckedModel, check},
        files::{self, Content, FileText},
        options::ReadOptions,
        source::Source,
    },
    text::syntax::Syntax,
};

/// A text with the result of its check.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) source: Source,
    /// False if the file is not text from some place on.
    pub(super) is_text: bool,
    pub(super) checked: Checked,
}

impl Loaded {
    /// Reads and checks a file; `length` is the number of bytes, if known. A large one is read block
    /// by block, if its text is not to be kept.
    pub(super) fn from_content(
        content: Content,
        length: Option<u64>,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> io::Result<Self> {
        let found = match &content {
            Content::File(file) if !options.keeps_text() => watch.time(Stage::Check, || {
                CheckedModel::in_file(file, length, syntax, options, watch)
            })?,
            _ => None,
        };
        let text = match &found {
            Some(found) if found.problems.is_empty() => FileText::default(),
            _ => {
                let expected = length.map_or(0, |length| usize::try_from(length).unwrap_or(0));
                watch.time(Stage::Read, || {
                    files::read_from(options.until_cancelled(content), expected)
                })?
            }
        };
        Ok(Self::from_text(text, found, syntax, options, watch))
    }

    /// Checks a text; `found` holds the results of an earlier read of the file, if any.
    pub(super) fn from_text(
        FileText { text, fault }: FileText,
        found: Option<CheckedModel>,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> Self {
        let source = Source::new(text, syntax);
        let is_text = fault.is_none();
        let checked = match fault {
            Some(fault) => Checked::refused(vec![fault]),
            None => watch.time(Stage::Check, || check(&source, found, options, watch)),
        };
        Self {
            source,
            is_text,
            checked,
        }
    }
}
