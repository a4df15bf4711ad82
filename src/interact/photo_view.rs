//! Which part of the photo fills the viewport: zoom and pan.

use glam::{DVec2, DVec3};

use super::viewpoint::{GroundDrag, Viewpoint};
use super::{Button, Eye, Modifiers, object_rect};
use crate::math::{ImageRect, Pose};
use crate::scene::{Layers, ObjectId};
use crate::session::Session;

/// Screen pixels per photo pixel can go up to this: single pixels fill a hand's breadth.
const MAX_ZOOM: f64 = 128.0;

/// The photo can be made smaller than the viewport by this factor, no more.
const MAX_SHRINK: f64 = 4.0;

/// The photo view's place: viewport pixels are physical ones, counted from the viewport's top left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotoView {
    /// The point of the photo (`image` frame) in the middle of the viewport.
    pub center: DVec2,
    /// Physical screen pixels per photo pixel.
    pub zoom: f64,
    /// Keeps the whole photo in view while the viewport changes its size.
    pub fitted: bool,
    viewport: DVec2,
    photo: DVec2,
}

impl Default for PhotoView {
    fn default() -> Self {
        Self { center: DVec2::ZERO, zoom: 1.0, fitted: true, viewport: DVec2::ONE, photo: DVec2::ONE }
    }
}

impl PhotoView {
    /// Tells the view the sizes of viewport and photo, in pixels.
    pub fn set_sizes(&mut self, viewport: DVec2, photo: DVec2) {
        if (self.viewport, self.photo) == (viewport, photo) {
            return;
        }
        let another_photo = self.photo != photo;
        (self.viewport, self.photo) = (viewport.max(DVec2::ONE), photo.max(DVec2::ONE));
        if another_photo || self.fitted {
            self.fit();
        }
        self.keep_in_bounds();
    }

    /// The size of the viewport in physical pixels.
    pub fn viewport(&self) -> DVec2 {
        self.viewport
    }

    /// Shows the whole photo.
    pub fn fit(&mut self) {
        self.zoom = self.fitting_zoom(self.photo);
        self.center = (self.photo - 1.0) / 2.0;
        self.fitted = true;
    }

    /// Shows a rectangle of the photo with some room around it.
    pub fn show(&mut self, rect: &ImageRect) {
        self.center = rect.center();
        self.zoom = self.fitting_zoom(rect.size().max(DVec2::ONE) * 1.4);
        self.fitted = false;
        self.keep_in_bounds();
    }

    /// Zooms by a factor; the point of the photo under `viewport_pixel` stays there.
    pub fn zoom_about(&mut self, viewport_pixel: DVec2, factor: f64) {
        let fixed = self.image_from_viewport(viewport_pixel);
        self.zoom *= factor;
        self.fitted = false;
        self.keep_in_bounds();
        self.center += fixed - self.image_from_viewport(viewport_pixel);
        self.keep_in_bounds();
    }

    /// Moves the photo by so many viewport pixels.
    pub fn pan(&mut self, delta: DVec2) {
        self.center -= delta / self.zoom;
        self.fitted = false;
        self.keep_in_bounds();
    }

    /// The point of the `image` frame at a point of the viewport. Viewport pixels are counted from the corner of the first, so
    /// its centre is at 0.5.
    pub fn image_from_viewport(&self, viewport_pixel: DVec2) -> DVec2 {
        self.center + (viewport_pixel - self.viewport / 2.0) / self.zoom
    }

    pub fn viewport_from_image(&self, image_pixel: DVec2) -> DVec2 {
        (image_pixel - self.center) * self.zoom + self.viewport / 2.0
    }

    /// The part of the `image` frame that fills the viewport.
    pub fn visible_rect(&self) -> ImageRect {
        ImageRect { min: self.image_from_viewport(DVec2::ZERO), max: self.image_from_viewport(self.viewport) }
    }

    fn fitting_zoom(&self, size: DVec2) -> f64 {
        (self.viewport / size).min_element()
    }

    fn keep_in_bounds(&mut self) {
        let whole = self.fitting_zoom(self.photo);
        self.zoom = self.zoom.clamp((whole / MAX_SHRINK).min(1.0), MAX_ZOOM.max(whole));
        // The middle of the viewport stays over the photo, so that it cannot be lost.
        self.center = self.center.clamp(DVec2::splat(-0.5), self.photo - 0.5);
    }
}

impl Viewpoint for PhotoView {
    fn eye(&self, session: &Session) -> Option<Eye> {
        let camera = session.photo()?.camera;
        let origin_px = self.viewport / 2.0 - self.center * self.zoom;
        Some(Eye { camera, eye_from_camera: Pose::IDENTITY, zoom: self.zoom, origin_px })
    }

    fn is_photo(&self) -> bool {
        true
    }

    fn ground_drag_anywhere(&self, button: Button, _modifiers: Modifiers) -> Option<GroundDrag> {
        (button == Button::Middle).then_some(GroundDrag::Pan)
    }

    fn ground_drag(&self) -> GroundDrag {
        GroundDrag::Pan
    }

    fn begin_ground_drag(&mut self, _session: &Session) {}

    fn drag_ground(&mut self, _kind: GroundDrag, way_px: DVec2) {
        self.pan(way_px);
    }

    fn zoom_about(&mut self, position: DVec2, factor: f64, _surface_camera_mm: Option<DVec3>) {
        Self::zoom_about(self, position, factor);
    }

    fn show(&mut self, session: &Session, object: Option<ObjectId>) {
        let photo = session.photo().map(|photo| photo.id);
        let rect = photo.zip(object).and_then(|(photo, object)| object_rect(session.scene(), photo, object));
        match rect {
            Some(rect) => Self::show(self, &rect),
            None => self.fit(),
        }
    }

    fn wipe_px(&self, session: &Session) -> Option<f64> {
        let look = session.look();
        let part = look.wipe.filter(|_| look.layers != Layers::PhotoOnly)?;
        Some(f64::from(part) * self.viewport.x)
    }

    fn width_px(&self) -> f64 {
        self.viewport.x
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn zooming_keeps_the_point_under_the_cursor(
            x in 100.0..700.0, y in 100.0..500.0, factor in 0.8..8.0_f64
        ) {
            let mut view = PhotoView::default();
            view.set_sizes(DVec2::new(800.0, 600.0), DVec2::new(640.0, 480.0));
            let cursor = DVec2::new(x, y);
            let before = view.image_from_viewport(cursor);
            view.zoom_about(cursor, factor);
            prop_assert!(view.image_from_viewport(cursor).distance(before) < 1e-9);
            prop_assert!(view.viewport_from_image(before).distance(cursor) < 1e-9);
        }
    }

    #[test]
    fn a_fitted_photo_touches_the_viewport_from_edge_to_edge() {
        let mut view = PhotoView::default();
        view.set_sizes(DVec2::new(800.0, 600.0), DVec2::new(640.0, 480.0));
        assert_eq!(view.visible_rect(), ImageRect::of_photo(640, 480));
        view.set_sizes(DVec2::new(400.0, 600.0), DVec2::new(640.0, 480.0));
        assert_eq!(view.zoom, 0.625);
    }
}
