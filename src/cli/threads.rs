//! Threads of the program, and what they share.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    thread,
};

use super::failure::Failure;

/// Locks what threads share; a thread that has failed leaves it usable.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts a thread with a name. If the system refuses it, `lost` says what does not work.
pub(super) fn spawn(
    name: &str,
    lost: &str,
    run: impl FnOnce() + Send + 'static,
) -> Result<(), Failure> {
    let started = thread::Builder::new().name(name.to_owned()).spawn(run);
    let refused = |error| Failure::usage(format!("{lost}: {error}"));
    started.map(drop).map_err(refused)
}
