//! The output: a line of history a gesture, going back by a click, search, clearing, and copies as text.

use anyhow::{Context as _, ensure};

use super::{drag_by, place_of, pose_of, start_with_shapes, undo};
use crate::api::Widget;
use crate::context::Context;
use crate::input::{Button, Modifier};
use crate::page::Page;

pub fn output(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    let ball = shapes.ball;
    // Room for more than two lines.
    let widgets = page.wait_for_widgets(&["Fold output"])?;
    let fold = widgets.iter().find(|widget| widget.label == "Fold output").context("No output")?;
    let edge = (120.0, fold.rect[1] - 5.0);
    page.drag(edge, (edge.0, edge.1 - 160.0), Button::Left, 3, &[])?;
    let first = lines(page)?.len();
    let at = place_of(page, ball, [0.0; 3])?;
    drag_by(page, at, (25.0, 10.0))?;
    let moved = pose_of(page, ball)?;
    let at = place_of(page, ball, [0.0; 3])?;
    page.drag(at, (at.0 + 20.0, at.1 + 10.0), Button::Right, 2, &[])?;
    page.wheel(at, 1, &[Modifier::Shift])?;
    page.key("ArrowLeft", &[])?;
    let shown = lines(page)?;
    let labels: Vec<&str> = shown.iter().map(|line| line.label.as_str()).collect();
    println!("   {first} lines before, then {labels:?}");
    ensure!(shown.len() == first + 4, "4 gestures left {} lines", shown.len() - first);
    for (line, word) in shown.iter().zip(["Nudge", "Change depth", "Rotate", "Move"]) {
        ensure!(line.label.contains(word) && line.label.contains("ball"), "{} is no {word}", line.label);
    }

    // The newest is the first; the fourth is the move.
    page.click(shown[3].center(), Button::Left, &[])?;
    ensure!(pose_of(page, ball)? == moved, "A click on the line did not bring its pose back");
    undo(page)?;
    ensure!(pose_of(page, ball)? != moved, "The return was not undone");

    page.click_widget("Search the history")?;
    page.type_text("rotate")?;
    let found = lines(page)?;
    ensure!(found.len() == 1 && found[0].label.contains("Rotate"), "Found were {found:?}");
    page.key("a", &[Modifier::Control])?;
    page.key("Backspace", &[])?;
    page.key("Escape", &[])?;
    let all = lines(page)?;
    page.click_widget("Clear history list")?;
    ensure!(lines(page)?.is_empty(), "The list was not cleared");
    undo(page)?;
    let back = lines(page)?;
    ensure!(
        back.first().map(|line| &line.label) == all.first().map(|line| &line.label) && all.len() > 1,
        "Undo brought {} of {} lines back",
        back.len(),
        all.len()
    );
    ensure!(back.len() == all.len(), "The panel has another height than it was given");

    copies(page, ball)
}

/// The lines of the history that are on screen, from above.
fn lines(page: &mut Page) -> anyhow::Result<Vec<Widget>> {
    page.next_frame()?;
    let widgets = page.widgets()?;
    let is_line = |widget: &Widget| {
        let bytes = widget.label.as_bytes();
        bytes.len() > 8 && bytes[0].is_ascii_digit() && bytes[2] == b':' && bytes[5] == b':'
    };
    let mut lines: Vec<Widget> = widgets.into_iter().filter(is_line).collect();
    lines.sort_by(|a, b| a.rect[1].total_cmp(&b.rect[1]));
    Ok(lines)
}

/// Each command leaves the pose as text in the clipboard.
fn copies(page: &mut Page, object: u32) -> anyhow::Result<()> {
    page.eval(
        "(() => {
            window.copied = [];
            const write = (text) => { window.copied.push(text); return Promise.resolve(); };
            Object.defineProperty(navigator, 'clipboard', { value: { writeText: write }, configurable: true });
        })()",
    )?;
    let pose = pose_of(page, object)?;
    for (count, name) in ["copy_pose", "copy_pose_numpy", "copy_pose_json"].into_iter().enumerate() {
        page.command(name)?;
        page.wait_until(&format!("window.copied.length === {}", count + 1), crate::api::PATIENCE)?;
        let text = page.eval("window.copied.at(-1)")?;
        let text = text.as_str().context("No text was copied")?;
        let numbers = numbers(text);
        ensure!(
            numbers == pose.iter().flatten().copied().collect::<Vec<f64>>(),
            "{name} copied {text}, the pose is {pose:?}"
        );
    }
    println!("   the pose is copied bit for bit in three forms");
    Ok(())
}

fn numbers(text: &str) -> Vec<f64> {
    let parts = text.split(|letter: char| !(letter.is_ascii_digit() || "+-.eE".contains(letter)));
    parts
        .filter(|part| part.contains(|letter: char| letter.is_ascii_digit()))
        .filter_map(|part| part.parse().ok())
        .collect()
}
