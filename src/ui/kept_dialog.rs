//! Participations that are kept in this browser: to download their results again, or to remove them.

use egui::{Align, Button, Context, Layout, RichText, ScrollArea, Ui, Vec2};

use super::busy_mark::busy_mark;
use super::scenes_dialog::words;
use super::{once, theme};
use crate::platform::{SceneId, SceneSummary};

const TITLE_WIDTH: f32 = 210.0;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeptRequest {
    Download(SceneId),
    /// Into the report of results.
    Report(SceneId),
    /// For good: the dialog has asked.
    Remove(SceneId),
}

/// What is kept, and now, in milliseconds since 1970.
#[derive(Debug, Clone, Copy)]
pub struct KeptView<'a> {
    /// `None` until the store has answered.
    pub list: Option<&'a [SceneSummary]>,
    pub now_ms: f64,
}

#[derive(Debug, Default)]
pub struct State {
    is_open: bool,
    /// The one that is about to be removed.
    removing: Option<SceneId>,
}

impl State {
    pub fn show(&mut self) {
        *self = Self { is_open: true, removing: None };
    }

    pub fn close(&mut self) {
        *self = Self::default();
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }
}

pub fn draw(ctx: &Context, view: Option<&KeptView<'_>>, state: &mut State, asked: &mut Option<KeptRequest>) {
    let (true, Some(view)) = (state.is_open, view) else { return };
    let modal = once::modal(ctx, "kept results", theme::dialog_frame(ctx), |ui| {
        ui.set_width(640.0_f32.min(ui.ctx().content_rect().width() - 64.0));
        let is_closed = ui
            .horizontal(|ui| {
                ui.heading("Results kept in this browser");
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.button("Close").clicked()).inner
            })
            .inner;
        let words = "What was done in studies on this computer stays here until somebody removes it.";
        ui.label(RichText::new(words).weak());
        ui.add_space(8.0);
        match view.list {
            None => {
                busy_mark(ui);
            }
            Some([]) => {
                ui.label("Nobody has taken part in a study in this browser.");
            }
            Some(list) => {
                let height = ui.ctx().content_rect().height() - 220.0;
                ScrollArea::vertical().max_height(height).show(ui, |ui| {
                    list.iter().for_each(|kept| row(ui, kept, view.now_ms, &mut state.removing, asked));
                });
            }
        }
        is_closed
    });
    if modal.inner || modal.should_close() {
        state.is_open = false;
    }
}

fn row(
    ui: &mut Ui,
    kept: &SceneSummary,
    now_ms: f64,
    removing: &mut Option<SceneId>,
    asked: &mut Option<KeptRequest>,
) {
    ui.push_id(&kept.id, |ui| {
        ui.horizontal(|ui| {
            ui.set_min_height(30.0);
            ui.allocate_ui(Vec2::new(TITLE_WIDTH, 20.0), |ui| {
                ui.set_width(TITLE_WIDTH);
                ui.add(egui::Label::new(kept.heading.title()).truncate());
            });
            ui.label(RichText::new(words::when_text(kept.heading.changed_at_ms, now_ms)).weak());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if removing.as_ref() == Some(&kept.id) {
                    let remove = Button::new(RichText::new("Remove it").color(theme::error(ui.visuals())));
                    if ui.add(remove).clicked() {
                        *removing = None;
                        *asked = Some(KeptRequest::Remove(kept.id.clone()));
                    }
                    if ui.button("Keep it").clicked() {
                        *removing = None;
                    }
                    ui.label("Remove for good?");
                    return;
                }
                if ui.button("Remove").clicked() {
                    *removing = Some(kept.id.clone());
                }
                let hint =
                    "Among the files of a report, where those of others and the true poses can be added";
                if ui.button("Report").on_hover_text(hint).clicked() {
                    *asked = Some(KeptRequest::Report(kept.id.clone()));
                }
                if ui.button("Download").clicked() {
                    *asked = Some(KeptRequest::Download(kept.id.clone()));
                }
            });
        });
    });
}
