//! Results made by many threads and taken by one, in order.

use std::{
    collections::VecDeque,
    panic::{self, AssertUnwindSafe},
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

use rayon::Scope;

use crate::parallel::affinity::Core;

/// The items still to be made, shared by all threads, and the results.
///
/// No thread of a pool ever waits here: while waiting on behalf of an item that it makes, it might
/// be given this same queue to work on, and would wait for itself.
pub(super) struct Queue<I: Iterator, R> {
    state: Mutex<State<I, R>>,
    /// Wakes the thread that takes.
    ready: Condvar,
    ahead: usize,
    /// Number of threads in the pool.
    threads: usize,
    /// The core of the thread that takes.
    core: Core,
}

struct State<I: Iterator, R> {
    items: I,
    taken: usize,
    /// The results not taken yet, in the order of their items; `None` while one is being made.
    made: VecDeque<Option<thread::Result<R>>>,
    /// Number of threads that left because there was no room.
    gone: usize,
    ended: bool,
    /// Whether the thread that takes has to be woken.
    sleeps: bool,
}

/// The time for which a thread polls for a result of another before it sleeps: waking it takes
/// about as long.
const PATIENCE: Duration = Duration::from_micros(50);

impl<I: Iterator + Send, R: Send> Queue<I, R> {
    pub(super) fn new(items: I, ahead: usize, threads: usize) -> Self {
        Self {
            state: Mutex::new(State {
                items,
                taken: 0,
                made: VecDeque::new(),
                gone: 0,
                ended: false,
                sleeps: false,
            }),
            ready: Condvar::new(),
            ahead,
            threads,
            core: Core::of_this_thread(),
        }
    }

    /// Takes all items in order. They are made by `threads` threads of a scope, and by this one
    /// while no result is ready: it never waits for a thread that has not started.
    pub(super) fn run<'s, E>(
        &'s self,
        scope: &Scope<'s>,
        threads: usize,
        make: &'s (impl Fn(I::Item) -> R + Sync),
        mut take: impl FnMut(R) -> Result<(), E>,
    ) -> Result<(), E> {
        let start = || scope.spawn(move |_| self.work(make));
        (0..threads).for_each(|_| start());
        // However this function ends, the threads stop.
        let _end = End(self);
        loop {
            let mut state = self.lock();
            if let Some(result) = state.ready() {
                drop(state);
                take(result.unwrap_or_else(|panicked| panic::resume_unwind(panicked)))?;
                if self.lock().leave_room() {
                    start();
                }
            } else if let Some((number, item)) = state.next(self.ahead) {
                drop(state);
                let result = make(item);
                self.lock().put(number, Ok(result));
            } else if state.made.is_empty() {
                return Ok(());
            } else {
                drop(state);
                // Another thread is making it.
                self.wait();
            }
        }
    }

    /// Makes items until none are left or there is no room for them.
    fn work(&self, make: impl Fn(I::Item) -> R) {
        self.core.leave(self.threads);
        let mut state = self.lock();
        while let Some((number, item)) = state.next(self.ahead) {
            drop(state);
            let result = panic::catch_unwind(AssertUnwindSafe(|| make(item)));
            state = self.lock();
            state.put(number, result);
            if state.sleeps && state.is_ready() {
                self.ready.notify_one();
            }
        }
        state.gone += usize::from(!state.ended);
    }

    /// Waits until the next result is there.
    fn wait(&self) {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            if self.lock().is_ready() {
                return;
            }
            thread::yield_now();
        }
        let mut state = self.lock();
        state.sleeps = true;
        let is_missing = |state: &mut State<I, R>| !state.is_ready();
        let state = self.ready.wait_while(state, is_missing);
        state.unwrap_or_else(PoisonError::into_inner).sleeps = false;
    }
}

impl<I: Iterator, R> Queue<I, R> {
    fn lock(&self) -> MutexGuard<'_, State<I, R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<I: Iterator, R> State<I, R> {
    /// Returns the next item and its number, if there is one and room for it.
    fn next(&mut self, ahead: usize) -> Option<(usize, I::Item)> {
        if self.ended || self.made.len() >= ahead {
            return None;
        }
        let Some(item) = self.items.next() else {
            self.ended = true;
            return None;
        };
        let number = self.taken + self.made.len();
        self.made.push_back(None);
        Some((number, item))
    }

    fn put(&mut self, number: usize, result: thread::Result<R>) {
        if let Some(made) = self.made.get_mut(number - self.taken) {
            *made = Some(result);
        }
    }

    fn is_ready(&self) -> bool {
        self.made.front().is_some_and(Option::is_some)
    }

    /// Returns the next result, if it is there.
    fn ready(&mut self) -> Option<thread::Result<R>> {
        self.made.front_mut()?.take()
    }

    /// Counts a result as taken. Returns true if a thread that left for want of room can return.
    fn leave_room(&mut self) -> bool {
        self.made.pop_front();
        self.taken += 1;
        let somebody_has_gone = self.gone > 0;
        self.gone -= usize::from(somebody_has_gone);
        somebody_has_gone
    }
}

struct End<'a, I: Iterator, R>(&'a Queue<I, R>);

impl<I: Iterator, R> Drop for End<'_, I, R> {
    fn drop(&mut self) {
        self.0.lock().ended = true;
    }
}
