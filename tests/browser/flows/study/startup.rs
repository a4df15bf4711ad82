//! How long a participant waits from the link to the first photo that can be worked on, with all of the paper's files.

use anyhow::{Context as _, ensure};

use super::made::Made;
use super::{click_scrolled, on_screen};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::host::Host;

/// From the navigation on, without the time between two screens that is spent reading.
const MOST_S: f64 = 5.0;

pub fn link_to_trial(context: &mut Context) -> anyhow::Result<()> {
    let made = Made::new("startup", 10, |study| study.items_before.clear())?;
    let host = Host::start(&made.folder)?;
    let page = context.start(&format!("study={}/study/study.json&participant=P1", host.url()))?;
    on_screen(page, "instructions")?;
    let seconds = |page: &mut crate::page::Page| -> anyhow::Result<f64> {
        page.eval("performance.now() / 1000")?.as_f64().context("No time")
    };
    let instructions_s = seconds(page)?;
    click_scrolled(page, "Continue")?;
    on_screen(page, "begin")?;
    let start_s = seconds(page)?;
    page.click_widget("Start")?;
    on_screen(page, "trial")?;
    page.wait_for_state("state.photos.length === 1", PATIENCE)?;
    page.next_frame()?;
    let trial_s = seconds(page)?;
    // What lies between is the reader's, who takes longer than these clicks; files come meanwhile.
    let photo_s = trial_s - start_s;
    let waited_s = instructions_s + photo_s;
    println!(
        "   waited {instructions_s:.2} s for the instructions and {photo_s:.2} s for the photo, of {trial_s:.2} s"
    );
    ensure!(waited_s <= MOST_S, "It took {waited_s:.2} s");
    Ok(())
}
