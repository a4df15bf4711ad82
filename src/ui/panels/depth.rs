//! The shown photo's depth map.

use egui::Ui;

use super::number_field::{NumberField, column_width};
use super::section::section;
use crate::session::{Command, PhotoChange, Session};
use crate::ui::icons::{Icon, icon_button};

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((photo, depth)) = session.photo().and_then(|photo| Some((photo, photo.depth.as_ref()?))) else {
        return;
    };
    let mut asked = Vec::new();
    let remove = |ui: &mut Ui| {
        if icon_button(ui, Icon::Close, "Remove depth map", "Remove the depth map from this photo", true)
            .clicked()
        {
            asked.push(PhotoChange::WithoutDepth);
        }
    };
    let mut changed = Vec::new();
    section(ui, "Depth map", true, remove, |ui| {
        let mut occludes = depth.occludes;
        let tooltip = format!(
            "Parts of objects that are more than 15 mm behind it are not shown. From {}",
            depth.asset.file_name
        );
        if ui.checkbox(&mut occludes, "Hide what is behind it").on_hover_text(tooltip).changed() {
            changed.push(PhotoChange::DepthOccludes(occludes));
        }
        let field = NumberField {
            label: "One step",
            name: "depth map step",
            unit: " mm",
            tooltip: "How many millimetres a step of the depth map is; BOP calls it depth_scale",
            speed: 0.01,
            decimals: 4,
            live: false,
        };
        let mut mm_per_unit = depth.mm_per_unit;
        let width = column_width(ui, 1);
        field.show(ui, width, 64.0, &mut mm_per_unit);
        if mm_per_unit != depth.mm_per_unit && mm_per_unit.is_finite() && mm_per_unit > 0.0 {
            changed.push(PhotoChange::DepthScale(mm_per_unit));
        }
    });
    commands.extend(asked.into_iter().chain(changed).map(|change| Command::EditPhoto(photo.id, change)));
}
