//! What is gathered while photos and masks are written, for the files that hold all photos.

use std::collections::BTreeMap;

use serde::Serialize;

use super::super::plan::{PhotoPlan, Placed, Plan};
use super::coco::{Category, Coco};
use super::depth_scale;
use super::frames::{CameraEntry, TruthEntry, TruthInfo};
use crate::raster::Silhouette;
use crate::scene::Photo;

/// BOP's "time unknown".
const UNKNOWN_TIME: &str = "-1";

/// The score of a pose that has none: somebody stands for it.
const SURE: f64 = 1.0;

#[derive(Debug)]
pub(in super::super) struct Records {
    cameras: BTreeMap<u32, CameraEntry>,
    truths: BTreeMap<u32, Vec<TruthEntry>>,
    infos: BTreeMap<u32, Vec<TruthInfo>>,
    /// Of each of the truths, for the results file.
    scores: BTreeMap<u32, Vec<f64>>,
    coco: Coco,
}

/// An entry of `test_targets_bop19.json`: what there is to be found.
#[derive(Serialize)]
struct Target {
    im_id: u32,
    inst_count: usize,
    obj_id: u32,
    scene_id: u32,
}

impl Records {
    pub fn new(plan: &Plan) -> Self {
        let name = if plan.scene.name.is_empty() { "PinPose" } else { &plan.scene.name };
        let mut coco = Coco::new(name);
        let name_of = |object: usize| plan.scene.objects.get(object).map(|object| object.name.clone());
        coco.categories = plan
            .models
            .iter()
            .map(|model| Category {
                id: model.id,
                name: name_of(model.object).unwrap_or_default(),
                supercategory: name.to_owned(),
            })
            .collect();
        let (cameras, truths) = (BTreeMap::new(), BTreeMap::new());
        Self { cameras, truths, infos: BTreeMap::new(), scores: BTreeMap::new(), coco }
    }

    /// Takes down a photo with the silhouettes of what is placed in it; `file_name` is relative to the scene's folder.
    pub fn add(
        &mut self,
        plan: &Plan,
        planned: &PhotoPlan,
        photo: &Photo,
        silhouettes: &[Silhouette],
        file_name: String,
    ) {
        let id = planned.image_id;
        let camera = &photo.camera;
        self.cameras.insert(id, CameraEntry::new(camera, depth_scale(photo)));
        self.coco.add_image(id, file_name, camera.width, camera.height);
        let placed = plan.placed(photo);
        let truth = |index: usize, pose| TruthEntry::new(plan.model_id(index), pose);
        let truths: Vec<TruthEntry> =
            placed.iter().map(|placed| truth(placed.index, placed.pose())).collect();
        let infos: Vec<TruthInfo> = silhouettes.iter().map(TruthInfo::new).collect();
        for ((truth, info), silhouette) in truths.iter().zip(&infos).zip(silhouettes) {
            self.coco.add_object(id, truth.obj_id, &silhouette.visible, info);
        }
        let score_of = |placed: &Placed<'_>| placed.annotation.score.unwrap_or(SURE);
        self.scores.insert(id, placed.iter().map(score_of).collect());
        self.truths.insert(id, truths);
        self.infos.insert(id, infos);
    }

    pub fn scene_camera(&self) -> String {
        by_lines(&self.cameras)
    }

    pub fn scene_gt(&self) -> String {
        by_lines(&self.truths)
    }

    pub fn scene_gt_info(&self) -> String {
        by_lines(&self.infos)
    }

    pub fn coco(&self) -> String {
        json(&self.coco)
    }

    pub fn targets(&self, scene_id: u32) -> String {
        let mut targets = Vec::new();
        for (&im_id, truths) in &self.truths {
            let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
            truths.iter().for_each(|truth| *counts.entry(truth.obj_id).or_default() += 1);
            let target = |(obj_id, inst_count)| Target { im_id, inst_count, obj_id, scene_id };
            targets.extend(counts.into_iter().map(target));
        }
        json(&targets)
    }

    /// The poses as BOP's results file, with the scores that they were imported with.
    pub fn results(&self, scene_id: u32) -> String {
        let mut text = "scene_id,im_id,obj_id,score,R,t,time\n".to_owned();
        for (image_id, truths) in &self.truths {
            let scores = self.scores.get(image_id).into_iter().flatten();
            for (truth, score) in truths.iter().zip(scores) {
                let (object, columns) = (truth.obj_id, truth.result_columns());
                text += &format!("{scene_id},{image_id},{object},{score},{columns},{UNKNOWN_TIME}\n");
            }
        }
        text
    }
}

/// One line for each image, as bop_toolkit writes it: a file of a thousand frames can be read and compared by people.
fn by_lines(images: &BTreeMap<u32, impl Serialize>) -> String {
    let lines: Vec<String> =
        images.iter().map(|(id, entry)| format!("  \"{id}\": {}", json(entry))).collect();
    format!("{{\n{}\n}}\n", lines.join(",\n"))
}

fn json(value: &impl Serialize) -> String {
    // Maps with numbers as keys and finite numbers: JSON has a form for all of it.
    serde_json::to_string(value).unwrap_or_default()
}
