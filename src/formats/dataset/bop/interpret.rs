//! A BOP scene's files to photos, meshes and poses.

use std::collections::BTreeMap;

use super::Layout;
use super::parts::Part;
use crate::formats::bop::{FrameCamera, FramePose, Frames, read_cameras, read_poses};
use crate::formats::dataset::listing::base_name;
use crate::formats::dataset::meshes::{MeshTable, ModelFolder};
use crate::formats::dataset::{Contents, Dataset, DatasetDepth, DatasetMask, DatasetPhoto, counted};
use crate::formats::file_key::{bop_object_id, number_of};
use crate::formats::gather::Gather;
use crate::formats::{CameraFile, FileKey, FormatError, camera};
use crate::math::sort_short;

/// BOP's `depth_scale` where nothing says another.
const USUAL_MM_PER_UNIT: f64 = 1.0;

/// What is gathered over all chosen parts.
struct Work<'a> {
    contents: &'a Contents,
    dataset: &'a mut Dataset,
    meshes: MeshTable<'a>,
    gather: Gather,
    /// The numbers of objects that no mesh was found for.
    without_mesh: Vec<u32>,
}

impl Layout {
    pub fn interpret(&self, chosen: &[usize], contents: &Contents, dataset: &mut Dataset) {
        let file_name = self.chosen(chosen).find_map(|part| part.poses.as_deref()).map_or("poses", base_name);
        let mut work = Work {
            contents,
            dataset,
            meshes: MeshTable::new(&self.listing),
            gather: Gather::new(file_name),
            without_mesh: Vec::new(),
        };
        for part in self.chosen(chosen) {
            let models = self.models_of(part);
            if let Some(models) = models
                && let Err(error) = work.meshes.read_info(models, contents)
            {
                work.dataset.miss_file(models.info.as_deref().unwrap_or_default(), &error);
            }
            let common = self.common_camera(part);
            work.take_part(part, models, common.as_deref());
        }
        work.finish(self.chosen(chosen).find_map(|part| self.models_of(part)));
    }
}

impl Work<'_> {
    fn take_part(&mut self, part: &Part, models: Option<&ModelFolder>, common_camera: Option<&str>) {
        let cameras = self.cameras_of(part);
        let common = common_camera.filter(|_| cameras.is_none()).and_then(|path| self.common_camera(path));
        let poses = self.poses_of(part);
        let first = self.dataset.photos.len();
        let mut without_camera = 0;
        for (image, path) in &part.photos {
            let frame = cameras.as_ref().and_then(|cameras| cameras.get(image));
            let mut photo = DatasetPhoto::at(path);
            photo.camera = self
                .camera_of(part, *image, frame)
                .or_else(|| common.as_ref().map(|(camera, _)| camera.clone()));
            without_camera += usize::from(photo.camera.is_none());
            let scale =
                frame.and_then(|frame| frame.depth_scale).or(common.as_ref().and_then(|(_, scale)| *scale));
            photo.depth = part.depth.get(image).map(|path| DatasetDepth {
                path: path.clone(),
                mm_per_unit: scale
                    .filter(|scale| scale.is_finite() && *scale > 0.0)
                    .unwrap_or(USUAL_MM_PER_UNIT),
            });
            self.dataset.photos.push(photo);
        }
        if without_camera > 0 {
            let photos = counted(without_camera, "photo", "");
            self.dataset.missing.push(format!("{}: no camera for {photos}", part.label));
        }
        self.take_poses(part, models, &poses, first);
        self.take_image_masks(part, models, &poses, first);
        self.list_what_is_missing(part);
    }

    fn cameras_of(&mut self, part: &Part) -> Option<Frames<FrameCamera>> {
        let path = part.cameras.as_deref()?;
        match read_cameras(path, self.contents.get(path)?) {
            Ok(cameras) => Some(cameras),
            Err(error) => {
                self.dataset.miss_file(path, &error);
                None
            }
        }
    }

    /// The data set's one camera, and its depth scale.
    fn common_camera(&mut self, path: &str) -> Option<(CameraFile, Option<f64>)> {
        let bytes = self.contents.get(path)?;
        let value: Result<serde_json::Value, _> = serde_json::from_slice(bytes);
        let read = value.map_err(FormatError::json).and_then(|value| {
            let camera = camera::read_camera(base_name(path), &value)?;
            // Its size is that of the sensor's full picture, which a split need not have.
            Ok((
                CameraFile { size: None, ..camera },
                value.get("depth_scale").and_then(serde_json::Value::as_f64),
            ))
        });
        match read {
            Ok(camera) => {
                self.dataset.guessed.push(format!("every photo has the camera of {path}"));
                Some(camera)
            }
            Err(error) => {
                self.dataset.miss_file(path, &error);
                None
            }
        }
    }

    fn poses_of(&mut self, part: &Part) -> Frames<Vec<FramePose>> {
        let Some(path) = part.poses.as_deref() else { return Frames::new() };
        let Some(bytes) = self.contents.get(path) else {
            self.dataset.missing.push(format!("{path}: it was not read"));
            return Frames::new();
        };
        read_poses(path, bytes).unwrap_or_else(|error| {
            self.dataset.miss_file(path, &error);
            Frames::new()
        })
    }

    fn camera_of(&mut self, part: &Part, image: u32, frame: Option<&FrameCamera>) -> Option<CameraFile> {
        let path = part.cameras.as_deref()?;
        match frame?.camera(base_name(path))? {
            Ok(camera) => Some(camera),
            Err(error) => {
                self.gather.leave_out(|| format!("{path}, image {image}: {error}"));
                None
            }
        }
    }

    /// Poses, and the masks that belong to them by their position.
    fn take_poses(
        &mut self,
        part: &Part,
        models: Option<&ModelFolder>,
        poses: &Frames<Vec<FramePose>>,
        first: usize,
    ) {
        let indices: BTreeMap<u32, usize> = part.photos.keys().copied().zip(first..).collect();
        let mut without_photo = 0;
        for (image, poses) in poses {
            let index = indices.get(image).copied();
            let key = match part.photos.get(image) {
                Some(path) => FileKey::Path(path.clone()),
                // Of a scene whose photos are not here they may be open already; of a part of them, the others are left out.
                None if part.photos.is_empty() => {
                    FileKey::BopImage { scene: number_of(base_name(&part.scene)), image: *image }
                }
                None => {
                    without_photo += 1;
                    continue;
                }
            };
            let photo = self.gather.photo(key);
            let mut instances: BTreeMap<u32, usize> = BTreeMap::new();
            for (position, pose) in poses.iter().enumerate() {
                let mesh = self.mesh(models, pose.obj_id);
                let instance = instances.entry(pose.obj_id).or_default();
                if let Some(path) = part.masks.of_pose.get(&(*image, position))
                    && let Some(photo) = index.and_then(|index| self.dataset.photos.get_mut(index))
                {
                    photo.masks.push(DatasetMask { path: path.clone(), mesh, instance: *instance });
                }
                let key = self.object_key(mesh, pose.obj_id);
                let taken = self.gather.pose(pose.found(photo, key), || {
                    format!("{}, image {image}, pose {position}", part.label)
                });
                *instance += usize::from(taken.is_some());
            }
        }
        if without_photo > 0 {
            let images = counted(without_photo, "image", "");
            self.dataset.missing.push(format!("{}: the photos of {images} that have poses", part.label));
        }
    }

    /// Repacked Linemod has one mask an image: of the object that its scene is called after.
    fn take_image_masks(
        &mut self,
        part: &Part,
        models: Option<&ModelFolder>,
        poses: &Frames<Vec<FramePose>>,
        first: usize,
    ) {
        if part.masks.of_image.is_empty() {
            return;
        }
        let object = bop_object_id(base_name(&part.scene))
            .filter(|id| poses.values().flatten().any(|pose| pose.obj_id == *id));
        let mesh = object.and_then(|id| self.mesh(models, id));
        for (image, photo) in part.photos.keys().zip(self.dataset.photos.iter_mut().skip(first)) {
            if let Some(path) = part.masks.of_image.get(image) {
                photo.masks.push(DatasetMask { path: path.clone(), mesh, instance: 0 });
            }
        }
    }

    fn mesh(&mut self, models: Option<&ModelFolder>, id: u32) -> Option<usize> {
        let mesh = models.and_then(|models| self.meshes.mesh(models, id));
        if mesh.is_none() && !self.without_mesh.contains(&id) {
            self.without_mesh.push(id);
        }
        mesh
    }

    fn object_key(&self, mesh: Option<usize>, id: u32) -> FileKey {
        match mesh.and_then(|index| self.meshes.meshes.get(index)) {
            Some(mesh) => FileKey::Path(mesh.path.clone()),
            None => FileKey::BopObject(id),
        }
    }

    fn list_what_is_missing(&mut self, part: &Part) {
        let label = &part.label;
        let mut miss = |is_missing: bool, what: &str| {
            if is_missing {
                self.dataset.missing.push(format!("{label}: {what}"));
            }
        };
        miss(part.photos.is_empty(), "its photos (rgb or gray)");
        miss(part.poses.is_none(), "scene_gt.json: no poses are given");
        miss(part.cameras.is_none(), "scene_camera.json");
        miss(part.poses.is_some() && !part.has_info, "scene_gt_info.json (nothing here needs it)");
        miss(part.depth.is_empty(), "depth maps");
        miss(part.poses.is_some() && part.masks.is_empty(), "masks");
    }

    /// Totals for the user, and the meshes of a scene that has no poses.
    fn finish(mut self, models: Option<&ModelFolder>) {
        let poses = self.gather.finish();
        if let (Some(models), true) = (models, self.meshes.meshes.is_empty() && self.without_mesh.is_empty())
        {
            for id in models.meshes.keys() {
                self.meshes.mesh(models, *id);
            }
        }
        let dataset = self.dataset;
        dataset.meshes = self.meshes.meshes;
        dataset.found.push(counted(dataset.photos.len(), "photo", ""));
        match poses {
            Ok(poses) => dataset.take_poses(poses),
            Err(error) => dataset.missing.push(format!("poses: {error}")),
        }
        let place = models.map_or_else(String::new, |models| format!(" in {}", models.path));
        dataset.found.push(counted(dataset.meshes.len(), "mesh", &place));
        let depth_maps = dataset.photos.iter().filter(|photo| photo.depth.is_some()).count();
        let masks: usize = dataset.photos.iter().map(|photo| photo.masks.len()).sum();
        let symmetric = dataset.meshes.iter().filter(|mesh| !mesh.symmetries.is_empty()).count();
        let counts = [(depth_maps, "depth map"), (masks, "mask"), (symmetric, "symmetric object")];
        dataset.found.extend(
            counts.iter().filter(|(count, _)| *count > 0).map(|(count, noun)| counted(*count, noun, "")),
        );
        if !self.without_mesh.is_empty() {
            sort_short(&mut self.without_mesh, Ord::cmp);
            let names: Vec<String> =
                self.without_mesh.iter().take(30).map(|id| format!("obj_{id:06}")).collect();
            dataset.missing.push(format!("meshes in a folder \"models\": {}", names.join(", ")));
        }
    }
}
