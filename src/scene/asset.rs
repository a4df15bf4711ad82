//! Files that came from outside, kept as they were and known by their content.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use glam::{DAffine3, DMat4};
use sha2::Digest;

use super::CameraOrigin;
use crate::math::Intrinsics;
use crate::mesh::{Bvh, DrawnAhead, FileUnit, Mesh, MeshError, SearchTree};
use crate::photo::ExifFocal;

/// The field of view that is assumed where a photo says nothing of its lens.
const ASSUMED_FIELD_OF_VIEW_RAD: f64 = std::f64::consts::FRAC_PI_3;

/// The SHA-256 of a file's bytes: how photos and meshes are found again.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Sha256([u8; 32]);

/// What is hashed in one call.
const PIECE_BYTES: usize = 1 << 14;

impl Sha256 {
    pub fn of(bytes: &[u8]) -> Self {
        let mut hasher = sha2::Sha256::new();
        // A browser compiles WebAssembly hastily at first and properly once a function was called often enough, but a call
        // that runs is never replaced: twenty megabytes in one call take six times as long.
        bytes.chunks(PIECE_BYTES).for_each(|piece| hasher.update(piece));
        Self(hasher.finalize().into())
    }
}

impl fmt::Display for Sha256 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Sha256 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl FromStr for Sha256 {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "a SHA-256 of 64 hexadecimal digits expected";
        if text.len() != 64 || !text.is_ascii() {
            return Err(EXPECTED);
        }
        let mut digest = [0; 32];
        for (byte, pair) in digest.iter_mut().zip(text.as_bytes().chunks_exact(2)) {
            let pair = std::str::from_utf8(pair).map_err(|_| EXPECTED)?;
            *byte = u8::from_str_radix(pair, 16).map_err(|_| EXPECTED)?;
        }
        Ok(Self(digest))
    }
}

/// A photo's file. Its pixels are decoded when it is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoAsset {
    pub file_name: String,
    pub sha256: Sha256,
    pub bytes: Arc<[u8]>,
    /// In pixels, upright.
    pub width: u32,
    pub height: u32,
    pub exif_focal: Option<ExifFocal>,
}

impl PhotoAsset {
    /// The camera to start with, and why.
    pub fn guessed_camera(&self) -> (Intrinsics, CameraOrigin) {
        match self.exif_focal {
            Some(ExifFocal { focal_px, source }) => {
                (Intrinsics::from_focal(focal_px, self.width, self.height), CameraOrigin::Exif(source))
            }
            None => (
                Intrinsics::from_horizontal_fov(ASSUMED_FIELD_OF_VIEW_RAD, self.width, self.height),
                CameraOrigin::AssumedFieldOfView,
            ),
        }
    }
}

/// A file that a mesh's file asks for: a material library, a texture, a buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompanionFile {
    pub file_name: String,
    pub bytes: Arc<[u8]>,
}

/// A mesh's file, parsed, with what picking needs.
#[derive(Debug)]
pub struct MeshAsset {
    pub file_name: String,
    pub sha256: Sha256,
    pub bytes: Arc<[u8]>,
    /// Kept, so that the mesh looks the same when it is opened again.
    pub companions: Vec<CompanionFile>,
    pub mesh: Mesh,
    pub search_tree: SearchTree,
    /// The mesh as its file has it, where this one is transformed, and how it is: going back loses no digit.
    pub untransformed: Option<(Arc<Self>, DAffine3)>,
    /// For whoever draws it first.
    pub drawn: DrawnAhead,
}

impl MeshAsset {
    /// What mesh and search tree take in memory, roughly: positions, triangles, attributes and two tree nodes a triangle; of
    /// what it was made from, nothing.
    pub fn memory_bytes(&self) -> usize {
        const BYTES_PER_VERTEX: usize = 12 + 12 + 4;
        const BYTES_PER_TRIANGLE: usize = 12 + 2 * 32;
        let (vertices, triangles) = (self.mesh.positions_mm().len(), self.mesh.triangles().len());
        vertices * BYTES_PER_VERTEX + triangles * BYTES_PER_TRIANGLE
    }

    /// The tree of the present mesh; `None` for the moment in which the worker makes it.
    pub fn tree(&self) -> Option<&Bvh> {
        match &self.untransformed {
            Some((source, transform)) => {
                self.search_tree.of_transformed(&self.mesh, (&source.search_tree, &source.mesh), transform)
            }
            None => self.search_tree.of(&self.mesh),
        }
    }

    /// What the file says of the unit of its numbers.
    pub fn file_unit(&self) -> FileUnit {
        FileUnit::of(&self.bytes)
    }

    /// The same file under another transform from its numbers to the `object` frame.
    pub fn with_mesh_from_file(
        self: &Arc<Self>,
        present: DMat4,
        wanted: DMat4,
    ) -> Result<Arc<Self>, MeshError> {
        // Only a mesh that nobody has transformed yet has no other behind it.
        let (source, present) = match &self.untransformed {
            Some((source, _)) => (source, DMat4::IDENTITY),
            None => (self, present),
        };
        if wanted == present {
            return Ok(source.clone());
        }
        let transform = DAffine3::from_mat4(wanted * present.inverse());
        let mesh = source.mesh.transformed(&transform)?;
        Ok(Arc::new(Self {
            file_name: self.file_name.clone(),
            sha256: self.sha256,
            bytes: self.bytes.clone(),
            companions: self.companions.clone(),
            search_tree: SearchTree::default(),
            mesh,
            untransformed: Some((source.clone(), transform)),
            drawn: DrawnAhead::default(),
        }))
    }
}

impl PartialEq for MeshAsset {
    /// The content decides: the mesh follows from the bytes, and its looks from how many companions were there.
    fn eq(&self, other: &Self) -> bool {
        self.sha256 == other.sha256
            && self.file_name == other.file_name
            && self.companions.len() == other.companions.len()
    }
}
