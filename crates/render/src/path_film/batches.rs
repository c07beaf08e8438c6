//! How uncertain the mean of a pixel's samples is, from the samples themselves.

/// Batches that are told apart; with fewer than half of them filled, the estimate rests on half of them.
const BATCHES: usize = 8;

/// Sums of the luminance of a pixel's samples in four to eight batches of consecutive samples; the batches grow with the samples.
///
/// A batch of `2^k` samples is well spread by itself, so that the difference of batches tells of the error that such samples leave, not of
/// that of independent ones. The mean of all batches is better spread still: the estimate is on the safe side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Batches {
    sums: [f32; BATCHES],
    /// Samples in all.
    pub(crate) count: u32,
}

impl Batches {
    /// Adds the next sample.
    #[inline(always)]
    pub(crate) fn add(&mut self, luminance: f32) {
        if self.count >= BATCHES as u32 && self.count.is_power_of_two() {
            self.merge_pairs();
        }
        let batch = self.count >> batch_bits(self.count);
        self.sums[batch as usize] += luminance;
        self.count += 1;
    }

    fn merge_pairs(&mut self) {
        for i in 0..BATCHES / 2 {
            self.sums[i] = self.sums[2 * i] + self.sums[2 * i + 1];
        }
        self.sums[BATCHES / 2..].fill(0.0);
    }

    /// The variance that independent samples with the same error of the mean would have; the variance of the mean of `n` is this over `n`.
    /// One sample tells nothing: then it is the square of its luminance.
    ///
    /// ```text
    /// m_j = means of K batches of s samples     v = s Σ(m_j − m)² / (K − 1)
    /// ```
    ///
    /// Source: Schmeiser, "Batch Size Effects in the Analysis of Simulation Output", Operations Research 30(3), 1982.
    pub(crate) fn variance(&self) -> f32 {
        let size = batch_size(self.count.saturating_sub(1));
        let full = (self.count / size) as usize;
        if full < 2 {
            return self.sums[0] * self.sums[0];
        }
        let mean = self.full_mean(size, full);
        let square = |sum: &f32| (sum / size as f32 - mean) * (sum / size as f32 - mean);
        let squares: f32 = self.sums[..full].iter().map(square).sum();
        size as f32 * squares / (full - 1) as f32
    }

    /// The mean luminance of all samples.
    pub(crate) fn mean(&self) -> f32 {
        self.sums.iter().sum::<f32>() / self.count.max(1) as f32
    }

    fn full_mean(&self, size: u32, full: usize) -> f32 {
        self.sums[..full].iter().sum::<f32>() / (size as usize * full) as f32
    }
}

/// Samples a batch, of which number `sample` falls into one of the eight.
#[inline(always)]
fn batch_size(sample: u32) -> u32 {
    1 << batch_bits(sample)
}

/// The logarithm of [`batch_size`].
#[inline(always)]
fn batch_bits(sample: u32) -> u32 {
    (sample / (BATCHES as u32 / 2)).max(1).ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_samples_fall_into_a_batch() {
        for sample in (0..1000).chain([65_535]) {
            let batch = sample / batch_size(sample);
            assert!(batch < BATCHES as u32, "{sample}");
            assert!(sample < 8 || batch >= 4, "{sample}");
        }
    }

    #[test]
    fn the_mean_is_that_of_all_samples() {
        let mut batches = Batches::default();
        for sample in 0..100 {
            batches.add(sample as f32);
            assert_eq!(batches.mean(), sample as f32 / 2.0);
        }
    }

    /// Independent samples: the estimate is the variance of one, whatever their number.
    #[test]
    fn the_variance_is_that_of_samples() {
        for count in [3, 8, 9, 24, 64, 100] {
            let (mut sum, mut state) = (0.0, 1_u32);
            for _ in 0..4000 {
                let mut batches = Batches::default();
                for _ in 0..count {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    batches.add((state >> 8) as f32 / (1 << 24) as f32);
                }
                sum += batches.variance() / 4000.0;
            }
            assert!((sum * 12.0 - 1.0).abs() < 0.05, "{count}: {sum}");
        }
    }

    #[test]
    fn equal_samples_have_no_variance() {
        let mut batches = Batches::default();
        for _ in 0..50 {
            batches.add(0.5);
        }
        assert_eq!(batches.variance(), 0.0);
    }

    #[test]
    fn one_sample_tells_nothing() {
        let mut batches = Batches::default();
        batches.add(3.0);
        assert_eq!(batches.variance(), 9.0);
    }
}
