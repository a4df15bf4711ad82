//! Menus, palette, keys, theme, strip and dialogs: what they show and what they ask for.

use std::cell::RefCell;
use std::rc::Rc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use pinpose::formats::NamedFile;
use pinpose::interact::Hands;
use pinpose::platform::{SceneHeading, SceneId, SceneSummary};
use pinpose::session::{Command, CommandId, Session};
use pinpose::ui::{self, Busy, Surroundings, ThemeChoice, UiState};

use crate::support::{
    CAMERA_JSON, NOW_MS, drop_files, flat_photo, quiet_surroundings, small_session, text_file,
};

struct Chrome {
    session: Session,
    state: UiState,
    busy: Option<Busy>,
    scenes: Vec<SceneSummary>,
    cancelled: bool,
}

type Shared = Rc<RefCell<Chrome>>;

/// The interface as the program runs it: keys and commands are applied, and its own effects carried out.
fn harness_of(session: Session, size: [f32; 2], pixels_per_point: f32) -> (Harness<'static>, Shared) {
    let (state, busy, scenes) = (UiState::default(), None, Vec::new());
    let chrome = Rc::new(RefCell::new(Chrome { session, state, busy, scenes, cancelled: false }));
    let shared = chrome.clone();
    let builder = Harness::builder().with_size(size).with_pixels_per_point(pixels_per_point);
    let harness = builder.build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let Chrome { session, state, busy, scenes, cancelled } = &mut *shared.borrow_mut();
        let mut commands = Vec::new();
        let is_elsewhere = ui.ctx().text_edit_focused() || egui::Popup::is_any_open(ui.ctx());
        if state.open.is_none() && session.question().is_none() && !is_elsewhere {
            let keymap = &state.preferences.keymap;
            let pressed = ui.ctx().input_mut(|input| ui::pressed_commands(input, keymap));
            commands.extend(pressed.into_iter().map(|pressed| Command::Run(pressed.id)));
        }
        let hands = Hands::default();
        let around = Surroundings {
            drawn_pose: None,
            busy: busy.clone(),
            scenes,
            store: ui::StoreView { now_ms: NOW_MS, ..ui::StoreView::default() },
            ..quiet_surroundings(&hands)
        };
        let asked = ui::draw(ui, session, &around, state);
        *cancelled |= asked.cancel_loading;
        commands.extend(asked.commands);
        for command in commands {
            for effect in session.apply(command, NOW_MS).unwrap() {
                state.take_effect(effect, ui.ctx());
            }
        }
    });
    (harness, chrome)
}

fn harness(session: Session) -> (Harness<'static>, Shared) {
    harness_of(session, [1024.0, 640.0], 1.0)
}

/// A session of so many photos of one size, with one object in the first.
fn many_photos(count: usize) -> Session {
    let mut session = small_session();
    let photos: Vec<NamedFile> = (1..count)
        .map(|number| {
            let mut file = flat_photo(&format!("photo-{number:03}.png"), 64, 48);
            // Each another file: bytes after a PNG's end are read by nobody.
            let bytes: Vec<u8> = file.bytes.iter().copied().chain(number.to_le_bytes()).collect();
            file.bytes = bytes.into();
            file
        })
        .collect();
    drop_files(&mut session, &photos, None);
    let first = session.scene().photos[0].id;
    session.apply(Command::ShowPhoto(first), NOW_MS).unwrap();
    session
}

fn press(harness: &mut Harness<'_>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn type_into(harness: &mut Harness<'_>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run();
}

#[test]
fn the_palette_finds_a_command_and_enter_runs_it() {
    let (mut harness, chrome) = harness(small_session());
    harness.run();
    press(&mut harness, Modifiers::COMMAND, Key::K);
    harness.get_by_label("Find a command");
    type_into(&mut harness, "rot");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(chrome.borrow().session.tool(), pinpose::session::Tool::Rotate);
    assert!(harness.query_by_label("Find a command").is_none(), "it is closed");
}

#[test]
fn the_palette_shows_photos_and_objects_and_arrows_choose() {
    let (mut harness, chrome) = harness(many_photos(3));
    harness.run();
    press(&mut harness, Modifiers::COMMAND, Key::K);
    type_into(&mut harness, "show photo photo-00");
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(chrome.borrow().session.photo().unwrap().name, "photo-002.png");
    press(&mut harness, Modifiers::COMMAND, Key::K);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(chrome.borrow().state.open, None);
}

#[test]
fn what_cannot_be_done_is_not_run_by_the_palette() {
    let (mut harness, chrome) = harness(Session::default());
    harness.run();
    press(&mut harness, Modifiers::COMMAND, Key::K);
    type_into(&mut harness, "undo");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(chrome.borrow().state.open.is_some(), "it stays, with the reason");
}

#[test]
fn a_key_is_changed_by_pressing_another_and_a_conflict_is_swapped() {
    let (mut harness, chrome) = harness_of(many_photos(2), [800.0, 600.0], 1.0);
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    harness.get_by_label("Search keys").focus();
    harness.run();
    type_into(&mut harness, "photo");
    harness.get_by_label("Key of Next photo: N").click();
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::P);
    harness.get_by_label("P is Previous photo");
    harness.get_by_label("Swap").click();
    harness.run();
    harness.get_by_label("Key of Next photo: P");
    harness.get_by_label("Key of Previous photo: N");
    harness.get_by_label("Close").click();
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::P);
    assert_eq!(chrome.borrow().session.photo().unwrap().name, "photo-001.png");
    chrome.borrow_mut().state.preferences.keymap.reset_all();
    press(&mut harness, Modifiers::NONE, Key::P);
    assert_eq!(chrome.borrow().session.photo().unwrap().name, "photo.png");
}

#[test]
fn the_sheet_closes_by_escape_but_a_recording_first() {
    let (mut harness, chrome) = harness(small_session());
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    harness.get_by_label("Search keys").focus();
    harness.run();
    type_into(&mut harness, "fit");
    harness.get_by_label("Key of Fit photo: 0").click();
    harness.run();
    harness.get_by_label("Press a key…");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(chrome.borrow().state.open.is_some(), "the recording alone ended");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(chrome.borrow().state.open, None);
}

#[test]
fn the_theme_is_switched_by_command() {
    let (mut harness, chrome) = harness(small_session());
    harness.run();
    let background = |harness: &Harness<'_>| harness.ctx.global_style().visuals.panel_fill;
    let dark = background(&harness);
    press(&mut harness, Modifiers::COMMAND, Key::K);
    type_into(&mut harness, "light or dark");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.run();
    assert_eq!(chrome.borrow().state.preferences.theme, ThemeChoice::Light);
    assert!(background(&harness).r() > dark.r() + 150);
}

#[test]
fn the_strip_shows_progress_and_a_click_shows_a_photo() {
    let mut session = many_photos(3);
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let pose = annotation.camera_from_object;
    let source = pinpose::scene::PoseSource::Manual;
    session.apply(Command::SetPose { photo, object, camera_from_object: pose, source }, NOW_MS).unwrap();
    session.apply(Command::Run(CommandId::ConfirmAndNext), NOW_MS).unwrap();
    let (mut harness, chrome) = harness(session);
    harness.run();
    harness.get_by_label("1 of 3 confirmed");
    harness.get_by_label("Photo photo.png, confirmed");
    harness.get_by_label("Photo photo-002.png, not posed yet").click();
    harness.run();
    assert_eq!(chrome.borrow().session.photo().unwrap().name, "photo-002.png");
    harness.get_by_label("Fold photos").click();
    harness.run();
    assert!(harness.query_by_label("Photo photo.png, confirmed").is_none());
    harness.get_by_label("1 of 3 confirmed");
}

#[test]
fn a_long_strip_lays_out_what_is_seen_and_follows_the_shown_photo() {
    let (mut harness, chrome) = harness(many_photos(300));
    harness.run();
    let laid_out = harness.query_all_by_label_contains("Photo photo").count();
    assert!(laid_out < 12, "{laid_out} of 300 photos are laid out");
    let last = chrome.borrow().session.scene().photos[250].id;
    chrome.borrow_mut().session.apply(Command::ShowPhoto(last), NOW_MS).unwrap();
    harness.run_steps(40);
    harness.get_by_label("Photo photo-250.png, not posed yet");
    assert!(!chrome.borrow().state.thumbnails.wanted().is_empty(), "their thumbnails are asked for");
}

#[test]
fn one_photo_needs_no_strip() {
    let (mut harness, _) = harness(small_session());
    harness.run();
    assert!(harness.query_by_label_contains("confirmed").is_none());
}

#[test]
fn a_pasted_pose_is_checked_while_it_is_typed() {
    let (mut harness, chrome) = harness(small_session());
    harness.run();
    chrome.borrow_mut().state.open = Some(ui::Dialog::PastePose);
    harness.run();
    type_into(&mut harness, "1 0 0 5");
    harness.get_by_label_contains("4 numbers found");
    type_into(&mut harness, " 0 1 0 6 0 0 1 700 0 0 0 1");
    harness.get_by_label_contains("proper rotation, t = (5.00, 6.00, 700.00) mm");
    harness.get_by_label("Set pose").click();
    harness.run();
    let pose = chrome.borrow().session.selected_annotation().unwrap().2.camera_from_object;
    assert_eq!(pose.translation_mm.to_array(), [5.0, 6.0, 700.0]);
    assert_eq!(chrome.borrow().state.open, None);
}

#[test]
fn the_poses_question_counts_and_enter_answers() {
    let mut session = small_session();
    let one = "1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n";
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n{one}duck <-> photo\n{one}");
    drop_files(&mut session, &[text_file("truth.txt", &truth)], None);
    let (mut harness, chrome) = harness(session);
    harness.run();
    harness.get_by_label("1 of 2 fits your files.");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(chrome.borrow().session.question().is_none());
    let pose = chrome.borrow().session.selected_annotation().unwrap().2.camera_from_object;
    assert_eq!(pose.translation_mm.z, 700.0);
}

#[test]
fn the_scene_is_renamed_in_the_bar() {
    let (mut harness, chrome) = harness(small_session());
    harness.run();
    harness.get_by_label("Unnamed scene").click();
    harness.run();
    harness.run();
    type_into(&mut harness, "Kitchen");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(chrome.borrow().session.scene().name, "Kitchen");
    harness.get_by_label("Kitchen");
}

#[test]
fn loading_can_be_cancelled() {
    let (mut harness, chrome) = harness(small_session());
    chrome.borrow_mut().busy = Some(Busy { text: "Reading 12 of 40 files…".to_owned(), can_cancel: true });
    harness.run_steps(3);
    harness.get_by_label("Reading 12 of 40 files…");
    harness.get_by_label("Cancel").click();
    harness.run_steps(3);
    assert!(chrome.borrow().cancelled);
}

#[test]
fn menus_have_groups_and_say_why_not() {
    let (mut harness, _) = harness(small_session());
    harness.run();
    for (menu, item) in [("File", "Import camera…"), ("Edit", "Paste pose…"), ("Pose", "Confirm and next")]
    {
        harness.get_by_label(menu).click();
        harness.run();
        harness.get_by_label_contains(item);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
}

/// Panels and dialogs as stored pictures; `UPDATE_SNAPSHOTS=1` writes them anew. Without a GPU, real or in software, there is
/// nothing to compare.
#[test]
fn panels_and_dialogs_look_as_they_did() {
    if crate::support::renderer().is_none() {
        return;
    }
    type Prepare = fn(&mut Chrome);
    let states: [(&str, ThemeChoice, Prepare); 9] = [
        ("scene", ThemeChoice::Dark, |_| {}),
        ("scene-light", ThemeChoice::Light, |_| {}),
        ("palette", ThemeChoice::Dark, |chrome| chrome.state.open = Some(ui::Dialog::Palette)),
        ("shortcuts", ThemeChoice::Light, |chrome| chrome.state.open = Some(ui::Dialog::Shortcuts)),
        ("paste", ThemeChoice::Dark, |chrome| chrome.state.open = Some(ui::Dialog::PastePose)),
        ("export", ThemeChoice::Light, |chrome| chrome.state.open = Some(ui::Dialog::Export)),
        ("welcome", ThemeChoice::Light, |chrome| chrome.session = Session::default()),
        ("scenes", ThemeChoice::Dark, |chrome| chrome.state.scenes_dialog.show()),
        ("question", ThemeChoice::Dark, |chrome| {
            let pose = "1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n";
            let truth = format!("{CAMERA_JSON}\nbox <-> photo\n{pose}duck <-> photo\n{pose}");
            drop_files(&mut chrome.session, &[text_file("truth.txt", &truth)], None);
        }),
    ];
    // Rasterisers round the edges of shapes their own way: a few hundred of 655,360 pixels. What a change of the interface
    // moves is thousands.
    let options = SnapshotOptions::new().threshold(1.0).max_failed_pixels(400);
    let mut results = SnapshotResults::new();
    for (name, theme, prepare) in states {
        let (mut harness, chrome) = harness_of(many_photos(6), [1024.0, 640.0], 1.0);
        chrome.borrow_mut().state.preferences.theme = theme;
        chrome.borrow_mut().scenes = ["Kitchen", "Desk, evening"].map(scene).to_vec();
        harness.run_steps(2);
        prepare(&mut chrome.borrow_mut());
        harness.run_steps(8);
        results.add(harness.try_snapshot_options(name, &options));
    }
}

fn scene(name: &str) -> SceneSummary {
    SceneSummary {
        id: SceneId::new(name),
        heading: SceneHeading {
            name: name.to_owned(),
            photo_count: 3,
            object_count: 2,
            changed_at_ms: NOW_MS - 3_600_000.0,
            ..SceneHeading::default()
        },
        bytes: 4_200_000,
    }
}
