//! Simulated participants obey the study, replay, and are about as exact as people.

use glam::DVec3;

use super::*;
use crate::mesh::test_shapes;
use crate::study::{
    Asset, CameraRecord, Item, ItemKind, Questionnaire, QuestionnaireKind, QuestionnaireTime, Sample,
    StudyObject, StudyPhoto, SymmetriesRecord, TruthSample,
};

fn asset(name: &str) -> Asset {
    Asset { name: name.to_owned(), path: format!("assets/{name}"), sha256: "0".repeat(64), bytes: 1 }
}

/// Ten samples of one cube in one photo, a metre away.
fn study() -> (Study, Truth, BTreeMap<String, Arc<Mesh>>) {
    let mut study = Study::new("test", "Test");
    let k = [[500.0, 0.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]];
    let camera = CameraRecord { k, distortion: None, width: 640, height: 480 };
    study.photos = vec![StudyPhoto { id: "photo".to_owned(), asset: asset("a.png"), camera }];
    let identity = crate::math::Pose::IDENTITY.to_rows();
    study.objects = vec![StudyObject {
        id: "cube".to_owned(),
        name: "cube".to_owned(),
        mesh: asset("cube.ply"),
        companions: Vec::new(),
        mesh_from_file: identity,
        color: None,
    }];
    let answer = ItemKind::Choice { options: vec!["none".to_owned(), "some".to_owned()], several: false };
    let text = "Have you posed objects before?".to_owned();
    study.items_before = vec![Item { id: "expertise".to_owned(), text, optional: false, answer }];
    for (id, kind) in
        [("tlx", QuestionnaireKind::NasaTlx { weighted: true }), ("sus", QuestionnaireKind::Sus)]
    {
        study.questionnaires.push(Questionnaire { id: id.to_owned(), when: QuestionnaireTime::End, kind });
    }
    let mut samples = Vec::new();
    for index in 0..10 {
        let (id, photo, object) = (format!("S{index}"), "photo".to_owned(), "cube".to_owned());
        study.samples.push(Sample { id: id.clone(), photo, object, set: None, start: None });
        let pose = crate::math::Pose::exp(DVec3::splat(0.1 * f64::from(index)), DVec3::ZERO);
        samples.push(TruthSample {
            id,
            set: None,
            pose: Some(Pose { translation_mm: DVec3::Z * 1000.0, ..pose }.into()),
            photo: "a.png".to_owned(),
            photo_sha256: "0".repeat(64),
            camera,
            object: "cube".to_owned(),
            mesh_sha256: "0".repeat(64),
            mesh_from_file: identity,
            symmetries: SymmetriesRecord::default(),
            diameter_mm: 12.0_f64.sqrt(),
        });
    }
    let meshes = BTreeMap::from([("cube".to_owned(), Arc::new(test_shapes::cube()))]);
    let truth = Truth::new("test", &"0".repeat(64), samples);
    (study, truth, meshes)
}

#[test]
fn they_do_what_the_study_asks_and_replay() {
    let (study, truth, meshes) = study();
    let simulation = Simulation { participants: 3, seed: 5, began_ms: 1.7e12 };
    let results = simulate(&study, "0", &truth, &meshes, simulation).unwrap();
    assert_eq!(results, simulate(&study, "0", &truth, &meshes, simulation).unwrap());
    let other = simulate(&study, "0", &truth, &meshes, Simulation { seed: 6, ..simulation }).unwrap();
    assert_ne!(results[0].trials[0].final_pose, other[0].trials[0].final_pose);
    for one in &results {
        assert!(one.is_simulated && one.finished_at.is_some());
        assert_eq!((one.trials.len(), one.questionnaires.len(), one.items_before.len()), (30, 2, 1));
        assert_eq!(one.questionnaires[0].pairs.len(), 15);
        for (index, trial) in one.trials.iter().enumerate() {
            assert_eq!((trial.index as usize, trial.repeat as usize), (index, index / 10));
            // Sums of milliseconds in f64.
            assert!((trial.active_s + trial.idle_s - trial.time_s).abs() < 1e-9 && trial.time_s > 5.0);
            assert_eq!(trial.events.last().map(|event| event.kind), Some(EventKind::Confirmed));
        }
        let text = one.to_json();
        assert_eq!(&Results::from_json(text.as_bytes()).unwrap(), one);
    }
}

#[test]
fn they_are_about_as_exact_and_as_fast_as_people() {
    let (mut study, truth, meshes) = study();
    study.conditions[0]
        .tools
        .retain(|tool| !matches!(tool, crate::study::Tool::Snap | crate::study::Tool::Pins));
    let simulation = Simulation { participants: 40, seed: 1, began_ms: 1.7e12 };
    let results = simulate(&study, "0", &truth, &meshes, simulation).unwrap();
    let (mut turned, mut moved, mut seconds, mut count) = (0.0, 0.0, 0.0, 0.0);
    for trial in results.iter().flat_map(|one| &one.trials) {
        let truth = truth.sample(&trial.sample).unwrap().pose.unwrap().to_pose().unwrap();
        let pose = trial.final_pose.to_pose().unwrap();
        turned += pose.angle_to(&truth).to_degrees();
        moved += pose.translation_mm.distance(truth.translation_mm);
        seconds += trial.time_s;
        count += 1.0;
    }
    // Half and twice the paper's 4.77 degrees, 14.91 mm and 102 s: a rehearsal needs the scale, not the value.
    for (found, paper) in [(turned, 4.77), (moved, 14.91), (seconds, 102.19)] {
        assert!((0.5..2.0).contains(&(found / count / paper)), "{} {paper}", found / count);
    }
}

#[test]
fn a_limit_ends_trials_and_a_missing_truth_is_said() {
    let (mut study, truth, meshes) = study();
    study.limits.trial_seconds = Some(60.0);
    let simulation = Simulation { participants: 2, seed: 1, began_ms: 0.0 };
    let results = simulate(&study, "0", &truth, &meshes, simulation).unwrap();
    let trials = || results.iter().flat_map(|one| &one.trials);
    assert!(trials().all(|trial| trial.time_s <= 60.0));
    assert!(trials().any(|trial| trial.outcome == Outcome::TimedOut));
    let nothing = Truth::new("test", "0", Vec::new());
    let error = simulate(&study, "0", &nothing, &meshes, simulation).unwrap_err().to_string();
    assert!(error.contains("it has no truth"), "{error}");
}
