//! How the scene view shows the photo.

use egui::Ui;

use super::number_field::{NumberField, column_width};
use super::section::section;
use crate::session::{Command, Panes, Session};

/// Where the photo's plane is put when it is first taken off "auto" and no object says how far it is.
const START_MM: f64 = 1000.0;

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let panes = session.panes();
    if !panes.arrangement.shows_scene() {
        return;
    }
    section(
        ui,
        "Image plane",
        true,
        |_| {},
        |ui| {
            ui.horizontal(|ui| {
                ui.label("Photo plane").on_hover_text("How far before the camera the photo stands");
                let mut is_auto = panes.image_distance_mm.is_none();
                let tooltip = "As far as the farthest object reaches";
                if ui.checkbox(&mut is_auto, "auto").on_hover_text(tooltip).changed() {
                    let image_distance_mm = (!is_auto).then(|| farthest_mm(session));
                    commands.push(Command::SetPanes(Panes { image_distance_mm, ..panes }));
                }
                if let Some(present_mm) = panes.image_distance_mm {
                    let mut distance_mm = present_mm;
                    let field = NumberField {
                        name: "image distance",
                        unit: " mm",
                        tooltip: "From the camera to the photo's plane",
                        speed: (present_mm * 0.005).max(0.1),
                        decimals: 1,
                        live: true,
                        label: "",
                    };
                    let width = column_width(ui, 1);
                    field.show(ui, width, 0.0, &mut distance_mm);
                    if distance_mm != present_mm && distance_mm.is_finite() && distance_mm >= 1.0 {
                        let image_distance_mm = Some(distance_mm);
                        commands.push(Command::SetPanes(Panes { image_distance_mm, ..panes }));
                    }
                }
            });
        },
    );
}

fn farthest_mm(session: &Session) -> f64 {
    let Some(photo) = session.photo() else { return START_MM };
    let reach = session.scene().objects_in(photo.id).map(|(object, annotation)| {
        let sphere = object.mesh.mesh.sphere();
        annotation.camera_from_object.transform_point(sphere.center).z + sphere.radius
    });
    let farthest = reach.fold(0.0, f64::max);
    if farthest >= 1.0 { farthest.round() } else { START_MM }
}
