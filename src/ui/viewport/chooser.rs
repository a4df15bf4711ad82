//! Which views, and how the meshes are drawn in them: two quiet choices in a corner.

use egui::{Align2, Area, ComboBox, Id, Order, Rect, Ui, Vec2};

use crate::scene::{Look, OverlayMode};
use crate::session::{Arrangement, Command, CommandId, Session};
use crate::ui::theme;

/// Which of the two are offered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choices {
    pub views: bool,
    pub modes: bool,
}

impl Choices {
    pub const ALL: Self = Self { views: true, modes: true };
}

/// What the choices are drawn in, for others that keep clear of them.
pub fn area() -> Id {
    Id::unique("view chooser")
}

pub fn draw(ui: &Ui, whole: Rect, session: &Session, choices: Choices, commands: &mut Vec<Command>) {
    if session.photo().is_none() || !(choices.views || choices.modes) {
        return;
    }
    Area::new(area())
        .order(Order::Middle)
        .pivot(Align2::LEFT_TOP)
        .fixed_pos(whole.left_top() + Vec2::splat(10.0))
        .constrain_to(whole)
        .show(ui.ctx(), |ui| {
            theme::overlay_frame().show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 2.0;
                    if choices.views {
                        arrangement(ui, session, commands);
                    }
                    if choices.views && choices.modes {
                        ui.add_space(6.0);
                    }
                    if choices.modes {
                        overlay_mode(ui, session, commands);
                    }
                });
            });
        });
}

fn arrangement(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let present = session.panes().arrangement;
    for (arrangement, text, id) in [
        (Arrangement::Photo, "Photo", CommandId::PhotoView),
        (Arrangement::Scene, "Scene", CommandId::SceneView),
        (Arrangement::Split, "Both", CommandId::SplitView),
    ] {
        let button = ui.selectable_label(present == arrangement, text).on_hover_text(id.info().tooltip);
        if button.clicked() {
            commands.push(Command::Run(id));
        }
    }
}

fn overlay_mode(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let look = session.look();
    let combo = ComboBox::from_id_salt("overlay mode")
        .selected_text(look.mode.title())
        .width(92.0)
        .height(320.0)
        .show_ui(ui, |ui| {
            for (mode, _, title) in OverlayMode::ALL {
                if ui.selectable_label(look.mode == mode, title).clicked() {
                    commands.push(Command::SetLook(Look { mode, ..look }));
                }
            }
        });
    combo.response.on_hover_text("How the meshes are drawn (O: the next one)");
}
