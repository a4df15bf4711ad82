//! Many errors in a few numbers.

use super::PoseErrors;

/// One number of [`PoseErrors`], with its name and unit.
#[derive(Debug, Clone, Copy)]
pub struct Metric {
    /// As in the columns of tables; ends in the unit.
    pub name: &'static str,
    /// In the unit of the name: degrees for angles.
    pub of: fn(&PoseErrors) -> Option<f64>,
}

impl Metric {
    /// Everything that is tabled, in this order. VSD is the mean over its tolerances here.
    pub const ALL: [Self; 11] = [
        Self { name: "rotation_deg", of: |errors| Some(errors.rotation_rad.to_degrees()) },
        Self { name: "translation_mm", of: |errors| Some(errors.translation_mm) },
        Self { name: "depth_mm", of: |errors| Some(errors.depth_mm) },
        Self { name: "add_mm", of: |errors| Some(errors.add_mm) },
        Self { name: "adi_mm", of: |errors| Some(errors.adi_mm) },
        Self { name: "ad_mm", of: |errors| Some(errors.ad_mm) },
        Self { name: "mssd_mm", of: |errors| Some(errors.mssd_mm) },
        Self { name: "mspd_px", of: |errors| errors.mspd_px },
        Self { name: "proj_px", of: |errors| errors.projection_px },
        Self { name: "vsd", of: |errors| Some(errors.vsd.iter().sum::<f64>() / errors.vsd.len() as f64) },
        Self { name: "cus", of: |errors| Some(errors.cus) },
    ];
}

/// What there is to say of some numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    pub count: usize,
    pub mean: f64,
    pub median: f64,
    /// The 90th percentile, between neighbours in proportion (NumPy's "linear").
    pub p90: f64,
    pub max: f64,
    /// Of the population: ddof 0.
    pub standard_deviation: f64,
}

impl Statistics {
    /// `None` for no numbers.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        let count = sorted.len();
        let mean = sorted.iter().sum::<f64>() / count as f64;
        let variance = sorted.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
        Some(Self {
            count,
            mean,
            median: quantile(&sorted, 0.5),
            p90: quantile(&sorted, 0.9),
            max,
            standard_deviation: variance.sqrt(),
        })
    }
}

/// The value below which the given part of some sorted numbers lies, between neighbours in proportion (NumPy's "linear").
/// There has to be one number at least.
pub fn quantile(sorted: &[f64], part: f64) -> f64 {
    let position = part * (sorted.len() - 1) as f64;
    let (low, high) = (position.floor() as usize, position.ceil() as usize);
    sorted[low] + (sorted[high] - sorted[low]) * (position - position.floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_those_of_numpy() {
        // numpy: x = [4, 1, 9, 2]; mean, median, percentile(x, 90), max, std
        let found = Statistics::of([4.0, 1.0, 9.0, 2.0]).unwrap();
        assert_eq!((found.count, found.mean, found.median, found.max), (4, 4.0, 3.0, 9.0));
        assert!((found.p90 - 7.5).abs() < 1e-12 && (found.standard_deviation - 9.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(Statistics::of([]), None);
    }
}
