//! The shown photo's intrinsics: the numbers, where they came from, and what to do where they are a guess.

use egui::{Slider, Ui};

use super::number_field::{NumberField, column_width, note, refusal};
use super::section::section;
use crate::math::{Distortion, Intrinsics};
use crate::photo::ExifFocalSource;
use crate::scene::{CameraOrigin, Photo, PhotoId};
use crate::session::{Command, PhotoChange, Session};
use crate::ui::icons::{Icon, icon_button};

/// What was typed and is no camera; the photo keeps the one it has.
#[derive(Debug, Default)]
pub struct CameraForm {
    refused: Option<(PhotoId, String)>,
    distortion_shown: bool,
}

/// Of the slider, in parts of the photo's long side: 118° to 7° wide.
const FOCAL_RANGE: [f64; 2] = [0.3, 8.0];

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
    section(
        ui,
        "Camera",
        true,
        |ui| buttons(ui, &mut asked),
        |ui| body(ui, (session, photo), form, commands),
    );
    commands.append(&mut asked);
}

fn body(
    ui: &mut Ui,
    (session, photo): (&Session, &Photo),
    form: &mut CameraForm,
    commands: &mut Vec<Command>,
) {
    let mut camera = photo.camera;
    ui.add_enabled_ui(!photo.locked, |ui| {
        pinhole_fields(ui, &mut camera);
        focal_slider(ui, session, photo, commands);
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
    guess(ui, session, photo);
}

/// The focal length by eye: all objects move so that the picture stays as it is, but for its perspective.
fn focal_slider(ui: &mut Ui, session: &Session, photo: &Photo, commands: &mut Vec<Command>) {
    let mut fx = photo.camera.fx;
    let long_side_px = f64::from(photo.camera.width.max(photo.camera.height));
    let [shortest, longest] = FOCAL_RANGE.map(|part| part * long_side_px);
    let range = shortest.min(fx)..=longest.max(fx);
    let slider = Slider::new(&mut fx, range).logarithmic(true).show_value(false);
    let shown = ui.horizontal(|ui| {
        ui.label("Focal length");
        ui.spacing_mut().slider_width = ui.available_width();
        ui.add(slider)
    });
    let response = shown.inner.on_hover_text(
        "By eye: objects keep their place and size in the picture and move nearer or farther with the focal length",
    );
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Focal length with depth"));
    if response.drag_started() {
        commands.push(Command::BeginGesture("Focal length"));
    }
    // After Escape the hand may still be on it.
    let goes_on = response.drag_started() || session.gesture_under_way() || !response.dragged();
    if response.changed() && goes_on {
        commands.push(Command::SetFocal { photo: photo.id, fx });
    }
    if response.drag_stopped() {
        commands.push(Command::EndGesture);
    }
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
        CameraOrigin::AssumedFieldOfView
        | CameraOrigin::Exif(_)
        | CameraOrigin::Pins { .. }
        | CameraOrigin::Slider { .. } => return,
        CameraOrigin::Typed => "Typed".to_owned(),
        CameraOrigin::File(name) => format!("From {name}"),
    };
    let width = (ui.available_width() - room).max(20.0);
    ui.allocate_ui(egui::Vec2::new(width, 18.0), |ui| {
        ui.set_max_width(width);
        ui.add(egui::Label::new(egui::RichText::new(text).small().weak()).truncate());
    });
}

fn guess(ui: &mut Ui, session: &Session, photo: &Photo) {
    match &photo.camera_origin {
        CameraOrigin::AssumedFieldOfView => {
            let depth = depth_words(&photo.camera_origin);
            note(
                ui,
                &format!("A guess: 60° field of view, {depth}. Drop a camera file or type the numbers."),
                true,
            );
        }
        CameraOrigin::Exif(source) => {
            let from = match source {
                ExifFocalSource::Equivalent => "the photo's EXIF data",
                ExifFocalSource::FocalPlane => {
                    "the lens and the sensor's resolution in the photo's EXIF data"
                }
                ExifFocalSource::SensorTable => {
                    "the lens in the photo's EXIF data and its camera's usual sensor"
                }
            };
            let depth = depth_words(&photo.camera_origin);
            note(
                ui,
                &format!("Estimated from {from}, {depth}. Drop a camera file or type the numbers."),
                true,
            );
        }
        CameraOrigin::Pins { relative_sigma } => {
            let percent = 100.0 * relative_sigma;
            note(
                ui,
                &format!("Focal length estimated from pins, ± {percent:.1} %: so is the distance."),
                true,
            );
        }
        CameraOrigin::Slider { before_px } => {
            let depth_mm = depth_of_selected(session).map_or_else(String::new, |mm| format!("{mm:.0} mm, "));
            let percent = 100.0 * (photo.camera.fx / before_px - 1.0);
            note(
                ui,
                &format!("Focal length estimated by eye. Depth follows: {depth_mm}{percent:+.0} %."),
                true,
            );
        }
        CameraOrigin::Typed | CameraOrigin::File(_) => {}
    }
}

fn depth_words(origin: &CameraOrigin) -> String {
    format!("so depth may be {:.0} % off", 100.0 * origin.focal_sigma().unwrap_or(0.0))
}

/// Of the object's middle, along the view.
fn depth_of_selected(session: &Session) -> Option<f64> {
    let (_, object, annotation) = session.selected_annotation()?;
    let center_mm = session.scene().object(object)?.mesh.mesh.sphere().center;
    Some(annotation.camera_from_object.transform_point(center_mm).z)
}
