//! A data set before it is opened: what it is, which of its parts to open, what was found, guessed and missing.

mod parts;

use std::collections::BTreeSet;

use egui::{Align, Button, Context, Layout, ProgressBar, RichText, ScrollArea, Ui, Vec2};

use super::busy_mark::busy_mark;
use super::{dialogs, once, theme};
use crate::formats::PosesAs;
use crate::formats::dataset::{Dataset, Recognised};

const WIDTH: f32 = 560.0;
/// The choices below the lists, the buttons, and the dialog's own edges.
const ROOM_FOR_CHOICES: f32 = 300.0;
const BUTTON_SIZE: Vec2 = Vec2::new(92.0, 28.0);
/// Lines of one list; the others are counted.
const MOST_LINES: usize = 60;

/// What the user wants of the data set.
#[derive(Debug, Clone, PartialEq)]
pub enum DatasetRequest {
    Choose(BTreeSet<usize>),
    /// `None`: leave them out.
    PosesAs(Option<PosesAs>),
    DepthMaps(bool),
    Masks(bool),
    Open,
    Cancel,
}

/// A data set that waits for the user, or is being opened.
#[derive(Debug, Clone, Copy)]
pub struct DatasetView<'a> {
    pub recognised: &'a Recognised,
    pub chosen: &'a BTreeSet<usize>,
    /// What the chosen parts hold; `None` while that is read. An error is a sentence.
    pub dataset: Option<Result<&'a Dataset, &'a str>>,
    pub poses_as: Option<PosesAs>,
    pub with_depth_maps: bool,
    pub with_masks: bool,
    /// Once it is being opened: files that are done, and all.
    pub progress: Option<(usize, usize)>,
}

/// Draws the dialog, and says what the user wants.
pub fn draw(ctx: &Context, view: &DatasetView<'_>, requests: &mut Vec<DatasetRequest>) {
    let modal = once::modal(ctx, "data set", theme::dialog_frame(ctx), |ui| {
        let screen = ui.ctx().content_rect();
        ui.set_width(WIDTH.min(screen.width() - 64.0));
        title(ui, view);
        match view.progress {
            Some((done, all)) => progress(ui, done, all, requests),
            None => {
                parts::draw(ui, view, requests);
                contents(ui, view);
                choices(ui, view, requests);
                ui.add_space(6.0);
                ui.separator();
                buttons(ui, view, requests);
            }
        }
    });
    if modal.should_close() && requests.is_empty() {
        requests.push(DatasetRequest::Cancel);
    }
}

fn title(ui: &mut Ui, view: &DatasetView<'_>) {
    ui.add(egui::Label::new(RichText::new(&view.recognised.name).heading()).truncate());
    ui.label(RichText::new(capitalised(view.recognised.kind.name())).weak());
    ui.add_space(6.0);
}

/// What was found, guessed and missing, or why that is not known.
fn contents(ui: &mut Ui, view: &DatasetView<'_>) {
    match view.dataset {
        Some(Ok(dataset)) => {
            // What there is to choose and the buttons stay on the screen, however long the lists are.
            let taken = ui.cursor().top() - ui.min_rect().top();
            let height = ui.ctx().content_rect().height() - taken - ROOM_FOR_CHOICES;
            ScrollArea::vertical().id_salt("contents").max_height(height.max(64.0)).show(ui, |ui| {
                ui.set_width(ui.available_width());
                list(ui, "Found", &dataset.found);
                list(ui, "Guessed", &dataset.guessed);
                list(ui, "Missing", &dataset.missing);
            });
        }
        Some(Err(problem)) => {
            ui.add_space(8.0);
            let color = theme::error(ui.visuals());
            ui.add(egui::Label::new(RichText::new(problem).color(color)).wrap());
        }
        None => {
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if !view.chosen.is_empty() {
                    busy_mark(ui);
                }
                let what = if view.chosen.is_empty() { "Choose a part." } else { "Reading what is in it…" };
                ui.label(RichText::new(what).weak());
            });
        }
    }
}

/// What becomes of that which can be done without.
fn choices(ui: &mut Ui, view: &DatasetView<'_>, requests: &mut Vec<DatasetRequest>) {
    let Some(Ok(dataset)) = view.dataset else { return };
    if dataset.pose_count() > 0 {
        poses_choice(ui, view.poses_as, requests);
    }
    extras(ui, view, dataset, requests);
}

fn list(ui: &mut Ui, name: &str, lines: &[String]) {
    if lines.is_empty() {
        return;
    }
    theme::group_title(ui, name);
    let mut line = |text: &str| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new("•").weak());
            ui.add(egui::Label::new(text).wrap());
        });
    };
    lines.iter().take(MOST_LINES).for_each(|text| line(text));
    let others = lines.len().saturating_sub(MOST_LINES);
    if others > 0 {
        line(&format!("and {others} more"));
    }
}

fn poses_choice(ui: &mut Ui, chosen: Option<PosesAs>, requests: &mut Vec<DatasetRequest>) {
    theme::group_title(ui, "Its poses are");
    let all = [
        (Some(PosesAs::Annotations), "Start poses", "My poses: I go on from them."),
        (Some(PosesAs::Reference), "Reference", "Truth or another's poses, to compare with. Read-only."),
        (None, "Left out", "I begin without any."),
    ];
    for (poses_as, text, meaning) in all {
        ui.horizontal(|ui| {
            if ui.radio(chosen == poses_as, text).clicked() && chosen != poses_as {
                requests.push(DatasetRequest::PosesAs(poses_as));
            }
            ui.label(RichText::new(meaning).weak());
        });
    }
}

/// Files that are not needed to annotate.
fn extras(ui: &mut Ui, view: &DatasetView<'_>, dataset: &Dataset, requests: &mut Vec<DatasetRequest>) {
    let depth_maps = dataset.photos.iter().filter(|photo| photo.depth.is_some()).count();
    let masks: usize = dataset.photos.iter().map(|photo| photo.masks.len()).sum();
    if depth_maps + masks == 0 {
        return;
    }
    theme::group_title(ui, "With them");
    ui.horizontal(|ui| {
        let (mut with_depth_maps, mut with_masks) = (view.with_depth_maps, view.with_masks);
        let text = format!("Depth maps ({})", parts::grouped(depth_maps));
        if depth_maps > 0 && ui.checkbox(&mut with_depth_maps, text).clicked() {
            requests.push(DatasetRequest::DepthMaps(with_depth_maps));
        }
        let text = format!("Masks ({})", parts::grouped(masks));
        if masks > 0 && ui.checkbox(&mut with_masks, text).clicked() {
            requests.push(DatasetRequest::Masks(with_masks));
        }
    });
}

fn buttons(ui: &mut Ui, view: &DatasetView<'_>, requests: &mut Vec<DatasetRequest>) {
    let can_open = matches!(view.dataset, Some(Ok(_)));
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let open = ui.add_enabled(can_open, theme::primary_button("Open").min_size(BUTTON_SIZE));
        if open.on_hover_text("In a scene of its own (Enter)").clicked() {
            requests.push(DatasetRequest::Open);
        }
        if ui.add(Button::new("Cancel").min_size(BUTTON_SIZE)).clicked() {
            requests.push(DatasetRequest::Cancel);
        }
    });
    if requests.is_empty() && can_open && dialogs::is_entered(ui) {
        requests.push(DatasetRequest::Open);
    }
}

fn progress(ui: &mut Ui, done: usize, all: usize, requests: &mut Vec<DatasetRequest>) {
    let (done_text, all_text) = (parts::grouped(done), parts::grouped(all));
    ui.label(format!("Reading files: {done_text} of {all_text}"));
    ui.add_space(4.0);
    ui.add(ProgressBar::new(done as f32 / all.max(1) as f32).desired_height(6.0));
    ui.add_space(10.0);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if ui.add(Button::new("Cancel").min_size(BUTTON_SIZE)).clicked() {
            requests.push(DatasetRequest::Cancel);
        }
    });
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
