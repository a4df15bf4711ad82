//! The empty scene: what to drop, and a way to try without having anything.

use egui::{Align2, Area, CornerRadius, Id, Order, RichText, Sense, Stroke, StrokeKind, Ui, Vec2};

use super::busy_mark::busy_mark;
use super::scenes_dialog::words;
use super::{Asked, SceneRequest, Surroundings, theme};
use crate::session::{Command, CommandId};

const STEPS: [(&str, &str, &str); 3] = [
    ("1", "A photo", "PNG, JPEG, WebP, BMP or TIFF"),
    ("2", "A 3D mesh of the object", "PLY, OBJ, STL, GLB or OFF"),
    ("3", "The camera", "JSON, YAML, NumPy, or typed later"),
];

/// More would be a list; the dialog has that.
const RECENT_SCENES: usize = 4;

pub fn draw(ui: &mut Ui, around: &Surroundings<'_>, asked: &mut Asked) {
    let rect = ui.max_rect();
    if around.store.is_opening {
        opening(ui, rect);
        return;
    }
    // The whole ground takes the click too: a large target for the obvious thing.
    let ground = ui.interact(rect, Id::unique("welcome ground"), Sense::click());
    drop_border(ui, rect.shrink(18.0), around.files_hover);
    Area::new(Id::unique("welcome"))
        .order(Order::Middle)
        .fixed_pos(rect.center())
        .pivot(Align2::CENTER_CENTER)
        .show(ui.ctx(), |ui| {
            ui.set_width(430.0);
            ui.vertical_centered(|ui| card(ui, around, asked));
        });
    if ground.clicked() {
        asked.commands.push(Command::Run(CommandId::OpenFiles));
    }
}

/// What was saved is on its way: nothing here is to be clicked in the meantime.
fn opening(ui: &mut Ui, rect: egui::Rect) {
    let place = egui::Rect::from_center_size(rect.center(), Vec2::new(120.0, 24.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| {
        ui.horizontal(|ui| {
            busy_mark(ui);
            ui.label(RichText::new("Opening…").weak());
        });
    });
}

fn card(ui: &mut Ui, around: &Surroundings<'_>, asked: &mut Asked) {
    let title = if around.files_hover { "Let go to open" } else { "Drop your files here" };
    ui.heading(RichText::new(title).size(26.0).strong());
    ui.add_space(2.0);
    ui.label(RichText::new("and get the object's 6D pose. Nothing leaves this browser.").weak());
    ui.add_space(18.0);
    for (number, what, how) in STEPS {
        step(ui, number, what, how);
    }
    ui.add_space(16.0);
    ui.horizontal(|ui| {
        let width = 130.0;
        ui.add_space((ui.available_width() - 3.0 * width - 16.0) / 2.0);
        let size = Vec2::new(width, 34.0);
        if ui.add(theme::primary_button("Open files…").min_size(size)).clicked() {
            asked.commands.push(Command::Run(CommandId::OpenFiles));
        }
        if ui.add(egui::Button::new("Open folder…").min_size(size)).clicked() {
            asked.commands.push(Command::Run(CommandId::OpenFolder));
        }
        if ui.add(egui::Button::new("Try the example").min_size(size)).clicked() {
            asked.commands.push(Command::Run(CommandId::LoadExample));
        }
    });
    recent_scenes(ui, around, asked);
    ui.add_space(12.0);
    ui.label(
        RichText::new("Also: a data set (BOP, Linemod, MegaPose) as folder or zip, poses, a workspace")
            .small()
            .weak(),
    );
    if let Some(busy) = &around.busy {
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            ui.add_space(ui.available_width() / 2.0 - 60.0);
            busy_mark(ui);
            ui.label(&busy.text);
            if busy.can_cancel && ui.small_button("Cancel").clicked() {
                asked.cancel_loading = true;
            }
        });
    }
}

/// What was worked on last, to go on with.
fn recent_scenes(ui: &mut Ui, around: &Surroundings<'_>, asked: &mut Asked) {
    // An open scene that is empty is nothing to go on with.
    let others = around.scenes.iter().filter(|scene| around.store.open_scene != Some(&scene.id));
    let recent: Vec<_> = others.take(RECENT_SCENES).collect();
    if recent.is_empty() {
        return;
    }
    ui.add_space(14.0);
    ui.label(RichText::new("Go on with").weak());
    for scene in recent {
        let when = words::when_text(scene.heading.changed_at_ms, around.store.now_ms);
        let button = egui::Button::new(scene.heading.title())
            .truncate()
            .shortcut_text(when)
            .min_size(Vec2::new(308.0, 26.0));
        if ui.add_sized(Vec2::new(308.0, 26.0), button).clicked() {
            asked.scene_requests.push(SceneRequest::Open(scene.id.clone()));
        }
    }
    if around.scenes.len() > RECENT_SCENES && ui.link("All scenes…").clicked() {
        asked.scene_requests.push(SceneRequest::Show);
    }
}

fn step(ui: &mut Ui, number: &str, what: &str, how: &str) {
    ui.horizontal(|ui| {
        ui.add_space(64.0);
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(24.0), Sense::hover());
        let fill = ui.visuals().selection.bg_fill;
        ui.painter().circle_filled(rect.center(), 11.0, fill);
        ui.painter().text(
            rect.center(),
            Align2::CENTER_CENTER,
            number,
            egui::FontId::proportional(13.0),
            ui.visuals().selection.stroke.color,
        );
        ui.label(RichText::new(what).strong());
        ui.label(RichText::new(how).weak());
    });
}

fn drop_border(ui: &Ui, rect: egui::Rect, hovered: bool) {
    let quiet = ui.visuals().widgets.noninteractive.bg_stroke.color;
    let color = if hovered { theme::ACCENT } else { quiet };
    let stroke = Stroke::new(if hovered { 2.0 } else { 1.5 }, color);
    if hovered {
        ui.painter().rect(
            rect,
            CornerRadius::same(14),
            theme::ACCENT.gamma_multiply(0.08),
            stroke,
            StrokeKind::Inside,
        );
        return;
    }
    let corners =
        [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    ui.painter().extend(egui::Shape::dashed_line(&corners, stroke, 8.0, 7.0));
}
