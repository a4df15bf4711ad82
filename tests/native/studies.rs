//! The files of a study, and the example study: it is packed from the demo scene, and its truth stays beside it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DMat3, DVec3};
use pinpose::formats::{Archive, NamedFile, read_mesh_with, read_photo_header};
use pinpose::math::{Intrinsics, Pose};
use pinpose::scene::{Annotation, AnnotationState, CameraOrigin, Scene};
use pinpose::study::pack::{Draft, Pack, Role, StudyFiles};
use pinpose::study::{
    Completion, Environment, Item, ItemKind, Participant, Plan, Questionnaire, QuestionnaireKind,
    QuestionnaireTime, RESULTS_SCHEMA, Results, STUDY_SCHEMA, StartPose, Study, TRUTH_SCHEMA, Truth, rfc3339,
};
use serde_json::Value;

fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo")
}

pub fn check_schema(schema: &str, file: &str) {
    let schema: Value = serde_json::from_str(schema).unwrap();
    let file: Value = serde_json::from_str(file).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> =
        validator.iter_errors(&file).map(|error| format!("{}: {error}", error.instance_path)).collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

fn read(path: &Path) -> NamedFile {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    NamedFile { name, bytes: std::fs::read(path).unwrap().into() }
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list: Vec<f64> = value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect();
    list.try_into().unwrap()
}

/// One object in one photo of the demo scene: the mesh, its name, the scene, the image.
const CHOSEN: [(&str, &str, u32, u32, u32, Role); 3] = [
    ("obj_000001.ply", "tea tin", 1, 1, 10, Role::Practice),
    ("obj_000005.ply", "toy car", 5, 1, 6, Role::Sample),
    ("obj_000004.ply", "mug", 4, 2, 3, Role::Sample),
];

/// The scene that a researcher would have open: three photos, each with one object that is confirmed at its truth.
fn researchers_scene() -> Scene {
    let mut scene = Scene::named("Example");
    for (mesh, name, id, folder, image, _) in CHOSEN {
        let folder = demo().join(format!("bop/test/{folder:06}"));
        let photo = read(&folder.join(format!("rgb/{image:06}.jpg")));
        let photo = scene.add_photo(Arc::new(read_photo_header(&photo).unwrap()));
        let json = |file: &str| -> Value {
            serde_json::from_slice(&std::fs::read(folder.join(file)).unwrap()).unwrap()
        };
        let k = numbers::<9>(&json("scene_camera.json")[image.to_string()]["cam_K"]);
        let camera = Intrinsics::pinhole(k[0], k[4], k[2], k[5], 960, 720);
        scene.set_camera(photo, camera, CameraOrigin::File("scene_camera.json".to_owned()));
        let mesh = read(&demo().join("bop/models").join(mesh));
        let texture = read(&demo().join("bop/models/obj_000001.png"));
        let companions = if id == 1 { vec![texture] } else { Vec::new() };
        let object = scene.add_object(Arc::new(read_mesh_with(&mesh, &companions).unwrap().0));
        scene.object_mut(object).unwrap().name = name.to_owned();
        let truth = json("scene_gt.json");
        let poses = truth[image.to_string()].as_array().unwrap();
        let pose = poses.iter().find(|pose| pose["obj_id"] == id).unwrap();
        let rotation = DMat3::from_cols_array(&numbers::<9>(&pose["cam_R_m2c"])).transpose();
        let translation = DVec3::from_array(numbers::<3>(&pose["cam_t_m2c"]));
        let (pose, _) = Pose::from_parts(rotation, translation).unwrap();
        let confirmed = Annotation { state: AnnotationState::Confirmed, ..Annotation::untouched(pose, 0.0) };
        scene.annotations.insert((photo, object), confirmed);
    }
    scene
}

const CONSENT: &str = "# Would you like to take part?\n\nThis is an **example** of a study: nothing is sent \
    anywhere, and you can stop whenever you like by closing this page.\n\n- It takes about five minutes.\n\
    - What you do with mouse and keys is recorded, with its times.\n- The results stay in this browser until you remove \
    them.";

const INSTRUCTIONS: &str = "# What to do\n\nYou will see photos of a table. In each of them, *one* object is drawn over the \
    photo.\n\n1. Move and turn the drawn object until it lies **exactly** on the real one.\n2. Press **Confirm** when it is as \
    good as you can make it.\n\nBe accurate first, and quick second.";

fn example_study() -> Study {
    let mut study = Study::new("example", "Example study: objects on a table");
    study.texts.consent = CONSENT.to_owned();
    study.texts.instructions = INSTRUCTIONS.to_owned();
    study.texts.thanks = "Thank you for trying the example.".to_owned();
    study.start_pose = StartPose::Centered;
    study.schedule.repeats = 2;
    let options = ["Never", "A few times", "Often"].map(str::to_owned).to_vec();
    study.items_before = vec![Item {
        id: "expertise".to_owned(),
        text: "How often have you worked with 3D programs?".to_owned(),
        optional: false,
        answer: ItemKind::Choice { options, several: false },
    }];
    let at_end = |id: &str, kind| Questionnaire { id: id.to_owned(), when: QuestionnaireTime::End, kind };
    study.questionnaires = vec![
        at_end("tlx", QuestionnaireKind::NasaTlx { weighted: false }),
        at_end("sus", QuestionnaireKind::Sus),
    ];
    study.completion = Completion { code: Some("TABLE-42".to_owned()), ..Completion::default() };
    study
}

pub fn example_pack() -> Pack {
    let scene = researchers_scene();
    let mut draft = Draft::of_scene(&scene, example_study());
    draft.chosen.iter_mut().zip(CHOSEN).for_each(|(chosen, (.., role))| chosen.role = role);
    draft.pack(&scene).unwrap()
}

/// Writes the example study anew: `cargo test --test native -- --ignored the_example_study_is_written`.
#[test]
#[ignore = "writes into the tree"]
fn the_example_study_is_written() {
    let pack = example_pack();
    std::fs::write(demo().join("study.zip"), pack.zip().unwrap()).unwrap();
    std::fs::write(demo().join("study_truth.json"), pack.truth.to_json()).unwrap();
}

#[test]
fn the_example_study_is_what_the_demo_scene_makes_and_holds_no_truth() {
    let pack = example_pack();
    let stored: Arc<[u8]> = std::fs::read(demo().join("study.zip")).unwrap().into();
    let files = StudyFiles::from_zip(stored.clone()).unwrap();
    assert_eq!(files.study, pack.study, "write it anew: the_example_study_is_written");
    let truth = Truth::from_json(&std::fs::read(demo().join("study_truth.json")).unwrap()).unwrap();
    assert_eq!(truth, pack.truth);
    assert_eq!(truth.study_sha256, files.sha256);

    check_schema(STUDY_SCHEMA, &files.study.to_json());
    check_schema(TRUTH_SCHEMA, &truth.to_json());
    // The practice sample's truth is there, for feedback; that of no other.
    let mut archive = Archive::open(stored).unwrap();
    let json = String::from_utf8(archive.read("study.json").unwrap().to_vec()).unwrap();
    for sample in &truth.samples {
        for number in sample.pose.unwrap().translation_mm {
            assert!(!json.contains(&number.to_string()), "{}", sample.id);
        }
    }
    let paths: Vec<String> = archive.listing("s").unwrap().paths().map(str::to_owned).collect();
    assert!(paths.iter().all(|path| path == "study.json" || path.starts_with("assets/")), "{paths:?}");
    assert!(pack.download_bytes() < 2 << 20, "{}", pack.download_bytes());
}

#[test]
fn every_kind_of_setting_is_in_the_schema() {
    let mut study = example_pack().study;
    study.start_pose = StartPose::Random { least_depth_mm: 300.0, most_depth_mm: 900.0 };
    study.limits.trial_seconds = Some(120.0);
    study.limits.break_after_trials = Some(5);
    study.schedule.seed = Some(7);
    study.saving = pinpose::study::Saving::DataPipe { experiment_id: "abc".to_owned(), url: None };
    study.questionnaires.push(Questionnaire {
        id: "own".to_owned(),
        when: QuestionnaireTime::EachCondition,
        kind: QuestionnaireKind::Own { title: "More".to_owned(), items: study.items_before.clone() },
    });
    check_schema(STUDY_SCHEMA, &study.to_json());
    assert_eq!(Study::from_json(study.to_json().as_bytes()).unwrap(), study);
}

#[test]
fn results_of_nobody_are_as_their_schema_says() {
    let study = example_pack();
    let files = StudyFiles::from_zip(study.zip().unwrap().into()).unwrap();
    let plan = Plan::new(&files.study, "P1", &pinpose::study::AskedFor::default()).unwrap();
    let participant = Participant { id: "P1".to_owned(), recruiter: Default::default() };
    let results = Results::new(files.record(), participant, Environment::default(), plan.seed, rfc3339(0.0));
    check_schema(RESULTS_SCHEMA, &results.to_json());
    assert_eq!(Results::from_json(results.to_json().as_bytes()).unwrap(), results);
}
