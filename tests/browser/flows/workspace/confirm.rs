//! Confirming a photo, and going on to the next one of a sequence.

use anyhow::ensure;

use super::{drag_by, place_of, pose_of, start_with_shapes, translation};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::flat_photo;
use crate::input::Modifier;
use crate::page::Page;
use crate::poses::distance;

pub fn confirm(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    let (ball, first) = (shapes.ball, shapes.photo);
    page.load(&[flat_photo("second.png", [120, 60, 60])?])?;
    page.eval(&format!("window.pinpose.command('show_photo', {first}).then(() => true)"))?;
    super::select(page, ball)?;
    let pose = pose_of(page, ball)?;
    page.key("Enter", &[])?;
    let state = page.wait_for_state(&format!("state.selection.photo !== {first}"), PATIENCE)?;
    let carried = state.shown_photo()?.poses.iter().find(|pose| pose.object == ball);
    ensure!(
        carried.is_some_and(|carried| carried.camera_from_object == pose && carried.state == "carried"),
        "Carried was {carried:?}"
    );
    wait_for_cell(page, "first", "confirmed")?;
    wait_for_cell(page, "second", "carried over, to be checked")?;

    page.key("p", &[])?;
    page.wait_for_state(&format!("state.selection.photo === {first}"), PATIENCE)?;
    super::select(page, ball)?;
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (25.0, 10.0))?;
    page.key("ArrowLeft", &[])?;
    ensure!(pose_of(page, ball)? == pose, "A confirmed object was moved");

    page.key("Enter", &[Modifier::Shift])?;
    wait_for_cell(page, "first", "posed")?;
    page.key("0", &[])?;
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (25.0, 10.0))?;
    let moved_mm = distance(translation(&pose_of(page, ball)?), translation(&pose));
    println!("   reopened it can be moved: by {moved_mm:.1} mm");
    ensure!(moved_mm > 5.0, "A reopened object was not moved");
    Ok(())
}

/// The strip says by name what has been done in a photo.
fn wait_for_cell(page: &mut Page, photo: &str, words: &str) -> anyhow::Result<()> {
    let wanted = [format!("Photo {photo}, {words}"), format!("Photo {photo}.png, {words}")];
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(10);
    loop {
        let labels: Vec<String> = page.widgets()?.into_iter().map(|widget| widget.label).collect();
        if labels.iter().any(|label| wanted.contains(label)) {
            return Ok(());
        }
        let cells: Vec<&String> = labels.iter().filter(|label| label.starts_with("Photo ")).collect();
        ensure!(std::time::Instant::now() < deadline, "No cell is called {}: {cells:?}", wanted[0]);
    }
}
