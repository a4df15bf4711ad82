//! From an empty page to a saved pose and back, by hand.

use std::time::Duration;

use anyhow::{Context as _, ensure};
use serde_json::Value;

use super::PHOTO;
use crate::api::{Loaded, PATIENCE, Pose, State};
use crate::context::Context;
use crate::data::{File, Linemod};
use crate::input::{Button, Modifier, Point};
use crate::page::Page;
use crate::poses::{Vector, angle_between, axis_rotation, distance, distance_px, product};
use crate::poses::{projected, rotation, transformed, with_translation};

/// An autosaved scene is back within this time after a reload.
const RESTORE_TIME: Duration = Duration::from_secs(10);

/// A point of the object's image at its true pose, away from rims behind which the surface would change in a drag.
const ON_OBJECT: Point = (221.0, 180.0);

/// Cursor, pose and projection are `f64`s throughout: far above their rounding, far below what a hand can do.
const EXACT_PX: f64 = 1e-6;
const EXACT_MM: f64 = 1e-6;

/// The whole path: files in, a pose by mouse, undo, files out and in again, a reload, a workspace.
pub fn path(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let page = context.start("")?;
    page.wait_for_widgets(&["Drop your files here", "A photo", "Open files…", "Try the example"])?;
    let start = drop_sample(page, &linemod)?;
    let sphere = Sphere::of(&linemod.file(&linemod.sample(PHOTO)?.mesh)?)?;

    let moved = move_by_mouse(page)?;
    let turned = turn_by_mouse(page, &sphere)?;
    let deeper = change_depth(page, &sphere)?;
    undo_and_redo(page, &[start, moved, turned, deeper])?;
    cancel_in_mid_drag(page)?;

    let poses_file = save_poses(page)?;
    let workspace = save_workspace(page)?;
    load_poses_again(page, &poses_file)?;
    reload(page)?;
    open_workspace(page, &workspace)
}

/// Drops photo, mesh and truth, and answers the question with the mouse.
fn drop_sample(page: &mut Page, linemod: &Linemod) -> anyhow::Result<Pose> {
    let sample = linemod.sample(PHOTO)?;
    page.drop_files(&linemod.files_of(sample)?)?;
    page.wait_for_state("state.question === 'poses_as'", PATIENCE)?;
    page.wait_for_widgets(&["Start poses", "Reference", "Cancel"])?;
    page.click_widget("Start poses")?;
    let state = page.wait_for_state("state.photos[0]?.poses.length === 1", PATIENCE)?;

    let k = state.shown_photo()?.k;
    ensure!(k == [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]], "K is {k:?}");
    let pose = state.selected_pose()?.clone();
    ensure!((pose.state.as_str(), pose.source.as_str()) == ("posed", "imported"), "{pose:?}");
    for (read, written) in
        pose.camera_from_object.iter().flatten().zip(sample.camera_from_object.iter().flatten())
    {
        // The file's rotation has eight digits, its columns' products are off by some 1e-7, and it is put back onto SO(3).
        ensure!((read - written).abs() < 1e-6, "{read} was read, {written} is in the file");
    }
    Ok(pose)
}

/// A left drag: the grabbed point of the surface stays under the cursor, at its depth. With Alt, a tenth of the way.
fn move_by_mouse(page: &mut Page) -> anyhow::Result<Pose> {
    let from = page.mouse_place(ON_OBJECT)?;
    let to = (from.0 + 70.0, from.1 + 45.0);
    let grabbed = page.pick(from)?.context("Nothing is under the cursor")?;
    page.drag(from, to, Button::Left, 3, &[])?;
    let (state, pose) = state_and_pose(page)?;
    let cursor = page.image_from_page(to)?;
    let seen = projected(&state.shown_photo()?.k, &pose.camera_from_object, grabbed.point);
    let miss_px = distance_px(seen, cursor);
    println!("   move: the grabbed point is {miss_px:.1e} px from the cursor");
    ensure!(miss_px < EXACT_PX, "The grabbed point is seen at {seen:?}, the cursor is at {cursor:?}");
    let depth = transformed(&pose.camera_from_object, grabbed.point)[2];
    ensure!((depth - grabbed.depth).abs() < EXACT_MM, "The depth went from {} to {depth}", grabbed.depth);
    let now = page.pick(to)?.context("Nothing is under the cursor after the move")?;
    // Picking meets the surface where 0.1 px of the ray's direction is 0.17 mm of it.
    ensure!(
        distance(now.point, grabbed.point) < 0.17,
        "{grabbed:?} was grabbed, {now:?} is under the cursor"
    );

    let fine_to = (to.0 + 20.0, to.1);
    page.drag(to, fine_to, Button::Left, 2, &[Modifier::Alt])?;
    let (_, fine) = state_and_pose(page)?;
    let aim = page.image_from_page((to.0 + 2.0, to.1))?;
    let seen = projected(&state.shown_photo()?.k, &fine.camera_from_object, grabbed.point);
    ensure!(distance_px(seen, aim) < EXACT_PX, "With Alt the point is seen at {seen:?}, not at {aim:?}");
    // One undo step a gesture: the flow goes on from the first.
    page.key("z", &[Modifier::Control])?;
    ensure!(page.selected_pose()? == pose, "Undo did not bring the pose before the fine drag back");
    Ok(pose)
}

/// A right drag: the rotation changes, the centre of the bounding sphere stays.
fn turn_by_mouse(page: &mut Page, sphere: &Sphere) -> anyhow::Result<Pose> {
    let (state, before) = state_and_pose(page)?;
    let center_before = transformed(&before.camera_from_object, sphere.center);
    let from =
        page.mouse_place(projected(&state.shown_photo()?.k, &before.camera_from_object, sphere.center))?;
    page.drag(from, (from.0 + 40.0, from.1 + 10.0), Button::Right, 3, &[])?;
    let (_, after) = state_and_pose(page)?;
    let angle = angle_between(&before.camera_from_object, &after.camera_from_object).to_degrees();
    let drift_mm = distance(transformed(&after.camera_from_object, sphere.center), center_before);
    println!("   right drag: turned by {angle:.1}°, the centre moved by {drift_mm:.1e} mm");
    ensure!(angle > 5.0, "A right drag turned the object by {angle}°");
    ensure!(drift_mm < EXACT_MM, "A right drag moved the object's centre by {drift_mm} mm");
    Ok(after)
}

/// Shift + wheel: nearer by one pixel of silhouette width a notch, the point under the cursor stays on its pixel.
fn change_depth(page: &mut Page, sphere: &Sphere) -> anyhow::Result<Pose> {
    let (state, before) = state_and_pose(page)?;
    let k = &state.shown_photo()?.k;
    let at = page.mouse_place(projected(k, &before.camera_from_object, sphere.center))?;
    let held = page.pick(at)?.context("Nothing is under the cursor")?;
    page.wheel(at, 1, &[Modifier::Shift])?;
    let (_, after) = state_and_pose(page)?;
    let drift_px =
        distance_px(projected(k, &after.camera_from_object, held.point), page.image_from_page(at)?);
    ensure!(drift_px < EXACT_PX, "Shift + wheel moved the point under the cursor by {drift_px} px");
    let width_px = |pose: &Pose| {
        let depth = transformed(&pose.camera_from_object, sphere.center)[2];
        2.0 * (k[0][0] * k[1][1]).sqrt() * sphere.radius / depth
    };
    let wider_px = width_px(&after) - width_px(&before);
    println!("   a notch with Shift: {wider_px:.3} px wider");
    // The surface point sets the step, the sphere's centre behind it is what is measured: some per cent of 1 px.
    ensure!((wider_px - 1.0).abs() < 0.1, "A notch made the silhouette {wider_px} px wider");
    Ok(after)
}

/// `poses`: before the first gesture, and after each. Every gesture is one step, and each comes back bit for bit.
fn undo_and_redo(page: &mut Page, poses: &[Pose]) -> anyhow::Result<()> {
    for (steps, expected) in poses.iter().rev().enumerate().skip(1) {
        page.key("z", &[Modifier::Control])?;
        ensure!(page.selected_pose()? == *expected, "Undo {steps} did not bring {expected:?} back");
    }
    for (steps, expected) in poses.iter().enumerate().skip(1) {
        page.key("z", &[Modifier::Control, Modifier::Shift])?;
        ensure!(page.selected_pose()? == *expected, "Redo {steps} did not bring {expected:?} back");
    }
    Ok(())
}

/// Esc puts the object back at once, and the rest of the drag does nothing.
fn cancel_in_mid_drag(page: &mut Page) -> anyhow::Result<()> {
    let before = page.state()?;
    let from = on_object(page)?;
    page.mouse_move(from)?;
    page.mouse_down(from, Button::Left)?;
    page.mouse_move_holding((from.0 + 30.0, from.1 - 30.0), Button::Left)?;
    ensure!(page.selected_pose()? != *before.selected_pose()?, "The drag did not move the object");
    page.key("Escape", &[])?;
    ensure!(page.state()?.scene() == before.scene(), "Esc did not put the object back");
    page.mouse_move_holding((from.0 + 40.0, from.1 - 10.0), Button::Left)?;
    page.mouse_up((from.0 + 40.0, from.1 - 10.0), Button::Left)?;
    ensure!(page.state()?.scene() == before.scene(), "After Esc the drag went on");
    Ok(())
}

/// Ctrl+E: what is downloaded is what is on screen, bit for bit.
fn save_poses(page: &mut Page) -> anyhow::Result<File> {
    page.key("e", &[Modifier::Control])?;
    let file = page.download(PATIENCE)?;
    ensure!(file.name == "000019-poses.json", "Saved as {}", file.name);
    let saved: Value = serde_json::from_slice(&file.bytes).context("The downloaded poses are no JSON")?;
    let pose: Pose = serde_json::from_value(saved["photos"][0]["poses"][0].clone())?;
    ensure!(pose == page.selected_pose()?, "Saved was {pose:?}");
    Ok(file)
}

fn save_workspace(page: &mut Page) -> anyhow::Result<File> {
    page.key("e", &[Modifier::Control, Modifier::Shift])?;
    let file = page.download(PATIENCE)?;
    ensure!(file.name == "000019-workspace.zip" && file.bytes.starts_with(b"PK"), "Saved as {}", file.name);
    Ok(file)
}

/// The saved poses, dropped after the object was moved further, bring it back bit for bit.
fn load_poses_again(page: &mut Page, poses_file: &File) -> anyhow::Result<()> {
    let saved = page.selected_pose()?;
    let from = on_object(page)?;
    page.drag(from, (from.0 - 35.0, from.1 + 20.0), Button::Left, 2, &[])?;
    ensure!(page.selected_pose()? != saved, "The drag did not move the object");
    page.drop_files(std::slice::from_ref(poses_file))?;
    page.click_widget("Start poses")?;
    page.wait_for_state("state.question === null && !state.busy", PATIENCE)?;
    let loaded = page.selected_pose()?;
    ensure!(loaded == saved, "{saved:?} was saved, {loaded:?} was loaded");
    Ok(())
}

/// After a reload everything is back as it was, the picture too.
fn reload(page: &mut Page) -> anyhow::Result<()> {
    let before = page.wait_until_saved()?;
    let picture = page.render_png("overlay")?;
    page.reload()?;
    page.wait_until_ready()?;
    let after = page.wait_for_state("state.photos.length === 1 && !state.busy", RESTORE_TIME)?;
    ensure!(after.scene() == before.scene(), "{:?} came back as {:?}", before.scene(), after.scene());
    ensure!(after.selection == before.selection, "{:?} was selected", after.selection);
    ensure!(page.render_png("overlay")? == picture, "The picture after the reload is another one");
    Ok(())
}

/// A workspace opens in an empty scene with everything in it.
fn open_workspace(page: &mut Page, workspace: &File) -> anyhow::Result<()> {
    let before = page.state()?;
    page.command("new_scene")?;
    let new = page.wait_for_state("!state.busy && state.photos.length === 0", PATIENCE)?;
    ensure!(new.scene() == (&[][..], &[][..]), "The new scene is not empty");
    page.drop_files(std::slice::from_ref(workspace))?;
    let after = page.wait_for_state("state.photos.length === 1 && !state.busy", PATIENCE)?;
    ensure!(after.selected_pose()? == before.selected_pose()?, "The workspace opened as {after:?}");
    ensure!(after.scene() == before.scene(), "{:?} came back as {:?}", before.scene(), after.scene());
    Ok(())
}

/// Files that come later, and a pose that was corrected in between: what the user has done stays.
pub fn late_files(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let first = linemod.sample(PHOTO)?;
    let second = linemod.samples.iter().find(|sample| sample.photo != PHOTO).context("Only one sample")?;
    let page = context.start("")?;
    page.load(&linemod.files_of(first)?)?;
    let before = page.state()?;
    let (photo, pose) = (before.shown_photo()?.id, before.selected_pose()?);
    let turn = product(&axis_rotation(2, 0.2), &rotation(&pose.camera_from_object));
    page.set_pose(photo, pose.object, with_translation(turn, [30.0, -20.0, 900.0]))?;
    let corrected = page.selected_pose()?;
    // The truth of the first drop speaks of these two as well.
    let Loaded { files, .. } = page.load(&[linemod.file(&second.photo)?, linemod.file(&second.mesh)?])?;
    ensure!(files == 2, "{files} of 2 files were taken");
    let after = page.wait_until_saved()?;
    let pose_in = |photo: &str| after.photos.iter().find(|it| it.file == photo).map(|it| it.poses.as_slice());
    ensure!(pose_in(&second.photo).is_some_and(|poses| poses.len() == 1), "The second truth was not used");
    let kept = pose_in(PHOTO).and_then(|poses| poses.first());
    ensure!(kept == Some(&corrected), "{corrected:?} was set, and is now {kept:?}");
    Ok(())
}

/// The bounding sphere: the pivot of rotations.
struct Sphere {
    center: Vector,
    radius: f64,
}

impl Sphere {
    fn of(mesh: &File) -> anyhow::Result<Sphere> {
        let sphere =
            pinpose::mesh::load(&mesh.name, &mesh.bytes, &pinpose::mesh::no_companions)?.mesh.sphere();
        Ok(Sphere { center: sphere.center.to_array(), radius: sphere.radius })
    }
}

fn state_and_pose(page: &mut Page) -> anyhow::Result<(State, Pose)> {
    let state = page.state()?;
    let pose = state.selected_pose()?.clone();
    Ok((state, pose))
}

/// A place of the page where the selected object is: where its mesh's origin is seen.
fn on_object(page: &mut Page) -> anyhow::Result<Point> {
    let (state, pose) = state_and_pose(page)?;
    let place = page.mouse_place(projected(&state.shown_photo()?.k, &pose.camera_from_object, [0.0; 3]))?;
    let hit = page.pick(place)?.context("The object is not where its origin is seen")?;
    ensure!(hit.object == pose.object, "Another object is before the selected one");
    Ok(place)
}
