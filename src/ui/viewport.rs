//! The photo with the meshes over it, and the quiet numbers in its corners.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Align2, Area, Id, Order, RichText, Sense, Ui, Vec2};

use super::{Surroundings, theme};
use crate::render::{Picture, Renderer, Subject, ViewSlot, picture_of};
use crate::scene::AnnotationState;
use crate::session::{Command, Session};

/// The renderer belongs to the interface's paint callbacks and to exports.
pub type SharedRenderer = Arc<Mutex<Renderer>>;

/// Where the viewport is on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewportPlace {
    /// In points, whole physical pixels.
    pub rect: egui::Rect,
    pub pixels_per_point: f32,
    pub layer: egui::LayerId,
}

impl ViewportPlace {
    /// The size in physical pixels.
    pub fn size_px(&self) -> [u32; 2] {
        [self.rect.width(), self.rect.height()]
            .map(|points| (points * self.pixels_per_point).round().max(1.0) as u32)
    }

    fn corner_px(&self) -> [u32; 2] {
        [self.rect.left(), self.rect.top()]
            .map(|points| (points * self.pixels_per_point).round().max(0.0) as u32)
    }
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    commands: &mut Vec<Command>,
) -> ViewportPlace {
    let pixels_per_point = ui.ctx().pixels_per_point();
    // Whole pixels, so that one texel of the picture is one pixel of the screen.
    let snap = |position: egui::Pos2| {
        egui::pos2((position.x * pixels_per_point).round(), (position.y * pixels_per_point).round())
            / pixels_per_point
    };
    let available = ui.max_rect();
    let rect = egui::Rect::from_min_max(snap(available.min), snap(available.max));
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Viewport"));
    let place = ViewportPlace { rect, pixels_per_point, layer: ui.layer_id() };
    if let (Some(renderer), Some(picture)) = (around.renderer, picture(session, around, pixels_per_point)) {
        let callback = SceneCallback { renderer: renderer.clone(), picture, place };
        ui.painter().add(eframe_callback(rect, callback));
    }
    cursor_icon(ui, &response, around);
    corners(ui, rect, session, around);
    hints(ui, rect, session, around, commands);
    if around.files_hover {
        let stroke = egui::Stroke::new(3.0, theme::ACCENT);
        ui.painter().rect_stroke(rect.shrink(6.0), 10.0, stroke, egui::StrokeKind::Inside);
    }
    place
}

fn picture(session: &Session, around: &Surroundings<'_>, pixels_per_point: f32) -> Option<Picture> {
    let photo = session.photo()?;
    let subject = Subject {
        selected: session.selected(),
        look: session.look(),
        pixels_per_point,
        ..Subject::new(session.scene(), photo.id, around.pixels.clone())
    };
    let mut picture = picture_of(&subject)?;
    picture.rect = around.view.visible_rect();
    Some(picture)
}

fn cursor_icon(ui: &Ui, response: &egui::Response, around: &Surroundings<'_>) {
    if around.dragging {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
    } else if response.hovered() && around.under_cursor.is_some() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grab);
    }
}

/// Zoom, the pixel under the cursor, and how far away and how large it is.
fn corners(ui: &Ui, rect: egui::Rect, session: &Session, around: &Surroundings<'_>) {
    let Some(photo) = session.photo() else { return };
    let mut text = format!("{:.0} %", around.view.zoom * 100.0);
    if let Some(pixel) = around.cursor_pixel {
        text += &format!("    u {:.1}  v {:.1}", pixel.x, pixel.y);
    }
    if let Some(hit) = around.under_cursor {
        let depth_mm = hit.point_camera_mm.z;
        text += &format!("    depth {depth_mm:.1} mm    1 px = {:.2} mm", depth_mm / photo.camera.focal_px());
    }
    note(ui, rect.left_bottom() + Vec2::new(10.0, -10.0), Align2::LEFT_BOTTOM, &text);
    if around.pixels.is_none() {
        note(ui, rect.center(), Align2::CENTER_CENTER, "Decoding the photo…");
    }
}

fn note(ui: &Ui, position: egui::Pos2, anchor: Align2, text: &str) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, ui.visuals().text_color());
    let frame = anchor.anchor_size(position, galley.size() + Vec2::new(16.0, 8.0));
    ui.painter().rect_filled(frame, 6.0, egui::Color32::from_black_alpha(170));
    ui.painter().galley(frame.min + Vec2::new(8.0, 4.0), galley, ui.visuals().text_color());
}

/// One line that says what to do next, where that may not be clear.
fn hints(
    ui: &Ui,
    rect: egui::Rect,
    session: &Session,
    around: &Surroundings<'_>,
    commands: &mut Vec<Command>,
) {
    let scene = session.scene();
    let photo = session.photo();
    let selected = session.selected().and_then(|id| scene.object(id));
    let placed = session.selected_annotation();
    let mut offer_place = None;
    let text = match (photo, selected, placed) {
        (None, _, _) => "Now drop a photo".to_owned(),
        (Some(_), _, _) if scene.objects.is_empty() => {
            "Now drop the mesh of the object (PLY, OBJ, GLB)".to_owned()
        }
        (Some(photo), _, _) if scene.objects_in(photo.id).next().is_none() && selected.is_none() => {
            "Nothing is placed in this photo: choose an object in the list".to_owned()
        }
        (Some(photo), Some(object), None) => {
            offer_place = Some((photo.id, object.id));
            format!("{} is not in this photo", object.name)
        }
        (_, _, Some((_, _, annotation))) if annotation.state == AnnotationState::Untouched => {
            "Drag the object onto its image.  Right drag: turn.  Shift + wheel: depth.".to_owned()
        }
        _ => return,
    };
    if around.dragging || session.question().is_some() {
        return;
    }
    let position = rect.center_top() + Vec2::new(0.0, 14.0);
    Area::new(Id::unique("hint"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(position)
        .interactable(offer_place.is_some())
        .show(ui.ctx(), |ui| {
            theme::overlay_frame().show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.label(RichText::new(text));
                    if let Some((photo, object)) = offer_place
                        && ui.add(theme::primary_button("Place it here")).clicked()
                    {
                        commands.push(Command::Place { photo, object });
                    }
                });
            });
        });
}

struct SceneCallback {
    renderer: SharedRenderer,
    picture: Picture,
    place: ViewportPlace,
}

fn eframe_callback(rect: egui::Rect, callback: SceneCallback) -> egui::epaint::PaintCallback {
    egui_wgpu::Callback::new_paint_callback(rect, callback)
}

impl egui_wgpu::CallbackTrait for SceneCallback {
    fn prepare(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _screen: &egui_wgpu::ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        _resources: &mut egui_wgpu::CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let mut renderer = self.renderer.lock().unwrap_or_else(PoisonError::into_inner);
        renderer.prepare(
            ViewSlot::Photo,
            encoder,
            &self.picture,
            self.place.corner_px(),
            self.place.size_px(),
        );
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &egui_wgpu::CallbackResources,
    ) {
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner).paint(ViewSlot::Photo, pass);
    }
}
