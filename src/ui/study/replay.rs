//! The bar under which a trial is watched again.

use egui::{ComboBox, RichText, Slider, Ui};

use super::StudyRequest;
use crate::study::EventKind;

/// What is watched, and where it is.
#[derive(Debug, Clone, Copy)]
pub struct ReplayView<'a> {
    pub participant: &'a str,
    /// What each trial is called.
    pub trials: &'a [String],
    pub trial: usize,
    /// Since the trial was shown.
    pub at_ms: f64,
    pub duration_ms: f64,
    /// 1 to 16.
    pub speed: f64,
    pub is_playing: bool,
    pub last_event: Option<EventKind>,
}

const SPEEDS: [u32; 5] = [1, 2, 4, 8, 16];

pub fn bar(ui: &mut Ui, replay: &ReplayView<'_>, requests: &mut Vec<StudyRequest>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(replay.participant).strong());
        let shown = replay.trials.get(replay.trial).map_or("", String::as_str);
        let combo =
            ComboBox::from_id_salt("watched trial").selected_text(shown).width(220.0).show_ui(ui, |ui| {
                for (index, name) in replay.trials.iter().enumerate() {
                    if ui.selectable_label(index == replay.trial, name).clicked() {
                        requests.push(StudyRequest::WatchTrial(index));
                    }
                }
            });
        combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Trial"));
        let text = if replay.is_playing { "Pause" } else { "Play" };
        if ui.button(text).clicked() {
            requests.push(StudyRequest::Play(!replay.is_playing));
        }
        for speed in SPEEDS {
            let is_chosen = replay.speed == f64::from(speed);
            if ui.selectable_label(is_chosen, format!("{speed}×")).clicked() {
                requests.push(StudyRequest::Speed(f64::from(speed)));
            }
        }
        if ui.button("Close").clicked() {
            requests.push(StudyRequest::LeavePreview);
        }
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 260.0).max(120.0);
        let mut seconds = replay.at_ms / 1000.0;
        let slider =
            Slider::new(&mut seconds, 0.0..=replay.duration_ms / 1000.0).suffix(" s").fixed_decimals(1);
        if ui.add(slider).changed() {
            requests.push(StudyRequest::PlayAt(seconds * 1000.0));
        }
        if let Some(kind) = replay.last_event {
            ui.label(RichText::new(kind.name().replace('_', " ")).weak());
        }
    });
}
