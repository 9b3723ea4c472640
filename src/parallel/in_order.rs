//! Results made by many threads and taken by one, in order.

use std::{
    collections::BTreeMap,
    iter::Enumerate,
    panic::{self, AssertUnwindSafe},
    sync::{
        Mutex, MutexGuard, PoisonError,
        mpsc::{self, Receiver, Sender, TryRecvError},
    },
    thread,
    time::{Duration, Instant},
};

use rayon::Scope;

use crate::parallel::affinity::Core;

/// The items still to be made, shared by all threads.
///
/// No thread of a pool ever waits here: while waiting on behalf of an item that it makes, it might
/// be given this same queue to work on, and would wait for itself.
pub(super) struct Queue<I: Iterator> {
    state: Mutex<State<I>>,
    ahead: usize,
    /// Number of threads in the pool.
    threads: usize,
    /// The core of the thread that takes.
    core: Core,
}

struct State<I: Iterator> {
    items: Enumerate<I>,
    started: usize,
    taken: usize,
    /// Number of threads that left because there was no room.
    gone: usize,
    ended: bool,
}

/// The time for which a thread polls for a result of another before it sleeps: waking it takes
/// about as long.
const PATIENCE: Duration = Duration::from_micros(50);

/// The number of an item and its result.
type Made<R> = (usize, thread::Result<R>);

impl<I: Iterator + Send> Queue<I> {
    pub(super) fn new(items: I, ahead: usize, threads: usize) -> Self {
        Self {
            state: Mutex::new(State {
                items: items.enumerate(),
                started: 0,
                taken: 0,
                gone: 0,
                ended: false,
            }),
            ahead,
            threads,
            core: Core::of_this_thread(),
        }
    }

    /// Takes all items in order. They are made by `threads` threads of a scope, and by this one
    /// while no result is ready: it never waits for a thread that has not started.
    pub(super) fn run<'s, R: Send + 's, E>(
        &'s self,
        scope: &Scope<'s>,
        threads: usize,
        make: &'s (impl Fn(I::Item) -> R + Sync),
        mut take: impl FnMut(R) -> Result<(), E>,
    ) -> Result<(), E> {
        let (sender, others) = mpsc::channel();
        let start = || {
            let sender = sender.clone();
            scope.spawn(move |_| self.work(make, &sender));
        };
        (0..threads).for_each(|_| start());
        // However this function ends, the threads stop.
        let _end = End(self);
        let mut made = BTreeMap::new();
        for next in 0.. {
            let result = loop {
                made.extend(others.try_iter());
                if let Some(result) = made.remove(&next) {
                    break result.unwrap_or_else(|panicked| panic::resume_unwind(panicked));
                }
                let mut state = self.lock();
                let item = state.next(self.ahead);
                let started = state.started;
                drop(state);
                match item {
                    Some((number, item)) if number == next => break make(item),
                    Some((number, item)) => {
                        made.insert(number, Ok(make(item)));
                    }
                    None if started == next => return Ok(()),
                    // Another thread is making it.
                    None => made.extend(receive(&others)),
                }
            };
            take(result)?;
            let mut state = self.lock();
            state.taken += 1;
            let somebody_has_gone = state.gone > 0;
            state.gone -= usize::from(somebody_has_gone);
            drop(state);
            if somebody_has_gone {
                start();
            }
        }
        Ok(())
    }

    /// Makes items until none are left or there is no room for them.
    fn work<R>(&self, make: impl Fn(I::Item) -> R, made: &Sender<Made<R>>) {
        self.core.leave(self.threads);
        loop {
            let mut state = self.lock();
            let Some((number, item)) = state.next(self.ahead) else {
                state.gone += usize::from(!state.ended);
                return;
            };
            drop(state);
            let result = panic::catch_unwind(AssertUnwindSafe(|| make(item)));
            // After `take` has failed, the receiver is gone.
            let _ = made.send((number, result));
        }
    }
}

impl<I: Iterator> Queue<I> {
    fn lock(&self) -> MutexGuard<'_, State<I>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<I: Iterator> State<I> {
    /// Returns the next item, if there is one and room for it.
    fn next(&mut self, ahead: usize) -> Option<(usize, I::Item)> {
        if self.ended || self.started - self.taken >= ahead {
            return None;
        }
        let item = self.items.next();
        self.started += usize::from(item.is_some());
        self.ended |= item.is_none();
        item
    }
}

/// Returns the next result of another thread, or `None` if no other thread is left.
fn receive<T>(others: &Receiver<T>) -> Option<T> {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        match others.try_recv() {
            Ok(made) => return Some(made),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) => thread::yield_now(),
        }
    }
    others.recv().ok()
}

struct End<'a, I: Iterator>(&'a Queue<I>);

impl<I: Iterator> Drop for End<'_, I> {
    fn drop(&mut self) {
        self.0.lock().ended = true;
    }
}
