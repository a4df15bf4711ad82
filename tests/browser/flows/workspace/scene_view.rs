//! The view of photo and objects from anywhere, alone and beside the photo view.

use std::time::Duration;

use anyhow::ensure;

use super::{
    at_rest, differing, middle_of, photo_view, pose_of, raw_state, rect_of, start_with_shapes, translation,
};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::Button;
use crate::page::Page;
use crate::poses::{axis_angle_between, norm, rotation};

/// Longer than the view takes to where it goes.
const TURNING: Duration = Duration::from_millis(500);

pub fn scene_view(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    for wanted in ["scene", "split", "photo"] {
        page.key("v", &[])?;
        wait_for_arrangement(page, wanted)?;
    }
    for (label, wanted) in [("Scene", "scene"), ("Photo", "photo"), ("Both", "split")] {
        page.click_widget(label)?;
        wait_for_arrangement(page, wanted)?;
    }
    // A place in a view is known once it was drawn there.
    page.wait_for_state("state.sceneViewport.rect[2] > 50", PATIENCE)?;
    drag_beside(page, shapes.ball)?;

    page.click_widget("Scene")?;
    page.wait_for_state("state.arrangement === 'scene' && state.viewport.rect[2] < 1", PATIENCE).ok();
    let rect = rect_of(&raw_state(page)?, "sceneViewport")?;
    let scene = page.state()?;
    let start = at_rest(page, rect)?;
    page.click_widget("View from +X")?;
    std::thread::sleep(TURNING);
    let from_x = at_rest(page, rect)?;
    page.click_widget("View from -Y")?;
    std::thread::sleep(TURNING);
    let from_above = at_rest(page, rect)?;
    let ground = (rect[0] + 30.0, rect[1] + rect[3] - 40.0);
    page.drag(ground, (ground.0 + 60.0, ground.1 - 40.0), Button::Left, 3, &[])?;
    let orbited = at_rest(page, rect)?;
    page.key("Home", &[])?;
    std::thread::sleep(TURNING);
    let reset = at_rest(page, rect)?;
    let counts = [(&start, &from_x), (&from_x, &from_above), (&from_above, &orbited), (&orbited, &reset)]
        .map(|(a, b)| differing(a, b));
    let left = differing(&start, &reset);
    println!("   from +X, from -Y, orbit, reset: {counts:?} pixels changed; {left} are not back");
    ensure!(counts.iter().all(|count| *count > 2000), "A view is like the one before");
    ensure!(left == 0, "Home is not the view that it began with");
    ensure!(page.state()?.scene() == scene.scene(), "Looking around changed the scene");
    Ok(())
}

/// A drag in the scene view moves the object in the plane of that view; the photo view shows it.
fn drag_beside(page: &mut Page, object: u32) -> anyhow::Result<()> {
    let rect = rect_of(&raw_state(page)?, "sceneViewport")?;
    let (before, seen) = (pose_of(page, object)?, photo_view(page)?);
    let from = middle_of(page, rect, object)?;
    page.drag(from, (from.0 + 15.0, from.1 - 20.0), Button::Left, 3, &[])?;
    let (after, seen_after) = (pose_of(page, object)?, photo_view(page)?);
    let way = [0, 1, 2].map(|axis| translation(&after)[axis] - translation(&before)[axis]);
    let changed = differing(&seen, &seen_after);
    println!("   a drag beside the photo: {way:.1?} mm, {changed} pixels of the photo view changed");
    ensure!(norm(way) > 3.0 && changed > 100, "The drag beside the photo did not move the object");
    ensure!(way[2].abs() > 0.3, "The drag was in the photo's plane, not in that of the view");
    let turn = norm(axis_angle_between(&rotation(&before), &rotation(&after)));
    ensure!(turn < 1e-9, "The drag turned the object by {turn}");
    Ok(())
}

fn wait_for_arrangement(page: &mut Page, wanted: &str) -> anyhow::Result<()> {
    page.wait_for_state(&format!("state.arrangement === '{wanted}'"), PATIENCE)?;
    Ok(())
}
