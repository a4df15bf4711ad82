//! The selected pose's pins: how well each fits, what is wrong with them, and how sure the pose is.

use egui::{Align, Layout, RichText, Ui, Vec2};

use super::list::ROW_HEIGHT;
use super::number_field::note;
use super::section::section;
use crate::scene::{Pin, PoseSource};
use crate::session::{Command, CommandId, PinChange, PinReport, RankedFit, Session};
use crate::ui::command_button::{command_button, command_icon};
use crate::ui::icons::{Icon, icon_button};

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((photo, object, annotation)) = session.selected_annotation() else { return };
    let mut asked = Vec::new();
    let clear = |ui: &mut Ui| {
        if !annotation.pins.is_empty()
            && command_icon(ui, Icon::Trash, CommandId::ClearPins, session).clicked()
        {
            asked.push(Command::Run(CommandId::ClearPins));
        }
    };
    let mut inside = Vec::new();
    section(ui, "Pins", true, clear, |ui| {
        let Some(report) = session.pin_report() else {
            let text =
                "With the Pin tool (X): click a point of the object, then drag it to its place in the photo.";
            note(ui, text, false);
            return;
        };
        for (number, pin) in annotation.pins.iter().enumerate() {
            row(ui, number, pin, &report, &mut inside);
        }
        advice(ui, &report);
        let set_pose = |camera_from_object| Command::SetPose {
            photo,
            object,
            camera_from_object,
            source: PoseSource::Pins,
        };
        fits(ui, &session.ranked_fits(), &mut inside, set_pose);
        actions(ui, session, &report, &mut inside);
    });
    commands.extend(asked.into_iter().chain(inside));
}

fn row(ui: &mut Ui, number: usize, pin: &Pin, report: &PinReport, commands: &mut Vec<Command>) {
    let size = Vec2::new(ui.available_width(), ROW_HEIGHT);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let mut enabled = pin.enabled;
        let checkbox = ui.checkbox(&mut enabled, format!("Pin {}", number + 1));
        if checkbox.on_hover_text("Whether this pin pulls on the pose").changed() {
            commands.push(Command::EditPins(PinChange::Enabled(number, enabled)));
        }
        let is_misclick = report.misclicks.contains(&number);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let label = format!("Remove pin {}", number + 1);
            if icon_button(ui, Icon::Close, &label, &label, true).clicked() {
                commands.push(Command::EditPins(PinChange::Remove(number)));
            }
            let residual = report.residuals_px.get(number).copied().flatten();
            let words = residual.map_or("behind the camera".to_owned(), |r| format!("{:.1} px", r.length()));
            let words = RichText::new(words);
            let warning = ui.visuals().warn_fg_color;
            let words = if is_misclick { words.color(warning) } else { words.weak() };
            ui.label(words).on_hover_text("From where the pin is to where the pose has its point");
            if is_misclick {
                let tooltip =
                    "The other pins contradict this one, so it was left out: look at it again, or remove it";
                ui.label(RichText::new("misplaced?").small().color(warning)).on_hover_text(tooltip);
            }
        });
    });
}

fn advice(ui: &mut Ui, report: &PinReport) {
    for advice in &report.advice {
        note(ui, &advice.to_string(), false);
    }
}

/// The poses that the pins allow, the one that the photo supports most first, and what that means.
fn fits(
    ui: &mut Ui,
    fits: &[RankedFit],
    commands: &mut Vec<Command>,
    take: impl Fn(crate::math::Pose) -> Command,
) {
    for fit in fits {
        ui.horizontal(|ui| {
            let is_present = fit.number == 0;
            let button = ui.add(egui::Button::new(name_of(fit)).selected(is_present));
            let tooltip = if is_present {
                "The pose as it is"
            } else {
                "Take this pose instead; it is outlined in the view"
            };
            if button.on_hover_text(tooltip).clicked() && !is_present {
                commands.push(take(fit.camera_from_object));
            }
            ui.label(RichText::new(format!("{:.1} px", fit.rms_px)).weak());
            if let Some(score) = fit.score {
                ui.label(format!("{:.0} %", 100.0 * score)).on_hover_text(
                    "How well the photo's colours and edges agree with the outline: 0 % is chance",
                );
            }
        });
    }
    if let Some((words, is_warning)) = photo_says(fits) {
        note(ui, &words, is_warning);
    }
}

fn name_of(fit: &RankedFit) -> String {
    if fit.number == 0 { "Present fit".to_owned() } else { format!("Other fit {}", fit.number) }
}

/// Scores closer than this may be in this order by chance.
const CLEAR_LEAD: f64 = 0.03;

/// Which fit the photo is for, and whether that is another one than the present; `None` until it was looked.
fn photo_says(fits: &[RankedFit]) -> Option<(String, bool)> {
    let (first, others) = fits.split_first()?;
    let best = first.score?;
    let next = others.iter().filter_map(|fit| fit.score).fold(0.0, f64::max);
    if best < next + CLEAR_LEAD {
        return Some(("The photo hardly tells these fits apart.".to_owned(), false));
    }
    let name = name_of(first).to_lowercase();
    Some((format!("The photo supports the {name} most."), first.number != 0))
}

fn actions(ui: &mut Ui, session: &Session, report: &PinReport, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(4.0, 4.0);
        let mut offer = |ui: &mut Ui, id: CommandId, text: &str| {
            if command_button(ui, egui::Button::new(text), id.info(), session) {
                commands.push(Command::Run(id));
            }
        };
        if !report.is_solved {
            offer(ui, CommandId::SolvePins, "Pose from pins");
        }
        if session.unavailable(CommandId::FocalFromPins).is_none() {
            offer(ui, CommandId::FocalFromPins, "Focal length");
        }
        offer(ui, CommandId::CopyPinsToNext, "To next photo");
        offer(ui, CommandId::ExportPins, "Save");
    });
}
