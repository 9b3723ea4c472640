//! Options that say which warnings are wanted; of two that disagree the later wins.

use clap::{ArgMatches, Args, Command, FromArgMatches, arg, error::ErrorKind};
use strahl::{Code, Levels, Severity};

/// What `--deny`, `--warn` and `--allow` say.
#[derive(Clone, Default)]
pub(super) struct LevelArgs(pub(super) Levels);

/// What an option names.
#[derive(Clone, Copy)]
enum Name {
    /// `warnings`: all that are reported.
    All,
    One(Code),
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

impl Args for LevelArgs {
    fn augment_args(command: Command) -> Command {
        command
            .next_help_heading("Warnings, of which a later option wins")
            .arg(
                arg!(--deny <CODE> ... "Report a warning as an error; `warnings` means all")
                    .value_parser(name)
                    .action(clap::ArgAction::Append)
                    .num_args(1)
                    .required(false),
            )
            .arg(
                arg!(--warn <CODE> ... "Report a warning, also one that is off by default")
                    .value_parser(code)
                    .action(clap::ArgAction::Append)
                    .num_args(1)
                    .required(false),
            )
            .arg(
                arg!(--allow <CODE> ... "Do not report a warning")
                    .value_parser(code)
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
        let mut given: Vec<(usize, &str, Name)> = Vec::new();
        let indices = |id| matches.indices_of(id).into_iter().flatten();
        if let Some(names) = matches.get_many::<Name>("deny") {
            given.extend(
                indices("deny")
                    .zip(names)
                    .map(|(at, name)| (at, "deny", *name)),
            );
        }
        for id in ["warn", "allow"] {
            if let Some(codes) = matches.get_many::<Code>(id) {
                given.extend(
                    indices(id)
                        .zip(codes)
                        .map(|(at, code)| (at, id, Name::One(*code))),
                );
            }
        }
        given.sort_by_key(|(at, ..)| *at);
        for (_, id, name) in given {
            match (id, name) {
                ("deny", Name::All) => self.0.deny_warnings(),
                ("deny", Name::One(code)) => self.0.deny(code),
                ("warn", Name::One(code)) => self.0.warn(code),
                ("allow", Name::One(code)) => self.0.allow(code),
                _ => return Err(clap::Error::new(ErrorKind::InvalidValue)),
            }
        }
        Ok(())
    }
}
