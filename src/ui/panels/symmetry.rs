//! Which turns leave the selected object's mesh as it is: listed, added, accepted from what was found, and shown.

use egui::{Align, DragValue, Layout, RichText, Ui, Vec2};
use glam::DVec3;

use super::list::ROW_HEIGHT;
use super::number_field::{NumberField, column_width, note};
use super::section::section;
use crate::scene::{Fold, Object, ObjectId, SymmetryAxis};
use crate::session::{Command, CommandId, ObjectChange, Session};
use crate::solve::symmetry::{FoundSymmetries, FoundSymmetry, TOLERANCE};
use crate::ui::SymmetryView;
use crate::ui::command_button::command_button;
use crate::ui::icons::{Icon, icon_button};

/// More turns about one axis than this are as good as all.
const MOST_TIMES: u32 = 60;

/// What the section keeps between frames.
#[derive(Debug, Default)]
pub struct SymmetryForm {
    /// The axis that is being written, of this object.
    new: Option<(ObjectId, SymmetryAxis)>,
    /// Under the pointer, or being written: drawn in the views.
    lit: Option<SymmetryAxis>,
    asked_turn: Option<SymmetryAxis>,
}

impl SymmetryForm {
    /// The axis to be drawn over the selected object.
    pub fn lit(&self) -> Option<SymmetryAxis> {
        self.lit
    }

    /// The turn that the user wants to see.
    pub fn take_asked_turn(&mut self) -> Option<SymmetryAxis> {
        self.asked_turn.take()
    }
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    search: SymmetryView<'_>,
    form: &mut SymmetryForm,
    commands: &mut Vec<Command>,
) {
    form.lit = None;
    let Some(object) = session.selected().and_then(|id| session.scene().object(id)) else { return };
    let body = |ui: &mut Ui| {
        ui.add_enabled_ui(!object.locked, |ui| {
            present(ui, object, form, commands);
            found(ui, object, search, form, commands);
            new_axis(ui, object, form, commands);
        });
        if form.new.is_none_or(|(id, _)| id != object.id) {
            actions(ui, session, object, form, commands);
        }
    };
    section(ui, "Symmetry", false, |_| {}, body);
}

fn actions(
    ui: &mut Ui,
    session: &Session,
    object: &Object,
    form: &mut SymmetryForm,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        let button = egui::Button::new("Find symmetries");
        if command_button(ui, button, CommandId::FindSymmetries.info(), session) {
            commands.push(Command::Run(CommandId::FindSymmetries));
        }
        let button = ui.add_enabled(!object.locked, egui::Button::new("Add axis…"));
        if button.on_hover_text("Write an axis by hand").clicked() {
            let through_mm = object.mesh.mesh.bounds().center();
            form.new = Some((object.id, SymmetryAxis { axis: DVec3::Z, through_mm, fold: Fold::Times(2) }));
        }
    });
}

/// The axes that the object has.
fn present(ui: &mut Ui, object: &Object, form: &mut SymmetryForm, commands: &mut Vec<Command>) {
    let axes = object.symmetries.axes(&object.mesh.mesh.sphere());
    if axes.is_empty() {
        note(ui, "None: every turn of this object counts as another pose.", false);
    }
    for axis in &axes {
        row(ui, axis, &words(axis), None, form, |ui, name| {
            let tooltip = "Remove the turns about this axis";
            if icon_button(ui, Icon::Close, &format!("Remove {name}"), tooltip, true).clicked() {
                commands.push(Command::EditObject(object.id, ObjectChange::RemoveSymmetry(*axis)));
            }
        });
    }
}

/// What the search found, with what speaks for it, as long as it is not accepted.
fn found(
    ui: &mut Ui,
    object: &Object,
    search: SymmetryView<'_>,
    form: &mut SymmetryForm,
    commands: &mut Vec<Command>,
) {
    let Some((_, found)) = search.found.filter(|(mesh, _)| std::sync::Arc::ptr_eq(mesh, &object.mesh)) else {
        return;
    };
    let around = object.mesh.mesh.sphere();
    let is_open = |found: &&FoundSymmetry| {
        !found.axis.turns().iter().all(|turn| object.symmetries.holds(turn, &around))
    };
    let open: Vec<&FoundSymmetry> = found.found.iter().filter(is_open).collect();
    if found.found.is_empty() {
        note(ui, "Found: no turn that leaves the mesh as it is.", false);
    } else if !open.is_empty() {
        note(ui, "Found: does the object look the same too? Colours count.", false);
    }
    for found_axis in &open {
        found_row(ui, object, found_axis, found, form, commands);
    }
    if open.len() > 1 && ui.button("Accept all").on_hover_text("Add all that were found").clicked() {
        let add =
            |found: &&FoundSymmetry| Command::EditObject(object.id, ObjectChange::AddSymmetry(found.axis));
        commands.extend(open.iter().map(add));
    }
    let nearly: Vec<&FoundSymmetry> = found.nearly.iter().filter(is_open).collect();
    if !nearly.is_empty() {
        let text = format!("Nearly, but off by more than {:.0} % somewhere:", 100.0 * TOLERANCE);
        note(ui, &text, false);
    }
    for near in nearly {
        found_row(ui, object, near, found, form, commands);
    }
}

fn found_row(
    ui: &mut Ui,
    object: &Object,
    axis: &FoundSymmetry,
    found: &FoundSymmetries,
    form: &mut SymmetryForm,
    commands: &mut Vec<Command>,
) {
    let part = |mm: f64| 100.0 * mm / found.diameter_mm;
    let evidence = format!("{:.1} %", part(axis.worst_mm));
    let tooltip = format!(
        "How far the turned surface is from the surface: {:.2} mm at worst, {:.2} mm in the mean; {:.2} % and {:.2} % of the diameter",
        axis.worst_mm,
        axis.mean_mm,
        part(axis.worst_mm),
        part(axis.mean_mm)
    );
    row(ui, &axis.axis, &words(&axis.axis), Some((&evidence, &tooltip)), form, |ui, name| {
        let label = format!("Accept {name}");
        if icon_button(ui, Icon::Check, &label, "The object looks the same after this turn", true).clicked() {
            commands.push(Command::EditObject(object.id, ObjectChange::AddSymmetry(axis.axis)));
        }
    });
}

/// An axis: its words, what speaks for it, a button that shows the turn, and one more.
fn row(
    ui: &mut Ui,
    axis: &SymmetryAxis,
    words: &str,
    evidence: Option<(&str, &str)>,
    form: &mut SymmetryForm,
    button: impl FnOnce(&mut Ui, &str),
) {
    let size = Vec2::new(ui.available_width(), ROW_HEIGHT);
    let layout = Layout::right_to_left(Align::Center);
    let inner = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        button(ui, words);
        let tooltip = "Turn the object about this axis, on the screen only";
        if icon_button(ui, Icon::Roll { left: true }, &format!("Show {words}"), tooltip, true).clicked() {
            form.asked_turn = Some(*axis);
        }
        if let Some((text, tooltip)) = evidence {
            ui.label(RichText::new(text).small().weak()).on_hover_text(tooltip);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(egui::Label::new(words).truncate());
        });
    });
    if ui.rect_contains_pointer(inner.response.rect) {
        form.lit = Some(*axis);
    }
}

/// The axis that is being written: turns, direction, a point of it.
fn new_axis(ui: &mut Ui, object: &Object, form: &mut SymmetryForm, commands: &mut Vec<Command>) {
    let Some((_, mut axis)) = form.new.filter(|(id, _)| *id == object.id) else { return };
    ui.separator();
    ui.horizontal(|ui| {
        let mut times = match axis.fold {
            Fold::Times(times) => times,
            Fold::Continuous => 2,
        };
        let mut is_continuous = axis.fold == Fold::Continuous;
        let field = DragValue::new(&mut times).range(2..=MOST_TIMES).speed(0.05).suffix("-fold");
        let field = ui.add_enabled(!is_continuous, field);
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("Turns about the new axis"));
        field.on_hover_text("How often the object looks the same in a whole turn");
        ui.checkbox(&mut is_continuous, "Any turn").on_hover_text("It is round about this axis");
        axis.fold = if is_continuous { Fold::Continuous } else { Fold::Times(times) };
    });
    ui.horizontal(|ui| {
        ui.label("Axis");
        for (name, direction) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
            let button = egui::Button::selectable(axis.axis == direction, name).frame_when_inactive(true);
            let response = ui.add_sized([34.0, 22.0], button);
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(format!("Axis along {name}")));
            if response.clicked() {
                axis.axis = direction;
            }
        }
    });
    vector_fields(ui, ["ax", "ay", "az"], "Direction of the axis", 0.01, &mut axis.axis);
    ui.horizontal(|ui| {
        ui.label("Through");
        for (name, point) in [("Middle", object.mesh.mesh.bounds().center()), ("Origin", DVec3::ZERO)] {
            let button = egui::Button::selectable(axis.through_mm == point, name).frame_when_inactive(true);
            if ui.add(button).on_hover_text("A point of the axis").clicked() {
                axis.through_mm = point;
            }
        }
    });
    vector_fields(ui, ["px", "py", "pz"], "A point of the axis, mm", 0.1, &mut axis.through_mm);
    form.lit = form.lit.or(SymmetryAxis { axis: axis.axis.normalize_or_zero(), ..axis }.into());
    form.new = Some((object.id, axis));
    ui.horizontal(|ui| {
        if ui.button("Add").on_hover_text("Add the turns about this axis").clicked() {
            commands.push(Command::EditObject(object.id, ObjectChange::AddSymmetry(axis)));
            form.new = None;
        }
        if ui.button("Try it").on_hover_text("Turn the object about this axis, on the screen only").clicked()
        {
            form.asked_turn =
                axis.axis.try_normalize().map(|direction| SymmetryAxis { axis: direction, ..axis });
        }
        if ui.button("Cancel").clicked() {
            form.new = None;
        }
    });
}

fn vector_fields(ui: &mut Ui, names: [&str; 3], tooltip: &str, speed: f64, vector: &mut DVec3) {
    let width = column_width(ui, 3);
    ui.horizontal(|ui| {
        for ((name, label), value) in names.into_iter().zip(["x", "y", "z"]).zip(vector.as_mut()) {
            let field = NumberField {
                label,
                name,
                tooltip,
                speed,
                decimals: 4,
                live: true,
                ..NumberField::default()
            };
            field.show(ui, width, 14.0, value);
        }
    });
}

/// "6-fold about z", or about a direction in numbers.
fn words(axis: &SymmetryAxis) -> String {
    /// What rounds to the letter's own direction.
    const STRAIGHT: f64 = 0.9999;
    let letters = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];
    match letters.into_iter().find(|(_, letter)| axis.axis.dot(*letter).abs() > STRAIGHT) {
        Some((letter, _)) => format!("{} about {letter}", axis.fold),
        None => {
            // A zero has no sign.
            let [x, y, z] = axis.axis.to_array().map(|part| if part.abs() < 0.005 { 0.0 } else { part });
            format!("{} about ({x:.2}, {y:.2}, {z:.2})", axis.fold)
        }
    }
}
