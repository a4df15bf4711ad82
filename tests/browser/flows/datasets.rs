//! Data sets: a folder and a zip, dropped, chosen and opened.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use image::{GrayImage, ImageFormat, Luma};
use serde_json::{Value, json};

use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::{self, File, Skipped, ball_ply, flat_photo};
use crate::page::{Page, SIZE};

/// A BOP data set of real photographs, dropped as a folder: its photos, poses and a mask that is put to it.
pub fn folder(context: &mut Context) -> anyhow::Result<()> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/lmo16");
    if !source.is_dir() {
        return Err(Skipped("the data folder lmo16 is not here".to_owned()).into());
    }
    let folder = Folder::new("lmo16")?;
    copy(&source, &folder.0)?;
    let mask = GrayImage::from_fn(640, 480, |x, y| Luma([if x < 100 && y < 100 { 255 } else { 0 }]));
    let mut png = Cursor::new(Vec::new());
    mask.write_to(&mut png, ImageFormat::Png)?;
    folder.write("test/000002/mask_visib/000762_000000.png", png.get_ref())?;

    let page = context.start("empty")?;
    drop_folder(page, &folder.0)?;
    page.wait_for_widgets(&["lmo16", "BOP data set", "Masks (1)"])?;
    page.click_widget("Open")?;
    let state = page.wait_for_state("!state.busy && state.saved && state.photos.length === 16", PATIENCE)?;
    let poses: usize = state.photos.iter().map(|photo| photo.poses.len()).sum();
    ensure!((state.objects.len(), poses) == (8, 122), "{} objects, {poses} poses", state.objects.len());
    let truth: Value = serde_json::from_slice(&std::fs::read(source.join("test/000002/scene_gt.json"))?)?;
    let first = truth["762"][0]["cam_t_m2c"].as_array().context("No truth")?;
    let pose = state.photos[0].poses[0].camera_from_object;
    for (row, expected) in pose.iter().zip(first) {
        ensure!(row[3] == expected.as_f64().context("No number")?, "{pose:?} instead of {first:?}");
    }
    let raw: Value = page.eval("window.pinpose.state()")?;
    let masks = raw["photos"][0]["masks"].as_array().context("No masks")?;
    ensure!(masks.len() == 1 && masks[0]["object"] == state.photos[0].poses[0].object, "{masks:?}");
    let page = context.start("")?;
    page.wait_for_state("!state.busy && state.photos.length === 16", PATIENCE)?;
    Ok(())
}

/// The same as a zip, dropped twice: cancelled, and opened.
pub fn zip(context: &mut Context) -> anyhow::Result<()> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in made_scene(3, 0)? {
        writer.start_file(path, zip::write::SimpleFileOptions::default())?;
        writer.write_all(&bytes)?;
    }
    let file = File::new("lab.zip", writer.finish()?.into_inner());
    let page = context.start("empty")?;
    page.drop_files(std::slice::from_ref(&file))?;
    page.wait_for_widgets(&["lab.zip", "BOP data set"])?;
    page.click_widget("Cancel")?;
    page.wait_for_state("state.question === null || state.question === undefined", PATIENCE)?;
    page.drop_files(&[file])?;
    page.click_widget("Open")?;
    let state = page.wait_for_state("!state.busy && state.saved && state.photos.length === 3", PATIENCE)?;
    let poses: usize = state.photos.iter().map(|photo| photo.poses.len()).sum();
    ensure!((state.objects.len(), poses) == (1, 3), "{} objects, {poses} poses", state.objects.len());
    Ok(())
}

/// A scene of a thousand frames of 300 kB: it opens in seconds, and any of them can be looked at.
pub fn thousand_frames(context: &mut Context) -> anyhow::Result<()> {
    const FRAMES: u32 = 1000;
    let folder = Folder::new("thousand")?;
    for (path, bytes) in made_scene(FRAMES, 300_000)? {
        folder.write(&path, &bytes)?;
    }
    let page = context.start("empty")?;
    let start = Instant::now();
    drop_folder(page, &folder.0)?;
    page.wait_for_widgets(&["thousand", "Open"])?;
    let listed = start.elapsed().as_secs_f64();
    page.eval(
        "performance.clearMeasures(); window.longest = 0; new PerformanceObserver((list) => { \
        for (const task of list.getEntries()) window.longest = Math.max(window.longest, task.duration); \
        }).observe({ entryTypes: ['longtask'] })",
    )?;
    let start = Instant::now();
    page.click_widget("Open")?;
    let open =
        format!("window.pinpose.state().then((state) => !state.busy && state.photos.length === {FRAMES})");
    page.wait_until(&open, Duration::from_secs(120))?;
    let opened = start.elapsed().as_secs_f64();
    let longest = page.eval("window.longest")?.as_f64().unwrap_or_default();
    let last = page.state()?.photos.last().context("No photo")?.id;
    let start = Instant::now();
    page.eval(&format!("window.pinpose.command('show_photo', {last})"))?;
    page.wait_for_state(&format!("!state.busy && state.selection.photo === {last}"), PATIENCE)?;
    let shown = start.elapsed().as_secs_f64();
    let megabytes = page.perf()?.memory_bytes / 1e6;
    println!(
        "   {FRAMES} frames: dialog after {listed:.1} s, open after {opened:.1} s, the last one shown after {shown:.1} s, \
         longest task {longest:.0} ms, {megabytes:.0} MB"
    );
    // Ten times what it takes on a free machine.
    ensure!(opened < 60.0, "It takes {opened:.1} s to open");
    Ok(())
}

/// A BOP scene of flat photos, each with so many bytes after its end and one object in it.
fn made_scene(frames: u32, surplus: usize) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let photo = flat_photo("", [90, 100, 110])?.bytes;
    let noise = data::noise(surplus);
    let mut files = vec![("models/obj_000001.ply".to_owned(), ball_ply("", 40.0, 24, 12).bytes)];
    let (mut truth, mut cameras) = (serde_json::Map::new(), serde_json::Map::new());
    for frame in 0..frames {
        let mut bytes = [photo.as_slice(), &noise].concat();
        bytes.extend(frame.to_le_bytes());
        files.push((format!("test/000001/rgb/{frame:06}.png"), bytes));
        let pose = json!({ "obj_id": 1, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 500 + frame] });
        truth.insert(frame.to_string(), json!([pose]));
        let [[fx, ..], [_, fy, cy], _] = data::CAMERA;
        let k = [fx, 0.0, data::CAMERA[0][2], 0.0, fy, cy, 0.0, 0.0, 1.0];
        cameras.insert(frame.to_string(), json!({ "cam_K": k, "depth_scale": 1 }));
    }
    files.push(("test/000001/scene_gt.json".to_owned(), Value::from(truth).to_string().into_bytes()));
    files.push(("test/000001/scene_camera.json".to_owned(), Value::from(cameras).to_string().into_bytes()));
    Ok(files)
}

/// Drags a folder of the disk over the page and lets it go, as the browser does it.
fn drop_folder(page: &mut Page, folder: &Path) -> anyhow::Result<()> {
    let data = json!({ "items": [], "files": [folder], "dragOperationsMask": 1 });
    for kind in ["dragEnter", "dragOver", "drop"] {
        let (x, y) = (SIZE.0 / 2, SIZE.1 / 2);
        page.call("Input.dispatchDragEvent", json!({ "type": kind, "x": x, "y": y, "data": data }))?;
    }
    page.next_frame()
}

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> anyhow::Result<Self> {
        let path = std::env::temp_dir().join(format!("pinpose-datasets-{}", std::process::id())).join(name);
        std::fs::create_dir_all(&path)?;
        Ok(Self(path))
    }

    fn write(&self, path: &str, bytes: &[u8]) -> anyhow::Result<()> {
        let path = self.0.join(path);
        std::fs::create_dir_all(path.parent().context("No folder")?)?;
        Ok(std::fs::write(path, bytes)?)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            std::fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
