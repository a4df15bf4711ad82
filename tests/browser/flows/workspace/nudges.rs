//! Every nudge key, by itself, ten times coarser and ten times finer, measured with arithmetic of our own.

use anyhow::{Context as _, ensure};

use super::{BALL_RADIUS_MM, BETWEEN_BURSTS, pose_of, start_with_shapes, translation, undo};
use crate::api::Matrix;
use crate::context::Context;
use crate::data::{CAMERA, ball_ply};
use crate::input::Modifier;
use crate::poses::{
    Vector, axis_angle_between, distance, norm, projected, rotated_back, rotation, transformed,
};

/// What a key does at factor 1.
#[derive(Clone, Copy)]
enum Step {
    /// Pixels of the photo.
    Side(f64, f64),
    /// Pixels of the silhouette's width.
    Depth(f64),
    /// About an axis of the camera, in degrees.
    Turn(Vector),
}

const KEYS: [(&str, Step); 12] = [
    ("ArrowLeft", Step::Side(-1.0, 0.0)),
    ("ArrowRight", Step::Side(1.0, 0.0)),
    ("ArrowUp", Step::Side(0.0, -1.0)),
    ("ArrowDown", Step::Side(0.0, 1.0)),
    ("]", Step::Depth(1.0)),
    ("[", Step::Depth(-1.0)),
    ("w", Step::Turn([-1.0, 0.0, 0.0])),
    ("s", Step::Turn([1.0, 0.0, 0.0])),
    ("a", Step::Turn([0.0, 1.0, 0.0])),
    ("d", Step::Turn([0.0, -1.0, 0.0])),
    ("q", Step::Turn([0.0, 0.0, -1.0])),
    ("e", Step::Turn([0.0, 0.0, 1.0])),
];

/// `f64`s throughout, numbers below 1e3.
const EXACT: f64 = 1e-6;

pub fn nudges(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    let sphere = sphere()?;
    let mut worst: f64 = 0.0;
    for (key, step) in KEYS {
        for (factor, modifiers) in
            [(1.0, &[][..]), (10.0, &[Modifier::Shift][..]), (0.1, &[Modifier::Alt][..])]
        {
            let before = pose_of(page, shapes.ball)?;
            page.key(key, modifiers)?;
            let after = pose_of(page, shapes.ball)?;
            let miss = miss(step, factor, &before, &after, &sphere);
            worst = worst.max(miss);
            ensure!(miss < EXACT, "{key} by {factor} is {miss:.1e} off: {before:?} became {after:?}");
        }
    }
    println!("   12 keys, 3 factors: at most {worst:.1e} px, mm or degrees off");

    // In the object's axes.
    page.key("l", &[])?;
    let before = pose_of(page, shapes.ball)?;
    page.key("ArrowRight", &[Modifier::Shift])?;
    let moved = pose_of(page, shapes.ball)?;
    let way: Vector = [0, 1, 2].map(|axis| translation(&moved)[axis] - translation(&before)[axis]);
    let [x, y, z] = rotated_back(&rotation(&before), way);
    ensure!(x > 1.0 && y.hypot(z) < EXACT, "In the object's axes ArrowRight goes along {:?}", [x, y, z]);
    page.key("e", &[])?;
    let turned = pose_of(page, shapes.ball)?;
    let axis = rotated_back(&rotation(&moved), axis_angle_between(&rotation(&moved), &rotation(&turned)));
    let degrees = axis.map(f64::to_degrees);
    ensure!(distance(degrees, [0.0, 0.0, 1.0]) < EXACT, "In the object's axes E turns about {degrees:?}");
    page.key("l", &[])?;

    // A burst is one step of undo.
    std::thread::sleep(BETWEEN_BURSTS);
    let before = pose_of(page, shapes.ball)?;
    page.keys("ArrowRight", 5, &[])?;
    let after = pose_of(page, shapes.ball)?;
    let miss = miss(Step::Side(5.0, 0.0), 1.0, &before, &after, &sphere);
    ensure!(miss < EXACT, "Five nudges are {miss} off");
    undo(page)?;
    ensure!(pose_of(page, shapes.ball)? == before, "Undo did not take back the whole burst");
    Ok(())
}

struct Sphere {
    center: Vector,
    radius: f64,
}

/// The ball's bounding sphere, as the program has it.
fn sphere() -> anyhow::Result<Sphere> {
    let file = ball_ply("ball.ply", BALL_RADIUS_MM, 24, 12);
    let loaded = pinpose::mesh::load(&file.name, &file.bytes, &pinpose::mesh::no_companions)
        .context("The ball was not read")?;
    let sphere = loaded.mesh.sphere();
    Ok(Sphere { center: sphere.center.to_array(), radius: sphere.radius })
}

/// By how much a step misses what it should do, in pixels, millimetres or degrees, whichever is worst.
fn miss(step: Step, factor: f64, before: &Matrix, after: &Matrix, sphere: &Sphere) -> f64 {
    let (center_before, center_after) =
        (transformed(before, sphere.center), transformed(after, sphere.center));
    let (seen_before, seen_after) =
        (projected(&CAMERA, before, sphere.center), projected(&CAMERA, after, sphere.center));
    let way_px = (seen_after.0 - seen_before.0, seen_after.1 - seen_before.1);
    let turned = axis_angle_between(&rotation(before), &rotation(after)).map(f64::to_degrees);
    match step {
        Step::Side(u, v) => {
            let off_px = (way_px.0 - u * factor).hypot(way_px.1 - v * factor);
            off_px.max((center_after[2] - center_before[2]).abs()).max(norm(turned))
        }
        Step::Depth(wider) => {
            let focal_px = (CAMERA[0][0] * CAMERA[1][1]).sqrt();
            let width = |center: Vector| 2.0 * focal_px * sphere.radius / center[2];
            let off_px = width(center_after) - width(center_before) - wider * factor;
            off_px.abs().max(way_px.0.hypot(way_px.1)).max(norm(turned))
        }
        Step::Turn(axis) => {
            distance(turned, axis.map(|value| value * factor)).max(distance(center_before, center_after))
        }
    }
}
