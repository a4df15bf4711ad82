//! A graphics context that is lost ends in the crash screen, and a reload brings everything back.

use anyhow::ensure;

use super::{photo_view, start_with_shapes};
use crate::api::PATIENCE;
use crate::context::Context;

pub fn lost_graphics(context: &mut Context) -> anyhow::Result<()> {
    let (page, _) = start_with_shapes(context)?;
    let picture = photo_view(page)?;
    let saved = page.wait_until_saved()?;
    page.eval(
        "document.getElementById('pinpose').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()",
    )?;
    page.wait_until("Boolean(document.querySelector('pre'))", PATIENCE)?;
    let said = page.eval("document.querySelector('pre').textContent")?;
    println!("   {}", said.as_str().unwrap_or_default().lines().next().unwrap_or_default());
    // It is reported in the console, as it should be.
    page.forget_errors()?;
    page.reload()?;
    page.wait_until_ready()?;
    let restored = page.wait_for_state("!state.busy && state.objects.length === 2", PATIENCE)?;
    ensure!(restored.scene() == saved.scene(), "{:?} came back as {:?}", saved.scene(), restored.scene());
    ensure!(photo_view(page)? == picture, "The picture after the reload is another one");
    Ok(())
}
