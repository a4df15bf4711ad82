//! Every picture of the corpus decodes or is refused with a reason; none panics or takes long.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use pinpose::photo::decode;

use crate::data_folder;

#[test]
fn every_picture_loads_or_is_refused() {
    let Some(folder) = data_folder("images_misc") else { return };
    let (mut loaded, mut refused) = (0, Vec::new());
    for path in files_below(&folder) {
        let bytes = std::fs::read(&path).unwrap();
        let start = Instant::now();
        let result = decode(&bytes);
        assert!(start.elapsed() < Duration::from_secs(5), "{} took {:?}", path.display(), start.elapsed());
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match result {
            Ok(photo) => {
                assert_eq!(photo.pixels.rgba.len(), 4 * (photo.pixels.width * photo.pixels.height) as usize);
                loaded += 1;
            }
            Err(error) => refused.push(format!("{name}: {error}")),
        }
    }
    println!("{loaded} pictures load, {} are refused:\n{}", refused.len(), refused.join("\n"));
    assert!(loaded > 150);
    // PngSuite's corrupt files begin with x, apart from those with colours that the rest of the file makes up for.
    let corrupt = refused.iter().filter(|line| line.starts_with('x')).count();
    assert!(corrupt >= 10, "corrupt files were taken");
    let sound = refused.iter().filter(|line| !line.starts_with('x') && line.contains(".png"));
    assert_eq!(sound.count(), 0, "sound files were refused");
}

#[test]
fn every_exif_orientation_stands_upright() {
    let Some(folder) = data_folder("images_misc") else { return };
    let landscapes: Vec<PathBuf> = files_below(&folder.join("exif-orientation-examples"))
        .into_iter()
        .filter(|path| {
            path.to_string_lossy().contains("Landscape_") && path.extension().is_some_and(|e| e == "jpg")
        })
        .collect();
    assert!(landscapes.len() >= 8, "{landscapes:?}");
    for path in landscapes {
        let pixels = decode(&std::fs::read(&path).unwrap()).unwrap().pixels;
        assert!(pixels.width > pixels.height, "{} lies on its side", path.display());
    }
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            _ if path.is_dir() => files.extend(files_below(&path)),
            Some("png" | "jpg" | "jpeg") => files.push(path),
            _ => {}
        }
    }
    files.sort();
    files
}
