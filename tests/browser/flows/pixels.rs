//! Where a projected point is drawn on the real page: screenshots against arithmetic.

use anyhow::{Context as _, ensure};
use image::RgbaImage;

use crate::api::{Matrix, PATIENCE};
use crate::context::Context;
use crate::data::{self, CAMERA, disc_obj};
use crate::input::Point;
use crate::page::Page;
use crate::poses::{axis_rotation, distance_px, placed, product, projected, unprojected};

/// The design's promise at any zoom. What is measured is bounded by four samples a pixel, along the disc's rim.
const WITHIN_PX: f64 = 0.1;

const PHOTO_COLOR: [u8; 3] = [70, 74, 80];

/// Off its own origin, so that a wrong order of rotation and translation shows.
const DISC_CENTER_MM: [f64; 3] = [11.0, -4.0, 7.0];
const DISC_RADIUS_MM: f64 = 3.0;
const DISC_DEPTH_MM: f64 = 240.0;

/// Off the pixels' grid, in different parts of the photo.
const PLACES: [Point; 3] = [(318.27, 236.81), (143.62, 120.45), (487.5, 351.08)];

/// Notches of the wheel from a fitted photo to about eight screen pixels a photo pixel, at a factor of 1.2 each.
const NOTCHES: i32 = 10;

/// A disc that faces the camera is an ellipse whose centre is the image of its centre.
pub fn pixels(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let mut disc = disc_obj("disc.obj", DISC_CENTER_MM, DISC_RADIUS_MM, 96);
    // So small a mesh would be taken for one in centimetres.
    disc.bytes.splice(..0, *b"# units: mm\n");
    page.load(&[data::flat_photo("flat.png", PHOTO_COLOR)?, disc, data::camera_file("camera.json")])?;
    page.command("toggle_outline")?;
    // The viewport as wide as the page shows the photo at about its own size.
    page.command("toggle_panels")?;
    let state = page.wait_for_state("!state.viewport.panels && !state.busy && state.saved", PATIENCE)?;
    let (photo, object) = (state.shown_photo()?, state.selection.object.context("No disc")?);
    ensure!(photo.k == CAMERA, "K is {:?}", photo.k);
    for (place, rotation) in PLACES.into_iter().zip(rotations()) {
        let target = unprojected(&CAMERA, place, DISC_DEPTH_MM);
        let pose = placed(rotation, DISC_CENTER_MM, target);
        page.set_pose(photo.id, object, pose)?;
        measure(page, &pose)?;
        let at = page.mouse_place(place)?;
        page.wheel(at, NOTCHES, &[])?;
        measure(page, &pose)?;
        page.command("fit_photo")?;
    }
    Ok(())
}

/// They keep the disc's plane parallel to the image's.
fn rotations() -> [[[f64; 3]; 3]; 3] {
    let about_axis = axis_rotation(2, 0.5);
    let turned_over = axis_rotation(0, std::f64::consts::PI);
    [axis_rotation(2, 0.0), about_axis, product(&about_axis, &turned_over)]
}

fn measure(page: &mut Page, pose: &Matrix) -> anyhow::Result<()> {
    let expected = page.page_from_image(projected(&CAMERA, pose, DISC_CENTER_MM))?;
    let zoom = page.state()?.viewport.zoom;
    let radius = CAMERA[0][0] * DISC_RADIUS_MM / DISC_DEPTH_MM * zoom;
    let screenshot = page.screenshot()?;
    let found = centroid(&screenshot, expected, radius * 1.2 + 4.0)?;
    let error_px = distance_px(found, expected);
    println!("   zoom {zoom:.2}: drawn {error_px:.3} px from where it belongs");
    ensure!(
        error_px < WITHIN_PX,
        "At zoom {zoom} the disc is drawn at {found:?}, it belongs at {expected:?}"
    );
    Ok(())
}

/// The middle of what differs from the photo, weighted by coverage, in CSS pixels.
fn centroid(screenshot: &RgbaImage, near: Point, reach: f64) -> anyhow::Result<Point> {
    let span = |middle: f64| ((middle - reach).floor() as u32)..=((middle + reach).ceil() as u32);
    let mut differences = Vec::new();
    for y in span(near.1) {
        for x in span(near.0) {
            let pixel = screenshot.get_pixel_checked(x, y).context("The disc is outside the page")?;
            let difference =
                (0..3).map(|c| f64::from(pixel[c]) - f64::from(PHOTO_COLOR[c])).map(f64::abs).sum();
            // A CSS pixel's centre is half a pixel from its corner.
            differences.push((f64::from(x) + 0.5, f64::from(y) + 0.5, difference));
        }
    }
    // Shading changes slowly over the disc; only at its rim does a smaller difference mean less coverage.
    let full: f64 = differences.iter().map(|&(_, _, difference)| difference).fold(0.0, f64::max);
    ensure!(full > 60.0, "No disc is near {near:?}");
    let coverage = |difference: f64| if difference > 0.93 * full { 1.0 } else { difference / full };
    let total: f64 = differences.iter().map(|&(_, _, difference)| coverage(difference)).sum();
    let mean = |axis: fn(&(f64, f64, f64)) -> f64| {
        differences.iter().map(|pixel| axis(pixel) * coverage(pixel.2)).sum::<f64>() / total
    };
    Ok((mean(|pixel| pixel.0), mean(|pixel| pixel.1)))
}
