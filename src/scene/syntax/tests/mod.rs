//! The reader against hand-made faults, random mutations and hostile text.

#[expect(
    dead_code,
    reason = "of the stand-in types it only matters whether serde makes them"
)]
mod common;
mod differential;
mod faults;
mod robust;
mod slips;
