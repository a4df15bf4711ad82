//! The renderer's pictures among the interface's shapes.

use std::sync::{Arc, Mutex, PoisonError};

use super::ViewportPlace;
use crate::render::{Picture, Renderer, ViewSlot};

/// The renderer belongs to the interface's paint callbacks and to exports.
pub type SharedRenderer = Arc<Mutex<Renderer>>;

/// So long a large mesh is shown by its coarse copy when it comes, in seconds: it is seen at once, and the rest is uploaded
/// when the GPU has that behind it.
const COARSE_AT_FIRST_SECONDS: f64 = 0.4;

/// Is the picture to be drawn coarsely because a mesh in it has just come? If so, another frame follows that is not.
pub fn shows_new_mesh(ui: &egui::Ui, picture: &Picture) -> bool {
    let id = egui::Id::unique("coarse until");
    let now = ui.input(|input| input.time);
    if picture.has_fresh_mesh() {
        ui.data_mut(|data| data.insert_temp(id, now + COARSE_AT_FIRST_SECONDS));
    }
    let left = ui.data(|data| data.get_temp::<f64>(id)).map_or(0.0, |until| until - now);
    if left > 0.0 {
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(left));
    }
    left > 0.0
}

/// Draws a picture into a view.
pub fn picture(
    ui: &egui::Ui,
    renderer: &SharedRenderer,
    slot: ViewSlot,
    picture: Picture,
    place: ViewportPlace,
) {
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
