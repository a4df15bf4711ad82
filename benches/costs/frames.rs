//! What a frame costs: a drag step from the picture's data to finished pixels, and the program's own share of it.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use glam::{DMat3, DVec3};
use pinpose::math::{ImageRect, Intrinsics, Pose};
use pinpose::mesh::{Bvh, Mesh, MeshData};
use pinpose::photo::Pixels;
use pinpose::render::{Gpu, Item, LineWidths, PhotoLayer, Picture, Renderer, ViewSlot};
use pinpose::scene::{Look, MeshAsset, OverlayMode, Rgb, Sha256};

use crate::row;

const SIZE: [u32; 2] = [1280, 800];

/// Meshes by half their triangles' root, and the time that a step is held against: a frame at 30 a second, and half a second
/// for a scan, after which a drag no longer follows the hand.
const LIMIT_MS: [(u32, f64); 3] = [(32, 33.0), (70, 33.0), (707, 500.0)];

pub fn frames() {
    let start = Instant::now();
    let Ok(mut renderer) = Renderer::headless() else {
        println!("frames: no GPU and no software Vulkan driver is here");
        return;
    };
    let ready_ms = start.elapsed().as_secs_f64() * 1000.0;
    row("headless renderer ready", ready_ms, ready_ms, "itself");
    if let Some(peak_mib) = peak_memory_mib() {
        println!("{:<46}{peak_mib:>12.1}{:>10}  MiB", "peak memory with nothing loaded", "");
    }
    for (side, limit_ms) in LIMIT_MS {
        let mesh = asset(potato(side));
        let modes = [OverlayMode::Shaded, OverlayMode::Outline, OverlayMode::Edges, OverlayMode::Wireframe];
        // Surfaces alone are what other viewers draw; ours have an outline besides.
        for (mode, outline) in
            [(OverlayMode::Shaded, false)].into_iter().chain(modes.map(|mode| (mode, true)))
        {
            let mut picture = picture(&mesh, mode);
            picture.look.outline = outline;
            let Step { frame_ms, own_ms, processor_ms } = drag_step(&mut renderer, picture);
            let alone = if outline { "" } else { " alone" };
            let what = format!("drag step, {} triangles, {}{alone}", 2 * side * side, mode.name());
            row(&what, frame_ms, limit_ms, &format!("{limit_ms} ms"));
            row("  the program's own share", own_ms, frame_ms, "the whole step");
            if let Some(processor_ms) = processor_ms {
                row("  processor time, all threads", processor_ms, frame_ms, "the whole step");
            }
        }
    }
}

struct Step {
    /// The median time until the GPU is done.
    frame_ms: f64,
    /// The part until everything is handed over to it.
    own_ms: f64,
    /// The mean over all threads. A software GPU's work is in it, and other programs' is not.
    processor_ms: Option<f64>,
}

fn drag_step(renderer: &mut Renderer, mut picture: Picture) -> Step {
    let gpu = renderer.gpu().clone();
    let target = screen(&gpu);
    let mut times: Vec<(f64, f64)> = Vec::new();
    let mut processor_start_ms = None;
    for step in 0..12 {
        // The first steps upload the mesh and make pipelines.
        if step == 2 {
            processor_start_ms = processor_time_ms();
        }
        let pose = &mut picture.items[0].camera_from_object;
        pose.translation_mm.x += 1.0;
        let start = Instant::now();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        renderer.prepare(ViewSlot::Photo, &mut encoder, &picture, [0, 0], SIZE);
        paint(renderer, &mut encoder, &target);
        gpu.queue.submit([encoder.finish()]);
        let own_ms = start.elapsed().as_secs_f64() * 1000.0;
        black_box(gpu.device.poll(wgpu::PollType::wait_indefinitely()).is_ok());
        if step >= 2 {
            times.push((start.elapsed().as_secs_f64() * 1000.0, own_ms));
        }
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let processor_ms =
        processor_time_ms().zip(processor_start_ms).map(|(end, start)| (end - start) / times.len() as f64);
    Step {
        frame_ms: median(times.iter().map(|time| time.0).collect()),
        own_ms: median(times.iter().map(|time| time.1).collect()),
        processor_ms,
    }
}

/// The composition, as the interface's own pass calls it.
fn paint(renderer: &Renderer, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            resolve_target: None,
            ops: wgpu::Operations::default(),
            depth_slice: None,
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
    renderer.paint(ViewSlot::Photo, &mut pass);
}

fn screen(gpu: &Gpu) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("screen"),
        size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// A closed, bumpy surface of about `2 * side * side` triangles, 160 mm wide, as a scan of an object is.
#[expect(clippy::expect_used, reason = "the surface is made here")]
fn potato(side: u32) -> Mesh {
    let point = |x: u32, y: u32| {
        let azimuth = f64::from(x) / f64::from(side) * std::f64::consts::TAU;
        let polar = f64::from(y) / f64::from(side) * std::f64::consts::PI;
        let direction = DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
        let bumps = (5.0 * azimuth).sin() * polar.sin() + (7.0 * polar).cos();
        (direction * (68.0 + 6.0 * bumps)).as_vec3()
    };
    let corner = |x: u32, y: u32| y * side + x % side;
    let positions_mm = (0..=side).flat_map(|y| (0..side).map(move |x| point(x, y))).collect();
    let triangles = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, d, b], [b, d, c]]
        })
        .collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).expect("the surface is a mesh")
}

/// The mesh at 70 cm, turned a little: a third of the picture's height.
fn picture(mesh: &Arc<MeshAsset>, mode: OverlayMode) -> Picture {
    let camera = Intrinsics::from_focal(1200.0, SIZE[0], SIZE[1]);
    let pixels =
        Pixels { width: SIZE[0], height: SIZE[1], rgba: vec![128; (SIZE[0] * SIZE[1] * 4) as usize] };
    let pose = Pose { rotation: DMat3::from_rotation_x(0.5), translation_mm: DVec3::new(-10.0, 0.0, 700.0) };
    let item = Item {
        mesh: mesh.clone(),
        camera_from_object: pose,
        color: Rgb([152, 230, 60]),
        opacity: 0.7,
        id: 1,
        selected: true,
    };
    Picture {
        camera,
        eye_from_camera: Pose::IDENTITY,
        rect: ImageRect::of_photo(SIZE[0], SIZE[1]),
        photo: Some(PhotoLayer(Arc::new(pixels))),
        photo_opacity: 1.0,
        masks: None,
        occluder: None,
        items: vec![item],
        ghosts: Vec::new(),
        look: Look { mode, ..Look::default() },
        widths: LineWidths::for_scale(1.0),
        surroundings: None,
        background: Rgb([24, 26, 31]),
        in_motion: true,
    }
}

fn asset(mesh: Mesh) -> Arc<MeshAsset> {
    let bvh = Bvh::build(&mesh);
    let (file_name, bytes) = ("sheet".to_owned(), Arc::from([]));
    Arc::new(MeshAsset {
        file_name,
        sha256: Sha256::of(b"sheet"),
        bytes,
        companions: Vec::new(),
        mesh,
        search_tree: bvh.into(),
        untransformed: None,
        drawn: Default::default(),
    })
}

/// User and system time of all threads, in steps of 10 ms; Linux only.
fn processor_time_ms() -> Option<f64> {
    const MS_PER_TICK: f64 = 10.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // After the program's name, which may hold anything, the two are fields 14 and 15 of the line.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) * MS_PER_TICK)
}

/// What the system says of this process; Linux only.
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1024.0)
}
