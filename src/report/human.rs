//! Human-readable output: the affected lines, with the places underlined.
//!
//! `annotate-snippets` draws. It gets only the few lines around a place, already cut to the width:
//! it would search the whole text for every diagnostic, its own cutting is off for wide characters,
//! and it counts columns only in the text it gets.

use std::io::{self, Write};

use annotate_snippets::{
    AnnotationKind, Group, Level, Renderer, Snippet,
    renderer::{DEFAULT_LINE_NUM_STYLE, DecorStyle},
};

use super::excerpt::width;
use crate::{
    diagnostic::{Code, Diagnostic, Severity},
    report::{
        file::{FileReport, UsedBy},
        reporter::{Report, Style},
        summary::Summary,
    },
    text::{lines::Lines, sanitize::sanitize},
};

mod drawing;

use drawing::{Drawing, Mark};

/// The supported widths: a narrower one is useless, a wider one only costs time.
const WIDTHS: std::ops::RangeInclusive<usize> = 40..=10_000;

pub(super) struct Human<W> {
    out: W,
    style: Style,
}

impl<W: Write> Human<W> {
    pub(super) fn new(out: W, style: Style) -> Self {
        let width = style.width.clamp(*WIDTHS.start(), *WIDTHS.end());
        Self {
            out,
            style: Style { width, ..style },
        }
    }
}

impl<W: Write> Report for Human<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let file = match report.option {
            Some(option) => format!("{}: {option}", report.file),
            None => report.file.to_owned(),
        };
        let source = Source {
            file: &sanitize(&file),
            text: report.text,
            lines: report.lines(),
            used_by: report.used_by,
            style: self.style,
        };
        for diagnostic in report.diagnostics {
            writeln!(self.out, "{}\n", source.rendered(diagnostic))?;
        }
        if !report.suppressed.is_empty() {
            writeln!(self.out, "{}\n", report.suppressed)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.out.flush()
    }
}

/// The file of the diagnostics, and the way to show it.
struct Source<'a> {
    file: &'a str,
    text: &'a str,
    lines: Lines<'a>,
    used_by: Option<UsedBy<'a>>,
    style: Style,
}

impl Source<'_> {
    fn rendered(&self, diagnostic: &Diagnostic) -> String {
        let level = match diagnostic.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let message = sanitize(&diagnostic.message);
        let title = level.primary_title(&*message).id(diagnostic.code.name());
        let mut group = Group::with_title(title);

        let primary = Mark::new(self.text, &self.lines, &diagnostic.range, None);
        let labels = diagnostic.labels.iter().map(|label| {
            Mark::new(
                self.text,
                &self.lines,
                &label.range,
                Some(sanitize(&label.message)),
            )
        });
        let (near, mut apart): (Vec<_>, Vec<_>) = labels.partition(|mark| mark.is_near(&primary));
        let drawing = self.drawing(primary, near, &mut apart);
        let digits = drawing.as_ref().map_or(0, Drawing::digits);
        if let Some(drawing) = &drawing {
            group = group.element(snippet(drawing));
            if drawing.cut && !diagnostic.path.steps().is_empty() {
                // Too little of the line is left to show its place in the scene.
                let path = format!("this is `{}`", sanitize(&diagnostic.path.to_string()));
                group = group.element(Level::NOTE.message(path));
            }
        }
        if let Some(used_by) = self.used_by {
            group = group.element(Level::NOTE.message(used_by.to_string()));
        }
        if let Some(help) = &diagnostic.help {
            let room = self.style.width.saturating_sub(digits + " = help: ".len());
            group = group.element(Level::HELP.message(wrapped(&sanitize(help), room)));
        }

        let start = self.lines.position(diagnostic.range.start);
        let place = if diagnostic.code == Code::Unreadable {
            self.file.to_owned()
        } else {
            format!("{}:{}:{}", self.file, start.line, start.column)
        };
        let mut text = self.draw(group, digits, &place);
        for mark in apart {
            text.push('\n');
            text.push_str(&self.note(mark));
        }
        text
    }

    /// Draws the marks together. Labels without room are drawn separately.
    fn drawing<'m>(
        &self,
        primary: Mark<'m>,
        near: Vec<Mark<'m>>,
        apart: &mut Vec<Mark<'m>>,
    ) -> Option<Drawing<'m>> {
        if self.text.is_empty() {
            return None;
        }
        let mut marks = vec![primary];
        marks.extend(near);
        loop {
            match Drawing::new(&self.lines, marks, self.style.width) {
                Ok(drawing) => return Some(drawing),
                Err((rest, without_room)) => {
                    apart.push(without_room?);
                    marks = rest;
                }
            }
        }
    }

    /// Returns the separate drawing of a label that is too far away or too long for the first one.
    fn note(&self, mut mark: Mark<'_>) -> String {
        let label = mark.label.take().unwrap_or_default();
        let place = format!("{}:{}:{}", self.file, mark.from.line, self.column(&mark));
        let mut group = Group::with_title(Level::NOTE.secondary_title(&*label));
        let drawing = self.drawing(mark, Vec::new(), &mut Vec::new());
        if let Some(drawing) = &drawing {
            group = group.element(snippet(drawing));
        }
        self.draw(group, drawing.as_ref().map_or(0, Drawing::digits), &place)
    }

    fn column(&self, mark: &Mark<'_>) -> usize {
        let before = self.lines.text(mark.from.line).get(..mark.from.at);
        before.map_or(0, |text| text.chars().count()) + 1
    }

    /// Returns the drawn group, with an arrow to the place below its title. The crate would show
    /// the column in the excerpt, not in the file.
    fn draw(&self, group: Group<'_>, digits: usize, place: &str) -> String {
        let renderer = if self.style.color {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        // Everything fits already: the crate must not cut again.
        let renderer = renderer
            .decor_style(DecorStyle::Ascii)
            .term_width(2 * WIDTHS.end());
        let drawn = renderer.render(&[group]);
        let (title, rest) = drawn.split_once('\n').unwrap_or((&drawn, ""));
        let arrow = if self.style.color {
            let style = DEFAULT_LINE_NUM_STYLE;
            format!("{style}-->{style:#}")
        } else {
            "-->".to_owned()
        };
        let gutter = " ".repeat(digits);
        let rest = if rest.is_empty() {
            String::new()
        } else {
            format!("\n{rest}")
        };
        format!("{title}\n{gutter}{arrow} {place}{rest}")
    }
}

fn snippet<'a>(drawing: &'a Drawing<'_>) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let first = drawing.spans.first();
    let annotations = drawing
        .spans
        .iter()
        .zip(&drawing.marks)
        .map(|(span, mark)| {
            // A label at the same place as the diagnostic would be drawn over it.
            let kind = if first == Some(span) {
                AnnotationKind::Primary
            } else {
                AnnotationKind::Context
            };
            kind.span(span.clone()).label(mark.label.as_deref())
        });
    Snippet::source(&drawing.source)
        .line_start(drawing.first)
        .annotations(annotations)
}

/// Wraps a text to lines of `room` columns. A longer word stays whole, so that it can be copied.
fn wrapped(text: &str, room: usize) -> String {
    let mut lines = String::new();
    let mut used = 0;
    for word in text.split(' ') {
        let needed = width(word);
        if used > 0 && used + 1 + needed > room {
            lines.push('\n');
            used = 0;
        } else if !lines.is_empty() {
            lines.push(' ');
            used += 1;
        }
        lines.push_str(word);
        used += needed;
    }
    lines
}
