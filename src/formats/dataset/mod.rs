//! Data sets: folders and archives in the layouts of the field.
//!
//! Nothing here reads a file, for a page reads them in its own time. A [`Listing`] of names is [`recognise`]d; the user
//! chooses; the few small files that are [`Recognised::needed`] are read by whoever can; [`Recognised::interpret`] makes a
//! [`Dataset`] of them, which names the photos and meshes to open and says what was found, guessed and missing.

mod bop;
mod folder;
mod linemod;
mod listing;
mod megapose;
mod meshes;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DMat4;

use super::{CameraFile, FileKey, FormatError, Incoming, IncomingCamera, IncomingObject, IncomingPhoto};
use crate::scene::Symmetries;

pub use listing::Listing;

/// Which layout a data set has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DatasetKind {
    /// BOP, and HANDAL, which has its layout; also Linemod with `gt.yml`.
    Bop,
    /// Linemod as it was published: `colorN.jpg`, `rotN.rot`, `traN.tra`.
    Linemod,
    MegaPose,
    /// Photos, meshes and files of cameras and poses, as Vision6D, 6D-PAT and people have them.
    Folder,
}

impl DatasetKind {
    /// As a message names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bop => "BOP data set",
            Self::Linemod => "Linemod sequence",
            Self::MegaPose => "MegaPose example",
            Self::Folder => "folder of photos and meshes",
        }
    }
}

/// A part of a data set that can be opened by itself: a scene of a split, by one sensor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// "test / 000002", with the sensor where there are several.
    pub label: String,
    pub photos: usize,
    /// The bytes of its photos.
    pub bytes: u64,
}

/// A `scene_gt.json` of a thousand photos with twenty objects each takes a sixth of it; what is larger is not asked for.
const MAX_TEXT_BYTES: u64 = 64 << 20;

/// The files that were read, by path. One that could not be read is left out.
pub type Contents = BTreeMap<String, Arc<[u8]>>;

/// A data set that was recognised by the names of its files.
#[derive(Debug, Clone)]
pub struct Recognised {
    pub kind: DatasetKind,
    pub name: String,
    /// Never empty.
    pub choices: Vec<Choice>,
    listing: Arc<Listing>,
    layout: Layout,
}

#[derive(Debug, Clone)]
enum Layout {
    Bop(bop::Layout),
    Linemod(linemod::Layout),
    MegaPose(megapose::Layout),
    Folder(folder::Layout),
}

/// What a data set holds, with its files still to be opened.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    pub kind: DatasetKind,
    pub name: String,
    /// For the user, before it opens: one line each.
    pub found: Vec<String>,
    pub guessed: Vec<String>,
    pub missing: Vec<String>,
    pub photos: Vec<DatasetPhoto>,
    pub meshes: Vec<DatasetMesh>,
    /// Each becomes a reference or annotations, as the user says. They name photos and meshes by the paths above: whoever
    /// opens those has to keep the paths as their files' names.
    pub poses: Vec<Incoming>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct DatasetPhoto {
    pub path: String,
    /// `None`: the data set does not say.
    pub camera: Option<CameraFile>,
    pub depth: Option<DatasetDepth>,
    pub masks: Vec<DatasetMask>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct DatasetDepth {
    pub path: String,
    pub mm_per_unit: f64,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DatasetMask {
    pub path: String,
    /// Index into [`Dataset::meshes`], where it is known, and which object of that mesh, from 0.
    pub mesh: Option<usize>,
    pub instance: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub struct DatasetMesh {
    pub path: String,
    /// What the object is to be called.
    pub name: String,
    /// From the numbers in the file to the data set's object frame, in millimetres; `None` where they are the same.
    pub mesh_from_file: Option<DMat4>,
    pub symmetries: Symmetries,
    /// Files that it may ask for: textures, material libraries, buffers. Which of them it does ask for, its content says.
    pub companions: Vec<String>,
}

impl DatasetPhoto {
    fn at(path: &str) -> Self {
        Self { path: path.to_owned(), camera: None, depth: None, masks: Vec::new() }
    }
}

impl DatasetMesh {
    fn at(path: &str) -> Self {
        Self {
            path: path.to_owned(),
            name: crate::scene::file_stem(path).to_owned(),
            mesh_from_file: None,
            symmetries: Symmetries::default(),
            companions: Vec::new(),
        }
    }
}

/// Tells by the names of files what a folder or an archive is; `None` where it holds nothing that could be opened together.
pub fn recognise(listing: &Arc<Listing>) -> Option<Recognised> {
    // A folder of photos is what is left when it is nothing else.
    megapose::recognise(listing)
        .or_else(|| bop::recognise(listing))
        .or_else(|| linemod::recognise(listing))
        .or_else(|| folder::recognise(listing))
}

impl Recognised {
    fn new(kind: DatasetKind, listing: &Arc<Listing>, choices: Vec<Choice>, layout: Layout) -> Option<Self> {
        let (name, listing) = (listing.name().to_owned(), listing.clone());
        (!choices.is_empty()).then_some(Self { kind, name, choices, listing, layout })
    }

    /// The small files that have to be read before these choices, by their indices, can be interpreted.
    pub fn needed(&self, chosen: &[usize]) -> Vec<String> {
        let mut paths = match &self.layout {
            Layout::Bop(layout) => layout.needed(chosen),
            Layout::Linemod(layout) => layout.needed(chosen),
            Layout::MegaPose(layout) => layout.needed(chosen),
            Layout::Folder(layout) => layout.needed(),
        };
        paths.retain(|path| self.listing.size_of(path).is_some_and(|bytes| bytes <= MAX_TEXT_BYTES));
        paths
    }

    /// What the chosen parts hold. Files of `contents` that cannot be understood, and parts of them, are missed in words;
    /// only where nothing at all can be opened it is an error.
    pub fn interpret(&self, chosen: &[usize], contents: &Contents) -> Result<Dataset, FormatError> {
        let mut dataset = Dataset {
            kind: self.kind,
            name: self.name.clone(),
            found: Vec::new(),
            guessed: Vec::new(),
            missing: Vec::new(),
            photos: Vec::new(),
            meshes: Vec::new(),
            poses: Vec::new(),
        };
        match &self.layout {
            Layout::Bop(layout) => layout.interpret(chosen, contents, &mut dataset),
            Layout::Linemod(layout) => layout.interpret(chosen, contents, &mut dataset),
            Layout::MegaPose(layout) => layout.interpret(chosen, contents, &mut dataset),
            Layout::Folder(layout) => layout.interpret(contents, &mut dataset),
        }
        if dataset.photos.is_empty() && dataset.meshes.is_empty() {
            let reasons = dataset.missing.join("; ");
            return Err(FormatError::at(
                &self.name,
                format!("neither photos nor meshes were found: {reasons}"),
            ));
        }
        Ok(dataset)
    }
}

impl Dataset {
    /// What is to be given to the scene before any poses: the photos' cameras, the meshes' transforms and symmetries.
    pub fn setting(&self) -> Incoming {
        let mut incoming = Incoming::new(&self.name);
        let cameras = self.photos.iter().filter_map(|photo| {
            Some(IncomingPhoto {
                key: FileKey::Path(photo.path.clone()),
                camera: Some(IncomingCamera::File(photo.camera.clone()?)),
                look: None,
                poses: Vec::new(),
            })
        });
        incoming.photos = cameras.collect();
        // All layouts but the loose folder fix the unit: what they do not transform is in millimetres.
        let fixed = (self.kind != DatasetKind::Folder).then_some(DMat4::IDENTITY);
        let meshes = self.meshes.iter().map(|mesh| IncomingObject {
            mesh_from_file: mesh.mesh_from_file.or(fixed),
            symmetries: Some(mesh.symmetries.clone()).filter(|symmetries| !symmetries.is_empty()),
            ..IncomingObject::named(FileKey::Path(mesh.path.clone()))
        });
        incoming.objects = meshes.collect();
        incoming
    }

    pub fn pose_count(&self) -> usize {
        self.poses.iter().map(Incoming::pose_count).sum()
    }

    /// Takes poses over, with what was corrected while they were read.
    fn take_poses(&mut self, mut poses: Incoming) {
        let name = &poses.file_name;
        self.guessed.extend(poses.remarks.drain(..).map(|remark| format!("{name}: {remark}")));
        let count = poses.pose_count();
        if count > 0 {
            self.found.push(counted(count, "pose", &format!(" in {name}")));
        }
        // Foreign cameras are with the photos by now; one of our own documents has more to say.
        let is_ours = |photo: &IncomingPhoto| matches!(photo.camera, Some(IncomingCamera::Exact(..)));
        if count > 0 || !poses.references.is_empty() || poses.photos.iter().any(is_ours) {
            self.poses.push(poses);
        }
    }

    /// Says of a file that it cannot be used, and why.
    fn miss_file(&mut self, path: &str, error: &FormatError) {
        self.missing.push(format!("{path}: {error}"));
    }
}

/// "1 pose", "2 poses", with what follows.
fn counted(count: usize, noun: &str, rest: &str) -> String {
    let plural = match (count, noun.ends_with("sh")) {
        (1, _) => "",
        (_, true) => "es",
        (_, false) => "s",
    };
    format!("{count} {noun}{plural}{rest}")
}
