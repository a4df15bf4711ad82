//! No way to lose an annotation: a browser that is killed while it saves, storage that is full, two tabs with one scene, and
//! a database that was damaged.

use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use image::{ImageFormat, Rgb, RgbImage};
use serde_json::json;

use crate::api::{Matrix, PATIENCE, State, Widget};
use crate::context::Context;
use crate::data::{File, camera_file, disc_obj, flat_photo, noise};
use crate::input::{Button, Modifier};
use crate::page::Page;
use crate::poses::{axis_rotation, unprojected, with_translation};

/// So many rounds, each with a kill at another moment.
const KILLS: u32 = 6;

/// Photos of noise, which nothing can pack: this many bytes each.
const BIG_PHOTO: (u32, u32) = (1600, 1200);
const BIG_PHOTO_BYTES: usize = 3 * 1600 * 1200;

/// Each round a big photo comes in and the pose is changed, and the browser is killed somewhere around the save: what comes
/// back is the scene before, between or after, as a whole, and it can be worked on.
pub fn killed(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let mut before = small_scene(page)?;
    // Moments spread over the save; not chance, so that a failure comes again.
    for round in 0..KILLS {
        let page = context.page()?;
        page.drop_files(&[big_photo(&format!("big_{round}.bmp"), round)?])?;
        let count = before.photos.len() + 1;
        let added = page.wait_for_state(&format!("state.photos.length === {count}"), PATIENCE)?;
        let photo = added.photos.iter().find(|photo| !photo.poses.is_empty()).context("No pose")?;
        let object = photo.poses[0].object;
        let place = with_translation(axis_rotation(0, 0.0), [f64::from(round), 3.0, 600.0]);
        let mut changed = added.clone();
        for photo in changed.photos.iter_mut().filter(|candidate| candidate.id == photo.id) {
            photo.poses[0].camera_from_object = place;
        }
        // From here on nothing is asked of the page: an answer would take as long as the save.
        page.set_pose(photo.id, object, place)?;
        let moment = Duration::from_millis(u64::from(round) * 120);
        std::thread::sleep(moment);
        page.kill()?;

        let page = context.start("")?;
        let back = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
        let states = [("old", &before), ("with the photo", &added), ("new", &changed)];
        let found = states.into_iter().find(|(_, state)| work(state) == work(&back));
        let (name, _) = found.with_context(|| {
            format!("Round {round}: neither of the states came back, but {:?}", back.scene())
        })?;
        println!("   killed {moment:?} after the change: {name}");
        ensure!(back.notices.is_empty(), "It came back with {:?}", back.notices);
        // Every photo of it can be shown, so its bytes are there.
        for photo in &back.photos {
            page.eval(&format!("window.pinpose.command('show_photo', {})", photo.id))?;
            let picture = page.render_png("overlay")?;
            ensure!(!picture.is_empty(), "{} cannot be drawn", photo.file);
        }
        before = page.wait_until_saved()?;
    }
    Ok(())
}

/// A photo that does not fit is said at once; everything can be downloaded; saving goes on when there is room.
pub fn full(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    // What is kept for offline use takes room too, until then.
    page.wait_until("navigator.serviceWorker.ready.then((it) => it.active.state === 'activated')", PATIENCE)?;
    let used = page.eval("navigator.storage.estimate().then((it) => it.usage)")?;
    let used = used.as_f64().context("No usage")?;
    let origin = page.eval("location.origin")?;
    // Room for one big photo, not for two. It has to be set before anything is stored: the browser remembers for half a minute
    // how much room there was.
    let quota = json!({ "origin": origin, "quotaSize": used + BIG_PHOTO_BYTES as f64 * 1.5 });
    page.call("Storage.overrideQuotaForOrigin", quota)?;
    // Another scene, which takes room.
    page.drop_files(&[big_photo("other.bmp", 9)?])?;
    page.wait_for_state("state.photos.length === 1 && state.saved", PATIENCE)?;
    page.command("new_scene")?;
    page.wait_for_state("state.photos.length === 0 && !state.busy", PATIENCE)?;
    small_scene(page)?;

    let start = Instant::now();
    page.drop_files(&[big_photo("big.bmp", 1)?])?;
    page.wait_for_state("state.photos.length === 2", PATIENCE)?;
    page.wait_for_state("state.notices.some((it) => it.includes('storage is full'))", PATIENCE)?;
    println!("   said {:.1} s after the drop", start.elapsed().as_secs_f64());
    // The console may say so too.
    page.forget_errors()?;
    page.click_widget("Download everything")?;
    let download = page.download(PATIENCE)?;
    let names = names_in(&download.bytes)?;
    for wanted in ["scene.json", "big.bmp", "small.png", "disc.obj"] {
        ensure!(names.iter().any(|name| name.ends_with(wanted)), "{wanted} is not in {names:?}");
    }
    // It is stored as it is: noise cannot be packed.
    ensure!(download.bytes.len() > BIG_PHOTO_BYTES, "The photo is not whole");

    // The other scene is deleted, which makes room; nothing else has to be done.
    choose_scene(page, "other, 1 photo")?;
    page.click_widget("Delete")?;
    page.click_widget("Delete it")?;
    // Files that are gone make room after a while; a disk that was emptied elsewhere does so at once.
    page.call("Storage.overrideQuotaForOrigin", json!({ "origin": origin }))?;
    let saved = page.wait_for_state("state.saved", PATIENCE)?;
    page.reload()?;
    page.wait_until_ready()?;
    let back = page.wait_for_state("!state.busy && state.photos.length === 2", PATIENCE)?;
    ensure!(work(&back) == work(&saved), "{:?} came back as {:?}", saved.scene(), back.scene());
    page.forget_errors()
}

/// Two tabs open one scene: the second is told, and what is changed there goes into a copy.
pub fn two_tabs(context: &mut Context) -> anyhow::Result<()> {
    let address = context.address("");
    let page = context.start("")?;
    small_scene(page)?;
    let first_tab = page.open_tab(&address)?;
    page.wait_until_ready()?;
    page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    page.wait_for_state("state.notices.some((it) => it.includes('open in another window'))", PATIENCE)?;
    // Both go on at the same time.
    nudge(page)?;
    nudge(page)?;
    let copy = page
        .wait_for_state("state.saved && state.notices.some((it) => it.includes('goes on as'))", PATIENCE)?;
    let second_tab = page.switch_to(first_tab)?;
    nudge(page)?;
    let original = page.wait_until_saved()?;
    ensure!(copy.selected_pose()? != original.selected_pose()?, "Both are the same");
    page.reload()?;
    page.wait_until_ready()?;
    let back = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    ensure!(work(&back) == work(&original), "The first tab came back as {:?}", back.scene());
    page.switch_to(second_tab)?;
    page.reload()?;
    page.wait_until_ready()?;
    let back = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    ensure!(work(&back) == work(&copy), "The second tab came back as {:?}", back.scene());
    Ok(())
}

/// Records that are cut, missing or something else: the page starts, shows what can be shown, offers the rest as a file, and
/// leaves other scenes alone.
pub fn damaged(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    page.drop_files(&[flat_photo("other.png", [20, 90, 40])?, disc_obj("other.obj", [0.0; 3], 30.0, 12)])?;
    page.wait_for_state("state.objects.length === 1 && state.saved", PATIENCE)?;
    let other = page.wait_until_saved()?;
    page.command("new_scene")?;
    page.wait_for_state("state.photos.length === 0 && !state.busy", PATIENCE)?;
    let whole = small_scene(page)?;
    page.eval(KEEP_COPY)?;

    for (what, damage) in DAMAGES {
        // No program that could save in between.
        let page = context.start("bare")?;
        page.eval(&format!("{USE_COPY}.then((database) => ({damage})(database))"))
            .with_context(|| format!("{what} could not be made"))?;
        let page = context.start("")?;
        let state = page.wait_for_state("!state.busy", PATIENCE)?;
        println!(
            "   {what}: {} photos, {} objects, {:?}",
            state.photos.len(),
            state.objects.len(),
            state.notices
        );
        let is_whole = work(&state) == work(&whole);
        if !is_whole {
            page.click_widget("Download what is stored").with_context(|| what.to_owned())?;
            let download = page.download(PATIENCE)?;
            let names = names_in(&download.bytes)?;
            println!("      {}: {names:?}", download.name);
            ensure!(names.len() >= 2, "{what}: only {names:?} is offered");
        }
        // Work here, and a save that cleans up, take nothing from what is there.
        let before = stored_bytes(page)?;
        page.drop_files(&[flat_photo("next.png", [1, 2, 3])?])?;
        page.wait_for_state("state.photos.some((it) => it.file === 'next.png') && state.saved", PATIENCE)?;
        ensure!(stored_bytes(page)? >= before, "{what}: a save has removed files");
        // The other scene opens as it was.
        choose_scene(page, "other, 1 photo").with_context(|| what.to_owned())?;
        page.click_widget("Open")?;
        let opened = page.wait_for_state("!state.busy && state.photos[0]?.file === 'other.png'", PATIENCE)?;
        ensure!(work(&opened) == work(&other), "{what}: the other scene is {:?}", opened.scene());
    }
    Ok(())
}

/// What is done to the database, as functions of it; `scene` is the key of the small scene.
const DAMAGES: &[(&str, &str)] = &[
    (
        "A document cut in half",
        "(it) => it.change('documents', it.scene, (document) => ({ ...document, json: document.json.slice(0, document.json.length / 2) }))",
    ),
    ("A document that is a number", "(it) => it.change('documents', it.scene, () => 5)"),
    ("A missing document", "(it) => it.remove('documents', it.scene)"),
    ("A missing heading", "(it) => it.remove('scenes', it.scene)"),
    ("A heading that is a text", "(it) => it.change('scenes', it.scene, () => 'garbage')"),
    ("A missing photo", "(it) => it.remove('assets', it.assets[0])"),
    (
        "A mesh whose bytes are a list",
        "(it) => it.change('assets', it.assets[1], (asset) => ({ ...asset, bytes: [1, 2, 3] }))",
    ),
    (
        "A photo that was cut",
        "(it) => it.change('assets', it.assets[0], (asset) => ({ ...asset, bytes: asset.bytes.slice(0, 40) }))",
    ),
];

/// Puts a copy of the database aside, in another one.
const KEEP_COPY: &str = r#"(async () => {
    const done = (request) => new Promise((resolve, reject) => {
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
    });
    const database = await done(indexedDB.open('pinpose'));
    const copy = {};
    for (const name of ['scenes', 'documents', 'assets', 'state']) {
        const store = database.transaction(name).objectStore(name);
        const [keys, values] = await Promise.all([done(store.getAllKeys()), done(store.getAll())]);
        copy[name] = keys.map((key, index) => [key, values[index]]);
    }
    database.close();
    const opening = indexedDB.open('copy', 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore('copy');
    const aside = await done(opening);
    const writing = aside.transaction('copy', 'readwrite');
    writing.objectStore('copy').put(copy, 'copy');
    await new Promise((resolve) => { writing.oncomplete = resolve; });
    aside.close();
    return true;
})()"#;

/// Makes the database what it was when the copy was made; a promise of what [`DAMAGES`] work with.
const USE_COPY: &str = r#"(async () => {
    const done = (request) => new Promise((resolve, reject) => {
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
    });
    const aside = await done(indexedDB.open('copy'));
    const copy = await done(aside.transaction('copy').objectStore('copy').get('copy'));
    aside.close();
    localStorage.clear();
    const database = await done(indexedDB.open('pinpose'));
    const write = (work) => new Promise((resolve, reject) => {
        const writing = database.transaction(['scenes', 'documents', 'assets', 'state'], 'readwrite');
        work((name) => writing.objectStore(name));
        writing.oncomplete = () => resolve(true);
        writing.onerror = () => reject(writing.error);
    });
    await write((store) => {
        for (const [name, records] of Object.entries(copy)) {
            store(name).clear();
            for (const [key, value] of records) store(name).put(value, key);
        }
    });
    const [scene] = copy.scenes.find(([, heading]) => heading.subject === 'small');
    const [, document] = copy.documents.find(([key]) => key === scene);
    const end = async (working) => { await working; database.close(); return true; };
    return {
        scene,
        assets: document.assets,
        change(name, key, make) {
            const [, value] = copy[name].find(([candidate]) => candidate === key);
            return end(write((store) => store(name).put(make(value), key)));
        },
        remove: (name, key) => end(write((store) => store(name).delete(key))),
    };
})()"#;

fn stored_bytes(page: &mut Page) -> anyhow::Result<u64> {
    let bytes = page.eval(
        "new Promise((resolve, reject) => {
            const opening = indexedDB.open('pinpose');
            opening.onerror = () => reject(opening.error);
            opening.onsuccess = () => {
                const reading = opening.result.transaction('assets').objectStore('assets').getAll();
                reading.onsuccess = () => {
                    opening.result.close();
                    resolve(reading.result.reduce((sum, asset) => sum + (asset.bytes?.length ?? 0), 0));
                };
            };
        })",
    )?;
    bytes.as_u64().context("No sum")
}

/// A photo with an object in it, saved.
fn small_scene(page: &mut Page) -> anyhow::Result<State> {
    let disc = disc_obj("disc.obj", [0.0; 3], 20.0, 24);
    page.drop_files(&[flat_photo("small.png", [70, 74, 80])?, disc, camera_file("camera.json")])?;
    let state = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    let (photo, object) = (state.shown_photo()?, state.selection.object.context("No object")?);
    let center = unprojected(&photo.k, (320.0, 240.0), 600.0);
    page.set_pose(photo.id, object, with_translation(axis_rotation(0, 0.0), center))?;
    page.wait_until_saved()
}

/// Errors stay on the page until they are read, and may lie over what is to be clicked.
fn close_messages(page: &mut Page) -> anyhow::Result<()> {
    while !page.state()?.notices.is_empty() {
        page.click_widget("Close message")?;
        page.next_frame()?;
    }
    Ok(())
}

/// Opens the list of scenes, and selects the one whose row begins so.
fn choose_scene(page: &mut Page, row: &str) -> anyhow::Result<()> {
    close_messages(page)?;
    page.key("o", &[Modifier::Control, Modifier::Shift])?;
    // A row says how long ago its scene was changed: it is found by its beginning, where it is seen twice.
    let deadline = Instant::now() + PATIENCE;
    let mut before = None;
    loop {
        let widgets = page.wait_for_widgets(&["Scenes", "Duplicate"])?;
        let now = widgets.iter().find(|widget| widget.label.starts_with(row)).map(Widget::center);
        match (before, now) {
            (Some(before), Some(now)) if before == now => return page.click(now, Button::Left, &[]),
            _ => before = now,
        }
        ensure!(Instant::now() < deadline, "{row} is not listed");
    }
}

fn names_in(zip: &[u8]) -> anyhow::Result<Vec<String>> {
    let zip = zip::ZipArchive::new(std::io::Cursor::new(zip))?;
    let names: Result<Vec<String>, _> = zip.file_names().map(|name| name.map(String::from)).collect();
    Ok(names?)
}

/// A small change of the selected pose, by the keyboard.
fn nudge(page: &mut Page) -> anyhow::Result<()> {
    let [x, y, width, height] = page.state()?.viewport.rect;
    page.mouse_move((x + width / 2.0, y + height / 2.0))?;
    let before = page.selected_pose()?;
    page.key("ArrowRight", &[])?;
    let deadline = Instant::now() + PATIENCE;
    while page.selected_pose()? == before {
        ensure!(Instant::now() < deadline, "The key did nothing");
    }
    Ok(())
}

/// An object's name, and its pose.
type NamedPose = (String, Matrix);

/// What must not be lost: every photo with its poses, every object; the ids are given anew.
fn work(state: &State) -> Vec<(String, Vec<NamedPose>)> {
    let name = |id: u32| {
        state.objects.iter().find(|object| object.id == id).map(|object| object.mesh_sha256.clone())
    };
    let photo = |photo: &crate::api::Photo| {
        let poses =
            photo.poses.iter().map(|pose| (name(pose.object).unwrap_or_default(), pose.camera_from_object));
        (photo.sha256.clone(), poses.collect())
    };
    state.photos.iter().map(photo).collect()
}

fn big_photo(name: &str, seed: u32) -> anyhow::Result<File> {
    let (width, height) = BIG_PHOTO;
    let bytes = noise(BIG_PHOTO_BYTES);
    let mut picture = RgbImage::from_raw(width, height, bytes).context("Too few bytes")?;
    // Each is another file.
    picture.put_pixel(0, 0, Rgb([seed as u8, 1, 2]));
    let mut bmp = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bmp, ImageFormat::Bmp)?;
    Ok(File::new(name, bmp.into_inner()))
}
