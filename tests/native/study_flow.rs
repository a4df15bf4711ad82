//! Taking part in the example study with the real program: every screen, a reload in the middle of a trial, and what comes out.

use std::path::PathBuf;
use std::rc::Rc;

use egui::{Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pinpose::app::{StartWith, StudyLink};
use pinpose::formats::read_document;
use pinpose::platform::{MemoryStorage, PageAnswer, PageCall, SceneId, Storage as _};
use pinpose::study::{EventKind, Participation, RESULTS_SCHEMA};

use crate::program::Program;
use crate::studies::{check_schema, example_pack};

/// The example as a file, for a window takes studies from files.
fn study_file(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("pinpose-{}-{name}.zip", std::process::id()));
    std::fs::write(&path, example_pack().zip().unwrap()).unwrap();
    path
}

struct Visit {
    program: Program,
    file: PathBuf,
}

impl Drop for Visit {
    fn drop(&mut self) {
        // Another visit may have removed it already.
        std::fs::remove_file(&self.file).ok();
    }
}

impl Visit {
    fn start(storage: &Rc<MemoryStorage>, name: &str) -> Self {
        let file = study_file(name);
        let link = StudyLink { study: file.to_string_lossy().into_owned() };
        let mut visit = Self { program: Program::start_with(storage, StartWith::Study(link)), file };
        visit.wait("participant");
        let harness = &mut visit.program.harness;
        harness.get_by_label("Participant id").click();
        harness.run_steps(2);
        harness.get_by_label("Participant id").type_text("P1");
        harness.run_steps(2);
        visit.click("Continue");
        visit
    }

    fn harness(&mut self) -> &mut Harness<'static, pinpose::app::PinPose> {
        &mut self.program.harness
    }

    fn screen(&mut self) -> &'static str {
        self.program.state().study.unwrap()
    }

    fn wait(&mut self, screen: &str) {
        self.program.wait(screen, |state| state.study == Some(screen));
    }

    fn click(&mut self, label: &str) {
        self.harness().get_by_label(label).click_accesskit();
        self.harness().run_steps(3);
    }

    fn point(&mut self, call: PageCall) -> Pos2 {
        match self.program.ask(call) {
            PageAnswer::Point { x, y } => Pos2::new(x as f32, y as f32),
            other => panic!("{other:?}"),
        }
    }

    /// Drags the object a little, once it is on screen.
    fn drag(&mut self) {
        let center = {
            let state = self.program.state();
            let [x, y, width, height] = state.viewport.map(|side| side as f32);
            Pos2::new(x + width / 2.0, y + height / 2.0)
        };
        let harness = self.harness();
        let mut step = |event| {
            harness.input_mut().events.push(event);
            harness.run_steps(1);
        };
        let button = |pos, pressed| egui::Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        step(egui::Event::PointerMoved(center));
        step(button(center, true));
        step(egui::Event::PointerMoved(center + egui::vec2(20.0, 10.0)));
        step(egui::Event::PointerMoved(center + egui::vec2(40.0, 20.0)));
        step(button(center + egui::vec2(40.0, 20.0), false));
        harness.run_steps(3);
    }

    /// Waits for the photo, moves the object and confirms.
    fn work(&mut self) {
        self.move_object();
        self.click("Confirm");
    }

    /// Drags until something has moved: before the photo is there, nothing does.
    fn move_object(&mut self) {
        for _ in 0..200 {
            self.harness().run_steps(1);
            self.drag();
            if !self.harness().get_by_label("Confirm").accesskit_node().is_disabled() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
    }

    fn go_to_first_trial(&mut self) {
        self.wait("consent");
        self.click("I have read this and agree to take part");
        self.click("Agree and continue");
        assert_eq!(self.screen(), "questions");
        self.click("A few times");
        self.click("Continue");
        assert_eq!(self.screen(), "instructions");
        self.click("Start practice");
        self.wait("practice");
        self.work();
        assert_eq!(self.screen(), "feedback");
        self.click("Continue");
        assert_eq!(self.screen(), "begin");
        self.click("Start");
        self.wait("trial");
    }

    fn refused(&mut self, call: PageCall) -> String {
        let calls = self.program.calls.clone();
        let mut answer = std::pin::pin!(async move { calls.call(call).await });
        for _ in 0..1000 {
            let mut context = std::task::Context::from_waker(std::task::Waker::noop());
            if let std::task::Poll::Ready(answer) = answer.as_mut().poll(&mut context) {
                return answer.unwrap_err();
            }
            self.program.harness.step();
        }
        panic!("no answer")
    }
}

/// The participation as it is kept, once it is as expected.
fn kept(visit: &mut Visit, storage: &MemoryStorage, is_so: impl Fn(&Participation) -> bool) -> Participation {
    for _ in 0..400 {
        visit.harness().run_steps(1);
        std::thread::sleep(std::time::Duration::from_millis(5));
        let list = pollster::block_on(storage.list()).unwrap();
        let id: Option<SceneId> = list.first().map(|summary| summary.id.clone());
        let saved = id.and_then(|id| pollster::block_on(storage.load(&id)).unwrap());
        let participation = saved.and_then(|saved| Participation::from_json(&saved.json));
        if let Some(participation) = participation.filter(&is_so) {
            return participation;
        }
    }
    panic!("not kept")
}

#[test]
fn a_participant_goes_through_the_example_with_a_reload_in_a_trial() {
    let storage = Rc::new(MemoryStorage::default());
    let mut visit = Visit::start(&storage, "flow");
    visit.go_to_first_trial();
    visit.work();
    visit.wait("trial");
    visit.move_object();
    visit.drag();
    let before = kept(&mut visit, &storage, |one| {
        one.results.trials.len() == 1 && one.trial().is_some_and(pinpose::study::RunningTrial::has_gesture)
    });
    drop(visit);

    // The page comes back in the same trial, with the object where it was.
    let mut visit = Visit::start(&storage, "flow-again");
    visit.wait("trial");
    let document = {
        let state = visit.program.wait("the photo is there", |state| state.photo.is_some());
        read_document(state.document_json.as_bytes()).unwrap()
    };
    assert_eq!(document.pose_count(), 1);
    visit.work();
    assert_eq!(visit.screen(), "rest");
    visit.click("Continue");
    visit.work();
    visit.work();
    assert_eq!(visit.screen(), "questionnaire");
    visit.click("Continue");
    visit.harness().get_by_label("Please answer the marked questions");
    for scale in ["mental", "physical", "temporal", "performance", "effort", "frustration"] {
        visit.click(&format!("{scale} 7"));
    }
    visit.click("Continue");
    visit.click("sus1 4");
    visit.click("Continue");
    assert_eq!(visit.screen(), "finish");
    visit.harness().get_by_label("TABLE-42");

    let done = kept(&mut visit, &storage, |one| one.results.finished_at.is_some());
    let results = &done.results;
    check_schema(RESULTS_SCHEMA, &results.to_json());
    assert_eq!((results.trials.len(), results.practice.len(), results.questionnaires.len()), (4, 1, 2));
    let reopened = &results.trials[1];
    assert!(reopened.events.iter().any(|event| event.kind == EventKind::Reopened));
    assert!(reopened.gestures.values().sum::<u32>() >= 2, "{:?}", reopened.gestures);
    assert_eq!(reopened.events[1].pose, before.trial().unwrap().events()[1].pose);
    for trial in &results.trials {
        let last = trial.events.iter().rev().find_map(|event| event.pose().map(Result::unwrap)).unwrap();
        assert_eq!(last, trial.final_pose.to_pose().unwrap(), "the events lead to the final pose");
        assert!(trial.time_s > 0.0 && trial.events[0].kind == EventKind::Shown);
    }
    assert_eq!(results.questionnaires[0].scores["raw"], 7.0);
    assert_eq!(results.questionnaires[1].scores["missing"], 9.0);

    visit.click("Remove it");
    visit.harness().run_steps(3);
    assert!(pollster::block_on(storage.list()).unwrap().is_empty(), "nothing is left in this browser");
}

#[test]
fn what_is_not_part_of_a_trial_is_refused() {
    let storage = Rc::new(MemoryStorage::default());
    let mut visit = Visit::start(&storage, "refusals");
    visit.go_to_first_trial();
    let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 500.0], [0.0, 0.0, 0.0, 1.0]];
    let set = PageCall::SetPose { photo: 1, object: 2, camera_from_object: rows };
    assert!(visit.refused(set).contains("setPose"));
    for name in ["import_poses", "export_workspace", "back_to_reference", "focal_from_pins", "new_scene"] {
        let said = visit.refused(PageCall::Command { name: name.to_owned(), value: None });
        assert!(said.contains("not p"), "{name}: {said}");
    }
    let load = PageCall::Load { files: Vec::new(), poses_as: Some("reference".to_owned()) };
    assert!(visit.refused(load).contains("study"));
    let scenes = pollster::block_on(storage.list()).unwrap();
    let listed = visit.program.harness.state().scene_list().len();
    assert!(listed == 0 && scenes.len() <= 1, "a participation is no scene");
}

#[test]
fn time_stands_still_while_paused_and_the_photo_is_hidden() {
    let storage = Rc::new(MemoryStorage::default());
    let mut visit = Visit::start(&storage, "pause");
    visit.go_to_first_trial();
    visit.move_object();
    visit.click("Pause");
    visit.harness().get_by_label("Paused");
    assert_eq!(visit.program.state().viewport, [0.0; 4], "the photo is not to be seen");
    std::thread::sleep(std::time::Duration::from_millis(300));
    visit.click("Go on");
    let _ = visit.point(PageCall::PageFromImage { u: 0.0, v: 0.0 });
    visit.click("Confirm");
    let one = kept(&mut visit, &storage, |one| one.results.trials.len() == 1);
    let trial = &one.results.trials[0];
    // The pause was 0.3 s long, and its frames a little more.
    assert!((0.3..3.0).contains(&trial.paused_s), "{}", trial.paused_s);
    assert_eq!(one.results.pauses.len(), 1);
}
