//! The shown photo's intrinsics: four numbers, where they came from, and what to do where they are a guess.

use egui::{DragValue, Grid, RichText, Ui};

use super::theme;
use crate::math::Intrinsics;
use crate::scene::{CameraOrigin, Photo};
use crate::session::{Command, Session};

/// Numbers while they are typed: given to the scene when the field is left, not at every key.
#[derive(Debug, Default)]
pub struct CameraForm {
    edited: Option<Intrinsics>,
}

pub fn draw(ui: &mut Ui, session: &Session, form: &mut CameraForm, commands: &mut Vec<Command>) {
    let Some(photo) = session.photo() else { return };
    theme::section(ui, "Camera");
    origin(ui, photo);
    fields(ui, photo, form, commands);
}

fn origin(ui: &mut Ui, photo: &Photo) {
    let text = match &photo.camera_origin {
        CameraOrigin::AssumedFieldOfView => {
            RichText::new("A guess: 60° field of view. Drop a camera file or type the numbers.")
                .color(theme::WARNING)
        }
        CameraOrigin::Exif => {
            RichText::new("Estimated from the photo's EXIF data. Drop a camera file or type the numbers.")
                .color(theme::WARNING)
        }
        CameraOrigin::Typed => RichText::new("Typed").weak(),
        CameraOrigin::File(name) => RichText::new(format!("From {name}")).weak(),
    };
    ui.add(egui::Label::new(text.small()).wrap());
}

fn fields(ui: &mut Ui, photo: &Photo, form: &mut CameraForm, commands: &mut Vec<Command>) {
    let mut camera = form.edited.unwrap_or(photo.camera);
    let mut responses = Vec::new();
    Grid::new("camera fields").num_columns(4).min_col_width(16.0).spacing([8.0, 6.0]).show(ui, |ui| {
        let mut field = |ui: &mut Ui, label: &str, value: &mut f64| {
            let name = ui.label(label);
            let field = DragValue::new(value).speed(0.1).max_decimals(5).update_while_editing(false);
            responses.push(ui.add_sized([88.0, 22.0], field).labelled_by(name.id).on_hover_text("pixels"));
        };
        field(ui, "fx", &mut camera.fx);
        field(ui, "fy", &mut camera.fy);
        ui.end_row();
        field(ui, "cx", &mut camera.cx);
        field(ui, "cy", &mut camera.cy);
        ui.end_row();
    });
    let editing = responses.iter().any(|response| response.has_focus() || response.dragged());
    if camera != photo.camera && !editing {
        form.edited = None;
        commands.push(Command::SetCamera { photo: photo.id, camera, origin: CameraOrigin::Typed });
    } else {
        form.edited = editing.then_some(camera);
    }
    let mut details = format!("{} × {} px", camera.width, camera.height);
    if !camera.distortion.is_none() {
        details += ", with lens distortion";
    }
    ui.label(RichText::new(details).small().weak());
}
