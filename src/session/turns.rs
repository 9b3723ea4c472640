//! Turns: the checks of many sessions, one after another.

use std::{
    collections::VecDeque,
    io,
    panic::{self, AssertUnwindSafe},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
};

use super::Shared;

/// The turns of sessions that check one after another, on one thread. Clones are the same turns.
#[derive(Clone, Debug, Default)]
pub struct Turns(Arc<Mutex<Queue>>);

/// The sessions that wait for a turn.
#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Arc<Shared>>,
    /// True while a thread gives turns.
    is_running: bool,
}

impl Turns {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives a session a turn after those that wait, on a thread that ends with the last turn.
    ///
    /// # Errors
    ///
    /// Fails if no thread can be started; the session then does not wait.
    pub(super) fn give(&self, session: Arc<Shared>) -> io::Result<()> {
        let mut queue = self.queue();
        queue.waiting.push_back(session);
        if queue.is_running {
            return Ok(());
        }
        let turns = self.clone();
        let thread = thread::Builder::new().name("check".to_owned());
        let started = thread.spawn(move || turns.run());
        match &started {
            Ok(_) => queue.is_running = true,
            Err(_) => drop(queue.waiting.pop_back()),
        }
        started.map(drop)
    }

    fn run(&self) {
        while let Some(session) = self.next() {
            // A fault of one check must not cost the others their turns.
            let _ = panic::catch_unwind(AssertUnwindSafe(|| session.turn()));
        }
    }

    fn next(&self) -> Option<Arc<Shared>> {
        let mut queue = self.queue();
        let next = queue.waiting.pop_front();
        queue.is_running = next.is_some();
        next
    }
}

#[cfg(test)]
mod tests {
    use std::{
        io,
        path::{Path, PathBuf},
        sync::{
            Mutex,
            mpsc::{self, Receiver, Sender},
        },
        time::Duration,
    };

    use crate::{
        scene::{
            files::{Content, Files, Memory},
            options::ReadOptions,
        },
        session::{Session, Turns},
        text::syntax::Syntax,
    };

    /// Enough for any machine; a test that succeeds does not wait that long.
    const PATIENCE: Duration = Duration::from_secs(20);

    /// A disk that tells when a table is asked for, and answers as soon as it may.
    #[derive(Debug)]
    struct Slow {
        asked: Sender<()>,
        may: Mutex<Receiver<()>>,
    }

    impl Files for Slow {
        fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
            let _ = self.asked.send(());
            let _ = self.may.lock().unwrap().recv();
            Memory::new().resolve(path)
        }

        fn length(&self, path: &Path) -> io::Result<Option<u64>> {
            Memory::new().length(path)
        }

        fn open(&self, path: &Path) -> io::Result<Content> {
            Memory::new().open(path)
        }
    }

    const TABLE: &str = "(camera: 1, geometries: [Spheres(file: \"a.csv\")])";

    #[test]
    fn a_session_ends_at_once_though_its_check_is_stuck_and_the_next_one_has_its_turn() {
        let (asked, is_stuck) = mpsc::channel();
        let (go_on, may) = mpsc::channel::<()>();
        let may = Mutex::new(may);
        let turns = Turns::default();
        let (checked, results) = mpsc::channel();
        let start = |name: &'static str, text: &str, options: ReadOptions| {
            let checked = checked.clone();
            let options = options.syntax(Syntax::Ron);
            Session::of_findings(name, text, options, &turns, move |_| {
                checked.send(name).unwrap();
            })
            .unwrap()
        };
        let slow = ReadOptions::new().files(Slow { asked, may });
        let stuck = start("stuck", TABLE, slow);
        is_stuck.recv_timeout(PATIENCE).unwrap();
        let others = ["a", "b", "c"].map(|name| start(name, "(", ReadOptions::new()));
        drop(stuck);
        assert!(results.try_recv().is_err());
        drop(go_on);
        for name in ["a", "b", "c"] {
            assert_eq!(results.recv_timeout(PATIENCE), Ok(name));
        }
        // A turn later, on another thread.
        others[1].replace("(camera: 1)");
        assert_eq!(results.recv_timeout(PATIENCE), Ok("b"));
    }

    #[test]
    fn a_check_that_panics_does_not_cost_the_others_their_turns() {
        let turns = Turns::default();
        let (checked, results) = mpsc::channel();
        let options = ReadOptions::new().syntax(Syntax::Ron);
        let start = |panics: bool| {
            let checked = checked.clone();
            Session::of_findings("a", "(", options.clone(), &turns, move |_| {
                checked.send(panics).unwrap();
                assert!(!panics, "a fault of the program");
            })
            .unwrap()
        };
        let _first = start(true);
        let _second = start(false);
        assert_eq!(results.recv_timeout(PATIENCE), Ok(true));
        assert_eq!(results.recv_timeout(PATIENCE), Ok(false));
    }
}
