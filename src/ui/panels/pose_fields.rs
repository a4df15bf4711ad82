//! The selected object's pose, typed or dragged number by number, or pasted as text.

use egui::{Button, RichText, TextEdit, Ui};
use glam::DVec3;

use super::number_field::{NumberField, column_width, note, refusal};
use super::pose_numbers::RotationForm;
use super::section::section;
use crate::formats::{PoseText, read_pose_text, write_pose_text};
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, ObjectId, PhotoId, PoseSource};
use crate::session::{Command, CommandId, Session};
use crate::ui::command_button::command_button;

#[derive(Debug, Default)]
pub struct PoseForm {
    form: RotationForm,
    numbers: Option<Numbers>,
    /// Text under way, and the pose's place that it is for.
    text: Option<((PhotoId, ObjectId), String)>,
    refused: Option<((PhotoId, ObjectId), String)>,
    /// A field is being dragged: one undo step.
    dragging: bool,
}

/// Numbers as they were typed, as long as the pose is the one that they gave: 190° stays 190°, a quaternion can be typed one
/// number after the other.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    form: RotationForm,
    pose: Pose,
    rotation: [f64; 4],
}

/// What a field did in this frame.
#[derive(Debug, Default, Clone, Copy)]
struct Touched {
    changed: bool,
    drag_started: bool,
    dragged: bool,
    drag_stopped: bool,
}

pub fn draw(ui: &mut Ui, session: &Session, form: &mut PoseForm, commands: &mut Vec<Command>) {
    section(
        ui,
        "Pose values",
        false,
        |_| {},
        |ui| match session.selected_annotation() {
            Some((photo, object, annotation)) => {
                body(ui, session, (photo, object), annotation, form, commands);
            }
            None => note(ui, "Select an object of this photo to type its pose.", false),
        },
    );
}

fn body(
    ui: &mut Ui,
    session: &Session,
    target: (PhotoId, ObjectId),
    annotation: &Annotation,
    form: &mut PoseForm,
    commands: &mut Vec<Command>,
) {
    form_choice(ui, form);
    let reason = why_held(session, target, annotation);
    let pose = annotation.camera_from_object;
    ui.add_enabled_ui(reason.is_none(), |ui| {
        if form.form == RotationForm::Matrix {
            matrix_text(ui, session, target, &pose, form, commands);
        } else {
            number_fields(ui, session, target, pose, form, commands);
        }
    });
    if let Some(reason) = reason {
        note(ui, reason, true);
    }
    if let Some((_, refused)) = form.refused.as_ref().filter(|(of, _)| *of == target) {
        refusal(ui, refused);
    }
}

fn form_choice(ui: &mut Ui, form: &mut PoseForm) {
    let before = form.form;
    ui.horizontal(|ui| {
        ui.label("R as");
        let width = ui.available_width() - 4.0;
        let combo = egui::ComboBox::new("rotation form", "").selected_text(before.title()).width(width);
        let response = combo.show_ui(ui, |ui| {
            for (choice, title, meaning) in RotationForm::ALL {
                ui.selectable_value(&mut form.form, choice, title).on_hover_text(meaning);
            }
        });
        let meaning = RotationForm::ALL[before as usize].2;
        ui.ctx().accesskit_node_builder(response.response.id, |node| node.set_label("Rotation as"));
        response.response.on_hover_text(meaning);
    });
    if form.form != before {
        form.refused = None;
    }
}

/// Why a pose cannot be changed by anybody now.
fn why_held(
    session: &Session,
    (photo, object): (PhotoId, ObjectId),
    annotation: &Annotation,
) -> Option<&'static str> {
    let scene = session.scene();
    if scene.photo(photo).is_some_and(|photo| photo.locked) {
        Some("This photo is locked.")
    } else if scene.object(object).is_some_and(|object| object.locked) {
        Some("This object is locked.")
    } else if annotation.state == AnnotationState::Confirmed {
        Some("This pose is confirmed: reopen it to change it.")
    } else {
        None
    }
}

fn number_fields(
    ui: &mut Ui,
    session: &Session,
    target: (PhotoId, ObjectId),
    pose: Pose,
    form: &mut PoseForm,
    commands: &mut Vec<Command>,
) {
    let kept = form.numbers.filter(|numbers| numbers.pose == pose && numbers.form == form.form);
    let mut rotation = kept.map_or_else(|| form.form.numbers_of(&pose), |numbers| numbers.rotation);
    let mut translation = pose.translation_mm;
    let touched = rotation_fields(ui, form.form, &mut rotation).and(translation_fields(ui, &mut translation));
    if form.form == RotationForm::Quaternion {
        let length = rotation.iter().map(|value| value * value).sum::<f64>().sqrt();
        if (length - 1.0).abs() > 1e-3 {
            note(ui, &format!("Of length {length:.3}: used as if it were 1."), false);
        }
    }
    if touched.drag_started {
        commands.push(Command::BeginGesture("Set pose"));
        form.dragging = true;
    }
    if touched.changed {
        match form.form.pose_of(rotation, translation, &pose) {
            Some(wanted) => {
                form.refused = None;
                form.numbers = Some(Numbers { form: form.form, pose: wanted, rotation });
                commands.extend(set_command(session, target, wanted, touched, form.dragging));
            }
            None => {
                let text = "A quaternion of zeros is no rotation: the pose is kept.";
                form.refused = Some((target, text.to_owned()));
            }
        }
    }
    if touched.drag_stopped && form.dragging {
        commands.push(Command::EndGesture);
        form.dragging = false;
    }
}

/// Within a drag a pose is a part of the drag; a drag that was cancelled with Escape goes on without effect.
fn set_command(
    session: &Session,
    (photo, object): (PhotoId, ObjectId),
    camera_from_object: Pose,
    touched: Touched,
    dragging: bool,
) -> Option<Command> {
    if dragging && touched.dragged {
        let under_way = touched.drag_started || session.gesture_under_way();
        return under_way.then_some(Command::Drag { photo, object, camera_from_object });
    }
    Some(Command::SetPose { photo, object, camera_from_object, source: PoseSource::Manual })
}

fn rotation_fields(ui: &mut Ui, form: RotationForm, rotation: &mut [f64; 4]) -> Touched {
    let names = form.names();
    let columns = if names.len() == 4 { 2 } else { 3 };
    let width = column_width(ui, columns);
    let mut touched = Touched::default();
    let (unit, speed, decimals) = if form.is_in_degrees() { ("°", 0.2, 2) } else { ("", 0.002, 5) };
    for (row, names) in names.chunks(columns).enumerate() {
        ui.horizontal(|ui| {
            for (column, name) in names.iter().enumerate() {
                let tooltip = RotationForm::ALL[form as usize].2;
                let field = NumberField { label: name, name, unit, tooltip, speed, decimals, live: false };
                let response = field.show(ui, width, 17.0, &mut rotation[row * columns + column]);
                touched = touched.and(Touched::of(&response));
            }
        });
    }
    touched
}

fn translation_fields(ui: &mut Ui, translation_mm: &mut DVec3) -> Touched {
    let width = column_width(ui, 3);
    let mut touched = Touched::default();
    let meanings = ["To the right of the camera, mm", "Below the camera, mm", "Before the camera, mm"];
    ui.horizontal(|ui| {
        for (axis, name) in ["tx", "ty", "tz"].into_iter().enumerate() {
            let tooltip = meanings[axis];
            let field =
                NumberField { label: name, name, unit: "", tooltip, speed: 0.5, decimals: 2, live: false };
            let response = field.show(ui, width, 17.0, &mut translation_mm[axis]);
            touched = touched.and(Touched::of(&response));
        }
    });
    note(ui, "t in mm, camera axes: x right, y down, z forward", false);
    touched
}

impl Touched {
    fn of(response: &egui::Response) -> Self {
        Self {
            changed: response.changed(),
            drag_started: response.drag_started(),
            dragged: response.dragged(),
            drag_stopped: response.drag_stopped(),
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            changed: self.changed || other.changed,
            drag_started: self.drag_started || other.drag_started,
            dragged: self.dragged || other.dragged,
            drag_stopped: self.drag_stopped || other.drag_stopped,
        }
    }
}

/// Any text that holds a pose; what is typed stays until it is set or dropped, else the live matrix is shown.
fn matrix_text(
    ui: &mut Ui,
    session: &Session,
    target: (PhotoId, ObjectId),
    pose: &Pose,
    form: &mut PoseForm,
    commands: &mut Vec<Command>,
) {
    let under_way = form.text.take().filter(|(of, _)| *of == target).map(|(_, text)| text);
    let is_edited = under_way.is_some();
    let mut text = under_way.unwrap_or_else(|| write_pose_text(&rounded(pose), PoseText::Matrix));
    let edit = TextEdit::multiline(&mut text)
        .font(egui::TextStyle::Monospace)
        .desired_rows(4)
        .desired_width(f32::INFINITY)
        .hint_text("Paste a matrix: plain rows, NumPy or JSON");
    let response = egui::ScrollArea::both()
        .id_salt("matrix text")
        .max_height(76.0)
        .auto_shrink([false, true])
        .show(ui, |ui| ui.add(edit))
        .inner;
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Pose as text"));
    let is_edited = is_edited || response.changed();
    let read = if is_edited { Some(read_pose_text(&text, pose)) } else { None };
    ui.horizontal(|ui| {
        let can_set = matches!(read, Some(Ok(_)));
        if ui.add_enabled(can_set, Button::new("Set")).on_hover_text("Take the pose of this text").clicked() {
            commands.push(Command::SetPoseFromText(text.clone()));
            form.text = None;
            form.refused = None;
        } else if is_edited {
            let revert = ui.button("Revert").on_hover_text("Drop this text, show the pose again");
            form.text = (!revert.clicked()).then_some((target, text));
        }
        let copies = [
            (CommandId::CopyPose, "Copy"),
            (CommandId::CopyPoseNumPy, "NumPy"),
            (CommandId::CopyPoseJson, "JSON"),
        ];
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for (id, text) in copies.into_iter().rev() {
                if command_button(ui, Button::new(RichText::new(text).small()), id.info(), session) {
                    commands.push(Command::Run(id));
                }
            }
        });
    });
    if let Some(Err(error)) = read.filter(|_| form.text.is_some()) {
        refusal(ui, &error.to_string());
    }
}

/// As many digits as fit; every digit is what the copy buttons give.
fn rounded(pose: &Pose) -> Pose {
    let round = |value: f64, digits: f64| (value * digits).round() / digits + 0.0;
    let columns = pose.rotation.to_cols_array().map(|value| round(value, 1e6));
    Pose {
        rotation: glam::DMat3::from_cols_array(&columns),
        translation_mm: DVec3::from_array(pose.translation_mm.to_array().map(|value| round(value, 1e4))),
    }
}
