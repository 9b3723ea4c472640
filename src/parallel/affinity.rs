//! The core that a thread runs on, so that two threads that work together do not share one.
//!
//! Linux wakes a thread on the core where it last ran. If the waking thread goes on working on that
//! core, the woken one may wait there for milliseconds while other cores are idle.

/// A core, on systems that report it.
#[derive(Clone, Copy)]
pub(super) struct Core(#[cfg(target_os = "linux")] usize);

impl Core {
    /// Returns the core that this thread runs on.
    pub(super) fn of_this_thread() -> Self {
        Self(
            #[cfg(target_os = "linux")]
            rustix::thread::sched_getcpu(),
        )
    }

    /// Moves this thread to another core if it runs on this one; `threads` is the number of threads
    /// that work together. The system may move it back at any time. With more threads than cores it
    /// does nothing, as there is nothing to gain.
    pub(super) fn leave(self, threads: usize) {
        #[cfg(target_os = "linux")]
        {
            use rustix::thread::{sched_getaffinity, sched_getcpu, sched_setaffinity};

            if sched_getcpu() != self.0 {
                return;
            }
            let Ok(all) = sched_getaffinity(None) else {
                return;
            };
            let mut others = all;
            others.unset(self.0);
            if all.count() as usize >= threads.max(2) && sched_setaffinity(None, &others).is_ok() {
                // This restores the previous set, so it cannot fail either.
                let _ = sched_setaffinity(None, &all);
            }
        }
        #[cfg(not(target_os = "linux"))]
        let _ = threads;
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::thread;

    use rustix::thread::sched_getaffinity;

    use super::Core;

    #[test]
    fn a_thread_leaves_a_core_and_may_return() {
        let leave = |threads| {
            let before = Core::of_this_thread();
            before.leave(threads);
            Core::of_this_thread().0 != before.0
        };
        thread::scope(|scope| {
            scope.spawn(|| {
                let all = sched_getaffinity(None).unwrap();
                // The system might move it back at once, but not every time.
                let has_left = (0..100).any(|_| leave(2));
                assert_eq!(has_left, all.count() > 1);
                leave(1000);
                assert_eq!(sched_getaffinity(None).unwrap(), all);
            });
        });
    }
}
