//! A screen of text and questions: one column that is easy to read, and at its foot the one thing to do next.

use egui::scroll_area::ScrollAreaOutput;
use egui::{Align, Button, Checkbox, Layout, Rect, RichText, ScrollArea, Stroke, TextEdit, Ui, Vec2};

use super::{State, StudyRequest, StudyScreen, StudyView};
use super::{finish, practice, questionnaire, questions, rehearsal, text};
use crate::ui::{study::allowed_keys, theme};

/// As long as lines of text are read well.
const COLUMN: f32 = 640.0;

const BUTTON: Vec2 = Vec2::new(160.0, 36.0);

pub fn draw(ui: &mut Ui, view: &StudyView<'_>, state: &mut State, requests: &mut Vec<StudyRequest>) {
    if view.is_preview {
        rehearsal::bar(ui, view, state, requests);
    }
    // A new screen begins at its top.
    let area = ScrollArea::vertical().id_salt(("study page", view.page)).auto_shrink(false);
    let shown = area.show(ui, |ui| {
        if std::mem::take(&mut state.turn_over) {
            ui.scroll_with_delta(Vec2::new(0.0, -0.8 * ui.clip_rect().height()));
        }
        let width = (ui.available_width() - 48.0).min(COLUMN);
        ui.vertical_centered(|ui| {
            ui.set_max_width(width);
            ui.add_space(40.0);
            ui.with_layout(Layout::top_down(Align::Min), |ui| {
                ui.spacing_mut().item_spacing.y = 10.0;
                ui.label(RichText::new(view.title).small().color(ui.visuals().weak_text_color()));
                screen(ui, view, state, requests);
            });
            ui.add_space(48.0);
        });
    });
    state.turn_over = more_below(ui, &shown);
}

/// Says that the screen goes on, for what to do next is at its foot; true if it is to be turned over.
fn more_below(ui: &mut Ui, shown: &ScrollAreaOutput<()>) -> bool {
    let visible = shown.inner_rect;
    let hidden = shown.content_size.y - shown.state.clamped_offset().y - visible.height();
    // The last of it is empty.
    if hidden < 48.0 {
        return false;
    }
    let place =
        Rect::from_center_size(visible.center_bottom() - Vec2::new(0.0, 22.0), Vec2::new(130.0, 28.0));
    let stroke = Stroke::new(1.0, theme::accent(ui.visuals()));
    ui.put(place, Button::new("More below").corner_radius(14.0).stroke(stroke)).clicked()
}

fn screen(ui: &mut Ui, view: &StudyView<'_>, state: &mut State, requests: &mut Vec<StudyRequest>) {
    match view.screen {
        StudyScreen::Loading { done, all } => loading(ui, done, all),
        StudyScreen::Problem { text, details, can_retry } => {
            problem(ui, view, text, details, can_retry, requests);
        }
        StudyScreen::AskId => ask_id(ui, state, requests),
        StudyScreen::Consent { text } => consent(ui, view, text, state, requests),
        StudyScreen::Declined => {
            heading(ui, "Thank you");
            ui.label("You did not agree, so nothing was recorded. You can close this page.");
        }
        StudyScreen::Instructions { text, condition, practice, trials } => {
            text::draw(ui, text, view.pictures);
            if text.trim().is_empty() {
                heading(ui, "What to do");
                ui.label("Move and turn the object until it lies exactly on its image in the photo.");
            }
            ui.add_space(4.0);
            allowed_keys::draw(ui, &condition.tools);
            ui.add_space(4.0);
            ui.label(what_comes(practice, trials));
            go_on(ui, if practice > 0 { "Start practice" } else { "Continue" }, requests);
        }
        StudyScreen::Questions { items } => questions::draw(ui, "Before we start", items, state, requests),
        StudyScreen::Feedback { feedback, may_try_again } => {
            practice::draw(ui, view.pictures, feedback, may_try_again, requests);
        }
        StudyScreen::Begin { condition, number, count, trials } => {
            let title = if count > 1 {
                format!("Part {number} of {count}: {}", condition.title)
            } else {
                "Now it counts".to_owned()
            };
            heading(ui, &title);
            text::draw(ui, &condition.instructions, view.pictures);
            let words = format!(
                "{} follow. The time of each starts when the photo appears and ends when you confirm.",
                photos(trials)
            );
            ui.label(words);
            if count > 1 {
                allowed_keys::draw(ui, &condition.tools);
            }
            go_on(ui, "Start", requests);
        }
        StudyScreen::Rest { done, all } => rest(ui, done, all, requests),
        StudyScreen::Questionnaire { questionnaire, about, pairs } => {
            questionnaire::draw(ui, questionnaire, about, pairs, state, requests);
        }
        StudyScreen::Finish(finish) => finish::draw(ui, view, &finish, requests),
        // Drawn with the viewport.
        StudyScreen::Trial(_) | StudyScreen::Replay(_) => {}
    }
}

pub fn heading(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).heading().strong());
}

/// The button at the foot of a screen.
pub fn primary(ui: &mut Ui, text: &str) -> bool {
    ui.add_space(12.0);
    // In a row its words are in its middle.
    ui.horizontal(|ui| ui.add(theme::primary_button(text).min_size(BUTTON)).clicked()).inner
}

fn go_on(ui: &mut Ui, text: &str, requests: &mut Vec<StudyRequest>) {
    if primary(ui, text) {
        requests.push(StudyRequest::GoOn);
    }
}

fn photos(count: usize) -> String {
    match count {
        1 => "One photo".to_owned(),
        count => format!("{count} photos"),
    }
}

fn what_comes(practice: usize, trials: usize) -> String {
    match practice {
        0 => format!("{} to work on.", photos(trials)),
        1 => format!("First one photo to practise, then {} that count.", photos(trials).to_lowercase()),
        _ => {
            format!("First {practice} photos to practise, then {} that count.", photos(trials).to_lowercase())
        }
    }
}

fn loading(ui: &mut Ui, done: usize, all: usize) {
    heading(ui, "Getting the study ready");
    let part = if all == 0 { 0.0 } else { done as f32 / all as f32 };
    ui.add(egui::ProgressBar::new(part).desired_height(8.0));
    if all > 0 {
        ui.label(RichText::new(format!("{done} of {all} files")).weak());
    }
}

fn problem(
    ui: &mut Ui,
    view: &StudyView<'_>,
    text: &str,
    details: &str,
    can_retry: bool,
    requests: &mut Vec<StudyRequest>,
) {
    heading(ui, "The study cannot go on here");
    ui.label(text);
    let whom = match view.contact {
        "" => "whoever invited you",
        contact => contact,
    };
    ui.label(format!("If this does not help, please write to {whom}."));
    if can_retry && primary(ui, "Try again") {
        requests.push(StudyRequest::Retry);
    }
    if !details.is_empty() {
        ui.add_space(16.0);
        ui.horizontal(|ui| {
            ui.label(RichText::new("For the researcher:").small().weak());
            if ui.small_button("Copy").clicked() {
                ui.ctx().copy_text(details.to_owned());
            }
        });
        ui.label(RichText::new(details).small().weak());
    }
}

fn ask_id(ui: &mut Ui, state: &mut State, requests: &mut Vec<StudyRequest>) {
    heading(ui, "Welcome");
    ui.label("Please type the participant id that you were given.");
    let field = ui.add(TextEdit::singleline(&mut state.id).desired_width(280.0).char_limit(80));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Participant id"));
    let is_given = !state.id.trim().is_empty();
    let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    ui.add_space(12.0);
    let button = ui.add_enabled(is_given, theme::primary_button("Continue").min_size(BUTTON));
    if button.clicked() || (entered && is_given) {
        requests.push(StudyRequest::Id(state.id.trim().to_owned()));
    }
}

fn consent(
    ui: &mut Ui,
    view: &StudyView<'_>,
    words: &str,
    state: &mut State,
    requests: &mut Vec<StudyRequest>,
) {
    text::draw(ui, words, view.pictures);
    ui.separator();
    ui.add(Checkbox::new(&mut state.consent, "I have read this and agree to take part"));
    ui.add_space(12.0);
    ui.horizontal(|ui| {
        let agree = theme::primary_button("Agree and continue").min_size(BUTTON);
        if ui.add_enabled(state.consent, agree).clicked() {
            requests.push(StudyRequest::Agree);
        }
        if ui.add(Button::new("I do not agree").min_size(BUTTON)).clicked() {
            requests.push(StudyRequest::Decline);
        }
    });
}

fn rest(ui: &mut Ui, done: usize, all: usize, requests: &mut Vec<StudyRequest>) {
    heading(ui, "Take a break if you like");
    ui.label(format!("{done} of {all} photos are done. The clock stands still on this screen."));
    ui.add(egui::ProgressBar::new(done as f32 / all.max(1) as f32).desired_height(8.0));
    go_on(ui, "Continue", requests);
}
