//! `README.txt`: what the files are and what their numbers mean.

use super::ExportPart;
use super::plan::Plan;
use crate::mesh::MeshUnit;
use crate::scene::MeshFrame;

pub(super) fn readme(plan: &Plan, warnings: &[String]) -> String {
    let words = plan.options.convention.words();
    let has = |part: ExportPart| plan.options.parts.contains(&part);
    let name =
        if plan.scene.name.is_empty() { String::new() } else { format!(" of \"{}\"", plan.scene.name) };
    let mut lines = vec![
        format!("6D object poses{name}, written by PinPose {}.", env!("CARGO_PKG_VERSION")),
        String::new(),
    ];
    if has(ExportPart::Document) {
        lines.push(
            "pinpose.json: everything, in PinPose's own format. camera_from_object (X_camera = R X_object + t), OpenCV camera \
             axes (x right, y down, z forward), millimetres, matrices row by row. Opens in PinPose again, bit for bit. The units \
             and axes of mesh files are in mesh_from_file."
                .to_owned(),
        );
    }
    for (part, files) in
        [(ExportPart::Poses, "poses.json"), (ExportPart::Npy, "npy/"), (ExportPart::Csv, "poses.csv")]
    {
        if has(part) {
            lines.push(format!(
                "{files}: {}; camera axes {}; {}; matrices row by row.",
                words.direction, words.camera_axes, words.length_unit
            ));
        }
    }
    if has(ExportPart::Npy) {
        lines.push(
            "npy/*-K.npy: the camera matrices in pixels. poses.json lists all files of npy/.".to_owned(),
        );
    }
    if has(ExportPart::Meshes) {
        lines.push("meshes/: PLY, millimetres, in the object frame that all poses here refer to.".to_owned());
    }
    for object in &plan.scene.objects {
        let frame = MeshFrame(object.mesh_from_file);
        match frame.unit(object.mesh.file_unit()) {
            Some(MeshUnit::Millimetre) => {}
            Some(unit) => lines.push(format!("{} was read in {unit}.", object.mesh.file_name)),
            None => lines.push(format!("{} was read in a unit of its own.", object.mesh.file_name)),
        }
    }
    if [ExportPart::Masks, ExportPart::VisibleMasks, ExportPart::Depth, ExportPart::Nocs, ExportPart::Boxes]
        .into_iter()
        .any(has)
    {
        lines.push("pictures.json: what the pictures hold, and the objects' boxes.".to_owned());
    }
    if has(ExportPart::Bop) {
        lines.extend(bop_lines(plan));
    }
    lines.push(
        "project.py: projects the meshes into the photos with NumPy; shows how the numbers are meant."
            .to_owned(),
    );
    lines.push("Pixel (0, 0) is the centre of the top-left pixel everywhere.".to_owned());
    lines.extend(warnings.iter().map(|warning| format!("Note: {warning}.")));
    lines.join("\n") + "\n"
}

fn bop_lines(plan: &Plan) -> Vec<String> {
    let mut lines = vec![
        format!(
            "bop/: a BOP dataset with one scene, {:06}. OpenCV camera axes, millimetres, x_camera = R x_object + t, matrices row by \
             row. Visible is what no other annotated object hides and what lies no more than {} mm behind the depth map, where there \
             is one. Boxes are x, y, width, height in whole pixels.",
            plan.options.scene_id, plan.options.visibility_delta_mm
        ),
        "Models:".to_owned(),
    ];
    for model in &plan.models {
        let object = plan.scene.objects.get(model.object);
        let names =
            object.map_or_else(String::new, |object| format!("{} ({})", object.name, object.mesh.file_name));
        lines.push(format!("  obj_{:06}: {names}", model.id));
    }
    lines.push("Images:".to_owned());
    for planned in &plan.photos {
        let file = plan.photo(planned).map_or("", |photo| &photo.asset.file_name);
        lines.push(format!("  {:06}: {file}", planned.image_id));
    }
    lines
}
