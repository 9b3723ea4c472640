//! The text of an open document, and places in it as the client counts them.

use std::{ops::Range, sync::Arc};

use lsp_types::{Position, TextDocumentContentChangeEvent, TextEdit};
use strahl::{
    Syntax,
    scene::{Elements, Excerpt, Source},
    text::{self, Columns, Edit, LineStarts, Lines},
};

/// A text that is edited. Clones share it.
#[derive(Clone)]
pub(super) struct Text {
    source: Arc<Source>,
    starts: Arc<LineStarts>,
    /// The elements of a long text, which help at a place leaves out.
    elements: Arc<Elements>,
    /// The number of bytes beside the elements when they were found.
    beside: usize,
}

/// The number of bytes from which on a text is long.
const LONG: usize = 1 << 20;

impl Text {
    pub(super) fn new(text: String, syntax: Syntax) -> Self {
        let mut new = Self {
            starts: LineStarts::new(&text).into(),
            source: Source::new(text, syntax).into(),
            elements: Arc::default(),
            beside: 0,
        };
        new.find_elements();
        new
    }

    /// Finds the elements of a long text.
    fn find_elements(&mut self) {
        self.elements = match self.as_str().len() {
            0..LONG => Arc::default(),
            _ => Elements::new(&self.source).into(),
        };
        self.beside = self.as_str().len() - self.elements.bytes();
    }

    /// Returns what help at a place needs of the text.
    pub(super) fn around(&self, offset: usize) -> Excerpt<'_> {
        self.elements
            .around(self.as_str(), self.source.syntax(), offset)
    }

    /// Returns the text with its tree, which is built on first use.
    pub(super) fn source(&self) -> &Source {
        self.elements.give_tree(&self.source);
        &self.source
    }

    pub(super) fn syntax(&self) -> Syntax {
        self.source.syntax()
    }

    /// Returns true unless the text is surely not a scene.
    pub(super) fn may_be_scene(&self) -> bool {
        // The elements of a long text were those of a scene.
        self.elements.bytes() > 0 || self.source.may_be_scene()
    }

    pub(super) fn as_str(&self) -> &str {
        self.source.text()
    }

    pub(super) fn places(&self, columns: Columns) -> Places<'_> {
        Places {
            lines: self.starts.lines(self.as_str()),
            columns,
        }
    }

    /// Returns true if the text without its elements is much shorter.
    pub(super) fn has_excerpts(&self) -> bool {
        let beside = self.as_str().len() - self.elements.bytes();
        self.elements.bytes() > 0 && beside <= LONG
    }

    /// Applies changes, each to the result of the one before. Returns the replaced ranges, each
    /// with the number of bytes that replaced it; `None` if all of the text is new.
    pub(super) fn change(
        &mut self,
        changes: Vec<TextDocumentContentChangeEvent>,
        columns: Columns,
    ) -> Option<Vec<Replaced>> {
        let mut replaced = Some(Vec::new());
        let syntax = self.source.syntax();
        let empty = Arc::new(Source::new("", syntax));
        let source = std::mem::replace(&mut self.source, empty);
        // Only if a request still reads the text, it is copied.
        let mut text = match Arc::try_unwrap(source) {
            Ok(source) => source.into_text(),
            Err(shared) => shared.text().to_owned(),
        };
        for change in changes {
            let Some(range) = change.range else {
                *self = Self::new(change.text, syntax);
                text = self.as_str().to_owned();
                replaced = None;
                continue;
            };
            let places = Places {
                lines: self.starts.lines(&text),
                columns,
            };
            let range = places.offsets(range);
            text.replace_range(range.clone(), &change.text);
            Arc::make_mut(&mut self.starts).replace(range.clone(), &text, change.text.len());
            Arc::make_mut(&mut self.elements).replace(range.clone(), change.text.len());
            let inserted = change.text.len();
            replaced.iter_mut().for_each(|all| {
                all.push(Replaced {
                    range: range.clone(),
                    inserted,
                })
            });
        }
        self.source = Source::new(text, syntax).into();
        // After large insertions, their elements are found as well.
        if self.as_str().len() - self.elements.bytes() > self.beside + LONG {
            self.find_elements();
        }
        replaced
    }
}

/// A range of a text that was replaced.
#[derive(Clone, Debug)]
pub(super) struct Replaced {
    range: Range<usize>,
    /// The number of bytes that are there now.
    inserted: usize,
}

impl Replaced {
    /// Returns the offset behind what is new.
    pub(super) const fn end(&self) -> usize {
        self.range.start + self.inserted
    }

    /// Returns the range of a part of the text after the replacement.
    pub(super) fn moved(&self, part: &Range<usize>) -> Range<usize> {
        let Self { range, .. } = self;
        let start = match part.start {
            start if start < range.start => start,
            start if start >= range.end => start - range.end + self.end(),
            _ => range.start,
        };
        let end = match part.end {
            end if end <= range.start => end,
            end if end >= range.end => end - range.end + self.end(),
            _ => self.end(),
        };
        start..end.max(start)
    }
}

/// Converts places in a text.
pub(super) struct Places<'a> {
    lines: Lines<'a>,
    columns: Columns,
}

impl<'a> Places<'a> {
    pub(super) fn new(text: &'a str, starts: &'a LineStarts, columns: Columns) -> Self {
        let lines = starts.lines(text);
        Self { lines, columns }
    }

    /// Creates the places of a text that follows `before` lines.
    pub(super) fn after(before: usize, text: &'a str, columns: Columns) -> Self {
        let lines = Lines::after(before, text);
        Self { lines, columns }
    }

    pub(super) fn position(&self, offset: usize) -> Position {
        let place = self.lines.position_in(offset, self.columns);
        let [line, character] =
            [place.line, place.column].map(|count| u32::try_from(count - 1).unwrap_or(u32::MAX));
        Position { line, character }
    }

    pub(super) fn range(&self, range: &Range<usize>) -> lsp_types::Range {
        lsp_types::Range::new(self.position(range.start), self.position(range.end))
    }

    /// Returns an offset; positions outside of the text become the nearest one in it.
    pub(super) fn offset(&self, position: Position) -> usize {
        let place = text::Position {
            line: position.line as usize + 1,
            column: position.character as usize + 1,
        };
        self.lines.offset(place, self.columns)
    }

    pub(super) fn offsets(&self, range: lsp_types::Range) -> Range<usize> {
        let [start, end] = [range.start, range.end].map(|position| self.offset(position));
        start.min(end)..start.max(end)
    }

    pub(super) fn edit(&self, edit: Edit) -> TextEdit {
        TextEdit::new(self.range(&edit.range), edit.text)
    }
}
