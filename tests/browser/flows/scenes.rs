//! Named scenes in the browser's storage: switching, coming back, closing in mid-drag, and databases of other versions.

use anyhow::ensure;

use super::start_with_sample;
use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::{Linemod, camera_file, disc_obj, flat_photo};
use crate::input::{Button, Point};
use crate::page::Page;

/// A place of the sample's object, as in the flow `path`.
const ON_OBJECT: Point = (221.0, 180.0);

/// Two scenes by mouse: a new one beside the first, back to the first, and after a reload the one that was open.
pub fn scenes(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let disc = disc_obj("disc.obj", [0.0; 3], 20.0, 24);
    page.drop_files(&[flat_photo("first.png", [70, 74, 80])?, disc.clone(), camera_file("camera.json")])?;
    page.wait_for_state("state.objects.length === 1", PATIENCE)?;
    let first = page.wait_until_saved()?;

    page.click_widget("Saved")?;
    page.click_widget("New scene")?;
    page.wait_for_state("!state.busy && state.photos.length === 0", PATIENCE)?;
    // The welcome screen offers the first one, and says when it was changed.
    let widgets = page.wait_for_widgets(&["Go on with"])?;
    let is_offered = widgets.iter().any(|widget| widget.label.starts_with("first"));
    ensure!(is_offered, "The first scene is not offered");
    page.drop_files(&[flat_photo("second.png", [120, 30, 30])?, disc])?;
    page.wait_for_state("state.objects.length === 1", PATIENCE)?;
    let second = page.wait_until_saved()?;
    ensure!(stored_keys(page, "assets")? == 3, "The mesh is not shared");

    open_scene(page, "first, 1 photo")?;
    let back = page.wait_for_state("!state.busy && state.photos[0]?.file === 'first.png'", PATIENCE)?;
    ensure!(back.scene() == first.scene(), "{:?} came back as {:?}", first.scene(), back.scene());

    page.wait_until_saved()?;
    page.reload()?;
    page.wait_until_ready()?;
    let restored = page.wait_for_state("!state.busy && state.photos.length === 1", PATIENCE)?;
    ensure!(restored.scene() == first.scene(), "After a reload {:?} is open", restored.scene());
    open_scene(page, "second, 1 photo")?;
    let back = page.wait_for_state("!state.busy && state.photos[0]?.file === 'second.png'", PATIENCE)?;
    ensure!(back.scene() == second.scene(), "{:?} came back as {:?}", second.scene(), back.scene());

    // The example has a scene of its own, and the next visit does not begin with it.
    page.wait_until_saved()?;
    let page = context.start("example")?;
    page.wait_for_state("!state.busy && state.photos.length > 0 && state.saved", PATIENCE)?;
    let page = context.start("")?;
    let mine = page.wait_for_state("!state.busy && state.photos.length > 0", PATIENCE)?;
    ensure!(mine.scene() == second.scene(), "After the example {:?} is open", mine.scene());
    Ok(())
}

/// The page is closed while the second drag goes on, and the first could not be stored: only the second is lost.
pub fn mid_drag(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let (page, _) = start_with_sample(context, &linemod)?;
    page.eval("IDBDatabase.prototype.transaction = () => { throw new DOMException('full', 'QuotaExceededError'); }, 1")?;
    let from = page.mouse_place(ON_OBJECT)?;
    let to = (from.0 + 40.0, from.1 + 25.0);
    page.drag(from, to, Button::Left, 2, &[])?;
    page.wait_for_state("state.notices.some((notice) => notice.startsWith('Not saved'))", PATIENCE)?;
    page.wait_for_widgets(&["Download"])?;
    page.mouse_down(to, Button::Left)?;
    let settled = page.state()?;
    page.mouse_move_holding((to.0 + 15.0, to.1), Button::Left)?;
    page.mouse_move_holding((to.0 + 30.0, to.1), Button::Left)?;
    let dragged = page.state()?;
    ensure!(dragged.selected_pose()? != settled.selected_pose()?, "The second drag did not begin");
    page.reload()?;
    page.wait_until_ready()?;
    let restored = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    let (kept, wanted) = (restored.selected_pose()?, settled.selected_pose()?);
    ensure!(
        kept.camera_from_object == wanted.camera_from_object,
        "{wanted:?} was settled, {kept:?} came back"
    );
    page.wait_until_saved()?;
    let journals =
        page.eval("Object.keys(localStorage).filter((key) => key.startsWith('pinpose journal')).length")?;
    ensure!(journals == 0, "The journal was not removed");
    Ok(())
}

/// What version 1 has stored in its two slots comes back as scenes.
pub fn version_1(context: &mut Context) -> anyhow::Result<()> {
    // A scene to have documents and assets of, taken back to what version 1 had.
    let page = context.start("")?;
    page.drop_files(&[flat_photo("old.png", [70, 74, 80])?, disc_obj("disc.obj", [0.0; 3], 20.0, 24)])?;
    page.wait_for_state("state.objects.length === 1", PATIENCE)?;
    let saved = page.wait_until_saved()?;
    // No program that could save in between.
    context.start("bare")?.eval(TO_VERSION_1)?;
    let page = context.start("")?;
    let restored = page.wait_for_state("!state.busy && state.photos.length === 1", PATIENCE)?;
    ensure!(restored.scene() == saved.scene(), "{:?} came back as {:?}", saved.scene(), restored.scene());
    ensure!(stored_keys(page, "scenes")? == 2, "Not both slots came back");
    // Work goes on in it.
    page.drop_files(&[flat_photo("new.png", [10, 14, 80])?])?;
    page.wait_for_state("state.photos.length === 2 && state.saved", PATIENCE)?;
    ensure!(stored_keys(page, "assets")? == 3, "Assets are missing");
    Ok(())
}

/// A database of a PinPose to come is left alone, and that is said.
pub fn newer_version(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("bare")?;
    page.eval(
        "new Promise((resolve, reject) => {
            const opening = indexedDB.open('pinpose', 99);
            opening.onupgradeneeded = () => opening.result.createObjectStore('hyperscenes');
            opening.onerror = () => reject(opening.error);
            opening.onsuccess = () => { opening.result.close(); resolve(true); };
        })",
    )?;
    let page = context.start("")?;
    page.wait_for_state("state.notices.some((notice) => notice.includes('a newer PinPose'))", PATIENCE)?;
    page.drop_files(&[flat_photo("photo.png", [70, 74, 80])?])?;
    page.wait_for_state("state.photos.length === 1", PATIENCE)?;
    page.wait_for_widgets(&["Download"])?;
    Ok(())
}

fn open_scene(page: &mut Page, row: &str) -> anyhow::Result<()> {
    page.click_widget("Saved")?;
    let widgets = page.wait_for_widgets(&["Scenes", "Duplicate"])?;
    ensure!(widgets.iter().any(|widget| widget.label.starts_with(row)), "{row} is not listed");
    let label = widgets.into_iter().map(|widget| widget.label).find(|label| label.starts_with(row));
    page.click_widget(&label.unwrap_or_default())?;
    page.click_widget("Open")
}

/// How many values are in a store.
fn stored_keys(page: &mut Page, store: &str) -> anyhow::Result<u64> {
    let count = page.eval(&format!(
        "new Promise((resolve, reject) => {{
            const opening = indexedDB.open('pinpose');
            opening.onerror = () => reject(opening.error);
            opening.onsuccess = () => {{
                const counting = opening.result.transaction('{store}').objectStore('{store}').count();
                counting.onsuccess = () => {{ opening.result.close(); resolve(counting.result); }};
            }};
        }})"
    ))?;
    Ok(count.as_u64().unwrap_or_default())
}

/// Makes of the database what version 1 would have: the scene in both slots, and nothing that says more about them.
const TO_VERSION_1: &str = r#"(async () => {
    const done = (request) => new Promise((resolve, reject) => {
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
    });
    const now = await done(indexedDB.open('pinpose'));
    const reading = now.transaction(['documents', 'assets']);
    const [document] = await done(reading.objectStore('documents').getAll());
    const keys = await done(reading.objectStore('assets').getAllKeys());
    const assets = await done(reading.objectStore('assets').getAll());
    now.close();
    await done(indexedDB.deleteDatabase('pinpose'));
    const opening = indexedDB.open('pinpose', 1);
    opening.onupgradeneeded = () => {
        opening.result.createObjectStore('documents');
        opening.result.createObjectStore('assets');
    };
    const old = await done(opening);
    const writing = old.transaction(['documents', 'assets'], 'readwrite');
    writing.objectStore('documents').put(document, 'current');
    writing.objectStore('documents').put(document, 'example');
    keys.forEach((key, index) => writing.objectStore('assets').put(assets[index], key));
    await new Promise((resolve) => { writing.oncomplete = resolve; });
    old.close();
    return true;
})()"#;
