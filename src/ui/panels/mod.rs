//! The side panel: control above, display below, and the output at its foot.

mod camera;
mod depth;
mod history;
mod list;
mod look;
mod masks;
mod mesh_frame;
mod nudge;
mod number_field;
mod objects;
mod output;
mod photos;
mod pins;
mod pose_fields;
mod pose_numbers;
mod references;
mod scene_view;
mod section;
mod sureness;
mod symmetry;

use egui::{Frame, Panel, Ui, UiBuilder};

use super::{Preferences, ShownMotion, Surroundings};
use crate::scene::{ObjectId, PhotoId, SymmetryAxis};
use crate::session::{Command, Session};

/// How wide the panel may be dragged.
pub const WIDTHS: std::ops::RangeInclusive<f32> = 240.0..=420.0;

/// What of the output is always in sight: its title and a row of the matrix.
const LEAST_OUTPUT_HEIGHT: f32 = 60.0;
/// At first: the matrix and a few lines of the history, less on a low screen.
const FIRST_OUTPUT: f32 = 0.27;
const FIRST_OUTPUT_HEIGHTS: (f32, f32) = (150.0, 230.0);
/// Of the panel, for the output at most.
const MOST_OUTPUT: f32 = 0.7;

/// What the panel keeps between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    camera: camera::CameraForm,
    pose: pose_fields::PoseForm,
    mesh: mesh_frame::MeshForm,
    symmetry: symmetry::SymmetryForm,
    sureness: sureness::SurenessForm,
    rename: Option<list::Rename>,
    /// As of the last frame: another one comes into sight in its list.
    shown_photo: Option<PhotoId>,
    shown_object: Option<ObjectId>,
    /// Where a range of objects begins that is chosen with Shift.
    range_anchor: Option<ObjectId>,
    errors: references::ErrorCache,
    output: output::OutputState,
}

impl PanelState {
    /// Puts the selected object's name under the cursor.
    pub fn rename_selected(&mut self, session: &Session) {
        let object = session.selected().and_then(|id| session.scene().object(id));
        self.rename = object.map(|object| {
            let key = list::RowKey { list: list::List::Objects, id: object.id.0 };
            list::Rename::new(key, &object.name)
        });
    }

    /// The axis of symmetry to be drawn over the selected object.
    pub fn lit_axis(&self) -> Option<SymmetryAxis> {
        self.symmetry.lit()
    }

    /// The motion of the selected object that the user wants to see.
    pub fn take_asked_motion(&mut self) -> Option<ShownMotion> {
        let turn = self.symmetry.take_asked_turn().map(ShownMotion::Turn);
        turn.or_else(|| self.sureness.take_asked_sway().map(ShownMotion::Sway))
    }
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    preferences: &mut Preferences,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    // A child of its own: nothing in it, however wide, makes the panel wider than it was dragged.
    let rect = ui.available_rect_before_wrap();
    let mut inside = ui.new_child(UiBuilder::new().max_rect(rect));
    inside.set_clip_rect(rect.intersect(ui.clip_rect()));
    parts(&mut inside, session, around, preferences, state, commands);
    ui.advance_cursor_after_rect(rect);
}

fn parts(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    preferences: &mut Preferences,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    let most = (ui.available_height() * MOST_OUTPUT).max(LEAST_OUTPUT_HEIGHT);
    let (low, high) = FIRST_OUTPUT_HEIGHTS;
    let first = (ui.available_height() * FIRST_OUTPUT).clamp(low, high).min(most);
    let frame = Frame::NONE.inner_margin(egui::Margin { left: 0, right: 8, top: 4, bottom: 4 });
    let panel = if state.output.folded {
        Panel::bottom("output folded").resizable(false)
    } else {
        Panel::bottom("output").resizable(true).default_size(first).size_range(LEAST_OUTPUT_HEIGHT..=most)
    };
    panel.frame(frame).show(ui, |ui| output::draw(ui, session, &mut state.output, commands));
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        control_and_display(ui, session, around, preferences, state, commands);
    });
}

fn control_and_display(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    preferences: &mut Preferences,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    // The scroll bar floats over the right margin.
    ui.set_max_width(ui.available_width() - 8.0);
    ui.spacing_mut().item_spacing.y = 2.0;
    section::caption(ui, "Control");
    camera::draw(ui, session, &mut state.camera, commands);
    pins::draw(ui, session, commands);
    sureness::draw(ui, session, &mut preferences.tolerances, &mut state.sureness);
    pose_fields::draw(ui, session, &mut state.pose, commands);
    mesh_frame::draw(ui, session, &mut state.mesh, commands);
    symmetry::draw(ui, session, around.symmetries, &mut state.symmetry, commands);
    nudge::draw(ui, session, commands);
    scene_view::draw(ui, session, commands);
    section::caption(ui, "Display");
    photos::draw(ui, session, state, commands);
    objects::draw(ui, session, state, commands);
    masks::draw(ui, session, state, commands);
    depth::draw(ui, session, commands);
    references::draw(ui, session, &mut state.errors, commands);
    look::draw(ui, session, commands);
    ui.add_space(8.0);
}
