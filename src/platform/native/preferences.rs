//! Preferences as small files beside the scenes.

use super::data_folder;
use super::folder::{file_name, read_if_there, write_whole};

pub fn read_stored_preference(key: &str) -> Option<String> {
    let path = data_folder()?.join("preferences").join(file_name(key));
    read_if_there(&path).unwrap_or_else(|error| {
        log::warn!("the preference {key} cannot be read: {error}");
        None
    })
}

pub fn write_stored_preference(key: &str, value: &str) {
    let Some(folder) = data_folder() else { return };
    write_whole(&folder.join("preferences").join(file_name(key)), value.as_bytes())
        .unwrap_or_else(|error| log::warn!("the preference {key} cannot be kept: {error}"));
}
