//! Chance that replays: numbers drawn from a recorded seed.

use sha2::{Digest, Sha256};

/// JSON readers that keep numbers as `f64` keep whole ones below this.
const SEED_LIMIT: u64 = 1 << 53;

/// Vigna's SplitMix64: a few dozen draws for one participant need no more.
#[derive(Debug, Clone)]
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Of one purpose among several that share a seed: what is drawn for one says nothing of the next.
    pub fn of(seed: u64, purpose: &str) -> Self {
        Self(hash(&[&seed.to_string(), purpose]))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// From 0 up to, not including, 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / SEED_LIMIT as f64
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// A whole number below `count`, each as likely as the others; 0 where there is none.
    pub fn below(&mut self, count: usize) -> usize {
        let count = count.max(1) as u64;
        // What is left over after the last whole round would favour the first numbers.
        let fair = u64::MAX - u64::MAX % count;
        loop {
            let drawn = self.next();
            if drawn < fair {
                return (drawn % count) as usize;
            }
        }
    }

    /// Fisher and Yates: every order is as likely as the others.
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.below(last + 1));
        }
    }
}

/// A number that these words always give, the same on every machine.
pub fn hash(words: &[&str]) -> u64 {
    let mut digest = Sha256::new();
    for word in words {
        digest.update((word.len() as u64).to_le_bytes());
        digest.update(word.as_bytes());
    }
    let bytes: [u8; 32] = digest.finalize().into();
    bytes.iter().take(8).fold(0, |number, byte| (number << 8) | u64::from(*byte))
}

/// The seed of a participant who is given none.
pub fn participant_seed(study: &str, participant: &str) -> u64 {
    hash(&["seed", study, participant]) % SEED_LIMIT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_below_are_even() {
        let mut chance = Chance::new(1);
        let mut counts = [0_u32; 5];
        for _ in 0..10_000 {
            counts[chance.below(5)] += 1;
        }
        // 2000 ± 40 is one standard deviation of a fair draw; five of them are 200.
        assert!(counts.iter().all(|count| count.abs_diff(2000) < 200), "{counts:?}");
        assert_eq!((chance.below(1), chance.below(0)), (0, 0));
    }

    #[test]
    fn every_order_of_three_comes_as_often() {
        let mut chance = Chance::new(7);
        let mut counts = std::collections::BTreeMap::new();
        for _ in 0..6000 {
            let mut list = [0, 1, 2];
            chance.shuffle(&mut list);
            *counts.entry(list).or_insert(0_u32) += 1;
        }
        // 1000 ± 29; five standard deviations.
        assert!(counts.len() == 6 && counts.values().all(|count| count.abs_diff(1000) < 145), "{counts:?}");
    }

    #[test]
    fn seeds_differ_by_participant_and_by_study_and_stay() {
        let seed = participant_seed("demo", "P1");
        assert_eq!(seed, participant_seed("demo", "P1"));
        assert_ne!(seed, participant_seed("demo", "P2"));
        assert_ne!(participant_seed("a", "bc"), participant_seed("ab", "c"));
        assert!(seed < SEED_LIMIT);
    }
}
