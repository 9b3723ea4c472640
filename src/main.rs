//! The program `strahl`: see `strahl help`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
