//! Tips for commands and options that other programs have.

use std::{env, path::Path};

use clap::{
    builder::StyledStr,
    error::{ContextKind, ContextValue, ErrorKind},
};
use strahl::Syntax;

/// Commands of other programs, each with the one of this program.
const COMMANDS: &[(&[&str], &str)] = &[
    (&["check", "lint", "verify", "test"], "validate"),
    (&["compare", "cmp"], "diff"),
    (&["create", "init"], "new"),
    (&["draw", "raytrace", "trace", "run"], "render"),
    (&["format"], "fmt"),
    (&["inspect", "stats"], "info"),
    (&["open", "serve", "show", "view"], "preview"),
];

/// Options of other programs, each with the option of this program and a tip. The first that the
/// command has is meant.
const OPTIONS: &[(&str, &str, &str)] = &[
    (
        "--resolution --res --dimensions --width --height",
        "size",
        "the size of the picture in pixels is '--size WIDTHxHEIGHT'",
    ),
    (
        "--dpi --ppi",
        "size",
        "a picture is measured in pixels: at 300 dpi, '--size 1200x900' is 4 by 3 inches",
    ),
    (
        "--spp --aa --antialias --antialiasing",
        "samples",
        "the number of rays per pixel is '--samples N'",
    ),
    (
        "--frame --time",
        "frames",
        "a picture of one frame is '--frames N'",
    ),
    (
        "--frames --time",
        "frame",
        "the number of the frame is '--frame N'",
    ),
    (
        "--format --type",
        "image-format",
        "the extension of '-o FILE' determines the format; for standard output, it is '--image-format FORMAT'",
    ),
    (
        "--format --type",
        "output-format",
        "the format of the result is '--output-format FORMAT'",
    ),
    (
        "--jobs --cores -j",
        "threads",
        "the number of threads is '--threads N'",
    ),
];

/// The number of valid values up to which an error lists all of them although one is similar.
const MOST_VALUES: usize = 20;

/// Adds to an error in the arguments what was probably meant.
pub(super) fn improve(error: &mut clap::Error, cli: clap::Command) {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            if let Some(name) = text(ContextKind::InvalidSubcommand) {
                command(error, &name);
            }
        }
        ErrorKind::UnknownArgument => {
            if let Some(name) = text(ContextKind::InvalidArg) {
                option(error, &name, cli);
            }
        }
        ErrorKind::InvalidValue => {
            let values = error.get(ContextKind::ValidValue);
            let is_long =
                matches!(values, Some(ContextValue::Strings(all)) if all.len() > MOST_VALUES);
            if is_long && error.get(ContextKind::SuggestedValue).is_some() {
                error.remove(ContextKind::ValidValue);
            }
        }
        _ => {}
    }
}

/// Suggests a command in place of an unknown one, or the command that draws a scene in place of the
/// scene.
fn command(error: &mut clap::Error, name: &str) {
    if Syntax::of_path(Path::new(name)).is_some() {
        tip(
            error,
            &format!("to render a scene, use 'strahl render {name}'"),
        );
        return;
    }
    let mut commands = COMMANDS.iter();
    if let Some((_, meant)) = commands.find(|(others, _)| others.contains(&name)) {
        let meant = ContextValue::String((*meant).to_owned());
        error.insert(ContextKind::SuggestedSubcommand, meant);
    }
}

/// Suggests an option that the command has in place of an unknown one.
fn option(error: &mut clap::Error, name: &str, mut cli: clap::Command) {
    cli.build();
    let command = env::args().nth(1);
    let command = command.and_then(|command| cli.find_subcommand_mut(command));
    let Some(command) = command else {
        return;
    };
    let has = |long: &str| {
        command
            .get_arguments()
            .any(|one| one.get_long() == Some(long))
    };
    let mut options = OPTIONS.iter();
    let meant =
        options.find(|(others, long, _)| others.split(' ').any(|one| one == name) && has(long));
    if let Some((_, _, words)) = meant {
        tip(error, words);
        error.remove(ContextKind::SuggestedArg);
        // The usage names the argument that was suggested.
        let usage = ContextValue::StyledStr(command.render_usage());
        error.insert(ContextKind::Usage, usage);
    }
}

fn tip(error: &mut clap::Error, words: &str) {
    let tip = ContextValue::StyledStrs(vec![StyledStr::from(words.to_owned())]);
    error.insert(ContextKind::Suggested, tip);
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn every_tip_names_what_exists() {
        let cli = Cli::command();
        for (others, meant) in COMMANDS {
            let exists = |name: &str| cli.get_subcommands().any(|one| one.get_name() == name);
            assert!(exists(meant) || *meant == "preview", "{meant}");
            assert!(!others.iter().any(|other| exists(other)), "{others:?}");
        }
        for (_, long, words) in OPTIONS {
            let mut arguments = cli.get_subcommands().flat_map(clap::Command::get_arguments);
            assert!(arguments.any(|one| one.get_long() == Some(*long)), "{long}");
            assert!(words.contains(&format!("--{long}")), "{words}");
        }
    }
}
