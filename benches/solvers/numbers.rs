//! Summaries of many measurements, and the time that they took.

use std::sync::OnceLock;
use std::time::Instant;

/// The value below which this part of them lies; not a number where there are none.
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get((part * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// In percent, of those for which the condition holds.
pub fn percent<T>(values: &[T], holds: impl Fn(&T) -> bool) -> f64 {
    100.0 * values.iter().filter(|value| holds(value)).count() as f64 / values.len() as f64
}

/// Seconds that this thread has worked, which other programs on the machine do not change. Where the system does not say,
/// seconds on the wall.
pub fn cpu_secs() -> f64 {
    static FIRST: OnceLock<Instant> = OnceLock::new();
    let on_the_wall = || FIRST.get_or_init(Instant::now).elapsed().as_secs_f64();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanos: Option<f64> = text.split(' ').next().and_then(|word| word.parse().ok());
    nanos.map_or_else(on_the_wall, |nanos| nanos * 1e-9)
}
