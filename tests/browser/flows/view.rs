//! Looking around: zoom, pan, panels, how the overlay looks, and the tools' keys.

use anyhow::ensure;

use super::{PHOTO, start_with_sample, without_messages};
use crate::api::{PATIENCE, State};
use crate::context::Context;
use crate::data::Linemod;
use crate::input::{Button, Point};
use crate::page::Page;
use crate::poses::{angle_between, distance_px, projected};

/// egui's positions are `f32`: at 800 CSS pixels they are exact to 1e-4, and a photo pixel is about one.
const EXACT_PX: f64 = 0.01;

/// In the photo, on the object.
const ON_OBJECT: Point = (221.0, 178.0);

pub fn view(context: &mut Context) -> anyhow::Result<()> {
    let (page, state) = start_with_sample(context, &Linemod::open()?)?;
    zoom_keeps_the_point(page)?;
    pan_moves_the_point(page)?;
    fit_and_zoom_to_object(page, &state)?;
    panels(page)?;
    overlay_looks(page)?;
    tools(page)
}

fn zoom_keeps_the_point(page: &mut Page) -> anyhow::Result<()> {
    let at = page.mouse_place(ON_OBJECT)?;
    let (before, zoom_before) = (page.image_from_page(at)?, page.state()?.viewport.zoom);
    page.wheel(at, 3, &[])?;
    let (after, zoom) = (page.image_from_page(at)?, page.state()?.viewport.zoom);
    let drift_px = distance_px(before, after);
    println!("   zoom {zoom_before:.2} to {zoom:.2}: the point under the cursor moved by {drift_px:.1e} px");
    ensure!(zoom > 1.5 * zoom_before, "Three notches went from zoom {zoom_before} to {zoom}");
    ensure!(drift_px < EXACT_PX, "{before:?} was under the cursor, now it is {after:?}");
    Ok(())
}

fn pan_moves_the_point(page: &mut Page) -> anyhow::Result<()> {
    let from = page.mouse_place(ON_OBJECT)?;
    let to = (from.0 + 50.0, from.1 + 30.0);
    let (scene, before) = (page.state()?, page.image_from_page(from)?);
    page.drag(from, to, Button::Middle, 2, &[])?;
    let after = page.image_from_page(to)?;
    ensure!(distance_px(before, after) < EXACT_PX, "{before:?} was dragged, {after:?} is under the cursor");
    ensure!(page.state()?.scene() == scene.scene(), "A middle drag changed the scene");
    Ok(())
}

fn fit_and_zoom_to_object(page: &mut Page, start: &State) -> anyhow::Result<()> {
    page.key("0", &[])?;
    let fitted = page.state()?.viewport.zoom;
    ensure!(
        fitted == start.viewport.zoom,
        "Fitted at zoom {fitted}, at the start it was {}",
        start.viewport.zoom
    );
    page.key("f", &[])?;
    let state = page.state()?;
    ensure!(state.viewport.zoom > 2.0 * fitted, "F went to zoom {}", state.viewport.zoom);
    let pose = state.selected_pose()?.camera_from_object;
    let seen = page.page_from_image(projected(&state.shown_photo()?.k, &pose, [0.0; 3]))?;
    let [x, y, width, height] = state.viewport.rect;
    let middle = (x + width / 2.0, y + height / 2.0);
    // A mesh's origin is near its middle, not in it.
    ensure!(
        distance_px(seen, middle) < height / 8.0,
        "After F the object is at {seen:?}, not near {middle:?}"
    );

    let corner = (x + 20.0, y + 60.0);
    ensure!(page.pick(corner)?.is_none(), "The viewport's corner is not free");
    page.double_click(corner, Button::Left)?;
    let zoom = page.state()?.viewport.zoom;
    ensure!(zoom == fitted, "A double click on the ground went to zoom {zoom}");
    Ok(())
}

fn panels(page: &mut Page) -> anyhow::Result<()> {
    let width = |page: &mut Page| anyhow::Ok(page.state()?.viewport.rect[2]);
    let with_panels = width(page)?;
    page.key("F9", &[])?;
    // The state tells where the viewport was in the last frame.
    let without = page.wait_for_state("state.viewport.rect[2] > 700", PATIENCE)?.viewport.rect[2];
    ensure!(
        without > with_panels + 100.0,
        "Without panels the viewport is {without} wide, with them {with_panels}"
    );
    page.key("F9", &[])?;
    page.wait_for_state(&format!("state.viewport.rect[2] === {with_panels}"), PATIENCE)?;
    Ok(())
}

/// Each setting changes what is on the screen, and back.
fn overlay_looks(page: &mut Page) -> anyhow::Result<()> {
    // The double click on the ground was a click there too, which selects nothing.
    let on_object = page.mouse_place(ON_OBJECT)?;
    page.click(on_object, Button::Left, &[])?;
    page.key("f", &[])?;
    // Messages lie over the viewport, and go by themselves.
    without_messages(page)?;
    let plain = object_on_screen(page)?;
    page.set_overlay_opacity(0.2)?;
    let faint = object_on_screen(page)?;
    page.set_overlay_opacity(1.0)?;
    let again = object_on_screen(page)?;
    page.key("u", &[])?;
    let unlined = object_on_screen(page)?;
    page.key("u", &[])?;
    ensure!(plain == again, "Back at full opacity the picture is another one");
    ensure!(differing(&plain, &faint) > 2000, "The opacity changes {} pixels", differing(&plain, &faint));
    ensure!(differing(&plain, &unlined) > 200, "The outline is {} pixels", differing(&plain, &unlined));
    Ok(())
}

/// A square of the page around the middle of the viewport, where F has brought the object.
fn object_on_screen(page: &mut Page) -> anyhow::Result<image::RgbaImage> {
    let [x, y, width, height] = page.state()?.viewport.rect;
    let side = height * 0.8;
    let corner = (x + (width - side) / 2.0, y + (height - side) / 2.0);
    let screenshot = page.screenshot()?;
    let [x, y, side] = [corner.0, corner.1, side].map(|value| value as u32);
    Ok(image::imageops::crop_imm(&screenshot, x, y, side, side).to_image())
}

fn differing(a: &image::RgbaImage, b: &image::RgbaImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

/// With R a left drag turns, with M it moves again.
fn tools(page: &mut Page) -> anyhow::Result<()> {
    let before = page.state()?;
    let start = before.selected_pose()?.camera_from_object;
    page.key("r", &[])?;
    ensure!(page.state()?.selection.tool == "rotate", "R does not take the Rotate tool");
    let [x, y, width, height] = before.viewport.rect;
    let middle = ((x + width / 2.0).round(), (y + height / 2.0).round());
    page.drag(middle, (middle.0 + 40.0, middle.1), Button::Left, 2, &[])?;
    let turned = page.selected_pose()?.camera_from_object;
    ensure!(angle_between(&start, &turned) > 0.05, "With R a left drag did not turn the object");

    page.key("m", &[])?;
    ensure!(page.state()?.selection.tool == "move", "M does not take the Move tool");
    page.drag(middle, (middle.0 + 40.0, middle.1), Button::Left, 2, &[])?;
    let moved = page.selected_pose()?.camera_from_object;
    ensure!(
        angle_between(&turned, &moved) < 1e-7 && moved != turned,
        "With M a left drag did not move the object"
    );
    Ok(())
}

/// A reference is a dashed magenta line around its object's image, whether or not the user's own objects have lines.
pub fn reference(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let page = context.start("")?;
    page.drop_files(&linemod.files_of(linemod.sample(PHOTO)?)?)?;
    page.click_widget("Reference")?;
    page.wait_for_state(
        "state.references.length === 1 && state.objects.length === 1 && !state.busy",
        PATIENCE,
    )?;
    let lined = magenta_pixels(page)?;
    page.command("toggle_outline")?;
    let unlined = magenta_pixels(page)?;
    println!("   the reference is {lined} pixels, {unlined} without outlines");
    ensure!(lined > 50, "The reference is not drawn");
    ensure!(unlined > 50, "Without outlines the reference is gone");
    Ok(())
}

/// Pixels of the reference's colour around the true pose.
fn magenta_pixels(page: &mut Page) -> anyhow::Result<usize> {
    let (left, top) = page.page_from_image((190.0, 148.0))?;
    let (right, bottom) = page.page_from_image((253.0, 208.0))?;
    let screenshot = page.screenshot()?;
    let [left, top, right, bottom] = [left, top, right, bottom].map(|value| value as u32);
    let area = image::imageops::crop_imm(&screenshot, left, top, right - left, bottom - top).to_image();
    // The line is thin, so the photo shows through it; nothing else there has as much more red and blue than green.
    let is_magenta = |pixel: &image::Rgba<u8>| pixel[0].min(pixel[2]) > pixel[1].saturating_add(60);
    Ok(area.pixels().filter(|pixel| is_magenta(pixel)).count())
}
