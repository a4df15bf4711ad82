//! What an export works from: the scene as it was when it began, and everything's name in files.

use std::collections::BTreeMap;

use super::meshes::{MeshPlan, mesh_plans};
use super::names::{numbers_of, unique_names};
use super::{ExportOptions, ExportPart, PhotoChoice};
use crate::formats::Keep;
use crate::math::Pose;
use crate::photo::is_grey;
use crate::raster::RasterItem;
use crate::scene::{Annotation, AnnotationState, Object, Photo, PhotoId, Scene, file_stem};

/// A scene, cut down to what is exported.
#[derive(Debug)]
pub(super) struct Plan {
    pub scene: Scene,
    pub options: ExportOptions,
    pub photos: Vec<PhotoPlan>,
    pub objects: Vec<ObjectPlan>,
    /// Objects of one mesh in one frame are instances of one model.
    pub models: Vec<ModelPlan>,
    /// Of each object, for one folder of all.
    pub meshes: Vec<MeshPlan>,
    /// BOP's folder of photos: `gray` if none of them has colours.
    pub photo_folder: &'static str,
}

#[derive(Debug)]
pub(super) struct PhotoPlan {
    /// Index into the scene's photos.
    pub index: usize,
    /// A file's stem.
    pub name: String,
    /// BOP's `im_id`.
    pub image_id: u32,
}

#[derive(Debug)]
pub(super) struct ObjectPlan {
    /// A file's stem.
    pub name: String,
    /// Index into [`Plan::models`].
    pub model: usize,
}

#[derive(Debug)]
pub(super) struct ModelPlan {
    /// Index into the scene's objects: the first that has the mesh.
    pub object: usize,
    /// BOP's `obj_id`.
    pub id: u32,
    pub mesh: MeshPlan,
}

/// An object in a photo.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'a> {
    /// Index into [`Plan::objects`] and the scene's.
    pub index: usize,
    pub object: &'a Object,
    pub annotation: &'a Annotation,
}

impl Placed<'_> {
    pub fn pose(&self) -> &Pose {
        &self.annotation.camera_from_object
    }
}

impl Plan {
    pub fn new(mut scene: Scene, options: ExportOptions) -> Self {
        if let PhotoChoice::These(chosen) = &options.photos {
            let others: Vec<PhotoId> =
                scene.photos.iter().map(|photo| photo.id).filter(|id| !chosen.contains(id)).collect();
            others.into_iter().for_each(|id| scene.remove_photo(id));
        }
        let is_annotated = |annotation: &Annotation| {
            matches!(annotation.state, AnnotationState::Posed | AnnotationState::Confirmed)
        };
        if options.keep == Keep::Annotated {
            scene.annotations.retain(|_, annotation| is_annotated(annotation));
        }
        let stems: Vec<&str> = scene.photos.iter().map(|photo| file_stem(&photo.name)).collect();
        let names = unique_names(stems.iter().copied()).into_iter().enumerate();
        let photos = names
            .zip(numbers_of(stems.iter().copied(), 0))
            .map(|((index, name), image_id)| PhotoPlan { index, name, image_id })
            .collect();
        let (models, model_of) = models(&scene);
        let names = unique_names(scene.objects.iter().map(|object| object.name.as_str()));
        let objects =
            names.into_iter().zip(model_of).map(|(name, model)| ObjectPlan { name, model }).collect();
        let meshes = mesh_plans(scene.objects.iter());
        let is_bop = options.parts.contains(&ExportPart::Bop);
        let is_grey = is_bop
            && !scene.photos.is_empty()
            && scene.photos.iter().all(|photo| is_grey(&photo.asset.bytes));
        let photo_folder = if is_grey { "gray" } else { "rgb" };
        Self { photos, objects, models, meshes, options, scene, photo_folder }
    }

    /// The photo of a plan of this scene.
    pub fn photo(&self, plan: &PhotoPlan) -> Option<&Photo> {
        self.scene.photos.get(plan.index)
    }

    /// The objects whose poses in a photo are exported, in the scene's order.
    pub fn placed(&self, photo: &Photo) -> Vec<Placed<'_>> {
        let placed = self.scene.objects.iter().enumerate().filter_map(|(index, object)| {
            let annotation = self.scene.annotation(photo.id, object.id)?;
            Some(Placed { index, object, annotation })
        });
        placed.collect()
    }

    /// The name of an object in files.
    pub fn object_name(&self, index: usize) -> &str {
        self.objects.get(index).map_or("", |object| &object.name)
    }

    /// The objects whose textures cannot be written with their meshes.
    pub fn textures_lost<'a>(
        &'a self,
        meshes: impl Iterator<Item = (&'a MeshPlan, usize)>,
    ) -> impl Iterator<Item = &'a str> {
        let objects = meshes.filter_map(|(mesh, at)| Some((mesh, self.scene.objects.get(at)?)));
        objects.filter(|(mesh, object)| mesh.loses_textures(object)).map(|(_, object)| object.name.as_str())
    }

    /// BOP's `obj_id` of an object.
    pub fn model_id(&self, index: usize) -> u32 {
        let model = self.objects.get(index).and_then(|object| self.models.get(object.model));
        model.map_or(0, |model| model.id)
    }

    /// The photo's depth map in millimetres; `None` where it has none of its size, or none that can be read.
    pub fn depth_mm(&self, photo: &Photo) -> Option<Vec<f32>> {
        let depth = photo.depth.as_ref()?.in_mm().ok()?;
        let fits = (depth.width, depth.height) == (photo.camera.width, photo.camera.height);
        fits.then_some(depth.mm)
    }
}

/// For the rasteriser; ids are 1, 2, … in this order.
pub(super) fn raster_items<'a>(placed: &[Placed<'a>]) -> Vec<RasterItem<'a>> {
    let item = |(id, placed): (u32, &Placed<'a>)| RasterItem {
        mesh: &placed.object.mesh.mesh,
        camera_from_object: *placed.pose(),
        id,
    };
    (1..).zip(placed).map(item).collect()
}

/// The models of a scene, and which of them each object is.
fn models(scene: &Scene) -> (Vec<ModelPlan>, Vec<usize>) {
    let mut firsts: Vec<usize> = Vec::new();
    let mut model_of = Vec::with_capacity(scene.objects.len());
    let mut known: BTreeMap<crate::scene::Sha256, Vec<usize>> = BTreeMap::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let same_mesh = known.entry(object.mesh.sha256).or_default();
        let same = same_mesh.iter().copied().find(|&model| {
            let first = firsts.get(model).and_then(|&first| scene.objects.get(first));
            first.is_some_and(|first| is_same_model(first, object))
        });
        model_of.push(same.unwrap_or_else(|| {
            firsts.push(index);
            same_mesh.push(firsts.len() - 1);
            firsts.len() - 1
        }));
    }
    let stem =
        |&object: &usize| scene.objects.get(object).map_or("", |object| file_stem(&object.mesh.file_name));
    let ids = numbers_of(firsts.iter().map(stem), 1);
    let meshes = mesh_plans(firsts.iter().filter_map(|&first| scene.objects.get(first)));
    let models = firsts
        .iter()
        .zip(ids)
        .zip(meshes)
        .map(|((&object, id), mesh)| ModelPlan { object, id, mesh })
        .collect();
    (models, model_of)
}

fn is_same_model(a: &Object, b: &Object) -> bool {
    a.mesh_from_file == b.mesh_from_file && a.symmetries == b.symmetries
}
