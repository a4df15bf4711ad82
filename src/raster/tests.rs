use glam::{DMat3, DVec2, DVec3, Vec3};
use proptest::prelude::*;

use super::triangle::{GRID_PER_PIXEL, ScreenVertex, fill};
use super::*;
use crate::math::{Distortion, NEAR_MM};
use crate::mesh::MeshData;
use crate::mesh::test_shapes::{cube, sphere};

/// With these numbers a point at z = 500 is projected to whole multiples of its millimetres, exactly.
fn camera() -> Intrinsics {
    Intrinsics::pinhole(500.0, 500.0, 32.0, 24.0, 64, 48)
}

fn mesh(positions_mm: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

/// Two triangles over [x0, x1] × [y0, y1] at depth z.
fn rectangle([x0, x1]: [f32; 2], [y0, y1]: [f32; 2], z: f32) -> Mesh {
    let corners = [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]];
    mesh(corners.map(Vec3::from_array).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn draw(camera: &Intrinsics, meshes: &[&Mesh]) -> RasterImage {
    let items: Vec<RasterItem<'_>> = (1..)
        .zip(meshes)
        .map(|(id, mesh)| RasterItem { mesh, camera_from_object: Pose::IDENTITY, id })
        .collect();
    rasterize(camera, &items, PixelRegion::of_camera(camera))
}

fn pixels(image: &RasterImage) -> impl Iterator<Item = (DVec2, f64, u32)> {
    (0..image.height)
        .flat_map(|y| (0..image.width).map(move |x| DVec2::new(x.into(), y.into())))
        .zip(0..)
        .map(|(pixel, i): (DVec2, usize)| (pixel, f64::from(image.depth_mm[i]), image.ids[i]))
}

#[test]
fn a_rectangle_covers_the_centers_within_it_and_those_on_its_top_and_left() {
    // In the picture: [2, 12] × [4, 9.25]; the left, right and top sides run through pixel centres.
    let image = draw(&camera(), &[&rectangle([-30.0, -20.0], [-20.0, -14.75], 500.0)]);
    for (pixel, depth_mm, id) in pixels(&image) {
        let is_inside = (2.0..12.0).contains(&pixel.x) && (4.0..9.25).contains(&pixel.y);
        assert_eq!((id, depth_mm), if is_inside { (1, 500.0) } else { (0, 0.0) }, "at {pixel}");
    }
    assert_eq!(image.mask(1).count(), 10 * 6);
}

#[test]
fn a_region_is_a_cut_out_of_the_whole_and_may_reach_beyond() {
    let sphere = sphere(40.0, 20, 40);
    let pose = Pose::from_translation(DVec3::new(3.3, -2.7, 600.0));
    let item = RasterItem { mesh: &sphere, camera_from_object: pose, id: 7 };
    let whole = rasterize(&camera(), &[item], PixelRegion::of_camera(&camera()));
    let region = PixelRegion { x0: 20, y0: -5, width: 50, height: 40 };
    let part = rasterize(&camera(), &[item], region);
    for (pixel, depth_mm, id) in pixels(&part) {
        let (x, y) = (pixel.x as i32 + region.x0, pixel.y as i32 + region.y0);
        if (0..64).contains(&x) && (0..48).contains(&y) {
            let i = (y * 64 + x) as usize;
            // The weights are summed from another origin, in f64; then both are rounded to f32.
            assert_eq!(id, whole.ids[i]);
            assert!((depth_mm - f64::from(whole.depth_mm[i])).abs() < 1e-4);
        }
    }
}

#[test]
fn a_tilted_plane_has_the_depth_of_its_closed_form() {
    let camera = Intrinsics { skew: 0.3, ..Intrinsics::pinhole(572.4, 573.6, 325.3, 242.0, 640, 480) };
    for tilt_deg in [10.0_f64, 45.0, 75.0] {
        let rotation = DMat3::from_rotation_x(tilt_deg.to_radians()) * DMat3::from_rotation_y(0.4);
        let pose = Pose { rotation, translation_mm: DVec3::new(20.0, -10.0, 900.0) };
        let plane = rectangle([-400.0, 400.0], [-400.0, 400.0], 0.0);
        let item = RasterItem { mesh: &plane, camera_from_object: pose, id: 1 };
        let image = rasterize(&camera, &[item], PixelRegion::of_camera(&camera));
        let normal = rotation.z_axis;
        let mut drawn = 0;
        for (pixel, depth_mm, _) in pixels(&image).filter(|&(_, _, id)| id == 1) {
            let expected = normal.dot(pose.translation_mm) / normal.dot(camera.unproject(pixel));
            // Vertices are rounded by up to 1/8192 px, and one pixel is at most a few percent of depth here.
            assert!((depth_mm / expected - 1.0).abs() < 2e-5, "{depth_mm} {expected} at {pixel}");
            drawn += 1;
        }
        assert!(drawn > 10_000, "{drawn}");
    }
}

#[test]
fn a_sphere_covers_the_ellipse_of_its_silhouette() {
    let camera = Intrinsics::from_focal(600.0, 640, 480);
    let (radius, distance) = (60.0, 500.0);
    let sphere = sphere(60.0, 256, 512);
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, distance));
    let item = RasterItem { mesh: &sphere, camera_from_object: pose, id: 1 };
    let image = rasterize(&camera, &[item], PixelRegion::of_camera(&camera));
    // On the axis the silhouette is a circle of tan(asin(r / d)).
    let silhouette_px = 600.0 * radius / f64::sqrt(distance * distance - radius * radius);
    let expected = std::f64::consts::PI * silhouette_px * silhouette_px;
    // Facets of 0.7° lose about 1e-4 of the area; counting pixel centres is good to a few times the root of the boundary.
    let area = image.mask(1).count() as f64;
    assert!((area / expected - 1.0).abs() < 2e-3, "{area} {expected}");
    let nearest = image.depth_mm.iter().copied().filter(|&depth| depth > 0.0).fold(f32::INFINITY, f32::min);
    assert!((f64::from(nearest) - (distance - radius)).abs() < 0.01, "{nearest}");
}

#[test]
fn the_nearest_surface_wins_in_any_order() {
    let near = rectangle([-10.0, 10.0], [-10.0, 10.0], 400.0);
    let far = rectangle([-30.0, 30.0], [-20.0, 20.0], 500.0);
    let (near_first, far_first) = (draw(&camera(), &[&near, &far]), draw(&camera(), &[&far, &near]));
    assert_eq!(near_first.depth_mm, far_first.depth_mm);
    assert_eq!(near_first.mask(1), far_first.mask(2));
    assert_eq!(near_first.ids[24 * 64 + 32], 1);
    let twice = draw(&camera(), &[&far, &far]);
    assert_eq!(twice.mask(2).count(), 0);
}

#[test]
fn what_is_behind_or_too_near_is_cut_off() {
    assert_eq!(draw(&camera(), &[&rectangle([-9.0, 9.0], [-9.0, 9.0], -500.0)]).mask(1).count(), 0);
    assert_eq!(draw(&camera(), &[&rectangle([-9.0, 9.0], [-9.0, 9.0], 0.5)]).mask(1).count(), 0);
    // A floor at y = 100 mm from behind the camera to 1 km: everything below the horizon's few rows that are still free.
    let floor = [[-1e6, 100.0, -1e6], [1e6, 100.0, -1e6], [1e6, 100.0, 1e6], [-1e6, 100.0, 1e6]];
    let floor = mesh(floor.map(Vec3::from_array).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let image = draw(&camera(), &[&floor]);
    for (pixel, depth_mm, id) in pixels(&image) {
        let below_horizon = pixel.y - 24.0;
        assert_eq!(id, u32::from(below_horizon >= 1.0), "at {pixel}");
        if id == 1 {
            let expected = 500.0 * 100.0 / below_horizon;
            // Corners of the clipped polygon are up to 65536 px away, so that rounding a grid step turns little.
            assert!((depth_mm / expected - 1.0).abs() < 1e-4, "{depth_mm} {expected}");
        }
    }
}

#[test]
fn inside_a_cube_every_pixel_is_covered() {
    let cube = cube();
    let grown = cube.transformed(&glam::DAffine3::from_scale(DVec3::splat(1e4))).unwrap();
    for angle in 0..50 {
        let rotation =
            DMat3::from_rotation_y(f64::from(angle) * 0.13) * DMat3::from_rotation_x(f64::from(angle) * 0.07);
        let pose = Pose { rotation, translation_mm: DVec3::new(0.0, 5e3, -3e3) };
        let item = RasterItem { mesh: &grown, camera_from_object: pose, id: 1 };
        let image = rasterize(&camera(), &[item], PixelRegion::of_camera(&camera()));
        assert_eq!(image.mask(1).count(), 64 * 48);
        assert!(image.depth_mm.iter().all(|&depth| f64::from(depth) > NEAR_MM));
    }
}

#[test]
fn distorted_vertices_are_drawn_where_the_camera_projects_them() {
    let lens = Distortion { k1: -0.2, k2: 0.05, p1: 0.002, p2: -0.001, k3: 0.0 };
    let camera = Intrinsics { distortion: lens, ..Intrinsics::from_focal(500.0, 640, 480) };
    let center = DVec3::new(220.0, -150.0, 500.0);
    let dot = rectangle([218.0, 222.0], [-152.0, -148.0], 500.0);
    let image = draw(&camera, &[&dot]);
    let drawn: Vec<DVec2> = pixels(&image).filter(|&(_, _, id)| id == 1).map(|(pixel, _, _)| pixel).collect();
    let mean = drawn.iter().sum::<DVec2>() / drawn.len() as f64;
    // A square of four pixels: its centre is known to a fraction of one.
    assert!(mean.distance(camera.project(center).unwrap()) < 0.5);
    assert!(
        mean.distance(Intrinsics { distortion: Distortion::NONE, ..camera }.project(center).unwrap()) > 10.0
    );
}

fn blank(width: u32, height: u32) -> RasterImage {
    let pixel_count = (width * height) as usize;
    RasterImage { width, height, depth_mm: vec![0.0; pixel_count], ids: vec![0; pixel_count] }
}

fn grid_vertex() -> impl Strategy<Value = ScreenVertex> {
    // Often on pixel centres or halves, where ties are; sometimes far outside.
    let coordinate = prop_oneof![
        (-4_i64..20).prop_map(|pixel| pixel * GRID_PER_PIXEL),
        (-8_i64..40).prop_map(|half| half * GRID_PER_PIXEL / 2),
        -20_000_i64..80_000,
        -268_435_456_i64..268_435_456,
    ];
    [coordinate.clone(), coordinate].prop_map(|[x, y]| ScreenVertex {
        x: x as i32,
        y: y as i32,
        inverse_depth: 1.0,
    })
}

fn signed_side(a: &ScreenVertex, b: &ScreenVertex, p: &ScreenVertex) -> i128 {
    let [ax, ay, bx, by, px, py] = [a.x, a.y, b.x, b.y, p.x, p.y].map(i128::from);
    (bx - ax) * (py - ay) - (by - ay) * (px - ax)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn triangles_that_share_an_edge_cover_each_pixel_once(
        [a, b, c, d] in [grid_vertex(), grid_vertex(), grid_vertex(), grid_vertex()],
    ) {
        // On different sides of the shared edge: then they overlap nowhere else.
        if signed_side(&a, &b, &c).signum() * signed_side(&a, &b, &d).signum() != -1 {
            return Ok(());
        }
        let covered = |triangle: [ScreenVertex; 3]| {
            let mut image = blank(16, 16);
            fill(&mut image, triangle, 1);
            image.ids
        };
        let (left, right) = (covered([a, b, c]), covered([d, a, b]));
        for (pixel, (in_left, in_right)) in left.iter().zip(&right).enumerate() {
            prop_assert!(in_left + in_right <= 1, "pixel {pixel} twice");
            // A centre strictly within the pair's hull near the shared edge may not be lost: test the closed triangles.
            let center = ScreenVertex {
                x: (pixel % 16) as i32 * GRID_PER_PIXEL as i32,
                y: (pixel / 16) as i32 * GRID_PER_PIXEL as i32,
                inverse_depth: 1.0,
            };
            let strictly_in = |[u, v, w]: [ScreenVertex; 3]| {
                let sides = [signed_side(&u, &v, &center), signed_side(&v, &w, &center), signed_side(&w, &u, &center)];
                sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0)
            };
            let on_shared_edge = signed_side(&a, &b, &center) == 0
                && signed_side(&a, &c, &center).signum() * signed_side(&b, &c, &center).signum() == -1;
            if strictly_in([a, b, c]) || strictly_in([a, b, d]) || on_shared_edge {
                prop_assert_eq!(in_left + in_right, 1, "pixel {} lost", pixel);
            }
        }
    }
}
