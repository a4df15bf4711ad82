//! How long a participant waits: from the link to the first photo that can be worked on, with all of the paper's files.

use anyhow::{Context as _, ensure};

use super::made::Made;
use super::{click_scrolled, on_screen};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::host::Host;

/// From the navigation on, on a machine with nothing else to do, and how many times that is a failure: what else runs is
/// not the page's fault.
const MOST_S: f64 = 5.0;
const MOST_TIMES_AS_LONG: f64 = 4.0;

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
    page.click_widget("Start")?;
    on_screen(page, "trial")?;
    page.wait_for_state("state.photos.length === 1", PATIENCE)?;
    page.next_frame()?;
    let trial_s = seconds(page)?;
    println!(
        "   instructions after {instructions_s:.2} s, the first photo after {trial_s:.2} s, clicks and all ({MOST_S} s wanted)"
    );
    ensure!(trial_s <= MOST_S * MOST_TIMES_AS_LONG, "It took {trial_s:.2} s");
    Ok(())
}
