//! The program `strahl`: see `strahl help`.

mod cli;

use std::process::ExitCode;

/// It asks for large pages: first touches of small ones took a third of the time of large scenes.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    cli::run()
}
