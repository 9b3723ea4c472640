//! `strahl explain`: the page of a diagnostic.

use strahl::{Code, describe};

use super::Failure;

/// Print the page of a diagnostic code
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The code, such as out-of-range
    #[arg(value_parser = code)]
    code: Code,
}

fn code(name: &str) -> Result<Code, String> {
    name.parse().map_err(|_| {
        let known: Vec<_> = Code::ALL.iter().map(|code| code.name()).collect();
        format!("known are {}", known.join(", "))
    })
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    super::print(describe(args.code))
}
