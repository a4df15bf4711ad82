//! Drawings as pictures, and pages in the user's browser.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Fonts that look like a page's, the first that is installed.
const FAMILIES: [&str; 5] = ["Helvetica", "Arial", "Liberation Sans", "DejaVu Sans", "Noto Sans"];

/// Looking for them takes a moment: once for all drawings.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| Arc::new(fonts()));

/// A drawing as the bytes of a PNG file, so many pixels for each of its units.
pub async fn png_of_svg(text: String, scale: f64) -> Result<Vec<u8>, String> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    let scale = scale as f32;
    let drawn = || {
        let tree = Tree::from_str(&text, &options).ok()?;
        let size = tree.size().to_int_size().scale_by(scale)?;
        let mut pixels = Pixmap::new(size.width(), size.height())?;
        resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().ok()
    };
    drawn().ok_or_else(|| "it cannot be drawn".to_owned())
}

/// Opens a page in the user's browser, from a file among the system's temporary ones.
pub fn show_page(html: &str) -> Result<(), String> {
    let path = std::env::temp_dir().join("pinpose-report.html");
    std::fs::write(&path, html).map_err(|error| format!("{}: {error}", path.display()))?;
    let opened = std::process::Command::new("xdg-open").arg(&path).spawn();
    opened.map(|_| ()).map_err(|error| format!("{}: no browser opened it: {error}", path.display()))
}

/// The system's; on a machine without any, the font that the window has.
fn fonts() -> fontdb::Database {
    let mut fonts = fontdb::Database::new();
    fonts.load_system_fonts();
    let has = |family: &str| {
        let named = |face: &fontdb::FaceInfo| face.families.iter().any(|(name, _)| name == family);
        fonts.faces().any(named)
    };
    match FAMILIES.into_iter().find(|family| has(family)) {
        Some(family) => fonts.set_sans_serif_family(family),
        None => {
            fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
            fonts.set_sans_serif_family("Ubuntu");
        }
    }
    fonts
}
