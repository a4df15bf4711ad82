//! Pictures at the photo's resolution, pixel-exact: masks, depth, NOCS, boxes; and `pictures.json`, which says what each one
//! holds.

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::boxes::draw_boxes;
use super::paths;
use super::plan::{PhotoPlan, Placed, Plan, raster_items};
use crate::photo::{Pixels, decode, png_gray8, png_gray16, png_rgba};
use crate::raster::{Mask, PixelRegion, RasterImage, Silhouette, rasterize};
use crate::scene::Photo;

/// The JSON Schema of `pictures.json`.
pub const PICTURES_SCHEMA: &str = include_str!("pictures.schema.json");

const CANNOT_ENCODE: &str = "the picture cannot be encoded";

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PictureKind {
    /// Drawn by a renderer; the others are made here.
    Overlay,
    Mask,
    VisibleMask,
    Depth,
    Nocs,
    Boxes,
}

impl PictureKind {
    /// Also the folder that its pictures are in.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overlay => "overlays",
            Self::Mask => "masks",
            Self::VisibleMask => "visible_masks",
            Self::Depth => "depth",
            Self::Nocs => "nocs",
            Self::Boxes => "boxes",
        }
    }

    pub fn is_of_one_object(self) -> bool {
        matches!(self, Self::Mask | Self::VisibleMask)
    }
}

#[derive(Debug, Serialize)]
struct PicturesFile<'a> {
    format: &'static str,
    version: u32,
    generator: &'static str,
    photos: &'a [PhotoPictures],
}

/// The pictures of one photo, and the boxes of its objects.
#[derive(Debug, Serialize)]
pub(super) struct PhotoPictures {
    file: String,
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: [[f64; 3]; 3],
    distortion: Option<[f64; 5]>,
    pictures: Vec<PictureEntry>,
    objects: Vec<ObjectBoxes>,
    #[serde(skip)]
    photo: usize,
}

#[derive(Debug, Serialize)]
struct PictureEntry {
    path: String,
    kind: &'static str,
    object: Option<String>,
    /// Of a depth picture: the pixel's value times this is z in millimetres.
    mm_per_step: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ObjectBoxes {
    object: String,
    /// x, y, width, height in pixels; the whole silhouette reaches beyond the photo.
    box_whole: Option<[i64; 4]>,
    box_visible: Option<[i64; 4]>,
    visible_fraction: f64,
    /// x, y of the eight corners of the object's box, z slowest, x fastest; null behind the camera.
    box_3d_px: [Option<[f64; 2]>; 8],
    /// A colour of the NOCS picture is (X − center) / size + ½.
    nocs_center_mm: [f64; 3],
    nocs_size_mm: f64,
}

impl PhotoPictures {
    pub fn new(plan: &Plan, photo_index: usize, photo: &Photo, silhouettes: &[Silhouette]) -> Self {
        let placed = plan.placed(photo);
        Self {
            file: photo.asset.file_name.clone(),
            width: photo.camera.width,
            height: photo.camera.height,
            k: photo.camera.k_rows(),
            distortion: (!photo.camera.distortion.is_none()).then(|| photo.camera.distortion.to_array()),
            pictures: Vec::new(),
            objects: placed
                .iter()
                .zip(silhouettes)
                .map(|(placed, found)| boxes_of(photo, placed, found))
                .collect(),
            photo: photo_index,
        }
    }

    pub fn is_of(&self, photo_index: usize) -> bool {
        self.photo == photo_index
    }

    /// Lists the overlay that a renderer is to draw; its path.
    pub fn list_overlay(&mut self, plan: &Plan, planned: &PhotoPlan) -> String {
        let kind = PictureKind::Overlay.name();
        let path = paths::picture(plan, planned, kind, None);
        self.pictures.push(PictureEntry { path: path.clone(), kind, object: None, mm_per_step: None });
        path
    }

    /// Makes a picture and lists it; the path and the file.
    pub fn make(
        &mut self,
        plan: &Plan,
        planned: &PhotoPlan,
        photo: &Photo,
        kind: PictureKind,
        of: Option<(&Placed<'_>, &Silhouette)>,
    ) -> Result<(String, Vec<u8>), String> {
        let path = paths::picture(plan, planned, kind.name(), of.map(|(placed, _)| placed.index));
        let placed = plan.placed(photo);
        let mut mm_per_step = None;
        let bytes = match (kind, of) {
            (PictureKind::Mask, Some((_, silhouette))) => mask_png(&silhouette.whole),
            (PictureKind::VisibleMask, Some((_, silhouette))) => mask_png(&silhouette.visible),
            (PictureKind::Overlay, _) | (PictureKind::Mask | PictureKind::VisibleMask, None) => None,
            (PictureKind::Depth, _) => {
                let (png, scale) = depth_png(&drawn(photo, &placed));
                mm_per_step = Some(scale);
                png
            }
            (PictureKind::Nocs, _) => nocs_png(photo, &placed),
            (PictureKind::Boxes, _) => {
                let decoded = decode(&photo.asset.bytes).map_err(|error| format!("{path}: {error}"))?;
                let boxes: Vec<_> =
                    self.objects.iter().map(|object| (object.box_visible, object.box_3d_px)).collect();
                png_rgba(&with_boxes(decoded.pixels, &placed, &boxes))
            }
        };
        let bytes = bytes.ok_or_else(|| format!("{path}: {CANNOT_ENCODE}"))?;
        let object = of.map(|(placed, _)| placed.object.name.clone());
        self.pictures.push(PictureEntry { path: path.clone(), kind: kind.name(), object, mm_per_step });
        Ok((path, bytes))
    }
}

pub(super) fn pictures_json(photos: &[PhotoPictures]) -> String {
    let generator = concat!("PinPose ", env!("CARGO_PKG_VERSION"));
    let file = PicturesFile { format: "pinpose-pictures", version: 1, generator, photos };
    serde_json::to_string_pretty(&file).unwrap_or_default()
}

/// White on black.
pub(super) fn mask_png(mask: &Mask) -> Option<Vec<u8>> {
    let (width, height) = (mask.width(), mask.height());
    let values = (0..height).flat_map(|y| (0..width).map(move |x| if mask.get(x, y) { 255 } else { 0 }));
    png_gray8(width, height, values.collect())
}

fn drawn(photo: &Photo, placed: &[Placed<'_>]) -> RasterImage {
    rasterize(&photo.camera, &raster_items(placed), PixelRegion::of_camera(&photo.camera))
}

/// Steps of a tenth of a millimetre, or of the first power of ten above it with which the farthest surface fits 16 bits.
fn depth_png(drawn: &RasterImage) -> (Option<Vec<u8>>, f64) {
    let farthest_mm = drawn.depth_mm.iter().copied().fold(0.0_f32, f32::max);
    let most_steps = f32::from(u16::MAX);
    let steps =
        [10.0, 1.0, 0.1, 0.01].into_iter().find(|steps| farthest_mm * steps <= most_steps).unwrap_or(0.001);
    let values = drawn.depth_mm.iter().map(|depth_mm| (depth_mm * steps).round() as u16).collect();
    let mm_per_step = match steps {
        10.0 => 0.1,
        steps => (1.0 / f64::from(steps)).round(),
    };
    (png_gray16(drawn.width, drawn.height, values), mm_per_step)
}

/// Where on its object each pixel looks, as a colour; transparent where no object is. The same colours as on screen.
fn nocs_png(photo: &Photo, placed: &[Placed<'_>]) -> Option<Vec<u8>> {
    let picture = drawn(photo, placed);
    let frames: Vec<_> = placed.iter().map(|placed| (placed.pose().inverse(), nocs_frame(placed))).collect();
    let mut rgba = vec![0; 4 * picture.ids.len()];
    let pixels = picture.ids.iter().zip(&picture.depth_mm).zip(rgba.chunks_exact_mut(4));
    for (pixel, ((&id, &depth_mm), texel)) in pixels.enumerate() {
        let Some((object_from_camera, (center, size))) =
            (id as usize).checked_sub(1).and_then(|at| frames.get(at))
        else {
            continue;
        };
        let (x, y) = (pixel % picture.width as usize, pixel / picture.width as usize);
        let ray = photo.camera.unproject(DVec2::new(x as f64, y as f64));
        let point = object_from_camera.transform_point(ray * f64::from(depth_mm));
        let color = ((point - *center) / *size + 0.5).clamp(DVec3::ZERO, DVec3::ONE) * 255.0;
        let color = color.round();
        texel.copy_from_slice(&[color.x as u8, color.y as u8, color.z as u8, 255]);
    }
    png_rgba(&Pixels { width: picture.width, height: picture.height, rgba })
}

/// The middle of the object's box, and its longest side: one scale for all axes keeps angles.
fn nocs_frame(placed: &Placed<'_>) -> (DVec3, f64) {
    let bounds = placed.object.mesh.mesh.bounds();
    (bounds.center(), bounds.size().max_element().max(f64::MIN_POSITIVE))
}

fn boxes_of(photo: &Photo, placed: &Placed<'_>, silhouette: &Silhouette) -> ObjectBoxes {
    let corners = placed.object.mesh.mesh.bounds().corners();
    let project = |corner: DVec3| {
        photo.camera.project(placed.pose().transform_point(corner)).map(|pixel| pixel.to_array())
    };
    let (center, size) = nocs_frame(placed);
    ObjectBoxes {
        object: placed.object.name.clone(),
        box_whole: silhouette.whole_box.map(box_numbers),
        box_visible: silhouette.visible.bounding_box().map(box_numbers),
        visible_fraction: silhouette.visible_fraction(),
        box_3d_px: corners.map(project),
        nocs_center_mm: center.to_array(),
        nocs_size_mm: size,
    }
}

/// x, y, width, height.
pub(super) fn box_numbers(region: PixelRegion) -> [i64; 4] {
    [region.x0.into(), region.y0.into(), region.width.into(), region.height.into()]
}

type Boxes = (Option<[i64; 4]>, [Option<[f64; 2]>; 8]);

fn with_boxes(mut photo: Pixels, placed: &[Placed<'_>], boxes: &[Boxes]) -> Pixels {
    for (placed, (visible, corners)) in placed.iter().zip(boxes) {
        draw_boxes(&mut photo, placed.object.color, *visible, corners);
    }
    photo
}
