//! The whole program without a window, on a store in memory: which scene is open, and what becomes of the others.

use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use egui_kittest::kittest::Queryable as _;
use pinpose::platform::{Journal, MemoryStorage, PageCall, SaveTerms, SceneId, SceneSummary, Storage};

use crate::program::Program;
use crate::support::{box_mesh, flat_photo};

fn stored(storage: &MemoryStorage) -> Vec<SceneSummary> {
    pollster::block_on(storage.list()).unwrap()
}

fn titles(scenes: &[SceneSummary]) -> Vec<&str> {
    scenes.iter().map(|scene| scene.heading.title()).collect()
}

/// Two scenes: "first" with a photo and a mesh, "second" with another photo and the same mesh; the second is open.
fn two_scenes(storage: &Rc<MemoryStorage>) -> (Program, SceneId, SceneId) {
    let mut program = Program::start(storage);
    program.load(&[flat_photo("first.png", 64, 48), box_mesh("box.obj")]);
    program.set_opacity(0.25);
    program.new_scene();
    program.load(&[flat_photo("second.png", 80, 60), box_mesh("box.obj")]);
    let scenes = stored(storage);
    assert_eq!(titles(&scenes), ["second", "first"]);
    let (second, first) = (scenes[0].id.clone(), scenes[1].id.clone());
    (program, first, second)
}

#[test]
fn an_untouched_empty_scene_is_not_stored() {
    let storage = Rc::new(MemoryStorage::default());
    let mut program = Program::start(&storage);
    program.new_scene();
    assert!(program.state().saved);
    assert_eq!(stored(&storage), []);
}

#[test]
fn scenes_are_switched_and_the_next_start_opens_the_last_one() {
    let storage = Rc::new(MemoryStorage::default());
    let (mut program, first, _) = two_scenes(&storage);
    assert_eq!(storage.asset_count(), 3, "the mesh is stored once for both");
    program.change_opacity(0.5);
    // Not saved yet: switching saves it first.
    program.open(&first);
    let state = program.state();
    assert!(state.document_json.contains("first.png") && state.document_json.contains("0.25"));
    // There is no way back across a switch but switching.
    let undo = program.calls.clone();
    let mut undone = pin!(undo.call(PageCall::Command { name: "undo".to_owned(), value: None }));
    assert!(undone.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_pending());
    program.state();
    assert!(matches!(undone.as_mut().poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(Err(_))));
    drop(program);

    let mut program = Program::start(&storage);
    let state = program.wait_until_saved();
    assert!(state.document_json.contains("first.png"));
    let second = stored(&storage).into_iter().find(|scene| scene.id != first).unwrap();
    program.open(&second.id);
    let state = program.state();
    assert!(state.document_json.contains("second.png") && state.document_json.contains("0.5"));
}

#[test]
fn a_scene_gets_a_name_and_goes_on_in_a_copy_under_another() {
    let storage = Rc::new(MemoryStorage::default());
    let (mut program, first, _) = two_scenes(&storage);
    // Without a name "save as" just names it.
    program.harness.state_mut().save_scene_as("Lab bench");
    program.wait_until_saved();
    assert_eq!(titles(&stored(&storage)), ["Lab bench", "first"]);
    program.harness.state_mut().save_scene_as("Lab bench, tried again");
    program.wait_until_saved();
    program.set_opacity(0.75);
    let scenes = stored(&storage);
    assert_eq!(titles(&scenes), ["Lab bench, tried again", "Lab bench", "first"]);
    let old = pollster::block_on(storage.load(&scenes[1].id)).unwrap().unwrap();
    assert!(!old.json.contains("0.75"));
    // A name is no step of the work: undo leaves it.
    program.ask(PageCall::Command { name: "undo".to_owned(), value: None });
    program.wait_until_saved();
    assert_eq!(titles(&stored(&storage))[0], "Lab bench, tried again");

    program.harness.state_mut().rename_scene(&first, "Shelf");
    program.list("it is renamed", |scenes| titles(scenes).contains(&"Shelf"));
    program.open(&first);
    assert!(program.state().document_json.contains("\"name\": \"Shelf\""));
}

#[test]
fn scenes_are_duplicated_and_deleted() {
    let storage = Rc::new(MemoryStorage::default());
    let (mut program, first, second) = two_scenes(&storage);
    program.change_opacity(0.5);
    program.harness.state_mut().duplicate_scene(second.clone());
    let scenes = program.list("it is copied", |scenes| scenes.len() == 3);
    let copy = scenes.iter().find(|scene| scene.heading.title() == "second copy").unwrap();
    let copied = pollster::block_on(storage.load(&copy.id)).unwrap().unwrap();
    assert!(copied.json.contains("0.5"), "what was not saved yet is in the copy");
    program.harness.state_mut().delete_scene(first);
    program.list("it is deleted", |scenes| scenes.len() == 2);
    assert_eq!(storage.asset_count(), 2);
    // The open one: what is left is an empty scene, and its name does not come back.
    program.harness.state_mut().delete_scene(second);
    program.list("it is deleted", |scenes| titles(scenes) == ["second copy"]);
    let state = program.wait_until_saved();
    assert_eq!(state.photo, None);
    std::thread::sleep(Duration::from_millis(900));
    program.state();
    assert_eq!(titles(&stored(&storage)), ["second copy"]);
}

#[test]
fn a_newer_journal_is_used_and_goes_once_it_is_saved() {
    let storage = Rc::new(MemoryStorage::default());
    let mut program = Program::start(&storage);
    program.load(&[flat_photo("photo.png", 64, 48), box_mesh("box.obj")]);
    drop(program);
    let scene = stored(&storage).remove(0);
    let saved = pollster::block_on(storage.load(&scene.id)).unwrap().unwrap();
    let changed = saved.json.replace("\"overlay_opacity\": 1.0", "\"overlay_opacity\": 0.5");
    assert_ne!(changed, saved.json);
    let older = Journal { changed_at_ms: saved.heading.changed_at_ms - 1.0, json: changed.clone() };
    storage.write_journal(&scene.id, &older);
    let mut program = Program::start(&storage);
    assert!(program.wait_until_saved().document_json.contains("\"overlay_opacity\": 1.0"));
    assert_eq!(storage.read_journal(&scene.id), None, "a journal that is of no use stays behind");
    drop(program);

    let newer = Journal { changed_at_ms: saved.heading.changed_at_ms + 1.0, json: changed };
    storage.write_journal(&scene.id, &newer);
    let mut program = Program::start(&storage);
    assert!(program.wait_until_saved().document_json.contains("\"overlay_opacity\": 0.5"));
    let stored_now = pollster::block_on(storage.load(&scene.id)).unwrap().unwrap();
    assert!(stored_now.json.contains("\"overlay_opacity\": 0.5"));
    assert_eq!(storage.read_journal(&scene.id), None);
    drop(program);

    // A journal that is no document is no better than none.
    let broken = Journal { changed_at_ms: f64::MAX, json: "{".to_owned() };
    storage.write_journal(&scene.id, &broken);
    let mut program = Program::start(&storage);
    assert!(program.wait_until_saved().document_json.contains("\"overlay_opacity\": 0.5"));
}

#[test]
fn a_failed_save_is_said_with_a_way_out_and_keeps_the_scene_open() {
    let storage = Rc::new(MemoryStorage::default());
    let (mut program, first, _) = two_scenes(&storage);
    storage.fail_with(Some("the scene cannot be saved: the disk is full"));
    program.change_opacity(0.5);
    program
        .wait("it is said", |state| state.notices.iter().any(|notice| notice.contains("the disk is full")));
    program.harness.step();
    program.harness.get_by_label("Download workspace");
    program.harness.state_mut().open_scene(first.clone());
    let state = program.wait("it is refused", |state| !state.busy);
    assert!(state.document_json.contains("second.png"));
    storage.fail_with(None);
    program.set_opacity(0.75);
    program.open(&first);
    assert!(program.state().document_json.contains("first.png"));
}

#[test]
fn two_windows_of_one_scene_lose_nothing() {
    let storage = Rc::new(MemoryStorage::default());
    let mut one = Program::start(&storage);
    one.load(&[flat_photo("photo.png", 64, 48)]);
    let mut other = Program::start(&storage);
    other.set_opacity(0.25);
    one.change_opacity(0.5);
    let state = one.wait("it goes on in a copy", |state| {
        state.saved && state.notices.iter().any(|notice| notice.contains("another window"))
    });
    assert!(state.document_json.contains("photo copy"));
    let scenes = stored(&storage);
    assert_eq!(titles(&scenes), ["photo copy", "photo"]);
    let theirs = pollster::block_on(storage.load(&scenes[1].id)).unwrap().unwrap();
    assert!(theirs.json.contains("0.25"));
}

#[test]
fn a_scene_that_is_open_elsewhere_is_said_at_once_and_not_written() {
    let storage = Rc::new(MemoryStorage::default());
    let mut one = Program::start(&storage);
    one.load(&[flat_photo("photo.png", 64, 48)]);
    let before = stored(&storage);
    storage.hold_elsewhere(&before[0].id);
    let mut other = Program::start(&storage);
    other.wait("it is said", |state| state.notices.iter().any(|notice| notice.contains("open in another")));
    assert_eq!(stored(&storage), before, "looking changes nothing");
    other.change_opacity(0.5);
    let state = other.wait("it goes on in a copy", |state| state.saved);
    assert!(state.document_json.contains("photo copy"));
    let after = stored(&storage);
    assert_eq!(titles(&after), ["photo copy", "photo"]);
    assert_eq!(after[1], before[0]);
}

#[test]
fn a_scene_that_cannot_be_read_is_left_as_it_is() {
    let storage = Rc::new(MemoryStorage::default());
    let mut program = Program::start(&storage);
    program.load(&[flat_photo("photo.png", 64, 48)]);
    drop(program);
    let scene = stored(&storage).remove(0);
    let mut saved = pollster::block_on(storage.load(&scene.id)).unwrap().unwrap();
    saved.json = saved.json.replace("\"version\": ", "\"version\": 9");
    pollster::block_on(storage.save(&scene.id, saved.clone(), SaveTerms::default())).unwrap();
    let mut program = Program::start(&storage);
    let state = program.state();
    assert!(state.notices.iter().any(|notice| notice.contains("cannot be opened")), "{:?}", state.notices);
    program.load(&[flat_photo("other.png", 80, 60)]);
    assert_eq!(pollster::block_on(storage.load(&scene.id)).unwrap().unwrap(), saved);
    assert_eq!(stored(&storage).len(), 2);
}

#[test]
fn a_scene_that_lacks_a_file_is_not_written_over() {
    let storage = Rc::new(MemoryStorage::default());
    let mut program = Program::start(&storage);
    program.load(&[flat_photo("kept.png", 64, 48), flat_photo("lost.png", 32, 24), box_mesh("box.obj")]);
    drop(program);
    storage.lose("lost.png");
    let scene = stored(&storage).remove(0);
    let before = pollster::block_on(storage.load(&scene.id)).unwrap().unwrap();

    let mut program = Program::start(&storage);
    let state = program.wait("it is said", |state| {
        state.notices.iter().any(|notice| notice.contains("lost.png cannot be read from the storage"))
    });
    assert!(state.document_json.contains("kept.png"), "what is there is shown");
    program.harness.get_by_label("Download what is stored");
    // The poses of the lost photo are still in the stored document: a change must not cost them.
    program.set_opacity(0.25);
    assert_eq!(stored(&storage).len(), 2);
    assert_eq!(pollster::block_on(storage.load(&scene.id)).unwrap().unwrap(), before);
}

#[test]
fn deleting_another_scene_makes_room() {
    let storage = Rc::new(MemoryStorage::default());
    let (mut program, first, second) = two_scenes(&storage);
    storage.fail_with(Some("the scene cannot be saved: the browser's storage is full"));
    program.change_opacity(0.5);
    program.wait("it is said", |state| state.notices.iter().any(|notice| notice.contains("is full")));
    program.harness.step();
    program.harness.get_by_label("Download everything");
    storage.fail_with(None);
    program.harness.state_mut().delete_scene(first);
    let state = program.wait("nothing more has to be done", |state| state.saved);
    assert!(state.document_json.contains("second.png"));
    assert_eq!(stored(&storage).len(), 1);
    assert!(pollster::block_on(storage.load(&second)).unwrap().unwrap().json.contains("0.5"));
}
