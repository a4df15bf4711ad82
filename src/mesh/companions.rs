//! The files that a mesh's file asks for: material libraries, textures, buffers. They are known by their base name alone,
//! for a drop has no folders.

use std::sync::Arc;

use super::load::{Source, recognize};
use super::{Format, gltf, obj, ply, text};

/// Finds the bytes of a companion by its [`companion_key`].
pub type FindCompanion<'a> = &'a dyn Fn(&str) -> Option<Arc<[u8]>>;

/// For a mesh that came alone.
pub fn no_companions(_: &str) -> Option<Arc<[u8]>> {
    None
}

/// What a file is found by: its name in lower case, without folders of either slash.
pub fn companion_key(name: &str) -> String {
    base_name(name).to_lowercase()
}

/// The keys of the files that a mesh asks for, directly or, where they are at hand, through its material libraries.
/// Cheap: nothing is decoded. Also names that are only tried, and images that are of no use here, such as normal maps: who
/// has a drop to sort must not take them for photos.
pub fn companion_names(file_name: &str, bytes: &[u8], find: FindCompanion<'_>) -> Vec<String> {
    let source = Source { file_name, bytes: text::without_byte_order_mark(bytes), find };
    let names = match recognize(file_name, source.bytes) {
        Some(Format::Ply) => ply::companion_names(&source),
        Some(Format::Obj) => obj::companion_names(&source),
        Some(Format::Gltf) => gltf::companion_names(&source),
        Some(Format::Stl | Format::Off) | None => Vec::new(),
    };
    let mut keys: Vec<String> = names.iter().map(|name| companion_key(name)).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.retain(|key| !key.is_empty() && *key != companion_key(file_name));
    keys
}

/// A name without its folders.
pub(super) fn base_name(name: &str) -> &str {
    name.trim().rsplit(['/', '\\']).next().unwrap_or_default()
}

/// A name without its folders and its extension.
pub(super) fn stem(name: &str) -> &str {
    let name = base_name(name);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// A URI's `%20` and the like as what they stand for; whatever is no such code stays as it is.
pub(super) fn percent_decoded(uri: &str) -> String {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, behind)) = rest.split_first() {
        let code = (first == b'%')
            .then(|| std::str::from_utf8(behind.get(..2)?).ok())
            .flatten()
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        decoded.push(code.unwrap_or(first));
        rest = if code.is_some() { behind.get(2..).unwrap_or_default() } else { behind };
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_compared_without_folders_and_case() {
        assert_eq!(companion_key("Textures\\sub/Mug.PNG "), "mug.png");
        assert_eq!(stem("a/b.c.obj"), "b.c");
        assert_eq!(percent_decoded("a%20b%C3%A9%zz%4"), "a bé%zz%4");
    }
}
