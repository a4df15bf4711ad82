//! The free view and the handles, as scripts; and the switch between the views, by its labels.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::{DVec2, DVec3};
use pinpose::interact::gizmo::{Axis, Gizmo, Handle};
use pinpose::interact::{
    Button, Eye, Gestures, Hands, Modifiers, PhotoView, PointerAction, PointerEvent, SceneView, StandardView,
    Viewpoint, other_cameras, pick_along,
};
use pinpose::math::Pose;
use pinpose::scene::PoseSource;
use pinpose::session::{Arrangement, Command, CommandId, ObjectChange, Session};
use pinpose::ui::{self, UiState};

use crate::support::{NOW_MS, box_mesh, drop_files, flat_photo, quiet_surroundings, small_session};

struct Hand<V> {
    session: Session,
    view: V,
    gestures: Gestures,
    modifiers: Modifiers,
}

fn in_scene_view() -> Hand<SceneView> {
    let session = small_session();
    let mut view = SceneView::default();
    view.set_scene(DVec2::new(800.0, 600.0), &session);
    Hand { session, view, gestures: Gestures::default(), modifiers: Modifiers::default() }
}

fn in_photo_view() -> Hand<PhotoView> {
    let mut view = PhotoView::default();
    view.set_sizes(DVec2::new(800.0, 600.0), DVec2::new(640.0, 480.0));
    Hand { session: small_session(), view, gestures: Gestures::default(), modifiers: Modifiers::default() }
}

impl<V: Viewpoint> Hand<V> {
    fn act(&mut self, position: DVec2, action: PointerAction) {
        let event = PointerEvent { position, action, modifiers: self.modifiers };
        for command in self.gestures.handle(&event, &self.session, &mut self.view) {
            self.session.apply(command, NOW_MS).unwrap();
        }
    }

    fn press_and_move(&mut self, button: Button, from: DVec2, to: DVec2) {
        self.act(from, PointerAction::Press(button));
        for step in 1..=8 {
            self.act(from.lerp(to, f64::from(step) / 8.0), PointerAction::Move);
        }
    }

    fn drag(&mut self, button: Button, from: DVec2, to: DVec2) {
        self.press_and_move(button, from, to);
        self.act(to, PointerAction::Release(button));
    }

    fn run(&mut self, id: CommandId) {
        self.session.apply(Command::Run(id), NOW_MS).unwrap();
    }

    fn eye(&self) -> Eye {
        self.view.eye(&self.session).unwrap()
    }

    fn pose(&self) -> Pose {
        self.session.selected_annotation().unwrap().2.camera_from_object
    }

    /// Where the middle of the box is seen.
    fn middle(&self) -> DVec2 {
        self.eye().project(self.pose().translation_mm).unwrap()
    }

    fn gizmo(&self) -> Gizmo {
        Gizmo::of(&self.session, &self.eye(), 1.0).unwrap()
    }

    /// A point where a handle, and no other, is taken.
    fn point_on(&self, handle: Handle) -> DVec2 {
        let gizmo = self.gizmo();
        let shape = gizmo.shapes.iter().find(|shape| shape.handle == handle).unwrap();
        let on_lines = shape.front.iter().flatten().copied();
        let candidates =
            shape.knob.map(|(center, _)| center).into_iter().chain(shape.head.map(|head| head[0]));
        let taken = |point: &DVec2| gizmo.handle_at(*point) == Some(handle);
        candidates.chain(on_lines).find(taken).unwrap()
    }
}

#[test]
fn at_first_everything_is_in_view_from_behind_the_camera() {
    let hand = in_scene_view();
    let eye = hand.eye();
    let inside = |point: DVec3| {
        let seen = eye.project(point).unwrap();
        assert!(
            seen.cmpge(DVec2::ZERO).all() && seen.cmple(DVec2::new(800.0, 600.0)).all(),
            "{point}: {seen}"
        );
    };
    inside(DVec3::ZERO);
    inside(hand.pose().translation_mm);
    let camera = hand.session.photo().unwrap().camera;
    let distance_mm = pinpose::interact::image_distance_mm(&hand.session);
    assert!(distance_mm > hand.pose().translation_mm.z);
    pinpose::interact::plane_corners(&camera, distance_mm).into_iter().for_each(inside);
    let position = hand.view.position_mm();
    assert!(position.z < 0.0 && position.y < 0.0, "behind and above: {position}");
}

#[test]
fn the_ground_orbits_shift_pans_and_the_wheel_keeps_what_is_under_it() {
    let mut hand = in_scene_view();
    let (ground, pose) = (DVec2::new(8.0, 8.0), hand.pose());
    let middle = hand.middle();
    hand.drag(Button::Left, ground, ground + DVec2::new(90.0, 40.0));
    assert!(hand.middle().distance(middle) < 1e-6, "what is orbited stays where it is seen");
    hand.modifiers.shift = true;
    hand.drag(Button::Left, middle, middle + DVec2::new(25.0, -30.0));
    assert!(hand.middle().distance(middle + DVec2::new(25.0, -30.0)) < 1e-6);
    hand.drag(Button::Middle, ground, ground - DVec2::new(25.0, -30.0));
    hand.modifiers.shift = false;
    assert!(hand.middle().distance(middle) < 1e-6);
    let photo = hand.session.photo().unwrap().id;
    let under = pick_along(hand.session.scene(), photo, &hand.eye().ray(middle))[0].point_camera_mm;
    hand.act(middle, PointerAction::Wheel(4.0));
    assert!(hand.eye().project(under).unwrap().distance(middle) < 1e-6);
    assert_eq!(hand.pose(), pose);
}

#[test]
fn an_object_moves_in_the_plane_of_the_view_with_the_point_that_is_held() {
    let mut hand = in_scene_view();
    let (before, middle) = (hand.pose(), hand.middle());
    let photo = hand.session.photo().unwrap().id;
    let held = pick_along(hand.session.scene(), photo, &hand.eye().ray(middle))[0];
    let target = middle + DVec2::new(40.0, 22.0);
    hand.drag(Button::Left, middle, target);
    let point = hand.pose().transform_point(held.point_object_mm);
    assert!(hand.eye().project(point).unwrap().distance(target) < 1e-6);
    let depth = |point| hand.eye().eye_from_camera.transform_point(point).z;
    assert!((depth(point) - depth(held.point_camera_mm)).abs() < 1e-6);
    assert_eq!(hand.pose().rotation, before.rotation);
    assert_eq!(hand.session.undo_label(), Some("Move"));
    hand.run(CommandId::Undo);
    assert_eq!(hand.pose(), before);
}

#[test]
fn a_right_drag_turns_about_the_centre_and_escape_puts_it_back() {
    let mut hand = in_scene_view();
    let (before, middle) = (hand.pose(), hand.middle());
    hand.press_and_move(Button::Right, middle, middle + DVec2::new(50.0, 10.0));
    assert!(hand.pose().angle_to(&before) > 0.2);
    assert!(hand.pose().translation_mm.distance(before.translation_mm) < 1e-9);
    hand.gestures.cancel();
    hand.session.apply(Command::CancelGesture, NOW_MS).unwrap();
    hand.act(middle, PointerAction::Move);
    hand.act(middle, PointerAction::Release(Button::Right));
    assert_eq!(hand.pose(), before);
}

#[test]
fn a_double_click_zooms_to_the_object_and_on_the_ground_fits() {
    let mut hand = in_scene_view();
    let middle = hand.middle();
    let from = hand.view.position_mm();
    hand.act(middle, PointerAction::DoubleClick);
    assert!(hand.view.advance(0.0) && !hand.view.advance(1.0));
    let object_mm = hand.pose().translation_mm;
    assert!(hand.view.position_mm().distance(object_mm) < from.distance(object_mm) / 2.0);
    hand.act(DVec2::new(3.0, 3.0), PointerAction::DoubleClick);
    hand.view.advance(2.0);
    hand.view.advance(3.0);
    assert!(hand.view.position_mm().distance(from) < 1.0);
}

#[test]
fn other_photos_cameras_stand_where_an_object_in_both_puts_them() {
    let mut session = Session::default();
    let mut files = vec![flat_photo("a.png", 640, 480), flat_photo("b.png", 320, 240)];
    files.push(box_mesh("box.obj"));
    drop_files(&mut session, &files, None);
    assert!(other_cameras(&session).is_empty(), "nothing is placed yet");
    let object = session.scene().objects[0].id;
    let photos: Vec<_> = session.scene().photos.iter().map(|photo| photo.id).collect();
    let poses = [
        Pose::exp(DVec3::new(0.1, 0.2, 0.3), DVec3::new(10.0, 20.0, 700.0)),
        Pose::exp(DVec3::new(-0.4, 0.1, 0.0), DVec3::new(-30.0, 0.0, 900.0)),
    ];
    for (photo, camera_from_object) in photos.iter().zip(poses) {
        let command =
            Command::SetPose { photo: *photo, object, camera_from_object, source: PoseSource::Manual };
        session.apply(command, NOW_MS).unwrap();
    }
    let others = other_cameras(&session);
    let [(other, camera_from_other)] = &others[..] else { panic!("{others:?}") };
    let shown = session.photo().unwrap().id;
    let (of_shown, of_other) = if shown == photos[0] { (poses[0], poses[1]) } else { (poses[1], poses[0]) };
    assert_ne!(other.id, shown);
    // Seen by the other camera and put into this one's frame, the object is where it is.
    let object_in_camera = *camera_from_other * of_other;
    assert!(object_in_camera.translation_mm.distance(of_shown.translation_mm) < 1e-9);
    assert!(object_in_camera.angle_to(&of_shown) < 1e-7);
}

#[test]
fn an_arrow_moves_along_its_axis_alone() {
    for axis in [Axis::X, Axis::Y] {
        let mut hand = in_photo_view();
        hand.run(CommandId::ToggleGizmo);
        let (before, from) = (hand.pose(), hand.point_on(Handle::Move(axis)));
        // Mostly along the axis, a little off it.
        let way = (from - hand.middle()).normalize();
        hand.press_and_move(Button::Left, from, from + way * 50.0 + way.perp() * 9.0);
        let moved = hand.pose().translation_mm - before.translation_mm;
        let direction = axis.direction();
        assert!(moved.dot(direction) > 10.0, "{axis:?}: {moved}");
        assert!((moved - direction * moved.dot(direction)).length() < 1e-9);
        let amount = hand.gestures.handle_drag().unwrap().amount;
        assert!((amount - moved.dot(direction)).abs() < 1e-9, "what is read is what is done");
        hand.act(from, PointerAction::Release(Button::Left));
    }
}

#[test]
fn a_ring_turns_about_its_axis_and_alt_is_ten_times_finer() {
    for axis in Axis::ALL {
        let mut angles = [0.0; 2];
        for (angle, alt) in angles.iter_mut().zip([false, true]) {
            let mut hand = in_scene_view();
            hand.run(CommandId::ToggleGizmo);
            hand.modifiers.alt = alt;
            let (before, from) = (hand.pose(), hand.point_on(Handle::Turn(axis)));
            let tangent = (from - hand.middle()).normalize().perp();
            hand.drag(Button::Left, from, from + tangent * 30.0);
            let turn = hand.pose().rotation * before.rotation.transpose();
            assert!((turn * axis.direction()).distance(axis.direction()) < 1e-9, "{axis:?}");
            assert!(hand.pose().translation_mm.distance(before.translation_mm) < 1e-9);
            assert_eq!(hand.session.undo_label(), Some("Rotate"));
            *angle = hand.pose().angle_to(&before);
        }
        assert!(angles[0] > 0.02, "{axis:?}: {angles:?}");
        // The fine drag stays near its start, where the same way may be a somewhat different angle.
        assert!((2.0..50.0).contains(&(angles[0] / angles[1])), "{axis:?}: {angles:?}");
    }
}

#[test]
fn the_outer_ring_rolls_and_its_knob_brings_nearer_on_the_same_pixel() {
    let mut hand = in_photo_view();
    hand.run(CommandId::ToggleGizmo);
    let (before, middle) = (hand.pose(), hand.middle());
    let from = hand.point_on(Handle::Roll);
    let quarter = middle + (from - middle).perp();
    hand.drag(Button::Left, from, quarter);
    assert!((hand.pose().angle_to(&before) - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let from = hand.point_on(Handle::Depth);
    hand.drag(Button::Left, from, from - DVec2::new(0.0, 40.0));
    assert!(hand.pose().translation_mm.z < before.translation_mm.z - 10.0);
    assert!(hand.middle().distance(middle) < 1e-6);
    assert_eq!(hand.session.undo_label(), Some("Change depth"));
}

#[test]
fn handles_of_a_locked_object_cannot_be_taken_and_keep_their_size() {
    let mut hand = in_scene_view();
    hand.run(CommandId::ToggleGizmo);
    let point = hand.point_on(Handle::Roll);
    let radius = point.distance(hand.middle());
    hand.act(hand.middle(), PointerAction::Wheel(5.0));
    assert!((hand.point_on(Handle::Roll).distance(hand.middle()) - radius).abs() < 1e-6);
    let object = hand.session.selected().unwrap();
    hand.session.apply(Command::EditObject(object, ObjectChange::Locked(true)), NOW_MS).unwrap();
    let gizmo = hand.gizmo();
    assert!(!gizmo.movable && gizmo.handle_at(point).is_none());
}

/// The interface over a session with its views, as the program runs it.
fn harness(session: Session) -> (Harness<'static>, Rc<RefCell<(Session, Hands)>>) {
    let shared = Rc::new(RefCell::new((session, Hands::default())));
    let of_ui = shared.clone();
    let mut state = UiState::default();
    let harness = Harness::builder().with_size([1280.0, 800.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let mut borrowed = of_ui.borrow_mut();
        let (session, hands) = &mut *borrowed;
        hands.scene_view.advance(ui.input(|input| input.time));
        let around = quiet_surroundings(hands);
        let asked = ui::draw(ui, session, &around, &mut state);
        if let Some(moved) = asked.scene_move {
            hands.move_scene(moved, session);
            ui.ctx().request_repaint();
        }
        for command in asked.commands {
            session.apply(command, NOW_MS).unwrap();
        }
    });
    (harness, shared)
}

#[test]
fn the_views_are_switched_by_their_names() {
    let (mut harness, shared) = harness(small_session());
    harness.run();
    assert!(harness.query_by_label("Scene view").is_none());
    harness.get_by_label("Both").click();
    harness.run();
    assert_eq!(shared.borrow().0.panes().arrangement, Arrangement::Split);
    for label in ["Viewport", "Scene view", "Divide the views"] {
        harness.get_by_label(label);
    }
    harness.get_by_label("Scene").click();
    harness.run();
    assert!(harness.query_by_label("Viewport").is_none());
}

#[test]
fn an_end_of_the_axes_is_a_standard_view() {
    let mut session = small_session();
    session.apply(Command::Run(CommandId::SceneView), NOW_MS).unwrap();
    let (mut harness, shared) = harness(session);
    harness.run();
    for view in StandardView::ALL {
        harness.get_by_label(&format!("View from {}", view.axis_name()));
    }
    harness.get_by_label("View from +X").click();
    for _ in 0..60 {
        harness.step();
    }
    let forward = shared.borrow().1.scene_view.eye_from_camera().rotation.transpose() * DVec3::Z;
    assert!(forward.distance(DVec3::NEG_X) < 1e-9, "{forward}");
}
