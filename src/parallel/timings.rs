//! The time taken by each stage of the work.

use std::{
    cell::Cell,
    fmt,
    io::{self, Seek, SeekFrom, Write},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use crate::diagnostic::named::named;

named! {
    /// A stage on the way from a scene file to a picture.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Stage {
        /// From opening the file to the model.
        Read = "read",
        /// Validation of the model.
        Check = "check",
        /// Everything that does not depend on the camera and the size: the world and its colors as
        /// bytes.
        Build = "build",
        /// From the camera to the geometries that each pixel sees.
        Trace = "trace",
        /// From there to the bytes of the file.
        Encode = "encode",
        /// Passing the bytes to the system, up to the finished file.
        Write = "write",
    }
}

/// The time spent in each [`Stage`].
///
/// Clones share one state, and times add up. Overlapping stages each count in full, so their sum
/// can exceed the elapsed time.
///
/// # Examples
///
/// ```
/// use strahl::{RenderOptions, Scene, parallel::Stage};
///
/// let scene = Scene::from_path("scenes/sphere.ron")?;
/// let options = RenderOptions::new().timings(scene.timings().clone());
/// scene.render_with(&options)?;
/// for stage in Stage::ALL {
///     println!("{}: {:?}", stage.name(), scene.timings().of(*stage));
/// }
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Timings(Arc<[AtomicU64; Stage::ALL.len()]>);

impl Timings {
    /// Returns timings with zero time in each stage.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the time spent in a stage so far.
    pub fn of(&self, stage: Stage) -> Duration {
        Duration::from_nanos(self.0[stage as usize].load(Ordering::Relaxed))
    }

    /// Adds other timings, such as those of one scene to a total.
    pub fn include(&self, other: &Self) {
        for stage in Stage::ALL {
            self.add(*stage, other.of(*stage));
        }
    }

    /// Returns a watch for one thread.
    pub(crate) fn watch(&self) -> Watch<'_> {
        Watch {
            timings: self,
            stage: Cell::new(None),
            since: Cell::new(Instant::now()),
        }
    }

    /// Returns a watch for several threads.
    pub(crate) fn shared_watch(&self, stage: Stage) -> SharedWatch<'_> {
        SharedWatch {
            timings: self,
            stage,
            working: Mutex::new((0, Instant::now())),
        }
    }

    fn add(&self, stage: Stage, time: Duration) {
        let nanos = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.0[stage as usize].fetch_add(nanos, Ordering::Relaxed);
    }
}

impl fmt::Debug for Timings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times = Stage::ALL
            .iter()
            .map(|stage| (stage.name(), self.of(*stage)));
        f.debug_map().entries(times).finish()
    }
}

/// Measures the work of one thread: one stage at a time, or none.
pub(crate) struct Watch<'a> {
    timings: &'a Timings,
    stage: Cell<Option<Stage>>,
    since: Cell<Instant>,
}

impl Watch<'_> {
    /// Times the work of a stage. While that calls for work of another stage, measured by the same
    /// watch, this stage does not count.
    pub(crate) fn time<T>(&self, stage: Stage, work: impl FnOnce() -> T) -> T {
        self.during(Some(stage), work)
    }

    /// Waits for another thread; this time counts for no stage.
    pub(crate) fn wait<T>(&self, wait: impl FnOnce() -> T) -> T {
        self.during(None, wait)
    }

    /// Returns a writer whose work counts as [`Stage::Write`].
    pub(crate) fn writer<W>(&self, writer: W) -> Timed<'_, W> {
        Timed {
            watch: self,
            writer,
        }
    }

    fn during<T>(&self, stage: Option<Stage>, work: impl FnOnce() -> T) -> T {
        let outer = self.switch(stage);
        let result = work();
        self.switch(outer);
        result
    }

    fn switch(&self, next: Option<Stage>) -> Option<Stage> {
        let now = Instant::now();
        let since = self.since.replace(now);
        let stage = self.stage.replace(next);
        if let Some(stage) = stage {
            self.timings.add(stage, now - since);
        }
        stage
    }
}

/// Measures a stage shared by several threads: the time during which at least one of them works.
pub(crate) struct SharedWatch<'a> {
    timings: &'a Timings,
    stage: Stage,
    /// Number of working threads, and the time since which at least one has been working.
    working: Mutex<(usize, Instant)>,
}

impl SharedWatch<'_> {
    /// Times some work of the stage.
    pub(crate) fn time<T>(&self, work: impl FnOnce() -> T) -> T {
        let lock = || self.working.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let mut working = lock();
        if working.0 == 0 {
            working.1 = now;
        }
        working.0 += 1;
        drop(working);
        let result = work();
        let now = Instant::now();
        let mut working = lock();
        working.0 -= 1;
        if working.0 == 0 {
            self.timings
                .add(self.stage, now.saturating_duration_since(working.1));
        }
        result
    }
}

/// A writer that is timed, see [`Watch::writer`].
pub(crate) struct Timed<'a, W> {
    watch: &'a Watch<'a>,
    writer: W,
}

impl<W: Write> Write for Timed<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.watch.time(Stage::Write, || self.writer.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.watch.time(Stage::Write, || self.writer.flush())
    }
}

impl<W: Seek> Seek for Timed<'_, W> {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.watch.time(Stage::Write, || self.writer.seek(place))
    }
}

#[cfg(test)]
mod tests {
    use std::thread::{self, sleep};

    use super::*;

    const STEP: Duration = Duration::from_millis(20);

    #[test]
    fn a_stage_is_paused_while_another_runs() {
        let timings = Timings::new();
        let watch = timings.watch();
        let start = Instant::now();
        watch.time(Stage::Encode, || {
            sleep(STEP);
            watch.time(Stage::Write, || sleep(2 * STEP));
            watch.wait(|| sleep(3 * STEP));
            sleep(STEP);
        });
        let (encode, write) = (timings.of(Stage::Encode), timings.of(Stage::Write));
        assert!(encode >= 2 * STEP && write >= 2 * STEP);
        // Whatever else the machine does, waiting counts for no stage.
        assert!(encode + write + 3 * STEP <= start.elapsed());
        assert_eq!(timings.of(Stage::Trace), Duration::ZERO);
    }

    #[test]
    fn simultaneous_work_of_threads_counts_once() {
        let timings = Timings::new();
        let watch = timings.shared_watch(Stage::Trace);
        let start = Instant::now();
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| watch.time(|| sleep(2 * STEP)));
            }
        });
        sleep(STEP);
        watch.time(|| sleep(STEP));
        let trace = timings.of(Stage::Trace);
        assert!(trace >= 3 * STEP && trace + STEP <= start.elapsed());
    }

    #[test]
    fn clones_share_their_times() {
        let timings = Timings::new();
        timings.clone().add(Stage::Read, STEP);
        timings.add(Stage::Read, STEP);
        assert_eq!(timings.of(Stage::Read), 2 * STEP);
    }

    #[test]
    fn a_writer_is_timed() {
        let (timings, mut bytes) = (Timings::new(), Vec::new());
        timings
            .watch()
            .writer(&mut bytes)
            .write_all(b"abc")
            .unwrap();
        assert_eq!(bytes, b"abc");
        assert!(timings.of(Stage::Write) > Duration::ZERO);
    }

    #[test]
    fn stages_are_in_their_order() {
        for (place, stage) in Stage::ALL.iter().enumerate() {
            assert_eq!(*stage as usize, place);
        }
    }
}
