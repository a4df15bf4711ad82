//! A BOP scene folder as a scene, read in the plainest way: to hold exports against what they were made from.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DMat3, DVec3};
use pinpose::formats::{NamedFile, read_mesh_with, read_photo};
use pinpose::math::{Intrinsics, Pose};
use pinpose::raster::Mask;
use pinpose::scene::{
    Annotation, AnnotationState, CameraOrigin, ContinuousSymmetry, DepthMap, ObjectId, PoseSource, Scene,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::support::{NOW_MS, named_file};

pub type PerImage<T> = BTreeMap<u32, T>;

#[derive(Deserialize)]
pub struct Camera {
    #[serde(rename = "cam_K")]
    pub k: [f64; 9],
    pub depth_scale: f64,
}

#[derive(Deserialize, Debug, PartialEq)]
pub struct Truth {
    pub obj_id: u32,
    #[serde(rename = "cam_R_m2c")]
    pub rotation: [f64; 9],
    #[serde(rename = "cam_t_m2c")]
    pub translation_mm: [f64; 3],
}

#[derive(Deserialize)]
pub struct TruthInfo {
    pub bbox_obj: [i64; 4],
    pub bbox_visib: [i64; 4],
    pub px_count_all: usize,
    pub px_count_valid: usize,
    pub px_count_visib: usize,
    pub visib_fract: f64,
}

#[derive(Deserialize, Debug, PartialEq)]
pub struct ModelInfo {
    pub diameter: f64,
    pub min_x: f64,
    pub size_x: f64,
    pub min_y: f64,
    pub size_y: f64,
    pub min_z: f64,
    pub size_z: f64,
    #[serde(default)]
    pub symmetries_discrete: Vec<Vec<f64>>,
    #[serde(default)]
    pub symmetries_continuous: Vec<Continuous>,
}

#[derive(Deserialize, Debug, PartialEq)]
pub struct Continuous {
    pub axis: [f64; 3],
    pub offset: [f64; 3],
}

/// A scene folder, with its models two folders up.
pub struct BopFolder(pub PathBuf);

pub fn read_json<T: DeserializeOwned>(path: &Path) -> T {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

impl Truth {
    /// Projected onto SO(3), as an import does.
    pub fn pose(&self) -> Pose {
        let rotation = DMat3::from_cols_array(&self.rotation).transpose();
        Pose::from_parts(rotation, DVec3::from_array(self.translation_mm)).unwrap().0
    }
}

impl BopFolder {
    pub fn cameras(&self) -> PerImage<Camera> {
        read_json(&self.0.join("scene_camera.json"))
    }

    pub fn truths(&self) -> PerImage<Vec<Truth>> {
        read_json(&self.0.join("scene_gt.json"))
    }

    pub fn infos(&self) -> PerImage<Vec<TruthInfo>> {
        read_json(&self.0.join("scene_gt_info.json"))
    }

    pub fn models(&self) -> PathBuf {
        self.0.join("../../models")
    }

    /// Empty where there is no such file.
    pub fn model_infos(&self) -> PerImage<ModelInfo> {
        let path = self.models().join("models_info.json");
        if path.is_file() { read_json(&path) } else { BTreeMap::new() }
    }

    pub fn photo(&self, image: u32) -> PathBuf {
        let found = ["png", "jpg"].map(|extension| self.0.join(format!("rgb/{image:06}.{extension}")));
        found.into_iter().find(|path| path.is_file()).unwrap()
    }

    pub fn mask(&self, folder: &str, image: u32, truth: usize) -> Mask {
        let path = self.0.join(format!("{folder}/{image:06}_{truth:06}.png"));
        let picture =
            image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_luma8();
        Mask::from_pixels(picture.width(), picture.height(), picture.pixels().map(|pixel| pixel.0[0] > 0))
    }

    /// Everything as annotations that somebody stands for.
    pub fn scene(&self) -> Scene {
        let mut scene = Scene::named("a scene");
        let (cameras, truths) = (self.cameras(), self.truths());
        let objects = self.add_objects(&mut scene, &truths);
        for (image, camera) in cameras {
            let (asset, _) = read_photo(&named_file(&self.photo(image))).unwrap();
            let (width, height) = (asset.width, asset.height);
            let photo = scene.add_photo(Arc::new(asset));
            let rows = [0, 3, 6].map(|start| [0, 1, 2].map(|column| camera.k[start + column]));
            let intrinsics = Intrinsics::from_k_rows(&rows, width, height).unwrap();
            scene.set_camera(photo, intrinsics, CameraOrigin::File("scene_camera.json".to_owned()));
            let depth = self.0.join(format!("depth/{image:06}.png"));
            if depth.is_file() {
                let asset = Arc::new(read_photo(&named_file(&depth)).unwrap().0);
                let depth = DepthMap { asset, mm_per_unit: camera.depth_scale, occludes: true };
                scene.photo_mut(photo).unwrap().depth = Some(depth);
            }
            for truth in &truths[&image] {
                let annotation = Annotation {
                    pins: Vec::new(),
                    state: AnnotationState::Posed,
                    source: PoseSource::Imported,
                    ..Annotation::untouched(truth.pose(), NOW_MS)
                };
                scene.annotations.insert((photo, objects[&truth.obj_id]), annotation);
            }
        }
        scene
    }

    fn add_objects(&self, scene: &mut Scene, truths: &PerImage<Vec<Truth>>) -> BTreeMap<u32, ObjectId> {
        let infos = self.model_infos();
        let mut objects = BTreeMap::new();
        let mut ids: Vec<u32> = truths.values().flatten().map(|truth| truth.obj_id).collect();
        ids.sort_unstable();
        ids.dedup();
        for id in ids {
            let path = self.models().join(format!("obj_{id:06}.ply"));
            let texture = path.with_extension("png");
            let textures: Vec<NamedFile> =
                texture.is_file().then(|| named_file(&texture)).into_iter().collect();
            let object = scene.add_object(Arc::new(read_mesh_with(&named_file(&path), &textures).unwrap().0));
            let symmetries = &mut scene.object_mut(object).unwrap().symmetries;
            if let Some(info) = infos.get(&id) {
                symmetries.discrete = info.symmetries_discrete.iter().map(|rows| pose_of_16(rows)).collect();
                let continuous = |symmetry: &Continuous| ContinuousSymmetry {
                    axis: DVec3::from_array(symmetry.axis),
                    offset_mm: DVec3::from_array(symmetry.offset),
                };
                symmetries.continuous = info.symmetries_continuous.iter().map(continuous).collect();
            }
            objects.insert(id, object);
        }
        objects
    }
}

fn pose_of_16(rows: &[f64]) -> Pose {
    let rows = [0, 4, 8, 12].map(|start| [0, 1, 2, 3].map(|column| rows[start + column]));
    Pose::from_rows(&rows).unwrap().0
}
