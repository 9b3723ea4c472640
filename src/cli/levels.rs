//! `--deny`, `--warn` and `--allow`; if two conflict, the later one wins.

use clap::{
    Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches,
    builder::{PossibleValue, TypedValueParser},
};
use strahl::diagnostic::{Code, Levels, Severity};

use super::words::one_of;

/// The values of `--deny`, `--warn` and `--allow`, in the order of the command line.
#[derive(Clone, Default)]
pub(super) struct LevelArgs(Vec<Word>);

/// A function that changes the level of a code.
type SetLevel = fn(&mut Levels, Code);

/// A change and its code; `None` for `warnings`, which means all that are reported.
type Word = (SetLevel, Option<Code>);

/// The options, each with its change and its help text.
const OPTIONS: [(&str, SetLevel, &str); 3] = [
    (
        "deny",
        Levels::deny,
        "Report a warning as an error; `warnings` means all",
    ),
    (
        "warn",
        Levels::warn,
        "Report a warning, also one that is off by default",
    ),
    ("allow", Levels::allow, "Do not report a warning"),
];

impl LevelArgs {
    /// Applies the options to levels.
    pub(super) fn on(&self, levels: &Levels) -> Levels {
        let mut levels = levels.clone();
        for (set, code) in &self.0 {
            match code {
                Some(code) => set(&mut levels, *code),
                None => levels.deny_warnings(),
            }
        }
        levels
    }
}

/// Returns the name of a code; completions omit errors.
fn value(code: Option<Code>) -> PossibleValue {
    let name = code.map_or("warnings", Code::name);
    PossibleValue::new(name).hide(code.is_some_and(is_error))
}

fn is_error(code: Code) -> bool {
    code.severity() == Severity::Error
}

impl Args for LevelArgs {
    fn augment_args(command: Command) -> Command {
        let options = OPTIONS.map(|(name, set, help)| {
            let all = (name == "deny").then_some(None);
            let codes = Code::ALL.iter().copied().map(Some);
            let parser = one_of(all.into_iter().chain(codes), value);
            Arg::new(name)
                .long(name)
                .value_name("CODE")
                .help(help)
                .action(ArgAction::Append)
                .hide_possible_values(true)
                .value_parser(parser.try_map(move |code| match code {
                    Some(code) if is_error(code) => {
                        Err("it is an error; only warnings can be changed")
                    }
                    _ => Ok::<Word, _>((set, code)),
                }))
        });
        command
            .next_help_heading("Warnings (a later option wins)")
            .args(options)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for LevelArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut this = Self::default();
        this.update_from_arg_matches(matches)?;
        Ok(this)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let given = OPTIONS.iter().flat_map(|(name, ..)| {
            let words = matches.get_many::<Word>(name).into_iter().flatten();
            let indices = matches.indices_of(name).into_iter().flatten();
            indices.zip(words.copied())
        });
        let mut given: Vec<_> = given.collect();
        given.sort_by_key(|(at, _)| *at);
        self.0.extend(given.into_iter().map(|(_, word)| word));
        Ok(())
    }
}
