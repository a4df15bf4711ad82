//! The renderer's pictures among the interface's shapes.

use std::sync::{Arc, Mutex, PoisonError};

use super::ViewportPlace;
use crate::render::{Picture, Renderer, ViewSlot};

/// The renderer belongs to the interface's paint callbacks and to exports.
pub type SharedRenderer = Arc<Mutex<Renderer>>;

/// Draws a picture into a view.
pub fn picture(
    ui: &egui::Ui,
    renderer: &SharedRenderer,
    slot: ViewSlot,
    picture: Picture,
    place: ViewportPlace,
) {
    if picture.has_fresh_mesh() {
        // It is drawn coarsely for now, so that it is seen at once.
        ui.ctx().request_repaint();
    }
    let callback = PictureCallback { renderer: renderer.clone(), slot, picture, place };
    ui.painter().add(egui_wgpu::Callback::new_paint_callback(place.rect, callback));
}

struct PictureCallback {
    renderer: SharedRenderer,
    slot: ViewSlot,
    picture: Picture,
    place: ViewportPlace,
}

impl egui_wgpu::CallbackTrait for PictureCallback {
    fn prepare(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _screen: &egui_wgpu::ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        _resources: &mut egui_wgpu::CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let mut renderer = self.renderer.lock().unwrap_or_else(PoisonError::into_inner);
        let (corner, size) = (self.place.corner_px(), self.place.size_px());
        renderer.prepare(self.slot, encoder, &self.picture, corner, size);
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &egui_wgpu::CallbackResources,
    ) {
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner).paint(self.slot, pass);
    }
}
