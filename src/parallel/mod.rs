//! Threads, cancellation, progress and timings: the only module that uses rayon.

mod affinity;
mod in_order;
pub(crate) mod reader;
pub(crate) mod timings;

use std::{
    cell::Cell,
    convert::Infallible,
    fmt, fs, io, iter,
    num::NonZero,
    path::{Path, PathBuf},
    process,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use rayon::{ThreadPool, ThreadPoolBuilder};

use self::{affinity::Core, in_order::Queue};
pub use timings::{Stage, Timings};

use crate::diagnostic::error::{Error, ErrorKind};

/// Threads that work together.
pub(crate) enum Pool {
    /// The calling thread only.
    Calling,
    /// The calling thread and the threads shared by the process, one per core.
    Process(&'static ThreadPool),
    /// The calling thread and the pool's own threads.
    Own(ThreadPool),
}

impl Pool {
    /// Creates a pool of `threads` threads, at most [`most_threads`]. `None` and 0 return the pool
    /// of the process, which has one thread per core. There are fewer threads if the system refuses
    /// that many.
    pub(crate) fn new(threads: Option<usize>) -> Self {
        let others = match threads {
            None | Some(0) => return Self::of_process(),
            Some(threads) => threads.min(most_threads()) - 1,
        };
        match start(others) {
            Some(pool) => {
                let threads = pool.current_num_threads() + 1;
                // A new thread may start on the core of the thread that created it. It can move to
                // another core at once only while that thread waits.
                let core = Core::of_this_thread();
                pool.broadcast(|_| core.leave(threads));
                Self::Own(pool)
            }
            None => Self::Calling,
        }
    }

    fn of_process() -> Self {
        static SHARED: Shared = Shared(Mutex::new(None));
        let pool = SHARED.of(process::id());
        pool.map_or(Self::Calling, Self::Process)
    }

    /// Returns the number of threads.
    pub(crate) fn threads(&self) -> usize {
        match self {
            Self::Calling => 1,
            Self::Process(pool) => pool.current_num_threads(),
            Self::Own(pool) => pool.current_num_threads() + 1,
        }
    }

    /// Applies `of` to each item on all threads and returns the results in order.
    pub(crate) fn map<T: Send, R: Send>(
        &self,
        items: impl IntoIterator<Item = T, IntoIter: Send>,
        of: impl Fn(T) -> R + Sync,
    ) -> Vec<R> {
        let mut all = Vec::new();
        let Ok(()) = self.in_order(items, usize::MAX, of, |made| {
            all.push(made);
            Ok::<_, Infallible>(())
        });
        all
    }

    /// Applies `make` to each item on all threads and `take` to each result on the calling thread,
    /// in order.
    ///
    /// At most `ahead` items are being made or waiting to be taken. The calling thread is one of
    /// the threads, and makes items while there is no result to take. Stops at the first error of
    /// `take`.
    ///
    /// What `make` does in its turn by any pool is done by its own thread alone: it may be what all
    /// other threads wait for, say a tree that is built once, and none of them would be left to work.
    pub(crate) fn in_order<T: Send, R: Send, E>(
        &self,
        items: impl IntoIterator<Item = T, IntoIter: Send>,
        ahead: usize,
        make: impl Fn(T) -> R + Sync,
        mut take: impl FnMut(R) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut items = items.into_iter();
        // Waking a thread costs as much time as some work does.
        let others = items
            .size_hint()
            .1
            .map_or(usize::MAX, |most| most.saturating_sub(1));
        let pool = match self {
            Self::Own(pool) if others > 0 && !Making::is_one() => pool,
            Self::Process(pool) if others > 0 && !Making::is_one() => pool,
            _ => return items.try_for_each(|item| take(make(item))),
        };
        let threads = self.threads();
        let make = &|item| {
            let _making = Making::begin();
            make(item)
        };
        let queue = Queue::new(items, ahead, threads);
        let others = others.min(threads - 1);
        pool.in_place_scope(|scope| queue.run(scope, others, make, take))
    }
}

/// While it lives, its thread makes an item for others.
struct Making;

thread_local! {
    static MAKING: Cell<bool> = const { Cell::new(false) };
}

impl Making {
    fn begin() -> Self {
        MAKING.set(true);
        Self
    }

    fn is_one() -> bool {
        MAKING.get()
    }
}

impl Drop for Making {
    fn drop(&mut self) {
        MAKING.set(false);
    }
}

/// The pool of a process, with the id of the process. A forked child has a copy of it, but none of its
/// threads, and would wait for them forever: it starts its own.
struct Shared(Mutex<Option<(u32, Option<&'static ThreadPool>)>>);

impl Shared {
    /// Returns the pool of the process with this id, which is that of the caller; `None` if the system
    /// allows no threads.
    fn of(&self, process: u32) -> Option<&'static ThreadPool> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, pool)) = known.filter(|(owner, _)| *owner == process) {
            return pool;
        }
        let pool = start(cores()).map(|pool| {
            let core = Core::of_this_thread();
            pool.broadcast(|all| core.leave(all.num_threads()));
            // That of a parent cannot be dropped: it would wait for its threads.
            &*Box::leak(Box::new(pool))
        });
        *known = Some((process, pool));
        pool
    }
}

/// Returns the number of cores available to this process. It is determined once, as this reads
/// several system files.
fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, NonZero::get))
}

/// Returns the maximum number of threads to start. More threads than cores gain nothing, and
/// threads that look for work in vain slow down the others.
fn most_threads() -> usize {
    const FEW: usize = 16;
    FEW.max(4 * cores())
}

/// Starts a pool of `threads` threads, or of as many as the system allows; `None` if it allows
/// none.
///
/// If the threads left no memory for work, the program would abort on its next allocation.
fn start(threads: usize) -> Option<ThreadPool> {
    /// Bytes for the stack of a thread and for the data of its allocator.
    const THREAD: usize = 3 << 20;
    let fewer = iter::successors(Some(threads), |threads| Some(threads / 2));
    let mut fewer = fewer.take_while(|threads| *threads > 0);
    fewer.find_map(|threads| {
        if !has_memory(threads * THREAD + LEAST_MEMORY) {
            return None;
        }
        ThreadPoolBuilder::new().num_threads(threads).build().ok()
    })
}

/// The minimum memory for any work, in bytes. It is more than 32 MiB: for smaller blocks, glibc
/// takes the size of a freed block as the measure of what to keep, and each later allocation costs
/// more.
const LEAST_MEMORY: usize = 33 << 20;

/// Returns true if the system would allocate this many bytes.
fn has_memory(bytes: usize) -> bool {
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}

/// Checks that there is enough memory to work with. If memory runs out later, the program may
/// abort.
///
/// # Errors
///
/// Too little memory ([`ErrorKind::Unavailable`]).
pub fn check_memory() -> Result<(), Error> {
    if has_memory(LEAST_MEMORY) {
        return Ok(());
    }
    let most = LEAST_MEMORY >> 20;
    let message = format!("not enough memory; at least {most} MiB are needed");
    Err(Error::new(ErrorKind::Unavailable, message))
}

/// Applies `make` to each item on `threads` threads and `take` to each result on the calling
/// thread, in the order of the items.
///
/// 0 threads means one per core. At most `ahead` items are being made or waiting to be taken, so
/// that memory use does not grow with their number.
///
/// # Errors
///
/// The first error of `take`; no more items are made after it.
///
/// # Examples
///
/// ```
/// let mut all = Vec::new();
/// let take = |square| {
///     all.push(square);
///     Ok::<_, strahl::Error>(())
/// };
/// strahl::parallel::in_order(1..5, 0, 8, |item: u32| item * item, take)?;
/// assert_eq!(all, [1, 4, 9, 16]);
/// # Ok::<(), strahl::Error>(())
/// ```
pub fn in_order<T: Send, R: Send, E: From<Error>>(
    items: impl IntoIterator<Item = T, IntoIter: Send>,
    threads: usize,
    ahead: usize,
    make: impl Fn(T) -> R + Sync,
    take: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    Pool::new((threads > 0).then_some(threads)).in_order(items, ahead, make, take)
}

/// Returns the number of threads of a [`Pool`] created with `threads`, if the system does not
/// refuse them.
pub(crate) fn thread_count(threads: Option<usize>) -> usize {
    threads.map_or_else(cores, |threads| threads.min(most_threads()))
}

/// Stops work from another thread, or from a Ctrl-C handler.
///
/// Clones share one state. Once cancelled, a call under this handle removes what it has begun to
/// write and returns an error of the kind [`ErrorKind::Interrupted`].
///
/// # Examples
///
/// ```
/// use strahl::{ErrorKind, RenderOptions, Scene, parallel::Cancel};
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
    /// Returns a handle that is not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Cancels all work under this handle and removes its unfinished files immediately: a process
    /// may exit as soon as this returns.
    pub fn cancel(&self) {
        let mut unfinished = self.unfinished();
        self.0.cancelled.store(true, Ordering::Relaxed);
        for path in unfinished.drain(..) {
            // The file may already be gone.
            let _ = fs::remove_file(path);
        }
    }

    /// Returns true once cancelled.
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

    /// Calls `create`, which creates a file to be removed on cancellation. It is never called while
    /// another thread cancels, nor after cancellation.
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

    /// Calls `finish`, which completes or removes a file of [`Cancel::begin_file`]. It is never
    /// called while another thread cancels.
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

/// A callback that receives the number of units of work just done. It is called from any thread.
#[derive(Clone)]
pub(crate) struct OnProgress(Arc<dyn Fn(u64) + Send + Sync>);

impl OnProgress {
    pub(crate) fn new(of_units: impl Fn(u64) + Send + Sync + 'static) -> Self {
        Self(Arc::new(of_units))
    }

    pub(crate) fn add(&self, units: u64) {
        (self.0)(units);
    }
}

impl fmt::Debug for OnProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("OnProgress")
    }
}

#[cfg(test)]
mod tests {
    use std::{
        panic::{self, AssertUnwindSafe},
        ptr,
        sync::atomic::AtomicUsize,
        thread,
        time::Duration,
    };

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn items_are_consumed_in_order_and_only_a_few_wait() {
        const AHEAD: usize = 5;
        for threads in [None, Some(1), Some(3)] {
            let pool = Pool::new(threads);
            let (made, caller) = (AtomicUsize::new(0), thread::current().id());
            let mut taken = 0;
            let make = |item: usize| {
                made.fetch_add(1, Ordering::SeqCst);
                item * item
            };
            let take = |square| {
                assert_eq!(thread::current().id(), caller);
                assert!(made.load(Ordering::SeqCst) <= taken + AHEAD);
                assert_eq!(square, taken * taken);
                taken += 1;
                Ok::<_, ()>(())
            };
            pool.in_order(0..1000, AHEAD, make, take).unwrap();
            assert_eq!(taken, 1000);
        }
    }

    #[test]
    fn zero_threads_means_all() {
        let all = Pool::new(None).threads();
        assert_eq!(Pool::new(Some(0)).threads(), all);
        for threads in [1, 2, 5] {
            assert_eq!(Pool::new(Some(threads)).threads(), threads);
        }
    }

    #[test]
    fn a_forked_process_starts_threads_of_its_own() {
        let shared = Shared(Mutex::new(None));
        let [parent, again, child, later] = [1, 1, 2, 2].map(|id| shared.of(id).unwrap());
        assert!(ptr::eq(parent, again) && ptr::eq(child, later));
        assert!(!ptr::eq(parent, child));
        let sums = [parent, child].map(|pool| Pool::Process(pool).map(0..99, |item| item));
        assert!(sums.iter().all(|items| items.iter().sum::<u32>() == 4851));
    }

    #[test]
    fn production_stops_once_consumption_has_failed() {
        for threads in [Some(1), Some(3)] {
            let pool = Pool::new(threads);
            let made = AtomicUsize::new(0);
            let make = |_| made.fetch_add(1, Ordering::SeqCst);
            let mut left = 5;
            let take = |_| {
                left -= 1;
                if left > 0 { Ok(()) } else { Err("full") }
            };
            assert_eq!(pool.in_order(0.., 8, make, take), Err("full"));
            assert!(made.into_inner() < 5 + 8);
        }
    }

    #[test]
    fn panics_are_passed_on() {
        let pool = Pool::new(Some(2));
        let run = |make: fn(u32) -> u32, take: fn(u32) -> Result<(), ()>| {
            let run = || pool.in_order(0..100, 4, make, take);
            let panicked = panic::catch_unwind(AssertUnwindSafe(run)).unwrap_err();
            *panicked.downcast::<&str>().unwrap()
        };
        assert_eq!(run(|_| panic!("the maker"), |_| Ok(())), "the maker");
        assert_eq!(run(|item| item, |_| panic!("the taker")), "the taker");
    }

    #[test]
    fn threads_of_a_pool_may_wait_for_it() {
        // There are more callers than threads: if each only waited, no thread would be left to
        // work.
        let sum = |outer: &u64| {
            let mut sum = 0;
            let take = |item| {
                sum += item;
                Ok::<_, ()>(())
            };
            let pool = Pool::new(None);
            pool.in_order(0..50, 4, |item| item * outer, take).unwrap();
            sum
        };
        let callers: Vec<u64> = (0..40 * rayon::current_num_threads() as u64).collect();
        let sums: Vec<u64> = callers.par_iter().map(sum).collect();
        assert!(
            sums.into_iter()
                .eq(callers.iter().map(|outer| 1225 * outer))
        );
    }

    #[test]
    fn items_can_be_produced_in_order() {
        // A thread that waits for the inner items may be given the outer queue, which has no room
        // until these are done.
        let pool = Pool::new(Some(4));
        for _ in 0..200 {
            let inner = |outer: u32| {
                let mut sum = 0;
                let take = |item| {
                    sum += item;
                    Ok::<_, ()>(())
                };
                pool.in_order(0..20, 2, |item| item * outer, take).unwrap();
                sum
            };
            let mut sums = Vec::new();
            let take = |sum| {
                sums.push(sum);
                Ok::<_, ()>(())
            };
            pool.in_order(0..30, 2, inner, take).unwrap();
            assert!(sums.into_iter().eq((0..30).map(|outer| 190 * outer)));
        }
    }

    #[test]
    fn all_threads_may_wait_for_what_one_of_them_builds() {
        let pool = Pool::new(Some(3));
        for _ in 0..200 {
            let built = OnceLock::new();
            let build = || pool.map(0..100, |item| item).into_iter().sum::<u32>();
            let sums = pool.map(0..30, |_| *built.get_or_init(build));
            assert_eq!(sums, [4950; 30]);
        }
    }

    #[test]
    fn a_calling_thread_that_sleeps_is_woken() {
        let (pool, caller) = (Pool::new(Some(2)), thread::current().id());
        let make = |item: u32| {
            if thread::current().id() != caller {
                thread::sleep(Duration::from_millis(2));
            }
            item
        };
        let mut taken = Vec::new();
        let take = |item| {
            taken.push(item);
            Ok::<_, ()>(())
        };
        pool.in_order(0..50, 2, make, take).unwrap();
        assert!(taken.into_iter().eq(0..50));
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
