//! The last screen: whether the results have arrived, the code, the file, the way out.

use egui::{Button, RichText, Ui, Vec2};

use super::page::heading;
use super::{StudyRequest, StudyView, text};
use crate::ui::busy_mark::busy_mark;
use crate::ui::theme;

#[derive(Debug, Clone, Copy)]
pub struct FinishView<'a> {
    pub thanks: &'a str,
    pub sending: Sending<'a>,
    /// Once there is nothing left to wait for.
    pub code: Option<&'a str>,
    /// There is a page to go on to.
    pub can_redirect: bool,
    /// Whole seconds until the page goes there by itself.
    pub redirect_in: Option<u32>,
    pub is_kept_here: bool,
}

/// Where the results are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sending<'a> {
    /// The participant sends the file.
    ByHand,
    /// Which try of how many.
    UnderWay {
        attempt: u32,
        of: u32,
    },
    Arrived,
    Failed {
        reason: &'a str,
    },
}

const SIZE: Vec2 = Vec2::new(160.0, 36.0);

pub fn draw(ui: &mut Ui, view: &StudyView<'_>, finish: &FinishView<'_>, requests: &mut Vec<StudyRequest>) {
    match finish.sending {
        Sending::UnderWay { attempt, of } => {
            heading(ui, "Saving your results");
            ui.horizontal(|ui| {
                busy_mark(ui);
                ui.label(if attempt > 1 {
                    format!("The server did not answer. Try {attempt} of {of}…")
                } else {
                    "Please keep this page open for a moment…".to_owned()
                });
            });
            return;
        }
        Sending::Arrived => {
            heading(ui, "All done");
            let words = RichText::new("Your results have arrived.").color(theme::good(ui.visuals()));
            ui.label(words);
        }
        Sending::ByHand => {
            heading(ui, "All done");
            ui.label("Please download your results and send the file to whoever invited you.");
        }
        Sending::Failed { reason } => {
            heading(ui, "All done, but not sent yet");
            ui.label(RichText::new(reason).color(theme::error(ui.visuals())));
            ui.label("Please download your results and send the file to whoever invited you.");
        }
    }
    text::draw(ui, finish.thanks, view.pictures);
    if let Some(code) = finish.code {
        completion_code(ui, code, requests);
    }
    files(ui, finish, requests);
    if !view.contact.is_empty() {
        ui.label(RichText::new(format!("Questions: {}", view.contact)).weak());
    }
    if finish.can_redirect {
        ui.horizontal(|ui| {
            if ui.add(theme::primary_button("Continue").min_size(SIZE)).clicked() {
                requests.push(StudyRequest::Redirect);
            }
            if let Some(seconds) = finish.redirect_in {
                ui.label(format!("The page goes on in {seconds} s"));
            }
        });
    }
}

fn completion_code(ui: &mut Ui, code: &str, requests: &mut Vec<StudyRequest>) {
    ui.label("Your completion code:");
    ui.horizontal(|ui| {
        ui.label(RichText::new(code).monospace().size(22.0).strong());
        if ui.button("Copy code").clicked() {
            requests.push(StudyRequest::CopyCode);
        }
    });
}

/// The file is offered whatever happened.
fn files(ui: &mut Ui, finish: &FinishView<'_>, requests: &mut Vec<StudyRequest>) {
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        let is_first = matches!(finish.sending, Sending::ByHand | Sending::Failed { .. });
        let download = match is_first {
            true => theme::primary_button("Download results").min_size(SIZE),
            false => Button::new("Download results").min_size(SIZE),
        };
        if ui.add(download).clicked() {
            requests.push(StudyRequest::DownloadJson);
        }
        if ui.add(Button::new("As tables (CSV)").min_size(SIZE)).clicked() {
            requests.push(StudyRequest::DownloadCsv);
        }
        if matches!(finish.sending, Sending::Failed { .. })
            && ui.add(Button::new("Send again").min_size(SIZE)).clicked()
        {
            requests.push(StudyRequest::Retry);
        }
    });
    if finish.is_kept_here {
        ui.horizontal(|ui| {
            ui.label(RichText::new("A copy is kept in this browser.").weak());
            if ui.button("Remove it").clicked() {
                requests.push(StudyRequest::Forget);
            }
        });
    }
}
