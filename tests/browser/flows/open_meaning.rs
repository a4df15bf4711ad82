//! Files whose meaning is open: meshes that do not say their unit, and photos that the browser alone can read.

use anyhow::{Context as _, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;

use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::{File, camera_file, disc_obj, flat_photo};
use crate::page::Page;

/// 48 × 32 pixels of (40, 90, 160), its top left quarter (200, 60, 30); written by Pillow 13.
const AVIF: &str = "AAAAIGZ0eXBhdmlmAAAAAGF2aWZtaWYxbWlhZk1BMUIAAADrbWV0YQAAAAAAAAAhaGRscgAAAAAAAAAAcGljdAAAAAAAAAAAAAAAAAAAAAAOcG\
    l0bQAAAAAAAQAAAB5pbG9jAAAAAEQAAAEAAQAAAAEAAAETAAAAWQAAAChpaW5mAAAAAAABAAAAGmluZmUCAAAAAAEAAGF2MDFDb2xvcgAAAABq\
    aXBycAAAAEtpcGNvAAAAFGlzcGUAAAAAAAAAMAAAACAAAAAQcGl4aQAAAAADCAgIAAAADGF2MUOBAAwAAAAAE2NvbHJuY2x4AAEADQAGgAAAAB\
    dpcG1hAAAAAAAAAAEAAQQBAoMEAAAAYW1kYXQSAAoJGBUv+0QENBoQMkoSB/f2qQCCCD5AAADuIYdsy74BzFW3S7IHArjX/PQpFBnxPRw+xgls\
    6bKQmIZfoLkEiWacifJsTmE2elEIqlkNwS9YqRB4aPiXfg==";
/// The same, with a palette.
const GIF: &str = "R0lGODdhMAAgAIEAAMg8HihaoAAAAAAAACwAAAAAMAAgAEAIawABCBxIsKDBgQESKlzIsKHCgxAjOpxIsaLFixgzatzIMKLHghwdfhwJIKTJky\
    hTniT5UWUAlh5dwpSociZElzhz6tzJs6dOmwdlAgVZcyhBoUYFIk261GjToU+B+pxKtarVq1izat3K9WJAADs=";

const MOST_OFF: f64 = 1e-6;

/// A disc of 0.12 without a unit is taken to be in metres; the card changes it, and it is saved.
pub fn mesh_units(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let disc = disc_obj("disc.obj", [0.0; 3], 0.06, 24);
    page.drop_files(&[flat_photo("flat.png", [70, 74, 80])?, disc.clone(), camera_file("camera.json")])?;
    page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    page.wait_for_widgets(&["In which unit is disc?", "The longest side would be 120 mm."])?;
    ensure!((unit_in_mm(page)? - 1000.0).abs() < MOST_OFF, "It is taken as {} mm", unit_in_mm(page)?);
    ensure!(page.state()?.selected_pose()?.state == "untouched", "Nothing waits for the answer");
    let far = page.selected_pose()?.camera_from_object[2][3];
    page.click_widget("Centimetres")?;
    page.wait_for_state("state.objects[0].mesh_from_file[0][0] === 10", PATIENCE)?;
    let near = page.selected_pose()?.camera_from_object[2][3];
    println!("   a disc of 0.12: at {far:.1} mm in metres, {near:.1} mm in centimetres");
    // Coordinates have seven digits.
    ensure!((far / near - 100.0).abs() < 1e-3, "It was not placed again: {far} mm, then {near} mm");
    page.command("undo")?;
    ensure!((unit_in_mm(page)? - 1000.0).abs() < MOST_OFF, "Not undone");
    page.wait_until_saved()?;
    page.reload()?;
    page.wait_until_ready()?;
    page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    ensure!((unit_in_mm(page)? - 1000.0).abs() < MOST_OFF, "The unit was not saved");
    let asked = page.widgets()?.iter().any(|widget| widget.label.starts_with("In which unit"));
    ensure!(!asked, "A saved scene knows its units");
    Ok(())
}

/// The length in millimetres of one unit of the first mesh's file.
fn unit_in_mm(page: &mut Page) -> anyhow::Result<f64> {
    let found = page.eval("window.pinpose.state().then((state) => state.objects[0].mesh_from_file[0][0])")?;
    found.as_f64().context("no number")
}

/// An AVIF and a GIF are opened with the browser's help, kept as PNG, and come back after a reload.
pub fn foreign_photos(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let file = |name: &str, text: &str| anyhow::Ok(File::new(name, BASE64.decode(text)?));
    page.drop_files(&[file("first.avif", AVIF)?, file("second.gif", GIF)?])?;
    page.wait_for_state("!state.busy && state.photos.length === 2", PATIENCE)?;
    let before = page.wait_until_saved()?;
    let names: Vec<&str> = before.photos.iter().map(|photo| photo.file.as_str()).collect();
    ensure!(names == ["first.png", "second.png"], "The photos are {names:?}");
    for said in ["first.avif: read by the browser and kept as first.png", "second.gif"] {
        ensure!(before.notices.iter().any(|notice| notice.contains(said)), "{said}: {:?}", before.notices);
    }
    // Quality 90 is off by a few steps, the palette by none.
    check_colors(page, 4)?;
    page.command("next_photo")?;
    check_colors(page, 0)?;
    page.reload()?;
    page.wait_until_ready()?;
    let after = page.wait_for_state("!state.busy && state.photos.length === 2", PATIENCE)?;
    ensure!(after.photos == before.photos, "Reloaded, the photos are {:?}", after.photos);

    // A kind that this browser does not read either is refused in words.
    let heic = File::new("third.heic", b"\0\0\0\x1cftypheic\0\0\0\0mif1heic".as_slice());
    page.drop_files(&[heic])?;
    let refused = page.wait_for_state("!state.busy && state.notices.length > 0", PATIENCE)?;
    println!("   {}", refused.notices.join("; "));
    ensure!(
        refused.notices.iter().any(|notice| notice.contains("third.heic") && notice.contains("HEIC")),
        "Not said"
    );
    ensure!(refused.photos == after.photos, "The photos have changed");
    Ok(())
}

/// The exported overlay of a scene without objects is the photo.
fn check_colors(page: &mut Page, most_off: i32) -> anyhow::Result<()> {
    let picture = image::load_from_memory(&page.render_png("overlay")?)?.to_rgb8();
    ensure!(picture.dimensions() == (48, 32), "The photo has {:?} pixels", picture.dimensions());
    for (x, y, expected) in [(4, 4, [200, 60, 30]), (40, 28, [40, 90, 160])] {
        let found = picture.get_pixel(x, y).0;
        let off = found.iter().zip(expected).map(|(a, b)| (i32::from(*a) - b).abs()).max().unwrap_or(0);
        ensure!(off <= most_off, "At ({x}, {y}) the colour is {found:?}");
    }
    Ok(())
}
