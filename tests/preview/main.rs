//! Tests of `strahl preview`: its page in Chromium, and its server against hostile requests.
//!
//! The tests of the page need `chromium` and `chromedriver`; on a machine without them they are
//! reported as ignored. With `STRAHL_SHOTS=FOLDER`, they leave screenshots there.

mod browser;
mod driver;
mod http;
mod preview;

mod camera;
mod comparing;
mod disk;
mod editing;
mod pointing;
mod showing;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};

use self::browser::Browser;

/// A test in a browser.
type PageTest = fn(&Browser);

/// The tests of a file, by the names of their functions.
macro_rules! tests {
    ($($name:ident),* $(,)?) => {
        &[$((concat!(module_path!(), "::", stringify!($name)), $name)),*]
    };
}
use tests;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let pages: [&[(&str, PageTest)]; _] = [
        camera::TESTS,
        comparing::TESTS,
        disk::TESTS,
        editing::TESTS,
        pointing::TESTS,
        showing::TESTS,
    ];
    let is_missing = driver::programs().is_none();
    let trials = pages.concat().into_iter().map(|(name, test)| {
        let name = name.trim_start_matches("preview::");
        let run = move || {
            Browser::with(test);
            Ok(())
        };
        Trial::test(name, run).with_ignored_flag(is_missing)
    });
    let conclusion = libtest_mimic::run(&arguments, trials.collect());
    driver::stop();
    conclusion.exit_code()
}
