//! What was on screen, as the document keeps it.

use serde::{Deserialize, Serialize};

use crate::scene::{Layers, Look, OverlayMode, PhotoAdjustment};

/// Never part of undo. A field that a file lacks, or whose word this version does not know, has its usual value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewSettings {
    /// Ids of the document's photos and objects.
    pub photo: Option<u32>,
    pub selected: Option<u32>,
    /// 0 to 1, over all objects.
    overlay_opacity: f32,
    outline: bool,
    overlay_mode: String,
    x_ray: bool,
    layers: String,
    brightness: f32,
    contrast: f32,
    saturation: f32,
    wipe: Option<f32>,
    difference: bool,
    /// `photo`, `scene` or `split`.
    pub panes: String,
    /// Of the photo's plane in the scene view; null: as far as the objects.
    pub image_distance_mm: Option<f64>,
}

const LAYERS: [(Layers, &str); 3] =
    [(Layers::Both, "both"), (Layers::PhotoOnly, "photo_only"), (Layers::MeshOnly, "mesh_only")];

impl Default for ViewSettings {
    fn default() -> Self {
        Self::of_look(&Look::default())
    }
}

impl ViewSettings {
    pub fn of_look(look: &Look) -> Self {
        let layers =
            LAYERS.iter().find(|(layers, _)| *layers == look.layers).map_or("both", |(_, name)| name);
        Self {
            photo: None,
            selected: None,
            overlay_opacity: look.overlay_opacity,
            outline: look.outline,
            overlay_mode: look.mode.name().to_owned(),
            x_ray: look.x_ray,
            layers: layers.to_owned(),
            brightness: look.photo.brightness,
            contrast: look.photo.contrast,
            saturation: look.photo.saturation,
            wipe: look.wipe,
            difference: look.difference,
            panes: "photo".to_owned(),
            image_distance_mm: None,
        }
    }

    pub fn look(&self) -> Look {
        let layers = LAYERS.iter().find(|(_, name)| *name == self.layers).map(|(layers, _)| *layers);
        Look {
            mode: OverlayMode::from_name(&self.overlay_mode).unwrap_or_default(),
            overlay_opacity: self.overlay_opacity,
            outline: self.outline,
            x_ray: self.x_ray,
            layers: layers.unwrap_or_default(),
            photo: PhotoAdjustment {
                brightness: self.brightness,
                contrast: self.contrast,
                saturation: self.saturation,
            },
            wipe: self.wipe,
            difference: self.difference,
        }
        .in_range()
    }
}
