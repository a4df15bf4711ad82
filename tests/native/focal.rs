//! A focal length by eye: the picture stays, depths follow, one step a drag, saved and read back.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::{DVec2, DVec3};
use pinpose::formats::{Keep, read_document, write_document};
use pinpose::interact::Hands;
use pinpose::photo::ExifFocalSource;
use pinpose::scene::{AnnotationState, CameraOrigin, PoseSource};
use pinpose::session::{Command, CommandId, ObjectChange, Opening, Session};
use pinpose::ui::{self, UiState};

use crate::support::{NOW_MS, quiet_surroundings, small_session};

fn posed_session() -> Session {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let turn = pinpose::math::Pose::exp(DVec3::new(0.5, 0.6, 0.1), DVec3::ZERO);
    let pose = (annotation.camera_from_object * turn).translated(DVec3::new(30.0, -20.0, 50.0));
    let set = Command::SetPose { photo, object, camera_from_object: pose, source: PoseSource::Manual };
    session.apply(set, NOW_MS).unwrap();
    session
}

/// Where the object's middle is seen, and how far away it is.
fn middle(session: &Session) -> (DVec2, f64) {
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let center_mm = session.scene().object(object).unwrap().mesh.mesh.sphere().center;
    let center = annotation.camera_from_object.transform_point(center_mm);
    (session.scene().photo(photo).unwrap().camera.project(center).unwrap(), center.z)
}

#[test]
fn depth_follows_the_focal_length_and_is_undone_with_it() {
    let mut session = posed_session();
    let photo = session.photo().unwrap().id;
    let (camera, before) = (session.photo().unwrap().camera, middle(&session));
    let rotation = session.selected_annotation().unwrap().2.camera_from_object.rotation;
    session.apply(Command::BeginGesture("Focal length"), NOW_MS).unwrap();
    for factor in [0.7, 3.0, 0.5, 1.2] {
        session.apply(Command::SetFocal { photo, fx: camera.fx * factor }, NOW_MS).unwrap();
    }
    session.apply(Command::EndGesture, NOW_MS).unwrap();
    let after = middle(&session);
    let shown = session.photo().unwrap();
    assert!(
        (shown.camera.fx / camera.fx - 1.2).abs() < 1e-12
            && (shown.camera.fy / camera.fy - 1.2).abs() < 1e-12
    );
    // Each step goes from where the drag began, so this is the rounding of one.
    assert!(
        (after.1 / before.1 - 1.2).abs() < 1e-12 && after.0.distance(before.0) < 1e-9,
        "{after:?} {before:?}"
    );
    let (_, _, annotation) = session.selected_annotation().unwrap();
    assert_eq!((annotation.camera_from_object.rotation, annotation.source), (rotation, PoseSource::Manual));
    assert!(
        annotation.camera_changed && annotation.state == AnnotationState::Posed,
        "it wants a second look"
    );
    assert_eq!(shown.camera_origin, CameraOrigin::Slider { before_px: camera.fx });
    assert!(shown.camera_origin.is_guess() && shown.given_camera.0 == camera);
    assert_eq!(session.log().last().unwrap().label, "Focal length");

    // Another drag goes on from there; what it is compared with stays.
    session.apply(Command::SetFocal { photo, fx: camera.fx * 1.5 }, NOW_MS).unwrap();
    assert_eq!(session.photo().unwrap().camera_origin, CameraOrigin::Slider { before_px: camera.fx });
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!((session.photo().unwrap().camera, middle(&session)), (camera, before));
    for fx in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        session.apply(Command::SetFocal { photo, fx }, NOW_MS).unwrap_err();
    }
    assert_eq!(session.photo().unwrap().camera, camera);
}

#[test]
fn what_is_locked_or_confirmed_stays() {
    let mut session = posed_session();
    let (photo, object) = (session.photo().unwrap().id, session.selected().unwrap());
    session.apply(Command::EditObject(object, ObjectChange::Locked(true)), NOW_MS).unwrap();
    let depth_mm = middle(&session).1;
    session.apply(Command::SetFocal { photo, fx: 900.0 }, NOW_MS).unwrap();
    assert_eq!(middle(&session).1, depth_mm);
    assert!(session.selected_annotation().unwrap().2.camera_changed);
    let lock = pinpose::session::PhotoChange::Locked(true);
    session.apply(Command::EditPhoto(photo, lock), NOW_MS).unwrap();
    session.apply(Command::SetFocal { photo, fx: 700.0 }, NOW_MS).unwrap_err();
}

#[test]
fn origins_are_saved_and_read_back() {
    let mut session = posed_session();
    let (photo, camera) = (session.photo().unwrap().id, session.photo().unwrap().camera);
    let exif = |source| CameraOrigin::Exif(source);
    for origin in [
        CameraOrigin::Slider { before_px: 512.25 },
        exif(ExifFocalSource::Equivalent),
        exif(ExifFocalSource::FocalPlane),
        exif(ExifFocalSource::SensorTable),
    ] {
        session.apply(Command::SetCamera { photo, camera, origin: origin.clone() }, NOW_MS).unwrap();
        let text = write_document(&session.document(Keep::Everything));
        // Files of before there was more than one way are read, and read by programs of then.
        assert_eq!(
            text.contains("\"sensor\""),
            !matches!(&origin, CameraOrigin::Slider { .. } | CameraOrigin::Exif(ExifFocalSource::Equivalent))
        );
        let opening = Opening {
            document: read_document(text.as_bytes()).unwrap(),
            photos: session.scene().photos.iter().map(|photo| photo.asset.clone()).collect(),
            meshes: vec![session.scene().objects[0].mesh.clone()],
            restored: false,
        };
        let mut reopened = Session::default();
        reopened.apply(Command::Open(Box::new(opening)), NOW_MS).unwrap();
        assert_eq!(reopened.photo().unwrap().camera_origin, origin);
    }
}

#[test]
fn a_drag_of_the_slider_is_one_step_and_says_what_it_does() {
    let session = Rc::new(RefCell::new(posed_session()));
    let shared = session.clone();
    let mut state = UiState::default();
    let mut harness = Harness::builder().with_size([1024.0, 1200.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let asked = ui::draw(ui, &shared.borrow(), &quiet_surroundings(&hands), &mut state);
        for command in asked.commands {
            shared.borrow_mut().apply(command, NOW_MS).unwrap();
        }
    });
    harness.run();
    let (camera, before) = (session.borrow().photo().unwrap().camera, middle(&session.borrow()));
    let slider = harness.get_by_label("Focal length with depth").rect();
    let at = |part: f32| egui::pos2(slider.left() + part * slider.width(), slider.center().y);
    harness.hover_at(at(0.4));
    harness.run();
    harness.drag_at(at(0.4));
    for part in [0.5, 0.6, 0.7] {
        harness.hover_at(at(part));
        harness.run();
    }
    harness.drop_at(at(0.7));
    harness.run();
    let factor = session.borrow().photo().unwrap().camera.fx / camera.fx;
    let (pixel, depth_mm) = middle(&session.borrow());
    assert!(factor > 1.5 && (depth_mm / before.1 / factor - 1.0).abs() < 1e-9, "{factor} {depth_mm}");
    assert!(pixel.distance(before.0) < 1e-9);
    let percent = 100.0 * (factor - 1.0);
    harness.get_by_label(&format!(
        "Focal length estimated by eye. Depth follows: {depth_mm:.0} mm, {percent:+.0} %."
    ));
    if let Ok(picture) = harness.render() {
        picture.save(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("focal-slider.png")).unwrap();
    }
    assert!(!session.borrow().gesture_under_way());
    session.borrow_mut().apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!((session.borrow().photo().unwrap().camera, middle(&session.borrow())), (camera, before));
}
