//! `strahl explain`: the page of a diagnostic.

use clap::builder::PossibleValue;
use strahl::{Code, describe};

use super::{Failure, words::Words};

/// Print the page of a diagnostic code
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The code, such as out-of-range
    #[arg(value_parser = Words::new(code, codes), hide_possible_values = true)]
    code: Code,
}

fn code(name: &str) -> Result<Code, String> {
    name.parse().map_err(|_| {
        let known: Vec<_> = Code::ALL.iter().map(|code| code.name()).collect();
        format!("known are {}", known.join(", "))
    })
}

fn codes() -> Vec<PossibleValue> {
    let codes = Code::ALL.iter().map(|code| code.name());
    codes.map(PossibleValue::new).collect()
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    super::print(describe(args.code))
}
