//! Gestures as scripts: pointer events in, poses out, with the view at several zooms.

use glam::DVec2;
use pinpose::interact::{Button, Gestures, Modifiers, PhotoView, PointerAction, PointerEvent, pick_all};
use pinpose::scene::AnnotationState;
use pinpose::session::{Command, CommandId, HalfPin, Session, Tool};

use crate::support::{NOW_MS, small_session};

struct Hand {
    session: Session,
    view: PhotoView,
    gestures: Gestures,
    modifiers: Modifiers,
    refusals: Vec<String>,
}

impl Hand {
    fn new() -> Self {
        let mut view = PhotoView::default();
        view.set_sizes(DVec2::new(800.0, 600.0), DVec2::new(640.0, 480.0));
        let (gestures, modifiers, refusals) = Default::default();
        Self { session: small_session(), view, gestures, modifiers, refusals }
    }

    /// `pixel` is in the `image` frame.
    fn act(&mut self, pixel: DVec2, action: PointerAction) {
        let position = self.view.viewport_from_image(pixel);
        self.act_at(position, action);
    }

    fn act_at(&mut self, position: DVec2, action: PointerAction) {
        let event = PointerEvent { position, action, modifiers: self.modifiers };
        for command in self.gestures.handle(&event, &self.session, &mut self.view) {
            // What is refused is said to the user.
            self.refusals.extend(self.session.apply(command, NOW_MS).err().map(|error| error.to_string()));
        }
    }

    fn drag(&mut self, button: Button, from: DVec2, to: DVec2) {
        self.act(from, PointerAction::Press(button));
        for step in 1..=4 {
            self.act(from.lerp(to, f64::from(step) / 4.0), PointerAction::Move);
        }
        self.act(to, PointerAction::Release(button));
    }

    fn pose(&self) -> pinpose::math::Pose {
        self.session.selected_annotation().unwrap().2.camera_from_object
    }

    /// The pixel in the middle of the box.
    fn middle(&self) -> DVec2 {
        self.session.photo().unwrap().camera.project(self.pose().translation_mm).unwrap()
    }
}

#[test]
fn a_move_keeps_the_grabbed_point_under_the_cursor_at_any_zoom() {
    for zoom in [1.0, 8.0] {
        let mut hand = Hand::new();
        hand.view.zoom_about(DVec2::new(400.0, 300.0), zoom);
        let photo = hand.session.photo().unwrap().id;
        let grabbed = hand.middle() + DVec2::new(7.3, -4.6);
        let hit = pick_all(hand.session.scene(), photo, grabbed)[0];
        let depth_mm = hit.point_camera_mm.z;
        let target = grabbed + DVec2::new(31.5, 18.25);
        hand.drag(Button::Left, grabbed, target);
        let point = hand.pose().transform_point(hit.point_object_mm);
        let pixel = hand.session.photo().unwrap().camera.project(point).unwrap();
        // Rounding of f64 alone.
        assert!(pixel.distance(target) < 1e-9, "zoom {zoom}: {pixel} instead of {target}");
        assert!((point.z - depth_mm).abs() < 1e-9);
        assert_eq!(hand.session.undo_label(), Some("Move"));
    }
}

#[test]
fn alt_is_ten_times_finer() {
    let mut hand = Hand::new();
    hand.modifiers.alt = true;
    let photo = hand.session.photo().unwrap().id;
    let grabbed = hand.middle();
    let point_object = pick_all(hand.session.scene(), photo, grabbed)[0].point_object_mm;
    hand.drag(Button::Left, grabbed, grabbed + DVec2::new(40.0, -20.0));
    let seen =
        hand.session.photo().unwrap().camera.project(hand.pose().transform_point(point_object)).unwrap();
    assert!(seen.distance(grabbed + DVec2::new(4.0, -2.0)) < 1e-9);
}

#[test]
fn a_right_drag_turns_about_the_centre_and_ctrl_rolls() {
    let mut hand = Hand::new();
    let (before, middle) = (hand.pose(), hand.middle());
    hand.drag(Button::Right, middle, middle + DVec2::new(30.0, 0.0));
    let turned = hand.pose();
    assert!(turned.angle_to(&before) > 0.1);
    assert!(turned.translation_mm.distance(before.translation_mm) < 1e-9, "the box is centred on its origin");
    // The view ray is the optical axis, so a turn to the right is about the camera's y axis.
    assert!((turned.rotation.y_axis.y - 1.0).abs() < 1e-9);

    hand.modifiers.ctrl = true;
    let from = middle + DVec2::new(40.0, 0.0);
    hand.drag(Button::Right, from, middle + DVec2::new(0.0, 40.0));
    let rolled = hand.pose();
    // From three to six o'clock, a quarter turn clockwise; the steps of the drag cut the corner but not the angle.
    assert!((rolled.angle_to(&turned) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
}

#[test]
fn depth_keeps_the_point_under_the_cursor_on_its_pixel() {
    let mut hand = Hand::new();
    hand.modifiers.shift = true;
    let pixel = hand.middle() + DVec2::new(11.0, 6.0);
    let photo = hand.session.photo().unwrap().id;
    let point_object = pick_all(hand.session.scene(), photo, pixel)[0].point_object_mm;
    let width = |hand: &Hand| {
        let radius = hand.session.scene().objects[0].mesh.mesh.sphere().radius;
        2.0 * hand.session.photo().unwrap().camera.focal_px() * radius / hand.pose().translation_mm.z
    };
    let before = width(&hand);
    for _ in 0..5 {
        hand.act(pixel, PointerAction::Wheel(1.0));
    }
    let camera = hand.session.photo().unwrap().camera;
    assert!(camera.project(hand.pose().transform_point(point_object)).unwrap().distance(pixel) < 1e-9);
    // The anchor is on the near side, nearer than the centre whose width is counted: the step is a pixel within a tenth.
    assert!((width(&hand) - before - 5.0).abs() < 0.5, "{} px", width(&hand) - before);
    hand.session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert!((width(&hand) - before).abs() < 1e-9, "a burst is one step");
}

#[test]
fn the_wheel_changes_depth_within_a_drag() {
    let mut hand = Hand::new();
    let from = hand.middle() + DVec2::new(5.0, 5.0);
    let photo = hand.session.photo().unwrap().id;
    let point_object = pick_all(hand.session.scene(), photo, from)[0].point_object_mm;
    hand.act(from, PointerAction::Press(Button::Left));
    hand.act(from + DVec2::new(20.0, 0.0), PointerAction::Move);
    hand.act(from + DVec2::new(20.0, 0.0), PointerAction::Wheel(3.0));
    let to = from + DVec2::new(35.0, 10.0);
    hand.act(to, PointerAction::Move);
    hand.act(to, PointerAction::Release(Button::Left));
    let camera = hand.session.photo().unwrap().camera;
    assert!(camera.project(hand.pose().transform_point(point_object)).unwrap().distance(to) < 1e-9);
    hand.session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!(hand.session.undo_label(), Some("Add files"), "drag and wheel were one step");
}

#[test]
fn a_click_selects_and_moves_nothing() {
    let mut hand = Hand::new();
    hand.session.apply(Command::Select(None), NOW_MS).unwrap();
    let object = hand.session.scene().objects[0].id;
    let photo = hand.session.photo().unwrap().id;
    let pose = hand.session.scene().annotation(photo, object).unwrap().camera_from_object;
    let pixel = hand.session.photo().unwrap().camera.project(pose.translation_mm).unwrap();
    hand.act(pixel, PointerAction::Press(Button::Left));
    hand.act(pixel + DVec2::new(1.0, 1.0), PointerAction::Move);
    hand.act(pixel + DVec2::new(1.0, 1.0), PointerAction::Release(Button::Left));
    assert_eq!(hand.session.selected(), Some(object));
    assert_eq!(hand.session.selected_annotation().unwrap().2.state, AnnotationState::Untouched);
    hand.act(DVec2::new(20.0, 20.0), PointerAction::Press(Button::Left));
    hand.act(DVec2::new(20.0, 20.0), PointerAction::Release(Button::Left));
    assert_eq!(hand.session.selected(), None);
}

#[test]
fn dragging_the_ground_pans_and_the_middle_button_always_does() {
    let mut hand = Hand::new();
    hand.view.zoom_about(DVec2::new(400.0, 300.0), 1.5);
    let (before, pose) = (hand.view.center, hand.pose());
    let ground = hand.view.image_from_viewport(DVec2::new(20.0, 20.0));
    hand.act_at(DVec2::new(20.0, 20.0), PointerAction::Press(Button::Left));
    hand.act_at(DVec2::new(60.0, 45.0), PointerAction::Move);
    hand.act_at(DVec2::new(60.0, 45.0), PointerAction::Release(Button::Left));
    assert!(hand.view.image_from_viewport(DVec2::new(60.0, 45.0)).distance(ground) < 1e-9);
    let middle = hand.middle();
    hand.drag(Button::Middle, middle, middle + DVec2::new(9.0, 9.0));
    assert_ne!(hand.view.center, before);
    assert_eq!(hand.pose(), pose);
}

#[test]
fn escape_puts_the_drag_back_and_the_rest_of_it_does_nothing() {
    let mut hand = Hand::new();
    let (before, middle) = (hand.pose(), hand.middle());
    hand.act(middle, PointerAction::Press(Button::Left));
    hand.act(middle + DVec2::new(30.0, 0.0), PointerAction::Move);
    assert_ne!(hand.pose(), before);
    hand.gestures.cancel();
    hand.session.apply(Command::CancelGesture, NOW_MS).unwrap();
    hand.act(middle + DVec2::new(60.0, 0.0), PointerAction::Move);
    hand.act(middle + DVec2::new(60.0, 0.0), PointerAction::Release(Button::Left));
    assert_eq!(hand.pose(), before);
    assert_eq!(hand.session.undo_label(), Some("Add files"));
}

#[test]
fn shift_sets_the_place_in_the_photo_first_though_the_object_be_over_it() {
    let mut hand = Hand::new();
    hand.session.apply(Command::SetTool(Tool::Pin), NOW_MS).unwrap();
    let click = |hand: &mut Hand, position: DVec2| {
        hand.act(position, PointerAction::Press(Button::Left));
        hand.act(position, PointerAction::Release(Button::Left));
    };
    let (middle, before) = (hand.middle(), hand.pose());
    hand.modifiers.shift = true;
    click(&mut hand, middle + DVec2::new(6.0, 2.0));
    let Some(HalfPin::Pixel(place)) = hand.session.half_pin() else { panic!("a place alone") };
    click(&mut hand, middle + DVec2::new(4.0, 0.0));
    let Some(HalfPin::Pixel(corrected)) = hand.session.half_pin() else { panic!("a better place") };
    assert_ne!(place, corrected);
    assert_eq!(hand.pose(), before);
    hand.modifiers.shift = false;
    click(&mut hand, middle);
    let (.., annotation) = hand.session.selected_annotation().unwrap();
    assert_eq!(annotation.pins.len(), 1);
    assert_eq!((annotation.pins[0].pixel, hand.session.half_pin()), (corrected, None));
    let seen = hand.session.photo().unwrap().camera;
    let seen = seen.project(hand.pose().transform_point(annotation.pins[0].point_mm)).unwrap();
    // One pin is met by a shift: to the solver's last step.
    assert!(seen.distance(corrected) < 1e-3, "{seen} {corrected}");
}

#[test]
fn a_locked_object_stays_while_the_hand_moves() {
    let mut hand = Hand::new();
    let object = hand.session.selected().unwrap();
    hand.session
        .apply(Command::EditObject(object, pinpose::session::ObjectChange::Locked(true)), NOW_MS)
        .unwrap();
    let (before, middle) = (hand.pose(), hand.middle());
    hand.drag(Button::Left, middle, middle + DVec2::new(50.0, 0.0));
    assert_eq!(hand.pose(), before);
    assert_eq!(hand.refusals, ["box is locked"], "it is said once");
}

#[test]
fn a_confirmed_object_stays_and_says_why() {
    let mut hand = Hand::new();
    let middle = hand.middle();
    hand.drag(Button::Left, middle, middle + DVec2::new(10.0, 0.0));
    hand.session.apply(Command::Run(CommandId::ConfirmAndNext), NOW_MS).unwrap();
    let (before, middle) = (hand.pose(), hand.middle());
    hand.drag(Button::Right, middle, middle + DVec2::new(50.0, 0.0));
    assert_eq!(hand.pose(), before);
    assert!(matches!(&hand.refusals[..], [text] if text.contains("reopen")), "{:?}", hand.refusals);
}

#[test]
fn a_double_click_on_the_ground_fits_and_keeps_the_selection() {
    let mut hand = Hand::new();
    hand.view.zoom_about(DVec2::new(400.0, 300.0), 1.5);
    let selected = hand.session.selection();
    let ground = DVec2::new(10.0, 10.0);
    for _ in 0..2 {
        hand.act_at(ground, PointerAction::Press(Button::Left));
        hand.act_at(ground, PointerAction::Release(Button::Left));
    }
    hand.act_at(ground, PointerAction::DoubleClick);
    assert!(hand.view.fitted);
    assert_eq!(hand.session.selection(), selected);
}

#[test]
fn ctrl_adds_to_the_selection_and_takes_out_of_it() {
    let mut hand = Hand::new();
    let middle = hand.middle();
    hand.modifiers.ctrl = true;
    hand.act(middle, PointerAction::Press(Button::Left));
    hand.act(middle, PointerAction::Release(Button::Left));
    assert!(hand.session.selection().is_empty(), "it was in the selection");
    hand.act(middle, PointerAction::Press(Button::Left));
    hand.act(middle, PointerAction::Release(Button::Left));
    assert_eq!(hand.session.selection().len(), 1);
}

#[test]
fn the_wipes_line_follows_the_hand() {
    let mut hand = Hand::new();
    hand.session.apply(Command::Run(CommandId::ToggleWipe), NOW_MS).unwrap();
    let pose = hand.pose();
    hand.act_at(DVec2::new(402.0, 200.0), PointerAction::Press(Button::Left));
    hand.act_at(DVec2::new(600.0, 210.0), PointerAction::Move);
    hand.act_at(DVec2::new(600.0, 210.0), PointerAction::Release(Button::Left));
    assert_eq!(hand.session.look().wipe, Some(0.75));
    assert_eq!((hand.pose(), hand.view.fitted), (pose, true));
}
