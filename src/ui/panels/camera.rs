//! The shown photo's intrinsics: the numbers, where they came from, and what to do where they are a guess.

use egui::Ui;

use super::number_field::{NumberField, column_width, note, refusal};
use super::section::section;
use crate::math::{Distortion, Intrinsics};
use crate::scene::{CameraOrigin, Photo, PhotoId};
use crate::session::{Command, PhotoChange, Session};
use crate::ui::icons::{Icon, icon_button};

/// What was typed and is no camera; the photo keeps the one it has.
#[derive(Debug, Default)]
pub struct CameraForm {
    refused: Option<(PhotoId, String)>,
    distortion_shown: bool,
}

const LENS: [(&str, &str); 5] = [
    ("k1", "Radial distortion, times r² (OpenCV)"),
    ("k2", "Radial distortion, times r⁴"),
    ("p1", "Tangential distortion"),
    ("p2", "Tangential distortion"),
    ("k3", "Radial distortion, times r⁶"),
];

pub fn draw(ui: &mut Ui, session: &Session, form: &mut CameraForm, commands: &mut Vec<Command>) {
    let Some(photo) = session.photo() else { return };
    let buttons = |ui: &mut Ui, commands: &mut Vec<Command>| {
        let (icon, label) =
            if photo.locked { (Icon::Lock, "Unlock camera") } else { (Icon::LockOpen, "Lock camera") };
        let tooltip = if photo.locked {
            "Unlock this photo's camera and poses"
        } else {
            "Lock this photo's camera and poses: nothing changes them by mistake"
        };
        if icon_button(ui, icon, label, tooltip, true).clicked() {
            commands.push(Command::EditPhoto(photo.id, PhotoChange::Locked(!photo.locked)));
        }
        let given = photo.camera == photo.given_camera.0;
        let tooltip =
            if given { "The camera is as it was given" } else { "Back to the camera as it was given" };
        if icon_button(ui, Icon::Reset, "Reset camera", tooltip, !given && !photo.locked).clicked() {
            commands.push(Command::ResetCamera(photo.id));
        }
    };
    let mut asked = Vec::new();
    section(ui, "Camera", true, |ui| buttons(ui, &mut asked), |ui| body(ui, photo, form, commands));
    commands.append(&mut asked);
}

fn body(ui: &mut Ui, photo: &Photo, form: &mut CameraForm, commands: &mut Vec<Command>) {
    let mut camera = photo.camera;
    ui.add_enabled_ui(!photo.locked, |ui| {
        pinhole_fields(ui, &mut camera);
        if form.distortion_shown || !camera.distortion.is_none() {
            distortion_fields(ui, &mut camera.distortion);
        }
    });
    ui.horizontal(|ui| {
        let size = format!("{} × {} px", photo.camera.width, photo.camera.height);
        ui.label(egui::RichText::new(size).small().weak()).on_hover_text("The photo's size, width × height");
        quiet_origin(ui, photo, if photo.camera.distortion.is_none() { 48.0 } else { 0.0 });
        if photo.camera.distortion.is_none() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let button =
                    egui::Button::selectable(form.distortion_shown, egui::RichText::new("Lens").small());
                let response = ui.add(button.min_size(egui::Vec2::new(0.0, 18.0)));
                ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Lens distortion"));
                if response.on_hover_text("Show the lens's distortion, k1 k2 p1 p2 k3").clicked() {
                    form.distortion_shown = !form.distortion_shown;
                }
            });
        }
    });
    take(photo, camera, form, commands);
    if let Some((_, reason)) = form.refused.as_ref().filter(|(refused, _)| *refused == photo.id) {
        refusal(ui, reason);
    }
    guess(ui, photo);
}

fn pinhole_fields(ui: &mut Ui, camera: &mut Intrinsics) {
    let focal = "The focal length, pixels";
    let center = "The principal point, pixels; (0, 0) is the centre of the top left pixel";
    let Intrinsics { fx, fy, cx, cy, .. } = camera;
    let width = column_width(ui, 2);
    for (tooltip, pair) in [(focal, [("fx", fx), ("fy", fy)]), (center, [("cx", cx), ("cy", cy)])] {
        ui.horizontal(|ui| {
            for (name, value) in pair {
                let field = NumberField {
                    label: name,
                    name,
                    unit: " px",
                    tooltip,
                    decimals: 5,
                    live: true,
                    speed: 0.1,
                };
                field.show(ui, width, 22.0, value);
            }
        });
    }
}

fn distortion_fields(ui: &mut Ui, distortion: &mut Distortion) {
    let mut values = distortion.to_array();
    let width = column_width(ui, 3);
    for row in [0..3, 3..5] {
        ui.horizontal(|ui| {
            for index in row {
                let (name, tooltip) = LENS[index];
                let field = NumberField {
                    label: name,
                    name,
                    tooltip,
                    decimals: 7,
                    live: true,
                    speed: 1e-3,
                    unit: "",
                };
                field.show(ui, width, 20.0, &mut values[index]);
            }
        });
    }
    *distortion = Distortion::from_array(values);
}

/// Gives a camera that was changed to the session, or says why it is none.
fn take(photo: &Photo, camera: Intrinsics, form: &mut CameraForm, commands: &mut Vec<Command>) {
    if camera == photo.camera {
        return;
    }
    match camera.checked() {
        Ok(camera) => {
            form.refused = None;
            commands.push(Command::SetCamera { photo: photo.id, camera, origin: CameraOrigin::Typed });
        }
        Err(error) => form.refused = Some((photo.id, format!("Not taken: {error}."))),
    }
}

/// Where numbers came from that are no guess.
fn quiet_origin(ui: &mut Ui, photo: &Photo, room: f32) {
    let text = match &photo.camera_origin {
        CameraOrigin::AssumedFieldOfView | CameraOrigin::Exif | CameraOrigin::Pins { .. } => return,
        CameraOrigin::Typed => "Typed".to_owned(),
        CameraOrigin::File(name) => format!("From {name}"),
    };
    let width = (ui.available_width() - room).max(20.0);
    ui.allocate_ui(egui::Vec2::new(width, 18.0), |ui| {
        ui.set_max_width(width);
        ui.add(egui::Label::new(egui::RichText::new(text).small().weak()).truncate());
    });
}

fn guess(ui: &mut Ui, photo: &Photo) {
    match &photo.camera_origin {
        CameraOrigin::AssumedFieldOfView => {
            note(ui, "A guess: 60° field of view. Drop a camera file or type the numbers.", true);
        }
        CameraOrigin::Exif => {
            note(ui, "Estimated from the photo's EXIF data. Drop a camera file or type the numbers.", true);
        }
        CameraOrigin::Pins { relative_sigma } => {
            let percent = 100.0 * relative_sigma;
            note(
                ui,
                &format!("Focal length estimated from pins, ± {percent:.1} %: so is the distance."),
                true,
            );
        }
        CameraOrigin::Typed | CameraOrigin::File(_) => {}
    }
}
