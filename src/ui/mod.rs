//! The interface: panels, viewport, dialogs. Reads a [`Session`] and returns commands; changes nothing itself.

mod camera_panel;
mod dialogs;
mod icons;
mod pose_panel;
mod scene_panel;
mod shortcuts;
mod theme;
mod toasts;
mod top_bar;
mod viewport;
mod welcome;

use egui::{CentralPanel, Frame, Panel};

use crate::interact::{Hands, SceneMove};
use crate::session::{Command, Session};

pub use shortcuts::{Pressed, is_released, pressed_commands, shortcut_text};
pub use theme::apply_theme;
pub use toasts::Toasts;
pub use viewport::{SharedRenderer, ViewportPlace};

/// What the interface keeps for itself between frames.
#[derive(Debug, Default)]
pub struct UiState {
    pub panels_hidden: bool,
    /// The window that is open over everything.
    pub open: Option<Dialog>,
    pub toasts: Toasts,
    camera_form: camera_panel::CameraForm,
    /// Where the photo view and the scene view were in the last frame; `None` where they were not on screen.
    pub viewport: Option<ViewportPlace>,
    pub scene_viewport: Option<ViewportPlace>,
    split: viewport::SplitState,
}

/// Windows that come up over the rest, one at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialog {
    Shortcuts,
    Palette,
    PastePose,
}

impl UiState {
    pub fn toggle(&mut self, dialog: Dialog) {
        self.open = if self.open == Some(dialog) { None } else { Some(dialog) };
    }
}

/// What the interface shows besides the session.
pub struct Surroundings<'a> {
    pub hands: &'a Hands,
    pub renderer: Option<&'a SharedRenderer>,
    /// The pixels of the photo that is shown, once they are decoded.
    pub pixels: Option<std::sync::Arc<crate::photo::Pixels>>,
    pub saving: Saving,
    /// What is being loaded, for the user to read.
    pub busy: Option<String>,
    pub update_ready: bool,
    /// Files are being dragged over the window.
    pub files_hover: bool,
}

/// Is the scene in the browser's storage?
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Saving {
    #[default]
    Saved,
    Pending,
    Failed(String),
}

/// What the user asked for in this frame.
#[derive(Debug, Default)]
pub struct Asked {
    pub commands: Vec<Command>,
    pub scene_move: Option<SceneMove>,
    pub apply_update: bool,
}

/// Draws a whole frame.
pub fn draw(ui: &mut egui::Ui, session: &Session, around: &Surroundings<'_>, state: &mut UiState) -> Asked {
    let mut asked = Asked::default();
    Panel::top("top bar").frame(theme::bar_frame()).show(ui, |ui| {
        top_bar::draw(ui, session, around, &mut asked);
    });
    // An empty scene has nothing to list.
    if !state.panels_hidden && !session.scene().is_empty() {
        Panel::left("side panel")
            .frame(theme::panel_frame())
            .exact_size(theme::PANEL_WIDTH)
            .resizable(false)
            .show(ui, |ui| side_panel(ui, session, &mut state.camera_form, &mut asked.commands));
    }
    CentralPanel::default().frame(Frame::NONE.fill(theme::VIEWPORT_BACKGROUND)).show(ui, |ui| {
        if session.scene().is_empty() {
            (state.viewport, state.scene_viewport) = (None, None);
            welcome::draw(ui, around, &mut asked.commands);
        } else {
            viewport::draw(ui, session, around, state, &mut asked);
        }
    });
    dialogs::draw(ui.ctx(), session, state, &mut asked.commands);
    state.toasts.draw(ui.ctx());
    asked
}

fn side_panel(
    ui: &mut egui::Ui,
    session: &Session,
    camera_form: &mut camera_panel::CameraForm,
    commands: &mut Vec<Command>,
) {
    // What changes under the hand stays in sight, however long the lists are.
    Panel::bottom("side panel foot").frame(Frame::NONE).show(ui, |ui| {
        scene_panel::overlay(ui, session, commands);
        pose_panel::draw(ui, session, commands);
    });
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        scene_panel::photos(ui, session, commands);
        camera_panel::draw(ui, session, camera_form, commands);
        scene_panel::objects(ui, session, commands);
        scene_panel::references(ui, session, commands);
        ui.add_space(8.0);
    });
}
