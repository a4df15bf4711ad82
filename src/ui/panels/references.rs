//! The references: truth and others' poses to compare with, and how far the selected object is from each.

use std::sync::Arc;

use egui::{Align, Color32, Layout, RichText, Sense, Shape, Stroke, Ui, Vec2};

use super::list;
use super::number_field::note;
use super::section::section;
use crate::math::Pose;
use crate::metrics::{LIVE_VERTICES, PoseError};
use crate::scene::{Object, Reference, Symmetries, reference_color};
use crate::session::{Command, Session};
use crate::ui::theme;

/// Errors that were computed, one a reference, with the poses that they are of.
#[derive(Debug, Default)]
pub struct ErrorCache {
    known: Vec<KnownError>,
}

#[derive(Debug)]
struct KnownError {
    reference: String,
    poses: [Pose; 2],
    /// Held, so that no other mesh can come to be at its address.
    mesh: Arc<crate::scene::MeshAsset>,
    symmetries: Symmetries,
    error: PoseError,
}

impl ErrorCache {
    /// Goes through the mesh's vertices when a pose, the mesh or its symmetries are others than the last time.
    fn error(&mut self, reference: &str, poses: [Pose; 2], object: &Object) -> PoseError {
        let same = |known: &&KnownError| {
            known.reference == reference
                && known.poses == poses
                && Arc::ptr_eq(&known.mesh, &object.mesh)
                && known.symmetries == object.symmetries
        };
        if let Some(known) = self.known.iter().find(same) {
            return known.error;
        }
        let [estimate, other] = &poses;
        let (mesh, symmetries) = (object.mesh.clone(), object.symmetries.clone());
        let error = PoseError::between(estimate, other, &mesh.mesh, &symmetries, LIVE_VERTICES);
        self.known.retain(|known| known.reference != reference);
        self.known.push(KnownError { reference: reference.to_owned(), poses, mesh, symmetries, error });
        error
    }
}

pub fn draw(ui: &mut Ui, session: &Session, cache: &mut ErrorCache, commands: &mut Vec<Command>) {
    let references = &session.scene().references;
    if references.is_empty() {
        return;
    }
    section(
        ui,
        "References",
        true,
        |_| {},
        |ui| {
            for reference in references {
                reference_row(ui, session, reference, commands);
                live_error(ui, session, reference, cache);
            }
        },
    );
}

fn reference_row(ui: &mut Ui, session: &Session, reference: &Reference, commands: &mut Vec<Command>) {
    let name: Arc<str> = Arc::from(reference.name.as_str());
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        line_sample(ui, reference.visible);
        let width = (ui.available_width() - 52.0).max(40.0);
        ui.allocate_ui_with_layout(
            Vec2::new(width, list::ROW_HEIGHT),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.set_width(width);
                let text = RichText::new(&reference.name);
                let text = if reference.visible { text } else { text.weak() };
                let tooltip =
                    format!("{} poses to compare with, drawn as dashed outlines", reference.poses.len());
                let label = egui::Label::new(text).truncate();
                ui.add(label).on_hover_text(tooltip);
            },
        );
        if list::eye(ui, &reference.name, reference.visible) {
            let visible = !reference.visible;
            commands.push(Command::SetReferenceVisible { name: name.clone(), visible });
        }
        list::row_menu(ui, &reference.name, None, |ui| {
            let has_pose = selected_pose(session, reference).is_some();
            let reason = (!has_pose).then_some("it has no pose of the selected object in this photo");
            if list::item(ui, "Set pose from this", reason) {
                commands.push(Command::SetPoseFromReference { name: name.clone() });
            }
            ui.separator();
            if list::item(ui, &format!("Remove the reference {}", reference.name), None) {
                commands.push(Command::RemoveReference { name: name.clone() });
            }
        });
    });
}

fn selected_pose(session: &Session, reference: &Reference) -> Option<[Pose; 2]> {
    let (photo, object, annotation) = session.selected_annotation()?;
    Some([annotation.camera_from_object, *reference.poses.get(&(photo, object))?])
}

fn live_error(ui: &mut Ui, session: &Session, reference: &Reference, cache: &mut ErrorCache) {
    let Some(object) = session.selected().and_then(|id| session.scene().object(id)) else { return };
    let Some(poses) = selected_pose(session, reference) else {
        note(ui, &format!("No pose of {} in this photo", object.name), false);
        return;
    };
    let error = cache.error(&reference.name, poses, object);
    let text = format!(
        "{:.2}°   {:.2} mm   ADD {:.2} mm",
        error.rotation_rad.to_degrees(),
        error.translation_mm,
        error.add_mm
    );
    ui.horizontal(|ui| {
        ui.add_space(24.0);
        ui.label(RichText::new(text).small().monospace()).on_hover_text(format!(
            "How far {} is from {}: rotation, translation, and the mean distance of the mesh's vertices (ADD){}",
            object.name,
            reference.name,
            if object.symmetries.is_empty() { "" } else { ", at the symmetry where it is nearest" }
        ));
    });
}

/// As it is drawn over the photo: dashed, magenta.
fn line_sample(ui: &mut Ui, visible: bool) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(20.0, list::ROW_HEIGHT), Sense::hover());
    let color: Color32 = theme::color32(reference_color());
    let color = if visible { color } else { color.gamma_multiply(0.4) };
    let ends = [rect.left_center() + Vec2::new(1.0, 0.0), rect.right_center() - Vec2::new(1.0, 0.0)];
    ui.painter().extend(Shape::dashed_line(&ends, Stroke::new(2.5, color), 5.0, 3.0));
}
