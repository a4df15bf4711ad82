//! The interface without a window: what is on screen, and what it asks for when it is used.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pinpose::formats::PosesAs;
use pinpose::interact::Hands;
use pinpose::math::Pose;
use pinpose::session::{Command, CommandId, Session};
use pinpose::ui::{self, UiState};

use crate::support::{
    CAMERA_JSON, NOW_MS, drop_files, flat_photo, quiet_surroundings, small_session, text_file,
};

/// A session behind the interface; commands are applied as the program does it.
fn harness(session: Session) -> (Harness<'static>, Rc<RefCell<Session>>) {
    harness_of(session, [1024.0, 720.0])
}

/// High enough for every section at once.
fn tall_harness(session: Session) -> (Harness<'static>, Rc<RefCell<Session>>) {
    harness_of(session, [1024.0, 1800.0])
}

fn click(harness: &mut Harness<'static>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

/// Types into a field as a person does: click, type over what is there, Enter.
fn type_into(harness: &mut Harness<'static>, label: &str, text: &str) {
    click(harness, label);
    harness.get_by_label(label).type_text(text);
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
}

fn pose(session: &Rc<RefCell<Session>>) -> Pose {
    session.borrow().selected_annotation().unwrap().2.camera_from_object
}

fn harness_of(session: Session, size: [f32; 2]) -> (Harness<'static>, Rc<RefCell<Session>>) {
    let session = Rc::new(RefCell::new(session));
    let shared = session.clone();
    let mut state = UiState::default();
    let harness = Harness::builder().with_size(size).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let around = quiet_surroundings(&hands);
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

#[test]
fn camera_numbers_are_typed_and_bad_ones_are_refused_in_words() {
    let (mut harness, session) = tall_harness(small_session());
    harness.run();
    type_into(&mut harness, "fx", "612.5");
    assert_eq!(session.borrow().photo().unwrap().camera.fx, 612.5);
    type_into(&mut harness, "fx", "-3");
    harness.get_by_label_contains("Not taken: the focal length fx is -3");
    assert_eq!(session.borrow().photo().unwrap().camera.fx, 612.5);
    click(&mut harness, "Reset camera");
    assert_eq!(session.borrow().photo().unwrap().camera.fx, 520.5);
    click(&mut harness, "Lock camera");
    assert!(session.borrow().photo().unwrap().locked);
    click(&mut harness, "Lens distortion");
    harness.get_by_label("k1");
}

#[test]
fn a_pose_is_typed_as_angles_and_each_edit_is_one_undo_step() {
    let (mut harness, session) = tall_harness(small_session());
    let start = pose(&session);
    harness.run();
    click(&mut harness, "Pose values");
    click(&mut harness, "Rotation as");
    click(&mut harness, "Euler xyz");
    type_into(&mut harness, "rz", "190");
    let turned = glam::DMat3::from_rotation_z(190.0_f64.to_radians());
    assert!(pose(&session).rotation.abs_diff_eq(turned, 1e-12));
    // Not the -170 that the matrix would give.
    assert_eq!(harness.get_by_label("rz").value().as_deref(), Some("190.0°"));
    type_into(&mut harness, "tz", "812.25");
    assert_eq!(pose(&session).translation_mm.z, 812.25);
    click(&mut harness, "Undo");
    click(&mut harness, "Undo");
    assert_eq!(pose(&session), start);
}

/// A field shows two decimals; to look into it is no edit.
#[test]
fn a_field_that_is_left_as_it_was_changes_nothing() {
    let mut session = small_session();
    session.apply(Command::SetPoseFromText("1.23456789 2 777.123456789".to_owned()), NOW_MS).unwrap();
    let (mut harness, session) = tall_harness(session);
    harness.run();
    click(&mut harness, "Pose values");
    click(&mut harness, "Rotation as");
    click(&mut harness, "Axis-angle");
    let before = pose(&session);
    for field in ["tx", "tz", "ax"] {
        click(&mut harness, field);
    }
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(pose(&session), before);
    assert_eq!(session.borrow().log().len(), 1);
}

#[test]
fn a_dragged_number_is_one_undo_step() {
    let (mut harness, session) = tall_harness(small_session());
    let start = pose(&session);
    harness.run();
    click(&mut harness, "Pose values");
    click(&mut harness, "Rotation as");
    click(&mut harness, "Quaternion");
    let from = harness.get_by_label("tx").rect().center();
    harness.drag_at(from);
    harness.run();
    for step in 1..=5 {
        harness.hover_at(from + egui::vec2(8.0 * step as f32, 0.0));
        harness.run();
    }
    harness.drop_at(from + egui::vec2(40.0, 0.0));
    harness.run();
    assert!(pose(&session).translation_mm.x > start.translation_mm.x + 5.0);
    assert_eq!(session.borrow().log().len(), 1);
    click(&mut harness, "Undo");
    assert_eq!(pose(&session), start);
    assert!(session.borrow().undo_label().is_none_or(|label| label != "Set pose"));
}

#[test]
fn a_pasted_matrix_is_set_and_one_that_is_none_is_explained() {
    let (mut harness, session) = tall_harness(small_session());
    harness.run();
    click(&mut harness, "Pose values");
    click(&mut harness, "Pose as text");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    harness.get_by_label("Pose as text").type_text("np.array([[1, 2, 3, 4]])");
    harness.run();
    harness.get_by_label_contains("4 numbers found");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    harness.get_by_label("Pose as text").type_text("0 -1 0 5  1 0 0 6  0 0 1 707  0 0 0 1");
    harness.run();
    click(&mut harness, "Set");
    assert_eq!(pose(&session).translation_mm, glam::DVec3::new(5.0, 6.0, 707.0));
}

#[test]
fn a_mesh_is_mirrored_and_spaced_but_never_flattened() {
    let (mut harness, session) = tall_harness(small_session());
    harness.run();
    click(&mut harness, "Mesh");
    harness.get_by_label("80.0 × 60.0 × 40.0 mm, 12 triangles");
    click(&mut harness, "Mirror y");
    type_into(&mut harness, "spacing z", "2.5");
    harness.get_by_label("80.0 × 60.0 × 100.0 mm, 12 triangles");
    type_into(&mut harness, "spacing x", "0");
    harness.get_by_label_contains("a spacing of 0 is not possible");
    let frame = pinpose::scene::MeshFrame(session.borrow().scene().objects[0].mesh_from_file);
    assert!(frame.is_mirrored(1));
    assert_eq!(frame.spacing(), glam::DVec3::new(1.0, 1.0, 2.5));
}

/// Four boxes in one photo.
fn four_boxes() -> Session {
    let mut session = small_session();
    for _ in 0..3 {
        session.apply(Command::Run(CommandId::DuplicateObject), NOW_MS).unwrap();
    }
    session
}

fn names(session: &Rc<RefCell<Session>>) -> Vec<String> {
    session.borrow().scene().objects.iter().map(|object| object.name.clone()).collect()
}

#[test]
fn objects_are_chosen_with_ctrl_and_shift() {
    let (mut harness, session) = tall_harness(four_boxes());
    harness.run();
    let names = names(&session);
    click(&mut harness, &names[0]);
    harness.get_by_label(&names[2]).click_modifiers(egui::Modifiers::COMMAND);
    harness.run();
    assert_eq!(session.borrow().selection().len(), 2);
    click(&mut harness, &names[3]);
    harness.get_by_label(&names[1]).click_modifiers(egui::Modifiers::SHIFT);
    harness.run();
    assert_eq!(session.borrow().selection().len(), 3);
    assert_eq!(session.borrow().selected(), Some(session.borrow().scene().objects[1].id));
}

#[test]
fn a_row_is_renamed_moved_and_removed_by_its_menu() {
    let (mut harness, session) = tall_harness(four_boxes());
    harness.run();
    let before = names(&session);
    click(&mut harness, "More for box");
    click(&mut harness, "Rename");
    harness.get_by_label("New name").type_text("cup");
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(names(&session)[0], "cup");
    click(&mut harness, "More for cup");
    click(&mut harness, "Move down");
    assert_eq!(names(&session)[..2], [before[1].clone(), "cup".to_owned()]);
    click(&mut harness, "More for cup");
    click(&mut harness, "Remove cup");
    assert_eq!(names(&session), before[1..]);
}

#[test]
fn a_row_is_dragged_to_its_place() {
    let (mut harness, session) = tall_harness(four_boxes());
    harness.run();
    let before = names(&session);
    let from = harness.get_by_label(&before[0]).rect().center();
    let onto = harness.get_by_label(&before[2]).rect();
    harness.drag_at(from);
    harness.run();
    harness.hover_at(from + egui::vec2(0.0, 12.0));
    harness.run();
    harness.hover_at(onto.center_bottom() - egui::vec2(0.0, 4.0));
    harness.run();
    harness.drop_at(onto.center_bottom() - egui::vec2(0.0, 4.0));
    harness.run();
    let expected = [&before[1], &before[2], &before[0], &before[3]];
    assert_eq!(names(&session).iter().collect::<Vec<_>>(), expected);
}

#[test]
fn a_reference_says_how_far_it_is_and_can_be_taken_over() {
    let mut session = small_session();
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n");
    drop_files(&mut session, &[text_file("truth.txt", &truth)], Some(PosesAs::Reference));
    let (mut harness, session) = tall_harness(session);
    harness.run();
    harness.get_by_label_contains("ADD ");
    click(&mut harness, "More for truth");
    click(&mut harness, "Set pose from this");
    assert_eq!(pose(&session).translation_mm, glam::DVec3::new(5.0, 6.0, 700.0));
    harness.get_by_label_contains("ADD 0.00 mm");
    click(&mut harness, "Hide truth");
    assert!(!session.borrow().scene().references[0].visible);
}

#[test]
fn the_history_is_searched_and_returned_to() {
    let mut session = small_session();
    session.apply(Command::Run(CommandId::NudgeRight), NOW_MS).unwrap();
    session.apply(Command::Run(CommandId::RollLeft), NOW_MS + 61_000.0).unwrap();
    let (mut harness, session) = tall_harness(session);
    harness.run();
    // NOW_MS is 22:13:20 UTC; a native program shows UTC.
    let first = "22:13:20 box Nudge photo.png by hand";
    harness.get_by_label("22:14:21 box Nudge rotation photo.png by hand");
    click(&mut harness, "Search the history");
    harness.get_by_label("Search the history").type_text("22:13 PHOTO");
    harness.run();
    assert!(harness.query_by_label_contains("22:14:21").is_none());
    click(&mut harness, first);
    let entry = session.borrow().log()[0].camera_from_object;
    assert_eq!(pose(&session), entry);
    click(&mut harness, "Clear history list");
    harness.get_by_label("Every change of a pose is listed here.");
}

#[test]
fn hundreds_of_photos_lay_out_only_what_is_seen() {
    let mut session = small_session();
    // Pictures of different sizes are different files.
    let files: Vec<_> =
        (0..200).map(|i| flat_photo(&format!("row {i}.png"), 8 + i % 20, 8 + i / 20)).collect();
    drop_files(&mut session, &files, None);
    let (mut harness, session) = tall_harness(session);
    harness.run();
    let shown = harness.query_all_by_label_contains("More for ").count();
    assert!((5..30).contains(&shown), "{shown}");
    assert!(harness.query_by_label("row 150.png").is_none());
    let far = session.borrow().scene().photos[151].id;
    session.borrow_mut().apply(Command::ShowPhoto(far), NOW_MS).unwrap();
    harness.run();
    harness.get_by_label("row 150.png");
}

#[test]
fn what_is_in_the_panel_never_makes_it_wider() {
    let (mut harness, _) = tall_harness(small_session());
    harness.run();
    let left = harness.get_by_label("Viewport").rect().left();
    for section in ["Pose values", "Mesh", "Nudge", "Lens distortion"] {
        click(&mut harness, section);
    }
    for form in ["Euler xyz", "Quaternion", "Axis-angle"] {
        click(&mut harness, "Rotation as");
        harness.get_all_by_label(form).last().unwrap().click();
        harness.run();
        assert_eq!(harness.get_by_label("Viewport").rect().left(), left);
    }
}

#[test]
fn masks_are_listed_where_they_belong() {
    let mut session = small_session();
    let mask = pinpose::formats::read_photo(&flat_photo("mask.png", 640, 480)).unwrap().0;
    session.apply(Command::ImportMasks(vec![std::sync::Arc::new(mask)]), NOW_MS).unwrap();
    let (mut harness, session) = tall_harness(session);
    harness.run();
    click(&mut harness, "Hide mask.png");
    assert!(!session.borrow().scene().masks[0].visible);
    click(&mut harness, "More for mask.png");
    click(&mut harness, "No object");
    assert_eq!(session.borrow().scene().masks[0].object, None);
}

#[test]
fn the_look_is_changed_by_buttons() {
    let (mut harness, session) = tall_harness(small_session());
    harness.run();
    click(&mut harness, "Overlay mode");
    click(&mut harness, "Normals");
    click(&mut harness, "X-ray");
    click(&mut harness, "Show the photo alone");
    let look = session.borrow().look();
    assert_eq!(look.mode, pinpose::scene::OverlayMode::Normals);
    assert!(look.x_ray && look.layers == pinpose::scene::Layers::PhotoOnly);
    click(&mut harness, "Reset look");
    assert_eq!(session.borrow().look(), pinpose::scene::Look::default());
}

#[test]
fn nudges_and_their_steps_are_set_by_buttons() {
    let (mut harness, session) = tall_harness(small_session());
    let start = pose(&session);
    harness.run();
    click(&mut harness, "Nudge");
    type_into(&mut harness, "nudge step degrees", "5");
    click(&mut harness, "Roll left");
    assert!((pose(&session).angle_to(&start).to_degrees() - 5.0).abs() < 1e-9);
    click(&mut harness, "Object");
    assert_eq!(session.borrow().nudge_settings().frame, pinpose::session::NudgeFrame::Object);
}
