//! Laws between the text of a scene and its values.

mod convert;
mod differential;
pub(crate) mod oracle;
mod printed;
mod spelling;
mod strict;
mod typed;
