//! Errors of what is seen: VSD and CUS, on pictures of the CPU rasteriser.

use glam::DVec2;

use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::raster::{PixelRegion, RasterItem, rasterize};

/// Within this of the measured distance, a surface counts as seen.
pub const VSD_DELTA_MM: f64 = 15.0;

/// The tolerances of VSD, as parts of the object's diameter.
pub const VSD_TAUS: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5];

/// CUS: the complement over union, 1 − IoU, of the object's silhouettes in two poses; each is drawn alone. 1 where neither
/// has a pixel, as in BOP.
pub fn mask_error(estimate: &Pose, reference: &Pose, mesh: &Mesh, camera: &Intrinsics) -> f64 {
    let [estimated, expected] = [estimate, reference].map(|pose| Distances::of(pose, mesh, camera));
    let pairs = || estimated.mm.iter().zip(&expected.mm);
    let union = pairs().filter(|(a, b)| **a > 0.0 || **b > 0.0).count();
    let intersection = pairs().filter(|(a, b)| **a > 0.0 && **b > 0.0).count();
    if union == 0 { 1.0 } else { (union - intersection) as f64 / union as f64 }
}

/// VSD for each of [`VSD_TAUS`]: the part of the visible pixels where the two surfaces' distances from the camera differ by
/// the tolerance or more, or where only one of them is.
///
/// `depth_mm` is the photo's depth map, row by row, 0 where nothing was measured; what was not measured hides nothing
/// ("bop19"). Without a depth map nothing is hidden. 1 where neither pose shows anything.
pub fn visible_surface_discrepancy(
    estimate: &Pose,
    reference: &Pose,
    mesh: &Mesh,
    camera: &Intrinsics,
    depth_mm: Option<&[f32]>,
    diameter_mm: f64,
) -> [f64; VSD_TAUS.len()] {
    let estimated = Distances::of(estimate, mesh, camera);
    let expected = Distances::of(reference, mesh, camera);
    let (mut union, mut one_sided, mut too_far) = (0_u32, 0_u32, [0_u32; VSD_TAUS.len()]);
    for (pixel, (&estimated_mm, &expected_mm)) in estimated.mm.iter().zip(&expected.mm).enumerate() {
        if estimated_mm == 0.0 && expected_mm == 0.0 {
            continue;
        }
        let measured = depth_mm.and_then(|depth| depth.get(pixel)).filter(|depth| **depth > 0.0);
        let measured_mm = measured.map(|depth| f64::from(*depth) * expected.per_depth(camera, pixel));
        let is_seen = |mm: f64| mm > 0.0 && measured_mm.is_none_or(|measured| mm - measured <= VSD_DELTA_MM);
        let expected_seen = is_seen(expected_mm);
        let estimated_seen = is_seen(estimated_mm) || (expected_seen && estimated_mm > 0.0);
        match (estimated_seen, expected_seen) {
            (false, false) => continue,
            (true, true) => {
                let part = (expected_mm - estimated_mm).abs() / diameter_mm;
                for (count, tau) in too_far.iter_mut().zip(VSD_TAUS) {
                    *count += u32::from(part >= tau);
                }
            }
            _ => one_sided += 1,
        }
        union += 1;
    }
    too_far.map(|count| if union == 0 { 1.0 } else { f64::from(count + one_sided) / f64::from(union) })
}

/// How far the surface is from the camera's centre along each pixel's ray, 0 where there is none.
struct Distances {
    width: usize,
    mm: Vec<f64>,
}

impl Distances {
    fn of(camera_from_object: &Pose, mesh: &Mesh, camera: &Intrinsics) -> Self {
        let item = RasterItem { mesh, camera_from_object: *camera_from_object, id: 1 };
        let picture = rasterize(camera, &[item], PixelRegion::of_camera(camera));
        let mut distances = Self { width: picture.width as usize, mm: vec![0.0; picture.depth_mm.len()] };
        for (pixel, depth_mm) in picture.depth_mm.iter().enumerate().filter(|(_, depth)| **depth > 0.0) {
            distances.mm[pixel] = f64::from(*depth_mm) * distances.per_depth(camera, pixel);
        }
        distances
    }

    /// The distance that a z of one millimetre is at this pixel.
    fn per_depth(&self, camera: &Intrinsics, pixel: usize) -> f64 {
        let (x, y) = (pixel % self.width, pixel / self.width);
        camera.unproject(DVec2::new(x as f64, y as f64)).length()
    }
}
