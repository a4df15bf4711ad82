//! The dialog of saved scenes: what it lists, and what it asks for by mouse and by keyboard.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pinpose::interact::Hands;
use pinpose::platform::{SceneHeading, SceneId, SceneSummary, StorageUse};
use pinpose::session::Session;
use pinpose::ui::{self, SceneRequest, StoreView, Surroundings, UiState};

use crate::support::{NOW_MS, quiet_surroundings, small_session};

type Requests = Rc<RefCell<Vec<SceneRequest>>>;

fn scene(id: &str, name: &str, hours_ago: f64) -> SceneSummary {
    let heading = SceneHeading {
        name: name.to_owned(),
        subject: "photo".to_owned(),
        changed_at_ms: NOW_MS - hours_ago * 3_600_000.0,
        photo_count: 1,
        object_count: 2,
    };
    SceneSummary { id: SceneId::new(id), heading, bytes: 4_240_000 }
}

fn three() -> Vec<SceneSummary> {
    vec![
        scene("a", "Lab bench", 0.0),
        scene("b", "", 3.0),
        scene(
            "c",
            "A name that is far too long to be shown in one line of the list of scenes, and goes on",
            800.0,
        ),
    ]
}

/// The interface over some scenes of which the first is open, and what it asks for.
fn harness(
    session: Session,
    scenes: Vec<SceneSummary>,
    show: impl Fn(&mut UiState),
) -> (Harness<'static>, Requests) {
    let requests = Requests::default();
    let asked_for = requests.clone();
    let mut state = UiState::default();
    show(&mut state);
    let harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let usage = StorageUse { used_bytes: 12_700_000, quota_bytes: Some(2_100_000_000) };
        let hands = Hands::default();
        let around = Surroundings {
            drawn_pose: None,
            scenes: &scenes,
            store: StoreView {
                open_scene: scenes.first().map(|scene| &scene.id),
                is_opening: false,
                usage: Some(usage),
                now_ms: NOW_MS,
            },
            ..quiet_surroundings(&hands)
        };
        let asked = ui::draw(ui, &session, &around, &mut state);
        asked_for.borrow_mut().extend(asked.scene_requests);
    });
    (harness, requests)
}

fn listed(scenes: Vec<SceneSummary>) -> (Harness<'static>, Requests) {
    let (mut harness, requests) = harness(small_session(), scenes, |state| state.scenes_dialog.show());
    harness.run();
    (harness, requests)
}

fn taken(requests: &Requests) -> Vec<SceneRequest> {
    requests.borrow_mut().drain(..).collect()
}

#[test]
fn scenes_are_listed_with_what_is_in_them() {
    let (harness, _) = listed(three());
    harness.get_by_label("Lab bench, open, 1 photo, 2 objects, just now, 4.2 MB");
    harness.get_by_label("photo, 1 photo, 2 objects, 3 hours ago, 4.2 MB");
    harness.get_by_label("12.7 MB stored of the 2.1 GB that this browser allows");
    assert!(harness.query_by_label("Search scenes").is_none(), "three scenes need no search");
}

#[test]
fn a_scene_is_opened_by_mouse_and_by_keyboard() {
    let (mut harness, requests) = listed(three());
    harness.get_by_label_contains("photo, 1 photo").click();
    harness.run();
    harness.get_by_label("Open").click();
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Open(SceneId::new("b"))]);
    assert!(harness.query_by_label("Scenes").is_none(), "the dialog stays open");

    let (mut harness, requests) = listed(three());
    for key in [Key::ArrowDown, Key::ArrowDown, Key::ArrowDown, Key::ArrowUp, Key::Enter] {
        harness.key_press(key);
        harness.run();
    }
    assert_eq!(taken(&requests), [SceneRequest::Open(SceneId::new("b"))]);
}

#[test]
fn a_scene_is_renamed_in_place() {
    let (mut harness, requests) = listed(three());
    harness.key_press(Key::F2);
    harness.run();
    // What is typed replaces the name.
    harness.get_by_label("New name").type_text("Shelf");
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Rename(SceneId::new("a"), "Shelf".to_owned())]);
    harness.get_by_label("Scenes");

    harness.get_by_label("Rename").click();
    harness.run();
    harness.get_by_label("New name").type_text("No");
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(taken(&requests), []);
    harness.get_by_label("Scenes");
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Scenes").is_none());
}

#[test]
fn deleting_asks_first() {
    let (mut harness, requests) = listed(three());
    harness.get_by_label("Delete").click();
    harness.run();
    assert_eq!(taken(&requests), []);
    harness.get_by_label("Keep it").click();
    harness.run();
    harness.key_press(Key::Delete);
    harness.run();
    harness.get_by_label("Delete it").click();
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Delete(SceneId::new("a"))]);
    harness.get_by_label("Duplicate").click();
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Duplicate(SceneId::new("a"))]);
}

#[test]
fn many_scenes_can_be_searched() {
    let scenes = (0..12).map(|number| scene(&number.to_string(), &format!("Bench {number}"), 1.0)).collect();
    let (mut harness, requests) = listed(scenes);
    harness.get_by_label("Search scenes").click();
    harness.run();
    harness.get_by_label("Search scenes").type_text("bench 11");
    harness.run();
    assert!(harness.query_by_label_contains("Bench 10").is_none());
    harness.get_by_label("Open").click();
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Open(SceneId::new("11"))]);
}

#[test]
fn an_empty_list_says_how_scenes_come_there() {
    let (harness, _) = listed(Vec::new());
    harness.get_by_label("No scene is saved yet.");
}

#[test]
fn save_as_asks_for_a_name() {
    let ask = |state: &mut UiState| state.scenes_dialog.ask_name("Lab bench copy");
    let (mut harness, requests) = harness(small_session(), three(), ask);
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::SaveAs("Lab bench copy".to_owned())]);
    assert!(harness.query_by_label("Save as").is_none(), "the dialog stays open");
}

#[test]
fn the_welcome_screen_offers_recent_scenes() {
    let scenes: Vec<_> =
        ["open", "a", "b", "c", "d", "e"].map(|id| scene(id, &format!("Bench {id}"), 1.0)).into();
    let (mut harness, requests) = harness(Session::default(), scenes, |_| {});
    harness.run();
    assert!(harness.query_by_label_contains("Bench e").is_none(), "more than four");
    harness.get_by_label_contains("Bench b").click();
    harness.run();
    harness.get_by_label("All scenes…").click();
    harness.run();
    assert_eq!(taken(&requests), [SceneRequest::Open(SceneId::new("b")), SceneRequest::Show]);
}
