//! Files of a folder or an archive, read a few at a time, so that the page goes on.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use crate::formats::Archive;
use crate::platform::{self, FileTree};

/// A browser reads several files in the time of one.
const MOST_IN_FLIGHT: usize = 16;
/// A part of a frame: what is read at once (from a disk, out of a zip) goes on in the next one.
const SLICE_MS: f64 = 50.0;

/// Where files come from.
#[derive(Clone)]
pub enum Source {
    Folder(Rc<dyn FileTree>),
    Zip(Rc<RefCell<Archive>>),
}

/// What was read of one file, by its path; an error is a sentence without it.
pub type Read = (String, Result<Arc<[u8]>, String>);

/// Files on their way in. Those that are not begun when this is dropped are not read.
pub struct Reading {
    source: Source,
    shared: Rc<Shared>,
    ctx: egui::Context,
}

#[derive(Default)]
struct Shared {
    waiting: RefCell<VecDeque<String>>,
    in_flight: Cell<usize>,
    done: RefCell<Vec<Read>>,
    is_beginning: Cell<bool>,
}

impl Reading {
    pub fn new(source: Source, paths: impl IntoIterator<Item = String>, ctx: &egui::Context) -> Self {
        let shared = Shared { waiting: RefCell::new(paths.into_iter().collect()), ..Shared::default() };
        let reading = Self { source, shared: Rc::new(shared), ctx: ctx.clone() };
        ctx.request_repaint();
        reading
    }

    /// Is everything read and taken?
    pub fn is_done(&self) -> bool {
        let Shared { waiting, in_flight, done, .. } = &*self.shared;
        waiting.borrow().is_empty() && in_flight.get() == 0 && done.borrow().is_empty()
    }

    /// Once a frame: reads on, and gives what was read since the last time.
    pub fn take(&self) -> Vec<Read> {
        let until_ms = platform::now_ms() + SLICE_MS;
        match &self.source {
            Source::Folder(tree) => begin(&self.shared, tree, &self.ctx, until_ms),
            Source::Zip(archive) => unpack(&self.shared, archive, until_ms),
        }
        if !self.shared.waiting.borrow().is_empty() {
            self.ctx.request_repaint();
        }
        self.shared.done.take()
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        self.shared.waiting.borrow_mut().clear();
    }
}

fn unpack(shared: &Shared, archive: &RefCell<Archive>, until_ms: f64) {
    while platform::now_ms() < until_ms {
        let Some(path) = shared.waiting.borrow_mut().pop_front() else { return };
        let read = archive.borrow_mut().read(&path).map_err(|error| error.to_string());
        shared.done.borrow_mut().push((path, read));
    }
}

/// Begins to read as many as may be under way. What is there at once is done when this returns, and the next ones are begun;
/// what takes its time begins the next one itself.
fn begin(shared: &Rc<Shared>, tree: &Rc<dyn FileTree>, ctx: &egui::Context, until_ms: f64) {
    shared.is_beginning.set(true);
    while shared.in_flight.get() < MOST_IN_FLIGHT && platform::now_ms() < until_ms {
        let Some(path) = shared.waiting.borrow_mut().pop_front() else { break };
        shared.in_flight.set(shared.in_flight.get() + 1);
        let (shared, tree, ctx) = (shared.clone(), tree.clone(), ctx.clone());
        platform::spawn(async move {
            let read = tree.read(&path).await.map(Arc::from);
            shared.done.borrow_mut().push((path, read));
            shared.in_flight.set(shared.in_flight.get() - 1);
            if !shared.is_beginning.get() {
                begin(&shared, &tree, &ctx, f64::INFINITY);
            }
            ctx.request_repaint();
        });
    }
    shared.is_beginning.set(false);
}
