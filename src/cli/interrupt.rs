//! Signals such as Ctrl-C: leave no half file, and exit.

use std::process;

use strahl::parallel::Cancel;

/// The exit status of an interrupted program.
pub(super) const STATUS: u8 = 130;

/// From now on Ctrl-C removes the files that are being written under the result and ends the
/// program.
pub(super) fn cancel_on_signal() -> Cancel {
    let cancel = Cancel::new();
    let handle = cancel.clone();
    // Where no handler can be installed the system's own ends the program as well, only less
    // tidily.
    let _ = on_signal(move || {
        handle.cancel();
        process::exit(i32::from(STATUS));
    });
    cancel
}

#[cfg(unix)]
fn on_signal(handle: impl Fn() + Send + 'static) -> std::io::Result<()> {
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator::Signals,
    };

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    if !is_ignored(SIGHUP) {
        signals.add_signal(SIGHUP)?;
    }
    let handler = std::thread::Builder::new();
    handler.spawn(move || signals.forever().for_each(|_| handle()))?;
    Ok(())
}

/// Whether a signal is ignored, as SIGHUP is in a program that nohup has started: that is meant to
/// outlive its terminal. Where the system does not tell, it is left alone.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_none_or(|mask| mask >> (signal - 1) & 1 == 1)
}

/// From now on a file that becomes larger than the system allows is an error like a full disk, and
/// does not end the program at once.
#[cfg(unix)]
pub(super) fn outlive_large_files() {
    use signal_hook::{consts::SIGXFSZ, flag};

    // The flag is for nobody: that there is a handler is enough for writing to fail instead.
    let _ = flag::register(SIGXFSZ, std::sync::Arc::default());
}

#[cfg(not(unix))]
pub(super) fn outlive_large_files() {}

#[cfg(windows)]
fn on_signal(handle: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(handle)
}
