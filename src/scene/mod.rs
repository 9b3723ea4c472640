//! The file format: from text to a camera and a world, or to what is wrong with the text.

pub(crate) mod build;
pub(crate) mod convert;
pub(crate) mod document;
pub(crate) mod duplicates;
pub(crate) mod fields;
pub(crate) mod files;
pub(crate) mod fmt;
pub(crate) mod load;
pub(crate) mod locate;
pub(crate) mod mend;
pub(crate) mod model;
pub(crate) mod nearest;
pub(crate) mod new;
pub(crate) mod options;
pub(crate) mod origin;
pub(crate) mod path;
pub(crate) mod problem;
pub(crate) mod read;
pub(crate) mod schema;
pub(crate) mod strict;
pub(crate) mod surroundings;
pub(crate) mod syntax;
pub(crate) mod table;
pub(crate) mod tables;
pub(crate) mod validate;
pub(crate) mod view;
