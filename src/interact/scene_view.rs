//! A free eye around photo and objects: orbit, pan, zoom, standard views.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec2, DVec3};

use super::scene_content::{content_points, object_points, orbit_pivot_mm};
use super::viewpoint::{GroundDrag, Viewpoint};
use super::{Button, Eye, Modifiers};
use crate::math::{Intrinsics, Pose};
use crate::scene::{ObjectId, PhotoId};
use crate::session::Session;

/// From the top of the viewport to its bottom.
const FIELD_OF_VIEW_RAD: f64 = 40.0 * PI / 180.0;

/// Of the viewport's half sides, what fitted content may fill: read-outs are in the corners.
const FILLED: f64 = 0.84;

/// A little to the side of the photographing camera and above it.
const START_YAW_RAD: f64 = 0.42;
const START_PITCH_RAD: f64 = 0.30;

/// The eye comes no nearer to what it zooms to, and goes no farther from what it orbits.
const NEAREST_MM: f64 = 5.0;
const FARTHEST_MM: f64 = 1e6;

const ANIMATION_SECS: f64 = 0.25;

/// The scene view's place, in the frame of the shown photo's camera. A turntable: that camera's −y is always up.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneView {
    place: Place,
    pivot_mm: DVec3,
    viewport: DVec2,
    /// Shows all there is while the viewport changes its size and photos and objects come.
    fitted: bool,
    framed: Option<Framed>,
    animation: Option<Animation>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    /// To the side: the eye is on the camera's right where it is positive.
    yaw_rad: f64,
    /// Down: the eye is above where it is positive.
    pitch_rad: f64,
    eye_mm: DVec3,
}

/// What a fitted view was fitted to. Poses are not in it: the view must not follow a drag.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Framed {
    viewport: DVec2,
    photo: Option<PhotoId>,
    object_count: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Animation {
    from: Place,
    to: Place,
    /// Known from the first frame on.
    start_secs: Option<f64>,
}

/// A view along an axis of the camera's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandardView {
    Right,
    Left,
    Bottom,
    Top,
    Back,
    Front,
}

impl StandardView {
    pub const ALL: [Self; 6] = [Self::Right, Self::Left, Self::Bottom, Self::Top, Self::Back, Self::Front];

    /// From where the eye looks: the axis that points at it. The camera's y points down, its z away from it.
    pub fn axis(self) -> DVec3 {
        match self {
            Self::Right => DVec3::X,
            Self::Left => DVec3::NEG_X,
            Self::Bottom => DVec3::Y,
            Self::Top => DVec3::NEG_Y,
            Self::Back => DVec3::Z,
            Self::Front => DVec3::NEG_Z,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "Right",
            Self::Left => "Left",
            Self::Bottom => "Bottom",
            Self::Top => "Top",
            Self::Back => "Back",
            Self::Front => "Front",
        }
    }

    /// The axis as it is written: "+X".
    pub fn axis_name(self) -> &'static str {
        match self {
            Self::Right => "+X",
            Self::Left => "-X",
            Self::Bottom => "+Y",
            Self::Top => "-Y",
            Self::Back => "+Z",
            Self::Front => "-Z",
        }
    }

    fn yaw_and_pitch_rad(self) -> (f64, f64) {
        match self {
            Self::Right => (FRAC_PI_2, 0.0),
            Self::Left => (-FRAC_PI_2, 0.0),
            Self::Bottom => (0.0, -FRAC_PI_2),
            Self::Top => (0.0, FRAC_PI_2),
            Self::Back => (PI, 0.0),
            Self::Front => (0.0, 0.0),
        }
    }
}

impl Default for SceneView {
    fn default() -> Self {
        let place = Place { yaw_rad: START_YAW_RAD, pitch_rad: START_PITCH_RAD, eye_mm: DVec3::ZERO };
        Self {
            place,
            pivot_mm: DVec3::Z * 1000.0,
            viewport: DVec2::ONE,
            fitted: true,
            framed: None,
            animation: None,
        }
    }
}

impl Place {
    fn eye_from_camera_rotation(&self) -> DMat3 {
        DMat3::from_rotation_x(self.pitch_rad) * DMat3::from_rotation_y(self.yaw_rad)
    }

    fn eye_from_camera(&self) -> Pose {
        let rotation = self.eye_from_camera_rotation();
        Pose { rotation, translation_mm: -(rotation * self.eye_mm) }
    }

    fn forward(&self) -> DVec3 {
        self.eye_from_camera_rotation().transpose() * DVec3::Z
    }
}

impl SceneView {
    /// Tells the view how large its viewport is and what there is to see; called once a frame.
    pub fn set_scene(&mut self, viewport: DVec2, session: &Session) {
        self.viewport = viewport.max(DVec2::ONE);
        let photo = session.photo().map(|photo| photo.id);
        let object_count = photo.map_or(0, |photo| session.scene().objects_in(photo).count());
        let wanted = Framed { viewport: self.viewport, photo, object_count };
        if self.fitted && self.framed != Some(wanted) {
            self.animation = None;
            self.place = self.start_place(session);
        }
        self.framed = Some(wanted);
    }

    /// Goes on with an animation; says whether it has not ended.
    pub fn advance(&mut self, now_secs: f64) -> bool {
        let Some(animation) = &mut self.animation else { return false };
        let start_secs = *animation.start_secs.get_or_insert(now_secs);
        let part = ((now_secs - start_secs) / ANIMATION_SECS).clamp(0.0, 1.0);
        self.place = between(&animation.from, &animation.to, self.pivot_mm, part);
        if part >= 1.0 {
            self.animation = None;
        }
        part < 1.0
    }

    pub fn is_animating(&self) -> bool {
        self.animation.is_some()
    }

    /// The size of the viewport in physical pixels.
    pub fn viewport(&self) -> DVec2 {
        self.viewport
    }

    pub fn intrinsics(&self) -> Intrinsics {
        let [width, height] = self.viewport.to_array();
        let focal_px = self.focal_px();
        let (cx, cy) = ((width - 1.0) / 2.0, (height - 1.0) / 2.0);
        Intrinsics::pinhole(focal_px, focal_px, cx, cy, width.round() as u32, height.round() as u32)
    }

    pub fn eye_from_camera(&self) -> Pose {
        self.place.eye_from_camera()
    }

    /// Where the eye is, in the camera frame.
    pub fn position_mm(&self) -> DVec3 {
        self.place.eye_mm
    }

    pub fn pivot_mm(&self) -> DVec3 {
        self.pivot_mm
    }

    /// Back to the photographing camera's place, a little behind and above it, with everything in view.
    pub fn reset(&mut self, session: &Session) {
        self.pivot_mm = orbit_pivot_mm(session);
        self.go_to(self.start_place(session));
        self.fitted = true;
    }

    /// Looks along an axis at what it orbits, from as far away as it is.
    pub fn look_from(&mut self, view: StandardView, session: &Session) {
        self.pivot_mm = orbit_pivot_mm(session);
        let distance_mm = self.place.eye_mm.distance(self.pivot_mm).max(NEAREST_MM);
        let (yaw_rad, pitch_rad) = view.yaw_and_pitch_rad();
        let mut to = Place { yaw_rad, pitch_rad, eye_mm: DVec3::ZERO };
        to.eye_mm = self.pivot_mm - to.forward() * distance_mm;
        self.go_to(to);
    }

    /// Turns about what it orbits, which stays where it is seen.
    pub fn orbit(&mut self, way_px: DVec2) {
        self.taken_in_hand();
        let pivot_eye = self.place.eye_from_camera().transform_point(self.pivot_mm);
        let angle = way_px * (PI / self.viewport.min_element().max(200.0));
        self.place.yaw_rad -= angle.x;
        self.place.pitch_rad = (self.place.pitch_rad + angle.y).clamp(-FRAC_PI_2, FRAC_PI_2);
        self.place.eye_mm = self.pivot_mm - self.place.eye_from_camera_rotation().transpose() * pivot_eye;
    }

    /// Moves the scene by so many pixels at the pivot's depth.
    pub fn pan(&mut self, way_px: DVec2) {
        self.taken_in_hand();
        let way_eye = (way_px * (self.pivot_depth_mm() / self.focal_px())).extend(0.0);
        self.place.eye_mm -= self.place.eye_from_camera_rotation().transpose() * way_eye;
    }

    /// Chooses what is orbited; nothing moves by it.
    pub fn set_pivot(&mut self, pivot_mm: DVec3) {
        self.pivot_mm = pivot_mm;
    }

    fn zoom_to(&mut self, point_mm: DVec3, factor: f64) {
        self.taken_in_hand();
        let way = point_mm - self.place.eye_mm;
        let distance_mm = way.length().max(f64::MIN_POSITIVE);
        let wanted_mm = (distance_mm / factor).clamp(NEAREST_MM.min(distance_mm), FARTHEST_MM);
        self.place.eye_mm += way * (1.0 - wanted_mm / distance_mm);
    }

    fn taken_in_hand(&mut self) {
        self.fitted = false;
        self.animation = None;
    }

    fn go_to(&mut self, mut to: Place) {
        // The short way round.
        let turns = ((to.yaw_rad - self.place.yaw_rad) / TAU).round();
        to.yaw_rad -= turns * TAU;
        self.fitted = false;
        self.animation = Some(Animation { from: self.place, to, start_secs: None });
    }

    fn start_place(&self, session: &Session) -> Place {
        let place = Place { yaw_rad: START_YAW_RAD, pitch_rad: START_PITCH_RAD, eye_mm: self.place.eye_mm };
        self.fitted_to(place, &content_points(session))
    }

    /// The place from which the points just fill the viewport, with the same axes.
    fn fitted_to(&self, place: Place, points_mm: &[DVec3]) -> Place {
        let rotation = place.eye_from_camera_rotation();
        let tangents = self.viewport / 2.0 * FILLED / self.focal_px();
        // A point is within the left plane where x − e_x ≥ −t (z − e_z), in turned axes with the eye at e.
        let most = |value: &dyn Fn(DVec3) -> f64| {
            points_mm.iter().map(|point| value(rotation * *point)).fold(f64::NEG_INFINITY, f64::max)
        };
        let right = most(&|point| point.x - tangents.x * point.z);
        let left = most(&|point| -point.x - tangents.x * point.z);
        let down = most(&|point| point.y - tangents.y * point.z);
        let up = most(&|point| -point.y - tangents.y * point.z);
        let depth = (-(right + left) / (2.0 * tangents.x)).min(-(down + up) / (2.0 * tangents.y));
        // Nothing is nearer than a sixteenth of what is seen is deep.
        let (nearest, farthest) = (-most(&|point| -point.z), most(&|point| point.z));
        let room = ((farthest - nearest) / 16.0).max(NEAREST_MM);
        let depth = depth.min(nearest - room);
        let eye = DVec3::new((right - left) / 2.0, (down - up) / 2.0, depth);
        if eye.is_finite() { Place { eye_mm: rotation.transpose() * eye, ..place } } else { place }
    }

    fn focal_px(&self) -> f64 {
        self.viewport.y / 2.0 / (FIELD_OF_VIEW_RAD / 2.0).tan()
    }

    fn pivot_depth_mm(&self) -> f64 {
        self.place.eye_from_camera().transform_point(self.pivot_mm).z.max(NEAREST_MM)
    }
}

/// A place on the way from one to another, on an arc about the pivot.
fn between(from: &Place, to: &Place, pivot_mm: DVec3, part: f64) -> Place {
    if part >= 1.0 {
        return *to;
    }
    let eased = part * part * (3.0 - 2.0 * part);
    let mix = |from: f64, to: f64| from + (to - from) * eased;
    let mut place = Place {
        yaw_rad: mix(from.yaw_rad, to.yaw_rad),
        pitch_rad: mix(from.pitch_rad, to.pitch_rad),
        eye_mm: DVec3::ZERO,
    };
    let pivot_in = |place: &Place| place.eye_from_camera().transform_point(pivot_mm);
    let pivot_eye = pivot_in(from).lerp(pivot_in(to), eased);
    place.eye_mm = pivot_mm - place.eye_from_camera_rotation().transpose() * pivot_eye;
    place
}

impl Viewpoint for SceneView {
    fn eye(&self, session: &Session) -> Option<Eye> {
        session.photo()?;
        // Viewport pixels are counted from the corner of the first, image pixels from its centre.
        let origin_px = DVec2::splat(0.5);
        Some(Eye { camera: self.intrinsics(), eye_from_camera: self.eye_from_camera(), zoom: 1.0, origin_px })
    }

    fn is_photo(&self) -> bool {
        false
    }

    fn ground_drag_anywhere(&self, button: Button, modifiers: Modifiers) -> Option<GroundDrag> {
        let pans = button == Button::Middle || (button == Button::Left && modifiers.shift);
        pans.then_some(GroundDrag::Pan)
    }

    fn ground_drag(&self) -> GroundDrag {
        GroundDrag::Orbit
    }

    fn begin_ground_drag(&mut self, session: &Session) {
        self.set_pivot(orbit_pivot_mm(session));
    }

    fn drag_ground(&mut self, kind: GroundDrag, way_px: DVec2) {
        match kind {
            GroundDrag::Pan => self.pan(way_px),
            GroundDrag::Orbit => self.orbit(way_px),
        }
    }

    fn zoom_about(&mut self, position: DVec2, factor: f64, surface_camera_mm: Option<DVec3>) {
        let depth_mm = self.pivot_depth_mm();
        let point = surface_camera_mm.unwrap_or_else(|| {
            let point_eye = self.intrinsics().unproject(position - 0.5) * depth_mm;
            self.place.eye_from_camera().inverse().transform_point(point_eye)
        });
        self.zoom_to(point, factor);
    }

    fn show(&mut self, session: &Session, object: Option<ObjectId>) {
        let points = match object {
            Some(object) => object_points(session, object),
            None => content_points(session),
        };
        self.pivot_mm = orbit_pivot_mm(session);
        self.go_to(self.fitted_to(self.place, &points));
    }

    fn wipe_px(&self, _session: &Session) -> Option<f64> {
        None
    }

    fn width_px(&self) -> f64 {
        self.viewport.x
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn view() -> SceneView {
        let mut view = SceneView { viewport: DVec2::new(800.0, 600.0), ..SceneView::default() };
        view.place.eye_mm = DVec3::new(200.0, -150.0, -300.0);
        view
    }

    fn seen(view: &SceneView, point: DVec3) -> DVec2 {
        view.intrinsics().project(view.eye_from_camera().transform_point(point)).unwrap()
    }

    proptest! {
        #[test]
        fn orbiting_keeps_what_is_orbited_where_it_is_seen(dx in -300.0..300.0, dy in -300.0..300.0) {
            let mut view = view();
            view.set_pivot(DVec3::new(120.0, 40.0, 900.0));
            let before = seen(&view, view.pivot_mm());
            view.orbit(DVec2::new(dx, dy));
            prop_assert!(seen(&view, view.pivot_mm()).distance(before) < 1e-6);
            // The camera's x stays level.
            let up_eye = view.eye_from_camera().rotation * DVec3::NEG_Y;
            prop_assert!(up_eye.x.abs() < 1e-9 && up_eye.y <= 1e-9);
        }

        #[test]
        fn zooming_keeps_the_point_under_the_cursor(x in 0.0..800.0, y in 0.0..600.0, factor in 0.3..4.0_f64) {
            let mut view = view();
            let cursor = DVec2::new(x, y);
            let direction = view.intrinsics().unproject(cursor - 0.5);
            let point = view.eye_from_camera().inverse().transform_point(direction * 700.0);
            view.zoom_about(cursor, factor, Some(point));
            prop_assert!(seen(&view, point).distance(cursor - 0.5) < 1e-6);
        }

        #[test]
        fn what_is_fitted_is_in_view(
            points in prop::collection::vec((-500.0..500.0, -500.0..500.0, 0.0..2000.0), 2..20)
        ) {
            let points: Vec<DVec3> = points.into_iter().map(|(x, y, z)| DVec3::new(x, y, z)).collect();
            let mut view = view();
            view.place = view.fitted_to(view.place, &points);
            let half = view.viewport / 2.0;
            let mut farthest = 0.0_f64;
            for point in points {
                let offset = (seen(&view, point) + 0.5 - half).abs() / half;
                farthest = farthest.max(offset.max_element());
            }
            prop_assert!(farthest < FILLED + 1e-6, "{farthest}");
        }
    }

    #[test]
    fn panning_moves_the_pivot_with_the_hand() {
        let mut view = view();
        let before = seen(&view, view.pivot_mm());
        view.pan(DVec2::new(31.0, -17.0));
        assert!(seen(&view, view.pivot_mm()).distance(before + DVec2::new(31.0, -17.0)) < 1e-6);
    }

    #[test]
    fn a_standard_view_looks_along_its_axis_after_a_quarter_of_a_second() {
        let session = Session::default();
        for standard in StandardView::ALL {
            let mut view = view();
            view.look_from(standard, &session);
            assert!(view.advance(10.0) && view.advance(10.1));
            assert!(!view.advance(10.25) && !view.advance(11.0));
            assert!(view.place.forward().distance(-standard.axis()) < 1e-9, "{standard:?}");
            assert!(seen(&view, view.pivot_mm()).distance(DVec2::new(399.5, 299.5)) < 1e-6);
        }
    }
}
