//! MegaPose's examples: `image_rgb.png`, `image_depth.png`, `camera_data.json`, `[inputs/|outputs/]object_data.json` and
//! `meshes/LABEL/*.ply`, meshes in millimetres, depth in millimetres, poses in metres.

use std::sync::Arc;

use serde_json::Value;

use super::listing::{Listing, base_name, is_mesh_name, is_photo_name, join, parent, stem_and_extension};
use super::{
    Choice, Contents, Dataset, DatasetDepth, DatasetKind, DatasetMesh, DatasetPhoto, Layout as AnyLayout,
    Recognised, counted, meshes,
};
use crate::formats::gather::Gather;
use crate::formats::megapose::{ObjectData, gather_objects, read_camera_from_world, read_objects};
use crate::formats::{CameraFile, FileKey, FormatError, camera};
use crate::math::{Pose, sort_short};

#[derive(Debug, Clone)]
pub(super) struct Layout {
    listing: Arc<Listing>,
    examples: Vec<Example>,
}

#[derive(Debug, Clone)]
struct Example {
    folder: String,
    photo: String,
    depth: Option<String>,
    camera: String,
    /// Results before inputs, which mostly know boxes alone.
    objects: Vec<String>,
    meshes: Vec<String>,
}

pub(super) fn recognise(listing: &Arc<Listing>) -> Option<Recognised> {
    let cameras = listing.paths().filter(|path| base_name(path) == "camera_data.json");
    let examples: Vec<Example> = cameras.filter_map(|camera| example_of(listing, camera)).collect();
    let choices = examples.iter().map(|example| example.choice(listing)).collect();
    let layout = Layout { listing: listing.clone(), examples };
    Recognised::new(DatasetKind::MegaPose, listing, choices, AnyLayout::MegaPose(layout))
}

fn example_of(listing: &Listing, camera: &str) -> Option<Example> {
    let folder = parent(camera);
    let image = |stem: &str| {
        let mut names = listing.names_in(folder).filter(|name| is_photo_name(name));
        names.find(|name| stem_and_extension(name).0 == stem).map(|name| join(folder, name))
    };
    let mut objects: Vec<String> =
        listing.below(folder).filter(|path| path.ends_with("object_data.json")).map(str::to_owned).collect();
    let rank = |path: &str| (listing.folder_name(parent(path)) != "outputs", path.len());
    sort_short(&mut objects, |a, b| rank(a).cmp(&rank(b)));
    Some(Example {
        folder: folder.to_owned(),
        photo: image("image_rgb")?,
        depth: image("image_depth"),
        camera: camera.to_owned(),
        objects,
        meshes: listing.below(folder).filter(|path| is_mesh_name(path)).map(str::to_owned).collect(),
    })
}

impl Example {
    fn choice(&self, listing: &Listing) -> Choice {
        Choice {
            label: listing.folder_name(&self.folder).to_owned(),
            photos: 1,
            bytes: listing.size_of(&self.photo).unwrap_or(0),
        }
    }

    /// A label names a mesh's folder or the mesh; where there is one of each, they belong together.
    fn mesh_of(&self, label: &str, labels: usize) -> Option<usize> {
        let is_called =
            |path: &&String| base_name(parent(path)) == label || stem_and_extension(path).0 == label;
        let position = self.meshes.iter().position(|path| is_called(&path));
        position.or_else(|| (labels == 1 && self.meshes.len() == 1).then_some(0))
    }
}

impl Layout {
    fn chosen(&self, chosen: &[usize]) -> impl Iterator<Item = &Example> {
        chosen.iter().filter_map(|index| self.examples.get(*index))
    }

    pub fn needed(&self, chosen: &[usize]) -> Vec<String> {
        self.chosen(chosen)
            .flat_map(|example| std::iter::once(&example.camera).chain(&example.objects))
            .cloned()
            .collect()
    }

    pub fn interpret(&self, chosen: &[usize], contents: &Contents, dataset: &mut Dataset) {
        for example in self.chosen(chosen) {
            self.take_example(example, contents, dataset);
        }
        dataset.found.push(counted(dataset.photos.len(), "photo", ""));
        dataset.found.push(counted(dataset.meshes.len(), "mesh", ""));
    }

    fn take_example(&self, example: &Example, contents: &Contents, dataset: &mut Dataset) {
        let mut photo = DatasetPhoto::at(&example.photo);
        photo.depth = example.depth.clone().map(|path| DatasetDepth { path, mm_per_unit: 1.0 });
        let mut camera_from_world = Pose::IDENTITY;
        match contents.get(&example.camera).map(|bytes| read_camera(&example.camera, bytes)) {
            Some(Ok((camera, pose))) => (photo.camera, camera_from_world) = (Some(camera), pose),
            Some(Err(error)) => dataset.miss_file(&example.camera, &error),
            None => dataset.missing.push(format!("{}: it was not read", example.camera)),
        }
        dataset.photos.push(photo);

        let (objects_path, objects) = read_best(example, contents, dataset);
        let mut labels: Vec<&str> = objects.iter().map(|object| object.label.as_str()).collect();
        sort_short(&mut labels, Ord::cmp);
        labels.dedup();
        self.list_meshes(example, &labels, dataset);
        let mut gather = Gather::new(base_name(objects_path));
        let photo = gather.photo(FileKey::Path(example.photo.clone()));
        gather_objects(&mut gather, photo, &objects, &camera_from_world, |label| {
            match example.mesh_of(label, labels.len()).and_then(|index| example.meshes.get(index)) {
                Some(path) => FileKey::Path(path.clone()),
                None => FileKey::Label(label.to_owned()),
            }
        });
        match gather.finish() {
            Ok(poses) => dataset.take_poses(poses),
            Err(error) => dataset.miss_file(objects_path, &error),
        }
        if !objects.iter().any(ObjectData::has_pose) {
            dataset.missing.push(format!("{}: poses (\"TWO\")", base_name(&example.folder)));
        }
    }

    fn list_meshes(&self, example: &Example, labels: &[&str], dataset: &mut Dataset) {
        let owner: Vec<Option<usize>> =
            labels.iter().map(|label| example.mesh_of(label, labels.len())).collect();
        for (index, path) in example.meshes.iter().enumerate() {
            let label =
                owner.iter().position(|mesh| *mesh == Some(index)).and_then(|position| labels.get(position));
            let own = DatasetMesh::at(path);
            dataset.meshes.push(DatasetMesh {
                name: label.map_or(own.name.clone(), |label| (*label).to_owned()),
                companions: meshes::companions(&self.listing, path),
                ..own
            });
        }
        for (label, _) in labels.iter().zip(&owner).filter(|(_, mesh)| mesh.is_none()) {
            dataset.missing.push(format!("the mesh of \"{label}\""));
        }
    }
}

fn read_camera(path: &str, bytes: &[u8]) -> Result<(CameraFile, Pose), FormatError> {
    let value: Value = serde_json::from_slice(bytes).map_err(FormatError::json)?;
    Ok((camera::read_camera(base_name(path), &value)?, read_camera_from_world(&value)?))
}

/// The first list that has poses, else the first that can be read.
fn read_best<'a>(
    example: &'a Example,
    contents: &Contents,
    dataset: &mut Dataset,
) -> (&'a str, Vec<ObjectData>) {
    let mut best: (&str, Vec<ObjectData>) = ("object_data.json", Vec::new());
    for path in &example.objects {
        let Some(bytes) = contents.get(path) else { continue };
        match read_objects(bytes) {
            Ok(objects) if objects.iter().any(ObjectData::has_pose) => return (path, objects),
            Ok(objects) if best.1.is_empty() => best = (path, objects),
            Ok(_) => {}
            Err(error) => dataset.miss_file(path, &error),
        }
    }
    best
}
