//! What to draw: plain data, equal if and only if the pixels are.

use std::sync::Arc;

use super::Occluder;
use super::lines::Line3;
use crate::math::{ImageRect, Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::photo::{DepthPixels, Pixels};
use crate::scene::{Layers, Look, MeshAsset, ObjectId, OverlayMode, PhotoId, Rgb, Scene, reference_color};

/// One picture: what a camera sees of a photo and the meshes in it.
///
/// In the photo view that camera is the photo's own, and the photo is what it sees. In a free view the photo is a plane in
/// space, and the camera, an eye without distortion, may be anywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Of the eye that looks: the photo's camera, or a free one.
    pub camera: Intrinsics,
    /// Where the photo's camera is before that eye; the identity where the eye is that camera.
    pub eye_from_camera: Pose,
    /// The part of the eye's `image` frame that fills the target.
    pub rect: ImageRect,
    pub photo: Option<PhotoLayer>,
    /// 0 to 1, over the background.
    pub photo_opacity: f32,
    /// Of the photo's size, tinted, straight alpha; between photo and meshes.
    pub masks: Option<PhotoLayer>,
    /// Hides the parts of items that are behind it; not in a free view.
    pub occluder: Option<Occluder>,
    pub items: Vec<Item>,
    /// References: outlines only, dashed.
    pub ghosts: Vec<Item>,
    pub look: Look,
    pub widths: LineWidths,
    /// Of a free view: what is around the meshes in place of a photo that fills the target.
    pub surroundings: Option<Surroundings>,
    /// Around the photo.
    pub background: Rgb,
    /// While a gesture moves things, and when a mesh is seen for the first time: meshes of very many triangles are drawn
    /// coarser.
    pub in_motion: bool,
}

/// Pixels that lie under the meshes; shared, and the same where they are at the same place in memory.
#[derive(Debug, Clone)]
pub struct PhotoLayer(pub Arc<Pixels>);

impl PartialEq for PhotoLayer {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A mesh somewhere.
#[derive(Debug, Clone)]
pub struct Item {
    pub mesh: Arc<MeshAsset>,
    /// In the frame of the photo's camera, also where another eye looks.
    pub camera_from_object: Pose,
    pub color: Rgb,
    pub opacity: f32,
    /// 1 to 127, to tell neighbours apart.
    pub id: u8,
    pub selected: bool,
}

impl PartialEq for Item {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.camera_from_object == other.camera_from_object
            && (self.color, self.opacity, self.id, self.selected)
                == (other.color, other.opacity, other.id, other.selected)
    }
}

impl Item {
    pub fn mesh(&self) -> &Mesh {
        &self.mesh.mesh
    }
}

/// What a free eye sees besides meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    /// Where [`Picture::photo`] and its masks are.
    pub plane: Option<PhotoPlane>,
    pub lines: Vec<Line3>,
}

/// The photo as a surface in its camera's frustum: each pixel lies on its own view ray, at this depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotoPlane {
    pub camera: Intrinsics,
    pub distance_mm: f64,
    /// 0 to 1.
    pub opacity: f32,
}

/// Line widths in target pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineWidths {
    pub outline_px: f32,
    pub selected_outline_px: f32,
    /// Of the ghosts' outlines; they are there whether or not the items have theirs.
    pub ghost_px: f32,
    /// Of feature edges.
    pub edge_px: f32,
    pub wireframe_px: f32,
    /// Of the line where a wipe ends.
    pub wipe_px: f32,
}

impl LineWidths {
    /// Lines that look the same on every screen.
    pub fn for_scale(pixels_per_point: f32) -> Self {
        Self {
            outline_px: 1.25 * pixels_per_point,
            selected_outline_px: 2.25 * pixels_per_point,
            ghost_px: 2.25 * pixels_per_point,
            edge_px: 1.5 * pixels_per_point,
            wireframe_px: 0.9 * pixels_per_point,
            wipe_px: 1.5 * pixels_per_point,
        }
    }

    /// Of the lines that belong to meshes.
    pub(super) fn widest_px(&self) -> f32 {
        [self.outline_px, self.selected_outline_px, self.ghost_px, self.edge_px, self.wireframe_px]
            .into_iter()
            .fold(0.0, f32::max)
    }
}

/// What a picture is made from.
#[derive(Debug, Clone)]
pub struct Subject<'a> {
    pub scene: &'a Scene,
    pub photo: PhotoId,
    /// The photo, decoded.
    pub pixels: Option<Arc<Pixels>>,
    /// Of the photo's size, tinted, straight alpha.
    pub masks: Option<Arc<Pixels>>,
    /// The photo's depth map, decoded.
    pub depth: Option<Arc<DepthPixels>>,
    pub selected: Option<ObjectId>,
    /// An object that is drawn elsewhere than it is: on its way there.
    pub drawn_pose: Option<(ObjectId, Pose)>,
    pub look: Look,
    pub pixels_per_point: f32,
}

impl<'a> Subject<'a> {
    /// A photo of a scene as it is by default.
    pub fn new(scene: &'a Scene, photo: PhotoId, pixels: Option<Arc<Pixels>>) -> Self {
        Self {
            scene,
            photo,
            pixels,
            masks: None,
            depth: None,
            selected: None,
            drawn_pose: None,
            look: Look::default(),
            pixels_per_point: 1.0,
        }
    }
}

/// The whole of one photo of a scene, all of whose visible objects are in the picture.
pub fn picture_of(subject: &Subject<'_>) -> Option<Picture> {
    let Subject { scene, photo, .. } = *subject;
    let shown = scene.photo(photo)?;
    let camera = shown.camera;
    let items = scene.objects_in(photo).filter(|(object, _)| object.visible).enumerate();
    let items = items.map(|(index, (object, annotation))| Item {
        mesh: object.mesh.clone(),
        camera_from_object: match subject.drawn_pose {
            Some((drawn, pose)) if drawn == object.id => pose,
            _ => annotation.camera_from_object,
        },
        color: object.color,
        opacity: object.opacity,
        id: item_id(index),
        selected: Some(object.id) == subject.selected,
    });
    Some(Picture {
        camera,
        eye_from_camera: Pose::IDENTITY,
        rect: ImageRect::of_photo(camera.width, camera.height),
        photo: subject.pixels.clone().map(PhotoLayer),
        photo_opacity: if shown.visible { shown.opacity } else { 0.0 },
        masks: subject.masks.clone().map(PhotoLayer),
        occluder: shown.depth.as_ref().filter(|depth| depth.occludes).and_then(|depth| {
            Some(Occluder { pixels: subject.depth.clone()?, mm_per_unit: depth.mm_per_unit })
        }),
        items: items.collect(),
        ghosts: ghosts_of(scene, photo),
        look: subject.look,
        widths: LineWidths::for_scale(subject.pixels_per_point),
        surroundings: None,
        background: Rgb([24, 26, 31]),
        in_motion: false,
    })
}

impl Picture {
    /// Is a mesh of very many triangles in it that has never been drawn?
    pub fn has_fresh_mesh(&self) -> bool {
        self.items.iter().any(|item| item.mesh.drawn.is_fresh())
    }

    pub(super) fn shows_meshes(&self) -> bool {
        self.look.layers != Layers::PhotoOnly
    }

    pub(super) fn shows_photo(&self) -> bool {
        self.photo.is_some() && self.look.layers != Layers::MeshOnly
    }

    /// Nothing of what is around the photo is seen.
    pub(super) fn is_inside_photo(&self) -> bool {
        let photo = ImageRect::of_photo(self.camera.width, self.camera.height);
        self.rect.min.cmpge(photo.min).all() && self.rect.max.cmple(photo.max).all()
    }

    pub(super) fn shows_masks(&self) -> bool {
        self.masks.is_some() && self.look.layers != Layers::MeshOnly
    }

    pub(super) fn shows_ghosts(&self) -> bool {
        self.shows_meshes() && !self.ghosts.is_empty()
    }

    /// The meshes' own surfaces or edges.
    pub(super) fn fills(&self) -> bool {
        self.shows_meshes() && self.look.mode != OverlayMode::Outline && !self.items.is_empty()
    }

    pub(super) fn outlines(&self) -> bool {
        let wanted = self.look.outline || self.look.mode == OverlayMode::Outline;
        self.shows_meshes() && wanted && !self.items.is_empty()
    }

    pub(super) fn occludes(&self) -> bool {
        self.occluder.is_some() && self.surroundings.is_none() && !self.look.x_ray
    }

    /// What others hide is outlined too, or what the scene hides: nobody shall look for an object that is behind a wall.
    pub(super) fn outlines_hidden(&self) -> bool {
        self.outlines() && (self.occludes() || self.look.x_ray && self.items.len() > 1)
    }

    pub(super) fn lines(&self) -> &[Line3] {
        self.surroundings.as_ref().map_or(&[], |surroundings| &surroundings.lines)
    }

    pub(super) fn plane(&self) -> Option<&PhotoPlane> {
        self.surroundings.as_ref()?.plane.as_ref().filter(|_| self.shows_photo())
    }

    /// Where an item is before the eye that looks.
    pub(super) fn eye_from_object(&self, item: &Item) -> Pose {
        self.eye_from_camera * item.camera_from_object
    }
}

fn ghosts_of(scene: &Scene, photo: PhotoId) -> Vec<Item> {
    let visible = scene.references.iter().filter(|reference| reference.visible);
    let poses =
        visible.flat_map(|reference| reference.poses.iter()).filter(|((in_photo, _), _)| *in_photo == photo);
    let known = poses.filter_map(|((_, object), pose)| Some((scene.object(*object)?, pose)));
    known
        .enumerate()
        .map(|(index, (object, pose))| Item {
            mesh: object.mesh.clone(),
            camera_from_object: *pose,
            color: reference_color(),
            opacity: 0.0,
            id: item_id(index),
            selected: false,
        })
        .collect()
}

fn item_id(index: usize) -> u8 {
    (index % 127) as u8 + 1
}
