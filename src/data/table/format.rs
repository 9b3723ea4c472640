//! The file formats of tables: their extensions, and the names of their columns.

use crate::data::{
    ply::selection,
    table::{
        kind::RowKind,
        layout::COLORS,
        select::{self, ColumnNames, Known},
    },
};

/// The file format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Comma-separated values with a header.
    Csv,
    /// A numpy array.
    Npy,
    /// Numpy arrays with names, in a zip file.
    Npz,
    /// The Stanford polygon format; only its vertices are read.
    Ply,
    /// Atoms, one per line.
    Xyz,
    /// Atoms of the Protein Data Bank, in fixed columns.
    Pdb,
}

/// Each format with its file extension.
const ENDINGS: [(&str, Format); 6] = [
    (".csv", Format::Csv),
    (".npy", Format::Npy),
    (".npz", Format::Npz),
    (".ply", Format::Ply),
    (".xyz", Format::Xyz),
    (".pdb", Format::Pdb),
];

impl Format {
    /// Returns the format for a file extension, in either case.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        let is_it = |known: &str| known[1..].eq_ignore_ascii_case(ending);
        let mut all = ENDINGS.into_iter();
        all.find_map(|(known, format)| is_it(known).then_some(format))
    }

    /// Returns true if a file of the format may hold rows of a kind.
    pub(crate) const fn holds(self, kind: RowKind) -> bool {
        match self {
            Self::Csv | Self::Npy | Self::Npz => true,
            Self::Ply | Self::Xyz | Self::Pdb => matches!(kind, RowKind::Sphere),
        }
    }

    /// Returns the file extensions of the formats for rows of a kind, as text.
    pub(crate) fn endings(kind: RowKind) -> String {
        let all = ENDINGS.into_iter().filter(|(_, format)| format.holds(kind));
        let all: Vec<_> = all.map(|(ending, _)| ending).collect();
        match all.split_last() {
            Some((last, [])) => (*last).to_owned(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
            None => String::new(),
        }
    }

    /// Returns the names of the columns, without the value; `None` for one that rows of this kind
    /// never have.
    pub(crate) const fn columns(self, kind: RowKind) -> ColumnNames {
        match self {
            Self::Csv | Self::Npy | Self::Npz | Self::Xyz | Self::Pdb => select::columns(kind),
            Self::Ply => selection::KNOWN.columns,
        }
    }

    /// Returns the names of all columns that rows of a kind may have, without the value.
    pub(crate) fn column_names(self, kind: RowKind) -> impl Iterator<Item = &'static str> {
        let columns = self.columns(kind).into_iter().flatten();
        columns.chain(select::rotation_of(kind).iter().copied())
    }

    /// Returns the names of the columns of colors.
    pub(crate) fn color_names(self, kind: RowKind) -> impl Iterator<Item = &'static str> {
        let hex = Known::of_csv(kind).hex.filter(|_| self == Self::Csv);
        let channels = self.columns(kind).into_iter().skip(COLORS.start).flatten();
        channels.chain(hex)
    }

    /// Returns the name of a column, by its place among all.
    pub(crate) fn column(self, kind: RowKind, at: usize) -> Option<&'static str> {
        match (kind, self.columns(kind).get(at)) {
            (RowKind::Copy, None | Some(None)) => select::rotation(at),
            (_, name) => name.copied().flatten(),
        }
    }

    /// Returns true if the rows are atoms, whose elements have radii and colors.
    pub(crate) const fn is_atoms(self) -> bool {
        matches!(self, Self::Xyz | Self::Pdb)
    }
}
