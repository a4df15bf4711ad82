//! Which files an export has, and how each is made.

use super::bop::{self, BopStep};
use super::pictures::{PhotoPictures, PictureKind, mask_png, pictures_json};
use super::plan::{PhotoPlan, Plan};
use super::{ExportJob, ExportPart, OverlayRequest, PROJECT_SCRIPT, paths, poses, readme, write_npy};
use crate::formats::write_document;
use crate::photo::{decode, plain_extension, png_rgba};
use crate::scene::Photo;

/// One file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Readme,
    Script,
    Document,
    Poses,
    Csv,
    /// Indices into the plan's photos, and into what is placed in one.
    PoseNpy(usize, usize),
    CameraNpy(usize),
    /// Index into the plan's objects.
    Mesh(usize),
    /// And into its mesh's companions.
    MeshCompanion(usize, usize),
    Picture(PictureKind, usize, Option<usize>),
    PictureIndex,
    Bop(BopStep),
}

/// The path and the bytes, or why there are none.
type Made = Result<(String, Vec<u8>), String>;

const GONE: &str = "what was to be exported is not there";

pub(super) fn steps(plan: &Plan) -> Vec<Step> {
    let has = |part: ExportPart| plan.options.parts.contains(&part);
    let mut steps = vec![Step::Readme];
    if [ExportPart::Document, ExportPart::Poses, ExportPart::Npy, ExportPart::Csv, ExportPart::Bop]
        .into_iter()
        .any(has)
    {
        steps.push(Step::Script);
    }
    if has(ExportPart::Document) {
        steps.push(Step::Document);
    }
    // Matrices of their own say nothing of what they are: the list comes with them.
    if has(ExportPart::Poses) || has(ExportPart::Npy) {
        steps.push(Step::Poses);
    }
    if has(ExportPart::Csv) {
        steps.push(Step::Csv);
    }
    if has(ExportPart::Npy) {
        for (photo, placed) in photos_with_counts(plan) {
            steps.push(Step::CameraNpy(photo));
            steps.extend((0..placed).map(|at| Step::PoseNpy(photo, at)));
        }
    }
    if has(ExportPart::Meshes) {
        for (object, mesh) in plan.meshes.iter().enumerate() {
            steps.push(Step::Mesh(object));
            steps.extend(mesh.companions().map(|at| Step::MeshCompanion(object, at)));
        }
    }
    steps.extend(picture_steps(plan));
    if has(ExportPart::Bop) {
        steps.extend(bop::steps(plan).into_iter().map(Step::Bop));
    }
    steps
}

fn picture_steps(plan: &Plan) -> Vec<Step> {
    let parts = [
        (ExportPart::Overlays, PictureKind::Overlay),
        (ExportPart::Masks, PictureKind::Mask),
        (ExportPart::VisibleMasks, PictureKind::VisibleMask),
        (ExportPart::Depth, PictureKind::Depth),
        (ExportPart::Nocs, PictureKind::Nocs),
        (ExportPart::Boxes, PictureKind::Boxes),
    ];
    let kinds: Vec<PictureKind> = parts
        .into_iter()
        .filter(|(part, _)| plan.options.parts.contains(part))
        .map(|(_, kind)| kind)
        .collect();
    let mut steps = Vec::new();
    for (photo, placed) in photos_with_counts(plan) {
        for &kind in &kinds {
            if kind.is_of_one_object() {
                steps.extend((0..placed).map(|at| Step::Picture(kind, photo, Some(at))));
            } else {
                steps.push(Step::Picture(kind, photo, None));
            }
        }
    }
    if !kinds.is_empty() {
        steps.push(Step::PictureIndex);
    }
    steps
}

/// The index of each photo of the plan, and how many objects are placed in it.
fn photos_with_counts(plan: &Plan) -> impl Iterator<Item = (usize, usize)> {
    let photos = plan.photos.iter().enumerate();
    photos.filter_map(|(index, planned)| Some((index, plan.placed(plan.photo(planned)?).len())))
}

impl ExportJob {
    pub(super) fn make(&mut self, step: Step) -> Made {
        let text = |path: &str, text: String| Ok((path.to_owned(), text.into_bytes()));
        match step {
            Step::Readme => text("README.txt", readme::readme(&self.plan, &self.warnings())),
            Step::Script => text("project.py", PROJECT_SCRIPT.to_owned()),
            Step::Document => text("pinpose.json", write_document(&self.document)),
            Step::Poses => text("poses.json", poses::poses_json(&self.plan)),
            Step::Csv => text("poses.csv", poses::poses_csv(&self.plan)),
            Step::PoseNpy(photo, at) => self.pose_npy(photo, at),
            Step::CameraNpy(photo) => {
                let (planned, photo) = planned_photo(&self.plan, photo)?;
                Ok((paths::camera_npy(planned), write_npy(&photo.camera.k_rows())))
            }
            Step::Mesh(object) => {
                let mesh = self.plan.meshes.get(object).ok_or(GONE)?;
                let file = mesh.file(self.plan.scene.objects.get(object).ok_or(GONE)?);
                Ok((paths::mesh(&self.plan, object), file))
            }
            Step::MeshCompanion(object, at) => {
                let object = self.plan.scene.objects.get(object).ok_or(GONE)?;
                let file = object.mesh.companions.get(at).ok_or(GONE)?;
                Ok((paths::companion(file), file.bytes.to_vec()))
            }
            Step::Picture(kind, photo, at) => self.picture(kind, photo, at),
            Step::PictureIndex => text("pictures.json", pictures_json(&self.pictures)),
            Step::Bop(step) => self.bop_file(step),
        }
    }

    fn pose_npy(&self, photo: usize, at: usize) -> Made {
        let (planned, photo) = planned_photo(&self.plan, photo)?;
        let placed = self.plan.placed(photo);
        let placed = placed.get(at).ok_or(GONE)?;
        let rows = self.plan.options.convention.rows(placed.pose());
        Ok((paths::pose_npy(&self.plan, planned, placed.index), write_npy(&rows)))
    }

    fn picture(&mut self, kind: PictureKind, photo_index: usize, at: Option<usize>) -> Made {
        self.begin_pictures(photo_index)?;
        let silhouettes = self.silhouettes(photo_index);
        let (planned, photo) = planned_photo(&self.plan, photo_index)?;
        let placed = self.plan.placed(photo);
        let of = at.and_then(|at| Some((placed.get(at)?, silhouettes.get(at)?)));
        let pictures = self.pictures.last_mut().ok_or(GONE)?;
        pictures.make(&self.plan, planned, photo, kind, of)
    }

    /// What a renderer is to draw of a photo; it is listed among the pictures from now on.
    pub(super) fn overlay(&mut self, photo_index: usize) -> Result<OverlayRequest, String> {
        self.begin_pictures(photo_index)?;
        let (planned, photo) = planned_photo(&self.plan, photo_index)?;
        let pictures = self.pictures.last_mut().ok_or(GONE)?;
        Ok(OverlayRequest { photo: photo.id, path: pictures.list_overlay(&self.plan, planned) })
    }

    /// Makes the photo the one whose pictures are listed.
    fn begin_pictures(&mut self, photo_index: usize) -> Result<(), String> {
        if !self.pictures.last().is_some_and(|last| last.is_of(photo_index)) {
            let silhouettes = self.silhouettes(photo_index);
            let (_, photo) = planned_photo(&self.plan, photo_index)?;
            self.pictures.push(PhotoPictures::new(&self.plan, photo_index, photo, &silhouettes));
        }
        Ok(())
    }

    fn bop_file(&mut self, step: BopStep) -> Made {
        let scene = |file: &str| bop::scene_path(&self.plan, file);
        let scene_id = self.plan.options.scene_id;
        match step {
            BopStep::Camera => Ok((
                "bop/camera.json".to_owned(),
                bop::camera_json(&self.plan).unwrap_or_default().into_bytes(),
            )),
            BopStep::ModelsInfo => {
                Ok(("bop/models/models_info.json".to_owned(), bop::models_info(&self.plan).into_bytes()))
            }
            BopStep::Model(model) => bop::model_file(&self.plan, model).ok_or_else(|| GONE.to_owned()),
            BopStep::ModelCompanion(model, at) => {
                bop::companion_file(&self.plan, model, at).ok_or_else(|| GONE.to_owned())
            }
            BopStep::Photo(photo) => self.bop_photo(photo),
            BopStep::Depth(photo) => self.bop_depth(photo),
            BopStep::Mask(photo, at) => self.bop_mask("mask", photo, at),
            BopStep::VisibleMask(photo, at) => self.bop_mask("mask_visib", photo, at),
            BopStep::SceneCamera => Ok((scene("scene_camera.json"), self.bop.scene_camera().into_bytes())),
            BopStep::SceneGt => Ok((scene("scene_gt.json"), self.bop.scene_gt().into_bytes())),
            BopStep::SceneGtInfo => Ok((scene("scene_gt_info.json"), self.bop.scene_gt_info().into_bytes())),
            BopStep::SceneGtCoco => Ok((scene("scene_gt_coco.json"), self.bop.coco().into_bytes())),
            BopStep::Targets => {
                Ok(("bop/test_targets_bop19.json".to_owned(), self.bop.targets(scene_id).into_bytes()))
            }
            BopStep::Results => Ok((bop::results_path(&self.plan), self.bop.results(scene_id).into_bytes())),
        }
    }

    /// The photo's own file where others can read it as it is; else the upright picture as PNG. Takes down what the scene's
    /// files say of the photo, also where its file cannot be written.
    fn bop_photo(&mut self, photo_index: usize) -> Made {
        let silhouettes = self.silhouettes(photo_index);
        let (planned, photo) = planned_photo(&self.plan, photo_index)?;
        let as_it_is = plain_extension(&photo.asset.bytes);
        let extension = as_it_is.unwrap_or("png");
        let folder = self.plan.photo_folder;
        let file_name = format!("{folder}/{:06}.{extension}", planned.image_id);
        self.bop.add(&self.plan, planned, photo, &silhouettes, file_name);
        let path = bop::image_path(&self.plan, folder, planned.image_id, extension);
        let bytes = match as_it_is {
            Some(_) => photo.asset.bytes.to_vec(),
            None => upright_png(photo).map_err(|reason| format!("{path}: {reason}"))?,
        };
        Ok((path, bytes))
    }

    fn bop_depth(&self, photo: usize) -> Made {
        let (planned, photo) = planned_photo(&self.plan, photo)?;
        let path = bop::image_path(&self.plan, "depth", planned.image_id, "png");
        let depth = photo.depth.as_ref().ok_or(GONE)?;
        let bytes = bop::depth_png(depth).map_err(|reason| format!("{path}: {reason}"))?;
        Ok((path, bytes))
    }

    fn bop_mask(&mut self, folder: &str, photo_index: usize, at: usize) -> Made {
        let silhouettes = self.silhouettes(photo_index);
        let (planned, _) = planned_photo(&self.plan, photo_index)?;
        let path = bop::mask_path(&self.plan, folder, planned.image_id, at);
        let silhouette = silhouettes.get(at).ok_or(GONE)?;
        let mask = if folder == "mask" { &silhouette.whole } else { &silhouette.visible };
        let bytes = mask_png(mask).ok_or_else(|| format!("{path}: the picture cannot be encoded"))?;
        Ok((path, bytes))
    }
}

fn planned_photo(plan: &Plan, index: usize) -> Result<(&PhotoPlan, &Photo), String> {
    let planned = plan.photos.get(index).ok_or(GONE)?;
    Ok((planned, plan.photo(planned).ok_or(GONE)?))
}

fn upright_png(photo: &Photo) -> Result<Vec<u8>, String> {
    let decoded = decode(&photo.asset.bytes).map_err(|error| error.to_string())?;
    png_rgba(&decoded.pixels).ok_or_else(|| "the picture cannot be encoded".to_owned())
}
