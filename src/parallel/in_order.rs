//! Things made by many threads and taken by one, in their order.

use std::{
    collections::BTreeMap,
    iter::Enumerate,
    panic::{self, AssertUnwindSafe},
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, Sender},
    },
    thread,
};

use rayon::Scope;

/// The items that are still to be made, which all threads take from.
pub(super) struct Queue<I: Iterator> {
    state: Mutex<State<I>>,
    /// Somebody waits here once `ahead` items are made and not taken.
    room: Condvar,
    ahead: usize,
}

struct State<I: Iterator> {
    items: Enumerate<I>,
    started: usize,
    taken: usize,
    ended: bool,
}

/// What became of an item.
type Made<R> = (usize, thread::Result<R>);

impl<I: Iterator> Queue<I> {
    pub(super) fn new(items: I, ahead: usize) -> Self {
        Self {
            state: Mutex::new(State {
                items: items.enumerate(),
                started: 0,
                taken: 0,
                ended: false,
            }),
            room: Condvar::new(),
            ahead,
        }
    }

    /// Lets so many threads of a scope make items.
    pub(super) fn hand_out<'s, R: Send + 's>(
        &'s self,
        scope: &Scope<'s>,
        threads: usize,
        make: &'s (impl Fn(I::Item) -> R + Sync),
        made: Sender<Made<R>>,
    ) where
        I: Send,
    {
        for _ in 0..threads {
            let made = made.clone();
            scope.spawn(move |_| self.work(make, &made));
        }
    }

    /// Makes items until there are none left.
    fn work<R>(&self, make: impl Fn(I::Item) -> R, made: &Sender<Made<R>>) {
        loop {
            let mut state = self.lock();
            while state.started - state.taken == self.ahead && !state.ended {
                state = self
                    .room
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner);
            }
            let Some((number, item)) = state.next() else {
                return;
            };
            drop(state);
            let result = panic::catch_unwind(AssertUnwindSafe(|| make(item)));
            // Nobody listens any more once taking has failed.
            let _ = made.send((number, result));
        }
    }

    /// Takes all that others make, in its order, and makes items as well where none is there to
    /// be taken: it is never waited for a thread that has not begun.
    pub(super) fn take<R, E>(
        &self,
        make: impl Fn(I::Item) -> R,
        others: &Receiver<Made<R>>,
        mut take: impl FnMut(R) -> Result<(), E>,
    ) -> Result<(), E> {
        // However this ends, those who wait for room do not wait for ever.
        let _end = End(self);
        let mut made = BTreeMap::new();
        for next in 0.. {
            let result = loop {
                made.extend(others.try_iter());
                if let Some(result) = made.remove(&next) {
                    break result.unwrap_or_else(|panicked| panic::resume_unwind(panicked));
                }
                let mut state = self.lock();
                let item = if state.started - next < self.ahead {
                    state.next()
                } else {
                    None
                };
                let started = state.started;
                drop(state);
                match item {
                    Some((number, item)) if number == next => break make(item),
                    Some((number, item)) => {
                        made.insert(number, Ok(make(item)));
                    }
                    None if started == next => return Ok(()),
                    // Another thread is making it.
                    None => made.extend(others.recv()),
                }
            };
            take(result)?;
            let mut state = self.lock();
            state.taken += 1;
            if state.started - state.taken == self.ahead - 1 {
                self.room.notify_all();
            }
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, State<I>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<I: Iterator> State<I> {
    fn next(&mut self) -> Option<(usize, I::Item)> {
        let item = self.items.next().filter(|_| !self.ended);
        self.started += usize::from(item.is_some());
        item
    }
}

struct End<'a, I: Iterator>(&'a Queue<I>);

impl<I: Iterator> Drop for End<'_, I> {
    fn drop(&mut self) {
        self.0.lock().ended = true;
        self.0.room.notify_all();
    }
}
