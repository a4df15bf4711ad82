//! Statistics that a few wrong numbers do not move.

/// The middle value, the upper one of two; 0 of nothing.
pub fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Tukey's weight of a residual that is this part of the gate, squared: from 1 to 0 at the gate and beyond.
pub fn biweight(part_squared: f64) -> f64 {
    (1.0 - part_squared).max(0.0).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_value() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0]), 3.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 1e9, 2.0]), 4.0);
    }

    #[test]
    fn what_is_beyond_the_gate_counts_nothing() {
        assert_eq!(biweight(0.0), 1.0);
        assert_eq!(biweight(0.5), 0.25);
        assert_eq!(biweight(1.0), 0.0);
        assert_eq!(biweight(1e9), 0.0);
    }
}
