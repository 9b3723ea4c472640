//! Laws that hold between the text of scenes and what is read from it.

mod differential;
pub(crate) mod oracle;
mod printed;
mod spelling;
mod strict;
