//! Chromedriver: one for all tests, with a browser for each test that runs at the same time.

use std::{
    env,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{Mutex, OnceLock},
    thread,
};

use super::browser::Browser;

struct Driver {
    process: Mutex<Child>,
    port: u16,
}

static DRIVER: OnceLock<Driver> = OnceLock::new();
/// Browsers that no test uses at present.
pub(crate) static FREE: Mutex<Vec<Browser>> = Mutex::new(Vec::new());

/// Returns the paths of chromium and chromedriver.
pub(crate) fn programs() -> Option<(PathBuf, PathBuf)> {
    let path = env::var_os("PATH")?;
    let find = |names: &[&str]| {
        let mut all = env::split_paths(&path)
            .flat_map(|folder| names.iter().map(move |name| folder.join(name)));
        all.find(|file: &PathBuf| Path::is_file(file))
    };
    let chromium = find(&["chromium", "chromium-browser", "google-chrome"])?;
    Some((chromium, find(&["chromedriver"])?))
}

/// Returns the port of chromedriver, which is started at first.
pub(crate) fn port() -> u16 {
    DRIVER.get_or_init(start).port
}

fn start() -> Driver {
    let (_, program) = programs().expect("chromedriver is missing");
    let mut process = Command::new(program)
        .arg("--port=0")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
    let port = lines.find_map(|line| {
        let line = line.unwrap();
        let (_, port) = line.split_once("started successfully on port ")?;
        port.trim_end_matches('.').parse().ok()
    });
    let port = port.expect("chromedriver did not name its port");
    thread::spawn(move || lines.for_each(drop));
    Driver {
        process: Mutex::new(process),
        port,
    }
}

/// Ends all browsers, and chromedriver.
pub(crate) fn stop() {
    FREE.lock().unwrap().drain(..).for_each(Browser::close);
    if let Some(driver) = DRIVER.get() {
        let mut process = driver.process.lock().unwrap();
        process.kill().unwrap();
        process.wait().unwrap();
    }
}
