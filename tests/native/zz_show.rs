//! Temporary: pictures to look at, and times.
use crate::support::*;
use glam::{DMat3, DQuat, DVec3, Vec3};
use pinpose::math::{Intrinsics, Pose};
use pinpose::mesh::{Bvh, Mesh, MeshData};
use pinpose::photo::{decode, png_rgba};
use pinpose::render::*;
use pinpose::scene::*;
use std::sync::Arc;
use std::time::Instant;

#[test]
#[ignore]
fn zz_pictures() {
    let session = linemod_session().unwrap();
    let mut renderer = renderer().unwrap();
    let scene = session.scene();
    let n: usize = std::env::var("ZZ_PHOTO").ok().map_or(0, |v| v.parse().unwrap());
    let photo = &scene.photos[n];
    let pixels = Arc::new(decode(&photo.asset.bytes).unwrap().pixels);
    let id = scene.objects_in(photo.id).next().unwrap().0.id;
    let mesh = &scene.object(id).unwrap().mesh.mesh;
    println!("{} tris colors {:?}", mesh.triangles().len(), mesh.colors().is_some());
    let save = |renderer: &mut Renderer, picture: &Picture, size: [u32; 2], name: &str| {
        let p = renderer.draw_and_read(picture, size, Layer::Picture).wait(renderer.gpu()).unwrap();
        std::fs::write(format!("/tmp/render-look/{name}.png"), png_rgba(&p).unwrap()).unwrap();
    };
    let pose = scene.annotation(photo.id, id).unwrap().camera_from_object;
    let subject = |look| Subject {
        look,
        selected: Some(id),
        pixels_per_point: 2.0,
        ..Subject::new(scene, photo.id, Some(pixels.clone()))
    };
    let zoomed = |p: &mut Picture| {
        let c = photo
            .camera
            .project(pose.transform_point(scene.object(id).unwrap().mesh.mesh.sphere().center))
            .unwrap();
        let h = glam::DVec2::new(120.0, 90.0);
        p.rect.min = c - h;
        p.rect.max = c + h;
    };
    for (mode, name, _) in OverlayMode::ALL {
        let mut p = picture_of(&subject(Look { mode, ..Look::default() })).unwrap();
        zoomed(&mut p);
        save(&mut renderer, &p, [800, 600], name);
    }
    let mut p = picture_of(&subject(Look {
        wipe: Some(0.5),
        photo: PhotoAdjustment { brightness: 0.1, contrast: 0.3, saturation: -0.5 },
        ..Look::default()
    }))
    .unwrap();
    zoomed(&mut p);
    save(&mut renderer, &p, [800, 600], "wipe");
    let mut p = picture_of(&subject(Look {
        mode: OverlayMode::Colors,
        difference: true,
        outline: false,
        ..Look::default()
    }))
    .unwrap();
    zoomed(&mut p);
    save(&mut renderer, &p, [800, 600], "difference");
    // x-ray: a second object behind
    let mut two = scene.clone();
    let other = scene.objects.iter().find(|o| o.id != id).unwrap().id;
    two.place(photo.id, other, 0.0);
    two.annotations.get_mut(&(photo.id, other)).unwrap().camera_from_object =
        Pose { translation_mm: pose.translation_mm + DVec3::new(60.0, 20.0, 130.0), ..pose };
    for mode in [OverlayMode::Shaded, OverlayMode::Edges] {
        let look = Look { mode, x_ray: true, ..Look::default() };
        let mut p = picture_of(&Subject {
            look,
            selected: Some(id),
            pixels_per_point: 2.0,
            ..Subject::new(&two, photo.id, Some(pixels.clone()))
        })
        .unwrap();
        zoomed(&mut p);
        save(&mut renderer, &p, [800, 600], &format!("xray-{}", mode.name()));
    }
    let eye = Intrinsics::from_focal(1200.0, 1280, 800);
    for (name, yaw, pitch, d, mode) in [
        ("scene-a", -0.6, 0.35, 1.3, OverlayMode::Shaded),
        ("scene-b", 1.0, 0.2, 0.6, OverlayMode::Colors),
        ("scene-c", -2.4, 0.4, 1.3, OverlayMode::Edges),
    ] {
        let pivot = pose.translation_mm * 0.9;
        let rotation = DMat3::from_quat(DQuat::from_rotation_x(-pitch) * DQuat::from_rotation_y(yaw));
        let eye_from_camera =
            Pose { rotation, translation_mm: DVec3::Z * pivot.z * 1.1 * d - rotation * pivot };
        let view = FreeView {
            eye_from_camera,
            eye,
            image_distance_mm: pose.translation_mm.z * 1.15,
            photo_opacity: 0.95,
            other_cameras: vec![OtherCamera {
                camera_from_other_camera: Pose {
                    rotation: DMat3::from_rotation_y(-0.4),
                    translation_mm: DVec3::new(350.0, 60.0, 40.0),
                },
                camera: photo.camera,
                color: Rgb([240, 164, 40]),
            }],
        };
        let mut s = subject(Look { mode, ..Look::default() });
        s.pixels_per_point = 1.0;
        s.scene = &two;
        let p = scene_picture_of(&s, &view).unwrap();
        save(&mut renderer, &p, [1280, 800], name);
    }
}

fn sheet(side: u32) -> Mesh {
    let height = |x: u32, y: u32| ((x as f32 * 0.7).sin() + (y as f32 * 0.3).cos()) * 4.0;
    let scale = 160.0 / side as f32;
    let middle = side as f32 / 2.0;
    let positions_mm = (0..=side)
        .flat_map(|y| (0..=side).map(move |x| (x, y)))
        .map(|(x, y)| Vec3::new((x as f32 - middle) * scale, (y as f32 - middle) * scale, height(x, y)))
        .collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let triangles = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

#[test]
#[ignore]
fn zz_times() {
    let start = Instant::now();
    let mut renderer = renderer().unwrap();
    println!("ready {:?}", start.elapsed());
    let photo =
        Arc::new(pinpose::photo::Pixels { width: 1280, height: 800, rgba: vec![120; 1280 * 800 * 4] });
    for side in [32, 70, 707] {
        let mesh = sheet(side);
        let bvh = Bvh::build(&mesh);
        let asset = Arc::new(MeshAsset {
            file_name: "s".into(),
            sha256: Sha256::of(b"s"),
            bytes: Arc::from([]),
            mesh,
            bvh,
        });
        let camera = Intrinsics::from_focal(1200.0, 1280, 800);
        for (outline, mode) in [
            (true, OverlayMode::Shaded),
            (false, OverlayMode::Shaded),
            (true, OverlayMode::Outline),
            (true, OverlayMode::Colors),
            (false, OverlayMode::Edges),
            (false, OverlayMode::Wireframe),
        ] {
            let mut p = crate::gpu_and_cpu::picture(
                camera,
                pinpose::math::ImageRect::of_photo(1280, 800),
                asset.clone(),
                Pose::from_translation(DVec3::Z * 500.0),
            );
            p.photo = Some(PhotoLayer(photo.clone()));
            p.look.outline = outline;
            p.look.mode = mode;
            p.items[0].opacity = 0.7;
            let target = renderer.gpu().device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: 1280, height: 800, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            let view = target.create_view(&Default::default());
            let mut times = Vec::new();
            let mut cpu = Vec::new();
            for i in 0..8 {
                p.items[0].camera_from_object.translation_mm.x += 1.0;
                let start = Instant::now();
                let mut encoder = renderer.gpu().device.create_command_encoder(&Default::default());
                renderer.prepare(ViewSlot::Photo, &mut encoder, &p, [0, 0], [1280, 800]);
                {
                    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                        label: None,
                        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                            view: &view,
                            resolve_target: None,
                            ops: Default::default(),
                            depth_slice: None,
                        })],
                        ..Default::default()
                    });
                    renderer.paint(ViewSlot::Photo, &mut pass);
                }
                let commands = encoder.finish();
                renderer.gpu().queue.submit([commands]);
                let c = start.elapsed();
                renderer.gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
                if i > 1 {
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                    cpu.push(c.as_secs_f64() * 1e3);
                }
            }
            times.sort_by(f64::total_cmp);
            cpu.sort_by(f64::total_cmp);
            println!(
                "{} tris {mode:?} outline {outline}: frame {:.1} ms, cpu {:.2} ms",
                2 * side * side,
                times[3],
                cpu[3]
            );
        }
    }
}
