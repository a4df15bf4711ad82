//! Work that would hold up a frame: photos and meshes are read on another thread.
//!
//! Requests and replies cross as bytes, for a page's worker shares no memory with it; natively the same bytes go to a
//! thread, so that one path is tested.

mod wire;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use crate::formats::{NamedFile, read_mesh, read_photo};
use crate::mesh::{Bvh, Mesh, MeshData};
use crate::photo::{Pixels, decode, thumbnail};
use crate::platform::Background;
use crate::scene::{MeshAsset, PhotoAsset, Sha256};
use crate::ui::THUMBNAIL_SIDE_PX;

use wire::{Reader, Writer};

/// So many jobs are with the worker at once: it always has the next one, and what is cancelled is hardly begun.
const MOST_SENT: usize = 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobKind {
    Photo,
    Mesh,
    Thumbnail,
}

impl JobKind {
    fn code(self) -> u8 {
        match self {
            Self::Photo => 0,
            Self::Mesh => 1,
            Self::Thumbnail => 2,
        }
    }
}

/// Which of the waiting jobs is next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Urgency {
    /// The user looks at the place where it belongs.
    Next,
    InTurn,
}

/// What a job made of a file.
pub enum Done {
    Photo(Arc<PhotoAsset>, Arc<Pixels>),
    Mesh(Arc<MeshAsset>, Vec<String>),
    Thumbnail(Pixels),
}

/// The jobs that are under way.
pub struct Jobs {
    background: Background,
    next_id: u64,
    waiting: VecDeque<(u64, JobKind, NamedFile)>,
    sent: HashMap<u64, (JobKind, NamedFile)>,
}

impl Jobs {
    pub fn new(ctx: &egui::Context) -> Self {
        let ctx = ctx.clone();
        Self {
            background: Background::new(run_job, move || ctx.request_repaint()),
            next_id: 0,
            waiting: VecDeque::new(),
            sent: HashMap::new(),
        }
    }

    pub fn submit(&mut self, kind: JobKind, file: NamedFile, urgency: Urgency) -> u64 {
        self.next_id += 1;
        let job = (self.next_id, kind, file);
        match urgency {
            Urgency::Next => self.waiting.push_front(job),
            Urgency::InTurn => self.waiting.push_back(job),
        }
        self.send_next();
        self.next_id
    }

    /// Forgets jobs: those that wait are not begun, and what comes of the others is nobody's.
    pub fn cancel(&mut self, is_cancelled: impl Fn(u64) -> bool) {
        self.waiting.retain(|(id, ..)| !is_cancelled(*id));
        self.send_next();
    }

    pub fn is_idle(&self) -> bool {
        self.sent.is_empty()
    }

    fn send_next(&mut self) {
        while self.sent.len() < MOST_SENT {
            let Some((id, kind, file)) = self.waiting.pop_front() else { return };
            self.background.submit(id, write_request(kind, &file));
            self.sent.insert(id, (kind, file));
        }
    }

    /// What has come back since the last call; an error is a sentence without the file's name.
    pub fn poll(&mut self) -> Vec<(u64, NamedFile, Result<Done, String>)> {
        let replies = self.background.poll().into_iter();
        let known = replies.filter_map(|(id, reply)| Some((id, self.sent.remove(&id)?, reply)));
        let done = known
            .map(|(id, (kind, file), reply)| {
                let done = match reply {
                    Ok(bytes) => read_reply(kind, &file, &bytes),
                    Err(crash) => Err(format!("reading it crashed ({crash}); please report this file")),
                };
                (id, file, done)
            })
            .collect();
        self.send_next();
        done
    }
}

fn write_request(kind: JobKind, file: &NamedFile) -> Vec<u8> {
    let mut request = Writer::default();
    request.byte(kind.code());
    request.bytes(file.name.as_bytes());
    request.bytes(&file.bytes);
    request.finish()
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
        2 => decode(&file.bytes)
            .map(|photo| write_pixels(&thumbnail(&photo.pixels, THUMBNAIL_SIDE_PX)))
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
        Some(1) if kind == JobKind::Thumbnail => read_pixels(&mut reader).map(Done::Thumbnail),
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
    writer.raw(&write_pixels(pixels));
    writer.finish()
}

fn write_pixels(pixels: &Pixels) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.number(f64::from(pixels.width));
    writer.number(f64::from(pixels.height));
    writer.bytes(&pixels.rgba);
    writer.finish()
}

fn read_pixels(reader: &mut Reader<'_>) -> Option<Pixels> {
    let (width, height) = (reader.number()? as u32, reader.number()? as u32);
    let rgba = reader.bytes()?.to_vec();
    // A texture of another size than its bytes would be a crash.
    (rgba.len() as u64 == 4 * u64::from(width) * u64::from(height)).then_some(Pixels { width, height, rgba })
}

fn read_photo_reply(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let exif_focal_px = Some(reader.number()?).filter(|focal_px| *focal_px > 0.0);
    let pixels = read_pixels(reader)?;
    let (width, height) = (pixels.width, pixels.height);
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
    writer.bytes(nodes);
    writer.items(order);
    writer.bytes(warnings.join("\n").as_bytes());
    writer.finish()
}

fn read_mesh_reply(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let data = MeshData {
        positions_mm: reader.items()?,
        triangles: reader.items()?,
        normals: Some(reader.items()?).filter(|normals| !normals.is_empty()),
        colors: Some(reader.items()?).filter(|colors| !colors.is_empty()),
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
        read_reply(kind, &file, &run_job(&write_request(kind, &file)))
    }

    #[test]
    fn a_thumbnail_is_small_and_keeps_the_shape() {
        let pixels = Pixels { width: 400, height: 100, rgba: [10, 20, 30, 255].repeat(40_000) };
        let png = crate::photo::png_rgba(&pixels).unwrap();
        let Ok(Done::Thumbnail(small)) = run(JobKind::Thumbnail, "wide.png", &png) else {
            panic!("no thumbnail")
        };
        assert_eq!((small.width, small.height), (160, 40));
        assert!(small.rgba.chunks(4).all(|pixel| pixel == [10, 20, 30, 255]));
        assert!(run(JobKind::Thumbnail, "a.png", b"nothing").is_err());
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
