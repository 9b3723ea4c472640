//! A line of a scene, cut so that its relevant places fit into a terminal.
//!
//! A line may be a megabyte long, with two places far apart. So each place keeps its surroundings,
//! and `…` replaces the text in between; nothing else of the line is read.

use unicode_width::UnicodeWidthChar;

use crate::text::sanitize::shown;

/// The minimum number of columns kept on either side of a place: fewer would not show its context.
const LEAST_CONTEXT: usize = 3;

const TAB: &str = "    ";

/// The visible part of a line.
pub(super) struct Excerpt {
    pub(super) text: String,
    /// The byte offset of each point in `text`.
    pub(super) points: Vec<usize>,
    /// True if anything is left out.
    pub(super) cut: bool,
    /// Number of columns before each point.
    columns: Vec<usize>,
    width: usize,
}

/// Space for a text after a point: the index of the point and the number of columns.
pub(super) type Tail = (usize, usize);

/// Returns as much of `line` as fits into `room` columns, with all `points` (byte offsets at
/// character boundaries) and with room for every tail; `None` if even the minimum is too wide.
pub(super) fn fit(line: &str, points: &[usize], tails: &[Tail], room: usize) -> Option<Excerpt> {
    let fits = |excerpt: &Excerpt| {
        let tails_fit = tails.iter().all(|(point, width)| {
            let column = excerpt.columns.get(*point).copied().unwrap_or(0);
            column + width <= room
        });
        excerpt.width <= room && tails_fit
    };
    // Every character takes at least a byte, and those without width are rare.
    if line.len() <= room.saturating_mul(4) {
        let whole = Excerpt::new(line, points, &[(0, line.len())]);
        if fits(&whole) {
            return Some(whole);
        }
    }
    let with_context = |context| {
        let excerpt = Excerpt::new(line, points, &windows(line, points, context));
        fits(&excerpt).then_some(excerpt)
    };
    let mut best = with_context(LEAST_CONTEXT)?;
    let (mut fitting, mut too_wide) = (LEAST_CONTEXT, room.max(LEAST_CONTEXT + 1));
    while too_wide - fitting > 1 {
        let middle = fitting.midpoint(too_wide);
        match with_context(middle) {
            Some(excerpt) => (best, fitting) = (excerpt, middle),
            None => too_wide = middle,
        }
    }
    Some(best)
}

/// Returns the parts of the line within `context` columns of a point, in order, none touching
/// another.
fn windows(line: &str, points: &[usize], context: usize) -> Vec<(usize, usize)> {
    let mut sorted: Vec<usize> = if points.is_empty() {
        vec![0]
    } else {
        points.to_vec()
    };
    sorted.sort_unstable();
    let mut windows: Vec<(usize, usize)> = Vec::new();
    for point in sorted {
        let (before, after) = line.split_at_checked(point).unwrap_or((line, ""));
        let start = point - reach(before.chars().rev(), context);
        let end = point + reach(after.chars(), context);
        match windows.last_mut() {
            Some((_, last)) if is_short(line.get(*last..start)) => *last = end.max(*last),
            _ => windows.push((start, end)),
        }
    }
    windows
}

/// Returns true if a gap is too short for an ellipsis. Overlapping windows have no gap.
fn is_short(gap: Option<&str>) -> bool {
    gap.is_none_or(|gap| gap.chars().nth(1).is_none())
}

/// Returns the number of bytes of the characters that fit into `room` columns.
fn reach(characters: impl Iterator<Item = char>, room: usize) -> usize {
    let mut width = 0;
    characters
        .take_while(|character| {
            width += columns(*character);
            width <= room
        })
        .map(char::len_utf8)
        .sum()
}

impl Excerpt {
    fn new(line: &str, points: &[usize], windows: &[(usize, usize)]) -> Self {
        let mut excerpt = Self {
            text: String::new(),
            points: vec![0; points.len()],
            cut: false,
            columns: vec![0; points.len()],
            width: 0,
        };
        let mut shown_to = 0;
        for (start, end) in windows.iter().copied() {
            if start > shown_to {
                excerpt.elide();
            }
            for (at, character) in line.get(start..end).unwrap_or("").char_indices() {
                excerpt.note(points, start + at);
                excerpt.push(character);
            }
            excerpt.note(points, end);
            shown_to = end;
        }
        if shown_to < line.len() {
            excerpt.elide();
        }
        excerpt
    }

    fn elide(&mut self) {
        self.cut = true;
        self.push('…');
    }

    fn note(&mut self, points: &[usize], at: usize) {
        let here = (self.text.len(), self.width);
        let slots = self.points.iter_mut().zip(&mut self.columns);
        for (_, slot) in points.iter().zip(slots).filter(|(point, _)| **point == at) {
            (*slot.0, *slot.1) = here;
        }
    }

    fn push(&mut self, character: char) {
        self.width += columns(character);
        match character {
            '\t' => self.text.push_str(TAB),
            // Some terminals, but not all, would join its neighbors into one picture, and the marks
            // below would be misaligned.
            '\u{200d}' => {}
            // A wide space looks like two narrow ones, and narrow ones can be counted.
            space if space.is_whitespace() && shown(space) == space => {
                self.text.extend(std::iter::repeat_n(' ', columns(space)));
            }
            other => self.text.push(shown(other)),
        }
    }
}

/// Returns the number of columns that a character takes when shown.
fn columns(character: char) -> usize {
    match character {
        '\t' => TAB.len(),
        '\u{200d}' => 0,
        other => shown(other).width().unwrap_or(1),
    }
}

/// Returns the number of columns that a text takes.
pub(super) fn width(text: &str) -> usize {
    text.chars().map(columns).sum()
}

/// Returns true if a text takes no columns; stops at the first character that does.
pub(super) fn has_no_width(text: &str) -> bool {
    text.chars().all(|character| columns(character) == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(line: &str, points: &[usize], room: usize) -> String {
        let excerpt = fit(line, points, &[], room).unwrap();
        assert!(width(&excerpt.text) <= room, "{}", excerpt.text);
        excerpt.text
    }

    #[test]
    fn a_short_line_is_not_cut() {
        assert_eq!(text("radius: 1,", &[8, 9], 10), "radius: 1,");
        assert_eq!(text("\tx\u{3000}y\u{1b}\r", &[1], 20), "    x  y␛␍");
        assert_eq!(text("", &[0, 0], 20), "");
    }

    #[test]
    fn a_long_line_is_cut_around_its_points() {
        let line = "0123456789abcdefghijklmnopqrstuvwxyz";
        assert_eq!(text(line, &[18, 19], 13), "…defghijklmn…");
        assert_eq!(text(line, &[0], 13), "0123456789ab…");
        assert_eq!(text(line, &[36], 13), "…opqrstuvwxyz");
        assert_eq!(text(line, &[4, 32], 20), "012345678…rstuvwxyz");
        assert_eq!(text(line, &[], 5), "0123…");
    }

    #[test]
    fn wide_characters_take_two_columns() {
        let line = "日本日本日本日本日本x日本日本日本日本日本";
        let excerpt = fit(line, &[30, 31], &[], 15).unwrap();
        assert_eq!(excerpt.text, "…本日本x日本日…");
        assert_eq!(excerpt.points, [12, 13]);
        assert_eq!(excerpt.columns, [7, 8]);
    }

    #[test]
    fn a_tail_moves_the_view() {
        let line = "0123456789abcdefghij";
        let excerpt = fit(line, &[18, 19], &[(1, 6)], 20).unwrap();
        assert!(excerpt.columns[1] + 6 <= 20, "{}", excerpt.text);
        assert!(excerpt.cut);
        assert!(fit(line, &[18, 19], &[(1, 18)], 20).is_none());
    }
}
