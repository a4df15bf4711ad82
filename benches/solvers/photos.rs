//! Photographs that nobody took: a mesh before clutter, by another path than the solvers' own eyes. The full mesh is drawn
//! at 4 × 4 points a pixel, in linear light, then blurred, given sRGB's curve and noise.

use glam::{DVec2, DVec3};
use pinpose::math::{ImageRect, Intrinsics, Pose};
use pinpose::mesh::Mesh;
use pinpose::photo::Pixels;
use pinpose::raster::{PixelRegion, RasterItem, rasterize};

use crate::chance::Chance;

/// Points per pixel along each axis.
const FINE: u32 = 4;
/// Of the noise of each pixel and channel, in sRGB from 0 to 1.
const NOISE: f64 = 0.015;

/// The mesh at `camera_from_object` in front of something.
pub fn photo(chance: &mut Chance, camera: &Intrinsics, mesh: &Mesh, camera_from_object: &Pose) -> Pixels {
    let mut light = clutter(chance, camera);
    draw(chance, camera, mesh, camera_from_object, &mut light);
    let (width, height) = (camera.width as usize, camera.height as usize);
    let blurred = blur(&light, width, height);
    let mut rgba = Vec::with_capacity(4 * blurred.len());
    for light in blurred {
        let channel =
            |value: f64, noise: f64| (255.0 * (srgb(value) + NOISE * noise)).round().clamp(0.0, 255.0);
        rgba.extend(light.to_array().map(|value| channel(value, chance.normal()) as u8));
        rgba.push(255);
    }
    Pixels { width: camera.width, height: camera.height, rgba }
}

fn color(chance: &mut Chance) -> DVec3 {
    DVec3::new(chance.unit(), chance.unit(), chance.unit()) * 0.7 + 0.02
}

/// Discs and bars of all colours over one another.
fn clutter(chance: &mut Chance, camera: &Intrinsics) -> Vec<DVec3> {
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut light = vec![color(chance) * 0.6; width * height];
    for _ in 0..150 {
        let middle = DVec2::new(chance.unit() * width as f64, chance.unit() * height as f64);
        let size = DVec2::new(6.0 + 40.0 * chance.unit(), 6.0 + 40.0 * chance.unit());
        let (along, color, is_disc) = (chance.direction_in_image(), color(chance), chance.unit() < 0.5);
        let reach = size.length();
        let rows = (middle.y - reach).max(0.0) as usize..((middle.y + reach).max(0.0) as usize).min(height);
        for y in rows {
            for x in (middle.x - reach).max(0.0) as usize..((middle.x + reach).max(0.0) as usize).min(width) {
                let place = along.rotate(DVec2::new(x as f64, y as f64) - middle) / size;
                let is_in = if is_disc { place.length() < 1.0 } else { place.abs().max_element() < 1.0 };
                if is_in {
                    light[y * width + x] = color;
                }
            }
        }
    }
    light
}

/// Draws the mesh, lit from one side and a little patterned, over what is there.
fn draw(chance: &mut Chance, camera: &Intrinsics, mesh: &Mesh, pose: &Pose, light: &mut [DVec3]) {
    let corners = mesh.bounds().corners().map(|corner| camera.project(pose.transform_point(corner)).unwrap());
    let around = ImageRect::around(corners).unwrap();
    let (x0, y0) = ((around.min.x.floor() - 2.0) as i32, (around.min.y.floor() - 2.0) as i32);
    let (columns, rows) = (around.size().x.ceil() as u32 + 5, around.size().y.ceil() as u32 + 5);
    let region = PixelRegion {
        x0: x0 * FINE as i32,
        y0: y0 * FINE as i32,
        width: columns * FINE,
        height: rows * FINE,
    };
    let fine_camera = camera.scaled_to(camera.width * FINE, camera.height * FINE);
    let item = RasterItem { mesh, camera_from_object: *pose, id: 1 };
    let image = rasterize(&fine_camera, &[item], region);
    let point = |x: u32, y: u32| {
        let i = (y * region.width + x) as usize;
        let pixel = DVec2::new(f64::from(region.x0) + f64::from(x), f64::from(region.y0) + f64::from(y));
        (image.ids[i] == 1).then(|| {
            let ray = fine_camera.unproject(pixel);
            ray * (f64::from(image.depth_mm[i]) / ray.z)
        })
    };
    let surface = Surface::by_chance(chance);
    let object_from_camera = pose.inverse();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let (x, y) = (x0 + column as i32, y0 + row as i32);
        if x < 0 || y < 0 || x >= camera.width as i32 || y >= camera.height as i32 {
            continue;
        }
        let behind = light[y as usize * camera.width as usize + x as usize];
        let mut sum = DVec3::ZERO;
        for (down, right) in (0..FINE).flat_map(|down| (0..FINE).map(move |right| (down, right))) {
            let (x, y) = (column * FINE + right, row * FINE + down);
            let Some(here) = point(x, y) else {
                sum += behind;
                continue;
            };
            let beside = |dx: u32, dy: u32| {
                let [next, last] = [(x + dx, y + dy), (x - dx.min(x), y - dy.min(y))]
                    .map(|(x, y)| point(x.min(region.width - 1), y.min(region.height - 1)).unwrap_or(here));
                next - last
            };
            let normal = beside(1, 0).cross(beside(0, 1)).try_normalize().unwrap_or(DVec3::Z);
            sum += surface.light(object_from_camera.transform_point(here), normal);
        }
        light[y as usize * camera.width as usize + x as usize] = sum / f64::from(FINE * FINE);
    }
}

/// What an object is made of and lit by.
struct Surface {
    colors: [DVec3; 2],
    /// Waves per millimetre.
    pattern: DVec3,
    from_light: DVec3,
}

impl Surface {
    fn by_chance(chance: &mut Chance) -> Self {
        let first = color(chance);
        let second = first.lerp(color(chance), 0.4);
        let pattern = chance.direction() * 0.1;
        let from_light = (chance.direction() - DVec3::Z).normalize_or(-DVec3::Z);
        Self { colors: [first, second], pattern, from_light }
    }

    fn light(&self, point_mm: DVec3, normal: DVec3) -> DVec3 {
        let wave = 0.5 + 0.5 * (4.0 * point_mm.dot(self.pattern).sin()).tanh();
        let shade = 0.45 + 0.55 * normal.dot(self.from_light).abs();
        self.colors[0].lerp(self.colors[1], wave) * shade
    }
}

/// A lens of some half a pixel: 1 4 1 along each axis.
fn blur(light: &[DVec3], width: usize, height: usize) -> Vec<DVec3> {
    let along = |light: &[DVec3], stride: usize, index_of: &dyn Fn(usize) -> (usize, usize)| -> Vec<DVec3> {
        let at = |i: usize| {
            let (place, count) = index_of(i);
            let before = if place > 0 { light[i - stride] } else { light[i] };
            let after = if place + 1 < count { light[i + stride] } else { light[i] };
            (before + 4.0 * light[i] + after) / 6.0
        };
        (0..light.len()).map(at).collect()
    };
    let across = along(light, 1, &|i| (i % width, width));
    along(&across, width, &|i| (i / width, height))
}

fn srgb(value: f64) -> f64 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.max(0.0).powf(1.0 / 2.4) - 0.055 }
}
