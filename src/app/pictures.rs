//! Pictures at photo resolution: waits for the photo to be decoded and for the GPU to be read, and hands over PNGs.

use std::sync::PoisonError;

use super::PinPose;
use crate::photo::png_rgba;
use crate::platform::{self, PageAnswer, PageReply};
use crate::render::{ExportKind, Layer, PixelsPending, export_picture, raster_png, silhouette_png};
use crate::scene::{ObjectId, PhotoId, Scene};
use crate::session::{Notice, PictureKind, PictureRequest};

/// Pictures that take more than this frame.
#[derive(Default)]
pub struct Pictures {
    /// Not begun: the photo may have to be decoded first.
    asked: Vec<Asked>,
    /// Drawn, and being read back.
    drawn: Vec<(PixelsPending, ExportKind, PictureFor)>,
}

struct Asked {
    photo: PhotoId,
    kind: ExportKind,
    object: Option<ObjectId>,
    target: PictureFor,
}

/// Where a picture goes.
pub enum PictureFor {
    Page(PageReply),
    Download(String),
    /// Into the export that is under way, whose scene is drawn, under this path.
    Export(String),
}

impl Pictures {
    pub fn ask(&mut self, photo: PhotoId, kind: ExportKind, object: Option<ObjectId>, target: PictureFor) {
        self.asked.push(Asked { photo, kind, object, target });
    }
}

impl PinPose {
    pub(super) fn export(&mut self, request: PictureRequest) {
        let kind = match request.kind {
            PictureKind::Overlay => ExportKind::Overlay,
            PictureKind::Mask => ExportKind::Mask,
            PictureKind::VisibleMask => ExportKind::VisibleMask,
            PictureKind::Depth => ExportKind::Depth,
        };
        self.pictures.ask(request.photo, kind, request.object, PictureFor::Download(request.file_name));
    }

    pub(super) fn make_pictures(&mut self, ctx: &egui::Context) {
        for asked in std::mem::take(&mut self.pictures.asked) {
            match asked.kind {
                ExportKind::Mask | ExportKind::VisibleMask | ExportKind::Depth => self.rasterize(asked),
                ExportKind::Overlay if !self.is_decoded(&asked) || self.waits_for_depth(asked.photo) => {
                    self.pictures.asked.push(asked);
                }
                ExportKind::Overlay | ExportKind::Silhouette => self.draw_picture(asked, ctx),
            }
        }
        self.finish_pictures(ctx);
    }

    fn rasterize(&mut self, asked: Asked) {
        let png = raster_png(self.session.scene(), asked.photo, asked.kind, asked.object);
        self.hand_over(asked.target, png.ok_or_else(|| "the picture cannot be made".to_owned()));
    }

    /// Are the photo's pixels there? If not, they are sent for.
    fn is_decoded(&mut self, asked: &Asked) -> bool {
        let photo = self.scene_of(&asked.target).photo(asked.photo);
        let Some(asset) = photo.map(|photo| photo.asset.clone()) else { return true };
        if self.photos.get(asset.sha256).is_some() {
            return true;
        }
        if self.photos.wanted != Some(asset.sha256) {
            self.photos.wanted = Some(asset.sha256);
            self.loading.decode(&asset);
        }
        false
    }

    /// An export draws what there was when it began.
    fn scene_of(&self, target: &PictureFor) -> &Scene {
        let exported = matches!(target, PictureFor::Export(_)).then(|| self.exporting.scene()).flatten();
        exported.unwrap_or_else(|| self.session.scene())
    }

    fn draw_picture(&mut self, asked: Asked, ctx: &egui::Context) {
        let depth = self.depth_of(asked.photo);
        let scene = self.scene_of(&asked.target);
        let pixels = scene.photo(asked.photo).and_then(|photo| self.photos.get(photo.asset.sha256));
        let object = asked.object.filter(|_| asked.kind.is_of_one_object());
        let picture = export_picture(scene, asked.photo, pixels, depth, object);
        let (Some(picture), Some(renderer)) = (picture, &self.renderer) else {
            self.hand_over(asked.target, Err("the picture cannot be drawn".to_owned()));
            return;
        };
        let layer = if asked.kind == ExportKind::Silhouette { Layer::Ids } else { Layer::Picture };
        let size = [picture.camera.width, picture.camera.height];
        let mut renderer = renderer.lock().unwrap_or_else(PoisonError::into_inner);
        let pending = renderer.draw_and_read(&picture, size, layer);
        drop(renderer);
        self.pictures.drawn.push((pending, asked.kind, asked.target));
        ctx.request_repaint();
    }

    fn finish_pictures(&mut self, ctx: &egui::Context) {
        let Some(renderer) = &self.renderer else { return };
        let gpu = renderer.lock().unwrap_or_else(PoisonError::into_inner).gpu().clone();
        for (pending, kind, target) in std::mem::take(&mut self.pictures.drawn) {
            let Some(pixels) = pending.poll(&gpu) else {
                self.pictures.drawn.push((pending, kind, target));
                ctx.request_repaint();
                continue;
            };
            let png = pixels.map_err(|error| error.to_string()).and_then(|pixels| {
                let png =
                    if kind == ExportKind::Silhouette { silhouette_png(&pixels) } else { png_rgba(&pixels) };
                png.ok_or_else(|| "the picture cannot be written as PNG".to_owned())
            });
            self.hand_over(target, png);
        }
    }

    fn hand_over(&mut self, target: PictureFor, png: Result<Vec<u8>, String>) {
        match target {
            PictureFor::Page(reply) => {
                // Who asked may be gone.
                reply.send(png.map(PageAnswer::Bytes)).ok();
            }
            PictureFor::Export(path) => self.take_export_picture(path, png),
            PictureFor::Download(file_name) => {
                match png.and_then(|bytes| platform::download(&file_name, &bytes)) {
                    Ok(()) => self.notify(Notice::info(format!("{file_name} saved"))),
                    Err(error) => self.notify(Notice::error(format!("{file_name}: {error}"))),
                }
            }
        }
    }
}
