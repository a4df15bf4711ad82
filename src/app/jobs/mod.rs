//! Work that would hold up a frame: photos and meshes are read on another thread.
//!
//! Requests and replies cross as bytes, for a page's worker shares no memory with it; natively the same bytes go to a
//! thread, so that one path is tested.

mod mesh;
mod mesh_rest;
mod solver_mesh;
pub mod symmetries;
mod wire;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use crate::formats::{NamedFile, read_mesh_with, read_photo, read_photo_header};
use crate::mesh::{Bvh, Mesh, ShadingMesh};
use crate::photo::{DepthPixels, Pixels, decode, decode_depth, thumbnail};
use crate::platform::Background;
use crate::scene::{MeshAsset, PhotoAsset, Sha256};
use crate::solve::symmetry::FoundSymmetries;
use crate::ui::THUMBNAIL_SIDE_PX;

use mesh::{read_mesh_reply, write_mesh};
use wire::{Reader, Writer};

/// So many jobs are with the worker at once: it always has the next one, and what is cancelled is hardly begun.
const MOST_SENT: usize = 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobKind {
    Photo,
    Mesh,
    Thumbnail,
    DepthMap,
    /// Of a file and all of its companions, which are images as it is: sizes and hashes, nothing decoded.
    Headers,
    /// Of a mesh's file.
    SolverMesh,
    /// Of what [`symmetries::request`] makes of a mesh.
    Symmetries,
    /// Of what [`mesh_rest::request`] makes of a mesh.
    MeshRest,
}

impl JobKind {
    fn code(self) -> u8 {
        match self {
            Self::Photo => 0,
            Self::Mesh => 1,
            Self::Thumbnail => 2,
            Self::DepthMap => 3,
            Self::Headers => 4,
            Self::SolverMesh => 5,
            Self::Symmetries => 6,
            Self::MeshRest => 7,
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
    DepthMap(Arc<PhotoAsset>, Arc<DepthPixels>),
    /// In the order of the files; an error names its file.
    Headers(Vec<Result<Arc<PhotoAsset>, String>>),
    SolverMesh(Arc<Mesh>),
    Symmetries(FoundSymmetries),
    /// Nobody is told: the mesh has it.
    MeshRest(Box<(Bvh, ShadingMesh)>),
}

/// What is asked of the worker.
struct Job {
    kind: JobKind,
    file: NamedFile,
    companions: Vec<NamedFile>,
}

/// The jobs that are under way.
pub struct Jobs {
    background: Background,
    next_id: u64,
    waiting: VecDeque<(u64, Job)>,
    sent: HashMap<u64, Job>,
    /// Meshes whose rest is asked for once a frame has shown them.
    just_come: Vec<Arc<MeshAsset>>,
    /// Meshes that are shown, and whose rest follows.
    unfinished: HashMap<u64, Arc<MeshAsset>>,
    ctx: egui::Context,
}

impl Jobs {
    pub fn new(ctx: &egui::Context) -> Self {
        let waker = ctx.clone();
        Self {
            background: Background::new(run_job, move || waker.request_repaint()),
            next_id: 0,
            waiting: VecDeque::new(),
            sent: HashMap::new(),
            just_come: Vec::new(),
            unfinished: HashMap::new(),
            ctx: ctx.clone(),
        }
    }

    /// `companions` are the files that a mesh asks for.
    pub fn submit(
        &mut self,
        kind: JobKind,
        file: NamedFile,
        companions: &[NamedFile],
        urgency: Urgency,
    ) -> u64 {
        self.next_id += 1;
        let job = (self.next_id, Job { kind, file, companions: companions.to_vec() });
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
            let Some((id, job)) = self.waiting.pop_front() else { return };
            self.background.submit(id, write_request(job.kind, &job.file, &job.companions));
            self.sent.insert(id, job);
        }
    }

    /// What has come back since the last call; an error is a sentence without the file's name.
    pub fn poll(&mut self) -> Vec<(u64, NamedFile, Result<Done, String>)> {
        for mesh in std::mem::take(&mut self.just_come) {
            self.ask_for_rest(mesh);
        }
        let replies = self.background.poll().into_iter();
        let known = replies.filter_map(|(id, reply)| Some((id, self.sent.remove(&id)?, reply)));
        let all: Vec<_> = known
            .map(|(id, Job { kind, file, companions }, reply)| {
                let done = match reply {
                    Ok(bytes) => read_reply(kind, &file, &companions, &bytes),
                    Err(crash) => Err(format!("reading it crashed ({crash}); please report this file")),
                };
                (id, file, done)
            })
            .collect();
        let done = all.into_iter().filter_map(|(id, file, done)| {
            let done = self.take_rest(id, done)?;
            if let Ok(Done::Mesh(mesh, _)) = &done
                && mesh.search_tree.is_awaited()
            {
                self.just_come.push(mesh.clone());
                self.ctx.request_repaint();
            }
            Some((id, file, done))
        });
        let done = done.collect();
        self.send_next();
        done
    }

    /// Is the rest of a mesh that is shown still on its way?
    pub fn is_finishing_mesh(&self) -> bool {
        !self.just_come.is_empty() || !self.unfinished.is_empty()
    }

    fn ask_for_rest(&mut self, mesh: Arc<MeshAsset>) {
        let job = self.submit(JobKind::MeshRest, mesh_rest::request(&mesh), &[], Urgency::Next);
        self.unfinished.insert(job, mesh);
    }

    /// Gives a mesh its rest; gives back what is none.
    fn take_rest(&mut self, job: u64, done: Result<Done, String>) -> Option<Result<Done, String>> {
        let Some(mesh) = self.unfinished.remove(&job) else { return Some(done) };
        if let Ok(Done::MeshRest(rest)) = done {
            let (tree, shading) = *rest;
            mesh.search_tree.give(tree);
            mesh.drawn.give_whole(shading);
        } else {
            log::warn!("{}: what follows a large mesh was not made ({:?})", mesh.file_name, done.err());
            mesh.search_tree.withdraw();
            mesh.drawn.withdraw();
        }
        None
    }
}

fn write_request(kind: JobKind, file: &NamedFile, companions: &[NamedFile]) -> Vec<u8> {
    let all = || std::iter::once(file).chain(companions);
    let mut request = Writer::for_bytes(all().map(|file| file.name.len() + file.bytes.len() + 32).sum());
    request.byte(kind.code());
    for NamedFile { name, bytes } in all() {
        request.byte(1);
        request.bytes(name.as_bytes());
        request.bytes(bytes);
    }
    request.byte(0);
    request.finish()
}

/// The kind of job, the file, and its companions.
fn read_request(request: &[u8]) -> Option<(u8, NamedFile, Vec<NamedFile>)> {
    let mut request = Reader::new(request);
    let kind = request.byte()?;
    let mut files = Vec::new();
    while request.byte()? == 1 {
        let name = String::from_utf8(request.bytes()?.to_vec()).ok()?;
        files.push(NamedFile { name, bytes: Arc::from(request.bytes()?) });
    }
    let mut files = files.into_iter();
    Some((kind, files.next()?, files.collect()))
}

/// Runs one job: in the worker, or on the other thread.
pub fn run_job(request: &[u8]) -> Vec<u8> {
    let damaged = || Err("the request to the worker was damaged".to_owned());
    let (mut reply, is_done) = match answer(request).unwrap_or_else(damaged) {
        Ok(bytes) => (bytes, true),
        Err(message) => (message.into_bytes(), false),
    };
    // Last, where it moves nothing: a mesh is a hundred megabytes.
    reply.push(u8::from(is_done));
    reply
}

fn answer(request: &[u8]) -> Option<Result<Vec<u8>, String>> {
    let (kind, file, companions) = read_request(request)?;
    Some(match kind {
        0 => read_photo(&file)
            .map(|(asset, pixels)| write_photo(&asset, &pixels))
            .map_err(|error| error.to_string()),
        2 => decode(&file.bytes)
            .map(|photo| write_pixels(&thumbnail(&photo.pixels, THUMBNAIL_SIDE_PX)))
            .map_err(|error| error.to_string()),
        3 => decode_depth(&file.bytes)
            .map(|depth| write_depth(&file, &depth))
            .map_err(|error| error.to_string()),
        4 => Ok(write_headers(std::iter::once(&file).chain(&companions))),
        5 => solver_mesh::write(&file, &companions),
        6 => symmetries::write(&file),
        7 => mesh_rest::write(&file),
        _ => read_mesh_with(&file, &companions)
            .map(|(asset, warnings)| write_mesh(&asset, &warnings))
            .map_err(|error| error.to_string()),
    })
}

fn read_reply(
    kind: JobKind,
    file: &NamedFile,
    companions: &[NamedFile],
    reply: &[u8],
) -> Result<Done, String> {
    let damaged = || "the worker's reply was damaged".to_owned();
    let (is_done, body) = reply.split_last().ok_or_else(damaged)?;
    if *is_done != 1 {
        return Err(String::from_utf8_lossy(body).into_owned());
    }
    let mut reader = Reader::new(body);
    let done = match kind {
        JobKind::Photo => read_photo_reply(file, &mut reader),
        JobKind::Thumbnail => read_pixels(&mut reader).map(Done::Thumbnail),
        JobKind::DepthMap => read_depth_reply(file, &mut reader),
        JobKind::Headers => {
            read_headers(std::iter::once(file).chain(companions), &mut reader).map(Done::Headers)
        }
        JobKind::SolverMesh => solver_mesh::read(&mut reader).map(|mesh| Done::SolverMesh(Arc::new(mesh))),
        JobKind::Symmetries => symmetries::read(&mut reader).map(Done::Symmetries),
        JobKind::MeshRest => mesh_rest::read(&mut reader).map(|rest| Done::MeshRest(Box::new(rest))),
        JobKind::Mesh => read_mesh_reply(file, companions, &mut reader),
    };
    done.ok_or_else(damaged)
}

fn write_photo(asset: &PhotoAsset, pixels: &Pixels) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.bytes(asset.sha256.to_string().as_bytes());
    writer.focal(asset.exif_focal);
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
    let exif_focal = reader.focal()?;
    let pixels = read_pixels(reader)?;
    let (width, height) = (pixels.width, pixels.height);
    let asset = PhotoAsset {
        file_name: file.name.clone(),
        sha256,
        bytes: file.bytes.clone(),
        width,
        height,
        exif_focal,
    };
    Some(Done::Photo(Arc::new(asset), Arc::new(pixels)))
}

fn write_headers<'a>(files: impl Iterator<Item = &'a NamedFile>) -> Vec<u8> {
    let mut writer = Writer::default();
    for file in files {
        match read_photo_header(file) {
            Ok(asset) => {
                writer.byte(1);
                writer.bytes(asset.sha256.to_string().as_bytes());
                writer.number(f64::from(asset.width));
                writer.number(f64::from(asset.height));
                writer.focal(asset.exif_focal);
            }
            Err(error) => {
                writer.byte(0);
                writer.bytes(error.to_string().as_bytes());
            }
        }
    }
    writer.finish()
}

fn read_headers<'a>(
    files: impl Iterator<Item = &'a NamedFile>,
    reader: &mut Reader<'_>,
) -> Option<Vec<Result<Arc<PhotoAsset>, String>>> {
    files.map(|file| read_header(file, reader)).collect()
}

fn read_header(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Result<Arc<PhotoAsset>, String>> {
    if reader.byte()? == 0 {
        let reason = String::from_utf8_lossy(reader.bytes()?);
        return Some(Err(format!("{}: {reason}", file.name)));
    }
    let sha256 = read_hash(reader)?;
    let (width, height) = (reader.number()? as u32, reader.number()? as u32);
    let exif_focal = reader.focal()?;
    let (file_name, bytes) = (file.name.clone(), file.bytes.clone());
    Some(Ok(Arc::new(PhotoAsset { file_name, sha256, bytes, width, height, exif_focal })))
}

fn write_depth(file: &NamedFile, depth: &DepthPixels) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.bytes(Sha256::of(&file.bytes).to_string().as_bytes());
    writer.number(f64::from(depth.width));
    writer.number(f64::from(depth.height));
    writer.items(&depth.raw);
    writer.finish()
}

fn read_depth_reply(file: &NamedFile, reader: &mut Reader<'_>) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let (width, height) = (reader.number()? as u32, reader.number()? as u32);
    let raw: Vec<u16> = reader.items()?;
    let depth = DepthPixels { width, height, raw };
    let is_whole = depth.raw.len() as u64 == u64::from(width) * u64::from(height);
    let (file_name, bytes) = (file.name.clone(), file.bytes.clone());
    let asset = PhotoAsset { file_name, sha256, bytes, width, height, exif_focal: None };
    is_whole.then(|| Done::DepthMap(Arc::new(asset), Arc::new(depth)))
}

fn read_hash(reader: &mut Reader<'_>) -> Option<Sha256> {
    std::str::from_utf8(reader.bytes()?).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, bytes: &[u8]) -> NamedFile {
        NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) }
    }

    fn run(kind: JobKind, file: &NamedFile, companions: &[NamedFile]) -> Result<Done, String> {
        read_reply(kind, file, companions, &run_job(&write_request(kind, file, companions)))
    }

    #[test]
    fn a_thumbnail_is_small_and_keeps_the_shape() {
        let pixels = Pixels { width: 400, height: 100, rgba: [10, 20, 30, 255].repeat(40_000) };
        let png = crate::photo::png_rgba(&pixels).unwrap();
        let Ok(Done::Thumbnail(small)) = run(JobKind::Thumbnail, &file("wide.png", &png), &[]) else {
            panic!("no thumbnail")
        };
        assert_eq!((small.width, small.height), (160, 40));
        assert!(small.rgba.chunks(4).all(|pixel| pixel == [10, 20, 30, 255]));
        assert!(run(JobKind::Thumbnail, &file("a.png", b"nothing"), &[]).is_err());
    }

    #[test]
    fn a_mesh_survives_the_way_through_the_worker() {
        let pixels = Pixels { width: 2, height: 1, rgba: vec![9, 8, 7, 255, 0, 0, 0, 255] };
        let companions = [
            file("a.mtl", b"newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd b.png\n"),
            file("B.png", &crate::photo::png_rgba(&pixels).unwrap()),
        ];
        let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.5 0\nusemtl b\nf 1/1 2 3\nusemtl a\nf 1 2 4\n";
        let obj = file("corner.obj", obj);
        let Ok(Done::Mesh(asset, _)) = run(JobKind::Mesh, &obj, &companions) else { panic!("no mesh") };
        let (expected, _) = read_mesh_with(&obj, &companions).unwrap();
        assert_eq!((&asset.mesh, &asset.companions), (&expected.mesh, &expected.companions));
        assert_eq!(*asset.mesh.paint().unwrap().textures[0], pixels);
        assert_eq!(asset.tree().unwrap().to_parts(), expected.tree().unwrap().to_parts());
    }

    #[test]
    fn a_large_mesh_comes_without_its_tree_which_follows() {
        let ply = crate::mesh::write_ply(&crate::mesh::test_shapes::sphere(100.0, 400, 800));
        let ply = file("ball.ply", &ply);
        let Ok(Done::Mesh(asset, _)) = run(JobKind::Mesh, &ply, &[]) else { panic!("no mesh") };
        assert!(asset.tree().is_none() && asset.drawn.is_fresh());
        let request = mesh_rest::request(&asset);
        let mut jobs = Jobs::new(&egui::Context::default());
        jobs.ask_for_rest(asset.clone());
        assert!(jobs.is_finishing_mesh());
        let rest = run(JobKind::MeshRest, &request, &[]);
        let (job, _) = jobs.unfinished.iter().next().unwrap();
        assert!(jobs.take_rest(*job, rest).is_none());
        let (expected, _) = read_mesh_with(&ply, &[]).unwrap();
        assert_eq!(asset.tree().unwrap().to_parts(), expected.tree().unwrap().to_parts());
        assert_eq!(asset.drawn.take_whole(), Some(crate::mesh::shading_vertices(&expected.mesh)));
        assert!(!jobs.is_finishing_mesh());
    }

    #[test]
    fn a_large_mesh_whose_rest_fails_makes_it_itself() {
        let ply = crate::mesh::write_ply(&crate::mesh::test_shapes::sphere(100.0, 400, 800));
        let Ok(Done::Mesh(asset, _)) = run(JobKind::Mesh, &file("ball.ply", &ply), &[]) else {
            panic!("no mesh")
        };
        let mut jobs = Jobs::new(&egui::Context::default());
        assert!(asset.tree().is_none());
        jobs.ask_for_rest(asset.clone());
        let (job, _) = jobs.unfinished.iter().next().unwrap();
        assert!(jobs.take_rest(*job, Err("it crashed".to_owned())).is_none());
        assert!(asset.tree().is_some());
    }

    #[test]
    fn headers_come_together_and_one_that_is_none_stands_alone() {
        let pixels = Pixels { width: 7, height: 3, rgba: [10, 20, 30, 255].repeat(21) };
        let png = crate::photo::png_rgba(&pixels).unwrap();
        let files = [file("b.png", b"nothing"), file("c.png", &png)];
        let Ok(Done::Headers(read)) = run(JobKind::Headers, &file("a/a.png", &png), &files) else {
            panic!("no headers")
        };
        let [Ok(first), Err(none), Ok(last)] = &read[..] else { panic!("{}", read.len()) };
        assert_eq!((first.file_name.as_str(), first.width, first.height), ("a/a.png", 7, 3));
        assert_eq!((first.sha256, &*last.bytes), (Sha256::of(&png), &png[..]));
        assert!(none.starts_with("b.png: ") && none.contains("PNG"), "{none}");
    }

    #[test]
    fn errors_come_back_in_words() {
        let error = run(JobKind::Photo, &file("a.png", b"nothing"), &[]).err().unwrap();
        assert!(error.contains("PNG, JPEG"), "{error}");
        assert!(run_job(&[1, 2, 3]).len() > 1);
    }
}
