//! What frames cost, and that there are none where nothing changes.

use std::time::Duration;

use anyhow::{Context as _, ensure};

use super::start_with_sample;
use crate::api::{Matrix, PATIENCE, Perf};
use crate::context::Context;
use crate::data::{self, File, Linemod, ball_ply, camera_file, flat_photo};
use crate::input::Button;
use crate::page::Page;
use crate::poses::{axis_rotation, projected, transformed, unprojected, with_translation};

/// With no input the page draws nothing.
pub fn idle(context: &mut Context) -> anyhow::Result<()> {
    let (page, _) = start_with_sample(context, &Linemod::open()?)?;
    // Messages that leave by themselves are a change.
    page.wait_for_state("state.notices.length === 0", PATIENCE)?;
    page.wait_until_saved()?;
    let first = frames_after(page, 1.0)?;
    let second = frames_after(page, 1.0)?;
    let third = frames_after(page, 3.5)?;
    let (short, long) = (second - first, third - second);
    println!("   frames: {short} with 1 s of rest, {long} with 3.5 s");
    ensure!(short <= FRAMES_OF_A_CALL, "{short} frames were drawn in 1 s without input");
    ensure!(long <= FRAMES_OF_A_CALL, "{long} frames were drawn in 3.5 s without input");
    Ok(())
}

/// Asking costs frames too: one to answer in, one that shows what the call may have changed, one in which egui settles.
const FRAMES_OF_A_CALL: u64 = 3;

fn frames_after(page: &mut Page, seconds: f64) -> anyhow::Result<u64> {
    std::thread::sleep(Duration::from_secs_f64(seconds));
    Ok(page.perf()?.frames)
}

/// In a drag neither the uploads nor the draw calls depend on the mesh.
pub fn drag_cost(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let photo = || flat_photo("flat.png", [70, 74, 80]);
    // 5 680 triangles, as many as obj_000001 has, and ten times more.
    let small =
        cost_of_drag(page, &[photo()?, ball_ply("small.ply", 50.0, 71, 41), camera_file("camera.json")])?;
    page.wait_until_saved()?;
    page.command("new_scene")?;
    page.wait_for_state("!state.busy && state.photos.length === 0", PATIENCE)?;
    let large =
        cost_of_drag(page, &[photo()?, ball_ply("large.ply", 50.0, 200, 143), camera_file("camera.json")])?;
    println!("   small: {small}\n   large: {large}");
    ensure!(large.triangles > 8.0 * small.triangles, "The meshes are not of two sizes");
    for cost in [&small, &large] {
        // One object's and one frame's uniforms.
        ensure!(cost.bytes <= 1024.0, "{} bytes are uploaded for a step of a drag", cost.bytes);
        // The object in two passes; a repaint, even one that changes nothing, composes again what lies below, which is kept,
        // the surfaces and the outlines.
        ensure!(cost.mesh_draws() <= 2.0 + 1e-9, "{} draw calls for a step of a drag", cost.draws);
    }
    ensure!(large.bytes <= small.bytes * 1.01, "Uploads depend on the mesh");
    Ok(())
}

/// For one step of a drag.
pub(super) struct Cost {
    pub bytes: f64,
    pub draws: f64,
    pub triangles: f64,
    frames: f64,
    pub cpu_ms: f64,
}

/// Of each frame's composition: what lies below, surfaces, outlines.
const COMPOSED_PARTS: f64 = 3.0;

impl Cost {
    /// The draw calls that are not the composition's, for one step. How many frames a step has is not always the same.
    pub fn mesh_draws(&self) -> f64 {
        self.draws - COMPOSED_PARTS * self.frames
    }
}

impl std::fmt::Display for Cost {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Cost { bytes, draws, triangles, frames, cpu_ms } = self;
        write!(
            formatter,
            "{bytes:.0} bytes, {draws:.1} draw calls, {triangles:.0} triangles, {frames:.1} frames a step; \
             {cpu_ms:.2} ms of CPU a frame"
        )
    }
}

const STEPS: u32 = 6;

/// After so many steps a long drag begins its way again.
const STEPS_OF_A_WAY: u32 = 7;

fn cost_of_drag(page: &mut Page, files: &[File]) -> anyhow::Result<Cost> {
    page.load(files)?;
    let state = page.state()?;
    let target = unprojected(&data::CAMERA, (260.0, 200.0), 600.0);
    let object = state.selection.object.context("No object is selected")?;
    page.set_pose(state.shown_photo()?.id, object, with_translation(axis_rotation(0, 0.0), target))?;
    let state = page.wait_until_saved()?;
    let pose = state.selected_pose()?.camera_from_object;
    ensure!(transformed(&pose, [0.0; 3]) == target, "The pose was not set");
    cost_of_dragging(page, &pose, STEPS)
}

/// Drags the object that is at this pose to the right, a step a frame.
pub(super) fn cost_of_dragging(page: &mut Page, pose: &Matrix, steps: u32) -> anyhow::Result<Cost> {
    const STEP: f64 = 8.0;
    let from = page.mouse_place(projected(&data::CAMERA, pose, [0.0; 3]))?;
    let place = |step: u32| (from.0 + 10.0 + f64::from(step % STEPS_OF_A_WAY) * STEP, from.1);
    page.mouse_move(from)?;
    page.mouse_down(from, Button::Left)?;
    page.mouse_move_holding(place(0), Button::Left)?;
    let before = page.perf()?;
    for step in 1..=steps {
        page.mouse_move_holding(place(step), Button::Left)?;
    }
    let after = page.perf()?;
    page.mouse_up(place(steps), Button::Left)?;
    Ok(cost_of_steps(&before, &after, steps))
}

fn cost_of_steps(before: &Perf, after: &Perf, steps: u32) -> Cost {
    let steps = f64::from(steps);
    Cost {
        bytes: after.uploaded_bytes as f64 / steps,
        draws: after.draw_calls as f64 / steps,
        triangles: after.triangles as f64 / steps,
        frames: (after.frames - before.frames) as f64 / steps,
        cpu_ms: after.cpu_ms.median,
    }
}
