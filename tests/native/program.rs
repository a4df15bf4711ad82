//! The whole program without a window, as the page's script sees it.

use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use pinpose::app::{PinPose, Start, StartWith};
use pinpose::formats::NamedFile;
use pinpose::platform::{
    FileBytes, MemoryStorage, PageAnswer, PageCall, PageCalls, PageState, PageValue, SceneId, SceneSummary,
};

pub struct Program {
    pub harness: Harness<'static, PinPose>,
    pub calls: PageCalls,
    /// Every message that was seen: on screen they do not stay.
    pub said: Vec<String>,
}

impl Program {
    pub fn start(storage: &Rc<MemoryStorage>) -> Self {
        Self::start_with(storage, StartWith::LastOpen)
    }

    pub fn start_with(storage: &Rc<MemoryStorage>, with: StartWith) -> Self {
        let calls = PageCalls::new(Rc::new(|| {}));
        let start = Start { calls: calls.clone(), storage: storage.clone(), with };
        let harness = Harness::builder()
            .with_size([1024.0, 720.0])
            .build_eframe(|creation| PinPose::new(creation, start));
        let mut program = Self { harness, calls, said: Vec::new() };
        program.wait("it is ready", |state| !state.busy);
        program
    }

    pub fn ask(&mut self, call: PageCall) -> PageAnswer {
        let calls = self.calls.clone();
        let mut answer = pin!(async move { calls.call(call).await });
        let deadline = Instant::now() + Duration::from_secs(20);
        loop {
            if let Poll::Ready(answer) = answer.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
                return answer.unwrap();
            }
            assert!(Instant::now() < deadline, "no answer");
            self.harness.step();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    pub fn state(&mut self) -> PageState {
        match self.ask(PageCall::State) {
            PageAnswer::State(state) => {
                let new = state.notices.iter().filter(|notice| !self.said.contains(*notice)).cloned();
                let new: Vec<String> = new.collect();
                self.said.extend(new);
                state
            }
            other => panic!("{other:?}"),
        }
    }

    pub fn wait(&mut self, what: &str, is_so: impl Fn(&PageState) -> bool) -> PageState {
        let deadline = Instant::now() + Duration::from_secs(20);
        loop {
            let state = self.state();
            if is_so(&state) {
                return state;
            }
            assert!(Instant::now() < deadline, "{what}: {:?}", state.notices);
        }
    }

    pub fn load(&mut self, files: &[NamedFile]) {
        let bytes = |file: &NamedFile| FileBytes { name: file.name.clone(), bytes: file.bytes.to_vec() };
        let files = files.iter().map(bytes).collect();
        self.ask(PageCall::Load { files, poses_as: None });
        self.wait_until_saved();
    }

    pub fn wait_until_saved(&mut self) -> PageState {
        self.wait("it is saved", |state| !state.busy && state.saved)
    }

    pub fn open(&mut self, id: &SceneId) {
        self.harness.state_mut().open_scene(id.clone());
        self.wait_until_saved();
    }

    pub fn new_scene(&mut self) {
        self.harness.state_mut().new_scene();
        self.wait("it is empty", |state| !state.busy && state.photo.is_none());
    }

    /// A change that is saved, to tell by.
    pub fn set_opacity(&mut self, opacity: f64) {
        self.change_opacity(opacity);
        self.wait_until_saved();
    }

    pub fn change_opacity(&mut self, opacity: f64) {
        let value = Some(PageValue::Number(opacity));
        self.ask(PageCall::Command { name: "set_overlay_opacity".to_owned(), value });
    }

    /// The scenes as the interface lists them, once a condition is true of them.
    pub fn list(&mut self, what: &str, is_so: impl Fn(&[SceneSummary]) -> bool) -> Vec<SceneSummary> {
        self.wait(what, |_| true);
        for _ in 0..200 {
            let list = self.harness.state().scene_list().to_vec();
            if is_so(&list) {
                return list;
            }
            self.state();
        }
        panic!("{what}: {:?}", self.harness.state().scene_list());
    }

    /// An entry of the command table.
    pub fn command(&mut self, name: &str) {
        self.ask(PageCall::Command { name: name.to_owned(), value: None });
    }
}
