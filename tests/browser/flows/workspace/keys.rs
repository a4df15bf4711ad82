//! The palette, keys that the user changes, and the theme.

use anyhow::{Context as _, ensure};

use super::{differing, raw_state, start_with_shapes};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::Modifier;
use crate::page::Page;

pub fn keys(context: &mut Context) -> anyhow::Result<()> {
    let (page, _) = start_with_shapes(context)?;
    palette(page)?;
    theme(page)?;
    remap(page)
}

fn palette(page: &mut Page) -> anyhow::Result<()> {
    page.key("k", &[Modifier::Control])?;
    page.wait_for_widgets(&["Find a command"])?;
    page.type_text("nocs")?;
    page.wait_for_widgets(&["Overlay: NOCS"])?;
    page.key("Enter", &[])?;
    page.wait_for_state("state.view.overlay_mode === 'nocs'", PATIENCE)?;
    ensure!(!has_widget(page, "Find a command")?, "The palette is still open");
    // What is typed there runs no command by its key.
    page.key("k", &[Modifier::Control])?;
    page.wait_for_widgets(&["Find a command"])?;
    page.type_text("ro")?;
    page.key("Escape", &[])?;
    let state = raw_state(page)?;
    ensure!(
        state["selection"]["tool"] == "move" && state["view"]["overlay_mode"] == "nocs",
        "Keys got through"
    );
    Ok(())
}

fn theme(page: &mut Page) -> anyhow::Result<()> {
    let before = page.screenshot()?;
    page.command("toggle_theme")?;
    page.next_frame()?;
    page.next_frame()?;
    let toggled = page.screenshot()?;
    let count = differing(&before, &toggled);
    println!("   the other theme: {count} of {} pixels", before.pixels().len());
    ensure!(count > 50_000, "Another theme changes {count} pixels");
    page.command("toggle_theme")
}

/// X in place of O goes through the overlay modes, also after a reload.
fn remap(page: &mut Page) -> anyhow::Result<()> {
    page.key("?", &[Modifier::Shift])?;
    page.wait_for_widgets(&["Search keys"])?;
    page.click_widget("Search keys")?;
    page.type_text("next overlay")?;
    page.click_widget("Key of Next overlay: O")?;
    page.key("y", &[])?;
    page.wait_for_widgets(&["Key of Next overlay: Y"])?;
    page.click_widget("Close")?;
    page.wait_for_state("true", PATIENCE)?;
    check_key(page, "y", "o")?;
    page.wait_until_saved()?;
    page.reload()?;
    page.wait_until_ready()?;
    page.wait_for_state("!state.busy && state.photos.length === 1", PATIENCE)?;
    check_key(page, "y", "o")
}

fn check_key(page: &mut Page, new: &str, old: &str) -> anyhow::Result<()> {
    let mode = |page: &mut Page| {
        let mode = raw_state(page)?["view"]["overlay_mode"].clone();
        mode.as_str().map(str::to_owned).context("No overlay mode")
    };
    let before = mode(page)?;
    page.key(old, &[])?;
    ensure!(mode(page)? == before, "The old key still works");
    page.key(new, &[])?;
    ensure!(mode(page)? != before, "The new key does not work");
    Ok(())
}

fn has_widget(page: &mut Page, label: &str) -> anyhow::Result<bool> {
    Ok(page.widgets()?.iter().any(|widget| widget.label == label))
}
