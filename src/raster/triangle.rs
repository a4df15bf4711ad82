//! Fills one triangle: which pixel centres are in it, exactly, and how deep it is there.
//!
//! Corners are on a grid of 1/4096 pixel and edge functions are whole numbers, so every test is exact (Pineda, *A Parallel
//! Algorithm for Polygon Rasterization*, 1988): coordinates are below 2³⁰, their products below 2⁶¹.

use super::RasterImage;

pub(super) const GRID_PER_PIXEL: i64 = 1 << GRID_BITS;
const GRID_BITS: u32 = 12;

/// A corner on the grid, counted from the centre of the region's first pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct ScreenVertex {
    pub x: i32,
    pub y: i32,
    /// One over z in the camera frame: this, not z, is linear in the picture.
    pub inverse_depth: f64,
}

/// A function that is zero on an edge and positive within the triangle, at pixel centres: `at_origin + x dx + y dy`.
#[derive(Debug, Clone, Copy)]
struct Edge {
    at_origin: i64,
    dx: i64,
    dy: i64,
    /// Zero where a centre on the edge belongs to this triangle, one where it belongs to its neighbour.
    smallest: i64,
}

impl Edge {
    fn new(from: &ScreenVertex, to: &ScreenVertex) -> Self {
        let (from_x, from_y) = (i64::from(from.x), i64::from(from.y));
        let (step_x, step_y) = (i64::from(to.x) - from_x, i64::from(to.y) - from_y);
        // Seen from within a triangle that turns clockwise on the screen (y down).
        let is_top = step_y == 0 && step_x > 0;
        let is_left = step_y < 0;
        Self {
            at_origin: step_y * from_x - step_x * from_y,
            dx: -step_y * GRID_PER_PIXEL,
            dy: step_x * GRID_PER_PIXEL,
            smallest: i64::from(!(is_top || is_left)),
        }
    }

    fn at(&self, x: i64, y: i64) -> i64 {
        self.at_origin + x * self.dx + y * self.dy
    }

    /// Narrows the range of x that lies within this edge in row y, by halves: triangles of a mesh are a pixel or two wide, and
    /// for those a division of whole numbers takes longer.
    fn narrow(&self, y: i64, first: &mut i64, last: &mut i64) {
        let at_row = self.at(0, y) - self.smallest;
        let is_within = |x: i64| at_row + x * self.dx >= 0;
        if self.dx > 0 && is_within(*last) {
            let mut within = *last;
            while *first < within {
                let middle = (*first + within) >> 1;
                if is_within(middle) { within = middle } else { *first = middle + 1 }
            }
        } else if self.dx < 0 && is_within(*first) {
            let mut within = *first;
            while within < *last {
                let middle = (within + *last + 1) >> 1;
                if is_within(middle) { within = middle } else { *last = middle - 1 }
            }
        } else if !is_within(*first) {
            *last = *first - 1;
        }
    }
}

/// Writes `id` and the depth wherever the triangle covers a pixel centre and nothing nearer is there.
pub(super) fn fill(image: &mut RasterImage, [a, b, c]: [ScreenVertex; 3], id: u32) {
    let [min_x, max_x] = pixel_range([a.x, b.x, c.x], image.width);
    let [min_y, max_y] = pixel_range([a.y, b.y, c.y], image.height);
    if min_x > max_x || min_y > max_y {
        return;
    }
    let area = doubled_area(&a, &b, &c);
    let (b, c) = match area.signum() {
        1 => (b, c),
        -1 => (c, b),
        // Seen edge-on.
        _ => return,
    };
    let edges = [Edge::new(&b, &c), Edge::new(&c, &a), Edge::new(&a, &b)];
    // The edge function opposite a corner, over the area, is that corner's weight.
    let scale = 1.0 / area.unsigned_abs() as f64;
    let corner_values = [a, b, c].map(|corner| corner.inverse_depth * scale);
    let weighted = |values: [i64; 3]| -> f64 {
        values[0] as f64 * corner_values[0]
            + values[1] as f64 * corner_values[1]
            + values[2] as f64 * corner_values[2]
    };
    let inverse_depth_step = weighted(edges.map(|edge| edge.dx));

    for y in min_y..=max_y {
        let (mut first, mut last) = (min_x, max_x);
        for edge in &edges {
            edge.narrow(y, &mut first, &mut last);
        }
        if first > last {
            continue;
        }
        let inverse_depth = weighted(edges.map(|edge| edge.at(first, y)));
        let row_start = y as usize * image.width as usize;
        let span = row_start + first as usize..=row_start + last as usize;
        let depths = &mut image.depth_mm[span.clone()];
        let ids = &mut image.ids[span];
        for (x, (stored_depth, stored_id)) in (0_u32..).zip(depths.iter_mut().zip(ids)) {
            let depth = (1.0 / (inverse_depth + f64::from(x) * inverse_depth_step)) as f32;
            if *stored_depth == 0.0 || depth < *stored_depth {
                *stored_depth = depth;
                *stored_id = id;
            }
        }
    }
}

/// Twice the area of the triangle, in grid units, positive if it turns clockwise on the screen.
fn doubled_area(a: &ScreenVertex, b: &ScreenVertex, c: &ScreenVertex) -> i64 {
    let (ax, ay) = (i64::from(a.x), i64::from(a.y));
    (i64::from(b.x) - ax) * (i64::from(c.y) - ay) - (i64::from(b.y) - ay) * (i64::from(c.x) - ax)
}

/// The first and last pixel whose centre lies between these grid coordinates, within 0..size.
fn pixel_range(grid: [i32; 3], size: u32) -> [i64; 2] {
    let [a, b, c] = grid.map(i64::from);
    // Shifts round down.
    let first = (a.min(b).min(c) + GRID_PER_PIXEL - 1) >> GRID_BITS;
    let last = a.max(b).max(c) >> GRID_BITS;
    [first.max(0), last.min(i64::from(size) - 1)]
}
