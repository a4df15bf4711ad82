//! Between the live scene and the document, both ways.

use glam::{DMat4, DVec2, DVec3};

use super::{
    CameraOriginEntry, ContinuousSymmetryEntry, Conventions, DepthEntry, Document, ExifSensorEntry,
    MaskEntry, ObjectEntry, PhotoEntry, PinEntry, PoseEntry, ReferenceEntry, ReferencePoseEntry, SourceEntry,
    StateEntry, SymmetriesEntry, VERSION, ViewSettings,
};
use crate::formats::incoming::{IncomingReference, ObjectLook, PhotoLook};
use crate::formats::{
    FileKey, FormatError, Incoming, IncomingCamera, IncomingObject, IncomingPhoto, IncomingPose,
};
use crate::math::{Distortion, Intrinsics, Pose};
use crate::photo::ExifFocalSource;
use crate::scene::{
    Annotation, AnnotationState, CameraOrigin, ContinuousSymmetry, DepthMap, Mask, MeshFrame, Object, Photo,
    Pin, PoseSource, Rgb, Scene, Sha256, Symmetries,
};

/// Which poses a document holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// All: a saved state.
    Everything,
    /// Only those that somebody stands for: an untouched or carried pose is no annotation.
    Annotated,
}

impl Document {
    pub fn from_scene(scene: &Scene, view: &ViewSettings, keep: Keep) -> Self {
        Self {
            format: "pinpose".to_owned(),
            version: VERSION,
            generator: concat!("PinPose ", env!("CARGO_PKG_VERSION")).to_owned(),
            conventions: Conventions {
                pose: "camera_from_object: X_camera = R X_object + t".to_owned(),
                camera_axes: "OpenCV: x right, y down, z forward".to_owned(),
                length_unit: "mm".to_owned(),
                matrix_order: "row-major".to_owned(),
                pixel_origin: "(0, 0) is the centre of the top-left pixel".to_owned(),
                time: "milliseconds since 1970-01-01T00:00:00Z".to_owned(),
            },
            name: scene.name.clone(),
            photos: scene.photos.iter().map(|photo| photo_entry(scene, photo, keep)).collect(),
            objects: scene.objects.iter().map(object_entry).collect(),
            references: scene.references.iter().map(reference_entry).collect(),
            view: view.clone(),
        }
    }

    /// The content of each photo, in order; `None` where the document's hash is not one.
    pub fn photo_hashes(&self) -> impl Iterator<Item = Option<Sha256>> {
        self.photos.iter().map(|photo| photo.sha256.parse().ok())
    }

    /// The content of each object's mesh, in order; the same mesh may come several times.
    pub fn mesh_hashes(&self) -> impl Iterator<Item = Option<Sha256>> {
        self.objects.iter().map(|object| object.mesh_sha256.parse().ok())
    }

    /// Name and content of every file that the document speaks of, some more than once.
    pub fn files(&self) -> impl Iterator<Item = (&str, Option<Sha256>)> {
        let images = self.photos.iter().flat_map(|photo| {
            let depth = photo.depth.iter().map(|depth| (&depth.file, &depth.sha256));
            let masks = photo.masks.iter().map(|mask| (&mask.file, &mask.sha256));
            std::iter::once((&photo.file, &photo.sha256)).chain(depth).chain(masks)
        });
        let meshes = self.objects.iter().map(|object| (&object.mesh_file, &object.mesh_sha256));
        images.chain(meshes).map(|(name, sha256)| (name.as_str(), sha256.parse().ok()))
    }

    pub fn pose_count(&self) -> usize {
        self.photos.iter().map(|photo| photo.poses.len()).sum()
    }

    /// The masks, to be found again by their content among the images that came with the document.
    pub fn masks(&self) -> Vec<SavedMask> {
        let of_photo = |(photo, entry): (usize, &PhotoEntry)| -> Vec<SavedMask> {
            let position = |id: u32| self.objects.iter().position(|object| object.id == id);
            let read = |mask: &MaskEntry| {
                Some(SavedMask {
                    photo,
                    object: mask.object.and_then(position),
                    sha256: mask.sha256.parse().ok()?,
                    name: mask.name.clone(),
                    color: read_color(&mask.color, "mask").ok()?,
                    opacity: mask.opacity.clamp(0.0, 1.0),
                    visible: mask.visible,
                })
            };
            entry.masks.iter().filter_map(read).collect()
        };
        self.photos.iter().enumerate().flat_map(of_photo).collect()
    }

    /// The depth maps, to be found again like the masks.
    pub fn depth_maps(&self) -> impl Iterator<Item = SavedDepth> {
        self.photos.iter().enumerate().filter_map(|(photo, entry)| {
            let depth = entry.depth.as_ref()?;
            let is_scale = depth.mm_per_unit.is_finite() && depth.mm_per_unit > 0.0;
            Some(SavedDepth {
                photo,
                sha256: depth.sha256.parse().ok()?,
                mm_per_unit: is_scale.then_some(depth.mm_per_unit)?,
                occludes: depth.occludes,
            })
        })
    }

    /// The position of the view's photo and object among the document's.
    pub fn view_positions(&self) -> (Option<usize>, Option<usize>) {
        let photo = self.photos.iter().position(|photo| Some(photo.id) == self.view.photo);
        let object = self.objects.iter().position(|object| Some(object.id) == self.view.selected);
        (photo, object)
    }

    pub(in crate::formats) fn to_incoming(&self, file_name: &str) -> Result<Incoming, FormatError> {
        let mut incoming = Incoming::new(file_name);
        for (index, object) in self.objects.iter().enumerate() {
            incoming.objects.push(object.to_incoming(&format!("objects[{index}]"))?);
        }
        for (index, photo) in self.photos.iter().enumerate() {
            incoming.photos.push(self.incoming_photo(photo, &format!("photos[{index}]"))?);
        }
        for (index, reference) in self.references.iter().enumerate() {
            incoming.references.push(self.incoming_reference(reference, &format!("references[{index}]"))?);
        }
        Ok(incoming)
    }

    fn incoming_photo(&self, photo: &PhotoEntry, place: &str) -> Result<IncomingPhoto, FormatError> {
        let mut camera = Intrinsics::from_k_rows(&photo.k, photo.width, photo.height)
            .map_err(|error| FormatError::camera(format!("{place}.K"), error))?;
        camera.distortion = photo.distortion.map_or(Distortion::NONE, Distortion::from_array);
        let camera =
            camera.checked().map_err(|error| FormatError::camera(format!("{place}.distortion"), error))?;
        let poses = photo.poses.iter().enumerate();
        Ok(IncomingPhoto {
            key: content_key(&photo.sha256, &photo.file, place)?,
            camera: Some(IncomingCamera::Exact(camera, photo.camera_origin.clone().into())),
            look: Some(PhotoLook {
                name: photo.name.clone(),
                visible: photo.visible,
                opacity: photo.opacity.clamp(0.0, 1.0),
                locked: photo.locked,
            }),
            poses: poses
                .map(|(index, pose)| self.incoming_pose(pose, &format!("{place}.poses[{index}]")))
                .collect::<Result<_, _>>()?,
        })
    }

    fn incoming_pose(&self, pose: &PoseEntry, place: &str) -> Result<IncomingPose, FormatError> {
        let camera_from_object = read_pose(&pose.camera_from_object, place)?;
        let [x, y, z, _] = pose.camera_from_object;
        let rotation = [[x[0], x[1], x[2]], [y[0], y[1], y[2]], [z[0], z[1], z[2]]];
        if rotation != pose.rotation || [x[3], y[3], z[3]] != pose.translation_mm {
            return Err(FormatError::at(
                place,
                "R and t are not those of camera_from_object; which one is right?",
            ));
        }
        Ok(IncomingPose {
            object: self.object_index(pose.object, place)?,
            camera_from_object,
            state: pose.state.into(),
            source: pose.source.into(),
            changed_at_ms: Some(pose.changed_at_ms),
            score: pose.score,
            pins: read_pins(&pose.pins, place)?,
        })
    }

    fn incoming_reference(
        &self,
        reference: &ReferenceEntry,
        place: &str,
    ) -> Result<IncomingReference, FormatError> {
        let poses = reference.poses.iter().map(|pose| {
            let photo = self.photos.iter().position(|photo| photo.id == pose.photo);
            let photo =
                photo.ok_or_else(|| FormatError::at(place, format!("no photo has the id {}", pose.photo)))?;
            let object = self.object_index(pose.object, place)?;
            Ok((photo, object, read_pose(&pose.camera_from_object, place)?))
        });
        Ok(IncomingReference {
            name: reference.name.clone(),
            visible: reference.visible,
            poses: poses.collect::<Result<_, FormatError>>()?,
        })
    }

    fn object_index(&self, id: u32, place: &str) -> Result<usize, FormatError> {
        let index = self.objects.iter().position(|object| object.id == id);
        index.ok_or_else(|| FormatError::at(place, format!("no object has the id {id}")))
    }
}

/// A mask of a document: which photo and object it belongs to by their positions, and how it was shown.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedMask {
    pub photo: usize,
    pub object: Option<usize>,
    pub sha256: Sha256,
    pub name: String,
    pub color: Rgb,
    pub opacity: f32,
    pub visible: bool,
}

/// A depth map of a document; its photo by its position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SavedDepth {
    pub photo: usize,
    pub sha256: Sha256,
    pub mm_per_unit: f64,
    pub occludes: bool,
}

fn photo_entry(scene: &Scene, photo: &Photo, keep: Keep) -> PhotoEntry {
    let kept = |annotation: &Annotation| {
        keep == Keep::Everything
            || matches!(annotation.state, AnnotationState::Posed | AnnotationState::Confirmed)
    };
    PhotoEntry {
        id: photo.id.0,
        name: (photo.name != photo.asset.file_name).then(|| photo.name.clone()),
        file: photo.asset.file_name.clone(),
        sha256: photo.asset.sha256.to_string(),
        width: photo.camera.width,
        height: photo.camera.height,
        k: photo.camera.k_rows(),
        distortion: (!photo.camera.distortion.is_none()).then(|| photo.camera.distortion.to_array()),
        camera_origin: photo.camera_origin.clone().into(),
        visible: photo.visible,
        opacity: photo.opacity,
        locked: photo.locked,
        depth: photo.depth.as_ref().map(depth_entry),
        masks: scene.masks_of(photo.id).map(mask_entry).collect(),
        poses: scene
            .objects_in(photo.id)
            .filter(|(_, annotation)| kept(annotation))
            .map(|(object, annotation)| pose_entry(object, annotation))
            .collect(),
    }
}

fn depth_entry(depth: &DepthMap) -> DepthEntry {
    DepthEntry {
        file: depth.asset.file_name.clone(),
        sha256: depth.asset.sha256.to_string(),
        mm_per_unit: depth.mm_per_unit,
        occludes: depth.occludes,
    }
}

fn mask_entry(mask: &Mask) -> MaskEntry {
    MaskEntry {
        name: mask.name.clone(),
        file: mask.asset.file_name.clone(),
        sha256: mask.asset.sha256.to_string(),
        object: mask.object.map(|object| object.0),
        color: write_color(mask.color),
        opacity: mask.opacity,
        visible: mask.visible,
    }
}

fn pose_entry(object: &Object, annotation: &Annotation) -> PoseEntry {
    let pose = &annotation.camera_from_object;
    PoseEntry {
        object: object.id.0,
        name: object.name.clone(),
        mesh_file: object.mesh.file_name.clone(),
        mesh_sha256: object.mesh.sha256.to_string(),
        rotation: pose.rotation_rows(),
        translation_mm: pose.translation_mm.to_array(),
        camera_from_object: pose.to_rows(),
        state: annotation.state.into(),
        source: annotation.source.into(),
        changed_at_ms: annotation.changed_at_ms,
        camera_changed: annotation.camera_changed,
        score: annotation.score,
        pins: annotation.pins.iter().map(pin_entry).collect(),
    }
}

fn pin_entry(pin: &Pin) -> PinEntry {
    PinEntry {
        point: pin.point_mm.to_array(),
        pixel: pin.pixel.to_array(),
        weight: pin.weight,
        enabled: pin.enabled,
    }
}

fn read_pins(entries: &[PinEntry], place: &str) -> Result<Vec<Pin>, FormatError> {
    let read = |(index, entry): (usize, &PinEntry)| {
        let pin = Pin {
            point_mm: DVec3::from_array(entry.point),
            pixel: DVec2::from_array(entry.pixel),
            weight: entry.weight,
            enabled: entry.enabled,
        };
        let is_good = pin.point_mm.is_finite() && pin.pixel.is_finite() && (0.0..1e9).contains(&pin.weight);
        is_good.then_some(pin).ok_or_else(|| {
            FormatError::at(
                format!("{place}.pins[{index}]"),
                "finite numbers and a weight of 0 or more expected",
            )
        })
    };
    entries.iter().enumerate().map(read).collect()
}

fn object_entry(object: &Object) -> ObjectEntry {
    ObjectEntry {
        id: object.id.0,
        name: object.name.clone(),
        mesh_file: object.mesh.file_name.clone(),
        mesh_sha256: object.mesh.sha256.to_string(),
        mesh_from_file: object.mesh_from_file.transpose().to_cols_array_2d(),
        color: write_color(object.color),
        opacity: object.opacity,
        visible: object.visible,
        locked: object.locked,
        link: object.link,
        symmetries: symmetries_entry(&object.symmetries),
    }
}

fn symmetries_entry(symmetries: &Symmetries) -> SymmetriesEntry {
    let continuous = symmetries.continuous.iter().map(|symmetry| ContinuousSymmetryEntry {
        axis: symmetry.axis.to_array(),
        offset_mm: symmetry.offset_mm.to_array(),
    });
    SymmetriesEntry {
        discrete: symmetries.discrete.iter().map(Pose::to_rows).collect(),
        continuous: continuous.collect(),
    }
}

fn read_symmetries(entry: &SymmetriesEntry, place: &str) -> Result<Symmetries, FormatError> {
    let discrete = entry.discrete.iter().enumerate().map(|(index, rows)| {
        let pose = Pose::from_rows(rows);
        pose.map(|(pose, _)| pose)
            .map_err(|error| FormatError::pose(format!("{place}.symmetries.discrete[{index}]"), error))
    });
    let continuous = entry.continuous.iter().enumerate().map(|(index, symmetry)| {
        let axis = DVec3::from_array(symmetry.axis);
        let offset_mm = DVec3::from_array(symmetry.offset_mm);
        // A unit axis is taken as it is, bit for bit.
        let axis =
            if (axis.length_squared() - 1.0).abs() < 1e-12 { Some(axis) } else { axis.try_normalize() };
        let symmetry = axis.filter(|_| offset_mm.is_finite());
        symmetry.map(|axis| ContinuousSymmetry { axis, offset_mm }).ok_or_else(|| {
            FormatError::at(
                format!("{place}.symmetries.continuous[{index}]"),
                "an axis of some length and a finite offset_mm expected",
            )
        })
    });
    Ok(Symmetries {
        discrete: discrete.collect::<Result<_, _>>()?,
        continuous: continuous.collect::<Result<_, _>>()?,
    })
}

fn write_color(Rgb([red, green, blue]): Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn reference_entry(reference: &crate::scene::Reference) -> ReferenceEntry {
    let poses = reference.poses.iter().map(|((photo, object), pose)| ReferencePoseEntry {
        photo: photo.0,
        object: object.0,
        camera_from_object: pose.to_rows(),
    });
    ReferenceEntry { name: reference.name.clone(), visible: reference.visible, poses: poses.collect() }
}

impl ObjectEntry {
    fn to_incoming(&self, place: &str) -> Result<IncomingObject, FormatError> {
        let mesh_from_file = DMat4::from_cols_array_2d(&self.mesh_from_file).transpose();
        let mesh_from_file = MeshFrame::checked(mesh_from_file)
            .map_err(|error| FormatError::at(format!("{place}.mesh_from_file"), error))?
            .0;
        Ok(IncomingObject {
            key: content_key(&self.mesh_sha256, &self.mesh_file, place)?,
            mesh_from_file: Some(mesh_from_file),
            symmetries: Some(read_symmetries(&self.symmetries, place)?),
            look: Some(ObjectLook {
                name: self.name.clone(),
                color: read_color(&self.color, place)?,
                opacity: self.opacity.clamp(0.0, 1.0),
                visible: self.visible,
                locked: self.locked,
                link: self.link,
            }),
        })
    }
}

fn read_pose(rows: &[[f64; 4]; 4], place: &str) -> Result<Pose, FormatError> {
    let pose = Pose::from_rows(rows)
        .map_err(|error| FormatError::pose(format!("{place}.camera_from_object"), error))?;
    Ok(pose.0)
}

fn content_key(sha256: &str, file_name: &str, place: &str) -> Result<FileKey, FormatError> {
    let sha256: Sha256 =
        sha256.parse().map_err(|reason| FormatError::at(format!("{place}.sha256"), reason))?;
    Ok(FileKey::Content { sha256, file_name: file_name.to_owned() })
}

fn read_color(text: &str, place: &str) -> Result<Rgb, FormatError> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    let value = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, red, green, blue] = value
        .ok_or_else(|| {
            FormatError::at(format!("{place}.color"), format!("#rrggbb expected, found \"{text}\""))
        })?
        .to_be_bytes();
    Ok(Rgb([red, green, blue]))
}

impl From<CameraOrigin> for CameraOriginEntry {
    fn from(origin: CameraOrigin) -> Self {
        match origin {
            CameraOrigin::AssumedFieldOfView => Self::AssumedFieldOfView,
            CameraOrigin::Exif(source) => Self::Exif { sensor: source.into() },
            CameraOrigin::Pins { relative_sigma } => Self::Pins { relative_sigma },
            CameraOrigin::Slider { before_px } => Self::Slider { before_px },
            CameraOrigin::Typed => Self::Typed,
            CameraOrigin::File(name) => Self::File { name },
        }
    }
}

impl From<CameraOriginEntry> for CameraOrigin {
    fn from(entry: CameraOriginEntry) -> Self {
        match entry {
            CameraOriginEntry::AssumedFieldOfView => Self::AssumedFieldOfView,
            CameraOriginEntry::Exif { sensor } => Self::Exif(sensor.into()),
            CameraOriginEntry::Pins { relative_sigma } => Self::Pins { relative_sigma },
            CameraOriginEntry::Slider { before_px } => Self::Slider { before_px },
            CameraOriginEntry::Typed => Self::Typed,
            CameraOriginEntry::File { name } => Self::File(name),
        }
    }
}

/// Both directions between two enums of the same variants.
macro_rules! mirror {
    ($live:ident, $entry:ident, $($variant:ident),+) => {
        impl From<$live> for $entry {
            fn from(live: $live) -> Self {
                match live { $($live::$variant => Self::$variant),+ }
            }
        }
        impl From<$entry> for $live {
            fn from(entry: $entry) -> Self {
                match entry { $($entry::$variant => Self::$variant),+ }
            }
        }
    };
}

mirror!(ExifFocalSource, ExifSensorEntry, Equivalent, FocalPlane, SensorTable);
mirror!(AnnotationState, StateEntry, Untouched, Carried, Posed, Confirmed);
mirror!(PoseSource, SourceEntry, Manual, Pins, Snap, Tracked, Imported);
