//! Linemod as it was published: `ape/data/{colorN.jpg, rotN.rot, traN.tra}` and `ape/mesh.ply`. Translations are in
//! centimetres, meshes in millimetres, and the camera is in the paper alone.
//!
//! A sequence without `mesh.ply` has `OLDmesh.ply` and `transform.dat`, which takes it into the frame of the poses, in metres.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat4, DVec4};

use super::listing::{Listing, base_name, is_photo_name, join, parent, stem_and_extension};
use super::{
    Choice, Contents, Dataset, DatasetKind, DatasetMesh, DatasetPhoto, Layout as AnyLayout, Recognised,
    counted,
};
use crate::formats::file_key::number_of;
use crate::formats::gather::{Found, Gather};
use crate::formats::{CameraFile, FileKey, FormatError, text};
use crate::math::Distortion;

/// The camera of all Linemod sequences, of 640×480 pixels. Source: BOP's `camera.json` of LM.
const K: [[f64; 3]; 3] = [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]];

#[derive(Debug, Clone)]
pub(super) struct Layout {
    sequences: Vec<Sequence>,
}

/// One object's photos.
#[derive(Debug, Clone)]
struct Sequence {
    /// The object's name.
    name: String,
    /// Where the photos and poses are.
    folder: String,
    photos: BTreeMap<u32, String>,
    mesh: Option<String>,
    /// For an old mesh.
    transform: Option<String>,
    has_depth: bool,
}

pub(super) fn recognise(listing: &Arc<Listing>) -> Option<Recognised> {
    let mut folders: Vec<&str> = listing
        .paths()
        .filter(|path| numbered(base_name(path), "rot", "rot").is_some())
        .map(parent)
        .collect();
    folders.dedup();
    let sequences: Vec<Sequence> =
        folders.into_iter().filter_map(|folder| sequence_in(listing, folder)).collect();
    let choices = sequences.iter().map(|sequence| sequence.choice(listing)).collect();
    Recognised::new(DatasetKind::Linemod, listing, choices, AnyLayout::Linemod(Layout { sequences }))
}

fn sequence_in(listing: &Listing, folder: &str) -> Option<Sequence> {
    let photos: BTreeMap<u32, String> = listing
        .names_in(folder)
        .filter(|name| is_photo_name(name))
        .filter_map(|name| {
            Some((number_of(stem_and_extension(name).0.strip_prefix("color")?)?, join(folder, name)))
        })
        .collect();
    if photos.is_empty() {
        return None;
    }
    let above = if listing.folder_name(folder) == "data" { parent(folder) } else { folder };
    let (mesh, old_mesh) = (listing.find(above, "mesh.ply"), listing.find(above, "OLDmesh.ply"));
    let transform = if mesh.is_some() { None } else { listing.find(above, "transform.dat") };
    Some(Sequence {
        name: listing.folder_name(above).to_owned(),
        folder: folder.to_owned(),
        photos,
        mesh: mesh.or(old_mesh),
        transform,
        has_depth: listing.names_in(folder).any(|name| name.ends_with(".dpt")),
    })
}

/// The number in a name like `rot12.rot`.
fn numbered(name: &str, prefix: &str, extension: &str) -> Option<u32> {
    number_of(name.strip_prefix(prefix)?.strip_suffix(extension)?.strip_suffix('.')?)
}

impl Sequence {
    fn choice(&self, listing: &Listing) -> Choice {
        let size = |path: &String| listing.size_of(path).unwrap_or(0);
        Choice {
            label: self.name.clone(),
            photos: self.photos.len(),
            bytes: self.photos.values().map(size).sum(),
        }
    }

    fn rotation_path(&self, number: u32) -> String {
        join(&self.folder, &format!("rot{number}.rot"))
    }

    fn translation_path(&self, number: u32) -> String {
        join(&self.folder, &format!("tra{number}.tra"))
    }
}

impl Layout {
    fn chosen(&self, chosen: &[usize]) -> impl Iterator<Item = &Sequence> {
        chosen.iter().filter_map(|index| self.sequences.get(*index))
    }

    pub fn needed(&self, chosen: &[usize]) -> Vec<String> {
        let mut paths = Vec::new();
        for sequence in self.chosen(chosen) {
            for number in sequence.photos.keys() {
                paths.extend([sequence.rotation_path(*number), sequence.translation_path(*number)]);
            }
            paths.extend(sequence.transform.clone());
        }
        paths
    }

    pub fn interpret(&self, chosen: &[usize], contents: &Contents, dataset: &mut Dataset) {
        let mut gather = Gather::new("rot and tra files");
        for sequence in self.chosen(chosen) {
            take_sequence(sequence, contents, dataset, &mut gather);
        }
        dataset.found.push(counted(dataset.photos.len(), "photo", ""));
        dataset.found.push(counted(dataset.meshes.len(), "mesh", ""));
        match gather.finish() {
            Ok(poses) => dataset.take_poses(poses),
            Err(error) => dataset.missing.push(format!("poses: {error}")),
        }
        dataset
            .guessed
            .push("every photo has Linemod's published camera (fx 572.4114, fy 573.57043)".to_owned());
    }
}

fn take_sequence(sequence: &Sequence, contents: &Contents, dataset: &mut Dataset, gather: &mut Gather) {
    let name = &sequence.name;
    let camera = CameraFile {
        file_name: "Linemod's".to_owned(),
        k: K,
        distortion: Distortion::NONE,
        size: Some((640, 480)),
    };
    let object = match take_mesh(sequence, contents, dataset) {
        Some(path) => FileKey::Path(path),
        None => {
            dataset.missing.push(format!("{name}: mesh.ply"));
            FileKey::Stem("mesh".to_owned())
        }
    };
    let mut without_pose = 0;
    for (number, path) in &sequence.photos {
        dataset.photos.push(DatasetPhoto { camera: Some(camera.clone()), ..DatasetPhoto::at(path) });
        let read = |path: String| Some((contents.get(&path)?, path));
        let files = read(sequence.rotation_path(*number)).zip(read(sequence.translation_path(*number)));
        let Some(((rotation, rotation_path), (translation, translation_path))) = files else {
            without_pose += 1;
            continue;
        };
        let photo = gather.photo(FileKey::Path(path.clone()));
        match (numbers::<9>(rotation), numbers::<3>(translation)) {
            (Ok(rotation), Ok(centimetres)) => {
                let translation_mm = centimetres.map(|value| 10.0 * value);
                let found =
                    Found { photo, object: object.clone(), rotation: &rotation, translation_mm, score: None };
                gather.pose(found, || format!("{name}, photo {number}"));
            }
            (Err(error), _) => gather.leave_out(|| format!("{rotation_path}: {error}")),
            (_, Err(error)) => gather.leave_out(|| format!("{translation_path}: {error}")),
        }
    }
    if without_pose > 0 {
        dataset.missing.push(format!("{name}: rot and tra files of {}", counted(without_pose, "photo", "")));
    }
    if sequence.has_depth {
        dataset.missing.push(format!("{name}: depth, for depthN.dpt is not read"));
    }
}

/// Lists the mesh; an old one in the frame of the poses.
fn take_mesh(sequence: &Sequence, contents: &Contents, dataset: &mut Dataset) -> Option<String> {
    let path = sequence.mesh.clone()?;
    let mut mesh = DatasetMesh { name: sequence.name.clone(), ..DatasetMesh::at(&path) };
    if let Some(transform) = &sequence.transform {
        match contents.get(transform).map(|bytes| mesh_from_old_mesh(bytes)) {
            Some(Ok(transform)) => {
                dataset.guessed.push(format!("{}: OLDmesh.ply, moved by transform.dat", sequence.name));
                mesh.mesh_from_file = Some(transform);
            }
            Some(Err(error)) => dataset.miss_file(transform, &error),
            None => dataset.missing.push(format!("{transform}: it was not read")),
        }
    }
    dataset.meshes.push(mesh);
    Some(path)
}

/// `rows columns` and then the numbers, or the numbers alone.
fn numbers<const N: usize>(bytes: &[u8]) -> Result<[f64; N], FormatError> {
    let mut values = Vec::with_capacity(N + 2);
    for word in text(bytes)?.split_ascii_whitespace().take(N + 3) {
        let value: f64 = word.parse().map_err(|_| {
            let shown: String = word.chars().take(20).collect();
            FormatError::at("the text", format!("a number expected, found \"{shown}\""))
        })?;
        values.push(value);
    }
    let start = if values.len() == N + 2 { 2 } else { 0 };
    values.get(start..).and_then(|values| values.try_into().ok()).ok_or_else(|| {
        FormatError::at("the text", format!("a size and {N} numbers expected, found {}", values.len()))
    })
}

/// `transform.dat`: a count, then twelve lines of an index and a number of [R|t], row by row, t in metres.
fn mesh_from_old_mesh(bytes: &[u8]) -> Result<DMat4, FormatError> {
    let lines = text(bytes)?.lines().skip(1).filter(|line| !line.trim().is_empty()).take(13);
    let last_word =
        |line: &str| line.split_ascii_whitespace().nth(1).and_then(|word| word.parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = lines.map(last_word).collect();
    let rows: Option<[f64; 12]> = numbers.and_then(|numbers| numbers.try_into().ok());
    let [a, b, c, x, d, e, f, y, g, h, i, z] =
        rows.filter(|rows| rows.iter().all(|number| number.is_finite())).ok_or_else(|| {
            FormatError::at("the text", "a count and twelve lines of an index and a number expected")
        })?;
    Ok(DMat4::from_cols(
        DVec4::new(a, d, g, 0.0),
        DVec4::new(b, e, h, 0.0),
        DVec4::new(c, f, i, 0.0),
        DVec4::new(1000.0 * x, 1000.0 * y, 1000.0 * z, 1.0),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(files: &[(&str, &str)]) -> Dataset {
        let sizes = files.iter().map(|(path, content)| ((*path).to_owned(), content.len() as u64));
        let listing = Arc::new(Listing::new("LM", sizes).unwrap());
        let recognised = super::super::recognise(&listing).unwrap();
        assert_eq!(recognised.kind, DatasetKind::Linemod);
        let read = |path: &String| {
            let (_, content) = files.iter().find(|(candidate, _)| candidate == path)?;
            Some((path.clone(), Arc::from(content.as_bytes())))
        };
        let contents = recognised.needed(&[0]).iter().filter_map(read).collect();
        recognised.interpret(&[0], &contents).unwrap()
    }

    const ROTATION: &str = "3 3\n0 -1 0\n1 0 0\n0 0 1\n";

    #[test]
    fn centimetres_become_millimetres() {
        let dataset = opened(&[
            ("LM/ape/data/color0.jpg", ""),
            ("LM/ape/data/color1.jpg", ""),
            ("LM/ape/data/rot0.rot", ROTATION),
            ("LM/ape/data/tra0.tra", "1 3\n-10.5\n2\n101.25\n"),
            ("LM/ape/mesh.ply", ""),
            ("LM/ape/OLDmesh.ply", ""),
        ]);
        assert_eq!((dataset.photos.len(), dataset.meshes.len(), dataset.pose_count()), (2, 1, 1));
        assert_eq!((dataset.meshes[0].name.as_str(), dataset.meshes[0].mesh_from_file), ("ape", None));
        let pose = dataset.poses[0].photos[0].poses[0].camera_from_object;
        assert_eq!(pose.translation_mm.to_array(), [-105.0, 20.0, 1012.5]);
        assert_eq!(pose.to_rows()[0][1], -1.0);
        assert!(dataset.missing.join("\n").contains("rot and tra files of 1 photo"));
    }

    #[test]
    fn an_old_mesh_is_moved_and_broken_files_are_named() {
        let transform = "1\n0 1\n1 0\n2 0\n3 0.1\n4 0\n5 1\n6 0\n7 0\n8 0\n9 0\n10 1\n11 -0.02\n";
        let dataset = opened(&[
            ("can/data/color0.jpg", ""),
            ("can/data/color1.jpg", ""),
            ("can/data/rot0.rot", ROTATION),
            ("can/data/tra0.tra", "1 3\n0\n0\n50\n"),
            ("can/data/rot1.rot", "3 3\n1 2"),
            ("can/data/tra1.tra", "1 3\n0\n0\n50\n"),
            ("can/OLDmesh.ply", ""),
            ("can/transform.dat", transform),
        ]);
        let moved = dataset.meshes[0].mesh_from_file.unwrap();
        assert_eq!(moved.w_axis.to_array(), [100.0, 0.0, -20.0, 1.0]);
        assert_eq!(dataset.pose_count(), 1);
        assert!(
            dataset.guessed.join("\n").contains("rot1.rot: the text: a size and 9 numbers expected, found 4")
        );
    }
}
