//! The files of a study, and the example study: it is packed from the demo scene, and its truth stays beside it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DMat3, DVec3};
use pinpose::formats::{Archive, NamedFile, read_mesh_with, read_photo_header};
use pinpose::math::{Intrinsics, Pose};
use pinpose::scene::{Annotation, AnnotationState, CameraOrigin, Scene, Symmetries};
use pinpose::study::check::check;
use pinpose::study::pack::{Draft, Pack, Role, StudyFiles, reopened};
use pinpose::study::{
    Completion, Environment, Item, ItemKind, Participant, Plan, Questionnaire, QuestionnaireKind,
    QuestionnaireTime, RESULTS_SCHEMA, Results, STUDY_SCHEMA, StartPose, Study, TRUTH_SCHEMA, Truth,
    framed_mesh, rfc3339,
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
fn an_exported_study_comes_back_to_be_changed() {
    let mut scene = researchers_scene();
    let object = scene.objects[1].id;
    scene.object_mut(object).unwrap().symmetries = Symmetries {
        discrete: vec![Pose::exp(DVec3::Z * std::f64::consts::PI, DVec3::ZERO)],
        continuous: Vec::new(),
    };
    let mut draft = Draft::of_scene(&scene, example_study());
    draft.chosen.iter_mut().zip(CHOSEN).for_each(|(chosen, (.., role))| chosen.role = role);
    draft.chosen[1].set = Some("cars".to_owned());
    draft.chosen[2].set = Some("mugs".to_owned());
    let photo = demo().join("bop/test/000001/rgb/000010.jpg");
    draft.pictures = vec![("hint.jpg".to_owned(), std::fs::read(photo).unwrap().into())];
    draft.study.texts.instructions += "\n\n![a hint](hint.jpg)\n";
    let pack = draft.pack(&scene).unwrap();

    let files = StudyFiles::from_zip(pack.zip().unwrap().into()).unwrap();
    let photos: BTreeMap<_, _> = files
        .study
        .photos
        .iter()
        .map(|photo| {
            let file = files.file(&photo.asset).unwrap();
            (photo.id.clone(), Arc::new(read_photo_header(&file).unwrap()))
        })
        .collect();
    let meshes: BTreeMap<_, _> = files
        .study
        .objects
        .iter()
        .map(|object| {
            let companions: Vec<NamedFile> =
                object.companions.iter().map(|asset| files.file(asset).unwrap()).collect();
            let mesh = read_mesh_with(&files.file(&object.mesh).unwrap(), &companions).unwrap().0;
            (object.id.clone(), framed_mesh(&files.study, &object.id, &Arc::new(mesh)).unwrap())
        })
        .collect();
    let (scene, draft) = reopened(&files, &photos, &meshes, Some(&pack.truth)).unwrap();
    let again = draft.pack(&scene).unwrap();
    let truths = |pack: &Pack| -> Vec<_> {
        pack.truth
            .samples
            .iter()
            .map(|sample| {
                (
                    sample.id.clone(),
                    sample.set.clone(),
                    sample.pose,
                    sample.photo_sha256.clone(),
                    sample.symmetries.clone(),
                )
            })
            .collect()
    };
    assert_eq!(truths(&again), truths(&pack));
    assert_eq!(again.study.texts, pack.study.texts);
    assert_eq!(again.study.practice[0].truth, pack.study.practice[0].truth);
    let assets =
        |pack: &Pack| pack.study.assets().into_iter().map(|asset| asset.sha256.clone()).collect::<Vec<_>>();
    assert_eq!(assets(&again), assets(&pack));

    // Without its truth it comes too, and nothing is made up.
    let (scene, draft) = reopened(&files, &photos, &meshes, None).unwrap();
    let known: Vec<bool> =
        draft.chosen.iter().map(|chosen| draft.truth_of(&scene, chosen).is_some()).collect();
    assert_eq!(known.iter().filter(|known| **known).count(), 1, "only the practice sample's is in the study");
    let mut other = pack.truth.clone();
    other.study = "other".to_owned();
    let refused = reopened(&files, &photos, &meshes, Some(&other)).unwrap_err().to_string();
    assert!(refused.contains("true poses of the study \"other\""), "{refused}");
}

#[test]
fn pictures_of_texts_are_looked_for_and_stripped() {
    let scene = researchers_scene();
    let mut draft = Draft::of_scene(&scene, example_study());
    draft.chosen.iter_mut().zip(CHOSEN).for_each(|(chosen, (.., role))| chosen.role = role);
    draft.study.texts.consent += "\n\n![us](we.jpg)";
    let says = |draft: &Draft, words: &str| {
        let pack = draft.pack(&scene);
        check(draft, &scene, pack.as_ref()).iter().any(|finding| finding.text.contains(words))
    };
    assert!(says(&draft, "A text shows we.jpg, which is not among the pictures"));
    // A JPEG with a comment, as cameras and programs write them.
    let photo = std::fs::read(demo().join("bop/test/000001/rgb/000010.jpg")).unwrap();
    let secret = b"taken at home";
    let mut told = photo[..2].to_vec();
    told.extend([0xff, 0xfe, 0, (secret.len() + 2) as u8]);
    told.extend(secret);
    told.extend(&photo[2..]);
    draft.pictures = vec![("we.jpg".to_owned(), told.into()), ("unused.jpg".to_owned(), photo.into())];
    assert!(!says(&draft, "A text shows") && says(&draft, "unused.jpg is loaded, and no text shows it"));
    let pack = draft.pack(&scene).unwrap();
    let picture = &pack.study.texts.pictures[0];
    let (_, stored) = pack.files.iter().find(|(path, _)| *path == picture.path).unwrap();
    assert!(picture.path.contains(&picture.sha256) && pinpose::photo::decode(stored).is_ok());
    assert!(!stored.windows(secret.len()).any(|window| window == secret), "the comment is still there");
    draft.pictures = vec![("we.jpg".to_owned(), b"no picture".to_vec().into())];
    assert!(says(&draft, "we.jpg: this picture cannot be read"));
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
