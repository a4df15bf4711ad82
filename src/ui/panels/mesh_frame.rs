//! Unit, axes, mirror and spacing of the selected object's mesh, and how large it is.

use egui::Ui;

use super::number_field::{NumberField, column_width, note, refusal};
use super::section::section;
use crate::mesh::{FileUnit, MeshUnit};
use crate::scene::{MeshFrame, Object, ObjectId};
use crate::session::{Command, ObjectChange, Session};
use crate::ui::icons::{Icon, icon_button};

#[derive(Debug, Default)]
pub struct MeshForm {
    refused: Option<(ObjectId, String)>,
    /// A spacing under the mouse: the mesh is made anew when the mouse lets go.
    dragged: Option<(ObjectId, usize, f64)>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

pub fn draw(ui: &mut Ui, session: &Session, form: &mut MeshForm, commands: &mut Vec<Command>) {
    let Some(object) = session.selected().and_then(|id| session.scene().object(id)) else { return };
    let mut asked = Vec::new();
    let reset = |ui: &mut Ui| {
        let is_plain = object.mesh_from_file == glam::DMat4::IDENTITY;
        let tooltip = if is_plain { "The mesh is as in its file" } else { "The mesh as it is in its file" };
        if icon_button(ui, Icon::Reset, "Reset mesh", tooltip, !is_plain).clicked() {
            let frame = MeshFrame(glam::DMat4::IDENTITY);
            asked.push(Command::EditObject(object.id, ObjectChange::MeshFrame(frame)));
        }
    };
    section(ui, "Mesh", false, reset, |ui| {
        ui.add_enabled_ui(!object.locked, |ui| {
            choices(ui, object, commands);
            spacing(ui, object, form, commands);
        });
        if let Some((_, reason)) = form.refused.as_ref().filter(|(refused, _)| *refused == object.id) {
            refusal(ui, reason);
        }
        info(ui, object);
    });
    commands.append(&mut asked);
}

/// The unit of the file's numbers, and which of its axes points up.
fn choices(ui: &mut Ui, object: &Object, commands: &mut Vec<Command>) {
    let frame = MeshFrame(object.mesh_from_file);
    let file = object.mesh.file_unit();
    let mut chosen = None;
    egui::Grid::new("mesh choices").num_columns(2).spacing(ui.spacing().item_spacing).show(ui, |ui| {
        ui.label("Unit");
        ui.horizontal(|ui| {
            let present = frame.unit(file);
            for unit in MeshUnit::ALL {
                let tooltip = format!("The numbers in the mesh's file are {unit}{}", said_by(file, unit));
                let (symbol, name) = (unit.symbol(), format!("Unit {unit}"));
                if choice_button(ui, symbol, &name, &tooltip, present == Some(unit)) {
                    chosen = Some(ObjectChange::MeshUnit(unit));
                }
            }
        });
        ui.end_row();
        ui.label("Up");
        ui.horizontal(|ui| {
            let present = frame.up_axis();
            for (axis, letter) in AXES.into_iter().enumerate() {
                let tooltip = format!(
                    "The {letter} axis of the mesh's file points up: it becomes the object's z axis. Poses stay as they are"
                );
                let name = format!("Up is {letter}");
                if choice_button(ui, letter, &name, &tooltip, present == Some(axis)) {
                    chosen = Some(ObjectChange::UpAxis(axis));
                }
            }
        });
        ui.end_row();
        ui.label("Mirror");
        mirror(ui, object, commands);
        ui.end_row();
    });
    commands.extend(chosen.map(|change| Command::EditObject(object.id, change)));
}

fn said_by(file: FileUnit, unit: MeshUnit) -> &'static str {
    match file {
        FileUnit::Gltf if unit == MeshUnit::Metre => ", as in every glTF",
        FileUnit::Named(named) if unit == named => ", as it says itself",
        _ => "",
    }
}

/// One of a few that exclude each other; true if it was chosen anew.
fn choice_button(ui: &mut Ui, text: &str, name: &str, tooltip: &str, is_chosen: bool) -> bool {
    let button = egui::Button::selectable(is_chosen, text).frame_when_inactive(true);
    let response = ui.add_sized([34.0, 22.0], button);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
    response.on_hover_text(tooltip).clicked() && !is_chosen
}

fn mirror(ui: &mut Ui, object: &Object, commands: &mut Vec<Command>) {
    let frame = MeshFrame(object.mesh_from_file);
    ui.horizontal(|ui| {
        for (axis, name) in AXES.into_iter().enumerate() {
            let button = egui::Button::selectable(frame.is_mirrored(axis), name);
            let response = ui.add_sized([34.0, 22.0], button.frame_when_inactive(true));
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(format!("Mirror {name}")));
            let tooltip = format!("Mirror the mesh along its {name} axis, about the mesh's own origin");
            if response.on_hover_text(tooltip).clicked() {
                commands.push(Command::EditObject(object.id, ObjectChange::MeshFrame(frame.mirrored(axis))));
            }
        }
    });
}

fn spacing(ui: &mut Ui, object: &Object, form: &mut MeshForm, commands: &mut Vec<Command>) {
    let frame = MeshFrame(object.mesh_from_file);
    let factor = object.mesh.file_unit().loaded_factor();
    let present = frame.spacing() * factor;
    let width = column_width(ui, 3);
    note(ui, "Spacing: mm per unit of the file", false);
    ui.horizontal(|ui| {
        for (axis, label) in AXES.into_iter().enumerate() {
            let held = form.dragged.filter(|(id, dragged, _)| (*id, *dragged) == (object.id, axis));
            let mut value = held.map_or(present[axis], |(.., value)| value);
            let name = format!("spacing {label}");
            let field = NumberField {
                label,
                name: &name,
                tooltip: "Millimetres per unit of the mesh's file, about the mesh's own origin",
                speed: 0.005,
                decimals: 6,
                ..NumberField::default()
            };
            let response = field.show(ui, width, 14.0, &mut value);
            if response.dragged() {
                form.dragged = Some((object.id, axis, value));
            } else if response.changed() || response.drag_stopped() {
                form.dragged = None;
                take_spacing(object, axis, value, form, commands);
            } else if held.is_some() {
                form.dragged = None;
            }
        }
    });
}

fn take_spacing(object: &Object, axis: usize, value: f64, form: &mut MeshForm, commands: &mut Vec<Command>) {
    let frame = MeshFrame(object.mesh_from_file);
    let factor = object.mesh.file_unit().loaded_factor();
    match frame.with_spacing(axis, value / factor) {
        Ok(changed) => {
            form.refused = None;
            if changed != frame {
                commands.push(Command::EditObject(object.id, ObjectChange::MeshFrame(changed)));
            }
        }
        Err(error) => {
            let text =
                format!("Not taken: {error}; {} stays {}.", AXES[axis], frame.spacing()[axis] * factor);
            form.refused = Some((object.id, text));
        }
    }
}

fn info(ui: &mut Ui, object: &Object) {
    let mesh = &object.mesh.mesh;
    let size = mesh.bounds().size();
    let [x, y, z] = size.to_array();
    let triangles = mesh.triangles().len();
    note(ui, &format!("{x:.1} × {y:.1} × {z:.1} mm, {triangles} triangles"), false);
}
