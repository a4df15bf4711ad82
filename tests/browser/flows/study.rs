//! Taking part in a study by mouse: every screen, a reload in the middle of a trial, and a server that fails twice.

use std::time::Duration;

use anyhow::{Context as _, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use pinpose::formats::{Archive, zip_of_files};
use pinpose::study::pack::StudyFiles;
use pinpose::study::{EventKind, Results, Saving, Study};
use serde_json::json;

use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::Button;
use crate::page::Page;

/// Where the flow's study is, as the page sees it; nothing is there but what the flow puts before `fetch`.
const STUDY: &str = "flow/study.zip";
const SERVER: &str = "https://results.invalid/put/{file}";

/// Two samples, each twice.
pub fn short(context: &mut Context) -> anyhow::Result<()> {
    take_part(context, 2, 2)
}

/// The paper's protocol: ten samples, each three times.
pub fn long(context: &mut Context) -> anyhow::Result<()> {
    take_part(context, 10, 3)
}

fn take_part(context: &mut Context, samples: usize, repeats: u32) -> anyhow::Result<()> {
    let zip = study_zip(samples, repeats)?;
    let address = context.address(&format!("study={STUDY}&participant=P1&PROLIFIC_PID=abc&cond=1"));
    let page = context.start("empty")?;
    page.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": network(&zip) }))?;
    page.navigate(&address)?;
    page.wait_until_ready()?;

    on_screen(page, "consent")?;
    page.click_widget("I have read this and agree to take part")?;
    page.click_widget("Agree and continue")?;
    on_screen(page, "questions")?;
    page.click_widget("Often")?;
    page.click_widget("Continue")?;
    on_screen(page, "instructions")?;
    click_scrolled(page, "Start practice")?;
    on_screen(page, "practice")?;
    work(page)?;
    on_screen(page, "feedback")?;
    page.click_widget("Continue")?;
    on_screen(page, "begin")?;
    page.click_widget("Start")?;

    let trials = samples * repeats as usize;
    for trial in 0..trials {
        page.wait_for_state("['trial', 'rest'].includes(state.study)", PATIENCE)?;
        if page.eval("pinpose.state().then((state) => state.study)")? == "rest" {
            page.click_widget("Continue")?;
            on_screen(page, "trial")?;
        }
        if trial == 1 {
            reload_in_trial(page)?;
        }
        work(page)?;
    }
    questionnaires(page)?;
    finish(page, trials)
}

fn on_screen(page: &mut Page, screen: &str) -> anyhow::Result<()> {
    page.wait_for_state(&format!("state.study === '{screen}'"), PATIENCE)
        .with_context(|| format!("The screen \"{screen}\" did not come"))?;
    Ok(())
}

/// Moves the object, which starts in the middle of the photo, and confirms. A drag before the photo is there moves nothing.
fn work(page: &mut Page) -> anyhow::Result<()> {
    let before = page.wait_for_state("state.photos.length === 1", PATIENCE)?.selected_pose()?.clone();
    let deadline = std::time::Instant::now() + PATIENCE;
    loop {
        let [x, y, width, height] = page.state()?.viewport.rect;
        let middle = (x + width / 2.0, y + height / 2.0);
        page.drag(middle, (middle.0 + 24.0, middle.1 + 12.0), Button::Left, 2, &[])?;
        if page.selected_pose()? != before {
            break;
        }
        ensure!(std::time::Instant::now() < deadline, "The object does not move");
    }
    page.click_widget("Confirm")
}

/// The same trial comes back, with the object where it was left.
fn reload_in_trial(page: &mut Page) -> anyhow::Result<()> {
    let [x, y, width, height] = page.wait_for_state("state.photos.length === 1", PATIENCE)?.viewport.rect;
    let middle = (x + width / 2.0, y + height / 2.0);
    let start = page.selected_pose()?;
    let deadline = std::time::Instant::now() + PATIENCE;
    while page.selected_pose()? == start {
        page.drag(middle, (middle.0 + 16.0, middle.1), Button::Left, 2, &[])?;
        ensure!(std::time::Instant::now() < deadline, "The object does not move");
    }
    let moved = page.selected_pose()?;
    // Written within half a second; what is younger is put aside when the page goes.
    page.reload()?;
    page.wait_until_ready()?;
    on_screen(page, "trial")?;
    let back = page.wait_for_state("state.photos.length === 1", PATIENCE)?;
    let back = back.selected_pose()?;
    // When it was changed is when it was put there again.
    let (back, moved) = (back.camera_from_object, moved.camera_from_object);
    ensure!(back == moved, "The object came back elsewhere: {back:?} in place of {moved:?}");
    Ok(())
}

fn questionnaires(page: &mut Page) -> anyhow::Result<()> {
    on_screen(page, "questionnaire")?;
    // The page is longer than the window: what is below is not on screen, so the widgets are scrolled to.
    for scale in ["mental", "physical", "temporal", "performance", "effort", "frustration"] {
        click_scrolled(page, &format!("{scale} 5"))?;
    }
    click_scrolled(page, "Continue")?;
    click_scrolled(page, "sus1 4")?;
    click_scrolled(page, "Continue")?;
    Ok(())
}

/// Turns the wheel until a widget can be seen whole, and clicks it.
fn click_scrolled(page: &mut Page, label: &str) -> anyhow::Result<()> {
    const FOOT: f64 = 550.0;
    let deadline = std::time::Instant::now() + PATIENCE;
    loop {
        let widgets = page.widgets()?;
        let seen = widgets.iter().find(|widget| widget.label == label);
        if seen.is_some_and(|widget| widget.center().1 < FOOT && widget.center().1 > 10.0) {
            return page.click_widget(label);
        }
        ensure!(std::time::Instant::now() < deadline, "\"{label}\" does not come into view");
        page.wheel((400.0, 300.0), -2, &[])?;
    }
}

/// The third try arrives; what arrived is whole, and nothing of the truth is in it.
fn finish(page: &mut Page, trials: usize) -> anyhow::Result<()> {
    on_screen(page, "finish")?;
    page.wait_until("window.flowPuts.length === 3", Duration::from_secs(60))?;
    page.wait_for_widgets(&["Your results have arrived.", "TABLE-42"])?;
    let put = page.eval("window.flowPuts[2]")?;
    let body = put["body"].as_str().context("No body")?;
    let results = Results::from_json(body.as_bytes())?;
    ensure!(put["url"].as_str().is_some_and(|url| url.contains("example_P1_")), "{}", put["url"]);
    ensure!(results.trials.len() == trials, "{} trials came, not {trials}", results.trials.len());
    ensure!(results.participant.id == "P1" && results.participant.recruiter["PROLIFIC_PID"] == "abc");
    ensure!(results.finished_at.is_some() && !results.is_simulated);
    for trial in &results.trials {
        let last = trial.events.iter().rev().find_map(pinpose::study::Event::pose).context("No pose")??;
        ensure!(last == trial.final_pose.to_pose()?, "Trial {} does not end as its events", trial.index);
        ensure!(trial.time_s > 0.0 && trial.gestures.values().sum::<u32>() > 0);
    }
    let reopened = results
        .trials
        .iter()
        .filter(|trial| trial.events.iter().any(|event| event.kind == EventKind::Reopened));
    ensure!(reopened.count() == 1, "Not one trial was gone on with");

    page.click_widget("Download results")?;
    let file = page.download(PATIENCE)?;
    let saved = Results::from_json(&file.bytes)?;
    ensure!(saved.trials == results.trials, "The file is not what was sent");
    Ok(())
}

/// The example study with as many samples and repeats, which sends its results to a server.
fn study_zip(samples: usize, repeats: u32) -> anyhow::Result<Vec<u8>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/study.zip");
    let bytes: std::sync::Arc<[u8]> = std::fs::read(path)?.into();
    let mut archive = Archive::open(bytes.clone())?;
    let mut study: Study = StudyFiles::from_zip(bytes)?.study;
    study.saving = Saving::Put { url: SERVER.to_owned() };
    study.schedule.repeats = repeats;
    let first = study.samples.clone();
    study.samples = first.iter().cycle().take(samples).cloned().collect();
    study.samples.iter_mut().enumerate().for_each(|(index, sample)| sample.id = format!("S{index}"));
    let mut files = vec![("study.json".to_owned(), study.to_json().into_bytes().into())];
    for asset in study.assets() {
        files.push((asset.path.clone(), archive.read(&asset.path)?));
    }
    Ok(zip_of_files(&files)?)
}

/// Puts the study where the page looks for it, and a server that fails twice before it takes anything.
fn network(zip: &[u8]) -> String {
    let body = BASE64.encode(zip);
    format!(
        "(() => {{
            const fetched = window.fetch.bind(window);
            window.flowPuts = [];
            window.fetch = async (resource, options) => {{
                const url = String(resource);
                if (url === '{STUDY}') {{
                    return new Response(Uint8Array.from(atob('{body}'), (letter) => letter.charCodeAt(0)));
                }}
                if (url.startsWith('https://results.invalid/')) {{
                    window.flowPuts.push({{ url, body: options.body }});
                    return new Response('', {{ status: window.flowPuts.length < 3 ? 503 : 200 }});
                }}
                return fetched(resource, options);
            }};
        }})()"
    )
}
