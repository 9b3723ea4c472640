//! The reader against hand-made faults, random mutations and hostile text.

mod common;
mod differential;
mod faults;
mod robust;
mod slips;
mod spelling;
