use std::sync::Arc;

use super::*;
use crate::formats::Archive;
use crate::formats::{NamedFile, read_mesh, read_photo};
use crate::study::check::{Finding, check};
use crate::study::{StartPose, StudyError};

/// One photo with two objects of one mesh: the first is confirmed, the second has never been touched.
fn scene() -> Scene {
    let rgba = vec![90; 4 * 64 * 48];
    let png = crate::photo::png_rgba(&crate::photo::Pixels { width: 64, height: 48, rgba }).unwrap();
    let file = |name: &str, bytes: Vec<u8>| NamedFile { name: name.to_owned(), bytes: bytes.into() };
    let (photo, _) = read_photo(&file("folder/table.png", png)).unwrap();
    let obj = b"v 0 0 0\nv 30 0 0\nv 0 40 0\nf 1 2 3\n".to_vec();
    let (mesh, _) = read_mesh(&file("plate.obj", obj)).unwrap();
    let mesh = Arc::new(mesh);
    let mut scene = Scene::default();
    let photo = scene.add_photo(Arc::new(photo));
    for _ in 0..2 {
        let object = scene.add_object(mesh.clone());
        scene.place(photo, object, 0.0);
    }
    let first = scene.annotations.values_mut().next().unwrap();
    first.state = AnnotationState::Confirmed;
    first.camera_from_object = Pose::from_translation(glam::DVec3::new(1.0 / 3.0, 2.0, 471.125));
    scene
}

fn draft(scene: &Scene, roles: [Role; 2]) -> Draft {
    let mut draft = Draft::of_scene(scene, Study::new("demo", "Demo"));
    draft.chosen.iter_mut().zip(roles).for_each(|(chosen, role)| chosen.role = role);
    draft
}

#[test]
fn the_truth_is_in_its_own_file_and_nowhere_else() {
    let scene = scene();
    let pack = draft(&scene, [Role::Sample, Role::None]).pack(&scene).unwrap();
    assert_eq!(pack.truth.samples.len(), 1);
    let truth = &pack.truth.samples[0];
    assert_eq!(truth.pose.unwrap().translation_mm, [1.0 / 3.0, 2.0, 471.125]);
    // Of a right triangle with sides of 30 and 40.
    assert!((truth.diameter_mm - 50.0).abs() < 1e-4);
    let zip = Archive::open(pack.zip().unwrap().into());
    let mut zip = zip.unwrap();
    let paths: Vec<String> = zip.listing("study").unwrap().paths().map(str::to_owned).collect();
    assert_eq!(paths.len(), 3, "{paths:?}");
    for path in &paths {
        let content = String::from_utf8_lossy(&zip.read(path).unwrap()).into_owned();
        assert!(!content.contains("471.125") && !path.contains("truth"), "{path}");
    }
    assert_eq!(pack.truth.study_sha256, Sha256::of(&pack.files[0].1).to_string());
    assert_eq!(Truth::from_json(pack.truth.to_json().as_bytes()).unwrap(), pack.truth);
}

#[test]
fn a_study_comes_back_whole_and_a_changed_file_is_refused() {
    let scene = scene();
    let pack = draft(&scene, [Role::Sample, Role::Sample]).pack(&scene).unwrap();
    let files = StudyFiles::from_zip(pack.zip().unwrap().into()).unwrap();
    assert!(files.missing().is_empty() && files.study == pack.study);
    // Two objects of one mesh are one file.
    assert_eq!((files.study.objects.len(), files.study.assets().len()), (2, 2));
    let photo = &files.study.photos[0];
    assert_eq!((photo.asset.name.as_str(), photo.camera.width), ("table.png", 64));
    assert_eq!(photo.camera.to_intrinsics().unwrap(), scene.photos[0].camera);

    let mut json_only = StudyFiles::from_json(&pack.files[0].1).unwrap();
    let asset = json_only.missing().remove(0);
    let error = json_only.add(&asset, Arc::from(&b"other"[..])).unwrap_err();
    assert!(error.to_string().contains("another content"), "{error}");
}

#[test]
fn practice_needs_truth_and_is_no_sample() {
    let scene = scene();
    let untouched = draft(&scene, [Role::Sample, Role::Practice]).pack(&scene).unwrap_err();
    assert!(untouched.to_string().contains("true pose"), "{untouched}");
    let pack = draft(&scene, [Role::Practice, Role::Sample]).pack(&scene).unwrap();
    assert_eq!((pack.study.practice.len(), pack.study.samples.len()), (1, 1));

    let mut same = pack.study.clone();
    same.samples[0].object.clone_from(&same.practice[0].sample.object);
    let error = crate::study::check::usable(&same).unwrap_err();
    assert!(error.to_string().contains("one of the study's samples"), "{error}");
}

#[test]
fn the_check_says_what_is_missing() {
    let scene = scene();
    let nothing = draft(&scene, [Role::None; 2]);
    let pack = nothing.pack(&scene).unwrap();
    let findings = check(&nothing, &scene, Ok(&pack));
    assert!(findings[0].is_error && findings[0].text.contains("at least one"), "{findings:?}");
    let one = draft(&scene, [Role::Practice, Role::Sample]);
    let pack = one.pack(&scene).unwrap();
    let texts = |findings: Vec<Finding>| -> String {
        findings.iter().map(|finding| format!("{} {}\n", finding.is_error, finding.text)).collect()
    };
    let said = texts(check(&one, &scene, Ok(&pack)));
    assert!(said.lines().all(|line| line.starts_with("false")), "{said}");
    assert!(said.contains("One sample has no true pose"), "{said}");
    let failed = check(&one, &scene, Err(&StudyError::Pack("broken".to_owned())));
    assert!(failed[0].is_error && failed[0].text == "broken");
}

#[test]
fn what_is_written_by_hand_is_checked() {
    let scene = scene();
    let study = draft(&scene, [Role::Sample; 2]).pack(&scene).unwrap().study;
    let refused = |change: fn(&mut Study)| {
        let mut study = study.clone();
        change(&mut study);
        StudyFiles::from_json(study.to_json().as_bytes()).unwrap_err().to_string()
    };
    assert!(refused(|study| study.id = "a b".to_owned()).contains("letters"));
    assert!(refused(|study| study.schedule.repeats = 0).contains("trials"));
    assert!(refused(|study| study.schedule.repeats = u32::MAX).contains("trials"));
    assert!(refused(|study| study.samples[1].id = "S0".to_owned()).contains("comes twice"));
    assert!(refused(|study| study.photos[0].asset.path = "../x".to_owned()).contains("beside"));
    assert!(refused(|study| study.photos[0].asset.path = "https://x/y".to_owned()).contains("beside"));
    assert!(refused(|study| study.photos[0].camera.k[0][0] = 0.0).contains("focal"));
    assert!(refused(|study| study.start_pose = StartPose::Given).contains("start"));
    assert!(refused(|study| study.samples[0].set = Some("L".to_owned())).contains("sample set"));
    let later = study.to_json().replace("\"version\": 1", "\"version\": 2");
    assert!(StudyFiles::from_json(later.as_bytes()).unwrap_err().to_string().contains("reload the page"));
}
