//! Snap: the selected object's pose refined to the photo, a slice a frame.

mod batch;

use std::sync::Arc;

use glam::DAffine3;

use super::PinPose;
use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::photo::Pixels;
use crate::platform;
use crate::raster::Mask;
use crate::scene::{Annotation, DepthInMm, Object, ObjectId, PhotoAsset, PhotoId, Sha256};
use crate::session::{Command, Notice};
use crate::solve::contour::ContourModel;
use crate::solve::snap::{Progress, Snap, SnapHints, SnapOptions, SnapOutcome, SnapReach, SnapVerdict};
use crate::ui::Busy;
use batch::Batch;

/// Of each frame, for the solver.
const SLICE_MS: f64 = 8.0;
/// The picture goes from the pose before to the one after in this time.
const ANIMATION_S: f64 = 0.25;

#[derive(Default)]
pub struct Snapping {
    /// Meshes for the solvers, as they are in their files.
    meshes: Vec<(Sha256, Option<Arc<Mesh>>)>,
    /// Meshes that are being made.
    wanted: Vec<Sha256>,
    /// Waits for meshes and pixels.
    asked: Option<Asked>,
    running: Option<(Asked, Box<Snap>, f64)>,
    /// What goes on once this one is done.
    batch: Option<Batch>,
    /// A photo or mask that was sent for.
    wanted_picture: Option<Sha256>,
    /// Photo and mask that have come: the cache may not have room for both until the other is there.
    held: Vec<(Sha256, Arc<Pixels>)>,
    animation: Option<Animation>,
}

/// Whose pose is to be refined, from where, and as which camera sees it.
#[derive(Debug, Clone, Copy)]
struct Asked {
    photo: PhotoId,
    object: ObjectId,
    start: Pose,
    camera: Intrinsics,
    reach: SnapReach,
}

/// The way from one pose to another, seen.
#[derive(Debug, Clone, Copy)]
struct Animation {
    photo: PhotoId,
    object: ObjectId,
    from: Pose,
    to: Pose,
    began_s: f64,
}

impl Snapping {
    pub fn is_busy(&self) -> bool {
        self.asked.is_some() || self.running.is_some() || self.batch.is_some()
    }

    pub fn busy(&self) -> Option<Busy> {
        if let Some(batch) = &self.batch {
            return Some(Busy { text: batch.text(), can_cancel: true });
        }
        let text = match (&self.asked, &self.running) {
            (Some(_), _) => "Preparing to snap…".to_owned(),
            (None, Some((_, _, part))) => format!("Snapping… {:.0} %", part * 100.0),
            (None, None) => return None,
        };
        Some(Busy { text, can_cancel: true })
    }

    /// Stops what is under way; false if nothing is.
    pub fn cancel(&mut self) -> bool {
        self.wanted_picture = None;
        self.held.clear();
        self.asked.take().is_some() | self.running.take().is_some() | self.batch.take().is_some()
    }

    /// Where an object is drawn while it is on its way to its new pose.
    pub fn drawn_pose(&self, now_s: f64) -> Option<(PhotoId, ObjectId, Pose)> {
        let Animation { photo, object, from, to, began_s } = self.animation?;
        let part = ((now_s - began_s) / ANIMATION_S).clamp(0.0, 1.0);
        let eased = part * part * (3.0 - 2.0 * part);
        Some((photo, object, from.towards(&to, eased)))
    }
}

impl PinPose {
    /// What the solver does is stopped before what the hand has done is taken back, but for what it is just doing.
    pub(super) fn stop_snap_first(&mut self) -> bool {
        let is_hand_at_work = self.session.gesture_under_way() || self.session.half_pin().is_some();
        !is_hand_at_work && self.cancel_snap()
    }

    pub(super) fn start_snap(&mut self, photo: PhotoId, object: ObjectId, reach: SnapReach) {
        self.cancel_snap();
        self.snapping.asked = self.asked_of(photo, object, reach);
        self.ctx.request_repaint();
    }

    /// `None` where the object is not in the photo.
    fn asked_of(&self, photo: PhotoId, object: ObjectId, reach: SnapReach) -> Option<Asked> {
        let scene = self.session.scene();
        let start = scene.annotation(photo, object)?.camera_from_object;
        Some(Asked { photo, object, start, camera: scene.photo(photo)?.camera, reach })
    }

    /// Is all still as it was when this was asked? Somebody may have gone on by hand.
    fn still_stands(&self, asked: &Asked) -> bool {
        let present = self.asked_of(asked.photo, asked.object, asked.reach);
        present.is_some_and(|present| (present.start, present.camera) == (asked.start, asked.camera))
            && self.session.check_movable((asked.photo, asked.object)).is_ok()
    }

    /// Once a frame: what is missing is sent for; then the solver works for its slice.
    pub(super) fn tick_snap(&mut self) {
        for (sha256, mesh) in self.loading.take_solver_meshes() {
            self.snapping.wanted.retain(|wanted| *wanted != sha256);
            self.snapping.meshes.push((sha256, mesh));
        }
        // What ends now would end what the hand is doing.
        if !self.session.gesture_under_way() {
            self.go_on_snapping();
        }
        let now_s = self.ctx.input(|input| input.time);
        if let Some(animation) = &self.snapping.animation {
            if now_s - animation.began_s < ANIMATION_S {
                self.ctx.request_repaint();
            } else {
                self.snapping.animation = None;
            }
        }
    }

    fn go_on_snapping(&mut self) {
        if self.snapping.asked.is_none() && self.snapping.running.is_none() {
            self.go_on_with_batch();
        }
        if let Some(asked) = self.snapping.asked {
            self.prepare_snap(asked);
        }
        if let Some((asked, mut snap, _)) = self.snapping.running.take() {
            let until_ms = platform::now_ms() + SLICE_MS;
            match snap.step(&mut || platform::now_ms() < until_ms) {
                Progress::Working(part) => self.snapping.running = Some((asked, snap, part)),
                Progress::Done(outcome) => self.finish_snap(asked, &outcome),
            }
            self.ctx.request_repaint();
        }
    }

    /// Begins once photo, mask, depth map and meshes are there.
    fn prepare_snap(&mut self, asked: Asked) {
        let scene = self.session.scene();
        let is_there = scene.annotation(asked.photo, asked.object).is_some();
        let Some(photo) = scene.photo(asked.photo).filter(|_| is_there).map(|photo| photo.asset.clone())
        else {
            self.snapping.asked = None;
            self.snapping.held.clear();
            return;
        };
        let mask = scene.masks_of(asked.photo).find(|mask| mask.object == Some(asked.object));
        let mask = mask.map(|mask| mask.asset.clone());
        let here: Vec<ObjectId> = scene.objects_in(asked.photo).map(|(object, _)| object.id).collect();
        // All that are missing are sent for at once. Until they are there this comes round every frame, so nothing is built.
        let missing = here.iter().filter(|object| !self.has_solver_mesh(**object)).count();
        let Some(pixels) = self.picture_for_snap(&photo) else { return };
        let mask = match mask.map(|mask| self.picture_for_snap(&mask)) {
            Some(None) => return,
            Some(Some(mask)) => mask,
            None => None,
        };
        if missing > 0 || self.waits_for_depth(asked.photo) {
            return;
        }
        (self.snapping.asked, self.snapping.wanted_picture) = (None, None);
        self.snapping.held.clear();
        match pixels {
            Some(pixels) => self.begin_snap(asked, &pixels, mask.as_deref()),
            None => self.leave_out("The photo cannot be decoded"),
        }
    }

    fn begin_snap(&mut self, asked: Asked, pixels: &Pixels, mask: Option<&Pixels>) {
        let depth = self.depth_for_snap(asked.photo);
        let scene = self.session.scene();
        let annotation = scene.annotation(asked.photo, asked.object);
        let Some(annotation) = annotation else { return };
        let Some(model) = self.contour_model(asked.object) else {
            return self.leave_out("This mesh has no surface to snap to the photo");
        };
        let batch = self.snapping.batch.as_ref();
        let others = scene.placed_beside(asked.photo, asked.object);
        let occluder = |(other, annotation): (&Object, &Annotation)| {
            let moved = batch.and_then(|batch| batch.moved_to(asked.photo, other.id));
            Some((self.contour_model(other.id)?, moved.unwrap_or(annotation.camera_from_object)))
        };
        let hints = SnapHints {
            pins: annotation.pins.clone(),
            occluders: others.filter_map(occluder).collect(),
            depth,
        };
        let options = SnapOptions { reach: asked.reach, mask: mask.map(Mask::of_picture) };
        let snap = Snap::with(pixels, &asked.camera, model, &asked.start, hints, &options);
        self.snapping.running = Some((asked, Box::new(snap), 0.0));
    }

    /// A photo's or a mask's pixels; `None` while they are on their way, `Some(None)` where they do not come.
    fn picture_for_snap(&mut self, asset: &PhotoAsset) -> Option<Option<Arc<Pixels>>> {
        let held = self.snapping.held.iter().find(|(held, _)| *held == asset.sha256);
        if let Some((_, pixels)) = held {
            return Some(Some(pixels.clone()));
        }
        if let Some(pixels) = self.photos.get(asset.sha256) {
            self.snapping.held.push((asset.sha256, pixels.clone()));
            return Some(Some(pixels));
        }
        if self.snapping.wanted_picture != Some(asset.sha256) {
            self.snapping.wanted_picture = Some(asset.sha256);
            // It may be on its way to the screen.
            if self.photos.wanted != Some(asset.sha256) {
                self.loading.decode(asset);
            }
            return None;
        }
        // What has come was taken before this is asked.
        self.loading.is_worker_idle().then_some(None)
    }

    /// The photo's depth map, where it hides what is behind it.
    pub(super) fn depth_for_snap(&mut self, photo: PhotoId) -> Option<Arc<DepthInMm>> {
        let pixels = self.depth_of(photo)?;
        let mm_per_unit = self.session.scene().photo(photo)?.depth.as_ref()?.mm_per_unit;
        let mm = pixels.raw.iter().map(|&raw| (f64::from(raw) * mm_per_unit) as f32).collect();
        Some(Arc::new(DepthInMm { width: pixels.width, height: pixels.height, mm }))
    }

    /// A pose that cannot be snapped: in a batch it is counted, else it is said why.
    fn leave_out(&mut self, why: &str) {
        match &mut self.snapping.batch {
            Some(batch) => batch.leave(),
            None => self.notify(Notice::error(why)),
        }
    }

    /// Is what the solvers look at there, or known not to come? If not, it is sent for.
    pub(super) fn has_solver_mesh(&mut self, object: ObjectId) -> bool {
        let Some(object) = self.session.scene().object(object) else { return true };
        let sha256 = object.mesh.sha256;
        if self.snapping.meshes.iter().any(|(known, _)| *known == sha256) {
            return true;
        }
        if !self.snapping.wanted.contains(&sha256) {
            self.snapping.wanted.push(sha256);
            self.loading.prepare_for_solvers(&object.mesh);
        }
        false
    }

    /// `None` for a mesh without a surface.
    pub(super) fn contour_model(&self, object: ObjectId) -> Option<Arc<ContourModel>> {
        let object = self.session.scene().object(object)?;
        let (_, mesh) = self.snapping.meshes.iter().find(|(known, _)| *known == object.mesh.sha256)?;
        let transform = DAffine3::from_mat4(object.mesh_from_file);
        let framed = mesh.as_ref()?.transformed(&transform).ok()?;
        ContourModel::new(&framed).map(Arc::new)
    }

    fn finish_snap(&mut self, asked: Asked, outcome: &SnapOutcome) {
        if let Some(batch) = &mut self.snapping.batch {
            batch.take(asked, outcome);
            return;
        }
        let Asked { photo, object, start, .. } = asked;
        if !self.still_stands(&asked) {
            return;
        }
        let covariance = outcome.covariance.map(Box::new);
        if outcome.verdict != SnapVerdict::Improved {
            if covariance.is_some() {
                self.apply(Command::NoteSnap { photo, object, covariance });
            }
            self.notify(Notice::warning(outcome.verdict.to_string()));
            return;
        }
        let camera_from_object = outcome.camera_from_object;
        let taken = self.try_apply(Command::TakeSnap { photo, object, camera_from_object, covariance });
        if let Err(error) = taken {
            self.notify(Notice::warning(error));
            return;
        }
        let began_s = self.ctx.input(|input| input.time);
        self.snapping.animation =
            Some(Animation { photo, object, from: start, to: camera_from_object, began_s });
        self.notify(Notice::info(format!(
            "Snapped: turned {:.1}°, moved {:.1} mm; fit {:.0} % to {:.0} %. Esc takes it back",
            outcome.turned_rad.to_degrees(),
            outcome.moved_mm,
            100.0 * outcome.score_before,
            100.0 * outcome.score_after
        )));
    }
}
