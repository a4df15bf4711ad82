//! An annotator's day, in commands: nudges, links, confirming, copying, masks, mesh frames, the log.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use pinpose::formats::{Keep, NamedFile, PosesAs, read_photo};
use pinpose::math::{Intrinsics, Pose};
use pinpose::photo::png_gray16;
use pinpose::scene::{AnnotationState, CameraOrigin, MeshFrame, ObjectId, PhotoId, PoseSource};
use pinpose::session::{
    Command, CommandError, CommandId, Effect, MaskChange, Nudge, ObjectChange, Opening, PhotoChange, Session,
};

use crate::support::{NOW_MS, box_mesh, drop_files, flat_photo, small_session, text_file};

fn run(session: &mut Session, command: Command) -> Vec<Effect> {
    session.apply(command, NOW_MS).unwrap()
}

fn press(session: &mut Session, id: CommandId) -> Vec<Effect> {
    run(session, Command::Run(id))
}

fn target(session: &Session) -> (PhotoId, ObjectId) {
    let (photo, object, _) = session.selected_annotation().unwrap();
    (photo, object)
}

fn pose_of(session: &Session, (photo, object): (PhotoId, ObjectId)) -> Pose {
    session.scene().annotation(photo, object).unwrap().camera_from_object
}

fn state_of(session: &Session, (photo, object): (PhotoId, ObjectId)) -> AnnotationState {
    session.scene().annotation(photo, object).unwrap().state
}

fn set_pose(session: &mut Session, (photo, object): (PhotoId, ObjectId), pose: Pose) {
    let source = PoseSource::Manual;
    run(session, Command::SetPose { photo, object, camera_from_object: pose, source });
}

/// Three photos of one size, a box posed in the first.
fn sequence() -> (Session, [PhotoId; 3], ObjectId) {
    let mut session = small_session();
    drop_files(
        &mut session,
        &[flat_photo("b.png", 640, 480), text_file("k.json", crate::support::CAMERA_JSON)],
        None,
    );
    // Another size than the two before it; a flat photo of the same size would be the same content.
    drop_files(&mut session, &[flat_photo("c.png", 320, 240)], None);
    let photos: Vec<PhotoId> = session.scene().photos.iter().map(|photo| photo.id).collect();
    let object = session.scene().objects[0].id;
    let first = photos[0];
    run(&mut session, Command::ShowPhoto(first));
    (session, [photos[0], *photos.get(1).unwrap(), *photos.last().unwrap()], object)
}

#[test]
fn a_burst_of_nudges_is_one_step_and_one_line() {
    let mut session = small_session();
    let target = target(&session);
    let start = pose_of(&session, target);
    for (step, time_ms) in [0.0, 200.0, 400.0].into_iter().enumerate() {
        let factor = [1.0, 10.0, 0.1][step];
        session.apply(Command::Nudge(Nudge::Right, factor), NOW_MS + time_ms).unwrap();
    }
    let camera = session.photo().unwrap().camera;
    let center = |pose: Pose| camera.project(pose.transform_point(DVec3::ZERO)).unwrap();
    let way = center(pose_of(&session, target)) - center(start);
    // f64 rounding of numbers below 1e3.
    assert!(way.distance(DVec2::new(11.1, 0.0)) < 1e-9, "{way}");
    assert_eq!(session.log().len(), 1);
    assert_eq!(session.log()[0].camera_from_object, pose_of(&session, target));
    session.apply(Command::Nudge(Nudge::PitchBack, 1.0), NOW_MS + 500.0).unwrap();
    assert_eq!(session.log().len(), 2, "another kind is another gesture");
    press(&mut session, CommandId::Undo);
    press(&mut session, CommandId::Undo);
    assert_eq!(pose_of(&session, target), start);
}

#[test]
fn linked_objects_move_as_one_body() {
    let mut session = small_session();
    let first = target(&session);
    press(&mut session, CommandId::DuplicateObject);
    let second = target(&session);
    assert_ne!(first, second);
    assert_eq!(session.scene().objects[1].name, "box 2");
    assert_ne!(session.scene().objects[0].color, session.scene().objects[1].color);
    press(&mut session, CommandId::SelectAll);
    press(&mut session, CommandId::LinkObjects);
    run(&mut session, Command::Select(Some(first.1)));
    let between = pose_of(&session, first).inverse() * pose_of(&session, second);
    let turn = Pose::exp(DVec3::new(0.2, 0.1, -0.3), DVec3::new(5.0, 6.0, 70.0));
    run(&mut session, Command::BeginGesture("Move"));
    for _ in 0..50 {
        let camera_from_object = turn * pose_of(&session, first);
        run(&mut session, Command::Drag { photo: first.0, object: first.1, camera_from_object });
    }
    run(&mut session, Command::EndGesture);
    let after = pose_of(&session, first).inverse() * pose_of(&session, second);
    // Rounding of one product, however long the drag: lengths here are thousands of millimetres.
    assert!(after.translation_mm.distance(between.translation_mm) < 1e-8);
    assert!(after.angle_to(&between) < 1e-7);
    press(&mut session, CommandId::Undo);
    assert!((pose_of(&session, first).inverse() * pose_of(&session, second)).angle_to(&between) < 1e-12);
    // A snap is a motion too; what is only selected with it stays.
    let camera_from_object = turn * pose_of(&session, first);
    let snap = Command::TakeSnap { photo: first.0, object: first.1, camera_from_object, covariance: None };
    run(&mut session, snap.clone());
    assert!((pose_of(&session, first).inverse() * pose_of(&session, second)).angle_to(&between) < 1e-7);
    press(&mut session, CommandId::Undo);
    press(&mut session, CommandId::UnlinkObjects);
    press(&mut session, CommandId::SelectAll);
    let second_before = pose_of(&session, second);
    run(&mut session, snap);
    assert_eq!(pose_of(&session, second), second_before);
    press(&mut session, CommandId::Undo);
    run(&mut session, Command::Select(Some(first.1)));
    let second_before = pose_of(&session, second);
    run(&mut session, Command::Nudge(Nudge::Left, 10.0));
    assert_eq!(pose_of(&session, second), second_before);
    press(&mut session, CommandId::SelectAll);
    press(&mut session, CommandId::LinkObjects);
    run(&mut session, Command::RemoveObject(second.1));
    assert_eq!(session.scene().objects[0].link, None, "nobody is left linked alone");
}

#[test]
fn enter_confirms_and_carries_to_an_untouched_photo() {
    let (mut session, [first, .., last], object) = sequence();
    let moved = pose_of(&session, (first, object)).translated(DVec3::X * 20.0);
    assert!(press(&mut session, CommandId::ConfirmAndNext).len() == 1, "an untouched pose is not confirmed");
    assert_eq!(state_of(&session, (first, object)), AnnotationState::Untouched);
    set_pose(&mut session, (first, object), moved);
    press(&mut session, CommandId::ConfirmAndNext);
    assert_eq!(state_of(&session, (first, object)), AnnotationState::Confirmed);
    let shown = session.photo().unwrap().id;
    assert_ne!(shown, first);
    if session.photo().unwrap().asset.width == 640 {
        assert_eq!(state_of(&session, (shown, object)), AnnotationState::Carried);
        assert_eq!(pose_of(&session, (shown, object)), moved);
        // A carried pose is one to snap from; a confirmed one stays.
        assert_eq!(press(&mut session, CommandId::SnapAll), [Effect::SnapAll(vec![(shown, object)])]);
    }
    // Photos of another size are no sequence.
    assert!(session.scene().annotation(last, object).is_none());
    let refused = session.apply(Command::Nudge(Nudge::Left, 1.0), NOW_MS);
    assert!(refused.is_ok() || session.selected_annotation().is_none());
    run(&mut session, Command::ShowPhoto(first));
    let refused = session.apply(Command::Nudge(Nudge::Left, 1.0), NOW_MS).unwrap_err();
    assert!(matches!(refused, CommandError::Confirmed(_)), "{refused}");
    press(&mut session, CommandId::Reopen);
    run(&mut session, Command::Nudge(Nudge::Left, 1.0));
    assert_eq!(state_of(&session, (first, object)), AnnotationState::Posed);
}

#[test]
fn carried_and_untouched_poses_are_not_exported() {
    let (mut session, [first, ..], object) = sequence();
    let pose = pose_of(&session, (first, object)).translated(DVec3::X);
    set_pose(&mut session, (first, object), pose);
    press(&mut session, CommandId::ConfirmAndNext);
    assert_eq!(session.document(Keep::Annotated).pose_count(), 1);
}

#[test]
fn a_stored_pose_is_come_back_to() {
    let mut session = small_session();
    let target = target(&session);
    set_pose(&mut session, target, Pose::from_translation(DVec3::new(1.0, 2.0, 600.0)));
    let stored = pose_of(&session, target);
    press(&mut session, CommandId::StoreReference);
    run(&mut session, Command::Nudge(Nudge::YawLeft, 1.0));
    press(&mut session, CommandId::BackToReference);
    assert_eq!(pose_of(&session, target), stored);
    press(&mut session, CommandId::ResetPose);
    assert_eq!(state_of(&session, target), AnnotationState::Untouched);
    run(&mut session, Command::EditObject(target.1, ObjectChange::Locked(true)));
    assert!(session.apply(Command::Run(CommandId::ResetPose), NOW_MS).is_err(), "a locked object stays");
}

#[test]
fn poses_are_pasted_with_a_word_where_they_were_corrected() {
    let mut session = small_session();
    let target = target(&session);
    let paste =
        |session: &mut Session, text: &str| session.apply(Command::SetPoseFromText(text.to_owned()), NOW_MS);
    let effects = paste(&mut session, "[[1,0,0,5],[0,1,0,6],[0,0,1,700],[0,0,0,1]]").unwrap();
    assert!(effects.is_empty());
    assert_eq!(pose_of(&session, target), Pose::from_translation(DVec3::new(5.0, 6.0, 700.0)));
    let effects = paste(&mut session, "1.1 0 0 5\n0 1 0 6\n0 0 1 700").unwrap();
    assert!(
        matches!(&effects[..], [Effect::Notify(notice)] if notice.text.contains("nearest")),
        "{effects:?}"
    );
    let before = pose_of(&session, target);
    for bad in ["0 0 0 5 0 0 0 6 0 0 1 700", "1 2", "nan nan nan"] {
        assert!(paste(&mut session, bad).is_err(), "{bad}");
        assert_eq!(pose_of(&session, target), before);
    }
    let effects = press(&mut session, CommandId::CopyPoseNumPy);
    let Effect::CopyText(text) = &effects[0] else { panic!("{effects:?}") };
    press(&mut session, CommandId::ResetPose);
    paste(&mut session, text).unwrap();
    assert_eq!(pose_of(&session, target), before);
}

#[test]
fn the_log_leads_back_and_its_clearing_can_be_undone() {
    let mut session = small_session();
    let target = target(&session);
    let poses = [500.0, 600.0, 700.0].map(|depth_mm| Pose::from_translation(DVec3::Z * depth_mm));
    poses.into_iter().for_each(|pose| set_pose(&mut session, target, pose));
    assert_eq!(session.log().len(), 3);
    let entry = session.log()[0].clone();
    assert_eq!((entry.label, &*entry.object_name, &*entry.photo_name), ("Set pose", "box", "photo.png"));
    run(&mut session, Command::ReturnTo(Box::new(entry)));
    assert_eq!(pose_of(&session, target), poses[0]);
    assert_eq!(session.log().len(), 4);
    press(&mut session, CommandId::ClearLog);
    assert!(session.log().is_empty());
    press(&mut session, CommandId::Undo);
    assert_eq!(session.log().len(), 4);
}

#[test]
fn a_mirror_and_a_spacing_change_the_mesh_and_never_the_pose() {
    let mut session = small_session();
    let target = target(&session);
    set_pose(&mut session, target, Pose::from_translation(DVec3::Z * 600.0));
    let object = |session: &Session| session.scene().object(target.1).unwrap().clone();
    let start = object(&session);
    let frame = MeshFrame(start.mesh_from_file).mirrored(0).with_spacing(2, 2.0).unwrap();
    run(&mut session, Command::EditObject(target.1, ObjectChange::MeshFrame(frame)));
    let changed = object(&session);
    assert_eq!(pose_of(&session, target), Pose::from_translation(DVec3::Z * 600.0));
    assert_eq!(changed.mesh.mesh.bounds().max, DVec3::new(40.0, 30.0, 40.0));
    let back = MeshFrame(changed.mesh_from_file).mirrored(0).with_spacing(2, 1.0).unwrap();
    run(&mut session, Command::EditObject(target.1, ObjectChange::MeshFrame(back)));
    assert_eq!(object(&session).mesh_from_file, start.mesh_from_file);
    assert_eq!(object(&session).mesh.mesh.positions_mm(), start.mesh.mesh.positions_mm());
    let flat = MeshFrame(glam::DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0)));
    let refused = session.apply(Command::EditObject(target.1, ObjectChange::MeshFrame(flat)), NOW_MS);
    assert!(refused.is_err());
    press(&mut session, CommandId::Undo);
    assert_eq!(object(&session).mesh_from_file, frame.0);
}

#[test]
fn masks_belong_to_their_photo_and_survive_saving() {
    let mut session = small_session();
    let target = target(&session);
    let image = |name: &str, width| Arc::new(read_photo(&flat_photo(name, width, 480)).unwrap().0);
    let effects =
        run(&mut session, Command::ImportMasks(vec![image("mask.png", 640), image("small.png", 600)]));
    assert!(matches!(&effects[..], [Effect::Notify(notice)] if notice.text.contains("600")), "{effects:?}");
    let mask = session.scene().masks[0].clone();
    assert_eq!((mask.photo, mask.object), (target.0, Some(target.1)));
    run(&mut session, Command::EditMask(mask.id, MaskChange::Opacity(0.25)));
    run(&mut session, Command::EditMask(mask.id, MaskChange::Name("hand drawn".to_owned())));

    let document = session.document(Keep::Everything);
    let photos = session.scene().photos.iter().map(|photo| photo.asset.clone());
    let images = photos.chain([mask.asset.clone()]).collect();
    let meshes = session.scene().objects.iter().map(|object| object.mesh.clone()).collect();
    let mut reopened = Session::default();
    let opening = Opening { document, photos: images, meshes, restored: false };
    run(&mut reopened, Command::Open(Box::new(opening)));
    assert_eq!(reopened.scene().masks.len(), 1);
    let reopened_mask = &reopened.scene().masks[0];
    assert_eq!((reopened_mask.name.as_str(), reopened_mask.opacity), ("hand drawn", 0.25));
    assert_eq!(reopened_mask.object, Some(reopened.scene().objects[0].id));
    assert_eq!(reopened.scene().photos.len(), session.scene().photos.len(), "a mask is no photo");

    run(&mut session, Command::RemovePhoto(target.0));
    assert!(session.scene().masks.is_empty());
    press(&mut session, CommandId::Undo);
    assert_eq!(session.scene().masks.len(), 1);
}

#[test]
fn a_depth_map_belongs_to_its_photo_and_survives_saving() {
    let mut session = small_session();
    let photo = target(&session).0;
    let image = |name: &str, width| Arc::new(read_photo(&flat_photo(name, width, 480)).unwrap().0);
    let refused = session.apply(Command::ImportDepth(image("small.png", 600)), NOW_MS).unwrap_err();
    assert!(refused.to_string().contains("640 × 480 pixels, expected; this has 600"), "{refused}");
    let bytes = png_gray16(640, 480, vec![8000; 640 * 480]).unwrap();
    let depth = NamedFile { name: "depth.png".to_owned(), bytes: Arc::from(bytes) };
    let depth = Arc::new(read_photo(&depth).unwrap().0);
    run(&mut session, Command::ImportDepth(depth.clone()));
    for wrong in [0.0, -1.0, f64::NAN] {
        let command = Command::EditPhoto(photo, PhotoChange::DepthScale(wrong));
        assert!(session.apply(command, NOW_MS).is_err(), "{wrong}");
    }
    run(&mut session, Command::EditPhoto(photo, PhotoChange::DepthScale(0.1)));
    run(&mut session, Command::EditPhoto(photo, PhotoChange::DepthOccludes(false)));
    assert_eq!(session.scene().files().len(), 3, "photo, depth map and mesh");

    let document = session.document(Keep::Everything);
    let images = vec![session.scene().photos[0].asset.clone(), depth.clone()];
    let meshes = session.scene().objects.iter().map(|object| object.mesh.clone()).collect();
    let mut reopened = Session::default();
    run(
        &mut reopened,
        Command::Open(Box::new(Opening { document, photos: images, meshes, restored: false })),
    );
    let found = reopened.scene().photos[0].depth.clone().unwrap();
    assert_eq!((found.asset, found.mm_per_unit, found.occludes), (depth, 0.1, false));
    assert_eq!(reopened.scene().photos.len(), 1, "a depth map is no photo");

    run(&mut session, Command::EditPhoto(photo, PhotoChange::WithoutDepth));
    assert!(session.scene().photos[0].depth.is_none());
    press(&mut session, CommandId::Undo);
    assert!(session.scene().photos[0].depth.is_some());
}

#[test]
fn a_slider_under_the_hand_is_one_undo_step() {
    let mut session = small_session();
    let object = target(&session).1;
    for (index, opacity) in [0.6, 0.5, 0.4].into_iter().enumerate() {
        let time_ms = NOW_MS + 100.0 * index as f64;
        session.apply(Command::EditObject(object, ObjectChange::Opacity(opacity)), time_ms).unwrap();
    }
    assert_eq!(session.scene().objects[0].opacity, 0.4);
    // A slider that is pressed where it stands, and then moved, is undone too.
    let later = NOW_MS + 10_000.0;
    session.apply(Command::EditObject(object, ObjectChange::Opacity(0.4)), later).unwrap();
    session.apply(Command::EditObject(object, ObjectChange::Opacity(0.9)), later + 50.0).unwrap();
    press(&mut session, CommandId::Undo);
    assert_eq!(session.scene().objects[0].opacity, 0.4);
    press(&mut session, CommandId::Undo);
    assert_eq!(session.scene().objects[0].opacity, 0.7);
}

#[test]
fn what_concerns_all_selected_objects_changes_all_of_them() {
    let mut session = small_session();
    let first = target(&session).1;
    press(&mut session, CommandId::DuplicateObject);
    press(&mut session, CommandId::SelectAll);
    run(&mut session, Command::EditObject(first, ObjectChange::Visible(false)));
    assert!(session.scene().objects.iter().all(|object| !object.visible));
    run(&mut session, Command::EditObject(first, ObjectChange::Name("lid".to_owned())));
    assert_eq!(session.scene().objects[1].name, "box 2");
    run(&mut session, Command::SelectAlso(first));
    assert_eq!(session.selection().len(), 1);
    press(&mut session, CommandId::SelectAll);
    press(&mut session, CommandId::RemoveObject);
    assert!(session.scene().objects.is_empty());
}

#[test]
fn lists_are_put_in_order_by_hand() {
    let mut session = small_session();
    press(&mut session, CommandId::DuplicateObject);
    press(&mut session, CommandId::DuplicateObject);
    let names = |session: &Session| -> Vec<String> {
        session.scene().objects.iter().map(|object| object.name.clone()).collect()
    };
    let before = names(&session);
    let first = session.scene().objects[0].id;
    run(&mut session, Command::MoveObject(first, 3));
    assert_eq!(names(&session), [&before[1], &before[2], &before[0]].map(String::clone));
    run(&mut session, Command::MoveObject(first, 0));
    assert_eq!(names(&session), before);
}

#[test]
fn a_locked_photo_keeps_camera_and_poses() {
    let mut session = small_session();
    let (photo, object) = target(&session);
    run(&mut session, Command::EditPhoto(photo, PhotoChange::Locked(true)));
    let camera = Intrinsics::pinhole(700.0, 700.0, 320.0, 240.0, 640, 480);
    let origin = CameraOrigin::Typed;
    assert!(session.apply(Command::SetCamera { photo, camera, origin: origin.clone() }, NOW_MS).is_err());
    assert!(session.apply(Command::Nudge(Nudge::Left, 1.0), NOW_MS).is_err());
    run(&mut session, Command::EditPhoto(photo, PhotoChange::Locked(false)));
    run(&mut session, Command::SetCamera { photo, camera, origin });
    run(&mut session, Command::ResetCamera(photo));
    let reset = session.photo().unwrap();
    assert_eq!((reset.camera.fx, reset.camera_origin.is_guess()), (520.5, false));
    let _ = object;
}

#[test]
fn poses_are_copied_from_another_photo() {
    let (mut session, [first, _, last], object) = sequence();
    let pose = Pose::from_translation(DVec3::new(3.0, 4.0, 650.0));
    set_pose(&mut session, (first, object), pose);
    run(&mut session, Command::ShowPhoto(last));
    run(&mut session, Command::Select(Some(object)));
    run(&mut session, Command::CopyPosesFrom(first));
    assert_eq!(pose_of(&session, (last, object)), pose);
    assert!(session.apply(Command::CopyPosesFrom(PhotoId(999)), NOW_MS).is_err());
}

#[test]
fn imported_poses_are_in_the_history() {
    let mut session = small_session();
    let truth =
        format!("{}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n", crate::support::CAMERA_JSON);
    drop_files(&mut session, &[text_file("truth.txt", &truth)], Some(PosesAs::Annotations));
    let [line] = session.log() else { panic!("{:?}", session.log()) };
    assert_eq!((line.label, line.source), ("Import", PoseSource::Imported));
    assert_eq!(line.camera_from_object.translation_mm, DVec3::new(5.0, 6.0, 700.0));
}

#[test]
fn another_object_of_a_spaced_mesh_is_spaced_too() {
    let mut session = small_session();
    let object = target(&session).1;
    let frame = MeshFrame(glam::DMat4::IDENTITY).with_spacing(0, 3.0).unwrap();
    run(&mut session, Command::EditObject(object, ObjectChange::MeshFrame(frame)));
    let truth = format!(
        "{}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\nbox <-> photo\n1 0 0 50\n0 1 0 6\n0 0 1 700\n0 0 0 1\n",
        crate::support::CAMERA_JSON
    );
    drop_files(&mut session, &[text_file("truth.txt", &truth)], Some(PosesAs::Annotations));
    for object in &session.scene().objects {
        assert_eq!(
            (object.mesh_from_file, object.mesh.mesh.bounds().max.x),
            (frame.0, 120.0),
            "{}",
            object.name
        );
    }
    drop_files(&mut session, &[box_mesh("box.obj")], None);
}
