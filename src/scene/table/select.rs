//! Choice of the columns that are read, by their names.

use std::{collections::HashSet, sync::Arc};

use crate::{
    scene::table::{
        Fault, Request, VALUE,
        layout::{COLORS, Columns},
    },
    text::nearest::quote,
};

/// The names of a format for its columns, and for what it calls them.
pub(super) struct Known {
    /// The names of x, y, z, radius, red, green and blue.
    pub(super) columns: [&'static str; VALUE],
    /// The name of a column with all of a color.
    pub(super) hex: Option<&'static str>,
    /// The word for columns.
    pub(super) columns_word: &'static str,
    /// The start of the message about a missing column.
    pub(super) missing: &'static str,
}

/// The columns of CSV files and of numpy arrays.
pub(super) const COLUMNS: Known = Known {
    columns: ["x", "y", "z", "radius", "r", "g", "b"],
    hex: None,
    columns_word: "columns",
    missing: "there is no column",
};

/// The names of a table's columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Names {
    /// All columns with numbers.
    pub(crate) all: Arc<[String]>,
    /// Those that set nothing.
    pub(crate) unused: Arc<[String]>,
}

/// The columns that are read.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    /// The index of each among all columns.
    pub(super) places: Columns<Option<usize>>,
    /// True if the three channels are one column of text.
    pub(super) is_hex: bool,
    pub(super) names: Names,
}

impl Selection {
    /// Chooses among the columns with these names.
    pub(super) fn new(names: &[&str], known: &Known, request: &Request) -> Result<Self, Fault> {
        let place = |name: &str| names.iter().position(|other| *other == name);
        let mut seen = HashSet::new();
        let is_read =
            |name: &str| known.is_known(name) || request.value.is_some_and(|value| value == name);
        if let Some(name) = names
            .iter()
            .find(|name| !seen.insert(**name) && is_read(name))
        {
            let message = format!("the column {} is given twice", quote(name));
            return Err(Fault::new(message).help("remove one of the two"));
        }
        let [x, y, z, radius, red, green, blue] = known.columns;
        let [hex, r, g, b] =
            [known.hex.unwrap_or_default(), red, green, blue].map(|name| match request.value {
                None => place(name),
                // The values have the colors.
                Some(_) => None,
            });
        let is_hex = hex.is_some();
        let [r, g, b] = match (hex, [r, g, b]) {
            (None, channels @ ([None, None, None] | [Some(_), Some(_), Some(_)])) => channels,
            (Some(_), [None, None, None]) => [hex; COLORS.end - COLORS.start],
            (None, _) => {
                let columns = known.columns_word;
                let message =
                    format!("of the {columns} `{red}`, `{green}` and `{blue}` only some are given");
                return Err(Fault::new(message).help("give all three, or none"));
            }
            (Some(_), _) => {
                let message = "the color is given twice, as `color` and as `r`, `g` and `b`";
                return Err(Fault::new(message).help("remove one of the two"));
            }
        };
        let needed = |name| {
            let missing = || Fault::new(format!("{} {}", known.missing, quote(name)));
            place(name).ok_or_else(missing)
        };
        let (x, y, z) = (needed(x)?, needed(y)?, needed(z)?);
        let value = request.value.and_then(place);
        let places = [Some(x), Some(y), Some(z), place(radius), r, g, b, value];
        let is_unused =
            |(index, name): &(usize, &&str)| !places.contains(&Some(*index)) && !is_skipped(name);
        let unused = names.iter().enumerate().filter(is_unused);
        let named = names.iter().filter(|name| !is_skipped(name));
        Ok(Self {
            places,
            is_hex,
            names: Names {
                all: named.map(|name| (*name).to_owned()).collect(),
                unused: unused.map(|(_, name)| (*name).to_owned()).collect(),
            },
        })
    }

    /// Returns which columns there are.
    pub(super) fn has(&self) -> Columns<bool> {
        self.places.map(|place| place.is_some())
    }
}

impl Known {
    fn is_known(&self, name: &str) -> bool {
        self.columns.contains(&name) || self.hex == Some(name)
    }

    /// Returns all names.
    pub(super) fn all(&self) -> Vec<&'static str> {
        self.columns.iter().copied().chain(self.hex).collect()
    }
}

/// Returns true if a name stands for a column to skip.
fn is_skipped(name: &str) -> bool {
    name.starts_with('_')
}
