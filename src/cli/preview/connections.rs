//! The connections to the page. Any program of this machine can open one, so those without the token
//! must not keep the others out.

use std::{
    collections::VecDeque,
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::{net::TcpListener, task::AbortHandle, time};

/// The longest time for the headers of a request, and between two requests.
const PATIENCE: Duration = Duration::from_secs(30);
/// The number of connections that have not shown the token; of more, the oldest is closed.
const STRANGERS: usize = 64;
/// The pause after a connection that could not be accepted, such as for lack of file descriptors.
const PAUSE: Duration = Duration::from_millis(100);

/// True once a request of the connection had the token.
#[derive(Clone, Debug, Default)]
pub(super) struct Trusted(Arc<AtomicBool>);

impl Trusted {
    /// Notes that a request had the token.
    pub(super) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A connection that has not shown the token yet.
struct Stranger {
    known: Trusted,
    task: AbortHandle,
}

/// Answers requests for ever. Fails if the listener cannot be used.
pub(super) async fn serve(listener: std::net::TcpListener, router: Router) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let listener = TcpListener::from_std(listener)?;
    let mut server = http1::Builder::new();
    let server = server
        .timer(TokioTimer::new())
        .header_read_timeout(PATIENCE);
    let mut strangers = VecDeque::<Stranger>::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            time::sleep(PAUSE).await;
            continue;
        };
        strangers.retain(|other| !other.known.is_set() && !other.task.is_finished());
        if strangers.len() >= STRANGERS
            && let Some(oldest) = strangers.pop_front()
        {
            oldest.task.abort();
        }
        let known = Trusted::default();
        let service = TowerToHyperService::new(router.clone().layer(Extension(known.clone())));
        let served = server.serve_connection(TokioIo::new(stream), service);
        let task = tokio::spawn(async move {
            // Whoever broke the connection knows that.
            let _ = served.await;
        });
        let task = task.abort_handle();
        strangers.push_back(Stranger { known, task });
    }
}
