//! What to draw: plain data, equal if and only if the pixels are.

use std::sync::Arc;

use crate::math::{ImageRect, Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::photo::Pixels;
use crate::scene::{MeshAsset, ObjectId, PhotoId, Rgb, Scene, reference_color};

/// The width of a reference's outline on screen.
pub const GHOST_WIDTH_POINTS: f32 = 2.25;

/// One picture: a part of a photo with meshes over it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub camera: Intrinsics,
    /// The part of the `image` frame that fills the target.
    pub rect: ImageRect,
    pub photo: Option<PhotoLayer>,
    pub items: Vec<Item>,
    /// References: outlines only, dashed.
    pub ghosts: Vec<Item>,
    /// 0 to 1, over all items.
    pub overlay_opacity: f32,
    pub outline: Option<Outline>,
    /// Of the ghosts' outlines, in target pixels; they are there whether or not the items have theirs.
    pub ghost_width_px: f32,
    /// Around the photo.
    pub background: Rgb,
}

/// The pixels under the meshes; shared, and the same where they are at the same place in memory.
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

/// Line widths in target pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    pub width_px: f32,
    pub selected_width_px: f32,
}

impl Outline {
    /// Lines that look the same on every screen.
    pub fn for_scale(pixels_per_point: f32) -> Self {
        Self { width_px: 1.25 * pixels_per_point, selected_width_px: 2.25 * pixels_per_point }
    }
}

/// The whole of one photo of a scene, all of whose visible objects are in the picture.
pub fn picture_of(
    scene: &Scene,
    photo: PhotoId,
    pixels: Option<Arc<Pixels>>,
    selected: Option<ObjectId>,
) -> Option<Picture> {
    let camera = scene.photo(photo)?.camera;
    let items = scene.objects_in(photo).filter(|(object, _)| object.visible).enumerate();
    let items = items.map(|(index, (object, annotation))| Item {
        mesh: object.mesh.clone(),
        camera_from_object: annotation.camera_from_object,
        color: object.color,
        opacity: object.opacity,
        id: item_id(index),
        selected: Some(object.id) == selected,
    });
    Some(Picture {
        camera,
        rect: ImageRect::of_photo(camera.width, camera.height),
        photo: pixels.map(PhotoLayer),
        items: items.collect(),
        ghosts: ghosts_of(scene, photo),
        overlay_opacity: 1.0,
        outline: Some(Outline::for_scale(1.0)),
        ghost_width_px: GHOST_WIDTH_POINTS,
        background: Rgb([24, 26, 31]),
    })
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
