//! Our own files: bit for bit there and back, as the schema says, and refused in words where they are not.

use std::sync::Arc;

use glam::DVec3;
use pinpose::formats::{
    DOCUMENT_SCHEMA, Keep, NamedFile, PosesAs, classify, parse_text_or_archive, read_document,
    read_mesh_with, read_workspace, write_document, write_workspace,
};
use pinpose::math::Pose;
use pinpose::scene::{MeshFrame, PoseSource};
use pinpose::session::{Batch, Command, Effect, ObjectChange, Opening, Session};
use proptest::prelude::*;

use crate::support::{NOW_MS, drop_files, linemod_session, small_session, text_file};

fn with_pose(pose: Pose) -> Session {
    let mut session = small_session();
    let (photo, object, _) = session.selected_annotation().unwrap();
    let command = Command::SetPose { photo, object, camera_from_object: pose, source: PoseSource::Manual };
    session.apply(command, NOW_MS).unwrap();
    session
}

fn only_pose(session: &Session) -> Pose {
    session.scene().annotations.values().next().unwrap().camera_from_object
}

proptest! {
    // Each case decodes a PNG; enough of them still run to meet every kind of rounding.
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn poses_survive_export_import_export_bit_for_bit(w in [-3.0..3.0, -3.0..3.0, -3.0..3.0], t in [-900.0..900.0, -900.0..900.0, 100.0..4000.0_f64]) {
        let pose = Pose::exp(DVec3::from_array(w), DVec3::ZERO);
        let pose = Pose { translation_mm: DVec3::from_array(t), ..pose };
        let exported = write_document(&with_pose(pose).document(Keep::Annotated));

        let mut again = small_session();
        drop_files(&mut again, &[text_file("poses.json", &exported)], Some(PosesAs::Annotations));
        prop_assert_eq!(only_pose(&again), pose);
        prop_assert_eq!(write_document(&again.document(Keep::Annotated)), exported);
    }
}

#[test]
fn a_texture_that_comes_later_is_taken_and_stays_with_its_mesh() {
    let file = |name: &str, bytes: &[u8]| NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) };
    let mesh = file("m.obj", b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    let library = file("m.mtl", b"newmtl a\nKd 1 0 0\n");
    let mut session = Session::default();
    drop_files(&mut session, std::slice::from_ref(&mesh), None);
    assert!(!session.scene().objects[0].mesh.mesh.has_colors());
    let (complete, _) = read_mesh_with(&mesh, &[library]).unwrap();
    let batch = Batch { meshes: vec![Arc::new(complete)], ..Batch::default() };
    session.apply(Command::Import(Box::new(batch)), NOW_MS).unwrap();
    assert_eq!(session.scene().objects.len(), 1);
    assert!(session.scene().objects[0].mesh.mesh.has_colors());

    let zip = write_workspace(&session.document(Keep::Everything), session.scene()).unwrap();
    let workspace = read_workspace(&zip).unwrap();
    assert_eq!(workspace.files.len(), 1);
    let entry = &workspace.files[0];
    assert_eq!((entry.file.name.as_str(), entry.companions[0].name.as_str()), ("m.obj", "m.mtl"));
}

#[test]
fn linemod_survives_a_workspace() {
    let Some(session) = linemod_session() else { return };
    let document = session.document(Keep::Everything);
    let zip = write_workspace(&document, session.scene()).unwrap();
    println!("workspace of ten photos and ten meshes: {} bytes", zip.len());
    let workspace = read_workspace(&zip).unwrap();
    assert_eq!(workspace.files.len(), 20);
    let files: Vec<_> = workspace.files.into_iter().map(|entry| entry.file).collect();
    let batch = crate::support::batch_of(&files, None);
    let mut opened = Session::default();
    let opening =
        Opening { document: workspace.document, photos: batch.photos, meshes: batch.meshes, restored: true };
    opened.apply(Command::Open(Box::new(opening)), NOW_MS).unwrap();
    assert_eq!(write_document(&opened.document(Keep::Everything)), write_document(&document));
    assert!(opened.undo_label().is_none());
}

#[test]
fn exports_are_as_the_schema_says() {
    let schema: serde_json::Value = serde_json::from_str(DOCUMENT_SCHEMA).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let mut sessions = vec![small_session(), with_pose(Pose::from_translation(DVec3::new(1.0, 2.0, 800.0)))];
    sessions.extend(linemod_session());
    for session in sessions {
        for keep in [Keep::Annotated, Keep::Everything] {
            let text = write_document(&session.document(keep));
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{errors:?}");
        }
    }
    let mut wrong: serde_json::Value =
        serde_json::from_str(&write_document(&small_session().document(Keep::Everything))).unwrap();
    wrong["photos"][0]["sha256"] = "short".into();
    assert!(!validator.is_valid(&wrong), "the schema takes anything");
}

#[test]
fn symmetries_come_back_bit_for_bit() {
    let session = small_session();
    let mut value: serde_json::Value =
        serde_json::from_str(&write_document(&session.document(Keep::Everything))).unwrap();
    let half_turn =
        [[-1.0, 0.0, 0.0, 0.5], [0.0, -1.0, 0.0, 0.25], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    value["objects"][0]["symmetries"] = serde_json::json!({
        "discrete": [half_turn],
        "continuous": [{ "axis": [0.6, 0.0, 0.8], "offset_mm": [1.1, 2.2, 3.3] }],
    });
    let open = |value: &serde_json::Value| {
        let document = read_document(value.to_string().as_bytes()).unwrap();
        let photos = session.scene().photos.iter().map(|photo| photo.asset.clone()).collect();
        let meshes = session.scene().objects.iter().map(|object| object.mesh.clone()).collect();
        let mut opened = Session::default();
        let opening = Opening { document, photos, meshes, restored: true };
        let effects = opened.apply(Command::Open(Box::new(opening)), NOW_MS).unwrap();
        (opened, effects)
    };
    let (opened, _) = open(&value);
    let symmetries = &opened.scene().objects[0].symmetries;
    assert_eq!((symmetries.discrete.len(), symmetries.continuous.len()), (1, 1));
    let again: serde_json::Value =
        serde_json::from_str(&write_document(&opened.document(Keep::Everything))).unwrap();
    assert_eq!(again["objects"][0]["symmetries"], value["objects"][0]["symmetries"]);

    value["objects"][0]["symmetries"]["continuous"][0]["axis"] = serde_json::json!([0.0, 0.0, 0.0]);
    let (_, effects) = open(&value);
    let said = format!("{effects:?}");
    assert!(said.contains("symmetries.continuous[0]"), "{said}");
}

#[test]
fn an_untouched_pose_is_not_exported_as_an_annotation() {
    let session = small_session();
    assert_eq!(session.document(Keep::Annotated).pose_count(), 0);
    assert_eq!(session.document(Keep::Everything).pose_count(), 1);
}

#[test]
fn poses_without_their_files_wait_for_them() {
    let exported = write_document(
        &with_pose(Pose::from_translation(DVec3::new(1.0, 2.0, 800.0))).document(Keep::Annotated),
    );
    let mut session = Session::default();
    drop_files(&mut session, &[text_file("poses.json", &exported)], Some(PosesAs::Annotations));
    let missing: Vec<String> = session.missing_files().flat_map(|(_, files)| files.to_vec()).collect();
    assert_eq!(missing, ["photo.png", "box.obj"]);
    let files =
        [crate::support::flat_photo("renamed.png", 640, 480), crate::support::box_mesh("renamed.obj")];
    drop_files(&mut session, &files, None);
    assert_eq!(only_pose(&session).translation_mm, DVec3::new(1.0, 2.0, 800.0));
    assert_eq!(session.missing_files().count(), 0);
    assert_eq!(session.photo().unwrap().camera.fx, 520.5);
}

/// What the first drop gave may be changed by hand before the rest of the files comes.
#[test]
fn late_files_do_not_undo_what_was_done_meanwhile() {
    let exported = |name: &str| {
        let truth =
            format!("{}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n", crate::support::CAMERA_JSON);
        text_file(name, &format!("{truth}\nother <-> photo\n1 0 0 1\n0 1 0 2\n0 0 1 800\n0 0 0 1\n"))
    };
    let mut session = small_session();
    drop_files(&mut session, &[exported("truth.txt")], Some(PosesAs::Annotations));
    let (photo, object, _) = session.selected_annotation().unwrap();
    let moved = Pose::from_translation(DVec3::new(9.0, 9.0, 900.0));
    let command = Command::SetPose { photo, object, camera_from_object: moved, source: PoseSource::Manual };
    session.apply(command, NOW_MS).unwrap();
    let mut late = crate::support::box_mesh("other.obj");
    late.bytes = [&late.bytes[..], b"# another file"].concat().into();
    drop_files(&mut session, &[late], None);
    assert_eq!(session.scene().annotation(photo, object).unwrap().camera_from_object, moved);
    assert_eq!(session.scene().annotations.len(), 2);
    assert_eq!(session.missing_files().count(), 0);
}

#[test]
fn bad_documents_are_refused_in_words() {
    let good = write_document(&with_pose(Pose::from_translation(DVec3::Z * 500.0)).document(Keep::Annotated));
    let message = |text: &str| {
        let file = text_file("poses.json", text);
        parse_text_or_archive(&file, classify(&file.name, &file.bytes)).unwrap_err().to_string()
    };
    assert!(message(&good.replace("\"version\": 1", "\"version\": 7")).contains("version 7"));
    assert!(message(&good.replace("\"format\": \"pinpose\"", "\"format\": \"other\"")).contains("\"other\""));
    assert!(message(&good[..good.len() / 2]).contains("line"));
    assert!(message(&good.replacen("500.0", "501.0", 1)).contains("which one is right"));
    assert!(message("").contains("line 1"));
    let deep = "[".repeat(100_000);
    assert!(message(&format!("{{\"format\": {deep}")).contains("recursion"));
}

#[test]
fn every_truncation_and_many_flips_of_a_workspace_are_errors_or_scenes() {
    let session = with_pose(Pose::from_translation(DVec3::Z * 500.0));
    let zip = write_workspace(&session.document(Keep::Everything), session.scene()).unwrap();
    for length in (0..zip.len()).step_by(7) {
        assert!(read_workspace(&zip[..length]).is_err(), "{length} of {} bytes", zip.len());
    }
    let mut damaged = zip.clone();
    for position in 0..zip.len() {
        damaged[position] ^= 0x55;
        // An error or a scene; what must not happen is a panic.
        let _ = read_workspace(&damaged);
        damaged[position] ^= 0x55;
    }
    let text = write_document(&session.document(Keep::Everything));
    for length in 0..text.len() {
        assert!(read_document(&text.as_bytes()[..length]).is_err());
    }
}

/// As the first version has written it: a field that came later has to do without being there.
#[test]
fn what_the_first_version_has_written_opens() {
    let text = include_str!("../fuzz/document.json");
    let document = read_document(text.as_bytes()).unwrap();
    assert_eq!((document.files().count(), document.pose_count()), (3, 2));
    assert_eq!(document.name, "Example");
    let again = write_document(&document);
    assert_eq!(read_document(again.as_bytes()).unwrap(), document);
}

/// A session whose box was changed and posed, as a document.
fn saved_with_frame(change: impl Fn(&MeshFrame) -> MeshFrame, pose: Pose) -> (MeshFrame, NamedFile) {
    let mut session = with_pose(pose);
    let (_, object, _) = session.selected_annotation().unwrap();
    let frame = change(&MeshFrame(session.scene().object(object).unwrap().mesh_from_file));
    session.apply(Command::EditObject(object, ObjectChange::MeshFrame(frame)), NOW_MS).unwrap();
    // Changing its frame may have moved it.
    let command = Command::SetPose {
        photo: session.photo().unwrap().id,
        object,
        camera_from_object: pose,
        source: PoseSource::Manual,
    };
    session.apply(command, NOW_MS).unwrap();
    (frame, text_file("theirs.json", &write_document(&session.document(Keep::Annotated))))
}

#[test]
fn a_reference_brings_the_frame_of_a_mesh_that_has_no_poses_yet() {
    let pose = Pose::from_translation(DVec3::new(3.0, 4.0, 700.0));
    let (frame, saved) = saved_with_frame(|frame| frame.with_spacing(2, 2.0).unwrap(), pose);
    let mut session = small_session();
    drop_files(&mut session, &[saved], Some(PosesAs::Reference));
    let scene = session.scene();
    assert_eq!(scene.objects[0].mesh_from_file, frame.0);
    assert_eq!(scene.references[0].poses.values().next(), Some(&pose));
}

#[test]
fn a_reference_is_turned_into_the_frame_that_a_posed_mesh_has() {
    let pose = Pose::exp(DVec3::new(0.3, -0.2, 0.1), DVec3::ZERO).translated(DVec3::Z * 700.0);
    let (frame, saved) = saved_with_frame(|frame| frame.with_up_axis(1), pose);
    let mut session = with_pose(Pose::from_translation(DVec3::Z * 500.0));
    drop_files(&mut session, &[saved], Some(PosesAs::Reference));
    let scene = session.scene();
    let ours = scene.references[0].poses.values().next().unwrap();
    let at = |pose: &Pose, frame: &MeshFrame| {
        pose.transform_point(frame.0.transform_point3(DVec3::new(1.0, 2.0, 3.0)))
    };
    let unchanged = MeshFrame(scene.objects[0].mesh_from_file);
    assert_ne!(unchanged.0, frame.0);
    // Two products of rounded rotations, of a point 700 mm away.
    assert!(at(ours, &unchanged).distance(at(&pose, &frame)) < 1e-9);

    let (_, larger) = saved_with_frame(|frame| frame.with_spacing(0, 2.0).unwrap(), pose);
    let effects = drop_files(
        &mut session,
        &[NamedFile { name: "larger.json".to_owned(), ..larger }],
        Some(PosesAs::Reference),
    );
    assert_eq!(session.scene().references.len(), 1);
    let is_said =
        |effect: &Effect| matches!(effect, Effect::Notify(notice) if notice.text.contains("another size"));
    assert!(effects.iter().any(is_said), "{effects:?}");
}

#[test]
fn a_photo_that_is_open_under_another_name_is_not_added_silently() {
    let mut session = small_session();
    let effects = drop_files(&mut session, &[crate::support::flat_photo("copy.png", 640, 480)], None);
    assert_eq!(session.scene().photos.len(), 1);
    assert!(
        matches!(&effects[..], [Effect::Notify(notice)] if notice.text.contains("copy.png") && notice.text.contains("photo.png")),
        "{effects:?}"
    );
    // The same file again is what it was.
    assert_eq!(drop_files(&mut session, &[crate::support::flat_photo("photo.png", 640, 480)], None), []);
}
