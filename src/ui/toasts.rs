//! Messages that come and go; errors stay until they are read.

use egui::{Align2, Area, Id, Order, Sense, Vec2};

use super::icons::{Icon, icon_button};
use super::theme;
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

#[derive(Debug)]
struct Toast {
    notice: Notice,
    /// Seconds of the interface's clock; unset until it is first drawn.
    expires: Option<f64>,
}

impl Toasts {
    pub fn add(&mut self, notice: Notice) {
        self.shown.retain(|toast| toast.notice != notice);
        self.shown.push(Toast { notice, expires: None });
        let surplus = self.shown.len().saturating_sub(MOST_SHOWN);
        self.shown.drain(..surplus);
    }

    /// The texts on screen, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.shown.iter().map(|toast| toast.notice.text.as_str())
    }

    pub fn draw(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        self.expire(ctx, now);
        if self.shown.is_empty() {
            return;
        }
        let mut closed = None;
        Area::new(Id::unique("toasts"))
            .order(Order::Foreground)
            .anchor(Align2::RIGHT_BOTTOM, Vec2::new(-14.0, -14.0))
            .show(ctx, |ui| {
                for (index, toast) in self.shown.iter().enumerate() {
                    // Named by its text: a click is not lost when another message comes or goes between press and release.
                    if ui.push_id(&toast.notice.text, |ui| draw_one(ui, &toast.notice)).inner {
                        closed = Some(index);
                    }
                }
            });
        if let Some(index) = closed {
            self.shown.remove(index);
        }
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

/// Draws one message; true if it was closed.
fn draw_one(ui: &mut egui::Ui, notice: &Notice) -> bool {
    let color = match notice.severity {
        Severity::Info => theme::ACCENT,
        Severity::Warning => theme::WARNING,
        Severity::Error => theme::ERROR,
    };
    let frame = theme::toast_frame(ui.visuals(), color);
    let mut closed = false;
    frame.show(ui, |ui| {
        ui.set_width(330.0);
        ui.horizontal_top(|ui| {
            let (dot, _) = ui.allocate_exact_size(Vec2::new(12.0, 18.0), Sense::hover());
            ui.painter().circle_filled(dot.center(), 4.0, color);
            ui.vertical(|ui| {
                ui.set_width(268.0);
                ui.add(egui::Label::new(&notice.text).wrap());
            });
            closed = icon_button(ui, Icon::Close, "Close message", "Close", true).clicked();
        });
    });
    closed
}
