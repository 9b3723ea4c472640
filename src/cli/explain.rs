//! `strahl explain`: the page of a diagnostic.

use strahl::diagnostic::{Code, describe};

use super::{failure::Failure, words::one_of};

/// Print the page of a diagnostic code, or the list of all codes
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The code, such as out-of-range
    #[arg(value_parser = one_of(Code::ALL.iter().copied(), |code| code.name().into()), hide_possible_values = true)]
    code: Option<Code>,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    match args.code {
        Some(code) => super::output::print(describe(code)),
        None => super::output::print(&list()),
    }
}

/// Returns all codes, each with the first sentence of its page.
fn list() -> String {
    let width = Code::ALL.iter().map(|code| code.name().len()).max();
    let width = width.unwrap_or_default();
    let codes = Code::ALL.iter().map(|code| {
        let meaning = describe(*code).lines().nth(2).unwrap_or_default();
        format!("{:width$}  {meaning}\n", code.name())
    });
    codes.collect()
}
