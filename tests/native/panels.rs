//! The interface without a window: what is on screen, and what it asks for when it is used.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pinpose::formats::PosesAs;
use pinpose::interact::Hands;
use pinpose::session::{Command, CommandId, Session};
use pinpose::ui::{self, Saving, Surroundings, UiState};

use crate::support::{CAMERA_JSON, NOW_MS, drop_files, small_session, text_file};

/// A session behind the interface; commands are applied as the program does it.
fn harness(session: Session) -> (Harness<'static>, Rc<RefCell<Session>>) {
    let session = Rc::new(RefCell::new(session));
    let shared = session.clone();
    let mut state = UiState::default();
    let harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let around = Surroundings {
            hands: &Hands::default(),
            renderer: None,
            pixels: None,
            saving: Saving::Saved,
            busy: None,
            update_ready: false,
            files_hover: false,
        };
        let asked = ui::draw(ui, &shared.borrow(), &around, &mut state);
        for command in asked.commands {
            shared.borrow_mut().apply(command, NOW_MS).unwrap();
        }
    });
    (harness, session)
}

#[test]
fn an_empty_scene_says_what_to_do() {
    let (mut harness, _) = harness(Session::default());
    harness.run();
    for text in
        ["Drop your files here", "A photo", "A 3D mesh of the object", "Open files…", "Try the example"]
    {
        harness.get_by_label(text);
    }
}

#[test]
fn the_pose_is_shown_and_can_be_undone_by_button() {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let pose = annotation.camera_from_object.translated(glam::DVec3::new(0.0, 0.0, 12.5));
    let source = pinpose::scene::PoseSource::Manual;
    session.apply(Command::SetPose { photo, object, camera_from_object: pose, source }, NOW_MS).unwrap();
    let (mut harness, session) = harness(session);
    harness.run();
    let depth = format!("{:.2}", pose.translation_mm.z);
    harness.get_by_label_contains(&depth);
    harness.get_by_label("box: posed");
    harness.get_by_label("Undo").click();
    harness.run();
    harness.get_by_label("box: not posed yet, drag it");
    assert!(session.borrow().unavailable(CommandId::Redo).is_none());
}

#[test]
fn a_ground_truth_is_asked_about_in_words() {
    let mut session = small_session();
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n");
    drop_files(&mut session, &[text_file("truth.txt", &truth)], None::<PosesAs>);
    let (mut harness, session) = harness(session);
    harness.run();
    harness.get_by_label("1 pose in truth.txt");
    harness.get_by_label("Reference").click();
    harness.run();
    assert_eq!(session.borrow().scene().references.len(), 1);
    harness.get_by_label("truth");
}

#[test]
fn an_object_that_is_not_in_the_photo_can_be_placed() {
    let mut session = small_session();
    let (photo, object, _) = session.selected_annotation().unwrap();
    session.apply(Command::Withdraw { photo, object }, NOW_MS).unwrap();
    let (mut harness, session) = harness(session);
    harness.run();
    harness.get_by_label("Place it here").click();
    harness.run();
    assert!(session.borrow().scene().annotation(photo, object).is_some());
}

#[test]
fn hiding_and_locking_are_a_click_away() {
    let (mut harness, session) = harness(small_session());
    harness.run();
    harness.get_by_label("Hide box").click();
    harness.run();
    harness.get_by_label("Lock box").click();
    harness.run();
    let object = session.borrow().scene().objects[0].clone();
    assert!(!object.visible && object.locked);
}
