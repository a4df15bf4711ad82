//! A mask file comes in as a mask of the photo that is shown, and is a tint over it.

use anyhow::ensure;
use image::{GrayImage, ImageFormat, Luma};

use super::{click_in_panel, differing, photo_view, raw_state, start_with_shapes};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::{File, PHOTO_SIZE};

pub fn mask_import(context: &mut Context) -> anyhow::Result<()> {
    let (page, _) = start_with_shapes(context)?;
    let before = photo_view(page)?;
    let (width, height) = PHOTO_SIZE;
    // A rectangle at the photo's right, where no object is.
    let inside = |x: u32, y: u32| x > width * 3 / 4 && y > height / 2;
    let mask = GrayImage::from_fn(width, height, |x, y| Luma([if inside(x, y) { 255 } else { 0 }]));
    let mut png = std::io::Cursor::new(Vec::new());
    mask.write_to(&mut png, ImageFormat::Png)?;
    page.load(&[File::new("corner_mask.png", png.into_inner())])?;
    page.wait_for_state("state.photos.length === 1 && state.photos[0].masks?.length === 1", PATIENCE)?;
    let name = raw_state(page)?["photos"][0]["masks"][0]["name"].as_str().unwrap_or_default().to_owned();
    let tinted = photo_view(page)?;
    let count = differing(&before, &tinted);
    println!("   {name} tints {count} pixels");
    ensure!(count > 5000, "The mask tints {count} pixels");
    click_in_panel(page, &format!("Hide {name}"))?;
    page.wait_for_widgets(&[&format!("Show {name}")])?;
    ensure!(photo_view(page)? == before, "Hidden the mask is still seen");
    click_in_panel(page, &format!("Show {name}"))?;
    page.wait_for_widgets(&[&format!("Hide {name}")])?;
    ensure!(photo_view(page)? == tinted, "Shown again the mask looks different");
    // It is saved with the scene.
    page.wait_until_saved()?;
    page.reload()?;
    page.wait_until_ready()?;
    page.wait_for_state("!state.busy && state.photos[0]?.masks?.length === 1", PATIENCE)?;
    Ok(())
}
