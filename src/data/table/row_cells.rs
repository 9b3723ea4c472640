//! The cells of one row of a file as text: those of all columns, unlike in a [`Table`](super::Table).

use crate::text::sanitize::sanitize;

/// The number of cells that are shown.
pub(super) const MOST_CELLS: usize = 20;

/// The number of letters of a cell, or of the name of a column, that are shown.
const LONGEST: usize = 40;

/// The first cells of a row of a table, as text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RowCells {
    /// The name of each column and the text of its cell, both shortened and without control characters.
    pub shown: Vec<(String, String)>,
    /// The number of further columns.
    pub more: usize,
    /// True for the cells of the file, false for the numbers that the scene has from them.
    pub is_from_file: bool,
}

impl RowCells {
    /// Creates the cells of a file with this many columns from the first ones.
    pub(super) fn new<N: AsRef<str>, T: AsRef<str>>(
        count: usize,
        cells: impl Iterator<Item = (N, T)>,
    ) -> Self {
        let cells = cells.take(MOST_CELLS);
        let shown: Vec<_> = cells
            .map(|(name, text)| (short(name.as_ref()), short(text.as_ref())))
            .collect();
        Self {
            more: count.saturating_sub(shown.len()),
            shown,
            is_from_file: true,
        }
    }

    /// Creates the cells of the numbers that a scene has.
    pub(crate) fn of_scene<'a>(numbers: impl Iterator<Item = (&'a str, f64)>) -> Self {
        let numbers: Vec<_> = numbers
            .map(|(name, number)| (name, format!("{number:?}")))
            .collect();
        Self {
            is_from_file: false,
            ..Self::new(numbers.len(), numbers.into_iter())
        }
    }
}

fn short(text: &str) -> String {
    let mut letters = text.chars();
    let mut short: String = letters.by_ref().take(LONGEST).collect();
    if letters.next().is_some() {
        short.push('…');
    }
    sanitize(&short).into_owned()
}
