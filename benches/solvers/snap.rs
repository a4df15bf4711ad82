//! Snap on photographs that were made for it, where the truth is exact: 14 cm objects at 0.8 m.
//!
//! The meshes are those of `linemod10`, made 14 cm large: none of them served for tuning.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use pinpose::math::{Intrinsics, Pose, rotation_vector_from_rotation};
use pinpose::mesh::{Mesh, load, no_companions};
use pinpose::metrics::PoseError;
use pinpose::scene::Symmetries;
use pinpose::solve::TwistCovariance;
use pinpose::solve::contour::ContourModel;
use pinpose::solve::snap::{Snap, SnapHints, SnapOptions, SnapReach, score_of};

use crate::chance::Chance;
use crate::numbers::{cpu_secs, mean, percent, quantile};
use crate::photos::photo;
use crate::real::{Run, data, disturbed, header, report};

const DISTANCE_MM: f64 = 800.0;
const DIAMETER_MM: f64 = 140.0;
/// Starts for each mesh; each with a photo of its own.
const ROUNDS: usize = 30;

struct Object {
    name: String,
    mesh: Arc<Mesh>,
    model: Arc<ContourModel>,
}

pub fn snap() {
    let objects = match objects() {
        Ok(objects) => objects,
        Err(reason) => return println!("Snap: left out, {reason}"),
    };
    println!("Snap on made photos: 14 cm at 0.8 m, {ROUNDS} starts each, seed 6; mm and degrees");
    header();
    let near = (10.0, 10.0, 0.04);
    snap_all("10°, 10 px, 4 %", &objects, near, SnapReach::Near);
    snap_all("20°, 20 px, 8 % (wide)", &objects, (20.0, 20.0, 0.08), SnapReach::Wide);
}

fn camera() -> Intrinsics {
    Intrinsics::pinhole(572.4114, 573.57043, 325.2611, 242.04899, 640, 480)
}

fn snap_all(name: &str, objects: &[Object], off: (f64, f64, f64), reach: SnapReach) {
    let mut chance = Chance(6);
    let mut runs = Vec::new();
    let mut deviations = Vec::new();
    for object in objects {
        for _ in 0..ROUNDS {
            let (run, deviation) = snap_one(&mut chance, object, off, reach);
            deviations.extend(deviation);
            runs.push(run);
        }
    }
    report(name, &runs);
    let depths: Vec<f64> = runs.iter().map(|run| run.depth_mm).collect();
    let found: Vec<f64> = depths.iter().copied().filter(|depth| depth.abs() < 20.0).collect();
    println!(
        "  below 5 mm: {:.1} %, below 2 mm: {:.1} %; mean dz {:.2} mm, without failures {:.2} mm; rotation p90 {:.2}°",
        percent(&runs, |run| run.after.add_mm < 5.0),
        percent(&runs, |run| run.after.add_mm < 2.0),
        mean(&depths),
        mean(&found),
        quantile(&runs.iter().map(|run| run.after.rotation_rad.to_degrees()).collect::<Vec<_>>(), 0.9),
    );
    print_coverage(&deviations);
}

/// How often the truth is within the standard deviations that a snap says: 68 and 95 % are wanted.
pub fn print_coverage(deviations: &[[f64; 6]]) {
    let within = |axes: &[usize], sigmas: f64| {
        let all: Vec<f64> =
            deviations.iter().flat_map(|found| axes.iter().map(|&axis| found[axis])).collect();
        percent(&all, |deviation| deviation.abs() < sigmas)
    };
    let part =
        |name: &str, axes: &[usize]| format!("{name} {:.0}/{:.0}", within(axes, 1.0), within(axes, 1.96));
    println!(
        "  truth within 1 and 1.96 standard deviations, in %: {}, {}, {}, {}, {}",
        part("all", &[0, 1, 2, 3, 4, 5]),
        part("depth", &[5]),
        part("lateral", &[3, 4]),
        part("tilt", &[0, 1]),
        part("roll", &[2]),
    );
}

fn snap_one(
    chance: &mut Chance,
    object: &Object,
    off: (f64, f64, f64),
    reach: SnapReach,
) -> (Run, Option<[f64; 6]>) {
    let center = object.model.center_mm();
    let place = DVec3::new(60.0 * chance.signed(), 60.0 * chance.signed(), DISTANCE_MM);
    let turned = chance.rotation();
    let truth = turned.translated(place - turned.transform_point(center));
    let photo = photo(chance, &camera(), &object.mesh, &truth);
    let start = disturbed(chance, &camera(), &truth, center, off);
    let options = SnapOptions { reach, ..SnapOptions::default() };
    let hints = SnapHints::default();
    let truth_score = score_of(&photo, &camera(), &object.model, &truth, &hints);
    let clock = cpu_secs();
    let outcome = Snap::with(&photo, &camera(), object.model.clone(), &start, hints, &options).run();
    let ms = (cpu_secs() - clock) * 1e3;
    let error = |pose| PoseError::between(pose, &truth, &object.mesh, &Symmetries::default(), 5000);
    let found = outcome.camera_from_object;
    let run = Run {
        object: object.name.clone(),
        before: error(&start),
        after: error(&found),
        depth_mm: found.transform_point(center).z - truth.transform_point(center).z,
        verdict: outcome.verdict,
        score_above_truth: outcome.score_after - truth_score.map_or(0.0, |score| score.total()),
        ms,
    };
    let deviation = outcome.covariance.map(|covariance| deviations(&covariance, &found, &truth, center));
    (run, deviation)
}

/// How far the truth is from an estimate, in standard deviations: turned about two axes across the view ray and about it, then
/// shifted along the same.
pub fn deviations(covariance: &TwistCovariance, found: &Pose, truth: &Pose, center_mm: DVec3) -> [f64; 6] {
    let place = found.transform_point(center_mm);
    let covariance = covariance.about(place);
    let ray = place.normalize();
    let (across, down) = ray.any_orthonormal_pair();
    let turned = rotation_vector_from_rotation(&(truth.rotation * found.rotation.transpose()));
    let moved = truth.transform_point(center_mm) - place;
    std::array::from_fn(|k| {
        let (first, error) = if k < 3 { (0, turned) } else { (3, moved) };
        let axis = [across, down, ray][k % 3];
        let along = |row: usize| {
            DVec3::from_array([0, 1, 2].map(|column: usize| covariance[first + row][first + column]))
                .dot(axis)
        };
        let variance = DVec3::new(along(0), along(1), along(2)).dot(axis);
        error.dot(axis) / variance.max(f64::MIN_POSITIVE).sqrt()
    })
}

fn objects() -> Result<Vec<Object>, String> {
    let folder = data().join("linemod10");
    let files = std::fs::read_dir(&folder).map_err(|_| "the data folder is not here")?;
    let mut paths: Vec<_> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "ply"));
    paths.sort();
    let object = |path: &std::path::PathBuf| {
        let bytes = std::fs::read(path).unwrap();
        let mesh = load(&path.display().to_string(), &bytes, &no_companions).unwrap().mesh;
        let scale = DIAMETER_MM / (2.0 * mesh.sphere().radius);
        let mesh = mesh.transformed(&DAffine3::from_scale(DVec3::splat(scale))).unwrap();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let model = ContourModel::new(&mesh).unwrap();
        Object { name, mesh: Arc::new(mesh), model: Arc::new(model) }
    };
    Ok(paths.iter().map(object).collect())
}
