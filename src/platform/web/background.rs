//! A Web Worker that loads the same wasm and turns requests into replies.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use js_sys::{Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;

use super::{describe, page_create_worker};

type Replies = Rc<RefCell<VecDeque<(u64, Result<Vec<u8>, String>)>>>;

/// Requests and replies are bytes. A job that crashes takes its worker with it: a fresh one does the rest.
pub struct Background {
    worker: Option<Running>,
    replies: Replies,
    wake: Rc<dyn Fn()>,
    /// Sent and not yet answered, oldest first.
    open: Vec<(u64, Vec<u8>)>,
}

struct Running {
    worker: web_sys::Worker,
    _on_message: Closure<dyn Fn(web_sys::MessageEvent)>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.worker.terminate();
    }
}

impl Background {
    /// `run` is what the worker calls by itself, through the page's exports; `wake` is called after each reply.
    pub fn new(_run: fn(&[u8]) -> Vec<u8>, wake: impl Fn() + 'static) -> Self {
        Self { worker: None, replies: Rc::default(), wake: Rc::new(wake), open: Vec::new() }
    }

    pub fn submit(&mut self, id: u64, request: Vec<u8>) {
        self.send(id, &request);
        self.open.push((id, request));
    }

    /// The replies that have come. An error is a crash of that one job.
    pub fn poll(&mut self) -> Vec<(u64, Result<Vec<u8>, String>)> {
        let replies: Vec<_> = self.replies.borrow_mut().drain(..).collect();
        let crashed = replies.iter().any(|(_, reply)| reply.is_err());
        self.open.retain(|(id, _)| !replies.iter().any(|(answered, _)| answered == id));
        if crashed {
            self.worker = None;
            for (id, request) in self.open.clone() {
                self.send(id, &request);
            }
        }
        replies
    }

    fn send(&mut self, id: u64, request: &[u8]) {
        let sent = self.running().and_then(|running| {
            let message = Object::new();
            Reflect::set(&message, &"id".into(), &JsValue::from_f64(id as f64))?;
            Reflect::set(&message, &"request".into(), &Uint8Array::from(request))?;
            running.worker.post_message(&message)
        });
        if let Err(error) = sent {
            self.replies.borrow_mut().push_back((id, Err(describe(&error))));
            (self.wake)();
        }
    }

    fn running(&mut self) -> Result<&Running, JsValue> {
        match &mut self.worker {
            Some(running) => Ok(running),
            worker => {
                let started = start(self.replies.clone(), self.wake.clone())?;
                Ok(worker.insert(started))
            }
        }
    }
}

fn start(replies: Replies, wake: Rc<dyn Fn()>) -> Result<Running, JsValue> {
    let worker = page_create_worker()?;
    let on_message = Closure::<dyn Fn(web_sys::MessageEvent)>::new(move |event: web_sys::MessageEvent| {
        let data = event.data();
        let field = |name: &str| Reflect::get(&data, &name.into()).unwrap_or(JsValue::UNDEFINED);
        let Some(id) = field("id").as_f64() else { return };
        let reply = match field("reply").dyn_into::<Uint8Array>() {
            Ok(reply) => Ok(reply.to_vec()),
            Err(_) => Err(field("crash").as_string().unwrap_or_else(|| "a job crashed".to_owned())),
        };
        replies.borrow_mut().push_back((id as u64, reply));
        wake();
    });
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    Ok(Running { worker, _on_message: on_message })
}
