//! Tests of the parser with handmade faults, random mutations and hostile text.

pub(crate) mod common;
mod faults;
mod robust;
mod slips;
