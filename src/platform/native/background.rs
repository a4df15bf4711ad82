//! A second thread that turns requests into replies.

use std::sync::mpsc::{Receiver, Sender, channel};

/// Requests and replies are bytes, as between a page and its worker.
pub struct Background {
    requests: Sender<(u64, Vec<u8>)>,
    replies: Receiver<(u64, Result<Vec<u8>, String>)>,
}

impl Background {
    /// `run` is called on the other thread; `wake` after each reply.
    pub fn new(run: fn(&[u8]) -> Vec<u8>, wake: impl Fn() + Send + 'static) -> Self {
        let (requests, incoming) = channel::<(u64, Vec<u8>)>();
        let (outgoing, replies) = channel();
        std::thread::spawn(move || {
            while let Ok((id, request)) = incoming.recv() {
                let reply =
                    std::panic::catch_unwind(|| run(&request)).map_err(|_| "a job crashed".to_owned());
                if outgoing.send((id, reply)).is_err() {
                    break;
                }
                wake();
            }
        });
        Self { requests, replies }
    }

    pub fn submit(&mut self, id: u64, request: Vec<u8>) {
        // The thread ends with this struct and not before.
        self.requests.send((id, request)).ok();
    }

    /// The replies that have come. An error is a crash of that one job.
    pub fn poll(&mut self) -> Vec<(u64, Result<Vec<u8>, String>)> {
        self.replies.try_iter().collect()
    }
}
