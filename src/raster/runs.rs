//! Masks as run lengths, the way COCO writes them without compression.

use super::Mask;

impl Mask {
    /// How many pixels in turn are not set, set, not set, … down the columns, from the left. The first run is of pixels
    /// that are not set, and is 0 where the first pixel is.
    pub fn column_major_runs(&self) -> Vec<u32> {
        let (width, height) = (self.width(), self.height());
        let mut runs = Vec::new();
        let (mut current, mut length) = (false, 0_u32);
        for is_set in (0..width).flat_map(|x| (0..height).map(move |y| self.get(x, y))) {
            if is_set != current {
                runs.push(length);
                (current, length) = (is_set, 0);
            }
            length += 1;
        }
        runs.push(length);
        runs
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn runs_go_down_the_columns() {
        // . #
        // # #
        // . .
        let mask = Mask::from_pixels(2, 3, [false, true, true, true, false, false]);
        assert_eq!(mask.column_major_runs(), [1, 1, 1, 2, 1]);
        assert_eq!(Mask::from_pixels(1, 2, [true, true]).column_major_runs(), [0, 2]);
    }

    proptest! {
        #[test]
        fn runs_bring_the_mask_back(width in 1_u32..9, pixels in proptest::collection::vec(any::<bool>(), 64)) {
            let height = 64 / width;
            let mask = Mask::from_pixels(width, height, pixels.iter().copied());
            let mut columns = Vec::new();
            for (run, length) in mask.column_major_runs().into_iter().enumerate() {
                columns.extend(std::iter::repeat_n(run % 2 == 1, length as usize));
            }
            prop_assert_eq!(columns.len(), (width * height) as usize);
            let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x * height + y) as usize));
            prop_assert_eq!(Mask::from_pixels(width, height, rows.map(|i| columns[i])), mask);
        }
    }
}
