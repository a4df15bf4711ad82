//! Files that cannot be read and calls that make no sense: each is one clear message, and nothing else happens.

use anyhow::{Context as _, ensure};
use serde_json::json;

use crate::api::{PATIENCE, State};
use crate::context::Context;
use crate::data::{File, ball_ply, camera_file, disc_obj, flat_photo, noise};
use crate::page::Page;
use crate::poses::{axis_rotation, with_translation};

/// Each bad file by a drop and by a call, then one together with a good one.
pub fn bad_files(context: &mut Context) -> anyhow::Result<()> {
    let (page, before) = start_with_disc(context)?;
    for file in bad_ones()? {
        refuse(page, &file, &before).with_context(|| file.name.clone())?;
    }
    bad_beside_good(page)
}

fn start_with_disc(context: &mut Context) -> anyhow::Result<(&mut Page, State)> {
    let page = context.start("")?;
    let disc = disc_obj("disc.obj", [0.0; 3], 20.0, 24);
    page.load(&[flat_photo("flat.png", [70, 74, 80])?, disc, camera_file("camera.json")])?;
    let state = page.state()?;
    let object = state.selection.object.context("No object is selected")?;
    page.set_pose(
        state.shown_photo()?.id,
        object,
        with_translation(axis_rotation(0, 0.4), [5.0, -7.0, 300.0]),
    )?;
    let state = page.wait_until_saved()?;
    Ok((page, state))
}

fn bad_ones() -> anyhow::Result<Vec<File>> {
    let camera = json!({ "fx": 0, "fy": 500, "cx": 320, "cy": 240, "width": 640, "height": 480 });
    let newer = json!({ "format": "pinpose", "version": 99, "photos": [] });
    Ok(vec![
        flat_photo("", [9, 9, 9])?.cut("cut.png", 0.6),
        File::new("empty.ply", ""),
        File::new("words.png", "a photo of a cat"),
        ball_ply("", 10.0, 12, 6).cut("cut.ply", 0.7),
        File::new("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"),
        File::new("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        File::new("faceless.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        File::new("zero.json", camera.to_string()),
        File::new("newer.json", newer.to_string()),
        File::new("garbage.zip", noise(3000)),
        File::new("random.bin", noise(3000)),
    ])
}

/// A drop and a call give the same message, which is shown once.
fn refuse(page: &mut Page, file: &File, before: &State) -> anyhow::Result<()> {
    page.drop_files(std::slice::from_ref(file))?;
    let dropped = page.wait_for_state("!state.busy && state.notices.length > 0", PATIENCE)?;
    check_refused(file, before, &dropped)?;
    println!("   {}", dropped.notices[0]);

    let loaded = page.load(std::slice::from_ref(file))?;
    ensure!(loaded.files == 0 && loaded.problems == dropped.notices, "The call's answer is {loaded:?}");
    check_refused(file, before, &page.state()?)?;
    close_message(page)
}

fn check_refused(file: &File, before: &State, after: &State) -> anyhow::Result<()> {
    let [message] = after.notices.as_slice() else {
        anyhow::bail!("{} messages: {:?}", after.notices.len(), after.notices)
    };
    ensure!(message.contains(&file.name), "\"{message}\" does not name the file");
    ensure!(after.scene() == before.scene(), "The scene has changed");
    Ok(())
}

/// Errors stay until they are closed, by the mouse.
fn close_message(page: &mut Page) -> anyhow::Result<()> {
    page.click_widget("Close message")?;
    page.wait_for_state("state.notices.length === 0", PATIENCE)?;
    Ok(())
}

fn bad_beside_good(page: &mut Page) -> anyhow::Result<()> {
    page.drop_files(&[File::new("words.png", "no photo"), flat_photo("second.png", [120, 30, 30])?])?;
    let after = page.wait_for_state("!state.busy && state.notices.length > 0", PATIENCE)?;
    ensure!(after.photos.iter().any(|photo| photo.file == "second.png"), "The good file was not loaded");
    ensure!(after.photos.len() == 2 && after.notices.len() == 1, "{after:?}");
    close_message(page)
}

/// `setPose` takes proper poses of what there is; everything else is an `Error`, and changes nothing.
pub fn bad_calls(context: &mut Context) -> anyhow::Result<()> {
    let (page, before) = start_with_disc(context)?;
    let (photo, object) = (before.shown_photo()?.id, before.selected_pose()?.object);
    let matrix = |first: &str| format!("[[{first}, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 300], [0, 0, 0, 1]]");
    let good = matrix("1");
    let calls = [
        format!("setPose({photo}, {object}, {})", matrix("NaN")),
        format!("setPose({photo}, {object}, {})", matrix("-1")),
        format!("setPose({photo}, {object}, {})", matrix("'1'")),
        format!("setPose({photo}, {object}, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 300]])"),
        format!("setPose({photo}, {object})"),
        format!("setPose({}, {object}, {good})", photo + 77),
        format!("setPose({photo}, {}, {good})", object + 77),
        format!("setPose({photo}, {object} + 0.5, {good})"),
        "command('make_coffee')".to_owned(),
        "command('redo')".to_owned(),
        "pageFromImage('left', 3)".to_owned(),
        format!("render({{ kind: 'painting', object: {object} }})"),
        "load([{ name: 'nothing.png' }])".to_owned(),
    ];
    let mut accepted = Vec::new();
    for call in calls {
        let error = page.eval(&format!(
            "window.pinpose.{call}.then(() => '', (error) => error instanceof Error ? error.message : '')"
        ))?;
        match error.as_str() {
            Some("") | None => accepted.push(call),
            Some(message) => println!("   {call}: {message}"),
        }
    }
    ensure!(accepted.is_empty(), "Not rejected with an Error: {}", accepted.join("; "));
    ensure!(page.state()?.scene() == before.scene(), "A rejected call has changed the scene");
    Ok(())
}
