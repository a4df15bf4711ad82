//! Each way to look at a scene, by counted and computed pixels.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec2, DVec3, Vec2, Vec3};
use pinpose::math::{Distortion, ImageRect, Intrinsics, Pose};
use pinpose::mesh::{Bvh, Material, Mesh, MeshData, Paint};
use pinpose::photo::{DepthPixels, Pixels};
use pinpose::render::{
    FreeView, Item, Layer, Line3, Occluder, PhotoLayer, PhotoPlane, Picture, PixelsPending, Renderer,
    Subject, Surroundings, ViewSlot, scene_picture_of,
};
use pinpose::scene::{Layers, Look, MeshAsset, OverlayMode, PhotoAdjustment, Rgb, Sha256};

use crate::gpu_and_cpu::{centroid, disc, picture};
use crate::support::{linemod_session, renderer};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;

/// The box's sides from its middle.
const HALF_MM: DVec3 = DVec3::new(40.0, 30.0, 20.0);
const DISTANCE_MM: f64 = 500.0;

/// A value is rounded to 8 bits once when the overlay is written and once when it is composed; a fragment's position is
/// known to some 1e-6.
const EIGHT_BITS: f64 = 1.01;

fn camera() -> Intrinsics {
    Intrinsics::pinhole(600.0, 610.0, 161.0, 118.5, WIDTH, HEIGHT)
}

fn asset(mesh: Mesh) -> Arc<MeshAsset> {
    let bvh = Bvh::build(&mesh);
    let (file_name, bytes) = ("shape".to_owned(), Arc::from([]));
    Arc::new(MeshAsset {
        file_name,
        sha256: Sha256::of(b"shape"),
        bytes,
        companions: Vec::new(),
        mesh,
        search_tree: bvh.into(),
        untransformed: None,
        drawn: Default::default(),
    })
}

fn box_data() -> MeshData {
    let corner = |i: u8| {
        let side = |axis: u8, half: f64| if i >> axis & 1 == 0 { -half } else { half };
        DVec3::new(side(0, HALF_MM.x), side(1, HALF_MM.y), side(2, HALF_MM.z)).as_vec3()
    };
    let squares = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    MeshData {
        positions_mm: (0..8).map(corner).collect(),
        triangles: squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..MeshData::default()
    }
}

/// A box before a black background; its front face is 480 mm away and faces the camera.
fn box_picture(mode: OverlayMode) -> Picture {
    let pose = Pose::from_translation(DVec3::Z * DISTANCE_MM);
    let mesh = asset(Mesh::new(box_data()).unwrap());
    let mut picture = picture(camera(), ImageRect::of_photo(WIDTH, HEIGHT), mesh, pose);
    picture.look.mode = mode;
    picture
}

/// The same box turned so that three of its faces are seen.
fn turned_box_picture(mode: OverlayMode) -> Picture {
    let mut picture = box_picture(mode);
    let rotation = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.6, 0.7, 0.2));
    picture.items[0].camera_from_object.rotation = rotation;
    picture
}

fn flat(color: [u8; 4]) -> PhotoLayer {
    let rgba = color.repeat((WIDTH * HEIGHT) as usize);
    PhotoLayer(Arc::new(Pixels { width: WIDTH, height: HEIGHT, rgba }))
}

fn draw(renderer: &mut Renderer, picture: &Picture) -> Pixels {
    let size = [picture.camera.width, picture.camera.height];
    renderer.draw_and_read(picture, size, Layer::Picture).wait(renderer.gpu()).unwrap()
}

fn at(pixels: &Pixels, x: u32, y: u32) -> [f64; 3] {
    let start = ((y * pixels.width + x) * 4) as usize;
    [0, 1, 2].map(|channel| f64::from(pixels.rgba[start + channel]))
}

fn assert_close(seen: [f64; 3], expected: [f64; 3], bound: f64) {
    let worst = (0..3).map(|i| (seen[i] - expected[i]).abs()).fold(0.0, f64::max);
    assert!(worst <= bound, "{seen:?} is drawn, {expected:?} expected");
}

/// How many pixels are not black.
fn lit_pixels(pixels: &Pixels) -> usize {
    pixels.rgba.chunks_exact(4).filter(|texel| texel[..3].iter().any(|&value| value > 40)).count()
}

#[test]
fn nocs_colours_are_the_object_coordinates() {
    let Some(mut renderer) = renderer() else { return };
    let pixels = draw(&mut renderer, &box_picture(OverlayMode::Nocs));
    for (x, y) in [(161, 118), (130, 100), (200, 150), (115, 85)] {
        let front_mm = DISTANCE_MM - HALF_MM.z;
        let point_camera = camera().unproject(DVec2::new(f64::from(x), f64::from(y))) * front_mm;
        let point_object = point_camera - DVec3::Z * DISTANCE_MM;
        // One scale for all axes: the largest extent.
        let expected = (point_object / (2.0 * HALF_MM.x) + 0.5) * 255.0;
        assert_close(at(&pixels, x, y), expected.to_array(), EIGHT_BITS);
    }
}

#[test]
fn normals_and_depth_are_colours_by_their_formulas() {
    let Some(mut renderer) = renderer() else { return };
    let pixels = draw(&mut renderer, &box_picture(OverlayMode::Normals));
    // (0, 0, −1): towards the camera.
    assert_close(at(&pixels, 161, 118), [127.5, 127.5, 0.0], EIGHT_BITS);

    let pixels = draw(&mut renderer, &box_picture(OverlayMode::Depth));
    let radius = HALF_MM.length();
    let place = 8.0 * (radius - HALF_MM.z) / (2.0 * radius);
    // Between the third and the fourth colour of the ramp.
    assert!((2.0..3.0).contains(&place));
    let (third, fourth) = (DVec3::new(92.0, 200.0, 99.0), DVec3::new(39.0, 173.0, 129.0));
    assert_close(at(&pixels, 161, 118), third.lerp(fourth, place - 2.0).to_array(), EIGHT_BITS);
}

#[test]
fn a_textured_mesh_shows_its_texture_and_a_plain_one_its_colour() {
    let Some(mut renderer) = renderer() else { return };
    // The left half of the front is red, the right half green; v runs down.
    let texture = Pixels { width: 2, height: 1, rgba: vec![255, 0, 0, 255, 0, 255, 0, 255] };
    let mut data = box_data();
    let uv = |vertex: u32| {
        let position = data.positions_mm[vertex as usize];
        Vec2::new(position.x, position.y) / (2.0 * HALF_MM.truncate().as_vec2()) + 0.5
    };
    data.paint = Some(Paint {
        corner_uvs: data.triangles.iter().map(|triangle| triangle.map(uv)).collect(),
        material_of_triangle: vec![0; data.triangles.len()],
        materials: vec![Material { base_color: [255; 4], texture: Some(0) }],
        textures: vec![Arc::new(texture)],
    });
    let mut painted = box_picture(OverlayMode::Colors);
    painted.items[0].mesh = asset(Mesh::new(data).unwrap());
    let pixels = draw(&mut renderer, &painted);
    // A quarter from the side: in the middle of a texel. The face looks at the viewer, so it is lit nearly in full.
    let (left, right) = (at(&pixels, 136, 118), at(&pixels, 186, 118));
    assert!(left[0] > 230.0 && left[1] < 12.0 && left[2] < 2.0, "{left:?}");
    assert!(right[1] > 230.0 && right[0] < 12.0 && right[2] < 2.0, "{right:?}");

    let mut colored = box_picture(OverlayMode::Colors);
    let data = MeshData { colors: Some(vec![[0, 0, 255, 255]; 8]), ..box_data() };
    colored.items[0].mesh = asset(Mesh::new(data).unwrap());
    let blue = at(&draw(&mut renderer, &colored), 161, 118);
    assert!(blue[2] > 240.0 && blue[0] < 1.0, "{blue:?}");

    let plain = draw(&mut renderer, &box_picture(OverlayMode::Colors));
    assert_eq!(plain, draw(&mut renderer, &box_picture(OverlayMode::Shaded)));
}

#[test]
fn lines_cover_less_than_surfaces_and_all_edges_more_than_sharp_ones() {
    let Some(mut renderer) = renderer() else { return };
    let mut count = |mode| lit_pixels(&draw(&mut renderer, &turned_box_picture(mode)));
    let [fill, outline, edges, wires] =
        [OverlayMode::Shaded, OverlayMode::Outline, OverlayMode::Edges, OverlayMode::Wireframe]
            .map(&mut count);
    // The outline is six sides long, the edges nine; a wireframe has a diagonal on each of three faces besides.
    assert!(
        0 < outline && outline < edges && edges < wires && wires < fill,
        "{outline} {edges} {wires} {fill}"
    );
}

#[test]
fn hidden_edges_are_left_out_and_show_with_x_ray() {
    let Some(mut renderer) = renderer() else { return };
    // The back face's lower edge is seen through the front face, by its middle.
    let behind = camera().project(DVec3::new(0.0, HALF_MM.y, DISTANCE_MM + HALF_MM.z)).unwrap();
    let before = camera().project(DVec3::new(0.0, HALF_MM.y, DISTANCE_MM - HALF_MM.z)).unwrap();
    let brightest_near = |pixels: &Pixels, place: DVec2| {
        let rows = place.y.round() as u32 - 1..=place.y.round() as u32 + 1;
        rows.map(|y| at(pixels, place.x.round() as u32, y)[1] as u32).max().unwrap()
    };
    let mut picture = box_picture(OverlayMode::Edges);
    let pixels = draw(&mut renderer, &picture);
    assert_eq!(brightest_near(&pixels, behind), 0);
    assert!(brightest_near(&pixels, before) > 150);
    picture.look.x_ray = true;
    let pixels = draw(&mut renderer, &picture);
    // A third of the front's brightness.
    assert!((40..150).contains(&brightest_near(&pixels, behind)));
    assert!(brightest_near(&pixels, before) > 150);
}

/// Edges must not come and go while an object turns: at each of many angles, each visible edge is there along its length.
#[test]
fn visible_edges_are_whole_at_every_angle() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = box_picture(OverlayMode::Edges);
    for step in 0..40 {
        let angle = 0.37 + f64::from(step) * 0.021;
        let rotation = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.5, angle, 0.1));
        picture.items[0].camera_from_object.rotation = rotation;
        let pose = picture.items[0].camera_from_object;
        let pixels = draw(&mut renderer, &picture);
        // The corner that is nearest to the camera: all three of its edges are seen.
        let corners = picture.items[0].mesh().bounds().corners();
        let nearest = corners
            .into_iter()
            .min_by(|&a, &b| pose.transform_point(a).z.total_cmp(&pose.transform_point(b).z))
            .unwrap();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let other = nearest - 2.0 * nearest * axis;
            for part in [0.2, 0.35, 0.5, 0.65, 0.8] {
                let place = camera().project(pose.transform_point(nearest.lerp(other, part))).unwrap();
                let seen = at(&pixels, place.x.round() as u32, place.y.round() as u32);
                // The line is 1.5 px wide: the pixel that its middle runs through is covered by half at least.
                assert!(seen[1] > 110.0, "step {step}, {part} along {axis}: {seen:?}");
            }
        }
    }
}

#[test]
fn a_wipe_halves_the_overlay() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = box_picture(OverlayMode::Shaded);
    picture.look.outline = true;
    let whole = draw(&mut renderer, &picture);
    picture.look.wipe = Some(0.5);
    let wiped = draw(&mut renderer, &picture);
    let boundary = WIDTH / 2;
    for y in 0..HEIGHT {
        // The line and its rim take two pixels on each side.
        for x in (0..boundary - 2).chain(boundary + 2..WIDTH) {
            let expected = if x < boundary { at(&whole, x, y) } else { [0.0; 3] };
            assert_eq!(at(&wiped, x, y), expected, "at {x}, {y}");
        }
        assert!(at(&wiped, boundary, y)[0] > 150.0, "there is a line");
    }
}

#[test]
fn an_adjustment_of_nothing_keeps_every_byte_of_the_photo() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = box_picture(OverlayMode::Shaded);
    picture.look.layers = Layers::PhotoOnly;
    let mut state = 1_u32;
    let mut rgba: Vec<u8> = Vec::new();
    for _ in 0..WIDTH * HEIGHT {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        rgba.extend([(state >> 8) as u8, (state >> 16) as u8, (state >> 24) as u8, 255]);
    }
    let photo = Arc::new(Pixels { width: WIDTH, height: HEIGHT, rgba });
    picture.photo = Some(PhotoLayer(photo.clone()));
    assert!(draw(&mut renderer, &picture) == *photo, "the photo is not shown as it is");

    let mut adjusted = |adjustment| {
        picture.look.photo = adjustment;
        draw(&mut renderer, &picture)
    };
    let nothing = PhotoAdjustment::default();
    let white = adjusted(PhotoAdjustment { brightness: 1.0, ..nothing });
    assert!(white.rgba.iter().all(|&value| value == 255));
    let gray = adjusted(PhotoAdjustment { saturation: -1.0, ..nothing });
    assert!(gray.rgba.chunks_exact(4).all(|texel| texel[0] == texel[1] && texel[1] == texel[2]));
    let soft = adjusted(PhotoAdjustment { contrast: -1.0, ..nothing });
    // A quarter of the contrast about the middle.
    assert!(soft.rgba.chunks_exact(4).all(|texel| texel[..3].iter().all(|value| (95..=160).contains(value))));
}

#[test]
fn layers_masks_and_difference_are_composed_by_their_formulas() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = box_picture(OverlayMode::Normals);
    picture.photo = Some(flat([90, 100, 110, 255]));
    // Half red, between the photo and the box.
    picture.masks = Some(flat([255, 0, 0, 128]));
    let share = 128.0 / 255.0;
    let under = [90.0 + (255.0 - 90.0) * share, 100.0 * (1.0 - share), 110.0 * (1.0 - share)];
    let pixels = draw(&mut renderer, &picture);
    assert_close(at(&pixels, 5, 5), under, EIGHT_BITS);
    assert_close(at(&pixels, 161, 118), [127.5, 127.5, 0.0], EIGHT_BITS);

    picture.look.difference = true;
    picture.items[0].opacity = 0.5;
    let pixels = draw(&mut renderer, &picture);
    let difference = [under[0] - 127.5, 127.5 - under[1], under[2]];
    assert_close(at(&pixels, 161, 118), difference.map(f64::abs), EIGHT_BITS);
    assert_close(at(&pixels, 5, 5), under, EIGHT_BITS);

    picture.look = Look { layers: Layers::MeshOnly, mode: OverlayMode::Normals, ..Look::default() };
    picture.items[0].opacity = 1.0;
    let pixels = draw(&mut renderer, &picture);
    assert_close(at(&pixels, 5, 5), [0.0; 3], 0.0);
    assert_close(at(&pixels, 161, 118), [127.5, 127.5, 0.0], EIGHT_BITS);
}

#[test]
fn x_ray_shows_what_is_behind() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = box_picture(OverlayMode::Shaded);
    picture.items[0].color = Rgb([0, 0, 255]);
    let behind = Item {
        camera_from_object: Pose::from_translation(DVec3::Z * 700.0),
        color: Rgb([255, 0, 0]),
        id: 2,
        ..picture.items[0].clone()
    };
    // In either order.
    for items in
        [vec![picture.items[0].clone(), behind.clone()], vec![behind.clone(), picture.items[0].clone()]]
    {
        picture.items = items;
        picture.look = Look::default();
        let solid = at(&draw(&mut renderer, &picture), 161, 118);
        picture.look.x_ray = true;
        let pixels = draw(&mut renderer, &picture);
        let through = at(&pixels, 161, 118);
        // 60 % of the front, and behind it 60 % of the rest. The shine is of both colours.
        assert!(through[0] > solid[0] + 40.0 && through[2] > 120.0, "{solid:?} {through:?}");
        // The hidden box's lower edge is outlined in red, three quarters as strong as others.
        let edge = camera().project(DVec3::new(0.0, HALF_MM.y, 700.0 - HALF_MM.z)).unwrap();
        let rows = edge.y.round() as u32 - 1..=edge.y.round() as u32 + 1;
        picture.look.mode = OverlayMode::Outline;
        let mut reddest = |x_ray| {
            picture.look.x_ray = x_ray;
            let pixels = draw(&mut renderer, &picture);
            rows.clone().map(|y| at(&pixels, 161, y)[0] as u32).max().unwrap()
        };
        assert_eq!((reddest(false), reddest(true) > 80), (0, true));
    }
}

/// A repaint of either view draws nothing where nothing changed, but once for what lies below the meshes, which is kept
/// then; and an export disturbs neither.
#[test]
fn views_keep_their_pictures() {
    let Some(mut renderer) = renderer() else { return };
    let first = box_picture(OverlayMode::Shaded);
    let second = turned_box_picture(OverlayMode::Nocs);
    let cost = |renderer: &mut Renderer, slot, picture: &Picture| {
        renderer.usage.reset();
        let mut encoder = renderer.gpu().device.create_command_encoder(&Default::default());
        renderer.prepare(slot, &mut encoder, picture, [0, 0], [WIDTH, HEIGHT]);
        let commands = encoder.finish();
        renderer.gpu().queue.submit([commands]);
        (renderer.usage.draw_calls.get(), renderer.usage.uploaded_bytes.get())
    };
    assert!(cost(&mut renderer, ViewSlot::Photo, &first).0 > 0);
    assert!(cost(&mut renderer, ViewSlot::Scene, &second).0 > 0);
    draw(&mut renderer, &turned_box_picture(OverlayMode::Edges));
    for (slot, picture) in [(ViewSlot::Photo, &first), (ViewSlot::Scene, &second)] {
        assert_eq!(cost(&mut renderer, slot, picture), (1, 0));
        assert_eq!(cost(&mut renderer, slot, picture), (0, 0));
    }
}

/// What a drag step uploads and how often it draws does not depend on how fine the mesh is.
#[test]
fn a_drag_costs_the_same_for_every_mesh() {
    let Some(mut renderer) = renderer() else { return };
    let fine = |count: u32| {
        let rim = (0..count).map(|i| {
            let angle = f64::from(i) / f64::from(count) * std::f64::consts::TAU;
            DVec3::new(angle.cos() * 40.0, angle.sin() * 40.0, 0.0).as_vec3()
        });
        let positions_mm = std::iter::once(Vec3::ZERO).chain(rim).collect();
        let triangles = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        asset(Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap())
    };
    for mode in OverlayMode::ALL.map(|(mode, ..)| mode) {
        let mut costs = [12, 12_000].map(|count| {
            let mut picture = box_picture(mode);
            picture.items[0].mesh = fine(count);
            draw(&mut renderer, &picture);
            renderer.usage.reset();
            picture.items[0].camera_from_object.translation_mm.x += 3.0;
            draw(&mut renderer, &picture);
            (renderer.usage.draw_calls.get(), renderer.usage.uploaded_bytes.get())
        });
        costs.sort_unstable();
        assert_eq!(costs[0], costs[1], "{mode:?}");
        assert!(costs[0].1 < 4096, "{} bytes a frame", costs[0].1);
    }
}

#[test]
fn every_pipeline_can_be_made() {
    let Some(renderer) = renderer() else { return };
    renderer.make_all_pipelines();
}

/// An eye off to the side, that looks at the box.
fn eye_from_camera() -> Pose {
    let rotation = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::YXZ, -0.7, 0.3, 0.1));
    let about = Pose::rotation_about(DVec3::Z * DISTANCE_MM, rotation);
    Pose::from_translation(DVec3::new(12.0, -7.0, 350.0)) * about
}

fn free(mut picture: Picture) -> Picture {
    picture.eye_from_camera = eye_from_camera();
    picture.surroundings = Some(Surroundings { plane: None, lines: Vec::new() });
    picture
}

#[test]
fn a_free_eye_sees_objects_where_they_project_to() {
    let Some(mut renderer) = renderer() else { return };
    for position in
        [DVec3::new(0.0, 0.0, 500.0), DVec3::new(60.0, 40.0, 430.0), DVec3::new(-90.0, 20.0, 560.0)]
    {
        // The disc faces the eye.
        let camera_from_object =
            Pose { translation_mm: position, rotation: eye_from_camera().rotation.transpose() };
        let mut picture =
            free(picture(camera(), ImageRect::of_photo(WIDTH, HEIGHT), disc(6.0), camera_from_object));
        picture.look.mode = OverlayMode::Nocs;
        let ids = renderer.draw_and_read(&picture, [WIDTH, HEIGHT], Layer::Ids).wait(renderer.gpu()).unwrap();
        let white: Vec<u8> = ids.rgba.chunks_exact(4).flat_map(|texel| [texel[3]; 4]).collect();
        let expected = camera().project(eye_from_camera().transform_point(position)).unwrap();
        // One sample a pixel around a disc of some 50 px of border.
        assert!(centroid(&white, WIDTH as usize).distance(expected) < 0.3);
    }
}

#[test]
fn an_eye_in_the_camera_sees_the_photo_views_silhouette() {
    let Some(mut renderer) = renderer() else { return };
    let photo_view = turned_box_picture(OverlayMode::Shaded);
    let scene_view =
        Picture { surroundings: Some(Surroundings { plane: None, lines: Vec::new() }), ..photo_view.clone() };
    let [first, second] = [photo_view, scene_view].map(|picture| {
        renderer.draw_and_read(&picture, [WIDTH, HEIGHT], Layer::Ids).wait(renderer.gpu()).unwrap()
    });
    assert!(first == second, "the silhouettes differ");
}

#[test]
fn the_photo_is_where_its_frustum_says() {
    let Some(mut renderer) = renderer() else { return };
    let lens = Distortion { k1: -0.15, k2: 0.03, ..Distortion::NONE };
    for distortion in [Distortion::NONE, lens] {
        let photo_camera = Intrinsics { distortion, ..camera() };
        let mut picture = free(box_picture(OverlayMode::Shaded));
        picture.items.clear();
        picture.photo = Some(flat([255; 4]));
        let plane = PhotoPlane { camera: photo_camera, distance_mm: 420.0, opacity: 1.0 };
        picture.surroundings = Some(Surroundings { plane: Some(plane), lines: Vec::new() });
        let pixels = draw(&mut renderer, &picture);
        let is_white = |place: DVec2| at(&pixels, place.x.round() as u32, place.y.round() as u32)[0] > 250.0;
        let rect = ImageRect::of_photo(WIDTH, HEIGHT);
        let seen = |pixel: DVec2| {
            let point = photo_camera.unproject(pixel) * plane.distance_mm;
            picture.camera.project(eye_from_camera().transform_point(point)).unwrap()
        };
        let mut inside = 0;
        for pixel in
            [rect.min, rect.max, DVec2::new(rect.min.x, rect.max.y), DVec2::new(rect.max.x, rect.min.y)]
        {
            // Some photo pixels inwards from a corner it is there, as many outwards it is not: where the eye sees it from
            // the side that is two or three pixels on screen.
            let inwards = (rect.center() - pixel).normalize() * 8.0;
            let (in_it, off_it) = (seen(pixel + inwards), seen(pixel - inwards));
            let on_screen = DVec2::splat(1.0).cmple(in_it.min(off_it)).all()
                && in_it.max(off_it).cmplt(DVec2::new(318.0, 238.0)).all();
            if on_screen {
                inside += 1;
                assert!(is_white(in_it) && !is_white(off_it), "corner {pixel}: {in_it}, {off_it}");
            }
        }
        assert!(inside >= 2, "only {inside} corners are in the picture");
    }
}

/// A plane or a line before a mesh covers it, one behind it does not; a line in front of everything always does.
#[test]
fn surroundings_and_meshes_hide_each_other() {
    let Some(mut renderer) = renderer() else { return };
    let middle = |distance_mm: f64, in_front| {
        let across = DVec3::X * 30.0;
        let point = camera().unproject(DVec2::new(161.0, 118.0)) * distance_mm;
        let green = Rgb([0, 255, 0]);
        Line3 { in_front, ..Line3::solid(point - across, point + across, green, 5.0) }
    };
    let mut seen = |plane_mm: Option<f64>, line: Option<Line3>| {
        let mut picture = box_picture(OverlayMode::Normals);
        picture.photo = Some(flat([255, 255, 255, 255]));
        let plane = plane_mm.map(|distance_mm| PhotoPlane { camera: camera(), distance_mm, opacity: 1.0 });
        picture.surroundings = Some(Surroundings { plane, lines: line.into_iter().collect() });
        at(&draw(&mut renderer, &picture), 161, 118)
    };
    let (mesh, white, green) = ([127.5, 127.5, 0.0], [255.0; 3], [0.0, 255.0, 0.0]);
    assert_close(seen(None, None), mesh, EIGHT_BITS);
    assert_close(seen(Some(900.0), None), mesh, EIGHT_BITS);
    assert_close(seen(Some(300.0), None), white, EIGHT_BITS);
    assert_close(seen(None, Some(middle(300.0, false))), green, EIGHT_BITS);
    assert_close(seen(None, Some(middle(700.0, false))), mesh, EIGHT_BITS);
    assert_close(seen(None, Some(middle(700.0, true))), green, EIGHT_BITS);
    assert_close(seen(Some(250.0), Some(middle(300.0, false))), white, EIGHT_BITS);
}

#[test]
fn the_scene_picture_has_the_photo_its_camera_and_axes() {
    let Some(session) = linemod_session() else { return };
    let scene = session.scene();
    let photo = &scene.photos[0];
    let selected = scene.objects_in(photo.id).next().unwrap().0.id;
    let subject = Subject { selected: Some(selected), ..Subject::new(scene, photo.id, None) };
    let view = FreeView {
        eye_from_camera: eye_from_camera(),
        eye: camera(),
        image_distance_mm: 600.0,
        photo_opacity: 0.9,
        other_cameras: Vec::new(),
    };
    let picture = scene_picture_of(&subject, &view).unwrap();
    let lines = picture.surroundings.unwrap().lines;
    assert_eq!(lines.iter().filter(|line| line.in_front).count(), 3);
    // The first line leads from the optical centre to the photo's first corner.
    let corner = photo.camera.unproject(DVec2::splat(-0.5)) * 600.0;
    assert_eq!((lines[0].from, lines[0].to), (DVec3::ZERO, corner));
    assert_eq!((picture.camera, picture.eye_from_camera), (view.eye, view.eye_from_camera));
}

/// What is more than the tolerance behind a depth map is hidden, surfaces and outlines, unless it is looked through.
#[test]
fn a_depth_map_hides_what_is_behind_it() {
    let Some(mut renderer) = renderer() else { return };
    // Half millimetres. Left of the middle the scene is 200 mm before the box's front, right of it nothing was measured;
    // its lowest rows are the front itself, seen 10 mm too near.
    let near_mm = (DISTANCE_MM - HALF_MM.z) as u32 - 10;
    let raw = (0..WIDTH * HEIGHT).map(|i| match (i % WIDTH, i / WIDTH) {
        (_, y) if y >= 130 => 2 * near_mm as u16,
        (x, _) if x < 161 => 560,
        _ => 0,
    });
    let pixels = Arc::new(DepthPixels { width: WIDTH, height: HEIGHT, raw: raw.collect() });
    let mut picture = box_picture(OverlayMode::Normals);
    picture.occluder = Some(Occluder { pixels, mm_per_unit: 0.5 });
    let seen = draw(&mut renderer, &picture);
    let (mesh, nothing) = ([127.5, 127.5, 0.0], [0.0; 3]);
    for (x, y, expected) in [(140, 110, nothing), (180, 110, mesh), (140, 140, mesh), (180, 140, mesh)] {
        assert_close(at(&seen, x, y), expected, EIGHT_BITS);
    }
    // To the pixel: the border is between columns 160 and 161.
    assert_close(at(&seen, 160, 110), nothing, EIGHT_BITS);
    assert_close(at(&seen, 161, 110), mesh, EIGHT_BITS);
    picture.look.x_ray = true;
    assert!(lit_pixels(&draw(&mut renderer, &picture)) > lit_pixels(&seen));

    let whole = box_picture(OverlayMode::Outline);
    let hidden = Picture { occluder: picture.occluder, ..whole.clone() };
    let [whole, hidden] = [whole, hidden].map(|picture| draw(&mut renderer, &picture));
    assert_close(at(&hidden, 140, 110), nothing, EIGHT_BITS);
    // Where it is hidden its outline is fainter, so that it can be found.
    let left_side = |pixels: &Pixels| (100..120).map(|x| at(pixels, x, 100)[0]).fold(0.0, f64::max);
    let part = left_side(&hidden) / left_side(&whole);
    assert!((0.6..0.9).contains(&part), "{part} of the whole outline's brightness");
}

/// The photo below the meshes is drawn once and kept, and looks the same as if it were drawn with them.
#[test]
fn what_is_kept_below_the_meshes_is_what_was_drawn() {
    let Some(mut renderer) = renderer() else { return };
    let rgba =
        (0..WIDTH * HEIGHT).flat_map(|i| [(i % 251) as u8, (i / WIDTH) as u8, (i % 7) as u8 * 30, 255]);
    let photo = Pixels { width: WIDTH, height: HEIGHT, rgba: rgba.collect() };
    let mut picture = box_picture(OverlayMode::Shaded);
    picture.photo = Some(PhotoLayer(Arc::new(photo)));
    picture.background = Rgb([90, 20, 40]);
    picture.look.photo.contrast = 0.3;
    // Something of what is around the photo is seen too, and the view is not at the framebuffer's corner.
    picture.rect = ImageRect { min: DVec2::new(-20.3, 10.0), max: DVec2::new(250.2, 230.0) };
    let mut seen = Vec::new();
    for _ in 0..3 {
        picture.items[0].camera_from_object.translation_mm.x += 1e-9;
        seen.push(on_screen(&mut renderer, &picture, [13, 7]));
    }
    let [first, second, third] = &seen[..] else { panic!("three pictures") };
    assert_eq!(first, second, "drawn directly, and when it is kept");
    assert_eq!(first, third, "drawn directly, and from what was kept");
    picture.look.photo.contrast = 0.0;
    assert_ne!(&on_screen(&mut renderer, &picture, [13, 7]), third, "an older one is not taken for it");
}

/// What the interface's pass gets, with the view at a corner of the framebuffer.
fn on_screen(renderer: &mut Renderer, picture: &Picture, corner: [u32; 2]) -> Pixels {
    let gpu = renderer.gpu().clone();
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: WIDTH + 20, height: HEIGHT + 20, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.prepare(ViewSlot::Photo, &mut encoder, picture, corner, [WIDTH, HEIGHT]);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            resolve_target: None,
            ops: wgpu::Operations::default(),
            depth_slice: None,
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
    let [x, y, width, height] = [corner[0], corner[1], WIDTH, HEIGHT].map(|value| value as f32);
    pass.set_viewport(x, y, width, height, 0.0, 1.0);
    renderer.paint(ViewSlot::Photo, &mut pass);
    drop(pass);
    let pending = PixelsPending::copy(&gpu, &mut encoder, &texture);
    gpu.queue.submit([encoder.finish()]);
    pending.submitted();
    pending.wait(&gpu).unwrap()
}

/// A mesh of very many triangles is drawn coarser while it moves, near enough for the eye, and exactly at rest.
#[test]
fn fine_meshes_are_coarser_only_while_they_move() {
    let Some(mut renderer) = renderer() else { return };
    let side = 400_u32;
    let point = |i: u32| {
        let (x, y) = (i % (side + 1), i / (side + 1));
        Vec3::new(x as f32, y as f32, 0.0) * (80.0 / side as f32) - Vec3::new(40.0, 40.0, 0.0)
    };
    let corners = (0..side * side).map(|i| i / side * (side + 1) + i % side);
    let data = MeshData {
        positions_mm: (0..(side + 1) * (side + 1)).map(point).collect(),
        triangles: corners
            .flat_map(|a| {
                let [b, c, d] = [a + 1, a + side + 1, a + side + 2];
                [[a, b, c], [b, d, c]]
            })
            .collect(),
        ..MeshData::default()
    };
    let mut picture = box_picture(OverlayMode::Shaded);
    picture.items[0].mesh = asset(Mesh::new(data).unwrap());
    let mut draw_counting = |in_motion| {
        picture.in_motion = in_motion;
        renderer.usage.reset();
        let pixels = draw(&mut renderer, &picture);
        (pixels, renderer.usage.triangles.get(), renderer.usage.uploaded_bytes.get())
    };
    // Seen in motion first, as a mesh that has just come is, it is not on the GPU in full yet.
    let (moving, fewer_triangles, first_bytes) = draw_counting(true);
    let (at_rest, all_triangles, further_bytes) = draw_counting(false);
    assert!(first_bytes * 4 < further_bytes, "{first_bytes} bytes, then {further_bytes}");
    assert!(all_triangles > 320_000 && fewer_triangles < all_triangles / 5, "{fewer_triangles}");
    // The coarse copy's border is within a cell, half a millimetre, of the mesh's: a pixel at this distance.
    let (rest_count, moving_count) = (lit_pixels(&at_rest), lit_pixels(&moving));
    assert!(rest_count.abs_diff(moving_count) < rest_count / 25, "{rest_count} and {moving_count} pixels");
    assert_eq!(draw_counting(false).0, at_rest);
}
