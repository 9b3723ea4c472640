//! Ctrl-C: leave no half file, and exit.

use std::process;

use strahl::Cancel;

/// The exit status of an interrupted program.
pub(super) const STATUS: u8 = 130;

/// From now on Ctrl-C removes what is being written under `cancel` and ends the program.
pub(super) fn exit_on_signal(cancel: Cancel) {
    // Where no handler can be installed the system's own ends the program as well, only less
    // tidily.
    let _ = on_signal(move || {
        cancel.cancel();
        process::exit(i32::from(STATUS));
    });
}

// Not SIGHUP: a program that nohup has started is meant to outlive its terminal.
#[cfg(unix)]
fn on_signal(handle: impl Fn() + Send + 'static) -> std::io::Result<()> {
    use signal_hook::{
        consts::{SIGINT, SIGTERM},
        iterator::Signals,
    };

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    std::thread::spawn(move || signals.forever().for_each(|_| handle()));
    Ok(())
}

#[cfg(windows)]
fn on_signal(handle: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(handle)
}
