//! Calls from the page's script and their answers, as plain data: `api` turns them into JavaScript, `app` answers them.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use futures_channel::oneshot;

use super::{FileBytes, Wake};

/// One call of `window.pinpose`.
#[derive(Debug, Clone, PartialEq)]
pub enum PageCall {
    /// Resolves when the program answers calls.
    Ready,
    /// What a drop does. `poses_as`: "annotations" or "reference", else the user is asked.
    Load {
        files: Vec<FileBytes>,
        poses_as: Option<String>,
    },
    State,
    SetPose {
        photo: u32,
        object: u32,
        camera_from_object: [[f64; 4]; 4],
    },
    /// An entry of the command table, or one of the few that take a value.
    Command {
        name: String,
        value: Option<PageValue>,
    },
    PageFromImage {
        u: f64,
        v: f64,
    },
    ImageFromPage {
        x: f64,
        y: f64,
    },
    Pick {
        x: f64,
        y: f64,
    },
    Widgets,
    Render {
        photo: Option<u32>,
        kind: String,
        object: Option<u32>,
    },
    Perf,
}

/// The argument of a command.
#[derive(Debug, Clone, PartialEq)]
pub enum PageValue {
    Number(f64),
    Boolean(bool),
    Text(String),
}

#[derive(Debug, Clone, PartialEq)]
pub enum PageAnswer {
    Nothing,
    State(PageState),
    Point { x: f64, y: f64 },
    Picked(Option<Picked>),
    Widgets(Vec<Widget>),
    Bytes(Vec<u8>),
    Loaded(Loaded),
    Perf(Perf),
}

/// The scene in our own format, and what is around it.
#[derive(Debug, Clone, PartialEq)]
pub struct PageState {
    pub document_json: String,
    pub photo: Option<u32>,
    pub selected: Option<u32>,
    pub tool: &'static str,
    /// Of the photo view: physical pixels per photo pixel, and the point of the photo in the middle of the viewport.
    pub zoom: f64,
    pub center: [f64; 2],
    /// In CSS pixels: x, y, width, height.
    pub viewport: [f64; 4],
    /// Of the scene view; all 0 where it is not on screen.
    pub scene_viewport: [f64; 4],
    /// "photo", "scene" or "split".
    pub arrangement: &'static str,
    pub panels: bool,
    pub busy: bool,
    pub saved: bool,
    pub question: Option<&'static str>,
    pub notices: Vec<String>,
    /// Of somebody who takes part in a study: which screen is shown.
    pub study: Option<&'static str>,
}

/// A surface point under a place of the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picked {
    pub object: u32,
    pub face: u32,
    pub point_object_mm: [f64; 3],
    pub depth_mm: f64,
}

/// One widget of the interface, in CSS pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Widget {
    pub id: u64,
    pub label: String,
    pub role: String,
    pub value: String,
    pub enabled: bool,
    pub visible: bool,
    /// x, y, width, height.
    pub rect: [f64; 4],
}

/// What became of a load: how many files were taken, and what was said of the others.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loaded {
    pub files: u32,
    pub problems: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Perf {
    pub backend: String,
    pub frames: u64,
    /// Of the frames since the last call.
    pub cpu_median_ms: f64,
    pub cpu_p95_ms: f64,
    /// Of the scene's passes, since the last call.
    pub uploaded_bytes: u64,
    pub draw_calls: u64,
    pub triangles: u64,
    pub wasm_bytes: f64,
    pub memory_bytes: f64,
    pub start_ms: f64,
}

pub type PageReply = oneshot::Sender<Result<PageAnswer, String>>;

/// The way from the page to the program: calls wait here until the program looks.
#[derive(Clone)]
pub struct PageCalls {
    waiting: Rc<RefCell<VecDeque<(PageCall, PageReply)>>>,
    wake: Wake,
}

impl PageCalls {
    pub fn new(wake: Wake) -> Self {
        Self { waiting: Rc::default(), wake }
    }

    /// Puts a call in line; an error is a sentence for the caller.
    pub async fn call(&self, call: PageCall) -> Result<PageAnswer, String> {
        let (reply, answer) = oneshot::channel();
        self.waiting.borrow_mut().push_back((call, reply));
        (self.wake)();
        answer.await.unwrap_or_else(|_| Err("PinPose was closed before it could answer".to_owned()))
    }

    /// The next call, if there is one.
    pub fn take(&self) -> Option<(PageCall, PageReply)> {
        self.waiting.borrow_mut().pop_front()
    }
}
