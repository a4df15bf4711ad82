//! When and what autosave saves, with a clock of the test's own.

use std::sync::Arc;

use glam::DVec3;

use super::*;
use crate::formats::{NamedFile, read_mesh, read_photo};
use crate::math::Pose;
use crate::platform::MemoryStorage;
use crate::session::{Batch, Command};

const ID: &str = "bench";

struct Desk {
    storage: Rc<MemoryStorage>,
    autosave: Autosave,
    session: Session,
    now_ms: f64,
}

impl Desk {
    /// One photo and one object, saved.
    fn new() -> Self {
        let storage = Rc::new(MemoryStorage::default());
        let autosave = Autosave::new(storage.clone(), egui::Context::default(), SceneId::new(ID));
        let mut desk = Self { storage, autosave, session: Session::default(), now_ms: 0.0 };
        desk.apply(Command::Import(Box::new(batch())));
        desk.pass(1000.0);
        assert!(desk.stored().is_some());
        desk
    }

    fn apply(&mut self, command: Command) {
        self.session.apply(command, self.now_ms).unwrap();
        self.pass(0.0);
    }

    /// Time passes, with a frame every 50 ms.
    fn pass(&mut self, duration_ms: f64) {
        let end_ms = self.now_ms + duration_ms;
        loop {
            self.autosave.tick(&egui::Context::default(), &self.session, self.now_ms);
            if self.now_ms >= end_ms {
                return;
            }
            self.now_ms = (self.now_ms + 50.0).min(end_ms);
        }
    }

    fn move_by(&mut self, offset_mm: f64) {
        let (photo, object, annotation) = self.session.selected_annotation().unwrap();
        let camera_from_object = annotation.camera_from_object.translated(DVec3::new(offset_mm, 0.0, 0.0));
        self.apply(Command::Drag { photo, object, camera_from_object });
    }

    fn set_opacity(&mut self, overlay_opacity: f32) {
        self.apply(Command::SetLook(crate::scene::Look { overlay_opacity, ..self.session.look() }));
    }

    fn pose(&self) -> Pose {
        self.session.selected_annotation().unwrap().2.camera_from_object
    }

    fn stored(&self) -> Option<String> {
        pollster::block_on(self.storage.load(&SceneId::new(ID))).unwrap().map(|saved| saved.json)
    }

    fn stored_has(&self, pose: Pose) -> bool {
        holds(&self.stored().unwrap(), pose)
    }
}

fn holds(json: &str, pose: Pose) -> bool {
    json.contains(&format!("{:?}", pose.translation_mm.x))
}

fn batch() -> Batch {
    let mut png = Vec::new();
    let picture = image::RgbImage::from_pixel(64, 48, image::Rgb([90, 100, 110]));
    picture.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
    let photo = NamedFile { name: "photo.png".to_owned(), bytes: Arc::from(png) };
    let text = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let mesh = NamedFile { name: "tetra.obj".to_owned(), bytes: Arc::from(text.as_bytes()) };
    Batch {
        photos: vec![Arc::new(read_photo(&photo).unwrap().0)],
        meshes: vec![Arc::new(read_mesh(&mesh).unwrap().0)],
        ..Batch::default()
    }
}

#[test]
fn a_change_is_saved_within_a_second_also_while_changes_go_on() {
    let mut desk = Desk::new();
    desk.apply(Command::BeginGesture("Move"));
    desk.move_by(1.25);
    desk.apply(Command::EndGesture);
    let first = desk.pose();
    // A step every 200 ms never leaves the quiet that a save waits for.
    for _ in 0..5 {
        desk.pass(200.0);
        let opacity = desk.session.look().overlay_opacity - 0.1;
        desk.set_opacity(opacity);
    }
    assert!(desk.stored_has(first));
}

#[test]
fn a_drag_that_ended_is_saved_while_the_next_one_goes_on() {
    let mut desk = Desk::new();
    desk.apply(Command::BeginGesture("Move"));
    desk.move_by(1.25);
    desk.apply(Command::EndGesture);
    let settled = desk.pose();
    desk.pass(100.0);
    desk.apply(Command::BeginGesture("Move"));
    desk.move_by(0.5);
    assert!(!desk.stored_has(settled));
    for _ in 0..20 {
        desk.move_by(0.25);
        desk.pass(50.0);
    }
    assert!(desk.session.gesture_under_way());
    assert!(desk.stored_has(settled), "the first drag is not saved");
    assert!(!desk.stored_has(desk.pose()), "half a gesture was saved");
    assert_eq!(desk.autosave.state(&desk.session), Saving::Pending);
    desk.apply(Command::EndGesture);
    desk.pass(1000.0);
    assert!(desk.stored_has(desk.pose()));
    assert_eq!(desk.autosave.state(&desk.session), Saving::Saved);
}

#[test]
fn a_change_in_the_frame_in_which_a_drag_begins_is_settled_too() {
    let mut desk = Desk::new();
    let (photo, object, annotation) = desk.session.selected_annotation().unwrap();
    let pose = annotation.camera_from_object.translated(DVec3::new(3.75, 0.0, 0.0));
    let source = crate::scene::PoseSource::Manual;
    let set = Command::SetPose { photo, object, camera_from_object: pose, source };
    desk.session.apply(set, desk.now_ms).unwrap();
    desk.session.apply(Command::BeginGesture("Move"), desk.now_ms).unwrap();
    desk.move_by(0.5);
    desk.pass(1000.0);
    assert!(desk.stored_has(pose));
}

#[test]
fn when_the_page_goes_the_settled_scene_is_put_aside_and_saved() {
    let mut desk = Desk::new();
    desk.apply(Command::BeginGesture("Move"));
    desk.move_by(1.25);
    desk.apply(Command::EndGesture);
    let settled = desk.pose();
    desk.apply(Command::BeginGesture("Move"));
    desk.move_by(0.5);
    // Where the save does not come to its end, the journal is what is left.
    desk.storage.fail_with(Some("the page is gone"));
    leave(&desk.autosave.keeper);
    let journal = desk.storage.read_journal(&SceneId::new(ID)).unwrap();
    assert!(holds(&journal.json, settled) && !holds(&journal.json, desk.pose()));
    assert!(!desk.stored_has(settled));
    // It stays until the scene is saved.
    desk.storage.fail_with(None);
    desk.apply(Command::EndGesture);
    desk.pass(1000.0);
    assert!(desk.stored_has(desk.pose()));
    assert_eq!(desk.storage.read_journal(&SceneId::new(ID)), None);
    // With everything saved there is nothing to put aside.
    leave(&desk.autosave.keeper);
    assert_eq!(desk.storage.read_journal(&SceneId::new(ID)), None);
}

#[test]
fn a_failed_save_is_told_once_and_tried_again_with_the_next_change() {
    let mut desk = Desk::new();
    desk.autosave.take_finished();
    desk.storage.fail_with(Some("the disk is full"));
    desk.set_opacity(0.5);
    desk.pass(1000.0);
    assert_eq!(desk.autosave.take_finished(), Some(Finished::Failed("the disk is full".to_owned())));
    assert_eq!(desk.autosave.state(&desk.session), Saving::Failed("the disk is full".to_owned()));
    desk.pass(5000.0);
    assert_eq!(desk.autosave.take_finished(), None);
    desk.storage.fail_with(None);
    desk.set_opacity(0.25);
    desk.pass(1000.0);
    assert_eq!(desk.autosave.take_finished(), Some(Finished::Saved { first: false }));
    assert_eq!(desk.autosave.state(&desk.session), Saving::Saved);
}

#[test]
fn an_empty_scene_is_stored_only_where_one_was_stored_before() {
    let storage = Rc::new(MemoryStorage::default());
    let mut autosave = Autosave::new(storage.clone(), egui::Context::default(), SceneId::new(ID));
    let mut session = Session::default();
    let look = crate::scene::Look { overlay_opacity: 0.5, ..session.look() };
    session.apply(Command::SetLook(look), 0.0).unwrap();
    for now_ms in [0.0, 1000.0, 2000.0] {
        autosave.tick(&egui::Context::default(), &session, now_ms);
    }
    assert_eq!(pollster::block_on(storage.list()).unwrap(), []);
    assert_eq!(autosave.state(&session), Saving::Saved);
}
