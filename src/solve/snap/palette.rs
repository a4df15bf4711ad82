//! The few colours that a picture is made of, so that histograms are short and quickly learnt.

/// Colours of a palette.
pub const COLORS: usize = 48;
/// Cells per channel in which colours are counted before they are grouped.
const CELLS_PER_CHANNEL: usize = 32;
const CELLS: usize = CELLS_PER_CHANNEL * CELLS_PER_CHANNEL * CELLS_PER_CHANNEL;
/// Colours closer than this (channels from 0 to 1) are often the same surface: noise, a shade, compression.
const ALIKE: f64 = 0.04;

/// How alike the colours of a palette are, and which of them each pixel has.
#[derive(Debug, Clone)]
pub struct Palette {
    /// Per pixel.
    pub labels: Vec<u8>,
    /// `spread[i][j]`: what part of a pixel of colour i counts as one of colour j.
    pub spread: Vec<[f32; COLORS]>,
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    number: usize,
    count: f64,
    color: [f64; 3],
}

impl Palette {
    /// By cutting the box of colours with the largest variance in two, again and again (after Heckbert, *Color Image
    /// Quantization for Frame Buffer Display*, 1982, with variances in place of medians).
    pub fn new(colors: &[[f32; 3]]) -> Self {
        let numbers: Vec<usize> = colors.iter().map(cell_number).collect();
        let mut groups = vec![filled_cells(&numbers)];
        while groups.len() < COLORS {
            let widest =
                (0..groups.len()).max_by(|&a, &b| spread(&groups[a]).1.total_cmp(&spread(&groups[b]).1));
            let Some(widest) = widest.filter(|&group| groups[group].len() > 1) else { break };
            let (axis, _) = spread(&groups[widest]);
            let middle = mean(&groups[widest])[axis];
            let (low, high) =
                groups[widest].iter().copied().partition::<Vec<Cell>, _>(|cell| cell.color[axis] <= middle);
            groups[widest] = low;
            groups.push(high);
        }
        let mut label_of_cell = vec![0_u8; CELLS];
        for (label, group) in groups.iter().enumerate() {
            group.iter().for_each(|cell| label_of_cell[cell.number] = label as u8);
        }
        let means: Vec<[f64; 3]> = groups.iter().map(|group| mean(group)).collect();
        let labels = numbers.into_iter().map(|number| label_of_cell[number]).collect();
        Self { labels, spread: means.iter().map(|from| shares(from, &means)).collect() }
    }
}

fn cell_number(color: &[f32; 3]) -> usize {
    let [r, g, b] =
        color.map(|value| ((value * CELLS_PER_CHANNEL as f32) as usize).min(CELLS_PER_CHANNEL - 1));
    (r * CELLS_PER_CHANNEL + g) * CELLS_PER_CHANNEL + b
}

fn filled_cells(numbers: &[usize]) -> Vec<Cell> {
    let mut counts = vec![0_u32; CELLS];
    numbers.iter().for_each(|&number| counts[number] += 1);
    let place = |number: usize| (number % CELLS_PER_CHANNEL) as f64 / CELLS_PER_CHANNEL as f64;
    (0..CELLS)
        .filter(|&number| counts[number] > 0)
        .map(|number| Cell {
            number,
            count: f64::from(counts[number]),
            color: [CELLS_PER_CHANNEL * CELLS_PER_CHANNEL, CELLS_PER_CHANNEL, 1]
                .map(|unit| place(number / unit)),
        })
        .collect()
}

fn mean(cells: &[Cell]) -> [f64; 3] {
    let total: f64 = cells.iter().map(|cell| cell.count).sum();
    std::array::from_fn(|axis| {
        cells.iter().map(|cell| cell.count * cell.color[axis]).sum::<f64>() / total.max(1.0)
    })
}

/// The axis along which the cells' colours differ most, and the sum of squares along it.
fn spread(cells: &[Cell]) -> (usize, f64) {
    let middle = mean(cells);
    let along = |axis: usize| -> f64 {
        cells.iter().map(|cell| cell.count * (cell.color[axis] - middle[axis]).powi(2)).sum()
    };
    let sums = [along(0), along(1), along(2)];
    let widest = (0..3).max_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap_or(0);
    (widest, sums[widest])
}

/// A pixel of one colour, spread over all colours like it; the parts add up to one.
fn shares(from: &[f64; 3], all: &[[f64; 3]]) -> [f32; COLORS] {
    let mut parts = [0.0; COLORS];
    for (part, to) in parts.iter_mut().zip(all) {
        let squared: f64 = from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum();
        *part = (-0.5 * squared / (ALIKE * ALIKE)).exp();
    }
    let total: f64 = parts.iter().sum();
    parts.map(|part| (part / total) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_far_apart_have_labels_of_their_own_and_near_ones_share() {
        let colors: Vec<[f32; 3]> = (0..3000)
            .map(|k| {
                let near = (k % 7) as f32 * 0.001;
                if k % 3 == 0 { [0.9, 0.1, near] } else { [0.1, 0.8 + near, 0.2] }
            })
            .collect();
        let palette = Palette::new(&colors);
        let (red, green) = (palette.labels[0], palette.labels[1]);
        assert_ne!(red, green);
        for parts in &palette.spread {
            // Sums of 48 parts in single precision.
            assert!((parts.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        }
        assert!(palette.spread[usize::from(red)][usize::from(green)] < 1e-6);
        assert_eq!(Palette::new(&[]).labels.len(), 0);
    }
}
