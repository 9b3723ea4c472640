//! Laws that hold between the text of scenes and what is read from it.

mod differential;
mod printed;
mod spelling;
