//! Work that would hold up a frame: photos and meshes are read on another thread.
//!
//! Requests and replies cross as bytes, for a page's worker shares no memory with it; natively the same bytes go to a
//! thread, so that one path is tested.

mod wire;

use std::collections::HashMap;
use std::sync::Arc;

use crate::formats::{NamedFile, read_mesh, read_photo};
use crate::mesh::{Bvh, Material, Mesh, MeshData, Paint};
use crate::photo::Pixels;
use crate::platform::Background;
use crate::scene::{MeshAsset, PhotoAsset, Sha256};

use wire::{Reader, Writer};

/// A material without texture, on the wire.
const NO_TEXTURE: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobKind {
    Photo,
    Mesh,
}

/// What a job made of a file.
pub enum Done {
    Photo(Arc<PhotoAsset>, Arc<Pixels>),
    Mesh(Arc<MeshAsset>, Vec<String>),
}

/// The jobs that are under way.
pub struct Jobs {
    background: Background,
    next_id: u64,
    files: HashMap<u64, (JobKind, NamedFile)>,
}

impl Jobs {
    pub fn new(ctx: &egui::Context) -> Self {
        let ctx = ctx.clone();
        Self {
            background: Background::new(run_job, move || ctx.request_repaint()),
            next_id: 0,
            files: HashMap::new(),
        }
    }

    pub fn submit(&mut self, kind: JobKind, file: NamedFile) -> u64 {
        self.next_id += 1;
        let mut request = Writer::default();
        request.byte(if kind == JobKind::Photo { 0 } else { 1 });
        request.bytes(file.name.as_bytes());
        request.bytes(&file.bytes);
        self.background.submit(self.next_id, request.finish());
        self.files.insert(self.next_id, (kind, file));
        self.next_id
    }

    /// What has come back since the last call; an error is a sentence without the file's name.
    pub fn poll(&mut self) -> Vec<(u64, NamedFile, Result<Done, String>)> {
        let replies = self.background.poll().into_iter();
        let known = replies.filter_map(|(id, reply)| Some((id, self.files.remove(&id)?, reply)));
        known
            .map(|(id, (kind, file), reply)| {
                let done = match reply {
                    Ok(bytes) => read_reply(kind, &file, &bytes),
                    Err(crash) => Err(format!("reading it crashed ({crash}); please report this file")),
                };
                (id, file, done)
            })
            .collect()
    }
}

/// Runs one job: in the worker, or on the other thread.
pub fn run_job(request: &[u8]) -> Vec<u8> {
    let mut reply = Writer::default();
    match answer(request) {
        Some(Ok(bytes)) => {
            reply.byte(1);
            reply.raw(&bytes);
        }
        Some(Err(message)) => {
            reply.byte(0);
            reply.bytes(message.as_bytes());
        }
        None => {
            reply.byte(0);
            reply.bytes(b"the request to the worker was damaged");
        }
    }
    reply.finish()
}

fn answer(request: &[u8]) -> Option<Result<Vec<u8>, String>> {
    let mut request = Reader::new(request);
    let kind = request.byte()?;
    let name = String::from_utf8(request.bytes()?.to_vec()).ok()?;
    let file = NamedFile { name, bytes: Arc::from(request.bytes()?) };
    Some(match kind {
        0 => read_photo(&file)
            .map(|(asset, pixels)| write_photo(&asset, &pixels))
            .map_err(|error| error.to_string()),
        _ => read_mesh(&file)
            .map(|(asset, warnings)| write_mesh(&asset, &warnings))
            .map_err(|error| error.to_string()),
    })
}

fn read_reply(kind: JobKind, file: &NamedFile, reply: &[u8]) -> Result<Done, String> {
    let mut reader = Reader::new(reply);
    let done = match reader.byte() {
        Some(1) if kind == JobKind::Photo => read_photo_reply(file, &mut reader),
        Some(1) => read_mesh_reply(file, &mut reader),
        _ => {
            let message = reader.bytes().map(|bytes| String::from_utf8_lossy(bytes).into_owned());
            return Err(message.unwrap_or_else(|| "the worker's reply was damaged".to_owned()));
        }
    };
    done.ok_or_else(|| "the worker's reply was damaged".to_owned())
}

fn write_photo(asset: &PhotoAsset, pixels: &Pixels) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.bytes(asset.sha256.to_string().as_bytes());
    writer.number(asset.exif_focal_px.unwrap_or(0.0));
    writer.number(f64::from(pixels.width));
    writer.number(f64::from(pixels.height));
    writer.bytes(&pixels.rgba);
    writer.finish()
}

fn read_photo_reply(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let exif_focal_px = Some(reader.number()?).filter(|focal_px| *focal_px > 0.0);
    let (width, height) = (reader.number()? as u32, reader.number()? as u32);
    let pixels = Pixels { width, height, rgba: reader.bytes()?.to_vec() };
    let asset = PhotoAsset {
        file_name: file.name.clone(),
        sha256,
        bytes: file.bytes.clone(),
        width,
        height,
        exif_focal_px,
    };
    Some(Done::Photo(Arc::new(asset), Arc::new(pixels)))
}

fn write_mesh(asset: &MeshAsset, warnings: &[String]) -> Vec<u8> {
    let data = asset.mesh.data();
    let (nodes, order) = asset.bvh.to_parts();
    let mut writer = Writer::default();
    writer.bytes(asset.sha256.to_string().as_bytes());
    writer.items(&data.positions_mm);
    writer.items(&data.triangles);
    writer.items(data.normals.as_deref().unwrap_or_default());
    writer.items(data.colors.as_deref().unwrap_or_default());
    write_paint(&mut writer, data.paint.as_ref().unwrap_or(&Paint::default()));
    writer.bytes(nodes);
    writer.items(order);
    writer.bytes(warnings.join("\n").as_bytes());
    writer.finish()
}

fn write_paint(writer: &mut Writer, paint: &Paint) {
    writer.items(&paint.corner_uvs);
    writer.items(&paint.material_of_triangle);
    let colors: Vec<[u8; 4]> = paint.materials.iter().map(|material| material.base_color).collect();
    let textures: Vec<u32> =
        paint.materials.iter().map(|material| material.texture.unwrap_or(NO_TEXTURE)).collect();
    writer.items(&colors);
    writer.items(&textures);
    writer.number(paint.textures.len() as f64);
    for texture in &paint.textures {
        writer.number(f64::from(texture.width));
        writer.number(f64::from(texture.height));
        writer.bytes(&texture.rgba);
    }
}

fn read_paint(reader: &mut Reader<'_>) -> Option<Paint> {
    let (corner_uvs, material_of_triangle) = (reader.items()?, reader.items()?);
    let (colors, texture_numbers): (Vec<[u8; 4]>, Vec<u32>) = (reader.items()?, reader.items()?);
    let materials = colors.into_iter().zip(texture_numbers).map(|(base_color, texture)| Material {
        base_color,
        texture: Some(texture).filter(|&texture| texture != NO_TEXTURE),
    });
    let texture_count = reader.number()? as usize;
    let mut textures = Vec::new();
    for _ in 0..texture_count {
        let (width, height) = (reader.number()? as u32, reader.number()? as u32);
        textures.push(Arc::new(Pixels { width, height, rgba: reader.bytes()?.to_vec() }));
    }
    Some(Paint { corner_uvs, material_of_triangle, materials: materials.collect(), textures })
}

fn read_mesh_reply(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let data = MeshData {
        positions_mm: reader.items()?,
        triangles: reader.items()?,
        normals: Some(reader.items()?).filter(|normals| !normals.is_empty()),
        colors: Some(reader.items()?).filter(|colors| !colors.is_empty()),
        paint: Some(read_paint(reader)?).filter(|paint| !paint.materials.is_empty()),
    };
    let bvh = Bvh::from_parts(reader.bytes()?, reader.items()?)?;
    let warnings = String::from_utf8(reader.bytes()?.to_vec()).ok()?;
    let asset = MeshAsset {
        file_name: file.name.clone(),
        sha256,
        bytes: file.bytes.clone(),
        mesh: Mesh::new(data).ok()?,
        bvh,
    };
    Some(Done::Mesh(Arc::new(asset), warnings.lines().map(str::to_owned).collect()))
}

fn read_hash(reader: &mut Reader<'_>) -> Option<Sha256> {
    std::str::from_utf8(reader.bytes()?).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(kind: JobKind, name: &str, bytes: &[u8]) -> Result<Done, String> {
        let file = NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) };
        let mut request = Writer::default();
        request.byte(if kind == JobKind::Photo { 0 } else { 1 });
        request.bytes(file.name.as_bytes());
        request.bytes(&file.bytes);
        read_reply(kind, &file, &run_job(&request.finish()))
    }

    #[test]
    fn a_mesh_survives_the_way_through_the_worker() {
        let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n";
        let Ok(Done::Mesh(asset, _)) = run(JobKind::Mesh, "corner.obj", obj) else { panic!("no mesh") };
        let file = NamedFile { name: "corner.obj".to_owned(), bytes: Arc::from(&obj[..]) };
        let (expected, _) = read_mesh(&file).unwrap();
        assert_eq!(asset.mesh, expected.mesh);
        assert_eq!(asset.bvh.to_parts(), expected.bvh.to_parts());
    }

    #[test]
    fn errors_come_back_in_words() {
        let error = run(JobKind::Photo, "a.png", b"nothing").err().unwrap();
        assert!(error.contains("PNG or JPEG"), "{error}");
        assert!(run_job(&[1, 2, 3]).len() > 1);
    }
}
