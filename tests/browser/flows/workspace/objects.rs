//! The list of objects: names, colours, visibility, locks, links, copies, order.

use anyhow::{Context as _, ensure};

use super::{
    click_in_panel, differing, drag_by, object_entry, photo_view, place_of, pose_of, raw_state, reveal,
    row_menu, start_with_shapes, translation, undo,
};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::{Button, Modifier};
use crate::page::Page;
use crate::poses::{Vector, distance};

pub fn objects(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    let ball = shapes.ball;
    row_menu(page, "ball", "Rename")?;
    page.wait_for_widgets(&["New name"])?;
    page.type_text("globe")?;
    page.key("Enter", &[])?;
    ensure!(object_entry(page, ball)?["name"] == "globe", "Renamed to {}", object_entry(page, ball)?["name"]);

    let plain = photo_view(page)?;
    let color = object_entry(page, ball)?["color"].clone();
    click_in_panel(page, "Colour of globe")?;
    let choice = if color == object_entry(page, shapes.disc)?["color"] { "Colour 3" } else { "Colour 4" };
    page.click_widget(choice)?;
    page.key("Escape", &[])?;
    ensure!(object_entry(page, ball)?["color"] != color, "The colour is still {color}");
    let changed = differing(&plain, &photo_view(page)?);
    ensure!(changed > 500, "Another colour changes {changed} pixels");

    // The left third of the slider's rail.
    let slider = reveal(page, "Object opacity")?;
    page.click((slider.rect[0] + 30.0, slider.center().1), Button::Left, &[])?;
    let opacity = object_entry(page, ball)?["opacity"].as_f64().context("No opacity")?;
    println!("   colour: {changed} pixels; opacity by a click on the slider: {opacity}");
    ensure!((0.05..0.7).contains(&opacity), "The opacity is {opacity}");

    let shown = photo_view(page)?;
    click_in_panel(page, "Hide globe")?;
    page.wait_for_widgets(&["Show globe"])?;
    let at = place_of(page, ball, [0.0; 3])?;
    ensure!(page.pick(at)?.is_none(), "A hidden object was picked");
    ensure!(differing(&shown, &photo_view(page)?) > 500, "Hidden it is still seen");
    click_in_panel(page, "Show globe")?;
    ensure!(photo_view(page)? == shown, "Shown again it looks different");

    lock(page, ball)?;
    link(page, ball, shapes.disc)?;

    page.key("d", &[Modifier::Control])?;
    let state = page.wait_for_state("state.objects.length === 3", PATIENCE)?;
    let names: Vec<&str> = state.objects.iter().map(|object| object.name.as_str()).collect();
    println!("   after Duplicate: {names:?}");
    ensure!(
        state.selection.object.is_some_and(|id| id != ball && id != shapes.disc),
        "The copy is not selected"
    );
    undo(page)?;
    page.wait_for_state("state.objects.length === 2", PATIENCE)?;

    let order = order(page)?;
    let first = page.state()?.objects[0].name.clone();
    row_menu(page, &first, "Move down")?;
    let turned: Vec<u64> = order.iter().rev().copied().collect();
    ensure!(self::order(page)? == turned, "{order:?} was reordered to {:?}", self::order(page)?);
    page.key("Escape", &[])?;

    row_menu(page, "disc", "Remove disc")?;
    page.wait_for_state("state.objects.length === 1", PATIENCE)?;
    undo(page)?;
    page.wait_for_state("state.objects.length === 2", PATIENCE)?;
    Ok(())
}

fn order(page: &mut Page) -> anyhow::Result<Vec<u64>> {
    let state = raw_state(page)?;
    let objects = state["objects"].as_array().context("No objects")?;
    Ok(objects.iter().filter_map(|object| object["id"].as_u64()).collect())
}

/// A locked object is not moved by a drag.
fn lock(page: &mut Page, ball: u32) -> anyhow::Result<()> {
    click_in_panel(page, "Lock globe")?;
    page.wait_for_widgets(&["Unlock globe"])?;
    let before = pose_of(page, ball)?;
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (30.0, 10.0))?;
    page.key("ArrowLeft", &[])?;
    ensure!(pose_of(page, ball)? == before, "A locked object was moved");
    click_in_panel(page, "Unlock globe")?;
    page.wait_for_widgets(&["Lock globe"])?;
    page.key("0", &[])?;
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (30.0, 10.0))?;
    ensure!(pose_of(page, ball)? != before, "An unlocked object was not moved");
    undo(page)?;
    ensure!(pose_of(page, ball)? == before, "The move was not undone");
    Ok(())
}

/// Ctrl + click selects one more; linked they move together, also when one alone is selected.
fn link(page: &mut Page, ball: u32, disc: u32) -> anyhow::Result<()> {
    let row = reveal(page, "disc")?;
    page.click(row.center(), Button::Left, &[Modifier::Control])?;
    page.key("l", &[Modifier::Control])?;
    let links = [object_entry(page, ball)?["link"].clone(), object_entry(page, disc)?["link"].clone()];
    ensure!(links[0].is_u64() && links[0] == links[1], "Linked they have {links:?}");
    super::select(page, ball)?;
    let before = [pose_of(page, ball)?, pose_of(page, disc)?];
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (25.0, 15.0))?;
    let after = [pose_of(page, ball)?, pose_of(page, disc)?];
    let way = |index: usize| -> Vector {
        [0, 1, 2].map(|axis| translation(&after[index])[axis] - translation(&before[index])[axis])
    };
    println!("   linked: the ball by {:.2?} mm, the disc by {:.2?} mm", way(0), way(1));
    ensure!(distance(way(0), [0.0; 3]) > 5.0, "The drag did not move the ball");
    ensure!(distance(way(0), way(1)) < 1e-9, "Linked objects move apart");
    undo(page)?;
    ensure!([pose_of(page, ball)?, pose_of(page, disc)?] == before, "One undo did not bring both back");
    super::select(page, ball)?;
    page.key("l", &[Modifier::Control, Modifier::Shift])?;
    ensure!(object_entry(page, ball)?["link"].is_null(), "The ball is still linked");
    ensure!(object_entry(page, disc)?["link"].is_null(), "The disc is linked with nobody");
    Ok(())
}
