//! The file format: from text to a camera and a world, or to the faults of the text.

mod additions;
pub(crate) mod animation;
pub(crate) mod assist;
pub(crate) mod build;
pub(crate) mod check;
pub(crate) mod convert;
mod copies;
pub(crate) mod document;
pub(crate) mod duplicates;
pub(crate) mod files;
mod foreign;
pub mod format;
pub(crate) mod framing;
pub(crate) mod in_file;
mod loaded;
pub(crate) mod locate;
pub(crate) mod look;
mod meshes;
mod movers;
pub(crate) mod near;
mod nested;
pub(crate) mod new;
pub(crate) mod options;
pub(crate) mod origin;
pub(crate) mod origins;
pub(crate) mod part;
pub(crate) mod path;
mod pictures;
mod place;
pub(crate) mod problem;
pub(crate) mod read;
mod recognize;
pub(crate) mod recover;
mod reread;
pub(crate) mod scales;
pub(crate) mod schema;
pub(crate) mod set;
pub(crate) mod source;
pub(crate) mod tables;
pub(crate) mod unknown;
pub(crate) mod validate;
pub(crate) mod view;

#[cfg(test)]
pub(crate) mod tests;

pub use crate::data::table::row_cells::RowCells;
pub use crate::scene::assist::{
    completion::{ColorPlace, Completion, CompletionKind, Completions, Hover},
    names::{Name, NameKind},
};
pub use crate::tracer::colormap::scale::ColorScale;
pub use assist::{Cuts, Elements, Excerpt, FileLink, Fold, Symbol, SymbolKind};
pub use convert::{Converted, LostComments};
pub use document::Dependency;
pub use files::{Content, Disk, Files, Memory};
pub use look::Look;
pub use new::{new_lit_scene, new_path_scene, new_scene};
pub use origin::{Contained, Container, Origin};
pub use part::{PartFindings, PartPlace};
pub use scales::ColorValues;
pub use schema::{SCHEMA_URL, schema};
pub use set::{FieldLookup, Setting, SettingError};
pub use source::Source;
