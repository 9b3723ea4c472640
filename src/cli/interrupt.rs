//! Signals such as Ctrl-C: remove unfinished files and exit.

use std::process;

use strahl::parallel::Cancel;

/// The exit status of an interrupted program.
pub(super) const STATUS: u8 = 130;

/// Makes Ctrl-C, from now on, remove the files being written under the result and end the program.
pub(super) fn cancel_on_signal() -> Cancel {
    let cancel = Cancel::new();
    let handle = cancel.clone();
    exit_on_signal(move || handle.cancel());
    cancel
}

/// Makes Ctrl-C, from now on, call `clean_up` and end the program.
pub(super) fn exit_on_signal(clean_up: impl Fn() + Send + 'static) {
    // If no handler can be installed, the system's own ends the program too, only less tidily.
    let _ = on_signal(move || {
        clean_up();
        process::exit(i32::from(STATUS));
    });
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

/// Returns true if a signal is ignored, as SIGHUP is under nohup: the program is meant to outlive
/// its terminal. If the system does not report this, the signal is left alone.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = strahl::diagnostic::read_text("/proc/self/status", 1 << 16).unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_none_or(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Makes a file that exceeds the system's size limit an error, from now on, like a full disk.
/// Otherwise it would end the program at once.
#[cfg(unix)]
pub(super) fn outlive_large_files() {
    use signal_hook::{consts::SIGXFSZ, flag};

    // Nothing reads the flag: with any handler, writing fails instead.
    let _ = flag::register(SIGXFSZ, std::sync::Arc::default());
}

#[cfg(not(unix))]
pub(super) fn outlive_large_files() {}

#[cfg(windows)]
fn on_signal(handle: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(handle)
}
