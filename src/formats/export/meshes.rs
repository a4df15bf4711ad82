//! Meshes as PLY: the very file that was opened where it is one that others can use as it is, with its textures; else written
//! anew.

use std::collections::BTreeMap;

use glam::DMat4;

use crate::mesh::write_ply;
use crate::scene::{CompanionFile, Object};

/// How an object's mesh is exported.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct MeshPlan {
    /// Else it is written anew, without textures.
    is_copied: bool,
    /// Indices into the companions that go beside it.
    companions: Vec<usize>,
}

/// Plans the meshes that go into one folder. Their textures keep their names, for the meshes name them; where two would
/// overwrite each other, the later mesh goes without.
pub(super) fn mesh_plans<'a>(objects: impl Iterator<Item = &'a Object>) -> Vec<MeshPlan> {
    let mut taken: BTreeMap<String, &[u8]> = BTreeMap::new();
    let mut plan = |object: &'a Object| -> MeshPlan {
        let companions = &object.mesh.companions;
        let is_other =
            |file: &CompanionFile| taken.get(&key(file)).is_some_and(|present| **present != *file.bytes);
        if !can_be_copied(object) || companions.iter().any(is_other) {
            return MeshPlan::default();
        }
        let is_new = |file: &CompanionFile| !taken.contains_key(&key(file));
        let new = companions.iter().enumerate().filter(|(_, file)| is_new(file)).map(|(at, _)| at).collect();
        taken.extend(companions.iter().map(|file| (key(file), &*file.bytes)));
        MeshPlan { is_copied: true, companions: new }
    };
    objects.map(&mut plan).collect()
}

impl MeshPlan {
    /// Which of the mesh's companions are to be written.
    pub fn companions(&self) -> impl Iterator<Item = usize> {
        self.companions.iter().copied()
    }

    pub fn file(&self, object: &Object) -> Vec<u8> {
        if self.is_copied { object.mesh.bytes.to_vec() } else { write_ply(&object.mesh.mesh) }
    }

    /// Colours are lost: the mesh has textures and is written anew.
    pub fn loses_textures(&self, object: &Object) -> bool {
        let has_textures = object.mesh.mesh.paint().is_some_and(|paint| !paint.textures.is_empty());
        has_textures && !self.is_copied
    }
}

/// The name of a mesh's texture, without folders.
pub(super) fn companion_name(file: &CompanionFile) -> &str {
    file.file_name.rsplit(['/', '\\']).next().unwrap_or(&file.file_name)
}

fn key(file: &CompanionFile) -> String {
    companion_name(file).to_lowercase()
}

/// A PLY whose numbers are those of the `object` frame, in a form that every reader takes.
fn can_be_copied(object: &Object) -> bool {
    const HEADER_BYTES: usize = 64;
    let start = object.mesh.bytes.get(..HEADER_BYTES).unwrap_or_default();
    let has = |word: &[u8]| start.windows(word.len()).any(|window| window == word);
    object.mesh_from_file == DMat4::IDENTITY
        && start.starts_with(b"ply")
        && (has(b"format ascii 1.0") || has(b"format binary_little_endian 1.0"))
}
