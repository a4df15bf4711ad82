//! Which files of a drop belong to its meshes: a texture is no photo, and a material library nothing by itself.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::{FileKind, NamedFile, classify};
use crate::mesh::{companion_key, companion_names};
use crate::scene::CompanionFile;

/// A file, and those that it asks for.
#[derive(Debug, Clone)]
pub struct FileWithCompanions {
    pub file: NamedFile,
    pub companions: Vec<NamedFile>,
}

/// Gives each mesh the files that it names. They are no files of their own any more, and several meshes may share them.
pub fn with_companions(files: Vec<NamedFile>) -> Vec<FileWithCompanions> {
    let kinds: Vec<FileKind> = files.iter().map(|file| classify(&file.name, &file.bytes)).collect();
    // Only what could be a texture, a library or a buffer.
    let may_belong = |kind: FileKind| matches!(kind, FileKind::Photo | FileKind::Unknown);
    let mut by_key: BTreeMap<String, &NamedFile> = BTreeMap::new();
    for (file, _) in files.iter().zip(&kinds).filter(|(_, kind)| may_belong(**kind)) {
        by_key.entry(companion_key(&file.name)).or_insert(file);
    }
    let find = |key: &str| by_key.get(key).map(|file| file.bytes.clone());
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut companions_of = Vec::with_capacity(files.len());
    for (file, kind) in files.iter().zip(&kinds) {
        let mut companions = Vec::new();
        if *kind == FileKind::Mesh && !by_key.is_empty() {
            for key in companion_names(&file.name, &file.bytes, &find) {
                companions.extend(by_key.get(&key).map(|&companion| companion.clone()));
                taken.insert(key);
            }
        }
        companions_of.push(companions);
    }
    files
        .into_iter()
        .zip(kinds)
        .zip(companions_of)
        .filter(|((file, kind), _)| !(may_belong(*kind) && taken.contains(&companion_key(&file.name))))
        .map(|((file, _), companions)| FileWithCompanions { file, companions })
        .collect()
}

/// The companions as a mesh keeps them.
pub fn kept(companions: &[NamedFile]) -> Vec<CompanionFile> {
    let keep = |file: &NamedFile| CompanionFile { file_name: file.name.clone(), bytes: file.bytes.clone() };
    companions.iter().map(keep).collect()
}

/// Looks a companion up by its key.
pub(super) fn find_among(companions: &[NamedFile], key: &str) -> Option<Arc<[u8]>> {
    companions.iter().find(|file| companion_key(&file.name) == key).map(|file| file.bytes.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_go_to_their_mesh_and_photos_stay() {
        let file = |name: &str, bytes: &[u8]| NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) };
        let files = vec![
            file("Mug.png", b"\x89PNG"),
            file("photo.jpg", &[0xff, 0xd8, 0xff]),
            file("mug.obj", b"mtllib mug.mtl\n"),
            file("mug.mtl", b"newmtl a\nmap_Kd maps/mug.png\nbump other.png\n"),
            file("box.ply", b"ply\nformat ascii 1.0\ncomment TextureFile mug.png\nend_header\n"),
            file("notes.txt", b"hello"),
        ];
        let names = |files: &[NamedFile]| files.iter().map(|file| file.name.clone()).collect::<Vec<_>>();
        let sorted = with_companions(files);
        let found: Vec<(String, Vec<String>)> =
            sorted.iter().map(|entry| (entry.file.name.clone(), names(&entry.companions))).collect();
        let expected: [(&str, &[&str]); 4] = [
            ("photo.jpg", &[]),
            ("mug.obj", &["mug.mtl", "Mug.png"]),
            ("box.ply", &["Mug.png"]),
            ("notes.txt", &[]),
        ];
        let expected = expected.map(|(name, companions)| {
            (name.to_owned(), companions.iter().map(|&name| name.to_owned()).collect::<Vec<_>>())
        });
        assert_eq!(found, expected);
    }
}
