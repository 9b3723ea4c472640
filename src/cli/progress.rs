//! A bar on the terminal while a picture is being drawn.

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

/// When to show a bar.
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

/// Work that lasts less than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the bar is painted.
const TICK: Duration = Duration::from_millis(100);
/// How often a line is written where there is no terminal for a bar.
const LINE: Duration = Duration::from_secs(1);

/// Shows how far the work is until it is dropped.
pub(super) struct Progress {
    done: Arc<AtomicU64>,
    bar: ProgressBar,
    painter: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// A bar for so many pixels, or steps of another kind.
    pub(super) fn new(total: u64, when: When) -> Self {
        let done = Arc::new(AtomicU64::new(0));
        let shown = match when {
            When::Auto => io::stderr().is_terminal(),
            When::Always => true,
            When::Never => false,
        };
        // It has to see the work from its beginning: it would take all that was done before it
        // came for the work of an instant, and promise too much.
        let bar = self::bar(total);
        let painter = shown.then(|| {
            let (done, bar) = (Arc::clone(&done), bar.clone());
            let patience = if when == When::Auto {
                PATIENCE
            } else {
                Duration::ZERO
            };
            let tick = if io::stderr().is_terminal() {
                TICK
            } else {
                LINE
            };
            let (stop, stopped) = mpsc::channel();
            let painter = thread::spawn(move || {
                let start = Instant::now();
                let mut is_shown = false;
                // Paints from a thread of its own, so that drawing pays for a sum alone.
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

    /// So much more has been done.
    pub(super) fn add(&self, count: u64) {
        self.done.fetch_add(count, Ordering::Relaxed);
    }

    /// Prints something on standard error, where the bar would be in its way.
    pub(super) fn beside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// What is to be told of every pixel drawn.
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
            // A painter that has failed takes nothing but the bar with it.
            let _ = painter.join();
        }
    }
}

fn print_line(bar: &ProgressBar, total: u64) {
    let percent = bar.position() as f64 * 100.0 / total as f64;
    let (gone, left) = (HumanDuration(bar.elapsed()), HumanDuration(bar.eta()));
    // A reader that is gone misses nothing.
    let _ = writeln!(io::stderr(), "{percent:>3.0}%, {gone} gone, {left} left");
}

/// A bar that is not shown yet.
fn bar(total: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    let template = "{percent:>3}% [{wide_bar}] {elapsed} gone, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
