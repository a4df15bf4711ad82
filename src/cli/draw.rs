//! Pictures at photo resolution, by the GPU or the rasteriser.

use std::sync::Arc;

use crate::photo::{decode, decode_depth, png_rgba};
use crate::render::{ExportKind, Layer, Renderer, export_picture, raster_png, silhouette_png};
use crate::scene::{ObjectId, Photo, PhotoId, Scene};

/// A renderer that is made when the first picture needs one: masks and depth do not.
#[derive(Default)]
pub struct LazyRenderer(Option<Renderer>);

impl LazyRenderer {
    /// The picture as PNG; an error does not name the photo.
    pub fn draw(
        &mut self,
        scene: &Scene,
        photo: PhotoId,
        kind: ExportKind,
        object: Option<ObjectId>,
    ) -> Result<Vec<u8>, String> {
        let png = match kind {
            ExportKind::Overlay | ExportKind::Silhouette => {
                let photo = scene.photo(photo).ok_or("the photo is not there")?;
                self.draw_on_gpu(scene, photo, kind, object)?
            }
            ExportKind::Mask | ExportKind::VisibleMask | ExportKind::Depth => {
                raster_png(scene, photo, kind, object)
            }
        };
        png.ok_or_else(|| "the picture cannot be made".to_owned())
    }

    fn draw_on_gpu(
        &mut self,
        scene: &Scene,
        photo: &Photo,
        kind: ExportKind,
        object: Option<ObjectId>,
    ) -> Result<Option<Vec<u8>>, String> {
        let decoded = decode(&photo.asset.bytes).map_err(|error| error.to_string())?;
        let occluding = photo.depth.as_ref().filter(|depth| depth.occludes);
        let depth = occluding.map(|depth| decode_depth(&depth.asset.bytes).map(Arc::new)).transpose();
        let depth = depth.map_err(|error| format!("its depth map: {error}"))?;
        let pixels = Some(Arc::new(decoded.pixels));
        let Some(picture) = export_picture(scene, photo.id, pixels, depth, object) else { return Ok(None) };
        let renderer = match &mut self.0 {
            Some(renderer) => renderer,
            empty => empty.insert(Renderer::headless().map_err(|error| error.to_string())?),
        };
        let layer = if kind == ExportKind::Silhouette { Layer::Ids } else { Layer::Picture };
        let pending = renderer.draw_and_read(&picture, [photo.camera.width, photo.camera.height], layer);
        let pixels = pending.wait(renderer.gpu()).map_err(|error| error.to_string())?;
        Ok(if kind == ExportKind::Silhouette { silhouette_png(&pixels) } else { png_rgba(&pixels) })
    }
}
