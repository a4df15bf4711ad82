//! What frames cost.

use std::collections::VecDeque;

/// Frames over which the median is taken.
const KEPT: usize = 240;

#[derive(Debug, Default)]
pub struct Performance {
    pub frames: u64,
    /// From the navigation to the end of the first frame.
    pub start_ms: f64,
    cpu_ms: VecDeque<f32>,
}

impl Performance {
    /// Counts a frame, given the seconds that the last one took on the CPU.
    pub fn begin_frame(&mut self, last_cpu_seconds: Option<f32>) {
        self.frames += 1;
        self.cpu_ms.extend(last_cpu_seconds.map(|seconds| seconds * 1000.0));
        if self.cpu_ms.len() > KEPT {
            self.cpu_ms.pop_front();
        }
    }

    /// The time that `fraction` of the last frames stayed below.
    pub fn cpu_ms_quantile(&self, fraction: f64) -> f64 {
        let mut sorted: Vec<f32> = self.cpu_ms.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        let index = (fraction * sorted.len() as f64) as usize;
        sorted.get(index.min(sorted.len().saturating_sub(1))).map_or(0.0, |&ms| f64::from(ms))
    }
}
