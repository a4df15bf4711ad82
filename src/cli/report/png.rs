//! A report's figures as PNG files.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::study::report::{Figure, svg};

/// 192 dots an inch: twice the drawing's units.
const SCALE: f32 = 2.0;

/// Fonts that look like the page's, the first that is installed.
const FAMILIES: [&str; 5] = ["Helvetica", "Arial", "Liberation Sans", "DejaVu Sans", "Noto Sans"];

/// Paths and contents.
pub fn figures(figures: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let options = Options { fontdb: Arc::new(fonts()), ..Options::default() };
    let drawn = |figure: &Figure| {
        let path = format!("figures/{}.png", figure.name);
        let bytes = png(&svg(&figure.drawing, &figure.title), &options)
            .ok_or_else(|| format!("{path}: it cannot be drawn"))?;
        Ok((path, bytes))
    };
    figures.iter().map(drawn).collect()
}

fn png(text: &str, options: &Options<'_>) -> Option<Vec<u8>> {
    let tree = Tree::from_str(text, options).ok()?;
    let size = tree.size().to_int_size().scale_by(SCALE)?;
    let mut pixels = Pixmap::new(size.width(), size.height())?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().ok()
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
