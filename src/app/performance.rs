//! What frames cost.

use crate::math::sort_short;
use std::collections::VecDeque;

/// Frames over which the median is taken, at most.
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

    /// The times that these fractions of the frames since the last call stayed below.
    pub fn take_cpu_ms<const COUNT: usize>(&mut self, fractions: [f64; COUNT]) -> [f64; COUNT] {
        let mut sorted: Vec<f32> = self.cpu_ms.drain(..).collect();
        sort_short(&mut sorted, f32::total_cmp);
        fractions.map(|fraction| {
            let index = (fraction * sorted.len() as f64) as usize;
            sorted.get(index.min(sorted.len().saturating_sub(1))).map_or(0.0, |&ms| f64::from(ms))
        })
    }
}
