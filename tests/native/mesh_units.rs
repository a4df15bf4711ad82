//! Units and axes of meshes: read, guessed and asked about, chosen, saved.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions};
use glam::{DMat4, DVec3};
use pinpose::formats::{Incoming, Keep, NamedFile, PosesAs};
use pinpose::interact::Hands;
use pinpose::math::Pose;
use pinpose::mesh::MeshUnit;
use pinpose::scene::{Object, PoseSource};
use pinpose::session::{Command, CommandId, ObjectChange, Session};
use pinpose::ui::{self, UiState};

use crate::support::{
    CAMERA_JSON, NOW_MS, box_mesh, drop_files, empty_folder, flat_photo, pinpose, quiet_surroundings,
    text_file,
};

/// A box with sides of 4:3:2, the longest one this long, with comments before it.
fn box_of(side: f64, comment: &str) -> NamedFile {
    let text = String::from_utf8(box_mesh("cup.obj").bytes.to_vec()).unwrap();
    let scaled = |line: &str| match line.strip_prefix("v ") {
        Some(numbers) => {
            let numbers = numbers.split(' ').map(|n| (n.parse::<f64>().unwrap() * side / 80.0).to_string());
            format!("v {}\n", numbers.collect::<Vec<_>>().join(" "))
        }
        None => format!("{line}\n"),
    };
    text_file("cup.obj", &(comment.to_owned() + &text.lines().map(scaled).collect::<String>()))
}

fn session_of(mesh: NamedFile) -> Session {
    let mut session = Session::default();
    drop_files(
        &mut session,
        &[flat_photo("photo.png", 640, 480), mesh, text_file("camera.json", CAMERA_JSON)],
        None,
    );
    session
}

fn object(session: &Session) -> Object {
    session.scene().objects[0].clone()
}

fn longest_mm(session: &Session) -> f64 {
    object(session).mesh.mesh.bounds().size().max_element()
}

fn run(session: &mut Session, command: Command) {
    session.apply(command, NOW_MS).unwrap();
}

fn pose(session: &Session) -> Pose {
    session.selected_annotation().unwrap().2.camera_from_object
}

#[test]
fn a_mesh_is_asked_about_only_where_its_unit_is_doubtful() {
    for (side, comment, likely, mm) in [
        (80.0, "", None, 80.0),
        (3000.0, "", None, 3000.0),
        (0.12, "", Some(MeshUnit::Metre), 120.0),
        (12.0, "", Some(MeshUnit::Centimetre), 120.0),
        (30.0, "", Some(MeshUnit::Millimetre), 30.0),
        (4.0, "# File units = inches\n", None, 101.6),
        (0.5, "# units: mm\n", None, 0.5),
    ] {
        let session = session_of(box_of(side, comment));
        assert_eq!(session.unit_question().map(|question| question.likely), likely, "{side} {comment}");
        assert!((longest_mm(&session) / mm - 1.0).abs() < 1e-6, "{side}: {} mm", longest_mm(&session));
        assert!(session.question().is_none(), "nothing waits for it");
        // Whatever it is, it is placed so that it covers as much of the photo as any other.
        let distance_in_radii = |session: &Session| {
            pose(session).translation_mm.length() / object(session).mesh.mesh.sphere().radius
        };
        let usual = distance_in_radii(&session_of(box_of(80.0, "")));
        assert!((distance_in_radii(&session) / usual - 1.0).abs() < 1e-5);
    }
}

#[test]
fn an_answer_is_one_step_and_undone_without_a_trace() {
    let mut session = session_of(box_of(0.12, ""));
    let start = object(&session);
    let placed = pose(&session);
    run(&mut session, Command::AnswerUnit(MeshUnit::Inch));
    assert!(session.unit_question().is_none());
    assert!((longest_mm(&session) - 3.048).abs() < 1e-6);
    assert!(
        (pose(&session).translation_mm.z / placed.translation_mm.z - 0.0254).abs() < 1e-9,
        "placed again"
    );
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!((object(&session).mesh_from_file, pose(&session)), (start.mesh_from_file, placed));
    assert_eq!(object(&session).mesh.mesh, start.mesh.mesh);

    // What is likely needs no step.
    let mut session = session_of(box_of(0.12, ""));
    let label = session.undo_label().map(str::to_owned);
    run(&mut session, Command::AnswerUnit(MeshUnit::Metre));
    assert_eq!((session.unit_question(), session.undo_label().map(str::to_owned)), (None, label));
    assert!(session.apply(Command::AnswerUnit(MeshUnit::Metre), NOW_MS).is_err());
}

#[test]
fn a_question_goes_when_it_is_settled_otherwise() {
    let mut session = session_of(box_of(0.12, ""));
    let id = object(&session).id;
    run(&mut session, Command::EditObject(id, ObjectChange::MeshUnit(MeshUnit::Centimetre)));
    assert!(session.unit_question().is_none());
    run(&mut session, Command::RemoveObject(id));
    assert!(session.unit_question().is_none());
}

#[test]
fn poses_by_hand_keep_the_picture_and_imported_ones_their_millimetres() {
    let mut session = session_of(box_of(12.0, ""));
    let (photo, object, _) = session.selected_annotation().unwrap();
    let by_hand = Pose::from_translation(DVec3::new(10.0, 20.0, 600.0));
    let set = |camera_from_object, source| Command::SetPose { photo, object, camera_from_object, source };
    run(&mut session, set(by_hand, PoseSource::Manual));
    run(&mut session, Command::EditObject(object, ObjectChange::MeshUnit(MeshUnit::Metre)));
    assert!((pose(&session).translation_mm - DVec3::new(1000.0, 2000.0, 60_000.0)).length() < 1e-6);
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!(pose(&session), by_hand);
    run(&mut session, set(by_hand, PoseSource::Imported));
    run(&mut session, Command::EditObject(object, ObjectChange::MeshUnit(MeshUnit::Metre)));
    assert_eq!(pose(&session), by_hand);
}

#[test]
fn the_unit_and_the_axes_are_saved_and_come_back_without_a_question() {
    let mut session = session_of(box_of(0.12, ""));
    let id = object(&session).id;
    run(&mut session, Command::EditObject(id, ObjectChange::UpAxis(1)));
    // A box of 120 × 90 × 60 with y up is 120 × 60 × 90 with z up.
    let size = object(&session).mesh.mesh.bounds().size();
    assert!((size - DVec3::new(120.0, 60.0, 90.0)).length() < 1e-4, "{size}");
    let saved = session.document(Keep::Everything);
    let incoming = Incoming::from_document("poses.json", &saved).unwrap();
    let mut again = Session::default();
    let mut batch = crate::support::batch_of(
        &[flat_photo("photo.png", 640, 480), box_of(0.12, "")],
        Some(PosesAs::Annotations),
    );
    batch.poses.push(incoming);
    run(&mut again, Command::Import(Box::new(batch)));
    assert!(again.unit_question().is_none());
    assert_eq!(object(&again).mesh_from_file, object(&session).mesh_from_file);
    assert_eq!(object(&again).mesh.mesh, object(&session).mesh.mesh);
    let id = object(&again).id;
    run(&mut again, Command::EditObject(id, ObjectChange::UpAxis(2)));
    run(&mut again, Command::EditObject(id, ObjectChange::MeshUnit(MeshUnit::Millimetre)));
    assert_eq!(object(&again).mesh_from_file, DMat4::IDENTITY);
    assert_eq!(longest_mm(&again), f64::from(0.06_f32) * 2.0, "no digit was lost");
}

/// A session behind the interface.
fn harness(session: Session) -> (Harness<'static>, Rc<RefCell<Session>>) {
    let session = Rc::new(RefCell::new(session));
    let shared = session.clone();
    let mut state = UiState::default();
    let harness = Harness::builder().with_size([1024.0, 1300.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let asked = ui::draw(ui, &shared.borrow(), &quiet_surroundings(&hands), &mut state);
        for command in asked.commands {
            shared.borrow_mut().apply(command, NOW_MS).unwrap();
        }
    });
    (harness, session)
}

#[test]
fn the_card_names_the_sizes_and_the_panel_changes_them() {
    let (mut harness, session) = harness(session_of(box_of(0.12, "")));
    harness.run();
    for text in [
        "In which unit is cup?",
        "Taken as metres for now; you can go on.",
        "The longest side would be 120 mm.",
        "The longest side would be 0.12 mm.",
        "The longest side would be 3.0 mm.",
    ] {
        harness.get_by_label(text);
    }
    harness.get_by_label("Mesh").click();
    harness.run();
    if crate::support::renderer().is_some() {
        harness.snapshot_options(
            "mesh-unit",
            &SnapshotOptions::new().threshold(2.0).output_path("tests/snapshots"),
        );
    }
    harness.get_by_label("Centimetres").click();
    harness.run();
    assert!(harness.query_by_label("In which unit is cup?").is_none());
    assert!((longest_mm(&session.borrow()) - 1.2).abs() < 1e-6);
    harness.get_by_label("Unit metres").click();
    harness.run();
    assert!((longest_mm(&session.borrow()) - 120.0).abs() < 1e-4);
    harness.get_by_label("Up is y").click();
    harness.run();
    harness.get_by_label("120.0 × 60.0 × 90.0 mm, 12 triangles");
    harness.get_by_label("Up is z").click();
    harness.run();
    harness.get_by_label("120.0 × 90.0 × 60.0 mm, 12 triangles");
}

#[test]
fn the_command_line_says_what_it_takes_for_granted() {
    let folder = empty_folder("mesh-unit");
    for file in [flat_photo("photo.png", 640, 480), box_of(0.12, "")] {
        std::fs::write(folder.join(file.name), &file.bytes).unwrap();
    }
    let path = |name: &str| folder.join(name).display().to_string();
    let inspected = pinpose(&["inspect", &path("cup.obj"), "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&inspected.stdout).unwrap();
    assert_eq!(found[0]["content"]["unit"], "m");
    assert_eq!(found[0]["content"]["unit_from"], "its size, doubtful");
    assert!((found[0]["content"]["size_mm"][0].as_f64().unwrap() - 120.0).abs() < 1e-4);

    let inputs = [path("photo.png"), path("cup.obj")];
    let taken = pinpose(&["convert", &inputs[0], &inputs[1], &path("guessed.json"), "--all-poses"]);
    let said = String::from_utf8_lossy(&taken.stderr);
    assert!(said.contains("cup.obj") && said.contains("metres") && said.contains("120 mm"), "{said}");
    let told =
        pinpose(&["convert", &inputs[0], &inputs[1], &path("told.json"), "--all-poses", "--mesh-unit", "cm"]);
    assert!(!String::from_utf8_lossy(&told.stderr).contains("--mesh-unit"));
    let scale = |name: &str| {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["objects"][0]["mesh_from_file"][0][0]
            .as_f64()
    };
    assert_eq!((scale("guessed.json"), scale("told.json")), (Some(1000.0), Some(10.0)));
}
