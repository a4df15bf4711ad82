//! The structs of `common.wgsl` and `object.wgsl`, byte for byte.

use bytemuck::{Pod, Zeroable};

use super::extent::{Window, depth_range_mm};
use super::{Item, PhotoPlane, Picture};
use crate::math::{Pose, clip_from_camera};
use crate::scene::{OverlayMode, PhotoAdjustment, Rgb};

/// A dash of a reference's outline is so many times as long as the line is wide.
const DASH_PER_WIDTH: f32 = 2.5;

/// Of an object's opacity, where what it hides shows through.
const X_RAY_OPACITY: f32 = 0.6;

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct FrameUniform {
    clip_from_eye: [[f32; 4]; 4],
    image_rect: [f32; 4],
    target_rect: [f32; 4],
    distortion: [f32; 4],
    distortion_more: [f32; 4],
    photo: [f32; 4],
    background: [f32; 4],
    outline: [f32; 4],
    adjustment: [f32; 4],
    shown: [f32; 4],
    more: [f32; 4],
    lines: [f32; 4],
    window: [f32; 4],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ObjectUniform {
    eye_from_object: [[f32; 4]; 4],
    color: [f32; 4],
    id_color: [f32; 4],
    bounds: [f32; 4],
    surface: [f32; 4],
}

impl FrameUniform {
    /// For a target of `size` pixels whose corner is at `corner` in its framebuffer, and a window in it.
    pub fn new(picture: &Picture, corner: [u32; 2], size: [u32; 2], window: &Window) -> Self {
        let rect = picture.rect;
        let lens = picture.camera.distortion;
        let [red, green, blue] = unit_color(picture.background);
        Self {
            clip_from_eye: clip_from_camera(&picture.camera, &window.image_rect(picture, size))
                .as_mat4()
                .to_cols_array_2d(),
            image_rect: [rect.min.x, rect.min.y, rect.size().x, rect.size().y].map(|value| value as f32),
            target_rect: [corner[0], corner[1], size[0], size[1]].map(|value| value as f32),
            distortion: [lens.k1, lens.k2, lens.p1, lens.p2].map(|value| value as f32),
            distortion_more: [
                lens.k3 as f32,
                lens.valid_radius_squared().min(1e30) as f32,
                flag(!lens.is_none()),
                0.0,
            ],
            photo: photo_part(picture, size),
            background: [red, green, blue, picture.look.overlay_opacity],
            outline: outline_part(picture),
            adjustment: adjustment_part(&picture.look.photo),
            shown: shown_part(picture, size),
            more: [flag(picture.shows_masks()), 0.0, 0.0, 0.0],
            lines: lines_part(picture),
            window: [window.corner[0], window.corner[1], window.size[0], window.size[1]]
                .map(|value| value as f32),
        }
    }
}

fn photo_part(picture: &Picture, size: [u32; 2]) -> [f32; 4] {
    // Masks are as large as the photo, and may be there without it.
    let pixels = picture.photo.as_ref().or(picture.masks.as_ref()).map(|layer| &layer.0);
    let photo_pixels_per_target_pixel = picture.rect.size().x / f64::from(size[0]);
    [
        pixels.map_or(1.0, |pixels| pixels.width as f32),
        pixels.map_or(1.0, |pixels| pixels.height as f32),
        photo_pixels_per_target_pixel.log2().max(0.0) as f32,
        if picture.shows_photo() { picture.photo_opacity } else { 0.0 },
    ]
}

fn outline_part(picture: &Picture) -> [f32; 4] {
    let widths = picture.widths;
    let [line, selected] =
        if picture.outlines() { [widths.outline_px, widths.selected_outline_px] } else { [0.0; 2] };
    let ghost = if picture.shows_ghosts() { widths.ghost_px } else { 0.0 };
    [line / 2.0, selected / 2.0, ghost / 2.0, DASH_PER_WIDTH * widths.ghost_px]
}

fn adjustment_part(photo: &PhotoAdjustment) -> [f32; 4] {
    // A quarter of the contrast at −1, four times at 1.
    [photo.brightness, (2.0 * photo.contrast).exp2(), 1.0 + photo.saturation, flag(!photo.is_default())]
}

fn shown_part(picture: &Picture, size: [u32; 2]) -> [f32; 4] {
    let wipe = picture.look.wipe.filter(|_| picture.shows_meshes());
    [
        0.0,
        wipe.map_or(0.0, |part| part * size[0] as f32),
        wipe.map_or(0.0, |_| picture.widths.wipe_px / 2.0),
        0.0,
    ]
}

fn lines_part(picture: &Picture) -> [f32; 4] {
    let [nearest_mm, farthest_mm] = depth_range_mm(picture);
    let width = match picture.look.mode {
        OverlayMode::Wireframe => picture.widths.wireframe_px,
        _ => picture.widths.edge_px,
    };
    // Everything at one depth is as near as can be.
    [nearest_mm as f32, 1.0 / (farthest_mm - nearest_mm).max(1e-3) as f32, width, 0.0]
}

impl ObjectUniform {
    pub fn new(picture: &Picture, item: &Item) -> Self {
        let [red, green, blue] = unit_color(item.color);
        let id = item.id | if item.selected { 128 } else { 0 };
        let bounds = item.mesh().bounds();
        let largest_mm = bounds.size().max_element().max(f64::MIN_POSITIVE);
        let center = bounds.center().as_vec3();
        let look = &picture.look;
        // A difference is taken of the meshes' own colours.
        let opacity = if look.difference {
            1.0
        } else if look.x_ray && !draws_edges(look.mode) {
            item.opacity * X_RAY_OPACITY
        } else {
            item.opacity
        };
        Self {
            eye_from_object: matrix(&picture.eye_from_object(item)),
            color: [red, green, blue, opacity],
            id_color: [red, green, blue, f32::from(id) / 255.0],
            bounds: [center.x, center.y, center.z, (1.0 / largest_mm) as f32],
            surface: [flag(item.mesh().has_colors()), 0.0, 0.0, 0.0],
        }
    }

    /// Of what is given in the frame of the photo's camera: its plane, and lines.
    pub fn of_surroundings(picture: &Picture, plane: Option<&PhotoPlane>) -> Self {
        Self {
            eye_from_object: matrix(&picture.eye_from_camera),
            color: [0.0, 0.0, 0.0, plane.map_or(1.0, |plane| plane.opacity)],
            ..Self::zeroed()
        }
    }
}

/// Whether a mode draws a mesh's edges.
pub fn draws_edges(mode: OverlayMode) -> bool {
    matches!(mode, OverlayMode::Edges | OverlayMode::Wireframe)
}

fn matrix(pose: &Pose) -> [[f32; 4]; 4] {
    pose.to_mat4().as_mat4().to_cols_array_2d()
}

fn flag(is_set: bool) -> f32 {
    if is_set { 1.0 } else { 0.0 }
}

fn unit_color(Rgb(channels): Rgb) -> [f32; 3] {
    channels.map(|channel| f32::from(channel) / 255.0)
}
