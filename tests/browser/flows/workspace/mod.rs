//! The interface around the views, used with mouse and keys: panels, looks, handles, history, keys.

mod confirm;
mod export;
mod handles;
mod keys;
mod looks;
mod lost_graphics;
mod mask_import;
mod nudges;
mod objects;
mod output;
mod panels;
mod scene_view;

pub use confirm::confirm;
pub use export::export;
pub use handles::handles;
pub use keys::keys;
pub use looks::looks;
pub use lost_graphics::lost_graphics;
pub use mask_import::mask_import;
pub use nudges::nudges;
pub use objects::objects;
pub use output::output;
pub use panels::panels;
pub use scene_view::scene_view;

use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use image::RgbaImage;
use serde_json::{Value, json};

use super::without_messages;
use crate::api::{Matrix, PATIENCE, Widget};
use crate::context::Context;
use crate::data::{ball_ply, camera_file, disc_obj, flat_photo};
use crate::input::{Button, Modifier, Point};
use crate::page::Page;
use crate::poses::{Vector, axis_rotation, projected, with_translation};

/// Where nothing lies under the mouse that would light up, or tell anything.
const OUT_OF_THE_WAY: Point = (3.0, 597.0);

const BALL_RADIUS_MM: f32 = 25.0;
const BALL_AT: Vector = [-40.0, 5.0, 400.0];
const DISC_AT: Vector = [45.0, -5.0, 420.0];

const CHOOSERS_HEIGHT: f64 = 48.0;

/// Nudges less than half a second apart are one.
const BETWEEN_BURSTS: Duration = Duration::from_millis(700);

/// What `start_with_shapes` has put into the scene.
#[derive(Clone, Copy)]
struct Shapes {
    photo: u32,
    ball: u32,
    disc: u32,
}

/// Opens the page with a ball, which is selected, and a tilted disc before a photo of one colour.
fn start_with_shapes(context: &mut Context) -> anyhow::Result<(&mut Page, Shapes)> {
    let page = context.start("")?;
    page.load(&[
        flat_photo("first.png", [70, 74, 80])?,
        ball_ply("ball.ply", BALL_RADIUS_MM, 24, 12),
        disc_obj("disc.obj", [0.0; 3], 30.0, 24),
        camera_file("camera.json"),
    ])?;
    let state = page.state()?;
    let photo = state.shown_photo()?.id;
    let id_of = |mesh: &str| {
        let object = state.objects.iter().find(|object| object.mesh_file == mesh);
        object.map(|object| object.id).with_context(|| format!("{mesh} was not loaded"))
    };
    let shapes = Shapes { photo, ball: id_of("ball.ply")?, disc: id_of("disc.obj")? };
    page.set_pose(photo, shapes.disc, with_translation(axis_rotation(0, 0.5), DISC_AT))?;
    page.set_pose(photo, shapes.ball, with_translation(axis_rotation(1, 0.3), BALL_AT))?;
    select(page, shapes.ball)?;
    page.wait_until_saved()?;
    Ok((page, shapes))
}

fn select(page: &mut Page, object: u32) -> anyhow::Result<()> {
    page.eval(&format!("window.pinpose.command('select', {object}).then(() => true)"))?;
    Ok(())
}

/// All of the state, also what `State` does not read.
fn raw_state(page: &mut Page) -> anyhow::Result<Value> {
    page.eval("window.pinpose.state()")
}

/// An object's pose in the photo that is shown.
fn pose_of(page: &mut Page, object: u32) -> anyhow::Result<Matrix> {
    let state = page.state()?;
    let pose = state.shown_photo()?.poses.iter().find(|pose| pose.object == object);
    Ok(pose.context("The object is not in the photo")?.camera_from_object)
}

/// An object's entry in the state.
fn object_entry(page: &mut Page, object: u32) -> anyhow::Result<Value> {
    let state = raw_state(page)?;
    let mut entries = state["objects"].as_array().into_iter().flatten();
    entries.find(|entry| entry["id"] == json!(object)).cloned().context("The object is gone")
}

/// Where a point of an object's frame is on the page, in the photo view.
fn place_of(page: &mut Page, object: u32, point: Vector) -> anyhow::Result<Point> {
    let pose = pose_of(page, object)?;
    let k = page.state()?.shown_photo()?.k;
    page.mouse_place(projected(&k, &pose, point))
}

fn undo(page: &mut Page) -> anyhow::Result<()> {
    page.key("z", &[Modifier::Control])
}

/// Takes the mouse away, and gives the photo view as it is seen, without what lies over its top and its foot: the choosers
/// name what is chosen.
fn photo_view(page: &mut Page) -> anyhow::Result<RgbaImage> {
    let [x, y, width, height] = page.state()?.viewport.rect;
    clear_view(page)?;
    page.next_frame()?;
    area(page, [x, y + CHOOSERS_HEIGHT, width, height - 2.0 * CHOOSERS_HEIGHT])
}

/// The same of any rectangle of the page, once what moves in it has come to rest.
fn at_rest(page: &mut Page, rect: [f64; 4]) -> anyhow::Result<RgbaImage> {
    clear_view(page)?;
    let deadline = Instant::now() + PATIENCE;
    let mut before = area(page, rect)?;
    loop {
        page.next_frame()?;
        let now = area(page, rect)?;
        if now == before {
            return Ok(now);
        }
        ensure!(Instant::now() < deadline, "The picture does not come to rest");
        before = now;
    }
}

/// No mouse in the view, and no messages over it.
fn clear_view(page: &mut Page) -> anyhow::Result<()> {
    page.mouse_move(OUT_OF_THE_WAY)?;
    without_messages(page)
}

fn area(page: &mut Page, rect: [f64; 4]) -> anyhow::Result<RgbaImage> {
    let [x, y, width, height] = rect.map(|value| value.round().max(0.0) as u32);
    Ok(image::imageops::crop_imm(&page.screenshot()?, x, y, width, height).to_image())
}

fn differing(a: &RgbaImage, b: &RgbaImage) -> usize {
    if a.dimensions() != b.dimensions() {
        return a.pixels().len();
    }
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

/// Scrolls the side panel until a widget of it is in sight, and rests.
fn reveal(page: &mut Page, label: &str) -> anyhow::Result<Widget> {
    let deadline = Instant::now() + PATIENCE;
    let mut before = None;
    loop {
        let widgets = page.wait_for_widgets(&[label, "Fold output"])?;
        let find = |label: &str| widgets.iter().find(|widget| widget.label == label).cloned();
        let widget = find(label).context("The widget is gone")?;
        let bottom = find("Fold output").context("The output is gone")?.rect[1] - 16.0;
        let (_, y) = widget.center();
        ensure!(Instant::now() < deadline, "\"{label}\" does not come into sight");
        if before.replace(widget.rect) != Some(widget.rect) {
            // It has just come, or the panel is still scrolling.
        } else if y > 60.0 && y < bottom {
            return Ok(widget);
        } else {
            page.wheel((100.0, 250.0), if y < bottom { 1 } else { -1 }, &[])?;
        }
    }
}

/// Clicks a widget of the side panel.
fn click_in_panel(page: &mut Page, label: &str) -> anyhow::Result<()> {
    reveal(page, label)?;
    page.click_widget(label)
}

/// Puts a text into a field of the side panel, and leaves the field with Enter.
fn type_into(page: &mut Page, label: &str, text: &str) -> anyhow::Result<()> {
    click_in_panel(page, label)?;
    page.key("a", &[Modifier::Control])?;
    page.type_text(text)?;
    page.key("Enter", &[])
}

/// Pastes a text, as the browser would.
fn paste(page: &mut Page, text: &str) -> anyhow::Result<()> {
    page.eval(&format!(
        "(() => {{
            const clipboardData = new DataTransfer();
            clipboardData.setData('text', {});
            const event = new ClipboardEvent('paste', {{ clipboardData, bubbles: true, cancelable: true }});
            (document.activeElement ?? document.querySelector('canvas')).dispatchEvent(event);
        }})()",
        json!(text)
    ))?;
    page.next_frame()
}

/// Opens the menu at the end of a row, and clicks an entry of it.
fn row_menu(page: &mut Page, row: &str, entry: &str) -> anyhow::Result<()> {
    click_in_panel(page, &format!("More for {row}"))?;
    page.click_widget(entry)
}

/// Drags with the left button, by so much.
fn drag_by(page: &mut Page, from: Point, way: (f64, f64)) -> anyhow::Result<()> {
    page.drag(from, (from.0 + way.0, from.1 + way.1), Button::Left, 2, &[])
}

fn translation(pose: &Matrix) -> Vector {
    [pose[0][3], pose[1][3], pose[2][3]]
}

/// `count` × `count` places in a rectangle of the page, and which object is at each.
fn pick_all(
    page: &mut Page,
    [x, y, width, height]: [f64; 4],
    count: u32,
) -> anyhow::Result<Vec<(Point, u32)>> {
    let picked = page.eval(&format!(
        "Promise.all(Array.from({{ length: {count} * {count} }}, (_, index) => {{
            const x = Math.round({x} + {width} * (index % {count} + 0.5) / {count});
            const y = Math.round({y} + {height} * (Math.floor(index / {count}) + 0.5) / {count});
            return window.pinpose.pick(x, y).then((picked) => [[x, y], picked ? picked.object : null]);
        }}))"
    ))?;
    let picked: Vec<(Point, Option<u32>)> = serde_json::from_value(picked)?;
    Ok(picked.into_iter().filter_map(|(at, object)| Some((at, object?))).collect())
}

/// The middle of an object's picture in a rectangle of the page.
fn middle_of(page: &mut Page, rect: [f64; 4], object: u32) -> anyhow::Result<Point> {
    let picked = pick_all(page, rect, 40)?;
    let places: Vec<Point> = picked.into_iter().filter(|(_, at)| *at == object).map(|(at, _)| at).collect();
    ensure!(!places.is_empty(), "The object is not in sight");
    let count = places.len() as f64;
    let sum = places.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0, sum.1 + at.1));
    Ok(((sum.0 / count).round(), (sum.1 / count).round()))
}

/// A rectangle of the state by name, as `viewport` and `sceneViewport` have one.
fn rect_of(state: &Value, name: &str) -> anyhow::Result<[f64; 4]> {
    Ok(serde_json::from_value(state[name]["rect"].clone())?)
}
