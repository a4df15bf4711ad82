//! What foreign files of poses have in common: poses of named objects in named photos, one by one, with rotations that are
//! printed to a few digits.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};

use super::{
    CameraFile, FileKey, FormatError, Incoming, IncomingCamera, IncomingObject, IncomingPhoto, IncomingPose,
};
use crate::math::{Pose, PoseError};

/// A correction of a rotation by more than this, ‖RᵀR − I‖, is reported.
const REPORTED_DEFECT: f64 = 1e-3;
/// More of one object in one photo are left out: they are hypotheses, not instances.
const MOST_INSTANCES: usize = 64;
/// So many of what is left out is named, the rest counted.
const MOST_NAMED: usize = 3;

/// Makes an [`Incoming`] of poses in whatever order they come.
pub(super) struct Gather {
    incoming: Incoming,
    photos: BTreeMap<FileKey, usize>,
    /// By key and by which instance of it in a photo.
    objects: BTreeMap<(FileKey, usize), usize>,
    /// How many of an object a photo has so far.
    instances: BTreeMap<(usize, FileKey), usize>,
    corrections: Corrections,
    poses_read: usize,
    left_out: Vec<String>,
    left_out_count: usize,
}

/// Rotations that were off orthonormal.
#[derive(Debug, Default)]
struct Corrections {
    count: usize,
    worst: f64,
}

/// One pose as a file has it.
pub(super) struct Found<'a> {
    pub photo: usize,
    pub object: FileKey,
    /// Row by row.
    pub rotation: &'a [f64; 9],
    pub translation_mm: [f64; 3],
    pub score: Option<f64>,
}

impl Gather {
    pub fn new(file_name: &str) -> Self {
        Self {
            incoming: Incoming::new(file_name),
            photos: BTreeMap::new(),
            objects: BTreeMap::new(),
            instances: BTreeMap::new(),
            corrections: Corrections::default(),
            poses_read: 0,
            left_out: Vec::new(),
            left_out_count: 0,
        }
    }

    /// The photo of this name, made where it is new.
    pub fn photo(&mut self, key: FileKey) -> usize {
        if let Some(index) = self.photos.get(&key) {
            return *index;
        }
        let index = self.incoming.photos.len();
        self.incoming.photos.push(IncomingPhoto {
            key: key.clone(),
            camera: None,
            look: None,
            poses: Vec::new(),
        });
        self.photos.insert(key, index);
        index
    }

    pub fn camera(&mut self, photo: usize, camera: CameraFile) {
        if let Some(photo) = self.incoming.photos.get_mut(photo) {
            photo.camera = Some(IncomingCamera::File(camera));
        }
    }

    pub fn remark(&mut self, remark: String) {
        self.incoming.remarks.push(remark);
    }

    /// Takes a pose, and returns which of the objects it is of. One that is no pose is left out and named by its place.
    pub fn pose(&mut self, found: Found<'_>, place: impl FnOnce() -> String) -> Option<usize> {
        self.poses_read += 1;
        let (pose, defect) = match pose_of(found.rotation, found.translation_mm) {
            Ok(read) => read,
            Err(error) => {
                self.leave_out(|| format!("{}: {error}", place()));
                return None;
            }
        };
        let instance = self.instances.entry((found.photo, found.object.clone())).or_default();
        if *instance == MOST_INSTANCES {
            self.leave_out(|| format!("{}: more than {MOST_INSTANCES} of one object", place()));
            return None;
        }
        let slot = (found.object, *instance);
        *instance += 1;
        if defect > REPORTED_DEFECT {
            self.corrections.count += 1;
            self.corrections.worst = self.corrections.worst.max(defect);
        }
        let object = self.object(slot);
        let pose = IncomingPose::foreign(object, pose, found.score);
        self.incoming.photos.get_mut(found.photo)?.poses.push(pose);
        Some(object)
    }

    fn object(&mut self, slot: (FileKey, usize)) -> usize {
        if let Some(index) = self.objects.get(&slot) {
            return *index;
        }
        let index = self.incoming.objects.len();
        self.incoming.objects.push(IncomingObject::named(slot.0.clone()));
        self.objects.insert(slot, index);
        index
    }

    pub fn leave_out(&mut self, what: impl FnOnce() -> String) {
        self.left_out_count += 1;
        if self.left_out.len() < MOST_NAMED {
            self.left_out.push(what());
        }
    }

    /// What was read. A file in which everything is wrong is refused.
    pub fn finish(mut self) -> Result<Incoming, FormatError> {
        let is_of_use = |photo: &IncomingPhoto| photo.camera.is_some() || !photo.poses.is_empty();
        if let Some(first) = self.left_out.first()
            && !self.incoming.photos.iter().any(is_of_use)
        {
            return Err(FormatError::at("all entries", format!("none can be used; the first: {first}")));
        }
        let Corrections { count, worst } = self.corrections;
        if count > 0 {
            self.incoming.remarks.push(format!(
                "{count} of {} rotations were off orthonormal by up to {worst:.1e} and were corrected",
                self.poses_read
            ));
        }
        let unnamed = self.left_out_count - self.left_out.len();
        self.incoming.remarks.extend(self.left_out.into_iter().map(|what| format!("left out: {what}")));
        if unnamed > 0 {
            self.incoming.remarks.push(format!("left out: {unnamed} more"));
        }
        Ok(self.incoming)
    }
}

fn pose_of(rotation_rows: &[f64; 9], translation_mm: [f64; 3]) -> Result<(Pose, f64), PoseError> {
    let rotation = DMat3::from_cols_array(rotation_rows).transpose();
    Pose::from_parts(rotation, DVec3::from_array(translation_mm))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

    fn found(photo: usize, object: u32, rotation: &[f64; 9]) -> Found<'_> {
        Found {
            photo,
            object: FileKey::BopObject(object),
            rotation,
            translation_mm: [0.0, 0.0, 500.0],
            score: None,
        }
    }

    #[test]
    fn instances_of_one_object_are_objects_of_their_own() {
        let mut gather = Gather::new("scene_gt.json");
        for image in 0..2 {
            let photo = gather.photo(FileKey::BopImage { scene: None, image });
            let indices = [3, 3, 4].map(|object| gather.pose(found(photo, object, &TURN), String::new));
            assert_eq!(indices, [Some(0), Some(1), Some(2)]);
        }
        assert_eq!(gather.finish().unwrap().pose_count(), 6);
    }

    #[test]
    fn bad_rotations_are_counted_and_named() {
        let mut off = TURN;
        off[0] = 1.01;
        let mut mirrored = TURN;
        mirrored[0] = -1.0;
        let mut gather = Gather::new("scene_gt.json");
        let photo = gather.photo(FileKey::BopImage { scene: None, image: 1 });
        for (index, rotation) in [TURN, off, mirrored, mirrored, mirrored, mirrored].iter().enumerate() {
            gather.pose(found(photo, 1, rotation), || format!("pose {index}"));
        }
        let remarks = gather.finish().unwrap().remarks.join("\n");
        assert!(remarks.contains("1 of 6 rotations were off orthonormal by up to 2.0e-2"), "{remarks}");
        assert!(remarks.contains("left out: pose 2: the rotation is singular or mirrored"), "{remarks}");
        assert!(remarks.contains("left out: 1 more"), "{remarks}");

        let mut gather = Gather::new("scene_gt.json");
        gather.photo(FileKey::BopImage { scene: None, image: 1 });
        gather.pose(found(0, 1, &mirrored), || "pose 0".to_owned());
        assert!(gather.finish().unwrap_err().to_string().contains("pose 0"));
    }
}
