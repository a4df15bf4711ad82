//! Pictures at photo resolution: what they are, and those that the CPU makes exactly.

use std::sync::Arc;

use super::{Picture, Subject, picture_of};
use crate::photo::{DepthPixels, Pixels, png_gray8, png_gray16};
use crate::raster::{PixelRegion, RasterImage, RasterItem, rasterize};
use crate::scene::{ObjectId, PhotoId, Scene};

/// Depth pictures hold tenths of a millimetre (BOP's `depth_scale` 0.1): up to 6.5 m in 16 bits.
const DEPTH_STEPS_PER_MM: f32 = 10.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportKind {
    /// Photo with the meshes over it, as on screen; drawn by the GPU.
    Overlay,
    /// What the GPU draws of one object's silhouette, one sample a pixel: to check the renderer against [`Self::Mask`].
    Silhouette,
    /// One object's silhouette as if it were alone: white on black.
    Mask,
    /// The part of it that no other object hides.
    VisibleMask,
    /// All objects' depth in tenths of a millimetre, 16 bits, 0 where there is none.
    Depth,
}

impl ExportKind {
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Overlay, "overlay"),
        (Self::Silhouette, "silhouette"),
        (Self::Mask, "mask"),
        (Self::VisibleMask, "visible_mask"),
        (Self::Depth, "depth"),
    ];

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, candidate)| *candidate == name).map(|(kind, _)| *kind)
    }

    pub fn is_of_one_object(self) -> bool {
        matches!(self, Self::Silhouette | Self::Mask | Self::VisibleMask)
    }
}

/// The picture that the GPU draws for an export; `None` where photo or object are not there.
pub fn export_picture(
    scene: &Scene,
    photo: PhotoId,
    pixels: Option<Arc<Pixels>>,
    depth: Option<Arc<DepthPixels>>,
    object: Option<ObjectId>,
) -> Option<Picture> {
    let Some(object) = object else {
        return picture_of(&Subject { depth, ..Subject::new(scene, photo, pixels) });
    };
    let mut alone = scene.clone();
    alone.objects.retain(|candidate| candidate.id == object);
    let mut picture = picture_of(&Subject::new(&alone, photo, pixels))?;
    picture.ghosts.clear();
    (!picture.items.is_empty()).then_some(picture)
}

/// A silhouette that was read back as white on black PNG.
pub fn silhouette_png(ids: &Pixels) -> Option<Vec<u8>> {
    let covered = ids.rgba.chunks_exact(4).map(|texel| if texel[3] > 0 { 255 } else { 0 });
    png_gray8(ids.width, ids.height, covered.collect())
}

/// A mask or depth picture as PNG, without a GPU; `None` for other kinds and where photo or object are not there.
pub fn raster_png(
    scene: &Scene,
    photo: PhotoId,
    kind: ExportKind,
    object: Option<ObjectId>,
) -> Option<Vec<u8>> {
    let camera = scene.photo(photo)?.camera;
    let alone = matches!(kind, ExportKind::Mask);
    let placed = scene.objects_in(photo).filter(|(candidate, _)| {
        if alone { Some(candidate.id) == object } else { candidate.visible || Some(candidate.id) == object }
    });
    let items: Vec<RasterItem<'_>> = placed
        .map(|(object, annotation)| RasterItem {
            mesh: &object.mesh.mesh,
            camera_from_object: annotation.camera_from_object,
            id: object.id.0,
        })
        .collect();
    let image = rasterize(&camera, &items, PixelRegion::of_camera(&camera));
    match kind {
        ExportKind::Mask | ExportKind::VisibleMask => mask_png(&image, object?.0),
        ExportKind::Depth => depth_png(&image),
        ExportKind::Overlay | ExportKind::Silhouette => None,
    }
}

fn mask_png(image: &RasterImage, id: u32) -> Option<Vec<u8>> {
    let values = image.ids.iter().map(|&pixel| if pixel == id { 255 } else { 0 }).collect();
    png_gray8(image.width, image.height, values)
}

fn depth_png(image: &RasterImage) -> Option<Vec<u8>> {
    // The cast saturates: what is farther than 6.5 m has the largest value.
    let values =
        image.depth_mm.iter().map(|&depth_mm| (depth_mm * DEPTH_STEPS_PER_MM).round() as u16).collect();
    png_gray16(image.width, image.height, values)
}
