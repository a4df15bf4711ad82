//! Sessions as scripts: what a user does, in commands, and what the scene is after it.

use glam::{DVec2, DVec3};
use pinpose::formats::PosesAs;
use pinpose::math::{Intrinsics, Pose};
use pinpose::scene::{AnnotationState, CameraOrigin, Pin, PoseSource};
use pinpose::session::{
    Answer, COMMANDS, Command, CommandId, Effect, HalfPin, ObjectChange, PinChange, Question, Session,
};

use crate::support::{CAMERA_JSON, NOW_MS, box_mesh, drop_files, flat_photo, small_session, text_file};

fn run(session: &mut Session, command: Command) -> Vec<Effect> {
    session.apply(command, NOW_MS).unwrap()
}

fn shown_pose(session: &Session) -> Pose {
    session.selected_annotation().unwrap().2.camera_from_object
}

fn drag(session: &mut Session, offset: DVec3) {
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    run(session, Command::BeginGesture("Move"));
    for step in 1..=3 {
        let camera_from_object = start.translated(offset * (f64::from(step) / 3.0));
        run(session, Command::Drag { photo, object, camera_from_object });
    }
    run(session, Command::EndGesture);
}

#[test]
fn a_new_object_covers_a_third_of_the_photo() {
    let session = small_session();
    let (_, _, annotation) = session.selected_annotation().unwrap();
    assert_eq!(annotation.state, AnnotationState::Untouched);
    let photo = session.photo().unwrap();
    let pose = annotation.camera_from_object;
    assert_eq!(photo.camera.project(pose.translation_mm).unwrap(), glam::DVec2::new(301.75, 222.5));
    // The silhouette of the bounding sphere: f·r/√(d² − r²) is a sixth of the height.
    let radius = 40.0_f64.hypot(30.0).hypot(20.0);
    let distance = pose.translation_mm.length();
    let seen = photo.camera.fy * radius / (distance * distance - radius * radius).sqrt();
    assert!((seen - 80.0).abs() < 1e-3, "{seen}");
}

#[test]
fn files_may_come_in_any_order() {
    let files =
        [flat_photo("photo.png", 640, 480), box_mesh("box.obj"), text_file("camera.json", CAMERA_JSON)];
    for order in [[0, 1, 2], [2, 1, 0], [1, 0, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]] {
        let mut session = Session::default();
        for index in order {
            drop_files(&mut session, &files[index..=index], None);
        }
        assert_eq!(session.photo().unwrap().camera.fy, 533.25, "{order:?}");
        assert_eq!(shown_pose(&session), shown_pose(&small_session()), "{order:?}");
    }
}

#[test]
fn a_gesture_is_one_undo_step() {
    let mut session = small_session();
    let start = shown_pose(&session);
    drag(&mut session, DVec3::new(10.0, 0.0, 0.0));
    drag(&mut session, DVec3::new(0.0, 5.0, 0.0));
    let end = shown_pose(&session);
    run(&mut session, Command::Run(CommandId::Undo));
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!(shown_pose(&session), start);
    assert_eq!(session.selected_annotation().unwrap().2.state, AnnotationState::Untouched);
    run(&mut session, Command::Run(CommandId::Redo));
    run(&mut session, Command::Run(CommandId::Redo));
    assert_eq!(shown_pose(&session), end);
    assert!(session.unavailable(CommandId::Redo).is_some());
}

#[test]
fn cancelling_a_gesture_leaves_no_trace() {
    let mut session = small_session();
    let before = session.scene().clone();
    let (photo, object, _) = session.selected_annotation().unwrap();
    run(&mut session, Command::BeginGesture("Move"));
    run(
        &mut session,
        Command::Drag { photo, object, camera_from_object: Pose::from_translation(DVec3::Z * 400.0) },
    );
    run(&mut session, Command::CancelGesture);
    assert_eq!(*session.scene(), before);
    assert_eq!(session.undo_label(), Some("Add files"));
}

#[test]
fn steps_close_in_time_are_one() {
    let mut session = small_session();
    let (photo, object, _) = session.selected_annotation().unwrap();
    let start = shown_pose(&session);
    let mut nudge = |time_ms: f64| {
        let camera_from_object = shown_pose(&session).translated(DVec3::Z);
        let command = Command::Step { photo, object, camera_from_object, label: "Change depth" };
        session.apply(command, NOW_MS + time_ms).unwrap();
    };
    [0.0, 300.0, 600.0, 1200.0].into_iter().for_each(&mut nudge);
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!(shown_pose(&session), start.translated(DVec3::Z * 3.0));
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!(shown_pose(&session), start);
}

#[test]
fn a_locked_object_does_not_move() {
    let mut session = small_session();
    let (photo, object, _) = session.selected_annotation().unwrap();
    run(&mut session, Command::EditObject(object, ObjectChange::Locked(true)));
    let moved = Pose::from_translation(DVec3::Z * 400.0);
    let drag = Command::Drag { photo, object, camera_from_object: moved };
    assert!(session.apply(drag, NOW_MS).unwrap_err().to_string().contains("locked"));
    let set = Command::SetPose { photo, object, camera_from_object: moved, source: PoseSource::Manual };
    assert!(session.apply(set, NOW_MS).is_err());
}

#[test]
fn changing_the_camera_marks_poses_and_moves_untouched_ones() {
    let mut session = small_session();
    let photo = session.photo().unwrap().id;
    let untouched = shown_pose(&session);
    let camera = Intrinsics::pinhole(700.0, 710.0, 320.0, 240.0, 640, 480);
    run(&mut session, Command::SetCamera { photo, camera, origin: CameraOrigin::Typed });
    assert_ne!(shown_pose(&session), untouched);
    drag(&mut session, DVec3::X);
    let posed = shown_pose(&session);
    let camera = Intrinsics::pinhole(600.0, 610.0, 320.0, 240.0, 640, 480);
    run(&mut session, Command::SetCamera { photo, camera, origin: CameraOrigin::Typed });
    let (_, _, annotation) = session.selected_annotation().unwrap();
    assert_eq!(annotation.camera_from_object, posed);
    assert!(annotation.camera_changed);
    let zero = Intrinsics::pinhole(0.0, 610.0, 320.0, 240.0, 640, 480);
    let refused =
        session.apply(Command::SetCamera { photo, camera: zero, origin: CameraOrigin::Typed }, NOW_MS);
    assert!(refused.unwrap_err().to_string().contains("focal length"));
}

#[test]
fn a_camera_of_another_size_is_asked_about() {
    let mut session = small_session();
    let half = r#"{"fx": 260.25, "fy": 266.625, "cx": 150.625, "cy": 111, "width": 320, "height": 240}"#;
    drop_files(&mut session, &[text_file("half.json", half)], None);
    assert!(matches!(session.question(), Some(Question::CameraSize { .. })));
    assert_eq!(session.photo().unwrap().camera.fx, 520.5, "nothing changes before the answer");
    run(&mut session, Command::Answer(Answer::ScaleCamera));
    let camera = session.photo().unwrap().camera;
    // c′ = (c + ½)·s − ½
    assert_eq!((camera.fx, camera.cx, camera.width), (520.5, 301.75, 640));
    assert!(session.question().is_none());
}

#[test]
fn poses_are_asked_about_and_can_be_a_reference() {
    let mut session = small_session();
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n");
    drop_files(&mut session, &[text_file("truth.txt", &truth)], None);
    assert!(matches!(session.question(), Some(Question::PosesAs(_))));
    let before = shown_pose(&session);
    run(&mut session, Command::Answer(Answer::UsePosesAs(PosesAs::Reference)));
    assert_eq!(shown_pose(&session), before, "a reference is not mixed with annotations");
    let reference = &session.scene().references[0];
    assert_eq!((reference.name.as_str(), reference.poses.len()), ("truth", 1));
    run(&mut session, Command::Run(CommandId::Undo));
    assert!(session.scene().references.is_empty());
}

#[test]
fn files_of_poses_that_come_together_are_asked_about_once() {
    let mut session = small_session();
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n");
    let scored = "scene_id,im_id,obj_id,score,R,t,time\n1,0,1,0.75,1 0 0 0 1 0 0 0 1,5 6 710,-1\n";
    let files =
        [text_file("truth.txt", &truth), text_file("other.txt", &truth), text_file("scored.csv", scored)];
    drop_files(&mut session, &files, None);
    let Some(Question::PosesAs(asked)) = session.question() else { panic!("no question") };
    let names: Vec<&str> = asked.iter().map(|incoming| incoming.file_name.as_str()).collect();
    assert_eq!(names, ["truth.txt", "other.txt", "scored.csv"]);
    assert_eq!(asked[2].photos[0].poses[0].score, Some(0.75));
    assert_eq!(session.count_fitting_poses(asked), 2);
    run(&mut session, Command::Answer(Answer::UsePosesAs(PosesAs::Reference)));
    assert!(session.question().is_none(), "one choice for all");
    let names: Vec<&str> =
        session.scene().references.iter().map(|reference| reference.name.as_str()).collect();
    assert_eq!(names, ["truth", "other"]);
    assert_eq!(session.missing_files().map(|(file, _)| file).collect::<Vec<_>>(), ["scored.csv"]);
    run(&mut session, Command::Run(CommandId::Undo));
    assert!(session.scene().references.is_empty(), "and one step");
}

#[test]
fn a_file_of_cameras_alone_is_not_told_as_poses() {
    let mut session = Session::default();
    drop_files(&mut session, &[flat_photo("000000.png", 640, 480), box_mesh("box.obj")], None);
    let cameras = r#"{"0": {"cam_K": [520.5, 0, 301.75, 0, 533.25, 222.5, 0, 0, 1], "depth_scale": 1.0}}"#;
    let effects = drop_files(&mut session, &[text_file("scene_camera.json", cameras)], None);
    let said: Vec<String> = effects
        .iter()
        .filter_map(
            |effect| if let Effect::Notify(notice) = effect { Some(notice.text.clone()) } else { None },
        )
        .collect();
    assert_eq!(said, ["scene_camera.json: 1 camera taken over"]);
    assert_eq!(session.photo().unwrap().camera.fx, 520.5);
}

#[test]
fn a_session_replays_exactly() {
    let play = || {
        let mut session = small_session();
        drag(&mut session, DVec3::new(3.0, 4.0, 5.0));
        run(&mut session, Command::Run(CommandId::Undo));
        run(&mut session, Command::Run(CommandId::Redo));
        pinpose::formats::write_document(&session.document(pinpose::formats::Keep::Everything))
    };
    assert_eq!(play(), play());
}

/// Fails on a command that nobody exercises: each has to do something that can be seen, or say why it cannot.
#[test]
fn every_command_of_the_table_does_something() {
    for info in COMMANDS {
        let mut empty = Session::default();
        if let Err(error) = empty.apply(Command::Run(info.id), NOW_MS) {
            assert!(error.to_string().contains("not possible now"), "{}: {error}", info.name);
        }
        let mut session = small_session();
        drop_files(&mut session, &[flat_photo("second.png", 320, 240)], None);
        let first = session.scene().photos[0].id;
        run(&mut session, Command::ShowPhoto(first));
        drag(&mut session, DVec3::X);
        match info.id {
            CommandId::LinkObjects | CommandId::UnlinkObjects => {
                run(&mut session, Command::Run(CommandId::DuplicateObject));
                run(&mut session, Command::Run(CommandId::SelectAll));
                if info.id == CommandId::UnlinkObjects {
                    run(&mut session, Command::Run(CommandId::LinkObjects));
                }
            }
            CommandId::SelectAll => drop(run(&mut session, Command::Select(None))),
            CommandId::Reopen => {
                run(&mut session, Command::Run(CommandId::ConfirmAndNext));
                run(&mut session, Command::ShowPhoto(first));
            }
            CommandId::BackToReference => {
                run(&mut session, Command::Run(CommandId::StoreReference));
                drag(&mut session, DVec3::Y);
            }
            CommandId::CopyFromPrevious => drop(run(&mut session, Command::Run(CommandId::NextPhoto))),
            CommandId::PhotoView => drop(run(&mut session, Command::Run(CommandId::SceneView))),
            id if id.selects().is_some() => {
                // As many objects as there are numbers, and none selected.
                for _ in 0..8 {
                    run(&mut session, Command::Run(CommandId::DuplicateObject));
                }
                run(&mut session, Command::Select(None));
            }
            CommandId::SolvePins
            | CommandId::FocalFromPins
            | CommandId::ClearPins
            | CommandId::CopyPinsToNext
            | CommandId::ExportPins => {
                let beside = shown_pose(&session).translated(DVec3::X * 5.0);
                set_pins(&mut session, &beside);
            }
            CommandId::Redo => drop(run(&mut session, Command::Run(CommandId::Undo))),
            CommandId::PreviousPhoto => drop(run(&mut session, Command::Run(CommandId::NextPhoto))),
            CommandId::MoveTool => drop(run(&mut session, Command::Run(CommandId::RotateTool))),
            CommandId::Cancel => {
                run(&mut session, Command::BeginGesture("Move"));
            }
            _ => {}
        }
        let before = format!("{session:?}");
        let effects = run(&mut session, Command::Run(info.id));
        assert!(!effects.is_empty() || format!("{session:?}") != before, "{} does nothing", info.name);
    }
}

/// Pins at five corners of the box, where a pose has them; the pose stays.
fn set_pins(session: &mut Session, camera_from_object: &Pose) {
    let (photo, object, _) = session.selected_annotation().unwrap();
    let camera = session.photo().unwrap().camera;
    let corners = [
        [-40.0, -30.0, -20.0],
        [40.0, -30.0, -20.0],
        [-40.0, 30.0, -20.0],
        [-40.0, -30.0, 20.0],
        [40.0, 30.0, 20.0],
        [40.0, -30.0, 20.0],
    ];
    for corner in corners.map(DVec3::from_array) {
        let pixel = camera.project(camera_from_object.transform_point(corner)).unwrap();
        run(session, Command::AddPin { photo, object, pin: Pin::new(corner, pixel) });
    }
}

#[test]
fn pins_that_are_dragged_bring_the_pose_along() {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    let camera = session.photo().unwrap().camera;
    let target =
        Pose::exp(DVec3::new(0.3, -0.5, 0.2), DVec3::ZERO) * start.translated(DVec3::new(40.0, -10.0, 90.0));
    // Added where they are, they move nothing.
    set_pins(&mut session, &start);
    assert_eq!(shown_pose(&session), start);
    let points: Vec<DVec3> =
        session.selected_annotation().unwrap().2.pins.iter().map(|pin| pin.point_mm).collect();
    for (pin, point) in points.iter().enumerate() {
        run(&mut session, Command::BeginGesture("Drag pin"));
        let pixel = camera.project(target.transform_point(*point)).unwrap();
        run(&mut session, Command::DragPin { photo, object, pin, pixel });
        run(&mut session, Command::EndGesture);
    }
    let found = shown_pose(&session);
    // Exact pixels: what is left is where the solver stops, 1e-6 px or so, at 0.3 mm a pixel.
    assert!(found.angle_to(&target) < 1e-6, "{}", found.angle_to(&target));
    assert!(found.translation_mm.distance(target.translation_mm) < 1e-4);
    assert_eq!(session.selected_annotation().unwrap().2.source, PoseSource::Pins);
    let report = session.pin_report().unwrap();
    assert!(report.is_solved && report.rms_px < 1e-4 && report.misclicks.is_empty(), "{report:?}");
    let exact = pinpose::solve::Tolerances { focal: 0.0, mesh_scale: 0.0 };
    let sure = session.sureness(&exact).unwrap().uncertainty;
    assert!(sure.depth_mm > sure.lateral_mm, "{sure:?}");
    // Each drag is a step: the last one is taken back alone, with its pose.
    run(&mut session, Command::Run(CommandId::Undo));
    assert_ne!(shown_pose(&session), found);
    run(&mut session, Command::Run(CommandId::Redo));
    assert_eq!(shown_pose(&session), found);
}

#[test]
fn a_way_with_one_pin_there_and_back_ends_where_it_began() {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    let camera = session.photo().unwrap().camera;
    let point = DVec3::new(-40.0, -30.0, -20.0);
    let pixel = camera.project(start.transform_point(point)).unwrap();
    run(&mut session, Command::BeginGesture("Add pin"));
    run(&mut session, Command::AddPin { photo, object, pin: Pin::new(point, pixel) });
    for offset in [20.0, 80.0, 50.0, 0.0] {
        let pixel = pixel + glam::DVec2::new(offset, -offset / 2.0);
        run(&mut session, Command::DragPin { photo, object, pin: 0, pixel });
        let seen = camera.project(shown_pose(&session).transform_point(point)).unwrap();
        // The solver's last step; one pin can always be met.
        assert!(seen.distance(pixel) < 1e-3, "{}", seen.distance(pixel));
    }
    run(&mut session, Command::EndGesture);
    let end = shown_pose(&session);
    assert!(end.angle_to(&start) < 1e-6 && end.translation_mm.distance(start.translation_mm) < 1e-3);
    // It is what the object turns about.
    assert_eq!(session.pivot_mm(photo, object), Some(point));
}

/// What pins on a line leave open must not drift with the number of moves.
#[test]
fn a_way_with_three_pins_on_a_line_there_and_back_ends_where_it_began() {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    let camera = session.photo().unwrap().camera;
    let pixel_of = |point: DVec3| camera.project(start.transform_point(point)).unwrap();
    let points = [-40.0, 0.0, 40.0].map(|x| DVec3::new(x, -30.0, -20.0));
    run(&mut session, Command::BeginGesture("Add pin"));
    for point in points {
        run(&mut session, Command::AddPin { photo, object, pin: Pin::new(point, pixel_of(point)) });
    }
    for step in 0..=40 {
        let turn = std::f64::consts::TAU * f64::from(step) / 40.0;
        let pixel = pixel_of(points[2]) + 25.0 * DVec2::new(turn.sin(), turn.cos() - 1.0);
        run(&mut session, Command::DragPin { photo, object, pin: 2, pixel });
    }
    run(&mut session, Command::EndGesture);
    let end = shown_pose(&session);
    // Where the solver stops; it was 0.17 rad when each move began where the last one had ended.
    assert!(end.angle_to(&start) < 1e-5, "{}", end.angle_to(&start));
}

#[test]
fn pins_go_to_the_next_photo_beside_those_that_were_set_there() {
    let mut session = small_session();
    drop_files(&mut session, &[flat_photo("second.png", 640, 479)], None);
    let [first, second] = [0, 1].map(|number: usize| session.scene().photos[number].id);
    run(&mut session, Command::ShowPhoto(first));
    let pose = shown_pose(&session);
    set_pins(&mut session, &pose);
    run(&mut session, Command::Run(CommandId::CopyPinsToNext));
    assert_eq!(session.photo().unwrap().id, second);
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    assert_eq!((annotation.pins.len(), annotation.state), (6, AnnotationState::Carried));
    run(&mut session, Command::EditPins(PinChange::Remove(5)));
    let pixel = session.selected_annotation().unwrap().2.pins[0].pixel + DVec2::new(4.0, 1.0);
    run(&mut session, Command::BeginGesture("Drag pin"));
    run(&mut session, Command::DragPin { photo, object, pin: 0, pixel });
    run(&mut session, Command::EndGesture);
    run(&mut session, Command::ShowPhoto(first));
    run(&mut session, Command::Run(CommandId::CopyPinsToNext));
    let pins = &session.selected_annotation().unwrap().2.pins;
    assert_eq!((pins.len(), pins[0].pixel), (6, pixel), "what was put there stays, what is missing comes");
}

#[test]
fn a_pin_off_its_place_is_named_and_can_be_switched_off() {
    let mut session = small_session();
    let target = shown_pose(&session).translated(DVec3::new(5.0, 3.0, 20.0));
    set_pins(&mut session, &target);
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let pixel = annotation.pins[4].pixel + glam::DVec2::new(30.0, -40.0);
    run(&mut session, Command::BeginGesture("Drag pin"));
    run(&mut session, Command::DragPin { photo, object, pin: 4, pixel });
    run(&mut session, Command::EndGesture);
    let report = session.pin_report().unwrap();
    assert_eq!(report.misclicks, [4]);
    assert!(report.rms_px < 1.0, "it is of those that pull: {report:?}");
    run(&mut session, Command::EditPins(PinChange::Enabled(4, false)));
    let report = session.pin_report().unwrap();
    assert!(report.misclicks.is_empty() && report.rms_px < 1e-4, "{report:?}");
    assert!(report.residuals_px[4].unwrap().length() > 40.0, "it keeps its residual");
    assert!(shown_pose(&session).translation_mm.distance(target.translation_mm) < 1e-3);
    run(&mut session, Command::EditPins(PinChange::Remove(4)));
    assert_eq!(session.selected_annotation().unwrap().2.pins.len(), 5);
}

#[test]
fn six_pins_give_the_focal_length_too() {
    let mut session = small_session();
    // Near, so that perspective tells the focal length from the distance.
    let target =
        Pose::exp(DVec3::new(0.3, -0.5, 0.2), DVec3::ZERO) * Pose::from_translation(DVec3::Z * 220.0);
    set_pins(&mut session, &target);
    let photo = session.photo().unwrap();
    let (id, truth) = (photo.id, photo.camera);
    let camera = Intrinsics { fx: truth.fx * 1.3, fy: truth.fy * 1.3, ..truth };
    run(&mut session, Command::SetCamera { photo: id, camera, origin: CameraOrigin::Typed });
    run(&mut session, Command::Run(CommandId::FocalFromPins));
    let photo = session.photo().unwrap();
    // Exact pixels: what is left is where the solver stops.
    assert!((photo.camera.fx / truth.fx - 1.0).abs() < 1e-4, "{}", photo.camera.fx);
    assert!(matches!(photo.camera_origin, CameraOrigin::Pins { .. }) && photo.camera_origin.is_guess());
    assert!(shown_pose(&session).translation_mm.distance(target.translation_mm) < 0.1);
    run(&mut session, Command::Run(CommandId::Undo));
    assert_eq!(session.photo().unwrap().camera, camera);
}

#[test]
fn a_snap_is_a_step_and_esc_takes_it_back_until_something_else_is_done() {
    let mut session = small_session();
    let effects = run(&mut session, Command::Run(CommandId::Snap));
    assert!(matches!(effects[..], [Effect::Snap { .. }]), "{effects:?}");
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    let found = start.translated(DVec3::new(2.0, 0.0, -9.0));
    run(&mut session, Command::TakeSnap { photo, object, camera_from_object: found, covariance: None });
    assert_eq!(session.selected_annotation().unwrap().2.source, PoseSource::Snap);
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!(shown_pose(&session), start);
    // A second time there is nothing to take back.
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!(shown_pose(&session), start);
    run(&mut session, Command::TakeSnap { photo, object, camera_from_object: found, covariance: None });
    // To look at it is nothing done.
    run(&mut session, Command::Run(CommandId::ToggleOverlay));
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!(shown_pose(&session), start);
    // Esc with half a pin is about the half.
    run(&mut session, Command::TakeSnap { photo, object, camera_from_object: found, covariance: None });
    run(&mut session, Command::BeginPin(Some(HalfPin::Pixel(DVec2::new(20.0, 30.0)))));
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!((session.half_pin(), shown_pose(&session)), (None, found));
    drag(&mut session, DVec3::X);
    let end = shown_pose(&session);
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!(shown_pose(&session), end, "the snap was gone on from");
}

#[test]
fn what_nobody_has_placed_is_before_nothing() {
    let mut session = small_session();
    let other = "v 0 0 0\nv 90 0 0\nv 0 90 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    drop_files(&mut session, &[text_file("other.obj", other)], None);
    let scene = session.scene();
    let (photo, first, other) = (scene.photos[0].id, scene.objects[0].id, scene.objects[1].id);
    assert!(scene.annotation(photo, other).is_some(), "it waits where it came in");
    assert_eq!(scene.placed_beside(photo, first).count(), 0);
    let camera_from_object = Pose::from_translation(DVec3::new(0.0, 0.0, 500.0));
    run(
        &mut session,
        Command::SetPose { photo, object: other, camera_from_object, source: PoseSource::Manual },
    );
    let beside: Vec<_> = session.scene().placed_beside(photo, first).map(|(object, _)| object.id).collect();
    assert_eq!(beside, [other]);
    assert_eq!(session.scene().placed_beside(photo, other).count(), 0);
}

#[test]
fn a_pin_of_two_halves_moves_the_object_there() {
    let mut session = small_session();
    let (photo, object, _) = session.selected_annotation().unwrap();
    let pixel = glam::DVec2::new(100.0, 120.0);
    run(&mut session, Command::BeginPin(Some(HalfPin::Pixel(pixel))));
    let point = DVec3::new(40.0, 30.0, 20.0);
    run(&mut session, Command::CompletePin { photo, object, pin: Pin::new(point, pixel) });
    assert_eq!(session.half_pin(), None);
    let seen = session.photo().unwrap().camera.project(shown_pose(&session).transform_point(point)).unwrap();
    assert!(seen.distance(pixel) < 1e-3);
    run(&mut session, Command::BeginPin(Some(HalfPin::Point(object, point))));
    run(&mut session, Command::Run(CommandId::Cancel));
    assert_eq!(session.half_pin(), None);
}

#[test]
fn pins_are_saved_and_dropped_again() {
    let mut session = small_session();
    let target = shown_pose(&session).translated(DVec3::new(5.0, 3.0, 20.0));
    set_pins(&mut session, &target);
    let pins = session.selected_annotation().unwrap().2.pins.clone();
    let effects = run(&mut session, Command::Run(CommandId::ExportPins));
    let Some(Effect::Download { file_name, bytes }) = effects.first() else { panic!("{effects:?}") };
    assert_eq!(file_name, "photo-box-pins.json");
    let file = text_file(file_name, std::str::from_utf8(bytes).unwrap());
    run(&mut session, Command::Run(CommandId::ClearPins));
    assert!(session.selected_annotation().unwrap().2.pins.is_empty());
    drop_files(&mut session, &[file], None);
    assert_eq!(session.selected_annotation().unwrap().2.pins, pins);
    assert!(shown_pose(&session).translation_mm.distance(target.translation_mm) < 1e-3);
    let document = session.document(pinpose::formats::Keep::Everything);
    let text = pinpose::formats::write_document(&document);
    let again = pinpose::formats::read_document(text.as_bytes()).unwrap();
    assert_eq!(again, document);
}

#[test]
fn downloads_hold_what_they_say() {
    let mut session = small_session();
    drag(&mut session, DVec3::X);
    let effects = run(&mut session, Command::Run(CommandId::ExportPoses));
    let Some(Effect::Download { file_name, bytes }) = effects.first() else { panic!("{effects:?}") };
    assert_eq!(file_name, "photo-poses.json");
    assert_eq!(pinpose::formats::read_document(bytes).unwrap().pose_count(), 1);
    let effects = run(&mut session, Command::Run(CommandId::ExportWorkspace));
    let Some(Effect::Download { file_name, .. }) = effects.first() else { panic!("{effects:?}") };
    assert_eq!(file_name, "photo-workspace.zip");
}
