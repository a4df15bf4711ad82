//! What lies below the meshes, kept: photo and masks seldom change, and filtering them costs a software GPU most of a frame.

use super::pipelines::PipelineKind;
use super::targets::picture_target;
use super::view::Drawn;
use super::{PhotoLayer, Picture};
use crate::math::ImageRect;
use crate::scene::{Layers, PhotoAdjustment, Rgb};

/// A view's photo and masks as they are on screen, at the same place of a texture as in the framebuffer.
#[derive(Debug, Default)]
pub struct Base {
    kept: Option<(Content, wgpu::TextureView)>,
    /// Of the last picture. What is there for the first time may be gone with the next, while the view moves.
    seen: Option<Content>,
}

/// Everything that the pixels depend on.
#[derive(Debug, Clone, PartialEq)]
struct Content {
    photo: Option<PhotoLayer>,
    masks: Option<PhotoLayer>,
    photo_opacity: f32,
    adjustment: PhotoAdjustment,
    layers: Layers,
    background: Rgb,
    rect: ImageRect,
    corner: [u32; 2],
    size: [u32; 2],
}

impl Content {
    fn of(Drawn { picture, corner, size, .. }: &Drawn) -> Self {
        Self {
            photo: picture.photo.clone(),
            masks: picture.masks.clone(),
            photo_opacity: picture.photo_opacity,
            adjustment: picture.look.photo,
            layers: picture.look.layers,
            background: picture.background,
            rect: picture.rect,
            corner: *corner,
            size: *size,
        }
    }
}

impl Base {
    /// What is kept, where it is what lies below this picture.
    pub fn of(&self, drawn: &Drawn) -> Option<&wgpu::TextureView> {
        let (content, texture) = self.kept.as_ref()?;
        (drawn.picture.surroundings.is_none() && *content == Content::of(drawn)).then_some(texture)
    }

    /// A texture to draw it into, if it is worth it: when the same lies below two pictures in a row.
    pub fn wanted(&mut self, device: &wgpu::Device, drawn: &Drawn) -> Option<&wgpu::TextureView> {
        if drawn.picture.surroundings.is_some() || self.of(drawn).is_some() {
            return None;
        }
        let content = Content::of(drawn);
        if self.seen.as_ref() != Some(&content) {
            self.seen = Some(content);
            return None;
        }
        let end = [0, 1].map(|axis| drawn.corner[axis].saturating_add(drawn.size[axis]));
        if end.iter().any(|&end| end > device.limits().max_texture_dimension_2d) {
            return None;
        }
        let texture = picture_target(device, end).create_view(&wgpu::TextureViewDescriptor::default());
        Some(&self.kept.insert((content, texture)).1)
    }
}

/// What a picture's base is composed of, from below.
pub fn base_parts(picture: &Picture) -> impl Iterator<Item = PipelineKind> {
    use PipelineKind as Kind;
    let is_changed = picture.photo_opacity < 1.0 || !picture.look.photo.is_default();
    let shows_photo = picture.shows_photo() && picture.photo_opacity > 0.0;
    let is_covered = shows_photo && picture.is_inside_photo();
    let parts = [
        (!is_covered).then_some(Kind::Background),
        shows_photo.then_some(if is_changed { Kind::ChangedPhoto } else { Kind::Photo }),
        picture.shows_masks().then_some(Kind::Masks),
    ];
    parts.into_iter().flatten()
}
