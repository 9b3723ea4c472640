//! The lines in which two texts differ.

use std::{
    io::{self, Write},
    iter, mem,
    ops::Range,
};

use imara_diff::{Algorithm, Diff, InternedInput};

/// How many equal lines a unified diff shows before and after each change.
const CONTEXT: usize = 3;

/// Two texts, compared line by line.
pub(super) struct LineDiff<'a> {
    /// The lines with their ends.
    pub(super) old: Vec<&'a str>,
    pub(super) new: Vec<&'a str>,
    /// From top to bottom, with equal lines between them.
    pub(super) changes: Vec<Change>,
}

/// Lines of the old text, and those of the new text in their place.
#[derive(Clone)]
pub(super) struct Change {
    pub(super) old: Range<usize>,
    pub(super) new: Range<usize>,
}

/// The text that has a line.
pub(super) enum Side {
    Old,
    New,
    Both,
}

impl<'a> LineDiff<'a> {
    pub(super) fn new(old: &'a str, new: &'a str) -> Self {
        Self::near(old, new, 0..old.len())
    }

    /// Like [`new`](Self::new), with only the changes that touch a range of bytes of the old text, and with as few lines
    /// as possible there.
    pub(super) fn near(old: &'a str, new: &'a str, range: Range<usize>) -> Self {
        let lines = |text: &'a str| text.split_inclusive('\n').collect();
        let (old, new): (Vec<_>, Vec<_>) = (lines(old), lines(new));
        let before = |end| starts(&old).take_while(|start| *start < end).count();
        let (first, end) = (before(range.start), before(range.end + 1));
        let is_near = |lines: &Range<usize>| lines.start < end && first <= lines.end;
        let changes = parts(&old, &new, is_near).unwrap_or_else(|| {
            let mut changes = changes(&old, &new);
            changes.retain(|change| is_near(&change.old));
            changes
        });
        Self { old, new, changes }
    }

    /// Returns the lines of both texts, from top to bottom.
    #[cfg(feature = "preview")]
    pub(super) fn lines(&self) -> impl Iterator<Item = (Side, &'a str)> {
        self.part(0..self.old.len(), &self.changes)
    }

    /// Writes the changes in the format of `patch`.
    pub(super) fn write_unified(&self, name: &str, mut to: impl Write) -> io::Result<()> {
        writeln!(to, "--- {name}\n+++ {name}")?;
        let is_near = |one: &Change, next: &Change| next.old.start - one.old.end <= 2 * CONTEXT;
        for near in self.changes.chunk_by(is_near) {
            let ([first, ..], [.., last]) = (near, near) else {
                continue;
            };
            let before = first.old.start.min(CONTEXT);
            let after = (self.old.len() - last.old.end).min(CONTEXT);
            let old = first.old.start - before..last.old.end + after;
            let new = first.new.start - before..last.new.end + after;
            writeln!(to, "@@ -{} +{} @@", place(&old), place(&new))?;
            for (side, line) in self.part(old, near) {
                let mark = match side {
                    Side::Old => '-',
                    Side::New => '+',
                    Side::Both => ' ',
                };
                write!(to, "{mark}{line}")?;
                if !line.ends_with('\n') {
                    writeln!(to, "\n\\ No newline at end of file")?;
                }
            }
        }
        Ok(())
    }

    /// Returns lines of the old text, with `changes`, which are all in these lines.
    fn part(&self, old: Range<usize>, changes: &[Change]) -> impl Iterator<Item = (Side, &'a str)> {
        let mut kept_from = old.start;
        let end = Change {
            old: old.end..old.end,
            new: 0..0,
        };
        changes
            .iter()
            .cloned()
            .chain([end])
            .flat_map(move |Change { old, new }| {
                let kept = mem::replace(&mut kept_from, old.end)..old.start;
                let kept = self.old[kept].iter().map(|line| (Side::Both, *line));
                let old = self.old[old].iter().map(|line| (Side::Old, *line));
                let new = self.new[new].iter().map(|line| (Side::New, *line));
                kept.chain(old).chain(new)
            })
    }
}

/// Returns the offset of each line, and the end of the last.
pub(super) fn starts(lines: &[&str]) -> impl Iterator<Item = usize> {
    let ends = lines.iter().scan(0, |at, line| {
        *at += line.len();
        Some(*at)
    });
    iter::once(0).chain(ends)
}

/// Returns the changes between lines that only differ in blanks, commas and line breaks, as those
/// before and after a formatter do: a part ends where both have the same other letters, and parts
/// without equal lines between them are one change. Of the parts, only those that are near are kept. `None`
/// if the texts differ in more. Unlike a diff of any lines, it takes linear time and hardly any memory.
fn parts(
    old: &[&str],
    new: &[&str],
    is_near: impl Fn(&Range<usize>) -> bool,
) -> Option<Vec<Change>> {
    let mut parts: Vec<Change> = Vec::new();
    let (mut from, mut to, mut next) = (0, 0, 0);
    while from < old.len() || to < new.len() {
        if old.get(from) == new.get(to) {
            (from, to) = (from + 1, to + 1);
            continue;
        }
        let (first_old, first_new) = (from, to);
        // The letters of the old lines that are not among the new ones yet.
        let mut ahead = 0_isize;
        loop {
            if ahead <= 0 && from < old.len() {
                ahead += letters(&old[from..=from]).count() as isize;
                from += 1;
            } else {
                ahead -= letters(new.get(to..=to)?).count() as isize;
                to += 1;
            }
            // A comma that follows on another line belongs to the item before it.
            next = next.max(from);
            while old.get(next).is_some_and(|line| is_between(line)) {
                next += 1;
            }
            let is_item = !old
                .get(next)
                .is_some_and(|line| line.trim_start().starts_with(','));
            if ahead == 0 && is_item {
                break;
            }
        }
        let (old_lines, new_lines) = (first_old..from, first_new..to);
        if !letters(&old[old_lines.clone()]).eq(letters(&new[new_lines.clone()])) {
            return None;
        }
        if !is_near(&old_lines) {
            continue;
        }
        match parts.last_mut() {
            Some(last) if last.old.end == first_old && last.new.end == first_new => {
                (last.old.end, last.new.end) = (from, to);
            }
            _ => parts.push(Change {
                old: old_lines,
                new: new_lines,
            }),
        }
    }
    Some(parts)
}

/// Returns true for a line that is blank or a comment.
fn is_between(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with("//") || line.starts_with("/*") && line.ends_with("*/")
}

/// Returns the letters of lines that a formatter keeps.
fn letters(lines: &[&str]) -> impl Iterator<Item = u8> {
    let letters = lines.iter().flat_map(|line| line.bytes());
    letters.filter(|letter| !letter.is_ascii_whitespace() && *letter != b',')
}

fn changes(old: &[&str], new: &[&str]) -> Vec<Change> {
    // The crate counts lines in 31 bits.
    if old.len().max(new.len()) >= i32::MAX as usize {
        return vec![Change {
            old: 0..old.len(),
            new: 0..new.len(),
        }];
    }
    let mut input = InternedInput::default();
    // A long line is hashed once, not each time that the table grows.
    input.reserve(old.len() as u32, new.len() as u32);
    input.update_before(old.iter().copied());
    input.update_after(new.iter().copied());
    // The histogram's time grows with the square of the number of changes.
    let mut diff = Diff::compute(Algorithm::Myers, &input);
    diff.postprocess_lines(&input);
    let lines = |range: Range<u32>| range.start as usize..range.end as usize;
    let changes = diff.hunks().map(|hunk| Change {
        old: lines(hunk.before),
        new: lines(hunk.after),
    });
    changes.collect()
}

/// Returns the place of lines as the head of a change has it.
fn place(lines: &Range<usize>) -> String {
    match lines.len() {
        0 => format!("{},0", lines.start),
        1 => (lines.start + 1).to_string(),
        count => format!("{},{count}", lines.start + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unified(old: &str, new: &str) -> String {
        let mut text = Vec::new();
        LineDiff::new(old, new)
            .write_unified("a", &mut text)
            .unwrap();
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn changes_far_from_each_other_have_heads() {
        let old: String = (1..=20).map(|line| format!("{line}\n")).collect();
        let new = old.replace("\n5\n", "\n").replace("19\n", "x\n19\n");
        let new = format!("0\n{new}");
        let expected = "--- a\n+++ a\n@@ -1,8 +1,8 @@\n+0\n 1\n 2\n 3\n 4\n-5\n 6\n 7\n 8\n\
             @@ -16,5 +16,6 @@\n 16\n 17\n 18\n+x\n 19\n 20\n";
        assert_eq!(unified(&old, &new), expected);
    }

    #[test]
    fn a_last_line_without_an_end_is_marked() {
        assert_eq!(
            unified("a\nb", "a\nb\n"),
            "--- a\n+++ a\n@@ -1,2 +1,2 @@\n a\n-b\n\\ No newline at end of file\n+b\n",
        );
        assert_eq!(
            unified("", "b"),
            "--- a\n+++ a\n@@ -0,0 +1 @@\n+b\n\\ No newline at end of file\n",
        );
    }

    #[test]
    fn the_changes_lead_from_one_text_to_the_other() {
        let mut texts = vec![String::new()];
        for text in 0..121 {
            for line in ["a\n", "b\n", "\n"] {
                texts.push(format!("{}{line}", texts[text]));
            }
        }
        for old in &texts {
            for new in &texts {
                let diff = LineDiff::new(old, new);
                let (mut from, mut to) = (String::new(), String::new());
                for (side, line) in diff.lines() {
                    if !matches!(side, Side::New) {
                        from += line;
                    }
                    if !matches!(side, Side::Old) {
                        to += line;
                    }
                }
                assert_eq!((&from, &to), (old, new));
            }
        }
    }
}
