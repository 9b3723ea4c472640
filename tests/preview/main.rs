//! Tests of `strahl preview`: its page in Chromium, and its server against hostile requests.
//!
//! The tests of the page run with `STRAHL_FULL`, and need `chromium` and `chromedriver`; else they are
//! reported as ignored. With `STRAHL_SHOTS=FOLDER`, they leave screenshots there.

mod browser;
mod driver;
mod http;
mod preview;

mod access;
mod camera;
mod comparing;
mod disk;
mod editing;
mod foreign;
mod hostile;
mod many;
mod parts;
mod pictures;
mod pointing;
mod robust;
mod showing;

use std::{env, process::ExitCode};

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
        access::TESTS,
        camera::TESTS,
        comparing::TESTS,
        disk::TESTS,
        editing::TESTS,
        foreign::TESTS,
        many::PAGE_TESTS,
        parts::TESTS,
        pointing::TESTS,
        robust::PAGE_TESTS,
        showing::TESTS,
    ];
    // They take longer than all other tests.
    let is_full = ["STRAHL_FULL", "STRAHL_SHOTS"]
        .iter()
        .any(|name| env::var_os(name).is_some());
    let is_missing = !is_full || driver::programs().is_none();
    let mut trials: Vec<_> = pages
        .concat()
        .into_iter()
        .map(|(name, test)| trial(name, move || Browser::with(test)).with_ignored_flag(is_missing))
        .collect();
    let run = || Browser::with(pictures::pictures_of_the_manual);
    let is_unwanted = is_missing || env::var_os("STRAHL_SHOTS").is_none();
    trials.push(trial("pictures_of_the_manual", run).with_ignored_flag(is_unwanted));
    let is_missing = is_missing || !access::axe().exists();
    trials.extend(access::AXE_TESTS.iter().map(|(name, test)| {
        trial(name, move || Browser::with(test)).with_ignored_flag(is_missing)
    }));
    let plain = hostile::TESTS
        .iter()
        .chain(many::TESTS)
        .chain(robust::TESTS);
    trials.extend(plain.map(|(name, test)| trial(name, test)));
    let conclusion = libtest_mimic::run(&arguments, trials);
    driver::stop();
    conclusion.exit_code()
}

fn trial(name: &str, test: impl FnOnce() + Send + 'static) -> Trial {
    Trial::test(name.trim_start_matches("preview::"), || {
        test();
        Ok(())
    })
}
