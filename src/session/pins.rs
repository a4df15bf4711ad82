//! Pins: set, dragged, switched off, taken along; the pose follows them.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::apply::Applied;
use super::{CommandError, Effect, LogEntry, Notice, PinChange, Session};
use crate::formats::export::safe_file_name;
use crate::formats::write_pins;
use crate::math::Pose;
use crate::scene::{
    Annotation, AnnotationState, CameraOrigin, ObjectId, PhotoId, Pin, PoseSource, file_stem,
};
use crate::solve::TwistCovariance;
use crate::solve::pins::{PinAdvice, PinOptions, PinPose, PinSolution, leave_open, solve_focal, solve_pins};
use crate::solve::snap::SnapReach;

/// A pose's place: one object in one photo.
type Target = (PhotoId, ObjectId);

/// One half of a pin, while the other is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HalfPin {
    /// A place in the shown photo, in its `image` frame.
    Pixel(DVec2),
    /// A point of an object, in its frame, in millimetres.
    Point(ObjectId, DVec3),
}

/// What there is to say of a pose's pins.
#[derive(Debug, Clone, PartialEq)]
pub struct PinReport {
    /// For each pin: where the present pose has its point, less where it belongs. `None` behind the camera.
    pub residuals_px: Vec<Option<DVec2>>,
    /// Of the pins that pull, for the present pose.
    pub rms_px: f64,
    /// Numbers of pins that the others contradict.
    pub misclicks: Vec<usize>,
    pub advice: Vec<PinAdvice>,
    /// Other poses that fit the pins as well as theirs does.
    pub alternatives: Vec<PinPose>,
    /// Of the pose from the pins, at the focal length as it is; `None` where they leave it open.
    pub covariance: Option<TwistCovariance>,
    /// The present pose is the one that the pins give.
    pub is_solved: bool,
}

/// The report of a scene as it was at one revision.
#[derive(Debug, Default)]
pub(super) struct ReportCache(RefCell<Option<Cached>>);

/// The revision, whose pins they are, and the report.
type Cached = (u64, Target, Option<Rc<PinReport>>);

/// A pose this near to the pins' own is theirs: what rounding and the solver's last step leave.
const SAME_POSE_RAD: f64 = 1e-5;
const SAME_POSE_MM: f64 = 1e-2;

impl Session {
    /// What there is to say of the selected pose's pins; `None` without pins.
    pub fn pin_report(&self) -> Option<Rc<PinReport>> {
        let (photo, object, annotation) = self.selected_annotation()?;
        let key = (self.revision, (photo, object));
        if let Some((revision, target, report)) = &*self.pin_report.0.borrow()
            && (*revision, *target) == key
        {
            return report.clone();
        }
        let report = self.new_report(key.1, annotation).map(Rc::new);
        *self.pin_report.0.borrow_mut() = Some((key.0, key.1, report.clone()));
        report
    }

    fn new_report(&self, target: Target, annotation: &Annotation) -> Option<PinReport> {
        let camera = self.scene.photo(target.0)?.camera;
        let (pins, pose) = (&annotation.pins, &annotation.camera_from_object);
        if pins.is_empty() {
            return None;
        }
        let residual = |pin: &Pin| Some(camera.project(pose.transform_point(pin.point_mm))? - pin.pixel);
        let residuals_px: Vec<Option<DVec2>> = pins.iter().map(residual).collect();
        let solution = self.solution(target, pins, pose).ok();
        let misclicks = solution.as_ref().map_or_else(Vec::new, |solution| solution.misclicks.clone());
        let pulls = |number: usize, pin: &Pin| pin.counts() && !misclicks.contains(&number);
        let pulling =
            pins.iter().enumerate().zip(&residuals_px).filter(|((number, pin), _)| pulls(*number, pin));
        let squares: Vec<f64> = pulling.filter_map(|(_, r)| Some((*r)?.length_squared())).collect();
        Some(PinReport {
            rms_px: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            residuals_px,
            is_solved: solution.as_ref().is_some_and(|solution| is_same(&solution.camera_from_object, pose)),
            covariance: solution.as_ref().and_then(|solution| solution.covariance),
            misclicks,
            advice: solution.as_ref().map_or_else(Vec::new, |solution| solution.advice.clone()),
            alternatives: solution.map_or_else(Vec::new, |solution| solution.alternatives),
        })
    }

    fn solution(&self, target: Target, pins: &[Pin], start: &Pose) -> Result<PinSolution, CommandError> {
        let camera = self.scene.photo(target.0).ok_or(CommandError::NoPhoto(target.0))?.camera;
        let mesh = &self.scene.object(target.1).ok_or(CommandError::NoObject(target.1))?.mesh.mesh;
        let object_diameter_mm = Some(2.0 * mesh.sphere().radius).filter(|diameter| *diameter > 0.0);
        let options = PinOptions { object_diameter_mm, ..PinOptions::default() };
        solve_pins(&camera, pins, Some(start), &options)
            .map_err(|error| CommandError::Failed(format!("The pins give no pose: {error}")))
    }

    /// What an object turns about, and keeps on its pixel when its depth changes: its one pinned point, else its centre. In
    /// the `object` frame.
    pub fn pivot_mm(&self, photo: PhotoId, object: ObjectId) -> Option<DVec3> {
        let center = self.scene.object(object)?.mesh.mesh.sphere().center;
        let mut pulling = self.scene.annotation(photo, object)?.pins.iter().filter(|pin| pin.counts());
        match (pulling.next(), pulling.next()) {
            (Some(pin), None) => Some(pin.point_mm),
            _ => Some(center),
        }
    }

    pub(super) fn add_pin(&mut self, target: Target, pin: Pin) -> Applied {
        self.check_movable(target)?;
        checked(&pin)?;
        if self.gesture.is_some() {
            self.pins_mut(target)?.push(pin);
            self.touched();
            return Ok(Vec::new());
        }
        self.change("Add pin", |scene| {
            if let Some(annotation) = scene.annotations.get_mut(&target) {
                annotation.pins.push(pin);
            }
        })
    }

    pub(super) fn complete_pin(&mut self, target: Target, pin: Pin, now_ms: f64) -> Applied {
        self.half_pin = None;
        self.check_movable(target)?;
        checked(&pin)?;
        let mut pins = self.pins_of(target);
        pins.push(pin);
        self.set_pins("Add pin", target, pins, now_ms)
    }

    pub(super) fn drag_pin(&mut self, target: Target, pin: usize, pixel: DVec2, now_ms: f64) -> Applied {
        self.check_movable(target)?;
        let pins = self.pins_mut(target)?;
        let missing = || CommandError::Failed(format!("there is no pin {}", pin + 1));
        let dragged = pins.get_mut(pin).ok_or_else(missing)?;
        let moved = Pin { pixel, ..*dragged };
        checked(&moved)?;
        *dragged = moved;
        let pins = pins.clone();
        // What one or two pins leave open, or any on a line, is kept as it was when the gesture began, so that a way there and
        // back ends where it started. Other pins go on from the last pose, lest they jump to another that fits as well.
        let before = self.gesture.as_ref().filter(|_| leave_open(&pins)).map(|gesture| &gesture.before.scene);
        let start = before.unwrap_or(&self.scene).annotation(target.0, target.1);
        let Some(start) = start.map(|annotation| annotation.camera_from_object) else {
            return Ok(Vec::new());
        };
        // A pin on its way may be where no pose can follow; it goes on without one.
        if let Ok(solution) = self.solution(target, &pins, &start) {
            let origin = self.gesture.as_ref().map_or(&self.scene, |gesture| &gesture.before.scene);
            let poses = self.with_followers(origin, target, solution.camera_from_object);
            self.write_poses(poses, PoseSource::Pins, now_ms);
        }
        self.touched();
        Ok(Vec::new())
    }

    pub(super) fn edit_pins(&mut self, change: PinChange, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else {
            return Err(CommandError::NotAvailable("Change pins", "no object of this photo is selected"));
        };
        let mut pins = annotation.pins.clone();
        self.check_movable((photo, object))?;
        let label = match change {
            PinChange::Enabled(pin, enabled) => {
                if let Some(pin) = pins.get_mut(pin) {
                    pin.enabled = enabled;
                }
                if enabled { "Switch pin on" } else { "Switch pin off" }
            }
            PinChange::Remove(pin) => {
                if pin < pins.len() {
                    pins.remove(pin);
                }
                "Remove pin"
            }
            PinChange::Replace(new) => {
                new.iter().try_for_each(checked)?;
                pins = new;
                "Set pins"
            }
        };
        self.set_pins(label, (photo, object), pins, now_ms)
    }

    pub(super) fn solve_selected(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let pins = annotation.pins.clone();
        self.check_movable((photo, object))?;
        self.solution((photo, object), &pins, &annotation.camera_from_object)?;
        self.set_pins("Pose from pins", (photo, object), pins, now_ms)
    }

    /// The focal length that fits the pins best, and the pose with it, as one step.
    pub(super) fn focal_from_pins(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let pins = annotation.pins.clone();
        self.check_movable((photo, object))?;
        let camera = self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?.camera;
        let found = solve_focal(&camera, &pins, &PinOptions::default())
            .map_err(|error| CommandError::Failed(format!("The pins give no focal length: {error}")))?;
        let before = self.snapshot();
        let origin = CameraOrigin::Pins { relative_sigma: found.relative_sigma };
        self.scene.set_camera(photo, found.camera, origin);
        self.write_poses(vec![((photo, object), found.camera_from_object)], PoseSource::Pins, now_ms);
        self.record_changes(&before.scene, "Focal length from pins");
        self.history.push("Focal length from pins", before);
        Ok(vec![Effect::Notify(Notice::info(format!(
            "fx = {:.0} px, ± {:.1} %; the distance is as unsure as that",
            found.camera.fx,
            100.0 * found.relative_sigma
        )))])
    }

    pub(super) fn ask_snap(&self, reach: SnapReach) -> Applied {
        let Some((photo, object, _)) = self.selected_annotation() else { return Ok(Vec::new()) };
        self.check_movable((photo, object))?;
        Ok(vec![Effect::Snap { photo, object, reach }])
    }

    pub(super) fn ask_snap_all(&self) -> Applied {
        Ok(vec![Effect::SnapAll(self.snappable())])
    }

    /// Posed or carried over, and neither locked nor confirmed, photo by photo.
    pub(super) fn snappable(&self) -> Vec<Target> {
        let scene = &self.scene;
        let all = scene.photos.iter().flat_map(|photo| {
            scene.objects_in(photo.id).map(|(object, annotation)| ((photo.id, object.id), annotation))
        });
        all.filter(|(_, annotation)| {
            matches!(annotation.state, AnnotationState::Posed | AnnotationState::Carried)
        })
        .map(|(target, _)| target)
        .filter(|target| self.check_movable(*target).is_ok())
        .collect()
    }

    /// What is linked to the object goes along; what is only selected with it has its own place in the photo.
    pub(super) fn take_snap(
        &mut self,
        target: Target,
        camera_from_object: Pose,
        covariance: Option<TwistCovariance>,
        now_ms: f64,
    ) -> Applied {
        self.check_settable(target)?;
        let poses = self.with_linked(target, camera_from_object);
        let effects = self.change_poses("Snap", poses, PoseSource::Snap, now_ms)?;
        self.note_snap(target, covariance);
        self.snapped = self.history.newest().map(|step| (target, step));
        Ok(effects)
    }

    pub(super) fn take_snaps(
        &mut self,
        mut snaps: Vec<(Target, Pose, Option<TwistCovariance>)>,
        (summary, least_sure): (Arc<str>, Target),
        now_ms: f64,
    ) -> Applied {
        snaps.retain(|(target, ..)| self.check_movable(*target).is_ok());
        if snaps.is_empty() {
            return Ok(Vec::new());
        }
        let poses = snaps.iter().map(|(target, pose, _)| (*target, *pose)).collect();
        let label = "Snap on all photos";
        let effects = self.change_poses(label, poses, PoseSource::Snap, now_ms)?;
        // After the lines of the poses, so that it is the first to be read.
        if let Some(entry) = self.log_entry(least_sure, label) {
            self.log.push(LogEntry { summary: Some(summary), ..entry });
        }
        snaps.into_iter().for_each(|(target, _, covariance)| self.note_snap(target, covariance));
        Ok(effects)
    }

    pub(super) fn clear_pins(&mut self) -> Applied {
        let Some((photo, object, _)) = self.selected_annotation() else { return Ok(Vec::new()) };
        self.check_movable((photo, object))?;
        self.change("Remove all pins", |scene| {
            if let Some(annotation) = scene.annotations.get_mut(&(photo, object)) {
                annotation.pins.clear();
            }
        })
    }

    /// The same points in the next photo, where its pose has them, and shows it. A point that is pinned there already stays
    /// where it was put. Where the object is not there yet, it comes with this photo's pose.
    pub(super) fn copy_pins_to_next(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let position = self.scene.photos.iter().position(|candidate| candidate.id == photo);
        let next = position.and_then(|position| self.scene.photos.get(position + 1));
        let Some((next, camera)) = next.map(|next| (next.id, next.camera)) else { return Ok(Vec::new()) };
        let source = annotation.clone();
        self.check_settable((next, object))?;
        self.change("Pins to next photo", |scene| {
            let there = scene.annotations.entry((next, object)).or_insert_with(|| Annotation {
                state: AnnotationState::Carried,
                changed_at_ms: now_ms,
                camera_changed: false,
                score: None,
                pins: Vec::new(),
                ..source.clone()
            });
            if there.state == AnnotationState::Untouched {
                there.camera_from_object = source.camera_from_object;
                there.state = AnnotationState::Carried;
                there.source = source.source;
                there.changed_at_ms = now_ms;
            }
            let seen = |pin: &Pin| {
                let point = there.camera_from_object.transform_point(pin.point_mm);
                Pin { pixel: camera.project(point).unwrap_or(pin.pixel), ..*pin }
            };
            let is_new = |pin: &&Pin| there.pins.iter().all(|known| known.point_mm != pin.point_mm);
            let new: Vec<Pin> = source.pins.iter().filter(is_new).map(seen).collect();
            there.pins.extend(new);
        })?;
        self.show_photo(next)?;
        self.select(Some(object))
    }

    pub(super) fn export_pins(&self) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let photo = self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        let object = self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        let text = write_pins(&photo.camera, &annotation.camera_from_object, &annotation.pins);
        let stem = format!("{}-{}", safe_file_name(file_stem(&photo.name)), safe_file_name(&object.name));
        let file_name = format!("{stem}-pins.json");
        let notice = Notice::info(format!("{file_name}: {} pins saved", annotation.pins.len()));
        Ok(vec![Effect::Download { file_name, bytes: Arc::from(text.into_bytes()) }, Effect::Notify(notice)])
    }

    /// Other pins, and the pose that they give. Where they give none, the pose stays.
    fn set_pins(&mut self, label: &'static str, target: Target, pins: Vec<Pin>, now_ms: f64) -> Applied {
        self.finish_gesture();
        let before = self.snapshot();
        let start =
            before.scene.annotation(target.0, target.1).map(|annotation| annotation.camera_from_object);
        *self.pins_mut(target)? = pins.clone();
        let pulls = pins.iter().any(Pin::counts);
        let solution = start.filter(|_| pulls).and_then(|start| self.solution(target, &pins, &start).ok());
        if let Some(solution) = solution {
            let poses = self.with_followers(&before.scene, target, solution.camera_from_object);
            self.write_poses(poses, PoseSource::Pins, now_ms);
            self.record_changes(&before.scene, label);
        }
        if self.scene != before.scene {
            self.history.push(label, before);
            self.touched();
        }
        Ok(Vec::new())
    }

    fn pins_of(&self, (photo, object): Target) -> Vec<Pin> {
        self.scene.annotation(photo, object).map_or_else(Vec::new, |annotation| annotation.pins.clone())
    }

    fn pins_mut(&mut self, target: Target) -> Result<&mut Vec<Pin>, CommandError> {
        let missing = self.not_in_photo(target.1);
        self.scene.annotations.get_mut(&target).map(|annotation| &mut annotation.pins).ok_or(missing)
    }
}

fn checked(pin: &Pin) -> Result<(), CommandError> {
    let is_good = pin.point_mm.is_finite() && pin.pixel.is_finite() && pin.weight >= 0.0;
    is_good.then_some(()).ok_or_else(|| CommandError::Failed("a pin needs finite numbers".to_owned()))
}

/// Are two poses one, but for where a solver stopped?
pub(super) fn is_same(a: &Pose, b: &Pose) -> bool {
    a.angle_to(b) < SAME_POSE_RAD && a.translation_mm.distance(b.translation_mm) < SAME_POSE_MM
}
