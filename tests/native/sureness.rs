//! How sure a pose is: from pins and from a snap, with tolerances, in the panel.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::{DVec2, DVec3};
use pinpose::interact::Hands;
use pinpose::scene::{CameraOrigin, Fold, Pin, PoseSource, SymmetryAxis};
use pinpose::session::{Command, CommandId, ObjectChange, PinChange, Session};
use pinpose::solve::{Tolerances, TwistCovariance, Uncertainty, Weakness};
use pinpose::ui::{self, ShownMotion, UiState};

use crate::support::{NOW_MS, quiet_surroundings, small_session};

const EXACT: Tolerances = Tolerances { focal: 0.0, mesh_scale: 0.0 };

/// Pins on six corners of the box, each a pixel or so off.
fn pinned_session() -> Session {
    let mut session = small_session();
    let (photo, _, annotation) = session.selected_annotation().unwrap();
    let camera = session.scene().photo(photo).unwrap().camera;
    let turn = pinpose::math::Pose::exp(DVec3::new(0.5, 0.6, 0.1), DVec3::ZERO);
    let pose = annotation.camera_from_object * turn;
    let corner = |number: u32| {
        let side = |bit: u32, half: f64| if number & bit == 0 { -half } else { half };
        let point = DVec3::new(side(1, 40.0), side(2, 30.0), side(4, 20.0));
        let off = DVec2::new(f64::from(number % 3) - 1.0, f64::from(number % 2) - 0.5);
        Pin::new(point, camera.project(pose.transform_point(point)).unwrap() + off)
    };
    let pins: Vec<Pin> = (0..6).map(corner).collect();
    session.apply(Command::EditPins(PinChange::Replace(pins)), NOW_MS).unwrap();
    session
}

#[test]
fn tolerances_and_snaps_change_how_sure_a_pose_is() {
    let mut session = pinned_session();
    let by_pins = session.sureness(&EXACT).unwrap();
    assert_eq!(by_pins.source, PoseSource::Pins);
    let helpful = by_pins.helpful_pin.unwrap();
    assert!(helpful.depth_mm < by_pins.uncertainty.depth_mm && helpful.way.length() < 1.1, "{helpful:?}");

    let focal = Tolerances { focal: 0.02, ..EXACT };
    let unsure = session.sureness(&focal).unwrap();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let pose = annotation.camera_from_object;
    let expected = by_pins.uncertainty.depth_mm.hypot(0.02 * pose.translation_mm.length());
    // Rounding of 400² on the way to the camera's centre and back.
    assert!((unsure.uncertainty.depth_mm - expected).abs() < 1e-6, "{unsure:?}");
    assert_eq!(unsure.weakest.unwrap().kind, Weakness::Depth);
    let after_pin = helpful.depth_mm.hypot(unsure.by_tolerances_mm);
    assert!((unsure.helpful_pin.unwrap().depth_mm - after_pin).abs() < 1e-6, "a pin tells no focal length");

    // A snap's own covariance, as long as the pose is the snap's.
    let snapped = pose.translated(DVec3::X);
    let mut steps = [[0.0; 6]; 6];
    (0..6).for_each(|i| steps[i][i] = if i == 2 { 0.04 } else { 1e-6 });
    let covariance = TwistCovariance::from_steps_about(snapped.translation_mm, &steps);
    let covariance = Some(Box::new(covariance));
    let take = Command::TakeSnap { photo, object, camera_from_object: snapped, covariance };
    session.apply(take, NOW_MS).unwrap();
    let by_snap = session.sureness(&EXACT).unwrap();
    assert_eq!((by_snap.source, by_snap.weakest.unwrap().kind), (PoseSource::Snap, Weakness::Roll));
    // It is of this camera alone.
    let fx_of = |session: &mut Session, factor: f64| {
        let before = session.photo().unwrap();
        let (photo, mut camera) = (before.id, before.camera);
        camera.fx *= factor;
        session.apply(Command::SetCamera { photo, camera, origin: CameraOrigin::Typed }, NOW_MS).unwrap();
    };
    fx_of(&mut session, 1.1);
    assert!(session.sureness(&EXACT).is_none_or(|sureness| sureness.source != PoseSource::Snap));
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!(session.sureness(&EXACT), Some(by_snap));
    let moved = snapped.translated(DVec3::Y * 3.0);
    let set = Command::SetPose { photo, object, camera_from_object: moved, source: PoseSource::Manual };
    session.apply(set, NOW_MS).unwrap();
    assert_eq!(session.sureness(&EXACT), None, "nothing is known of a pose by hand");
    // Until a snap looked, though it found none that is better.
    let fx = 1.05 * session.photo().unwrap().camera.fx;
    session.apply(Command::SetFocal { photo, fx }, NOW_MS).unwrap();
    let pose = session.selected_annotation().unwrap().2.camera_from_object;
    let covariance = Some(Box::new(TwistCovariance::from_steps_about(pose.translation_mm, &steps)));
    session.apply(Command::NoteSnap { photo, object, covariance }, NOW_MS).unwrap();
    assert_eq!(session.selected_annotation().unwrap().2.camera_from_object, pose);
    let kept = session.sureness(&EXACT).unwrap();
    assert_eq!(kept.source, PoseSource::Snap);
    // A focal length by eye is counted without anybody saying so.
    let sigma = kept.guessed_focal.unwrap();
    let depth_mm = kept.uncertainty.depth_mm;
    assert!(sigma > 0.0 && depth_mm > 0.99 * sigma * pose.translation_mm.z, "{kept:?}");
}

#[test]
fn turns_about_axes_of_symmetry_are_no_error() {
    let mut session = pinned_session();
    let object = session.selected().unwrap();
    let plain = session.sureness(&EXACT).unwrap();
    let mut add = |axis: DVec3| {
        let axis = SymmetryAxis { axis, through_mm: DVec3::ZERO, fold: Fold::Continuous };
        session.apply(Command::EditObject(object, ObjectChange::AddSymmetry(axis)), NOW_MS).unwrap();
        session.sureness(&EXACT).unwrap()
    };
    let round = add(DVec3::Y);
    assert!(round.leaves_out_turns && !plain.leaves_out_turns);
    assert!(round.uncertainty.tilt_rad <= plain.uncertainty.tilt_rad);
    // A second axis makes it a ball: all its turns look the same.
    let ball = add(DVec3::X);
    let Uncertainty { tilt_rad, roll_rad, depth_mm, .. } = ball.uncertainty;
    // Rounding of 400² on the way to the camera's centre and back.
    assert!(tilt_rad < 1e-6 && roll_rad < 1e-6, "{ball:?}");
    // The box's middle is on both axes, so its place is as unsure as before.
    assert!((depth_mm - plain.uncertainty.depth_mm).abs() < 1e-6, "{ball:?}");
    assert!(matches!(ball.weakest.unwrap().kind, Weakness::Depth | Weakness::Lateral));
}

#[test]
fn the_panel_shows_the_numbers_and_the_weakest_direction() {
    let session = Rc::new(RefCell::new(pinned_session()));
    let motion = Rc::new(RefCell::new(None));
    let (shared, shown) = (session.clone(), motion.clone());
    let mut state = UiState::default();
    let mut harness = Harness::builder().with_size([1024.0, 1200.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let asked = ui::draw(ui, &shared.borrow(), &quiet_surroundings(&hands), &mut state);
        if asked.show_motion.is_some() {
            *shown.borrow_mut() = asked.show_motion;
        }
    });
    harness.run();
    harness.get_by_label_contains("mm sideways");
    harness.get_by_label_contains("The next pin helps most at");
    harness.get_by_label_contains("Depth is least sure. A photo from the side");
    harness.get_by_label("focal tolerance").click();
    harness.run();
    harness.get_by_label("focal tolerance").type_text("5");
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    // 5 % of the distance is more than the pins leave open in any direction, and no pin changes that.
    harness.get_by_label_contains("a calibrated camera and a measured mesh");
    assert!(harness.query_by_label_contains("A photo from the side").is_none(), "it would be off there too");
    harness.get_by_label("Show how far the depth may be off").click();
    harness.run();
    assert!(matches!(*motion.borrow(), Some(ShownMotion::Sway(weakest)) if weakest.kind == Weakness::Depth));
    // A guess is more than what was typed.
    {
        let mut session = session.borrow_mut();
        let photo = session.photo().unwrap();
        let (photo, camera, origin) = (photo.id, photo.camera, CameraOrigin::AssumedFieldOfView);
        session.apply(Command::SetCamera { photo, camera, origin }, NOW_MS).unwrap();
    }
    harness.run();
    harness.get_by_label_contains("Most of the depth's comes from the estimated focal length");
    if let Ok(picture) = harness.render() {
        picture.save(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("sureness-panel.png")).unwrap();
    }
}
