//! What is said of a practice pose.

use egui::{Button, Grid, RichText, Ui, Vec2};

use super::{Pictures, StudyRequest};
use crate::study::Feedback;
use crate::ui::theme;

/// What the pictures of a practice pose are called: the participant's, the true one, and both.
pub const FEEDBACK_PICTURES: [&str; 3] =
    ["feedback: yours", "feedback: correct", "feedback: where they differ"];

const CAPTIONS: [&str; 3] = ["Yours", "Correct", "Green: only yours. Pink: only correct"];

pub fn draw(
    ui: &mut Ui,
    shown: &Pictures,
    feedback: &Feedback,
    may_try_again: bool,
    requests: &mut Vec<StudyRequest>,
) {
    let (title, color) = match feedback.is_good {
        true => ("Well done", theme::good(ui.visuals())),
        false => ("Not quite there yet", theme::warning(ui.visuals())),
    };
    ui.label(RichText::new(title).heading().strong().color(color));
    pictures(ui, shown);
    Grid::new("practice errors").num_columns(2).spacing([24.0, 6.0]).show(ui, |ui| {
        let mut row = |what: &str, value: String| {
            ui.label(what);
            ui.label(RichText::new(value).strong());
            ui.end_row();
        };
        row("Turned by", format!("{:.1}°", feedback.rotation_deg));
        row("Moved by", format!("{:.1} mm", feedback.translation_mm));
        row("Mean distance of its points", format!("{:.1} mm", feedback.add_mm));
    });
    if !feedback.is_good {
        ui.label("Compare edges and details on all sides of the object; small turns show at its far ends.");
    }
    ui.add_space(12.0);
    ui.horizontal(|ui| {
        let size = Vec2::new(160.0, 36.0);
        // What is worth doing next stands out.
        let again = may_try_again.then(|| match feedback.is_good {
            true => Button::new("Try again").min_size(size),
            false => theme::primary_button("Try again").min_size(size),
        });
        let go_on = match may_try_again && !feedback.is_good {
            true => Button::new("Continue").min_size(size),
            false => theme::primary_button("Continue").min_size(size),
        };
        if again.is_some_and(|button| ui.add(button).clicked()) {
            requests.push(StudyRequest::TryAgain);
        }
        if ui.add(go_on).clicked() {
            requests.push(StudyRequest::GoOn);
        }
    });
}

/// Side by side; none where they could not be drawn.
fn pictures(ui: &mut Ui, shown: &Pictures) {
    const GAP: f32 = 8.0;
    let width = (ui.available_width() - 2.0 * GAP) / 3.0;
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        for (name, caption) in FEEDBACK_PICTURES.iter().zip(CAPTIONS) {
            let Some(texture) = shown.get(name) else { continue };
            let size = texture.size_vec2();
            ui.vertical(|ui| {
                ui.set_width(width);
                let image =
                    egui::Image::new((texture.id(), size * (width / size.x.max(1.0)))).corner_radius(4.0);
                let response = ui.add(image);
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, caption));
                ui.label(RichText::new(caption).small().weak());
            });
        }
    });
    ui.add_space(4.0);
}
