//! What goes on over several frames: snap on all photos, and the search for symmetries, through the whole program.

use std::rc::Rc;

use egui_kittest::kittest::Queryable as _;
use pinpose::formats::NamedFile;
use pinpose::platform::{MemoryStorage, PageCall};

use crate::program::Program;
use crate::support::named_file;

/// The example's tin, moved by 4 mm across and 9 mm away from where it is in the photo.
fn program_with_a_moved_tin() -> Program {
    let mut program = Program::start(&Rc::new(MemoryStorage::default()));
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/example.zip");
    let example: NamedFile = named_file(&path);
    program.load(&[example]);
    let mut rows = tin(&mut program);
    (rows[0][3], rows[2][3]) = (rows[0][3] + 4.0, rows[2][3] + 9.0);
    program.ask(PageCall::SetPose { photo: 1, object: 2, camera_from_object: rows });
    program
}

/// Where the tin is.
fn tin(program: &mut Program) -> [[f64; 4]; 4] {
    let document: serde_json::Value = serde_json::from_str(&program.state().document_json).unwrap();
    let poses = document["photos"][0]["poses"].as_array().unwrap();
    let tin = poses.iter().find(|pose| pose["object"] == 2).unwrap();
    serde_json::from_value(tin["camera_from_object"].clone()).unwrap()
}

#[test]
fn snap_on_all_photos_is_one_step_that_says_what_it_did() {
    let mut program = program_with_a_moved_tin();
    let before = tin(&mut program);
    program.command("snap_all");
    let state = program
        .wait("it is snapped", |state| state.notices.iter().any(|notice| notice.starts_with("Snapped")));
    // The car was never touched, so it is not among them.
    let said = state.notices.iter().find(|notice| notice.starts_with("Snapped")).unwrap();
    assert!(said.contains("1 of 1 poses") && said.contains("Least sure: tea tin"), "{said}");
    assert_ne!(tin(&mut program), before);
    program.harness.step();
    let line = "Snap on all photos Snapped 1 of 1 poses";
    assert!(program.harness.query_all_by_label_contains(line).next().is_some(), "the history says so too");
    program.command("undo");
    assert_eq!(tin(&mut program), before);
}

#[test]
fn symmetries_are_looked_for_by_the_worker() {
    let mut program = program_with_a_moved_tin();
    program.command("find_symmetries");
    let state = program.wait("it was looked", |state| {
        !state.busy && state.notices.iter().any(|notice| notice.contains("symmetr"))
    });
    // The toy car is selected, and has a front and wheels.
    let found_none = |notice: &String| notice.starts_with("No symmetry found");
    assert!(state.notices.iter().any(found_none), "{:?}", state.notices);
}
