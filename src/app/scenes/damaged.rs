//! Of a scene that cannot be opened as a whole: that it is said, and what is stored of it as a file.

use std::sync::Arc;

use super::{Arrived, PinPose};
use crate::formats::{DOCUMENT_NAME, FileKind, classify, read_document, zip_of_files};
use crate::platform::{Journal, Remains, SavedAsset, SceneId};
use crate::session::{Effect, Notice};
use crate::ui::Offer;

/// So many missing files are named.
const MOST_NAMED: usize = 3;

impl PinPose {
    /// Says what is wrong with a stored scene. It stays as it is stored.
    pub(super) fn notify_damaged(&mut self, id: SceneId, problem: String) {
        self.notify_with_offer(Notice::error(problem), Offer::Stored(id));
    }

    /// Says which files a stored scene came without, if there are any or one could not be read.
    pub(in crate::app) fn notify_lacking(&mut self, names: &[String], problems: &[String]) {
        let Some(id) = self.scenes.opening.as_ref().and_then(|incoming| incoming.id.clone()) else { return };
        if names.is_empty() && problems.is_empty() {
            return;
        }
        let mut named = names.iter().take(MOST_NAMED).cloned().collect::<Vec<_>>().join(", ");
        if names.len() > MOST_NAMED {
            named += &format!(" and {} more", names.len() - MOST_NAMED);
        }
        let what = if names.is_empty() { "" } else { &format!(" {named} cannot be read from the storage.") };
        self.notify_damaged(
            id,
            format!(
                "This scene is damaged.{what} It stays stored as it is; what you change here goes into a new one"
            ),
        );
    }

    /// Asks for all that is stored of a scene, to download it.
    pub(super) fn download_stored(&mut self, id: &SceneId) {
        let title = self.scenes.title(id).to_owned();
        let journal = self.scenes.storage.read_journal(id);
        let reading = self.scenes.storage.remains(id);
        let with_journal = |remains: Remains| match journal {
            Some(Journal { json, .. }) => {
                let aside = ("put-aside.json".to_owned(), json);
                Remains { unreadable: [remains.unreadable, vec![aside]].concat(), ..remains }
            }
            None => remains,
        };
        let done = move |remains| Arrived::Remains(title, with_journal(remains));
        self.scenes.when_done(reading, done, Arrived::Problem);
    }

    pub(super) fn download_remains(&mut self, title: &str, remains: Remains) {
        let files = files_of(remains);
        if files.is_empty() {
            self.notify(Notice::error(format!("Nothing is stored of {title} any more")));
            return;
        }
        match zip_of_files(&files) {
            Ok(bytes) => {
                let is_plain = |c: char| c.is_alphanumeric() || " -_.".contains(c);
                let stem: String = title.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
                self.carry_out(Effect::Download {
                    file_name: format!("{stem}-stored.zip"),
                    bytes: bytes.into(),
                });
            }
            Err(error) => self.notify(Notice::error(error.to_string())),
        }
    }
}

/// As in a workspace, which it is where the document can be read: then it opens as one, with what there is.
fn files_of(remains: Remains) -> Vec<(String, Arc<[u8]>)> {
    let mut files: Vec<(String, Arc<[u8]>)> = Vec::new();
    if let Some(json) = remains.json {
        let is_readable = read_document(json.as_bytes()).is_ok();
        let name = if is_readable { DOCUMENT_NAME } else { "scene-damaged.json" };
        files.push((name.to_owned(), Arc::from(json.into_bytes())));
    }
    let path = |of: &str, file: &SavedAsset, folder: &str| {
        let prefix: String = of.chars().take(8).collect();
        let base = file.file_name.rsplit(['/', '\\']).next().unwrap_or_default();
        (format!("{folder}/{prefix}/{base}"), file.bytes.clone())
    };
    for asset in &remains.assets {
        let is_mesh = classify(&asset.file_name, &asset.bytes) == FileKind::Mesh;
        files.push(path(&asset.key, asset, if is_mesh { "meshes" } else { "photos" }));
    }
    for companion in &remains.companions {
        files.push(path(&companion.of, &companion.file, "meshes"));
    }
    for (name, text) in remains.unreadable {
        files.push((format!("unreadable/{name}"), Arc::from(text.into_bytes())));
    }
    // No zip has two files of one name.
    let mut names = std::collections::BTreeSet::new();
    files.retain(|(name, _)| names.insert(name.clone()));
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_remains_is_a_file_each() {
        let asset = |key: &str, name: &str, bytes: &[u8]| SavedAsset {
            key: key.to_owned(),
            file_name: name.to_owned(),
            bytes: Arc::from(bytes),
        };
        let photo = asset("0123456789", "set/a.png", b"\x89PNG\r\n\x1a\n");
        let remains = Remains {
            json: Some("{\"format\": \"pin".to_owned()),
            assets: vec![photo.clone(), photo, asset("ab", "m.ply", b"ply\n")],
            companions: Vec::new(),
            unreadable: vec![("heading.json".to_owned(), "5".to_owned())],
        };
        let names: Vec<String> = files_of(remains).into_iter().map(|(name, _)| name).collect();
        let expected =
            ["scene-damaged.json", "photos/01234567/a.png", "meshes/ab/m.ply", "unreadable/heading.json"];
        assert_eq!(names, expected);
    }
}
