//! Pins: the error of the pose by the number of pins and the noise of the clicks, against OpenCV on the same numbers.

use std::time::Instant;

use glam::{DVec2, DVec3};
use pinpose::math::{Intrinsics, Pose};
use pinpose::solve::pins::{Pin, PinOptions, solve_pins};
use serde_json::{Value, json};

use crate::chance::Chance;
use crate::numbers::{mean, median, quantile};
use crate::opencv;

const PIN_COUNTS: [usize; 5] = [4, 5, 6, 8, 12];
const ROUNDS: usize = 2000;
const DISTANCE_MM: f64 = 850.0;

struct Problem {
    truth: Pose,
    pins: Vec<Pin>,
}

/// One row of the table.
struct Case {
    is_planar: bool,
    sigma_px: f64,
    pin_count: usize,
    problems: Vec<Problem>,
}

fn camera() -> Intrinsics {
    Intrinsics::pinhole(572.4114, 573.57043, 325.2611, 242.04899, 640, 480)
}

/// A point on an ellipsoid of 160 × 120 × 100 mm, or in a disc of 160 mm.
fn surface_point(chance: &mut Chance, is_planar: bool) -> DVec3 {
    if is_planar {
        let radius = 80.0 * chance.unit().sqrt();
        (chance.direction_in_image() * radius).extend(0.0)
    } else {
        chance.direction() * DVec3::new(80.0, 60.0, 50.0)
    }
}

fn problem(chance: &mut Chance, is_planar: bool, sigma_px: f64, pin_count: usize) -> Problem {
    let place = DVec3::new(60.0 * chance.signed(), 60.0 * chance.signed(), DISTANCE_MM);
    let truth = chance.rotation().translated(place);
    let pins = (0..pin_count)
        .map(|_| {
            let point = surface_point(chance, is_planar);
            let noise = DVec2::new(chance.normal(), chance.normal()) * sigma_px;
            Pin::new(point, camera().project(truth.transform_point(point)).unwrap() + noise)
        })
        .collect();
    Problem { truth, pins }
}

fn cases() -> Vec<Case> {
    let mut chance = Chance(1);
    let mut cases = Vec::new();
    for is_planar in [false, true] {
        for sigma_px in [1.0, 2.0] {
            for pin_count in PIN_COUNTS {
                let problems =
                    (0..ROUNDS).map(|_| problem(&mut chance, is_planar, sigma_px, pin_count)).collect();
                cases.push(Case { is_planar, sigma_px, pin_count, problems });
            }
        }
    }
    cases
}

/// The mean distance of points on the object's surface.
fn add_mm(estimate: &Pose, truth: &Pose, is_planar: bool) -> f64 {
    let mut chance = Chance(7);
    let distances: Vec<f64> = (0..100)
        .map(|_| surface_point(&mut chance, is_planar))
        .map(|point| estimate.transform_point(point).distance(truth.transform_point(point)))
        .collect();
    mean(&distances)
}

pub fn pins() {
    let cases = cases();
    println!(
        "Pins: 16 cm at 0.85 m, {ROUNDS} sets a row; median ADD in mm (90th percentile), time per solve"
    );
    let anchors = match opencv::solve(&to_json(&cases)) {
        Ok(answer) => {
            println!(
                "against OpenCV {} (SQPNP + solvePnPRefineLM)",
                answer["version"].as_str().unwrap_or("?")
            );
            Some(answer)
        }
        Err(reason) => {
            println!("without OpenCV: {reason}");
            None
        }
    };
    println!(
        "{:<10}{:>5}{:>5}{:>9}{:>10}{:>10}{:>10}{:>8}{:>9}{:>9}{:>7}{:>9}",
        "points", "σ px", "n", "ours", "p90", "OpenCV", "p90", "ratio", "µs", "µs", "ratio", "accused"
    );
    let mut first = 0;
    for case in &cases {
        let answers = anchors.as_ref().and_then(|all| all["answers"].as_array());
        print_row(case, answers.and_then(|all| all.get(first..first + case.problems.len())));
        first += case.problems.len();
    }
}

fn print_row(case: &Case, anchors: Option<&[Value]>) {
    let options = PinOptions { click_sigma_px: 1.5, ..PinOptions::default() };
    let mut errors = Vec::new();
    let mut accused = 0;
    let mut micros = Vec::new();
    for problem in &case.problems {
        let start = Instant::now();
        let solution = solve_pins(&camera(), &problem.pins, None, &options);
        micros.push(start.elapsed().as_secs_f64() * 1e6);
        let Ok(solution) = solution else {
            errors.push(f64::INFINITY);
            continue;
        };
        accused += usize::from(!solution.misclicks.is_empty());
        errors.push(add_mm(&solution.camera_from_object, &problem.truth, case.is_planar));
    }
    let kind = if case.is_planar { "planar" } else { "general" };
    let (ours, micros) = (median(&errors), mean(&micros));
    print!("{kind:<10}{:>5}{:>5}{ours:>9.2}{:>10.2}", case.sigma_px, case.pin_count, quantile(&errors, 0.9));
    match anchors {
        Some(anchors) => {
            let theirs: Vec<f64> = anchors
                .iter()
                .zip(&case.problems)
                .map(|(answer, problem)| {
                    pose_of(&answer["pose"])
                        .map_or(f64::INFINITY, |pose| add_mm(&pose, &problem.truth, case.is_planar))
                })
                .collect();
            let their_micros =
                mean(&anchors.iter().filter_map(|answer| answer["seconds"].as_f64()).collect::<Vec<_>>())
                    * 1e6;
            let their_median = median(&theirs);
            print!("{their_median:>10.2}{:>10.2}{:>8.3}", quantile(&theirs, 0.9), ours / their_median);
            print!("{micros:>9.0}{their_micros:>9.0}{:>7.2}", micros / their_micros);
        }
        None => print!("{:>10}{:>10}{:>8}{micros:>9.0}{:>9}{:>7}", "-", "-", "-", "-", "-"),
    }
    println!("{:>8.1}%", 100.0 * accused as f64 / case.problems.len() as f64);
}

fn pose_of(rows: &Value) -> Option<Pose> {
    let rows: [[f64; 4]; 4] = serde_json::from_value(rows.clone()).ok()?;
    Pose::from_rows(&rows).ok().map(|(pose, _)| pose)
}

fn to_json(cases: &[Case]) -> Value {
    let problems: Vec<Value> = cases
        .iter()
        .flat_map(|case| &case.problems)
        .map(|problem| {
            json!({
                "points": problem.pins.iter().map(|pin| pin.point_mm.to_array()).collect::<Vec<_>>(),
                "pixels": problem.pins.iter().map(|pin| pin.pixel.to_array()).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({"K": camera().k_rows(), "problems": problems})
}
