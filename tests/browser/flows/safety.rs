//! What keeps the work safe: offline use, and the crash screen.

use anyhow::ensure;

use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::{camera_file, disc_obj, flat_photo};
use crate::input::Button;
use crate::page::Page;

/// After one visit the page opens without a network, with what was saved.
pub fn offline(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    let disc = disc_obj("disc.obj", [0.0; 3], 20.0, 24);
    page.drop_files(&[flat_photo("flat.png", [70, 74, 80])?, disc, camera_file("camera.json")])?;
    page.wait_for_state("state.objects.length === 1", PATIENCE)?;
    let saved = page.wait_until_saved()?;
    let picture = page.render_png("overlay")?;
    page.wait_until("navigator.serviceWorker.ready.then((it) => it.active.state === 'activated')", PATIENCE)?;

    context.stop_server();
    let page = context.page()?;
    let online = page.eval("fetch('build.json').then(() => 'online', () => 'offline')")?;
    ensure!(online == "offline", "Still online");
    // The failed request above is meant to fail.
    page.forget_errors()?;
    page.reload()?;
    page.wait_until_ready()?;
    let restored = page.wait_for_state("!state.busy && state.objects.length === 1", PATIENCE)?;
    ensure!(restored.scene() == saved.scene(), "{:?} came back as {:?}", saved.scene(), restored.scene());
    // The photo is decoded in a worker, which has to start offline too.
    ensure!(page.render_png("overlay")? == picture, "The picture is another one offline");
    // So do files that are dropped now.
    page.drop_files(&[flat_photo("second.png", [120, 30, 30])?])?;
    page.wait_for_state("state.photos.length === 2", PATIENCE)?;
    Ok(())
}

/// After a crash the saved poses can be taken out of the browser without the program that crashed.
pub fn crash(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    page.eval(SAVE_POSES)?;
    page.eval("pinposePage.crashed('a triangle with four corners'), pinposePage.crashed('a consequence')")?;
    ensure!(page.eval("document.querySelector('pre').textContent")? == "a triangle with four corners");
    save_from_crash_screen(page)?;
    let download = page.download(PATIENCE)?;
    ensure!(
        download.name == "pinpose-recovered.json" && download.bytes == b"{\"saved\":1}",
        "Not the saved poses"
    );
    // The crash is reported in the console, as it should be.
    page.forget_errors()
}

fn save_from_crash_screen(page: &mut Page) -> anyhow::Result<()> {
    page.wait_until("!document.querySelector('button:disabled')", PATIENCE)?;
    let middle = "(() => { const it = document.querySelectorAll('button')[1].getBoundingClientRect();
        return [it.x + it.width / 2, it.y + it.height / 2]; })()";
    let (x, y) = serde_json::from_value(page.eval(middle)?)?;
    page.click((x, y), Button::Left, &[])
}

/// Saves a document where autosave does, as a scene that was open last.
const SAVE_POSES: &str = r#"new Promise((resolve, reject) => {
    const opening = indexedDB.open('pinpose');
    opening.onerror = () => reject(opening.error);
    opening.onsuccess = () => {
        const saving = opening.result.transaction(['documents', 'scenes', 'state'], 'readwrite');
        saving.objectStore('documents').put({ json: '{"saved":0}', assets: [] }, 'current');
        saving.objectStore('documents').put({ json: '{"saved":1}', assets: [] }, 'scene-1');
        saving.objectStore('scenes').put({ name: 'Bench', changedAtMs: 1, assets: [] }, 'scene-1');
        saving.objectStore('state').put('scene-1', 'last_open');
        saving.oncomplete = () => { opening.result.close(); resolve(true); };
        saving.onerror = () => reject(saving.error);
    };
})"#;
