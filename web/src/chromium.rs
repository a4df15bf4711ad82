//! Finds the Chromium that the browser suite drives.

use std::path::{Path, PathBuf};

const PROGRAMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Where macOS keeps it, which is not on the search path.
const APPLICATIONS: [&str; 2] = [
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
];

/// The first Chromium or Chrome on the search path, or among the installed applications.
pub fn find() -> Option<PathBuf> {
    PROGRAMS
        .iter()
        .find_map(|program| find_program(program))
        .or_else(|| APPLICATIONS.iter().map(PathBuf::from).find(|path| path.is_file()))
}

/// The full path of a program on the search path.
pub fn find_program(name: &str) -> Option<PathBuf> {
    let search_path = std::env::var_os("PATH")?;
    std::env::split_paths(&search_path).map(|folder| folder.join(name)).find(|path| path.is_file())
}

/// Whether a Vulkan driver that needs no graphics card is installed: the native renderer's tests draw with it.
pub fn has_software_vulkan() -> bool {
    let Ok(drivers) = Path::new("/usr/share/vulkan/icd.d").read_dir() else { return false };
    drivers.flatten().any(|driver| driver.file_name().to_string_lossy().starts_with("lvp_icd"))
}
