//! `strahl preview`: a local page with the text of a scene, its diagnostics and its picture.

mod app;
mod connections;
mod desk;
mod drawings;
mod findings;
mod guard;
mod opening;
mod page;
mod parts;
mod pictures;
mod places;
mod progressive;
mod references;
mod refusal;
mod requests;
mod routes;
mod texts;

use std::{
    io::{self, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener},
    path::PathBuf,
    sync::{Arc, mpsc},
};

use strahl::{
    Error, Syntax,
    diagnostic::read_text,
    parallel::Cancel,
    session::{Checked, Session, folder_of},
};

use self::{
    app::App,
    desk::{Desk, LONGEST},
    guard::{Guard, LOST, unavailable},
    opening::Opening,
};
use super::{
    config::ConfigArgs, failure::Failure, interrupt, paths::is_dash, scene, set::SetArgs,
    threads::spawn, watcher::Watcher,
};

/// The first port that is tried.
const PORT: u16 = 8017;
/// The number of ports that are tried.
const PORTS: u16 = 100;

/// Show a scene in the browser, drawn again with every change of the text
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The scene file, .ron or .json
    scene: PathBuf,
    /// Syntax of a scene with another extension
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    config: ConfigArgs,
    #[command(flatten)]
    set: SetArgs,
    /// The port of the page on this machine; 0 for any. Default: the first free one from 8017
    #[arg(long, value_name = "PORT")]
    port: Option<u16>,
    /// Only print the address; do not open a browser
    #[arg(long)]
    no_open: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (cancel, opening) = (Cancel::new(), Arc::new(Opening::default()));
    let at_end = (cancel.clone(), Arc::clone(&opening));
    interrupt::exit_on_signal(move || {
        at_end.0.cancel();
        at_end.1.end();
    });
    let path = &args.scene;
    if is_dash(path) {
        return Err(Failure::usage(
            "standard input cannot be previewed; write the scene to a file",
        ));
    }
    let text = read_text(path, LONGEST).map_err(|error| Error::reading_failed(path, error))?;
    let syntax = args.input_format.or_else(|| Syntax::of_path(path));
    let syntax = syntax.ok_or_else(|| {
        let why = "the extension does not determine the syntax, expected .ron or .json; use \
                   --input-format";
        Failure::refused(path, why)
    })?;
    let options = self::options(args, syntax)?;
    let listener = listen(args.port)?;
    let address = listener.local_addr().map_err(|error| unavailable(&error))?;

    let (checked, results) = mpsc::channel();
    let moved = checked.clone();
    let session = Session::new(path.display().to_string(), &*text, options, move |result| {
        let _ = checked.send(Some(result));
    })?;
    let desk = Arc::new(Desk::new(session, path.clone(), syntax, text, cancel));
    let guard = Guard::new(address, Arc::clone(&opening))?;
    let url = guard.url();
    super::output::print(&format!("{url}\n"))?;
    if !args.no_open && opening.open(&url).is_err() {
        let _ = writeln!(io::stderr(), "open the address above in a browser");
    }
    follow(&desk, moved, results)?;
    serve(listener, App::new(desk, guard))
}

fn options(args: &Args, syntax: Syntax) -> Result<strahl::ReadOptions, Failure> {
    let config = args.config.configs().of(&args.scene)?;
    let options = args.tables.options(&config).levels(config.levels().clone());
    let options = options.syntax(syntax).folder(folder_of(&args.scene));
    Ok(args.set.of(options))
}

/// Passes on the results of checks and the changes of files, on threads of their own. `changed` asks
/// for no result: the files are watched anew, because a link on the way to them may have changed.
fn follow(
    desk: &Arc<Desk>,
    changed: mpsc::Sender<Option<Arc<Checked>>>,
    results: mpsc::Receiver<Option<Arc<Checked>>>,
) -> Result<(), Failure> {
    let of_changes = Arc::clone(desk);
    let mut watcher = Watcher::new(move |files: &[PathBuf]| {
        of_changes.on_change(files);
        let _ = changed.send(None);
    })?;
    let mut files = vec![desk.path().to_owned()];
    watcher.watch(files.clone())?;
    let desk = Arc::clone(desk);
    let follow = move || {
        for result in results {
            let before = files.clone();
            if let Some(checked) = &result {
                files.truncate(1);
                files.extend(checked.files().iter().cloned());
            }
            if let Err(failure) = watcher.watch(files.clone()) {
                failure.print();
            }
            // What is new may have changed before it was watched.
            match result {
                Some(checked) => {
                    let new = files.iter().filter(|file| !before.contains(file));
                    if new.into_iter().any(|file| checked.may_precede(file)) {
                        desk.session().refresh();
                    }
                    desk.show(checked);
                }
                None => desk.on_change(&files[..1]),
            }
        }
    };
    spawn("follow", LOST, follow)
}

/// Binds to a port of this machine that other machines cannot reach.
fn listen(port: Option<u16>) -> Result<TcpListener, Failure> {
    let bind = |port| TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    match port {
        Some(port) => bind(port)
            .map_err(|error| Failure::usage(format!("port {port} cannot be used: {error}"))),
        None => {
            let mut free = (PORT..PORT + PORTS).filter_map(|port| bind(port).ok());
            let message = format!("no port from {PORT} to {} is free", PORT + PORTS - 1);
            free.next().ok_or_else(|| Failure::usage(message))
        }
    }
}

fn serve(listener: TcpListener, app: App) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| unavailable(&error))?;
    runtime
        .block_on(connections::serve(listener, app.router()))
        .map_err(|error| unavailable(&error))
}
