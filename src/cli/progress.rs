//! The progress bar on the terminal during drawing.

use std::{
    io::{self, IsTerminal, Write},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{self, RecvTimeoutError, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use clap::ValueEnum;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The conditions for showing a progress bar.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum When {
    /// On a terminal, if rendering takes longer than a second
    #[default]
    Auto,
    /// From the start; without a terminal, as one line per second
    Always,
    /// Never
    Never,
}

/// The duration below which work needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// The interval between updates of the bar.
const TICK: Duration = Duration::from_millis(100);
/// The interval between lines if there is no terminal for a bar.
const LINE: Duration = Duration::from_secs(1);

/// A progress display, shown until it is dropped.
pub(super) struct Progress {
    done: Arc<AtomicU64>,
    bar: ProgressBar,
    painter: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Creates a bar for `total` pixels, or steps of another kind.
    pub(super) fn new(total: u64, when: When) -> Self {
        let done = Arc::new(AtomicU64::new(0));
        let is_terminal = io::stderr().is_terminal();
        let (is_wanted, patience) = match when {
            When::Auto => (is_terminal, PATIENCE),
            When::Always => (true, Duration::ZERO),
            When::Never => (false, PATIENCE),
        };
        // The bar must exist from the start. Otherwise it would take all earlier work for that of
        // an instant and be too optimistic.
        let bar = self::bar(total);
        let painter = is_wanted.then(|| {
            let (done, bar) = (Arc::clone(&done), bar.clone());
            let tick = if is_terminal { TICK } else { LINE };
            let (stop, stopped) = mpsc::channel();
            let painter = thread::spawn(move || {
                let start = Instant::now();
                let mut is_shown = false;
                // Painting has its own thread, so that drawing only costs an addition.
                while stopped.recv_timeout(tick) == Err(RecvTimeoutError::Timeout) {
                    if start.elapsed() >= patience && !is_shown {
                        bar.set_draw_target(ProgressDrawTarget::stderr());
                        is_shown = true;
                    }
                    bar.set_position(done.load(Ordering::Relaxed));
                    if is_shown && bar.is_hidden() {
                        print_line(&bar, total);
                    }
                }
                bar.finish_and_clear();
            });
            (stop, painter)
        });
        Self { done, bar, painter }
    }

    /// Adds this many completed steps.
    pub(super) fn add(&self, count: u64) {
        self.done.fetch_add(count, Ordering::Relaxed);
    }

    /// Prints something on standard error, with the bar out of the way.
    pub(super) fn beside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Returns a function to call with the number of pixels drawn.
    pub(super) fn sink(&self) -> impl Fn(u64) + Send + Sync + use<> {
        let done = Arc::clone(&self.done);
        move |pixels| {
            done.fetch_add(pixels, Ordering::Relaxed);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((stop, painter)) = self.painter.take() {
            drop(stop);
            // If the painter has failed, only the bar is lost.
            let _ = painter.join();
        }
    }
}

fn print_line(bar: &ProgressBar, total: u64) {
    let percent = bar.position() as f64 * 100.0 / total as f64;
    let (gone, left) = (HumanDuration(bar.elapsed()), HumanDuration(bar.eta()));
    // If the reader is gone, nothing is lost.
    let _ = writeln!(io::stderr(), "{percent:>3.0}%, {gone} elapsed, {left} left");
}

/// Creates a bar that is not shown yet.
fn bar(total: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    let template = "{percent:>3}% [{wide_bar}] {elapsed} elapsed, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
