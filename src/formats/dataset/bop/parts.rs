//! The scenes of a BOP data set, sensor by sensor.

use std::collections::BTreeMap;

use crate::formats::dataset::listing::{Listing, base_name, is_photo_name, join, parent, stem_and_extension};
use crate::formats::file_key::number_of;

/// One scene by one sensor.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub label: String,
    /// The scene's folder.
    pub scene: String,
    /// What the sensor's files end with: `_left`, or nothing.
    pub suffix: String,
    /// Paths by the numbers of the images.
    pub photos: BTreeMap<u32, String>,
    pub poses: Option<String>,
    pub cameras: Option<String>,
    pub has_info: bool,
    pub depth: BTreeMap<u32, String>,
    pub masks: Masks,
}

/// Mask files by image, and by the position of the pose in the image where the name has one.
#[derive(Debug, Clone, Default)]
pub(super) struct Masks {
    pub of_pose: BTreeMap<(u32, usize), String>,
    pub of_image: BTreeMap<u32, String>,
}

/// Everything that makes folders scenes: image folders with numbered images, or files by their names.
pub(super) fn parts_of(listing: &Listing) -> Vec<Part> {
    // By the scene's folder, the names of its image folders.
    let mut scenes: BTreeMap<&str, BTreeMap<&str, BTreeMap<u32, String>>> = BTreeMap::new();
    for path in listing.paths() {
        let folder = parent(path);
        if is_scene_file(base_name(path)) {
            scenes.entry(folder).or_default();
        } else if !folder.is_empty() && is_image_folder(base_name(folder)) && is_photo_name(path) {
            let Some(number) = number_of(stem_and_extension(path).0) else { continue };
            let sensors = scenes.entry(parent(folder)).or_default();
            sensors.entry(base_name(folder)).or_default().entry(number).or_insert_with(|| path.to_owned());
        }
    }
    let mut parts = Vec::new();
    for (scene, mut sensors) in scenes {
        if sensors.is_empty() && has_poses(listing, scene) {
            // Their photos may be open already.
            sensors.insert("rgb", BTreeMap::new());
        }
        let names_sensor = sensors.len() > 1;
        for (folder, photos) in sensors {
            parts.push(part_of(listing, scene, folder, photos, names_sensor));
        }
    }
    parts
}

fn is_scene_file(name: &str) -> bool {
    let is_json =
        name.ends_with(".json") && (name.starts_with("scene_gt") || name.starts_with("scene_camera"));
    is_json || name == "gt.yml" || name == "info.yml"
}

fn is_image_folder(name: &str) -> bool {
    matches!(name, "rgb" | "gray" | "gray1" | "gray2")
        || name.starts_with("rgb_")
        || name.starts_with("gray_")
}

fn has_poses(listing: &Listing, scene: &str) -> bool {
    ["scene_gt.json", "gt.yml"].iter().any(|name| listing.find(scene, name).is_some())
}

fn part_of(
    listing: &Listing,
    scene: &str,
    images: &str,
    photos: BTreeMap<u32, String>,
    names_sensor: bool,
) -> Part {
    let suffix = match images {
        "rgb" | "gray" => String::new(),
        _ => format!(
            "_{}",
            images.strip_prefix("rgb_").or_else(|| images.strip_prefix("gray_")).unwrap_or(images)
        ),
    };
    let file = |base: &str, yaml: &str| {
        let names = [format!("{base}{suffix}.json"), format!("{base}_{images}.json"), yaml.to_owned()];
        names.iter().filter(|name| !name.is_empty()).find_map(|name| listing.find(scene, name))
    };
    let folder = |base: &str| join(scene, &format!("{base}{suffix}"));
    let visible = masks_in(listing, &folder("mask_visib"));
    Part {
        label: label_of(listing, scene, names_sensor.then_some(images)),
        scene: scene.to_owned(),
        poses: file("scene_gt", "gt.yml"),
        cameras: file("scene_camera", "info.yml"),
        has_info: file("scene_gt_info", "").is_some(),
        depth: numbered_in(listing, &folder("depth")),
        // What is seen of an object says more of a photo than what would be seen without the others.
        masks: if visible.is_empty() { masks_in(listing, &folder("mask")) } else { visible },
        photos,
        suffix,
    }
}

/// "test / 000002 / rgb_left".
fn label_of(listing: &Listing, scene: &str, sensor: Option<&str>) -> String {
    let split = if scene.is_empty() { None } else { Some(listing.folder_name(parent(scene))) };
    let own = listing.folder_name(scene);
    let parts = split.into_iter().filter(|split| *split != own).chain([own]).chain(sensor);
    parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" / ")
}

fn numbered_in(listing: &Listing, folder: &str) -> BTreeMap<u32, String> {
    let names = listing.names_in(folder).filter(|name| is_photo_name(name));
    names.filter_map(|name| Some((number_of(stem_and_extension(name).0)?, join(folder, name)))).collect()
}

fn masks_in(listing: &Listing, folder: &str) -> Masks {
    let mut masks = Masks::default();
    for name in listing.names_in(folder).filter(|name| is_photo_name(name)) {
        let stem = stem_and_extension(name).0;
        let path = join(folder, name);
        match stem.split_once('_') {
            Some((image, pose)) => {
                if let (Some(image), Some(pose)) = (number_of(image), number_of(pose)) {
                    masks.of_pose.insert((image, pose as usize), path);
                }
            }
            None => {
                if let Some(image) = number_of(stem) {
                    masks.of_image.insert(image, path);
                }
            }
        }
    }
    masks
}

impl Masks {
    pub fn is_empty(&self) -> bool {
        self.of_pose.is_empty() && self.of_image.is_empty()
    }
}
