//! The handles over the selected object, in both views.

use std::f64::consts::FRAC_1_SQRT_2;

use anyhow::ensure;

use super::{middle_of, place_of, pose_of, raw_state, rect_of, start_with_shapes, translation, undo};
use crate::api::Matrix;
use crate::context::Context;
use crate::data::CAMERA;
use crate::input::{Button, Point};
use crate::page::Page;
use crate::poses::{axis_angle_between, distance, distance_px, norm, projected, rotation};

/// The radii of the rings, in points.
const TURN_RING: f64 = 82.0;
const ROLL_RING: f64 = 100.0;

pub fn handles(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    let start = pose_of(page, shapes.ball)?;
    page.key("g", &[])?;
    let pivot = place_of(page, shapes.ball, [0.0; 3])?;
    let zoom = page.state()?.viewport.zoom;

    let moved = dragged(page, shapes.ball, (pivot.0 + 45.0, pivot.1), (pivot.0 + 85.0, pivot.1))?;
    let [x, y, z] = [0, 1, 2].map(|axis| translation(&moved)[axis] - translation(&start)[axis]);
    let way_px = projected(&CAMERA, &moved, [0.0; 3]).0 - projected(&CAMERA, &start, [0.0; 3]).0;
    println!("   the x arrow by 40 points: {x:.2} mm, {way_px:.2} px at zoom {zoom:.2}");
    ensure!(y.hypot(z) < 1e-9 && x > 0.0, "The x arrow moved by {:?}", [x, y, z]);
    ensure!((way_px - 40.0 / zoom).abs() < 1.0, "The x arrow moved by {way_px} px at zoom {zoom}");

    let turned = around(page, shapes.ball, pivot, TURN_RING, 205.0, 235.0)?;
    check_turn("the z ring", &start, &turned, None)?;
    let rolled = around(page, shapes.ball, pivot, ROLL_RING, 20.0, 50.0)?;
    check_turn("the roll ring", &start, &rolled, None)?;

    let knob = (pivot.0 + ROLL_RING * FRAC_1_SQRT_2, pivot.1 - ROLL_RING * FRAC_1_SQRT_2);
    let nearer = dragged(page, shapes.ball, knob, (knob.0, knob.1 - 20.0))?;
    let way_mm = translation(&nearer)[2] - translation(&start)[2];
    let (seen, was) = (projected(&CAMERA, &nearer, [0.0; 3]), projected(&CAMERA, &start, [0.0; 3]));
    println!("   the knob by 20 points: {way_mm:.2} mm in depth");
    ensure!(way_mm.abs() > 0.5 && distance_px(seen, was) < 1e-6, "The knob moved {was:?} to {seen:?}");

    // The same in the scene view, about another view ray.
    page.key("v", &[])?;
    page.wait_for_state("state.arrangement === 'scene'", crate::api::PATIENCE)?;
    let rect = rect_of(&raw_state(page)?, "sceneViewport")?;
    let middle = middle_of(page, rect, shapes.ball)?;
    let rolled = around(page, shapes.ball, middle, ROLL_RING, 20.0, 50.0)?;
    check_turn("the roll ring in the scene view", &start, &rolled, Some(0.05))?;

    // Without handles the same drag is one on the ground.
    page.key("v", &[])?;
    page.key("v", &[])?;
    page.key("g", &[])?;
    page.drag((pivot.0 + 45.0, pivot.1), (pivot.0 + 46.0, pivot.1 + 60.0), Button::Left, 2, &[])?;
    page.key("0", &[])?;
    ensure!(pose_of(page, shapes.ball)? == start, "A handle that is not there was dragged");
    Ok(())
}

/// The pose that a drag leads to; it is undone again.
fn dragged(page: &mut Page, object: u32, from: Point, to: Point) -> anyhow::Result<Matrix> {
    let before = pose_of(page, object)?;
    page.drag(from, to, Button::Left, 3, &[])?;
    let pose = pose_of(page, object)?;
    ensure!(pose != before, "A drag from {from:?} to {to:?} did nothing");
    undo(page)?;
    ensure!(pose_of(page, object)? == before, "Undo did not bring the pose before the drag back");
    Ok(pose)
}

/// Along a ring, from one angle to another: degrees from three o'clock, clockwise.
fn around(
    page: &mut Page,
    object: u32,
    middle: Point,
    radius: f64,
    from_degrees: f64,
    to_degrees: f64,
) -> anyhow::Result<Matrix> {
    let at = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        (middle.0 + radius * cos, middle.1 + radius * sin)
    };
    dragged(page, object, at(from_degrees), at(to_degrees))
}

/// 30° clockwise; about the view ray it is told from about the camera's axis by the axis alone.
fn check_turn(what: &str, before: &Matrix, after: &Matrix, least_tilt: Option<f64>) -> anyhow::Result<()> {
    let turn = axis_angle_between(&rotation(before), &rotation(after));
    let degrees = norm(turn).to_degrees();
    let axis = turn.map(|value| value / norm(turn));
    println!("   {what} by 30°: {degrees:.2}° about {axis:.3?}");
    // Whole pixels at this radius are up to half a degree at each end, and the middle is found to a pixel or two.
    ensure!((degrees - 30.0).abs() < 2.5, "{what} turned by {degrees}°");
    ensure!(axis[2] > 0.5, "{what} turned the wrong way");
    let drift_mm = distance(translation(before), translation(after));
    ensure!(drift_mm < 1e-6, "{what} moved the object by {drift_mm} mm");
    let tilt = axis[0].hypot(axis[1]);
    if let Some(least) = least_tilt {
        ensure!(tilt > least, "{what} turned about the photo's view ray");
    }
    Ok(())
}
