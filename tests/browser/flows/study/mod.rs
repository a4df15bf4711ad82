//! Studies as people meet them: two participants by mouse and keyboard, a reload in the middle of a trial, a server that fails
//! twice, two tabs, broken links; and the researcher's report of what came.

mod links;
mod made;
mod report;
mod results;
mod startup;
mod tabs;

use std::time::Instant;

use anyhow::{Context as _, ensure};
use pinpose::study::{AskedFor, Plan, QuestionnaireKind, Results, Saving, Study};

use crate::api::PATIENCE;
use crate::context::Context;
use crate::host::Host;
use crate::input::Button;
use crate::page::Page;
use made::{Made, ensure_no_truth, files_beneath};

pub use links::bad_links;
pub use report::of_a_hundred;
pub use startup::link_to_trial;
pub use tabs::two_tabs;

/// Two samples, each twice.
pub fn short(context: &mut Context) -> anyhow::Result<()> {
    two_participants(context, 2, 2)
}

/// The paper's protocol: ten samples, each three times.
pub fn long(context: &mut Context) -> anyhow::Result<()> {
    two_participants(context, 10, 3)
}

fn two_participants(context: &mut Context, samples: usize, repeats: u32) -> anyhow::Result<()> {
    let name = format!("two-{}-{samples}", context.backend.name());
    let mut made = Made::new(&name, samples, |study| {
        study.schedule.repeats = repeats;
        study.texts.consent = "# Would you like to take part?".to_owned();
        study.completion.code = Some("CODE-42".to_owned());
    })?;
    let host = Host::start(&made.folder)?;
    let mut sent: Vec<Results> = Vec::new();
    for (number, participant) in ["P1", "P2"].into_iter().enumerate() {
        // One sends by PUT and one by POST: the study is the same but for that.
        let url = format!("{}/results/{{file}}", host.url());
        made.study.saving = if number == 0 { Saving::Put { url } } else { Saving::Post { url } };
        made.write()?;
        host.fail_next(2);
        sent.push(take_part(context, &made.study, &host, participant)?);
        let page = context.page()?;
        ensure_no_truth("The page's storage", storage(page)?.as_bytes(), &made.truth)?;
        ensure_no_truth("The results", sent[number].to_json().as_bytes(), &made.truth)?;
    }
    for path in files_beneath(&made.study_folder())? {
        ensure_no_truth(&path.display().to_string(), &std::fs::read(&path)?, &made.truth)?;
    }
    let orders =
        sent.iter().map(|one| one.trials.iter().map(|trial| trial.sample.clone()).collect::<Vec<_>>());
    let orders: Vec<Vec<String>> = orders.collect();
    ensure!(samples < 10 || orders[0] != orders[1], "Both worked in the same order");
    // The report is of one version of the study: of the last one, and it says so of the first.
    report::of_both(context, &made, &sent)
}

/// From the link to the last screen; the results as they arrived.
fn take_part(
    context: &mut Context,
    study: &Study,
    host: &Host,
    participant: &str,
) -> anyhow::Result<Results> {
    let before = host.sent().len();
    let query = format!("study={}/study/study.json&participant={participant}&PROLIFIC_PID=abc", host.url());
    let page = context.start(&query)?;
    on_screen(page, "consent")?;
    page.click_widget("I have read this and agree to take part")?;
    page.click_widget("Agree and continue")?;
    on_screen(page, "questions")?;
    page.click_widget("some")?;
    page.click_widget("Continue")?;
    on_screen(page, "instructions")?;
    click_scrolled(page, "Continue")?;
    on_screen(page, "begin")?;
    page.click_widget("Start")?;
    let trials = study.samples.len() * study.schedule.repeats as usize;
    let began = Instant::now();
    for trial in 0..trials {
        page.wait_for_state("['trial', 'rest'].includes(state.study)", PATIENCE)?;
        if page.eval("pinpose.state().then((state) => state.study)")? == "rest" {
            page.click_widget("Continue")?;
            on_screen(page, "trial")?;
        }
        if trial == 1 {
            reload_in_trial(page)?;
        }
        work(page, trial)?;
    }
    let worked_s = began.elapsed().as_secs_f64();
    questionnaires(page, study)?;
    let results = finish(page, host, before)?;
    let plan = Plan::new(study, participant, &AskedFor::default())?;
    results::check(&results, &plan, participant, worked_s)?;
    ensure!(results.participant.recruiter["PROLIFIC_PID"] == "abc", "The recruiter's id is lost");

    page.click_widget("Download results")?;
    let file = page.download(PATIENCE)?;
    ensure!(file.name.starts_with(&format!("flow_{participant}_")), "The file is called {}", file.name);
    let saved = Results::from_json(&file.bytes)?;
    ensure!(saved == results, "The file is not what was sent");
    // Whoever comes back after the end finds the end.
    page.reload()?;
    page.wait_until_ready()?;
    on_screen(page, "finish")?;
    page.wait_for_widgets(&["CODE-42"])?;
    ensure!(host.sent().len() == before + 3, "The results were sent again");
    Ok(results)
}

pub fn on_screen(page: &mut Page, screen: &str) -> anyhow::Result<()> {
    page.wait_for_state(&format!("state.study === '{screen}'"), PATIENCE)
        .with_context(|| format!("The screen \"{screen}\" did not come"))?;
    Ok(())
}

/// Moves the object, which starts in the middle of the photo, by mouse or by keys, and confirms by button or by Enter. What
/// is done before the photo is there moves nothing.
fn work(page: &mut Page, trial: usize) -> anyhow::Result<()> {
    let before = page.wait_for_state("state.photos.length === 1", PATIENCE)?.selected_pose()?.clone();
    let deadline = Instant::now() + PATIENCE;
    loop {
        let [x, y, width, height] = page.state()?.viewport.rect;
        let middle = (x + width / 2.0, y + height / 2.0);
        page.drag(middle, (middle.0 + 24.0, middle.1 + 12.0), Button::Left, 2, &[])?;
        if page.selected_pose()? != before {
            break;
        }
        ensure!(Instant::now() < deadline, "The object does not move");
    }
    if trial.is_multiple_of(2) {
        return page.click_widget("Confirm");
    }
    page.key("ArrowRight", &[])?;
    page.next_frame()?;
    page.key("Enter", &[])
}

/// The same trial comes back, with the object where it was left.
fn reload_in_trial(page: &mut Page) -> anyhow::Result<()> {
    let [x, y, width, height] = page.wait_for_state("state.photos.length === 1", PATIENCE)?.viewport.rect;
    let middle = (x + width / 2.0, y + height / 2.0);
    let start = page.selected_pose()?;
    let deadline = Instant::now() + PATIENCE;
    while page.selected_pose()? == start {
        page.drag(middle, (middle.0 + 16.0, middle.1), Button::Left, 2, &[])?;
        ensure!(Instant::now() < deadline, "The object does not move");
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

/// Screens are longer than the window: what is below is not on screen, so the widgets are scrolled to.
fn questionnaires(page: &mut Page, study: &Study) -> anyhow::Result<()> {
    for questionnaire in &study.questionnaires {
        on_screen(page, "questionnaire")?;
        match questionnaire.kind {
            QuestionnaireKind::NasaTlx { .. } => {
                for scale in ["mental", "physical", "temporal", "performance", "effort", "frustration"] {
                    click_scrolled(page, &format!("{scale} 5"))?;
                }
            }
            QuestionnaireKind::Sus => click_scrolled(page, "sus1 4")?,
            QuestionnaireKind::Own { .. } => {}
        }
        click_scrolled(page, "Continue")?;
    }
    Ok(())
}

/// Turns the wheel until a widget can be seen whole, and clicks it.
pub fn click_scrolled(page: &mut Page, label: &str) -> anyhow::Result<()> {
    const FOOT: f64 = 550.0;
    let deadline = Instant::now() + PATIENCE;
    loop {
        let widgets = page.widgets()?;
        let seen = widgets.iter().find(|widget| widget.label == label);
        if seen.is_some_and(|widget| widget.center().1 < FOOT && widget.center().1 > 10.0) {
            return page.click_widget(label);
        }
        ensure!(Instant::now() < deadline, "\"{label}\" does not come into view");
        page.wheel((400.0, 300.0), -2, &[])?;
    }
}

/// Two tries fail and the third arrives.
fn finish(page: &mut Page, host: &Host, before: usize) -> anyhow::Result<Results> {
    on_screen(page, "finish")?;
    page.wait_for_widgets(&["Your results have arrived.", "CODE-42"])?;
    // The two that failed are in the console.
    page.forget_errors()?;
    let sent = host.sent();
    let tries: Vec<bool> = sent.iter().skip(before).map(|one| one.was_taken).collect();
    ensure!(tries == [false, false, true], "The tries went {tries:?}");
    let last = sent.last().context("Nothing was sent")?;
    ensure!(last.path.starts_with("/results/flow_"), "{} to {}", last.method, last.path);
    Ok(Results::from_json(&last.body)?)
}

/// All that the page keeps: its databases, and what goes with tab and browser.
fn storage(page: &mut Page) -> anyhow::Result<String> {
    let all = page.eval(
        "(async () => {
            const done = (request) => new Promise((resolve, reject) => {
                request.onsuccess = () => resolve(request.result);
                request.onerror = () => reject(request.error);
            });
            const found = [JSON.stringify(localStorage), JSON.stringify(sessionStorage)];
            for (const { name } of await indexedDB.databases()) {
                const database = await done(indexedDB.open(name));
                for (const store of database.objectStoreNames) {
                    const all = await done(database.transaction(store).objectStore(store).getAll());
                    const text = (value) => value instanceof Uint8Array ? String.fromCharCode(...value.slice(0, 100000)) : value;
                    found.push(JSON.stringify(all, (key, value) => text(value)));
                }
                database.close();
            }
            return found.join('\\n');
        })()",
    )?;
    let all = all.as_str().context("No storage")?.to_owned();
    ensure!(all.contains("flow"), "The participation is not in the storage: {all}");
    Ok(all)
}
