//! Meshes of a data set: which numbers they have, what may belong to them, and which symmetries `models_info` gives them.

use std::collections::BTreeMap;

use glam::DVec3;
use serde::Deserialize;

use super::listing::{Listing, is_photo_name, join, parent, stem_and_extension};
use super::{Contents, DatasetMesh};
use crate::formats::file_key::bop_object_id;
use crate::formats::yaml::read_yaml;
use crate::formats::{FormatError, text};
use crate::math::{Pose, sort_short};
use crate::scene::{ContinuousSymmetry, Symmetries};

/// A mesh's folder may be full of other meshes' textures; more than this is a folder of photos.
const MOST_COMPANIONS: usize = 256;
/// An icosahedron has 60 turns; a table of thousands is not one of symmetries.
const MOST_SYMMETRIES: usize = 1024;

/// A folder of BOP's meshes, by their numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct ModelFolder {
    pub path: String,
    pub meshes: BTreeMap<u32, String>,
    /// `models_info.json`, or `.yml` as Linemod has it.
    pub info: Option<String>,
}

/// Every folder that is called `models…` and has numbered meshes, those that look best first.
pub(super) fn model_folders(listing: &Listing) -> Vec<ModelFolder> {
    let mut folders: BTreeMap<&str, BTreeMap<u32, &str>> = BTreeMap::new();
    for path in listing.paths() {
        let folder = parent(path);
        let (stem, extension) = stem_and_extension(path);
        if !listing.folder_name(folder).starts_with("models") || rank_of_extension(&extension).is_none() {
            continue;
        }
        let Some(id) = bop_object_id(stem) else { continue };
        let known = folders.entry(folder).or_default().entry(id).or_insert(path);
        if rank_of_extension(&extension) < rank_of_extension(&stem_and_extension(known).1) {
            *known = path;
        }
    }
    let mut found: Vec<ModelFolder> = folders
        .into_iter()
        .map(|(path, meshes)| ModelFolder {
            path: path.to_owned(),
            meshes: meshes.into_iter().map(|(id, mesh)| (id, mesh.to_owned())).collect(),
            info: ["models_info.json", "models_info.yml"].iter().find_map(|name| listing.find(path, name)),
        })
        .collect();
    let rank = |path: &str| rank_of_folder(listing.folder_name(path));
    sort_short(&mut found, |a, b| rank(&a.path).cmp(&rank(&b.path)));
    found
}

/// Of several meshes of one number the first in this order is taken.
fn rank_of_extension(extension: &str) -> Option<usize> {
    ["ply", "obj", "glb", "gltf", "stl", "off"].iter().position(|candidate| *candidate == extension)
}

/// Coloured and whole before simplified.
fn rank_of_folder(name: &str) -> usize {
    let order = ["models", "models_fine", "models_reconst", "models_cad", "models_eval"];
    order.iter().position(|candidate| *candidate == name).unwrap_or(order.len())
}

/// The files that a mesh may ask for: images and libraries in its folder and below.
pub(super) fn companions(listing: &Listing, mesh: &str) -> Vec<String> {
    let folder = parent(mesh);
    let may_belong = |path: &&str| {
        let extension = stem_and_extension(path).1;
        is_photo_name(path) || matches!(extension.as_str(), "mtl" | "bin")
    };
    if stem_and_extension(mesh).1 == "glb" || folder.is_empty() {
        // Beside a mesh at the top there may be all the photos: those that are called as the mesh is.
        let stem = stem_and_extension(mesh).0;
        let own = listing.names_in(folder).filter(|name| name.starts_with(stem) || name.ends_with(".mtl"));
        return own.filter(may_belong).take(MOST_COMPANIONS).map(|name| join(folder, name)).collect();
    }
    listing.below(folder).filter(may_belong).take(MOST_COMPANIONS).map(str::to_owned).collect()
}

/// What `models_info` says of one object, as far as it matters here.
#[derive(Debug, Default, Deserialize)]
struct ModelInfo {
    #[serde(default)]
    symmetries_discrete: Vec<[f64; 16]>,
    #[serde(default)]
    symmetries_continuous: Vec<AxisEntry>,
}

#[derive(Debug, Deserialize)]
struct AxisEntry {
    axis: [f64; 3],
    #[serde(default)]
    offset: [f64; 3],
}

/// Reads the symmetries of all objects.
pub(super) fn read_symmetries(path: &str, bytes: &[u8]) -> Result<BTreeMap<u32, Symmetries>, FormatError> {
    let infos: BTreeMap<String, ModelInfo> = if path.ends_with(".json") {
        serde_json::from_slice(bytes).map_err(FormatError::json)?
    } else {
        serde_json::from_value(read_yaml(text(bytes)?)?)
            .map_err(|error| FormatError::at("the YAML", error))?
    };
    let read = |(name, info): (String, ModelInfo)| {
        let place = format!("object \"{}\"", name.chars().take(20).collect::<String>());
        let id = name.parse().map_err(|_| FormatError::at(&place, "the number of an object expected"))?;
        Ok((id, symmetries_of(&info, &place)?))
    };
    infos.into_iter().map(read).collect()
}

fn symmetries_of(info: &ModelInfo, place: &str) -> Result<Symmetries, FormatError> {
    if info.symmetries_discrete.len() > MOST_SYMMETRIES || info.symmetries_continuous.len() > MOST_SYMMETRIES
    {
        return Err(FormatError::at(place, format!("more than {MOST_SYMMETRIES} symmetries")));
    }
    let mut symmetries = Symmetries::default();
    for (index, flat) in info.symmetries_discrete.iter().enumerate() {
        let place = || format!("{place}, discrete symmetry {index}");
        let rows: [[f64; 4]; 4] =
            std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * row + column]));
        let (pose, _) = Pose::from_rows(&rows).map_err(|error| FormatError::pose(place(), error))?;
        symmetries.add_discrete(pose);
    }
    for (index, entry) in info.symmetries_continuous.iter().enumerate() {
        let (axis, offset_mm) = (DVec3::from_array(entry.axis), DVec3::from_array(entry.offset));
        let axis = axis.try_normalize().filter(|_| offset_mm.is_finite()).ok_or_else(|| {
            FormatError::at(
                format!("{place}, continuous symmetry {index}"),
                "an axis of some length and a finite offset expected",
            )
        })?;
        symmetries.continuous.push(ContinuousSymmetry { axis, offset_mm });
    }
    Ok(symmetries)
}

/// The meshes of a data set by their numbers, listed as they are asked for.
pub(super) struct MeshTable<'a> {
    listing: &'a Listing,
    symmetries: BTreeMap<String, BTreeMap<u32, Symmetries>>,
    /// Index into `meshes`, by path.
    known: BTreeMap<String, usize>,
    pub meshes: Vec<DatasetMesh>,
}

impl<'a> MeshTable<'a> {
    pub fn new(listing: &'a Listing) -> Self {
        Self { listing, symmetries: BTreeMap::new(), known: BTreeMap::new(), meshes: Vec::new() }
    }

    /// Reads a folder's `models_info`, once.
    pub fn read_info(&mut self, folder: &ModelFolder, contents: &Contents) -> Result<(), FormatError> {
        let Some(path) = &folder.info else { return Ok(()) };
        let Some(bytes) = contents.get(path).filter(|_| !self.symmetries.contains_key(&folder.path)) else {
            return Ok(());
        };
        let read = read_symmetries(path, bytes);
        self.symmetries.insert(folder.path.clone(), BTreeMap::new());
        self.symmetries.insert(folder.path.clone(), read?);
        Ok(())
    }

    /// The mesh of this number in a folder, listed if it is there.
    pub fn mesh(&mut self, folder: &ModelFolder, id: u32) -> Option<usize> {
        let path = folder.meshes.get(&id)?;
        if let Some(index) = self.known.get(path) {
            return Some(*index);
        }
        let symmetries = self.symmetries.get(&folder.path).and_then(|symmetries| symmetries.get(&id));
        self.known.insert(path.clone(), self.meshes.len());
        self.meshes.push(DatasetMesh {
            symmetries: symmetries.cloned().unwrap_or_default(),
            companions: companions(self.listing, path),
            ..DatasetMesh::at(path)
        });
        Some(self.meshes.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_folder_comes_first_and_of_two_files_the_ply() {
        let paths = [
            "models_eval/obj_000001.ply",
            "models/obj_000001.glb",
            "models/obj_000001.ply",
            "models/obj_02.obj",
            "models/readme.ply",
        ];
        let files = paths.iter().map(|path| (format!("set/{path}"), 1));
        let folders = model_folders(&Listing::new("set", files).unwrap());
        assert_eq!(folders.len(), 2);
        assert_eq!(folders[0].path, "set/models");
        let meshes: Vec<_> = folders[0].meshes.iter().map(|(id, path)| (*id, path.as_str())).collect();
        assert_eq!(meshes, [(1, "set/models/obj_000001.ply"), (2, "set/models/obj_02.obj")]);
    }

    #[test]
    fn symmetries_are_read_and_broken_ones_say_where() {
        let info = r#"{"1": {"diameter": 5}, "2": {"diameter": 5,
            "symmetries_discrete": [[-1,0,0,0, 0,-1,0,0, 0,0,1,0, 0,0,0,1], [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]],
            "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [1, 2, 3]}]}}"#;
        let symmetries = read_symmetries("models_info.json", info.as_bytes()).unwrap();
        assert!(symmetries[&1].is_empty());
        assert_eq!(symmetries[&2].discrete.len(), 1, "the identity is no symmetry worth keeping");
        assert_eq!(symmetries[&2].continuous[0].axis, DVec3::Z);
        let yaml = "2: {diameter: 5.0, symmetries_continuous: [{axis: [0, 0, 1], offset: [0, 0, 0]}]}\n";
        assert_eq!(read_symmetries("models_info.yml", yaml.as_bytes()).unwrap()[&2].continuous.len(), 1);

        let message = |text: &str| read_symmetries("a.json", text.as_bytes()).unwrap_err().to_string();
        assert!(
            message(&info.replace("[0, 0, 2]", "[0, 0, 0]")).contains("object \"2\", continuous symmetry 0")
        );
        assert!(message(&info.replace("-1,0,0,0", "0,0,0,0")).contains("discrete symmetry 0"));
        assert!(message(&info.replace("-1,0,0,0,", "0,")).contains("line 2"));
    }
}
