//! A small study with known errors: its truth, its meshes and the results of eleven people.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;
use pinpose::math::{Intrinsics, Pose};
use pinpose::scene::Sha256;
use pinpose::study::{
    Answer, AnswerValue, Environment, FileRecord, Outcome, PairChoice, Participant, PoseRecord,
    QuestionnaireResult, Results, StudyRecord, SymmetriesRecord, TrialResult, Truth, TruthSample, rfc3339,
};

use crate::support::{Noise, empty_folder};

/// What people are like in a study.
pub struct Recipe {
    /// The sets, with how many people each.
    pub sets: Vec<(&'static str, usize)>,
    pub samples_per_set: usize,
    /// The seconds of each of a person's trials, by the person's number; `None`: by chance.
    pub seconds: Option<Vec<f64>>,
}

/// A box that looks the same after half a turn about z, and a lump that does not.
fn meshes() -> [(&'static str, String, SymmetriesRecord); 2] {
    let mut noise = Noise(77);
    let mut lump = String::new();
    // Quarters of millimetres are exact in the 32 bits of a vertex.
    for _ in 0..60 {
        let [x, y, z] = (noise.vector() * 240.0).round().to_array().map(|value| value / 4.0);
        lump += &format!("v {x} {y} {z}\n");
    }
    (1..=58).for_each(|at| lump += &format!("f {at} {} {}\n", at + 1, at + 2));
    let mut cuboid = String::new();
    for corner in 0..8 {
        let side = |bit: u32, half: i32| if corner & bit == 0 { -half } else { half };
        cuboid += &format!("v {} {} {}\n", side(1, 40), side(2, 30), side(4, 20));
    }
    for face in ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"] {
        cuboid += &format!("f {face}\n");
    }
    let rotation = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    let half_turn = PoseRecord { rotation, translation_mm: [0.0; 3] };
    let symmetric = SymmetriesRecord { discrete: vec![half_turn], continuous: Vec::new() };
    [("lump", lump, SymmetriesRecord::default()), ("box", cuboid, symmetric)]
}

/// Writes `truth.json`, `assets/` and `results/` into a folder of this name.
pub fn write_study(name: &str, recipe: &Recipe) -> PathBuf {
    let folder = empty_folder(name);
    for part in ["assets", "results"] {
        std::fs::create_dir_all(folder.join(part)).unwrap();
    }
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let truth = write_truth(&folder, recipe, &mut noise);
    let mut number = 0;
    for (set, people) in &recipe.sets {
        for _ in 0..*people {
            let results = results_of(&truth, set, number, recipe, &mut noise);
            let path = folder.join(format!("results/{}.json", results.participant.id));
            std::fs::write(path, results.to_json()).unwrap();
            number += 1;
        }
    }
    folder
}

fn write_truth(folder: &Path, recipe: &Recipe, noise: &mut Noise) -> Truth {
    let meshes = meshes();
    for (name, text, _) in &meshes {
        std::fs::write(folder.join(format!("assets/{name}.obj")), text).unwrap();
    }
    let camera = Intrinsics::pinhole(500.0, 510.0, 320.0, 240.0, 640, 480).into();
    let mut samples = Vec::new();
    for (set, _) in &recipe.sets {
        for place in 0..recipe.samples_per_set {
            let (name, text, symmetries) = &meshes[place % 2];
            let pose = Pose::exp(noise.vector() * 2.0, DVec3::ZERO);
            let pose =
                Pose { translation_mm: noise.vector() * 80.0 + DVec3::Z * 900.0, ..pose }.renormalized();
            samples.push(TruthSample {
                id: format!("{set}{place}"),
                set: Some((*set).to_owned()),
                pose: Some(pose.into()),
                photo: format!("{place}.png"),
                photo_sha256: "0".repeat(64),
                camera,
                object: (*name).to_owned(),
                mesh_sha256: Sha256::of(text.as_bytes()).to_string(),
                mesh_from_file: Pose::IDENTITY.to_rows(),
                symmetries: symmetries.clone(),
                diameter_mm: 100.0,
            });
        }
    }
    let truth = Truth::new("constructed", &"1".repeat(64), samples);
    std::fs::write(folder.join("truth.json"), truth.to_json()).unwrap();
    truth
}

/// Three repeats of each sample of a set, under one of two conditions, and the questionnaires.
fn results_of(truth: &Truth, set: &str, number: usize, recipe: &Recipe, noise: &mut Noise) -> Results {
    let record = StudyRecord {
        id: "constructed".to_owned(),
        title: "A constructed study".to_owned(),
        sha256: "1".repeat(64),
    };
    let participant = Participant { id: format!("person{number:02}"), recruiter: BTreeMap::new() };
    let started_at = rfc3339(1.7e12 + 1e6 * number as f64);
    let mut results = Results::new(record, participant, Environment::default(), 1, started_at.clone());
    results.finished_at = Some(started_at.clone());
    let condition = ["by-hand", "with-snap"][number % 2];
    results.conditions = vec![condition.to_owned()];
    let expertise = ["none", "expert"][number % 3 % 2];
    let answer = Some(AnswerValue::Text(expertise.to_owned()));
    results.items_before = vec![Answer { item: "expertise".to_owned(), value: answer }];
    for repeat in 0..3 {
        for sample in truth.samples.iter().filter(|sample| sample.set.as_deref() == Some(set)) {
            let index = results.trials.len() as u32;
            let mut trial = trial_of(sample, index, repeat, condition, noise);
            if let Some(seconds) = &recipe.seconds {
                trial.time_s = seconds[number];
            }
            results.trials.push(trial);
        }
    }
    results.questionnaires = questionnaires(number, &started_at, noise);
    results
}

fn trial_of(
    sample: &TruthSample,
    index: u32,
    repeat: u32,
    condition: &str,
    noise: &mut Noise,
) -> TrialResult {
    let truth = sample.pose.unwrap().to_pose().unwrap();
    // Every third pose of a symmetric object is its twin's.
    let twin = match sample.symmetries.discrete.first() {
        Some(symmetry) if index.is_multiple_of(3) => symmetry.to_pose().unwrap(),
        _ => Pose::IDENTITY,
    };
    let turned = truth * twin * Pose::exp(noise.vector() * 0.15, DVec3::ZERO);
    let pose = turned.translated(noise.vector() * DVec3::new(4.0, 4.0, 25.0)).renormalized();
    let file = |name: &str| FileRecord { id: name.to_owned(), name: name.to_owned(), sha256: "0".repeat(64) };
    TrialResult {
        index,
        sample: sample.id.clone(),
        set: sample.set.clone(),
        repeat,
        condition: condition.to_owned(),
        tools: Vec::new(),
        photo: file(&sample.photo),
        object: file(&sample.object),
        start_pose: Pose::from_translation(DVec3::Z * 1000.0).into(),
        final_pose: pose.into(),
        outcome: Outcome::Confirmed,
        shown_at: rfc3339(1.7e12),
        confirmed_at: rfc3339(1.7e12),
        time_s: 90.0 + 60.0 * noise.next(),
        active_s: 0.0,
        idle_s: 0.0,
        paused_s: 0.0,
        hidden_s: 0.0,
        closed_s: 0.0,
        gestures: BTreeMap::new(),
        events: Vec::new(),
    }
}

const SCALES: [&str; 6] = ["mental", "physical", "temporal", "performance", "effort", "frustration"];

/// NASA-TLX with its comparisons, and SUS, of which one person leaves an item out.
fn questionnaires(number: usize, at: &str, noise: &mut Noise) -> Vec<QuestionnaireResult> {
    let answer = |item: String, value: Option<f64>| Answer { item, value: value.map(AnswerValue::Number) };
    let result = |kind: &str, answers: Vec<Answer>, pairs: Vec<PairChoice>| QuestionnaireResult {
        id: kind.to_owned(),
        kind: kind.to_owned(),
        condition: None,
        answers,
        pairs,
        scores: BTreeMap::new(),
        answered_at: at.to_owned(),
    };
    let tlx = SCALES.map(|scale| answer(scale.to_owned(), Some(noise.whole(0, 20)))).to_vec();
    let mut pairs = Vec::new();
    for (place, left) in SCALES.iter().enumerate() {
        for right in &SCALES[place + 1..] {
            let chosen = if noise.next() < 0.0 { left } else { right };
            let [left, right, chosen] = [left, right, chosen].map(|scale| (*scale).to_owned());
            pairs.push(PairChoice { left, right, chosen });
        }
    }
    let left_out = |item: usize| number == 4 && item == 7;
    let sus = (1..=10).map(|item| {
        let given = noise.whole(1, 5);
        answer(format!("sus{item}"), (!left_out(item)).then_some(given))
    });
    let sus = sus.collect();
    vec![result("nasa_tlx", tlx, pairs), result("sus", sus, Vec::new())]
}
