//! What a researcher sees above a preview: that it is one, the way back, and a rehearsal with simulated participants.

use egui::{Align, Button, DragValue, Layout, RichText, Ui, Vec2};

use super::{State, StudyRequest, StudyView};
use crate::ui::{once, theme};

/// Participants that are a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rehearsal {
    pub participants: usize,
    pub seed: u64,
    /// As result files, not as their report.
    pub as_files: bool,
}

impl Default for Rehearsal {
    /// As many as the paper had.
    fn default() -> Self {
        Self { participants: 11, seed: 1, as_files: false }
    }
}

const MOST: usize = 200;
const BUTTON: Vec2 = Vec2::new(140.0, 30.0);

pub fn bar(ui: &mut Ui, view: &StudyView<'_>, state: &mut State, requests: &mut Vec<StudyRequest>) {
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let words = RichText::new("Preview: nothing is sent or kept").color(theme::warning(ui.visuals()));
        ui.label(words);
        if ui.button("End preview").clicked() {
            requests.push(StudyRequest::LeavePreview);
        }
        let hint = "A program works through the study, so that you see its report before anybody takes part";
        if view.can_rehearse && ui.button("Simulate participants…").on_hover_text(hint).clicked() {
            state.rehearsal = Some(Rehearsal::default());
        }
    });
    dialog(ui, state, requests);
}

fn dialog(ui: &mut Ui, state: &mut State, requests: &mut Vec<StudyRequest>) {
    let Some(rehearsal) = &mut state.rehearsal else { return };
    let frame = theme::dialog_frame(ui.ctx());
    let modal = once::modal(ui.ctx(), "rehearsal", frame, |ui| {
        ui.set_width(460.0);
        ui.heading("Simulated participants");
        ui.add_space(6.0);
        ui.label("A program makes poses, times and answers of about the size that people's have. They show what files and report \
            will look like, and say nothing of people. Every file and every page of the report is marked.");
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            ui.label("Participants");
            ui.add(DragValue::new(&mut rehearsal.participants).range(1..=MOST));
            ui.add_space(16.0);
            ui.label("Seed").on_hover_text("Another seed makes other people");
            ui.add(DragValue::new(&mut rehearsal.seed).range(0..=999_999_999));
        });
        ui.add_space(10.0);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let mut chosen = None;
            if ui.add(theme::primary_button("See the report").min_size(BUTTON)).clicked() {
                chosen = Some(Rehearsal { as_files: false, ..*rehearsal });
            }
            if ui.add(Button::new("Download files").min_size(BUTTON)).clicked() {
                chosen = Some(Rehearsal { as_files: true, ..*rehearsal });
            }
            requests.extend(chosen.map(StudyRequest::Rehearse));
            ui.add(Button::new("Cancel").min_size(Vec2::new(84.0, 30.0))).clicked() || chosen.is_some()
        })
        .inner
    });
    if modal.inner || modal.should_close() {
        state.rehearsal = None;
    }
}
