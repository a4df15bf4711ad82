//! What is large: fine meshes, many photos, a photo of many pixels.

use std::time::Instant;

use anyhow::{Context as _, ensure};
use image::GenericImageView as _;

use super::idle::{Cost, cost_of_dragging};
use crate::api::{PATIENCE, Photo, files_expression};
use crate::context::Context;
use crate::data::{self, ball_ply, camera_file, camera_file_of, flat_photo, large_photo};
use crate::page::Page;
use crate::poses::{axis_rotation, unprojected, with_translation};

/// Enough for a median that one slow frame does not move.
const STEPS: u32 = 12;

/// Room for the object's sphere between its neighbours.
const RADIUS_MM: f32 = 30.0;
const DEPTH_MM: f64 = 600.0;

/// A step's share of the processor. On a machine with nothing else to do it is a few milliseconds; a software renderer
/// takes its processors from the page.
const MOST_CPU_MS: f64 = 10.0;

/// A hundredth: an upload less or more at the ends of the drag.
const SAME: f64 = 1.01;

/// What lies below the meshes is drawn once to be kept, of two parts, and composed of two parts until then. On a slow machine
/// that falls into the drag.
const ONCE: f64 = 4.0 / STEPS as f64 + 1e-9;

/// An object's uniforms as they are uploaded.
const BYTES_PER_OBJECT: f64 = 256.0;

/// Ten objects of 50 000 triangles cost what one of 10 000 does, but for their uniforms and draw calls.
pub fn drag_ten(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let one = drag(page, "One object of 10 000 triangles", &[(100, 51)])?;
    let ten_small = drag(page, "Ten objects of 10 000 triangles", &[(100, 51); 10])?;
    let ten = drag(page, "Ten objects of 50 000 triangles", &[(200, 126); 10])?;
    ensure!(ten.bytes <= ten_small.bytes * SAME, "Uploads depend on the meshes");
    ensure!(ten.mesh_draws() <= ten_small.mesh_draws() + ONCE, "Draw calls depend on the meshes");
    ensure!(ten.bytes <= one.bytes * SAME + 9.0 * BYTES_PER_OBJECT, "More is uploaded than uniforms");
    // Each object in the two passes of surfaces and silhouettes.
    ensure!(
        ten.mesh_draws() <= one.mesh_draws() + 9.0 * 2.0 + ONCE,
        "An object has more than two draw calls"
    );
    compare(&one, &ten)
}

/// A million triangles cost what ten thousand do.
pub fn drag_million(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let small = drag(page, "One object of 10 000 triangles", &[(100, 51)])?;
    let large = drag(page, "One object of 1 000 000 triangles", &[(1000, 501)])?;
    ensure!(large.bytes <= small.bytes * SAME, "Uploads depend on the mesh");
    ensure!(large.mesh_draws() <= small.mesh_draws() + ONCE, "Draw calls depend on the mesh");
    compare(&small, &large)
}

fn compare(small: &Cost, large: &Cost) -> anyhow::Result<()> {
    println!("   processor time a frame, large to small: {:.2}", large.cpu_ms / small.cpu_ms);
    ensure!(
        large.cpu_ms <= MOST_CPU_MS,
        "A frame of a drag takes {:.2} ms of the page's processor",
        large.cpu_ms
    );
    Ok(())
}

/// Loads a ball for each number of segments and rings, puts them side by side, and drags the last one.
fn drag(page: &mut Page, what: &str, balls: &[(u32, u32)]) -> anyhow::Result<Cost> {
    if !page.state()?.objects.is_empty() {
        page.command("new_scene")?;
    }
    let mut files = vec![flat_photo("flat.png", [70, 74, 80])?, camera_file("camera.json")];
    // Of different sizes: the same file is the same object.
    files.extend((0_u8..).zip(balls).map(|(number, &(segments, rings))| {
        let radius_mm = RADIUS_MM + 0.1 * f32::from(number);
        ball_ply(&format!("ball_{number}.ply"), radius_mm, segments, rings)
    }));
    let start = Instant::now();
    let loaded = page.load(&files)?;
    ensure!(loaded.problems.is_empty(), "{}", loaded.problems.join("; "));
    let load_seconds = start.elapsed().as_secs_f64();
    let state = page.state()?;
    ensure!(state.objects.len() == balls.len(), "{} objects were loaded", state.objects.len());
    let photo = state.shown_photo()?.id;
    for (number, object) in (0_u8..).zip(&state.objects) {
        let place = (80.0 + 110.0 * f64::from(number % 5), 150.0 + 150.0 * f64::from(number / 5));
        let center = unprojected(&data::CAMERA, place, DEPTH_MM);
        page.set_pose(photo, object.id, with_translation(axis_rotation(0, 0.0), center))?;
    }
    let state = page.wait_until_saved()?;
    let last = state.objects.last().context("No object")?.id;
    let poses = &state.shown_photo()?.poses;
    let pose = poses.iter().find(|pose| pose.object == last).context("No pose")?;
    let cost = cost_of_dragging(page, &pose.camera_from_object, STEPS)?;
    println!("   {what} (loaded in {load_seconds:.1} s): {cost}");
    ensure!(cost.triangles > 0.0, "Nothing was drawn");
    Ok(cost)
}

/// On a machine with nothing else to do, and how many times that is a failure: what else runs is not the page's fault.
const FIRST_FRAME_SECONDS: f64 = 1.5;
const LONGEST_TASK_MS: f64 = 200.0;
const MOST_TIMES_AS_LONG: f64 = 8.0;

/// A million triangles are dropped: how long until they are on screen, what holds up the page meanwhile, and its memory.
pub fn drop_million(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    page.drop_files(&[flat_photo("flat.png", [70, 74, 80])?, camera_file("camera.json")])?;
    page.wait_for_state("!state.busy && state.photos.length === 1 && state.saved", PATIENCE)?;
    let before = page.perf()?;
    // The file is brought to the page before the clock runs, as it would be on a disk.
    let file = ball_ply("million.ply", RADIUS_MM, 1000, 501);
    let megabytes = file.bytes.len() as f64 / 1e6;
    page.eval(&format!("window.million = {}, 1", files_expression(&[file])))?;
    let took = page.eval(
        "(async () => {
            const tasks = [];
            const observer = new PerformanceObserver((list) => tasks.push(...list.getEntries()));
            observer.observe({ type: 'longtask' });
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(window.million[0]);
            const canvas = document.querySelector('canvas');
            const start = performance.now();
            for (const type of ['dragenter', 'dragover', 'drop']) {
                canvas.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
            }
            const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
            while ((await window.pinpose.state()).objects.length === 0) await frame();
            // The frame after that shows it. A page may be two frames ahead of the screen, so when the one after those
            // begins, the first is seen.
            for (let ahead = 0; ahead < 4; ahead += 1) await frame();
            const seconds = (performance.now() - start) / 1000;
            // What follows by itself: the thumbnail, the save.
            while (!(await window.pinpose.state()).saved) await frame();
            await new Promise((resolve) => setTimeout(resolve, 500));
            observer.disconnect();
            return [seconds, ...tasks.map((task) => task.duration)];
        })()",
    )?;
    let took: Vec<f64> = serde_json::from_value(took)?;
    let (seconds, tasks) = took.split_first().context("No time was taken")?;
    let mut tasks = tasks.to_vec();
    tasks.sort_by(|a, b| b.total_cmp(a));
    let longest = tasks.first().copied().unwrap_or_default();
    let after = page.perf()?;
    println!(
        "   1 000 000 triangles ({megabytes:.1} MB): first frame {seconds:.2} s after the drop, longest tasks {:.0?} ms, \
         wasm memory {:.0} MB before, {:.0} MB after",
        &tasks[..tasks.len().min(5)],
        before.memory_bytes / 1e6,
        after.memory_bytes / 1e6
    );
    let [x, y, width, height] = page.state()?.viewport.rect;
    let drawn = page.pick((x + width / 2.0, y + height / 2.0))?;
    ensure!(drawn.is_some(), "The object is not in the middle of the page");
    ensure!(*seconds <= FIRST_FRAME_SECONDS * MOST_TIMES_AS_LONG, "The first frame took {seconds:.1} s");
    ensure!(longest <= LONGEST_TASK_MS * MOST_TIMES_AS_LONG, "A task of {longest:.0} ms held up the page");
    Ok(())
}

/// The page's memory with all photos, of which it keeps the encoded files, the pixels of some, and small copies.
const MOST_MEMORY_BYTES: f64 = 600e6;

pub fn many_photos(context: &mut Context) -> anyhow::Result<()> {
    step_through(context, 40)
}

pub fn very_many_photos(context: &mut Context) -> anyhow::Result<()> {
    step_through(context, 200)
}

/// Has the page make photos of noise, half a megabyte each as PNG, and load them; their bytes together.
fn load_noise(page: &mut Page, count: u32) -> anyhow::Result<f64> {
    const PORTION: u32 = 20;
    let mut bytes = 0.0;
    for first in (0..count).step_by(PORTION as usize) {
        let expression = noise_expression(first, (first + PORTION).min(count));
        bytes += page.eval(&expression)?.as_f64().context("The photos were not loaded")?;
    }
    Ok(bytes)
}

fn noise_expression(first: u32, end: u32) -> String {
    let (width, height) = data::PHOTO_SIZE;
    format!(
        "(async () => {{
            const canvas = new OffscreenCanvas({width}, {height});
            const context = canvas.getContext('2d');
            let bytes = 0;
            for (let number = {first}; number < {end}; number++) {{
                const image = new ImageData({width}, {height});
                for (let i = 0; i < image.data.length; i++) image.data[i] = 96 + Math.random() * 32;
                for (let i = 3; i < image.data.length; i += 4) image.data[i] = 255;
                context.putImageData(image, 0, 0);
                const blob = await canvas.convertToBlob({{ type: 'image/png' }});
                bytes += blob.size;
                const name = `photo_${{String(number).padStart(3, '0')}}.png`;
                const loaded = await window.pinpose.load([new File([blob], name)]);
                if (loaded.problems.length) throw new Error(loaded.problems.join('; '));
            }}
            return bytes;
        }})()"
    )
}

/// Goes through all photos, and looks at all in the strip.
fn step_through(context: &mut Context, count: u32) -> anyhow::Result<()> {
    let page = context.start("")?;
    let empty_bytes = page.perf()?.memory_bytes;
    let file_bytes = load_noise(page, count)?;
    let state = page.wait_until_saved()?;
    ensure!(state.photos.len() == count as usize, "{} photos are open", state.photos.len());
    let loaded_bytes = page.perf()?.memory_bytes;

    page.eval(&format!("window.pinpose.command('show_photo', {})", state.photos[0].id))?;
    let start = Instant::now();
    for Photo { id, .. } in &state.photos[1..] {
        page.key("n", &[])?;
        page.wait_for_state(&format!("state.selection.photo === {id}"), PATIENCE)?;
    }
    let step_ms = start.elapsed().as_secs_f64() * 1000.0 / f64::from(count - 1);
    // The last one is decoded by then.
    let overlay = image::load_from_memory(&page.render_png("overlay")?)?;
    ensure!(overlay.dimensions() == data::PHOTO_SIZE, "The picture is {:?}", overlay.dimensions());

    let widgets = page.widgets()?;
    let cell = widgets.iter().find(|widget| widget.label.starts_with("Photo photo_"));
    let over = cell.context("The strip is not on the page")?.center();
    // Back over all, a few cells at once.
    for _ in 0..count {
        page.wheel(over, 2, &[])?;
    }
    page.wait_for_widgets(&["Photo photo_000.png, not posed yet"])?;
    let perf = page.perf()?;
    println!(
        "   {count} photos of {:.0} kB: {:.0} MB of wasm memory empty, {:.0} loaded, {:.0} when all were seen; \
         {step_ms:.0} ms a step",
        file_bytes / f64::from(count) / 1e3,
        empty_bytes / 1e6,
        loaded_bytes / 1e6,
        perf.memory_bytes / 1e6,
    );
    ensure!(perf.memory_bytes > 0.0, "The memory was not measured");
    ensure!(perf.memory_bytes <= MOST_MEMORY_BYTES, "{count} photos take {:.0} MB", perf.memory_bytes / 1e6);
    Ok(())
}

/// A photo of twelve megapixels is shown, zoomed into, and exported as large as it is.
pub fn large_photo_flow(context: &mut Context) -> anyhow::Result<()> {
    const SIZE: (u32, u32) = (4000, 3000);
    let page = context.start("")?;
    let photo = large_photo("large.jpg", SIZE)?;
    let kilobytes = photo.bytes.len() as f64 / 1e3;
    let scale = f64::from(SIZE.0) / f64::from(data::PHOTO_SIZE.0);
    let start = Instant::now();
    page.load(&[photo, ball_ply("ball.ply", 50.0, 71, 41), camera_file_of("camera.json", SIZE, scale)])?;
    let state = page.wait_for_state("!state.busy", PATIENCE)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let photo = state.shown_photo()?;
    ensure!(photo.k[0][0] == data::CAMERA[0][0] * scale, "K is {:?}", photo.k);
    let object = state.selection.object.context("No object")?;
    // In the photo's middle.
    let center = unprojected(&photo.k, (2000.0, 1500.0), DEPTH_MM);
    page.set_pose(photo.id, object, with_translation(axis_rotation(0, 0.0), center))?;
    let fitted = page.wait_until_saved()?.viewport.zoom;

    let at = page.mouse_place((1010.0, 760.0))?;
    let before = page.image_from_page(at)?;
    page.wheel(at, 12, &[])?;
    let zoomed = page.wait_for_state(&format!("state.viewport.zoom > {}", fitted * 5.0), PATIENCE)?;
    let after = page.image_from_page(at)?;
    // A wheel keeps what is under it, to the rounding of numbers.
    let moved = ((after.0 - before.0).powi(2) + (after.1 - before.1).powi(2)).sqrt();
    ensure!(moved < 1e-6, "The zoom moved the photo by {moved} pixels");
    let screenshot = page.screenshot()?;
    let pixel = screenshot.get_pixel(at.0 as u32, at.1 as u32).0;
    let expected = data::large_photo_color(before.0 as u32, before.1 as u32);
    // JPEG's losses where there is no edge.
    let is_near = pixel.iter().zip(expected).all(|(seen, expected)| seen.abs_diff(expected) <= 12);
    ensure!(is_near, "{pixel:?} is shown, {expected:?} was expected");

    let start = Instant::now();
    let overlay = image::load_from_memory(&page.render_png("overlay")?)?.into_rgb8();
    let export_seconds = start.elapsed().as_secs_f64();
    ensure!(overlay.dimensions() == SIZE, "The picture is {:?}", overlay.dimensions());
    for (x, y) in [(30, 40), (3970, 2960), (1010, 760)] {
        let (seen, expected) = (overlay.get_pixel(x, y).0, data::large_photo_color(x, y));
        let is_near = seen.iter().zip(expected).all(|(seen, expected)| seen.abs_diff(expected) <= 12);
        ensure!(is_near, "({x}, {y}) is {seen:?}, {expected:?} was expected");
    }
    let (middle, bare) = (overlay.get_pixel(2000, 1500).0, data::large_photo_color(2000, 1500));
    ensure!(
        middle.iter().zip(bare).any(|(seen, bare)| seen.abs_diff(bare) > 12),
        "No object is in the picture"
    );
    println!(
        "   {kilobytes:.0} kB, loaded in {load_seconds:.1} s, zoom {fitted:.3} to {:.3}, overlay in {export_seconds:.1} s, \
         {:.0} MB of wasm memory",
        zoomed.viewport.zoom,
        page.perf()?.memory_bytes / 1e6
    );
    Ok(())
}
