//! Choice of the columns that are read, by their names.

use std::{collections::HashSet, sync::Arc};

use crate::{
    data::{
        fault::Fault,
        table::{
            kind::RowKind,
            layout::{COLORS, Columns, OTHER_END, RADIUS, VALUE},
            request::Request,
        },
    },
    text::nearest::quote,
};

/// The names of a format for its columns, and for what it calls them.
pub(crate) struct Known {
    /// The names of all columns but the value.
    pub(crate) columns: ColumnNames,
    /// The name of a column with all of a color.
    pub(crate) hex: Option<&'static str>,
    /// The word for columns.
    pub(crate) columns_word: &'static str,
    /// The start of the message about a missing column.
    pub(crate) missing: &'static str,
    /// The axis and the angle of copies.
    pub(crate) rotation: &'static [&'static str],
}

/// The columns of the axis and the angle of copies.
const ROTATION: [&str; 4] = ["axis_x", "axis_y", "axis_z", ANGLE];

/// The column of the angle of copies, in degrees.
const ANGLE: &str = "angle";

/// The names of the columns, without the value; `None` for one that no such table has.
pub(crate) type ColumnNames = [Option<&'static str>; VALUE];

impl Known {
    /// The columns of a numpy array whose rows stand for these shapes.
    pub(crate) const fn of_array(kind: RowKind) -> Self {
        Self {
            columns: columns(kind),
            hex: None,
            columns_word: "columns",
            missing: "there is no column",
            rotation: rotation_of(kind),
        }
    }

    /// The columns of a CSV file: one may have `#rrggbb` or `#rgb`.
    pub(crate) const fn of_csv(kind: RowKind) -> Self {
        Self {
            hex: match kind {
                RowKind::Sphere | RowKind::Cylinder { .. } => Some("color"),
                RowKind::Copy => None,
            },
            ..Self::of_array(kind)
        }
    }

    fn is_known(&self, name: &str) -> bool {
        let is_rotation = self.rotation.contains(&name);
        self.columns.contains(&Some(name)) || self.hex == Some(name) || is_rotation
    }

    /// Returns all names.
    pub(crate) fn all(&self) -> Vec<&'static str> {
        self.columns
            .iter()
            .copied()
            .chain([self.hex])
            .flatten()
            .chain(self.rotation.iter().copied())
            .collect()
    }
}

/// Returns the names of the columns of CSV files and of numpy arrays.
pub(crate) const fn columns(kind: RowKind) -> ColumnNames {
    let ends = match kind {
        RowKind::Sphere | RowKind::Copy => [Some("x"), Some("y"), Some("z"), None, None, None],
        RowKind::Cylinder { .. } => [
            Some("x1"),
            Some("y1"),
            Some("z1"),
            Some("x2"),
            Some("y2"),
            Some("z2"),
        ],
    };
    let [x, y, z, to_x, to_y, to_z] = ends;
    let [radius, r, g, b] = match kind {
        RowKind::Sphere | RowKind::Cylinder { .. } => {
            [Some("radius"), Some("r"), Some("g"), Some("b")]
        }
        RowKind::Copy => [Some("scale"), None, None, None],
    };
    [x, y, z, to_x, to_y, to_z, radius, r, g, b]
}

/// Returns the names of the columns of the axis and the angle, which only copies have.
pub(crate) const fn rotation_of(kind: RowKind) -> &'static [&'static str] {
    match kind {
        RowKind::Copy => &ROTATION,
        RowKind::Sphere | RowKind::Cylinder { .. } => &[],
    }
}

/// Returns the name of a column of the axis or the angle of copies, by its place among all columns.
pub(crate) fn rotation(at: usize) -> Option<&'static str> {
    match at {
        VALUE => Some(ANGLE),
        _ => ROTATION.get(at.checked_sub(OTHER_END.start)?).copied(),
    }
}

/// Returns the names of the coordinates.
pub(crate) fn coordinates(columns: &ColumnNames) -> impl Iterator<Item = &'static str> {
    columns.iter().take(RADIUS).copied().flatten()
}

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
pub(crate) struct Selection {
    /// The index of each among all columns.
    pub(crate) places: Columns<Option<usize>>,
    /// True if the three channels are one column of text.
    pub(crate) is_hex: bool,
    pub(crate) names: Names,
}

impl Selection {
    /// Chooses among the columns with these names.
    pub(crate) fn new(names: &[&str], known: &Known, request: &Request) -> Result<Self, Fault> {
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
        let [.., red, green, blue] = known.columns;
        // Where values determine the colors, no other column does.
        let color = |name: Option<&str>| name.filter(|_| request.value.is_none()).and_then(place);
        let [hex, r, g, b] = [known.hex, red, green, blue].map(color);
        let is_hex = hex.is_some();
        let [r, g, b] = match (hex, [r, g, b]) {
            (None, channels @ ([None, None, None] | [Some(_), Some(_), Some(_)])) => channels,
            (Some(_), [None, None, None]) => [hex; COLORS.end - COLORS.start],
            (None, _) => {
                let columns = known.columns_word;
                let [red, green, blue] = [red, green, blue].map(Option::unwrap_or_default);
                let message =
                    format!("of the {columns} `{red}`, `{green}` and `{blue}` only some are given");
                return Err(Fault::new(message).help("give all three, or none"));
            }
            (Some(_), _) => {
                let message = "the color is given twice, as `color` and as `r`, `g` and `b`";
                return Err(Fault::new(message).help("remove one of the two"));
            }
        };
        if let Some(name) = coordinates(&known.columns).find(|name| place(name).is_none()) {
            let fault = Fault::new(format!("{} {}", known.missing, quote(name)));
            return Err(match other_kind(names, request.kind()) {
                Some(help) => fault.help(help),
                None => fault,
            });
        }
        let [x, y, z, mut to_x, mut to_y, mut to_z, radius, ..] =
            known.columns.map(|name| name.and_then(place));
        let mut value = request.value.and_then(place);
        if let [axis @ .., angle] = known.rotation {
            [to_x, to_y, to_z] = match axis.iter().map(|name| place(name)).collect::<Vec<_>>()[..] {
                [Some(x), Some(y), Some(z)] => [Some(x), Some(y), Some(z)],
                [None, None, None] => [None; 3],
                _ => {
                    let [x, y, z, _] = ROTATION;
                    let message =
                        format!("of the columns `{x}`, `{y}` and `{z}` only some are given");
                    return Err(Fault::new(message).help("give all three, or none"));
                }
            };
            value = place(angle);
            if to_x.is_some() && value.is_none() {
                let fault = Fault::new(format!("there is an axis, but no column `{angle}`"));
                return Err(fault.help("give the angle about it in degrees, or leave the axis out"));
            }
        }
        let places = [x, y, z, to_x, to_y, to_z, radius, r, g, b, value];
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
    pub(crate) fn has(&self) -> Columns<bool> {
        self.places.map(|place| place.is_some())
    }
}

/// Returns the help for a table whose rows stand for other shapes than the scene says, if it is one.
pub(crate) fn other_kind(names: &[&str], kind: RowKind) -> Option<&'static str> {
    let (other, help) = match kind {
        RowKind::Copy => return None,
        RowKind::Sphere => (
            RowKind::Cylinder { capped: true },
            "its rows have two ends: name it by `Cylinders(file: …)`",
        ),
        RowKind::Cylinder { .. } => (
            RowKind::Sphere,
            "its rows have one point: name it by `Spheres(file: …)`",
        ),
    };
    coordinates(&columns(other))
        .all(|name| names.contains(&name))
        .then_some(help)
}

/// Returns true if a name stands for a column to skip, such as the nameless index that pandas writes.
fn is_skipped(name: &str) -> bool {
    name.is_empty() || name.starts_with('_')
}
