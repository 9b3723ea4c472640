//! Threads, cancelling and progress: the only place that names rayon.

use std::{
    fmt, fs, io, panic,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread,
};

use rayon::{ThreadPool, ThreadPoolBuilder, prelude::*};

use crate::error::{Error, ErrorKind};

/// Threads that work on one thing together.
pub(crate) enum Pool {
    /// Only the thread that calls.
    Calling,
    /// Those of the process: one for each core.
    Process,
    /// Its own.
    Own(ThreadPool),
}

impl Pool {
    /// A pool of so many threads; `None` takes the one of the process, which has a thread for
    /// each core.
    pub(crate) fn new(threads: Option<usize>) -> Result<Self, Error> {
        let threads = match threads {
            None => return Ok(Self::Process),
            Some(1) => return Ok(Self::Calling),
            Some(threads) => threads,
        };
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(Self::Own).map_err(|error| {
            let message = format!("cannot start {threads} threads");
            Error::new(ErrorKind::Unavailable, message).caused_by(error)
        })
    }

    /// How many threads it has.
    pub(crate) fn threads(&self) -> usize {
        match self {
            Self::Calling => 1,
            Self::Process => rayon::current_num_threads(),
            Self::Own(pool) => pool.current_num_threads(),
        }
    }

    /// Calls `fill` for each chunk of `items`, with the index of the chunk's first item, on all
    /// threads; stops early, with an error, once `cancel` is.
    pub(crate) fn fill<T: Send>(
        &self,
        items: &mut [T],
        chunk: usize,
        cancel: &Cancel,
        fill: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<(), Error> {
        let work = |(index, items): (usize, &mut [T])| {
            fill(index * chunk, items);
            cancel.check()
        };
        if matches!(self, Self::Calling) {
            return items.chunks_mut(chunk).enumerate().try_for_each(work);
        }
        self.install(|| {
            let chunks = items.par_chunks_mut(chunk).enumerate();
            chunks.try_for_each(work)
        })
    }

    /// What `of` makes of each item, in their order, on all threads.
    pub(crate) fn map<T: Send, R: Send>(
        &self,
        items: impl IntoIterator<Item = T>,
        of: impl Fn(T) -> R + Sync,
    ) -> Vec<R> {
        let items = items.into_iter();
        if matches!(self, Self::Calling) {
            return items.map(of).collect();
        }
        let items: Vec<T> = items.collect();
        self.install(|| items.into_par_iter().map(&of).collect())
    }

    /// Does work on a thread of the pool, so that what it gives to the others need not be handed
    /// over first, each time.
    pub(crate) fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match self {
            Self::Own(pool) => pool.install(work),
            Self::Process => rayon::scope(|_| work()),
            Self::Calling => work(),
        }
    }
}

/// How many threads a [`Pool`] of so many has.
pub(crate) fn thread_count(threads: Option<usize>) -> usize {
    threads.unwrap_or_else(rayon::current_num_threads)
}

/// How many items of [`pipe`] may wait to be taken.
const WAITING: usize = 2;

/// Hands an item over.
pub(crate) type Hand<'a, T> = &'a mut (dyn FnMut(T) -> Result<(), Error> + Send);

/// Makes items on a thread of its own and takes them, in their order, on the calling thread.
///
/// `make` hands each item to what it is given, which waits while the taker is behind, so that
/// only a few are there at any time. The taker need not be able to change its thread, such as the lock
/// of standard output. Where `take` fails, handing over fails as well and `make` should end;
/// the error is that of `take`.
pub(crate) fn pipe<T: Send>(
    make: impl FnOnce(Hand<T>) -> Result<(), Error> + Send,
    take: impl FnMut(T) -> Result<(), Error>,
) -> Result<(), Error> {
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::sync_channel(WAITING);
        // The sender goes with its thread, and with it the taker's last wait.
        let make = move || {
            make(&mut |item| {
                let sent = sender.send(item);
                sent.map_err(|_| Error::interrupted())
            })
        };
        let maker = thread::Builder::new().spawn_scoped(scope, make);
        let maker = maker.map_err(|error| {
            Error::new(ErrorKind::Unavailable, "cannot start a thread").caused_by(error)
        })?;
        // The receiver is gone when this is done, for whatever reason: nobody hands over in vain.
        let taken = receiver.into_iter().try_for_each(take);
        match maker.join() {
            Ok(made) => taken.and(made),
            Err(panicked) => panic::resume_unwind(panicked),
        }
    })
}

/// Stops work from another thread, or from a handler of Ctrl-C.
///
/// Clones share one state. Once cancelled, a call that works under it removes what it has begun
/// to write and returns an error of the kind [`ErrorKind::Interrupted`].
///
/// # Examples
///
/// ```
/// use strahl::{Cancel, ErrorKind, RenderOptions, Scene};
///
/// let scene = Scene::from_path("scenes/sphere.ron")?;
/// let cancel = Cancel::new();
/// cancel.cancel();
/// let options = RenderOptions::new().cancel(cancel);
/// assert_eq!(scene.render_with(&options).unwrap_err().kind(), ErrorKind::Interrupted);
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Cancel(Arc<State>);

#[derive(Default)]
struct State {
    cancelled: AtomicBool,
    unfinished: Mutex<Vec<PathBuf>>,
}

impl Cancel {
    /// Nothing is cancelled yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Cancels all work under this and removes its unfinished files, at once: a process may
    /// exit as soon as this returns.
    pub fn cancel(&self) {
        let mut unfinished = self.unfinished();
        self.0.cancelled.store(true, Ordering::Relaxed);
        for path in unfinished.drain(..) {
            // Already gone is as good.
            let _ = fs::remove_file(path);
        }
    }

    /// Whether somebody has cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        if self.is_cancelled() {
            Err(Error::interrupted())
        } else {
            Ok(())
        }
    }

    /// Calls `create`, which makes a file that must go if the work is cancelled; never while
    /// another thread cancels, and not at all once one has.
    pub(crate) fn begin_file<T>(
        &self,
        create: impl FnOnce() -> io::Result<(T, PathBuf)>,
    ) -> Result<io::Result<T>, Error> {
        let mut unfinished = self.unfinished();
        self.check()?;
        Ok(create().map(|(file, path)| {
            unfinished.push(path);
            file
        }))
    }

    /// Calls `finish`, which completes or removes a file of [`Cancel::begin_file`]; never while
    /// another thread cancels.
    pub(crate) fn end_file<T>(&self, path: &Path, finish: impl FnOnce() -> T) -> T {
        let mut unfinished = self.unfinished();
        let result = finish();
        unfinished.retain(|file| file != path);
        result
    }

    fn unfinished(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.0
            .unfinished
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Cancel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Cancel").field(&self.is_cancelled()).finish()
    }
}

/// Is told how many units of work have just been done; called from any thread.
pub(crate) type OnProgress = Arc<dyn Fn(u64) + Send + Sync>;

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::*;

    #[test]
    fn every_chunk_is_filled_once() {
        for threads in [None, Some(1), Some(3)] {
            let mut items = vec![0; 1000];
            let pool = Pool::new(threads).unwrap();
            let number = |first: usize, items: &mut [usize]| {
                for (offset, item) in items.iter_mut().enumerate() {
                    *item += first + offset;
                }
            };
            pool.fill(&mut items, 7, &Cancel::new(), number).unwrap();
            assert!(items.iter().copied().eq(0..1000));
        }
    }

    #[test]
    fn items_come_in_their_order_and_only_a_few_wait() {
        let made = AtomicUsize::new(0);
        let mut taken = Vec::new();
        let make = |hand: Hand<usize>| {
            (0..100).try_for_each(|item| {
                made.store(item, Ordering::SeqCst);
                hand(item)
            })
        };
        let take = |item| {
            // One more is in the maker's hand.
            assert!(made.load(Ordering::SeqCst) <= item + WAITING + 1);
            taken.push(item);
            Ok(())
        };
        pipe(make, take).unwrap();
        assert!(taken.into_iter().eq(0..100));
    }

    #[test]
    fn a_pipe_ends_when_either_side_fails() {
        let fail = |kind| Error::new(kind, "it fails");
        let endless = |hand: Hand<u32>| loop {
            hand(1)?;
        };
        let mut left = 5;
        let take = |_| {
            left -= 1;
            if left > 0 {
                Ok(())
            } else {
                Err(fail(ErrorKind::Unavailable))
            }
        };
        let kind = pipe(endless, take).unwrap_err().kind();
        assert_eq!(kind, ErrorKind::Unavailable, "not that of the maker");

        let make = |hand: Hand<u32>| {
            hand(1)?;
            Err(fail(ErrorKind::Scene))
        };
        let kind = pipe(make, |_| Ok(())).unwrap_err().kind();
        assert_eq!(kind, ErrorKind::Scene);
    }

    #[test]
    fn a_pipe_passes_panics_on() {
        let endless = |hand: Hand<u32>| loop {
            hand(1)?;
        };
        let taker = panic::catch_unwind(|| pipe(endless, |_| panic!("the taker")));
        assert_eq!(*taker.unwrap_err().downcast::<&str>().unwrap(), "the taker");
        let make = |_: Hand<u32>| panic!("the maker");
        let maker = panic::catch_unwind(|| pipe(make, |_| Ok(())));
        assert_eq!(*maker.unwrap_err().downcast::<&str>().unwrap(), "the maker");
    }

    #[test]
    fn cancelled_work_stops_with_an_error() {
        let cancel = Cancel::new();
        cancel.cancel();
        let done = Pool::Process.fill(&mut [0; 9], 1, &cancel, |_, _| ());
        assert_eq!(done.unwrap_err().kind(), ErrorKind::Interrupted);
    }

    #[test]
    fn cancelling_removes_unfinished_files_only() {
        let folder = tempfile::tempdir().unwrap();
        let (done, open) = (folder.path().join("done"), folder.path().join("open"));
        let cancel = Cancel::new();
        for path in [&done, &open] {
            let create = || fs::write(path, "x").map(|()| ((), path.clone()));
            cancel.begin_file(create).unwrap().unwrap();
        }
        cancel.end_file(&done, || ());
        cancel.cancel();
        assert!(done.exists() && !open.exists());
    }
}
