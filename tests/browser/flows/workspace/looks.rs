//! How the meshes are drawn over the photo, and what helps to compare: each changes pixels, and goes away without a trace.

use anyhow::ensure;
use image::RgbaImage;

use super::{click_in_panel, differing, photo_view, raw_state, reveal};
use crate::context::Context;
use crate::data::{File, Linemod};
use crate::flows::start_with_sample;
use crate::input::Button;
use crate::page::Page;
use crate::poses::with_translation;

const MODES: [&str; 8] = ["shaded", "colors", "nocs", "normals", "depth", "outline", "edges", "wireframe"];

/// Of the object's some 10 000 pixels.
const LEAST_DIFFERENCE: usize = 100;

pub fn looks(context: &mut Context) -> anyhow::Result<()> {
    let (page, state) = start_with_sample(context, &Linemod::open()?)?;
    // Something behind the object, for X-ray.
    page.load(&[painted()])?;
    let photo = state.shown_photo()?.id;
    let before = state.selected_pose()?;
    let ball = page.state()?.objects.iter().map(|object| object.id).find(|id| *id != before.object);
    let ball = ball.ok_or_else(|| anyhow::anyhow!("The ball was not loaded"))?;
    let [right, down, away] = [0, 1, 2].map(|axis| before.camera_from_object[axis][3]);
    let behind = [right + 30.0, down, away + 60.0];
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    page.set_pose(photo, ball, with_translation([x, y, z], behind))?;
    super::select(page, before.object)?;
    page.key("f", &[])?;

    let plain = modes(page)?;
    held(page, &plain)?;
    for (key, what) in [("j", "wipe"), ("k", "difference"), ("z", "X-ray"), ("u", "outline")] {
        there_and_back(page, &plain, what, |page| page.key(key, &[]), |page| page.key(key, &[]))?;
    }
    there_and_back(
        page,
        &plain,
        "photo only and mesh only",
        |page| page.key("i", &[]),
        |page| page.key("i", &[]).and_then(|()| page.key("i", &[])),
    )?;
    let rail = |page: &mut Page| {
        let widget = reveal(page, "Photo brightness")?;
        anyhow::Ok((widget.rect[0] + 75.0, widget.center().1))
    };
    there_and_back(
        page,
        &plain,
        "brightness",
        |page| {
            let at = rail(page)?;
            page.click(at, Button::Left, &[])
        },
        |page| {
            let at = rail(page)?;
            page.double_click(at, Button::Left)
        },
    )?;
    // Several at once, and all back by one click.
    there_and_back(
        page,
        &plain,
        "reset",
        |page| page.key("k", &[]).and_then(|()| page.key("o", &[])),
        |page| click_in_panel(page, "Reset look"),
    )
}

/// A square of four colours, that reaches out from behind the sample's object.
fn painted() -> File {
    let corners = [("-50 -50", "1 0 0"), ("50 -50", "0 1 0"), ("50 50", "0 0 1"), ("-50 50", "1 1 0")];
    let vertices = corners.map(|(place, color)| format!("v {place} 0 {color}\n"));
    File::new("painted.obj", vertices.concat() + "f 1 2 3\nf 1 3 4\n")
}

/// O goes through all modes; each picture is unlike every other. Gives the first.
fn modes(page: &mut Page) -> anyhow::Result<RgbaImage> {
    let mut pictures = Vec::new();
    for mode in MODES {
        let shown = raw_state(page)?["view"]["overlay_mode"].clone();
        ensure!(shown == mode, "{shown} is shown in place of {mode}");
        pictures.push(photo_view(page)?);
        page.key("o", &[])?;
    }
    let left = differing(&pictures[0], &photo_view(page)?);
    ensure!(left == 0, "After all modes {left} pixels of the first one are different");
    let mut least = (usize::MAX, "", "");
    for (index, a) in pictures.iter().enumerate() {
        for (other, b) in pictures.iter().enumerate().take(index) {
            least = least.min((differing(a, b), MODES[other], MODES[index]));
        }
    }
    println!("   the modes most alike: {} pixels between {} and {}", least.0, least.1, least.2);
    ensure!(least.0 > LEAST_DIFFERENCE, "{} and {} are {} pixels apart", least.1, least.2, least.0);
    Ok(pictures.swap_remove(0))
}

/// H hides as long as it is held.
fn held(page: &mut Page, before: &RgbaImage) -> anyhow::Result<()> {
    page.key_down("h")?;
    let hidden = photo_view(page)?;
    page.key_up("h")?;
    let after = photo_view(page)?;
    let count = differing(before, &hidden);
    println!("   H held: {count} pixels changed");
    ensure!(count > LEAST_DIFFERENCE, "H hides nothing");
    ensure!(after == *before, "After H the picture is another one");
    Ok(())
}

fn there_and_back(
    page: &mut Page,
    before: &RgbaImage,
    what: &str,
    there: impl FnOnce(&mut Page) -> anyhow::Result<()>,
    back: impl FnOnce(&mut Page) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    there(page)?;
    let changed = photo_view(page)?;
    back(page)?;
    let after = photo_view(page)?;
    let (count, left) = (differing(before, &changed), differing(before, &after));
    println!("   {what}: {count} pixels changed");
    ensure!(count > LEAST_DIFFERENCE, "{what} changes {count} pixels");
    ensure!(left == 0, "After {what} {left} pixels are not back");
    Ok(())
}
