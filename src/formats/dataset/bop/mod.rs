//! BOP's layout: `[test/]000002/{rgb,depth,mask,mask_visib}/000764.png` with `scene_gt.json` and `scene_camera.json`, and
//! `models/obj_000001.ply` above. Newer sets name files by sensor (`rgb_left`, `scene_gt_left.json`). Linemod as it was
//! repacked has the same with `gt.yml` and `info.yml`.
//!
//! Source: bop_toolkit's `bop_datasets_format.md`.

mod interpret;
mod parts;

use crate::math::sort_short;
use std::sync::Arc;

use super::listing::{Listing, parent};
use super::meshes::{ModelFolder, model_folders};
use super::{Choice, DatasetKind, Layout as AnyLayout, Recognised};
use parts::{Part, parts_of};

#[derive(Debug, Clone)]
pub(super) struct Layout {
    listing: Arc<Listing>,
    parts: Vec<Part>,
    models: Vec<ModelFolder>,
}

pub(super) fn recognise(listing: &Arc<Listing>) -> Option<Recognised> {
    let (parts, models) = (parts_of(listing), model_folders(listing));
    // Numbered photos in a folder "rgb" alone are anybody's.
    if models.is_empty() && !parts.iter().any(|part| part.poses.is_some() || part.cameras.is_some()) {
        return None;
    }
    let choices = parts.iter().map(|part| part.choice(listing)).collect();
    let layout = Layout { listing: listing.clone(), parts, models };
    Recognised::new(DatasetKind::Bop, listing, choices, AnyLayout::Bop(layout))
}

impl Part {
    fn choice(&self, listing: &Listing) -> Choice {
        let size = |path: &String| listing.size_of(path).unwrap_or(0);
        Choice {
            label: self.label.clone(),
            photos: self.photos.len(),
            bytes: self.photos.values().map(size).sum(),
        }
    }
}

impl Layout {
    fn chosen(&self, chosen: &[usize]) -> impl Iterator<Item = &Part> {
        chosen.iter().filter_map(|index| self.parts.get(*index))
    }

    pub fn needed(&self, chosen: &[usize]) -> Vec<String> {
        let mut paths = Vec::new();
        for part in self.chosen(chosen) {
            paths.extend(part.poses.clone());
            paths.extend(part.cameras.clone());
            paths.extend(self.common_camera(part));
            paths.extend(self.models_of(part).and_then(|models| models.info.clone()));
        }
        sort_short(&mut paths, Ord::cmp);
        paths.dedup();
        paths
    }

    /// The meshes of a scene are in a folder beside one that the scene is in: the nearest, and of these the best.
    fn models_of(&self, part: &Part) -> Option<&ModelFolder> {
        let depth = |folder: &ModelFolder| {
            let above = parent(&folder.path);
            let is_above =
                above.is_empty() || part.scene.starts_with(&format!("{above}/")) || part.scene == above;
            is_above.then_some(above.len())
        };
        let nearest = self.models.iter().filter_map(depth).max();
        self.models
            .iter()
            .find(|folder| nearest.is_some() && depth(folder) == nearest)
            // A data set whose meshes were unpacked beside it has only one such folder.
            .or_else(|| self.models.first().filter(|_| self.models.len() == 1))
    }

    /// The camera of the whole data set, for scenes that have none.
    fn common_camera(&self, part: &Part) -> Option<String> {
        if part.cameras.is_some() {
            return None;
        }
        let mut folder = part.scene.as_str();
        loop {
            let names = ["camera.json".to_owned(), format!("camera{}.json", part.suffix)];
            if let Some(path) = names.iter().find_map(|name| self.listing.find(folder, name)) {
                return Some(path);
            }
            if folder.is_empty() {
                return None;
            }
            folder = parent(folder);
        }
    }
}

#[cfg(test)]
mod tests;
