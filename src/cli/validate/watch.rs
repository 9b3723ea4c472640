//! `strahl validate --watch`: another report after each change of a file that matters.

use std::{
    collections::BTreeSet,
    env,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    thread,
    time::Instant,
};

use same_file::Handle;
use strahl::{
    Syntax,
    jobs::{Configs, find_scenes},
};

use super::Args;
use crate::cli::{
    failure::Failure,
    rounds::{Rounds, WAITING, print_line},
    scene,
};

/// Clears the screen and moves the cursor to its top.
const CLEAR: &str = "\x1b[2J\x1b[H";

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if args.paths.names_stdin() {
        let message = "standard input cannot be watched; name files or folders";
        return Err(Failure::usage(message));
    }
    let rounds = Rounds::new()?;
    let mut known = None;
    loop {
        let changed = match &known {
            None => rounds.next().changed,
            Some(known) => next_change(&rounds, known),
        };
        let is_first = known.is_none();
        if !is_first {
            begin(&changed)?;
        }
        known = Some(WatchedScenes::watch(args, &rounds)?);
        scene::forget_printed();
        match super::check(args, Some(rounds.files())) {
            Err(closed @ Failure::Closed { .. }) => return Err(closed),
            // An edit does not mend a wrong command.
            Err(failure) if is_first && failure.status() == 2 => return Err(failure),
            Err(failure) => failure.print(),
            Ok(()) => {}
        }
        print_line(WAITING)?;
    }
}

/// The files of a round.
struct WatchedScenes<'a> {
    args: &'a Args,
    /// The files that the command names, and those that say how scenes are checked.
    named: BTreeSet<PathBuf>,
    /// The scenes that were found, or nothing if the search failed.
    scenes: BTreeSet<PathBuf>,
}

impl<'a> WatchedScenes<'a> {
    /// Finds the files, and watches them before they are read.
    fn watch(args: &'a Args, rounds: &Rounds) -> Result<Self, Failure> {
        let configs = args.config.configs();
        let paths = args.paths.all().unwrap_or_default();
        let lists = args.paths.files_from.iter().chain(&args.params).cloned();
        let settings = paths.iter().flat_map(|path| configs.files(path));
        let named: BTreeSet<_> = paths.iter().cloned().chain(lists).chain(settings).collect();
        rounds.watch_below(named.iter().cloned())?;
        let scenes = scenes(args, &paths, &configs);
        // Behind a link, another file changes.
        for link in scenes.iter().filter(|scene| scene.is_symlink()) {
            rounds.add(link)?;
        }
        Ok(Self {
            args,
            named,
            scenes,
        })
    }

    /// Returns the files whose change calls for another round.
    fn relevant(&self, rounds: &Rounds, changed: BTreeSet<PathBuf>) -> BTreeSet<PathBuf> {
        let is_read = |file: &Path| {
            let is_config = file.file_name() == Some("strahl.toml".as_ref());
            is_config
                || self.scenes.contains(file)
                || self.named.contains(file)
                || rounds.is_named(file)
        };
        let (mut read, others): (BTreeSet<_>, BTreeSet<_>) =
            changed.into_iter().partition(|file| is_read(file));
        read.retain(|file| !is_output(file));
        if others.iter().any(|file| may_be_found(file)) {
            let start = Instant::now();
            let paths = self.args.paths.all().unwrap_or_default();
            let found = scenes(self.args, &paths, &self.args.config.configs());
            let differences = found.symmetric_difference(&self.scenes);
            read.extend(differences.filter(|file| !is_output(file)).cloned());
            if read.is_empty() {
                // Another program may write thousands of files that are none of ours.
                thread::sleep(start.elapsed());
            }
        }
        read
    }
}

fn scenes(args: &Args, paths: &[PathBuf], configs: &Configs) -> BTreeSet<PathBuf> {
    let found = find_scenes(paths, &args.paths.exclude, configs).unwrap_or_default();
    found.into_iter().map(|file| file.path).collect()
}

/// Returns true if a search may find other scenes after a change of this file or folder.
fn may_be_found(file: &Path) -> bool {
    Syntax::of_path(file).is_some()
        || file.file_name() == Some(".gitignore".as_ref())
        || file.is_dir()
        // It may have been a folder.
        || !file.exists()
}

/// Returns true if standard output or standard error is this file: it changes in each round.
fn is_output(file: &Path) -> bool {
    // Opening a pipe would block forever.
    let handle = file.is_file().then(|| Handle::from_path(file).ok());
    let Some(handle) = handle.flatten() else {
        return false;
    };
    let outputs = [Handle::stdout(), Handle::stderr()];
    outputs.into_iter().flatten().any(|output| output == handle)
}

/// Waits until a file that matters has changed.
fn next_change(rounds: &Rounds, known: &WatchedScenes) -> BTreeSet<PathBuf> {
    loop {
        let changed = known.relevant(rounds, rounds.next().changed);
        if !changed.is_empty() {
            return changed;
        }
    }
}

/// Separates a report from the one before.
fn begin(changed: &BTreeSet<PathBuf>) -> Result<(), Failure> {
    let mut stdout = io::stdout();
    if stdout.is_terminal() && env::var_os("TERM").is_none_or(|term| term != "dumb") {
        let cleared = write!(stdout, "{CLEAR}").and_then(|()| stdout.flush());
        cleared.map_err(Failure::stdout)?;
    }
    let Some(first) = changed.first() else {
        return Ok(());
    };
    print_line("")?;
    let others = match changed.len() - 1 {
        0 => String::new(),
        count => format!(" and {count} more"),
    };
    print_line(&format!("changed: {}{others}", first.display()))
}
