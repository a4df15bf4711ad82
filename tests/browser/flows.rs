//! The flows: what a user does with the page, on which backends.

use std::time::Duration;

use anyhow::ensure;

use crate::cdp::Backend;
use crate::context::Context;
use crate::input::Button;

pub struct Flow {
    pub name: &'static str,
    pub backends: &'static [Backend],
    /// Runs with `--full` alone.
    pub full_only: bool,
    pub run: fn(&mut Context) -> anyhow::Result<()>,
}

const BOTH: &[Backend] = &[Backend::WebGpu, Backend::WebGl];

pub const FLOWS: &[Flow] = &[
    Flow { name: "starts", backends: BOTH, full_only: false, run: starts },
    Flow { name: "offline", backends: &[Backend::WebGl], full_only: false, run: offline },
    Flow { name: "crash", backends: &[Backend::WebGl], full_only: false, run: crash },
];

/// The page draws its first frame with the renderer that was asked for.
fn starts(context: &mut Context) -> anyhow::Result<()> {
    let backend = context.backend.name();
    let page = context.start("")?;
    let perf = page.eval("window.pinpose.perf()")?;
    ensure!(perf["backend"] == backend, "The page draws with {}, not with {backend}", perf["backend"]);
    println!("   start_ms {}", perf["start_ms"]);
    Ok(())
}

/// After one visit the page opens without a network.
fn offline(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    page.wait_until("navigator.serviceWorker.ready.then((it) => it.active.state === 'activated')", MINUTE)?;
    context.stop_server();
    let page = context.page()?;
    ensure!(
        page.eval("fetch('build.json').then(() => 'online', () => 'offline')")? == "offline",
        "Still online"
    );
    // The failed request above is meant to fail.
    page.forget_errors()?;
    page.reload()?;
    page.wait_until_ready()
}

/// After a crash the saved poses can be taken out of the browser without the program that crashed.
fn crash(context: &mut Context) -> anyhow::Result<()> {
    let page = context.start("")?;
    page.eval(SAVE_POSES)?;
    page.eval("pinposePage.crashed('a triangle with four corners'), pinposePage.crashed('a consequence')")?;
    ensure!(page.eval("document.querySelector('pre').textContent")? == "a triangle with four corners");
    page.wait_until("!document.querySelector('button:disabled')", MINUTE)?;
    let middle = "(() => { const it = document.querySelectorAll('button')[1].getBoundingClientRect();
        return [it.x + it.width / 2, it.y + it.height / 2]; })()";
    let (x, y) = serde_json::from_value(page.eval(middle)?)?;
    page.click((x, y), Button::Left, &[])?;
    let download = page.download(MINUTE)?;
    ensure!(
        download.name == "pinpose-recovered.json" && download.bytes == b"{\"saved\":1}",
        "Not the saved poses"
    );
    // The crash is reported in the console, as it should be.
    page.forget_errors()
}

/// Saves a document where autosave does, whether or not the program has made the place for it yet.
const SAVE_POSES: &str = r#"new Promise((resolve, reject) => {
    const opening = indexedDB.open('pinpose', 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore('documents');
    opening.onerror = () => reject(opening.error);
    opening.onsuccess = () => {
        const saving = opening.result.transaction('documents', 'readwrite');
        saving.objectStore('documents').put({ json: '{"saved":1}' }, 'current');
        saving.oncomplete = () => resolve(true);
        saving.onerror = () => reject(saving.error);
    };
})"#;

const MINUTE: Duration = Duration::from_secs(60);
