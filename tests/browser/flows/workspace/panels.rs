//! The numbers of the side panel: camera, pose and mesh, typed and pasted.

use anyhow::ensure;
use serde_json::Value;

use super::{
    click_in_panel, differing, object_entry, paste, photo_view, pose_of, raw_state, reveal,
    start_with_shapes, translation, type_into, undo,
};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::{Button, Modifier};
use crate::page::Page;
use crate::poses::{angle_between, distance};

pub fn panels(context: &mut Context) -> anyhow::Result<()> {
    let (page, shapes) = start_with_shapes(context)?;
    camera(page)?;
    click_in_panel(page, "Camera")?;
    click_in_panel(page, "Pose values")?;
    pose_values(page, shapes.ball)?;
    click_in_panel(page, "Pose values")?;
    click_in_panel(page, "Mesh")?;
    mesh(page, shapes.ball)
}

/// Typed numbers are seen at once; undo, reset and lock.
fn camera(page: &mut Page) -> anyhow::Result<()> {
    let given = k(page)?;
    let before = photo_view(page)?;
    click_in_panel(page, "fx")?;
    page.key("a", &[Modifier::Control])?;
    page.type_text("800")?;
    ensure!(k(page)?[0][0] == 800.0, "800 was typed, fx is {}", k(page)?[0][0]);
    page.key("Enter", &[])?;
    let changed = differing(&before, &photo_view(page)?);
    let mut steps = 0;
    while k(page)? != given && steps < 4 {
        undo(page)?;
        steps += 1;
    }
    println!("   fx: {changed} pixels changed, undone in {steps} step(s)");
    ensure!(changed > 500, "Another focal length changes {changed} pixels");
    ensure!(steps == 1, "One number typed is {steps} steps of undo");
    ensure!(photo_view(page)? == before, "After undo the picture is another one");

    type_into(page, "cy", "240.5")?;
    ensure!(k(page)?[1][2] == 240.5, "cy is {}", k(page)?[1][2]);
    click_in_panel(page, "Reset camera")?;
    page.wait_for_state("state.photos[0].camera_origin.kind === 'file'", PATIENCE)?;
    ensure!(k(page)? == given, "The camera was not reset");

    click_in_panel(page, "Lock camera")?;
    page.wait_for_widgets(&["Unlock camera"])?;
    let at = reveal(page, "fx")?.center();
    page.drag(at, (at.0 + 40.0, at.1), Button::Left, 2, &[])?;
    ensure!(k(page)? == given, "A locked camera was changed");
    click_in_panel(page, "Unlock camera")?;
    page.wait_for_widgets(&["Lock camera"])?;
    Ok(())
}

fn k(page: &mut Page) -> anyhow::Result<[[f64; 3]; 3]> {
    Ok(page.state()?.shown_photo()?.k)
}

fn pose_values(page: &mut Page, object: u32) -> anyhow::Result<()> {
    let before = pose_of(page, object)?;
    // As text, which is the form that it begins with.
    click_in_panel(page, "Pose as text")?;
    page.key("a", &[Modifier::Control])?;
    paste(page, "0 -1 0 10\n1 0 0 20\n0 0 1 500\n0 0 0 1")?;
    click_in_panel(page, "Set")?;
    let set = pose_of(page, object)?;
    let wanted =
        [[0.0, -1.0, 0.0, 10.0], [1.0, 0.0, 0.0, 20.0], [0.0, 0.0, 1.0, 500.0], [0.0, 0.0, 0.0, 1.0]];
    let off =
        set.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(off < 1e-12, "The pasted matrix became {set:?}");
    undo(page)?;
    ensure!(distance(translation(&pose_of(page, object)?), translation(&before)) == 0.0, "Not undone");

    click_in_panel(page, "Rotation as")?;
    page.click_widget("Euler xyz")?;
    type_into(page, "tx", "-12.25")?;
    let typed = pose_of(page, object)?;
    let [_, y, z] = translation(&before);
    ensure!(translation(&typed) == [-12.25, y, z], "t is {:?}", translation(&typed));
    ensure!(angle_between(&typed, &before) < 1e-7, "Typing tx turned the object");
    undo(page)?;
    ensure!(pose_of(page, object)? == before, "Undo did not bring tx back");
    Ok(())
}

fn mesh(page: &mut Page, object: u32) -> anyhow::Result<()> {
    let frame = |page: &mut Page| anyhow::Ok(object_entry(page, object)?["mesh_from_file"].clone());
    let plain = frame(page)?;
    click_in_panel(page, "Mirror x")?;
    let mirrored = frame(page)?;
    ensure!(mirrored[0][0] == -1.0, "Mirrored along x the frame is {mirrored}");
    click_in_panel(page, "Mirror x")?;
    ensure!(frame(page)? == plain, "Mirrored twice the frame is {}", frame(page)?);

    type_into(page, "spacing y", "0")?;
    ensure!(frame(page)? == plain, "A spacing of 0 was taken");
    let widgets = page.widgets()?;
    let said = widgets.iter().find(|widget| widget.label.starts_with("Not taken")).map(|it| it.label.clone());
    println!("   spacing 0: {}", said.as_deref().unwrap_or("nothing said"));
    type_into(page, "spacing y", "2.5")?;
    ensure!(frame(page)?[1][1] == 2.5, "Spacing 2.5 gave {}", frame(page)?);
    reveal(page, "Reset mesh")?;
    click_in_panel(page, "Reset mesh")?;
    ensure!(frame(page)? == plain, "The mesh was not reset");
    ensure!(raw_state(page)?["notices"] == Value::Array(Vec::new()), "Something went wrong");
    Ok(())
}
