//! `strahl lsp`: scenes in an editor, by the Language Server Protocol.

mod actions;
mod assist;
mod capabilities;
mod client;
mod colors;
mod diagnostics;
mod document;
mod documents;
mod format;
mod names;
mod open_files;
mod outbox;
mod parent;
mod requests;
mod server;
mod settings;
mod structure;
mod text;
mod uri;
mod watching;
mod wire;
mod work;
mod workspace;

use std::{
    io::{self, IsTerminal, Write},
    sync::mpsc,
};

use self::{document::Event, outbox::Outbox, server::Server, settings::Settings};
use super::{config::ConfigArgs, failure::Failure, scene, threads::spawn};

/// Serve an editor: diagnostics, completion and more, by the Language Server Protocol
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Use standard input and output, which is the default; many editors pass it
    #[arg(long)]
    stdio: bool,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    config: ConfigArgs,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    if io::stdin().is_terminal() {
        let _ = writeln!(
            io::stderr(),
            "this command is started by an editor; see docs/editors.md. End it with Ctrl-D"
        );
    }
    let (sender, events) = mpsc::channel();
    let outbox = Outbox::new(io::stdout())?;
    let input = sender.clone();
    spawn("read", outbox::NO_THREADS, move || {
        let mut stdin = io::stdin().lock();
        while let Ok(Some(incoming)) = wire::read(&mut stdin) {
            if input.send(Event::Incoming(incoming)).is_err() {
                return;
            }
        }
        let _ = input.send(Event::End);
    })?;
    let settings = Settings::new(args.tables, args.config);
    let mut server = Server::new(outbox.clone(), sender, settings)?;
    let is_orderly = server.run(&events);
    drop(server);
    outbox.finish();
    match is_orderly {
        true => Ok(()),
        // The protocol demands this status of an end without `shutdown`.
        false => Err(Failure::Found),
    }
}
