//! The structs of `common.wgsl` and `mesh.wgsl`, byte for byte.

use bytemuck::{Pod, Zeroable};

use super::{Item, Picture};
use crate::math::clip_from_camera;
use crate::scene::Rgb;

/// A dash of a reference's outline is so many times as long as the line is wide.
const DASH_PER_WIDTH: f32 = 2.5;

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct FrameUniform {
    clip_from_camera: [[f32; 4]; 4],
    image_rect: [f32; 4],
    target_rect: [f32; 4],
    distortion: [f32; 4],
    distortion_more: [f32; 4],
    photo: [f32; 4],
    background: [f32; 4],
    outline: [f32; 4],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ObjectUniform {
    camera_from_object: [[f32; 4]; 4],
    color: [f32; 4],
    id_color: [f32; 4],
}

impl FrameUniform {
    /// For a target of `size` pixels whose corner is at `corner` in its framebuffer.
    pub fn new(picture: &Picture, corner: [u32; 2], size: [u32; 2]) -> Self {
        let rect = picture.rect;
        let lens = picture.camera.distortion;
        let photo = picture.photo.as_ref().map(|layer| &layer.0);
        let photo_pixels_per_target_pixel = rect.size().x / f64::from(size[0]);
        let outline = picture
            .outline
            .map_or([0.0; 2], |outline| [outline.width_px / 2.0, outline.selected_width_px / 2.0]);
        let has_ghosts = !picture.ghosts.is_empty();
        let ghost_half_width = if has_ghosts { picture.ghost_width_px / 2.0 } else { 0.0 };
        let [red, green, blue] = unit_color(picture.background);
        Self {
            clip_from_camera: clip_from_camera(&picture.camera, &rect).as_mat4().to_cols_array_2d(),
            image_rect: [rect.min.x, rect.min.y, rect.size().x, rect.size().y].map(|value| value as f32),
            target_rect: [corner[0], corner[1], size[0], size[1]].map(|value| value as f32),
            distortion: [lens.k1, lens.k2, lens.p1, lens.p2].map(|value| value as f32),
            distortion_more: [
                lens.k3 as f32,
                lens.valid_radius_squared().min(1e30) as f32,
                if lens.is_none() { 0.0 } else { 1.0 },
                0.0,
            ],
            photo: [
                photo.map_or(1.0, |pixels| pixels.width as f32),
                photo.map_or(1.0, |pixels| pixels.height as f32),
                photo_pixels_per_target_pixel.log2().max(0.0) as f32,
                if photo.is_some() { 1.0 } else { 0.0 },
            ],
            background: [red, green, blue, picture.overlay_opacity],
            outline: [outline[0], outline[1], ghost_half_width, DASH_PER_WIDTH * picture.ghost_width_px],
        }
    }
}

impl ObjectUniform {
    pub fn new(item: &Item) -> Self {
        let [red, green, blue] = unit_color(item.color);
        let id = item.id | if item.selected { 128 } else { 0 };
        Self {
            camera_from_object: item.camera_from_object.to_mat4().as_mat4().to_cols_array_2d(),
            color: [red, green, blue, item.opacity],
            id_color: [red, green, blue, f32::from(id) / 255.0],
        }
    }
}

fn unit_color(Rgb(channels): Rgb) -> [f32; 3] {
    channels.map(|channel| f32::from(channel) / 255.0)
}
