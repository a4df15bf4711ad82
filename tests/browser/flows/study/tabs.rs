//! The same participation in two tabs: the second one is sent to the first, and nothing is done twice.

use serde_json::json;

use super::made::Made;
use super::on_screen;
use crate::context::Context;
use crate::host::Host;

pub fn two_tabs(context: &mut Context) -> anyhow::Result<()> {
    let made = Made::new("tabs", 2, |study| study.texts.consent = "# Would you like to?".to_owned())?;
    let host = Host::start(&made.folder)?;
    let query = format!("study={}/study/study.json&participant=P1", host.url());
    let address = context.address(&query);
    let page = context.start(&query)?;
    on_screen(page, "consent")?;
    let first = page.open_tab(&address)?;
    page.wait_until_ready()?;
    on_screen(page, "problem")?;
    page.wait_for_widgets(&["If this does not help, please write to study@example.org."])?;
    let said = page.widgets()?;
    let is_plain = said.iter().any(|widget| widget.label.contains("open in another tab or window"));
    anyhow::ensure!(is_plain, "It is not said: {said:?}");

    // The first goes on, and is closed.
    let second = page.switch_to(first)?;
    page.click_widget("I have read this and agree to take part")?;
    page.click_widget("Agree and continue")?;
    on_screen(page, "questions")?;
    page.click_widget("expert")?;
    page.click_widget("Continue")?;
    on_screen(page, "instructions")?;
    let kept = "(async () => (await indexedDB.databases()).length > 0)()";
    page.wait_until(kept, crate::api::PATIENCE)?;
    page.call("Page.navigate", json!({ "url": "about:blank" }))?;
    page.switch_to(second)?;
    page.click_widget("Try again")?;
    // Where the first one was: nothing is asked twice.
    on_screen(page, "instructions")
}
