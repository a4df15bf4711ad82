//! Messages that come and go; errors stay until they are read.

use egui::{Align2, Area, Id, Order, Sense, Vec2};

use super::icons::{Icon, icon_button};
use super::theme;
use crate::platform::SceneId;
use crate::session::{Notice, Severity};

/// Seconds that a message of no concern stays.
const INFO_SECONDS: f64 = 5.0;
const WARNING_SECONDS: f64 = 12.0;

/// More than this at once would hide the photo; the oldest go.
const MOST_SHOWN: usize = 6;

#[derive(Debug, Default)]
pub struct Toasts {
    shown: Vec<Toast>,
}

/// The way out that a message offers.
#[derive(Debug, Clone, PartialEq)]
pub enum Offer {
    /// A file with the open scene and everything in it.
    Workspace,
    /// What is stored of a scene, as a file.
    Stored(SceneId),
}

#[derive(Debug)]
struct Toast {
    notice: Notice,
    offer: Option<Offer>,
    /// Seconds of the interface's clock; unset until it is first drawn.
    expires: Option<f64>,
}

impl Toasts {
    pub fn add(&mut self, notice: Notice) {
        self.push(notice, None);
    }

    /// A message with a button below it.
    pub fn add_with_offer(&mut self, notice: Notice, offer: Offer) {
        self.push(notice, Some(offer));
    }

    fn push(&mut self, notice: Notice, offer: Option<Offer>) {
        self.shown.retain(|toast| toast.notice != notice);
        self.shown.push(Toast { notice, offer, expires: None });
        let surplus = self.shown.len().saturating_sub(MOST_SHOWN);
        self.shown.drain(..surplus);
    }

    /// The texts on screen, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.shown.iter().map(|toast| toast.notice.text.as_str())
    }

    /// The offer that was taken. Its message stays: a download may be wanted once more.
    pub fn draw(&mut self, ctx: &egui::Context) -> Option<Offer> {
        let now = ctx.input(|input| input.time);
        self.expire(ctx, now);
        if self.shown.is_empty() {
            return None;
        }
        let (mut closed, mut taken) = (None, None);
        Area::new(Id::unique("toasts"))
            .order(Order::Foreground)
            .anchor(Align2::RIGHT_BOTTOM, Vec2::new(-14.0, -14.0))
            .show(ctx, |ui| {
                for (index, toast) in self.shown.iter().enumerate() {
                    // Named by its text: a click is not lost when another message comes or goes between press and release.
                    match ui.push_id(&toast.notice.text, |ui| draw_one(ui, toast)).inner {
                        Some(Clicked::Close) => closed = Some(index),
                        Some(Clicked::Offer) => taken.clone_from(&toast.offer),
                        None => {}
                    }
                }
            });
        if let Some(index) = closed {
            self.shown.remove(index);
        }
        taken
    }

    fn expire(&mut self, ctx: &egui::Context, now: f64) {
        for toast in &mut self.shown {
            let seconds = match toast.notice.severity {
                Severity::Info => INFO_SECONDS,
                Severity::Warning => WARNING_SECONDS,
                Severity::Error => f64::INFINITY,
            };
            toast.expires.get_or_insert(now + seconds);
        }
        self.shown.retain(|toast| toast.expires.is_none_or(|expires| expires > now));
        let next = self.shown.iter().filter_map(|toast| toast.expires).fold(f64::INFINITY, f64::min);
        if next.is_finite() {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64((next - now).max(0.01)));
        }
    }
}

enum Clicked {
    Close,
    Offer,
}

fn draw_one(ui: &mut egui::Ui, toast: &Toast) -> Option<Clicked> {
    let color = match toast.notice.severity {
        Severity::Info => theme::ACCENT,
        Severity::Warning => theme::WARNING,
        Severity::Error => theme::ERROR,
    };
    let frame = theme::toast_frame(ui.visuals(), color);
    let mut clicked = None;
    frame.show(ui, |ui| {
        ui.set_width(330.0);
        ui.horizontal_top(|ui| {
            let (dot, _) = ui.allocate_exact_size(Vec2::new(12.0, 18.0), Sense::hover());
            ui.painter().circle_filled(dot.center(), 4.0, color);
            ui.vertical(|ui| {
                ui.set_width(268.0);
                ui.add(egui::Label::new(&toast.notice.text).wrap());
                let words = toast.offer.as_ref().map(|offer| match offer {
                    Offer::Workspace => "Download everything",
                    Offer::Stored(_) => "Download what is stored",
                });
                if words.is_some_and(|words| ui.add(theme::primary_button(words)).clicked()) {
                    clicked = Some(Clicked::Offer);
                }
            });
            if icon_button(ui, Icon::Close, "Close message", "Close", true).clicked() {
                clicked = Some(Clicked::Close);
            }
        });
    });
    clicked
}
