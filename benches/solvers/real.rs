//! Snap on real photographs, from starts that are off by exactly 5° about a chance axis, 10 px in a chance direction and 3 %
//! of the distance.
//!
//! Numbers were tuned on the photos of `lmo16` with an even place in its `case.json`; the other half is for testing.
//! `linemod10` was meant for testing too, but its results were looked at while the method was changed, so it flatters.
//! Truth itself is off by some millimetres, mostly in depth. The other annotated objects occlude from their true poses, and
//! the visible part counts those alone: `lmo16` also has things in front that nobody annotated.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use pinpose::math::{Intrinsics, Pose, rotation_from_rotation_vector};
use pinpose::mesh::{Mesh, load, no_companions};
use pinpose::metrics::PoseError;
use pinpose::photo::{Pixels, decode};
use pinpose::raster::{PixelRegion, RasterItem, rasterize};
use pinpose::scene::Symmetries;
use pinpose::solve::contour::ContourModel;
use pinpose::solve::snap::{Snap, SnapHints, SnapVerdict, score_of};
use serde_json::Value;

use crate::chance::Chance;
use crate::numbers::{cpu_secs, median, percent, quantile};
use crate::snap::{deviations, print_coverage};

/// A median of fewer runs is chance by some millimetres.
const ROUNDS: usize = 8;
const SMALLEST_VISIBLE_PART: f64 = 0.6;

struct Object {
    name: String,
    mesh: Arc<Mesh>,
    model: Arc<ContourModel>,
    truth: Pose,
}

struct Frame {
    photo: Pixels,
    camera: Intrinsics,
    objects: Vec<Object>,
}

/// One snap, measured.
pub struct Run {
    pub object: String,
    pub before: PoseError,
    pub after: PoseError,
    /// Farther than the truth is positive.
    pub depth_mm: f64,
    pub verdict: SnapVerdict,
    /// How much better the photo agrees with what was found than with the truth.
    pub score_above_truth: f64,
    pub ms: f64,
}

/// A folder and which half of its frames; the first is for tuning.
const PARTS: [(&str, Option<usize>); 3] =
    [("lmo16 tuning half", Some(0)), ("lmo16 test half", Some(1)), ("linemod10", None)];

pub fn real() {
    println!(
        "Snap on real photos: start 5°, 10 px, 3 % of the distance off; {ROUNDS} starts each, seed 1; mm and degrees"
    );
    header();
    PARTS.iter().for_each(real_part);
}

fn real_part(&(name, half): &(&str, Option<usize>)) {
    let folder = name.split(' ').next().unwrap_or(name);
    match frames(folder, half) {
        Ok(frames) => {
            let (runs, deviations) = snap_all(&frames);
            report(name, &runs);
            print_coverage(&deviations);
            print_preferred(&runs);
        }
        Err(reason) => println!("{name}: left out, {reason}"),
    }
}

/// Where the error is: a pose that is off though the photo agrees more with it than with the truth was not missed by the search.
fn print_preferred(runs: &[Run]) {
    let off: Vec<&Run> =
        runs.iter().filter(|run| run.verdict == SnapVerdict::Improved && run.after.add_mm > 8.0).collect();
    println!(
        "  improved and still off by more than 8 mm: {:.0} %; of these the photo agrees more with what was found than with the truth: {:.0} %",
        100.0 * off.len() as f64 / runs.len() as f64,
        percent(&off, |run| run.score_above_truth > 0.0),
    );
}

pub fn header() {
    println!(
        "{:<24}{:>5}{:>9}{:>9}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>8}",
        "", "runs", "start", "ADD", "p90", "rot °", "dz", "|dz|", "worse", "refused", "ms"
    );
}

/// One row for all, then one for each object.
pub fn report(name: &str, runs: &[Run]) {
    row(name, &runs.iter().collect::<Vec<_>>());
    let mut objects: Vec<&str> = runs.iter().map(|run| run.object.as_str()).collect();
    objects.sort_unstable();
    objects.dedup();
    for object in objects.into_iter().filter(|_| runs.len() > 1) {
        row(&format!("  {object}"), &runs.iter().filter(|run| run.object == object).collect::<Vec<_>>());
    }
}

fn row(name: &str, runs: &[&Run]) {
    let of = |value: &dyn Fn(&Run) -> f64| runs.iter().map(|run| value(run)).collect::<Vec<f64>>();
    let add = of(&|run| run.after.add_mm);
    println!(
        "{name:<24}{:>5}{:>9.2}{:>9.2}{:>8.2}{:>8.2}{:>8.2}{:>8.2}{:>8.1}%{:>8.1}%{:>8.1}",
        runs.len(),
        median(&of(&|run| run.before.add_mm)),
        median(&add),
        quantile(&add, 0.9),
        median(&of(&|run| run.after.rotation_rad.to_degrees())),
        median(&of(&|run| run.depth_mm)),
        median(&of(&|run| run.depth_mm.abs())),
        percent(runs, |run| run.after.add_mm > run.before.add_mm + 2.0),
        percent(runs, |run| run.verdict != SnapVerdict::Improved),
        median(&of(&|run| run.ms)),
    );
}

/// A pose that is off by exactly this much in chance directions.
pub fn disturbed(
    chance: &mut Chance,
    camera: &Intrinsics,
    truth: &Pose,
    center_mm: DVec3,
    (turn_deg, shift_px, depth_part): (f64, f64, f64),
) -> Pose {
    let center = truth.transform_point(center_mm);
    let turn = rotation_from_rotation_vector(chance.direction() * turn_deg.to_radians());
    let pixel = camera.project(center).unwrap() + chance.direction_in_image() * shift_px;
    let place = camera.unproject(pixel) * (center.z * (1.0 + chance.sign() * depth_part));
    (Pose::rotation_about(center, turn) * *truth).translated(place - center)
}

fn snap_all(frames: &[Frame]) -> (Vec<Run>, Vec<[f64; 6]>) {
    let mut chance = Chance(1);
    let (mut runs, mut deviations) = (Vec::new(), Vec::new());
    for frame in frames {
        for (number, object) in frame.objects.iter().enumerate() {
            if visible_part(frame, number) < SMALLEST_VISIBLE_PART {
                continue;
            }
            for _ in 0..ROUNDS {
                let (run, deviation) = snap_one(&mut chance, frame, object);
                runs.push(run);
                deviations.extend(deviation);
            }
        }
    }
    (runs, deviations)
}

fn snap_one(chance: &mut Chance, frame: &Frame, object: &Object) -> (Run, Option<[f64; 6]>) {
    let center = object.model.center_mm();
    let start = disturbed(chance, &frame.camera, &object.truth, center, (5.0, 10.0, 0.03));
    let others = frame.objects.iter().filter(|other| other.name != object.name);
    let occluders = others.map(|other| (other.model.clone(), other.truth)).collect();
    let hints = SnapHints { occluders, ..SnapHints::default() };
    let truth_score = score_of(&frame.photo, &frame.camera, &object.model, &object.truth, &hints);
    let clock = cpu_secs();
    let outcome = Snap::new(&frame.photo, &frame.camera, object.model.clone(), &start, hints).run();
    let ms = (cpu_secs() - clock) * 1e3;
    let error = |pose: &Pose| {
        PoseError::between(pose, &object.truth, &object.mesh, &Symmetries::default(), usize::MAX)
    };
    let found = outcome.camera_from_object;
    let deviation =
        outcome.covariance.map(|covariance| deviations(&covariance, &found, &object.truth, center));
    let run = Run {
        object: object.name.clone(),
        before: error(&start),
        after: error(&found),
        depth_mm: found.transform_point(center).z - object.truth.transform_point(center).z,
        verdict: outcome.verdict,
        score_above_truth: outcome.score_after - truth_score.map_or(0.0, |score| score.total()),
        ms,
    };
    (run, deviation)
}

pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data")
}

fn visible_part(frame: &Frame, number: usize) -> f64 {
    let item = |(id, object): (u32, &Object)| (id, object.mesh.clone(), object.truth);
    let all: Vec<_> = (1..).zip(&frame.objects).map(item).collect();
    let count = |drawn: &[(u32, Arc<Mesh>, Pose)]| {
        let items: Vec<RasterItem<'_>> = drawn
            .iter()
            .map(|(id, mesh, pose)| RasterItem { mesh, camera_from_object: *pose, id: *id })
            .collect();
        let image = rasterize(&frame.camera, &items, PixelRegion::of_camera(&frame.camera));
        image.mask(number as u32 + 1).count() as f64
    };
    count(&all) / count(&all[number..=number])
}

/// The frames of a data folder; of one half, if that is asked for.
fn frames(folder: &str, half: Option<usize>) -> Result<Vec<Frame>, String> {
    let folder = data().join(folder);
    let text =
        std::fs::read_to_string(folder.join("case.json")).map_err(|_| "the data folder is not here")?;
    let case: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let k: [[f64; 3]; 3] = serde_json::from_value(case["K"].clone()).map_err(|error| error.to_string())?;
    let mut meshes: Vec<(PathBuf, Arc<Mesh>, Arc<ContourModel>)> = Vec::new();
    let mut frames = Vec::new();
    for (place, frame) in case["frames"].as_array().into_iter().flatten().enumerate() {
        if half.is_some_and(|half| place % 2 != half) {
            continue;
        }
        let bytes =
            std::fs::read(folder.join(frame["image"].as_str().unwrap())).map_err(|e| e.to_string())?;
        let photo = decode(&bytes).map_err(|error| error.to_string())?.pixels;
        let camera =
            Intrinsics::from_k_rows(&k, photo.width, photo.height).map_err(|error| error.to_string())?;
        let objects = frame["objects"].as_array().into_iter().flatten();
        let objects = objects.map(|object| read_object(&folder, object, &mut meshes)).collect();
        frames.push(Frame { photo, camera, objects });
    }
    Ok(frames)
}

fn read_object(
    folder: &Path,
    object: &Value,
    meshes: &mut Vec<(PathBuf, Arc<Mesh>, Arc<ContourModel>)>,
) -> Object {
    let path = folder.join(object["mesh"].as_str().unwrap());
    if !meshes.iter().any(|(known, ..)| *known == path) {
        let bytes = std::fs::read(&path).unwrap();
        let mesh = load(&path.display().to_string(), &bytes, &no_companions).unwrap().mesh;
        let model = ContourModel::new(&mesh).unwrap();
        meshes.push((path.clone(), Arc::new(mesh), Arc::new(model)));
    }
    let (_, mesh, model) = meshes.iter().find(|(known, ..)| *known == path).unwrap();
    let rows: [[f64; 4]; 4] = serde_json::from_value(object["T_m2c"].clone()).unwrap();
    let (truth, _) = Pose::from_rows(&rows).unwrap();
    let name = path.file_stem().unwrap().to_string_lossy().into_owned();
    Object { name, mesh: mesh.clone(), model: model.clone(), truth }
}
