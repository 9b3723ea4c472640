//! Options that say which warnings are wanted; of two that disagree the later wins.

use clap::{ArgMatches, Args, Command, FromArgMatches, arg, builder::PossibleValue};
use strahl::diagnostic::{Code, Levels, Severity};

use super::words::Words;

/// What `--deny`, `--warn` and `--allow` say.
#[derive(Clone, Default)]
pub(super) struct LevelArgs(Vec<Word>);

/// An option with its value.
#[derive(Clone, Copy)]
enum Word {
    Deny(Name),
    Warn(Code),
    Allow(Code),
}

/// What an option names.
#[derive(Clone, Copy)]
enum Name {
    /// `warnings`: all that are reported.
    All,
    One(Code),
}

impl LevelArgs {
    /// The levels that these options make of others.
    pub(super) fn on(&self, levels: &Levels) -> Levels {
        let mut levels = levels.clone();
        for word in &self.0 {
            match *word {
                Word::Deny(Name::All) => levels.deny_warnings(),
                Word::Deny(Name::One(code)) => levels.deny(code),
                Word::Warn(code) => levels.warn(code),
                Word::Allow(code) => levels.allow(code),
            }
        }
        levels
    }
}

fn name(text: &str) -> Result<Name, String> {
    if text == "warnings" {
        return Ok(Name::All);
    }
    code(text).map(Name::One)
}

fn code(text: &str) -> Result<Code, String> {
    match text.parse::<Code>() {
        Ok(code) if code.severity() == Severity::Warning => Ok(code),
        Ok(_) => Err("it is an error, and stays one".to_owned()),
        Err(_) => {
            let known: Vec<_> = Code::WARNINGS.iter().map(|code| code.name()).collect();
            Err(format!("known are {}", known.join(", ")))
        }
    }
}

fn codes() -> Vec<PossibleValue> {
    let codes = Code::WARNINGS.iter().map(|code| code.name());
    codes.map(PossibleValue::new).collect()
}

fn names() -> Vec<PossibleValue> {
    let mut names = codes();
    names.insert(0, PossibleValue::new("warnings"));
    names
}

impl Args for LevelArgs {
    fn augment_args(command: Command) -> Command {
        command
            .next_help_heading("Warnings, of which a later option wins")
            .arg(
                arg!(--deny <CODE> ... "Report a warning as an error; `warnings` means all")
                    .value_parser(Words::new(name, names))
                    .hide_possible_values(true)
                    .action(clap::ArgAction::Append)
                    .num_args(1)
                    .required(false),
            )
            .arg(
                arg!(--warn <CODE> ... "Report a warning, also one that is off by default")
                    .value_parser(Words::new(code, codes))
                    .hide_possible_values(true)
                    .action(clap::ArgAction::Append)
                    .num_args(1)
                    .required(false),
            )
            .arg(
                arg!(--allow <CODE> ... "Do not report a warning")
                    .value_parser(Words::new(code, codes))
                    .hide_possible_values(true)
                    .action(clap::ArgAction::Append)
                    .num_args(1)
                    .required(false),
            )
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
        let mut given: Vec<(usize, Word)> = Vec::new();
        let indices = |id| matches.indices_of(id).into_iter().flatten();
        if let Some(names) = matches.get_many::<Name>("deny") {
            let words = names.map(|name| Word::Deny(*name));
            given.extend(indices("deny").zip(words));
        }
        if let Some(codes) = matches.get_many::<Code>("warn") {
            let words = codes.map(|code| Word::Warn(*code));
            given.extend(indices("warn").zip(words));
        }
        if let Some(codes) = matches.get_many::<Code>("allow") {
            let words = codes.map(|code| Word::Allow(*code));
            given.extend(indices("allow").zip(words));
        }
        given.sort_by_key(|(at, _)| *at);
        self.0.extend(given.into_iter().map(|(_, word)| word));
        Ok(())
    }
}
