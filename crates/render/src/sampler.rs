//! Where samples lie in a pixel: a pure function of (pixel, sample, seed).

use umbriel_kernels::{glam::Vec2, mix_bits};

/// The place in `[0, 1)²` of sample number `sample` of `count` in the pixel `x`, `y`.
///
/// A Hammersley set, moved by a random vector of the pixel's own so that neighbouring pixels do
/// not repeat the same pattern. A single sample is the pixel's centre.
/// ```text
/// s_i = ( (i + ½)/n , φ₂(i) )  + r(x, y, seed)   mod 1
/// ```
///
/// Source: Hammersley, 1960 (the set); Cranley & Patterson, SIAM Journal on Numerical Analysis 13(6), 1976 (the random vector).
#[inline]
pub fn sample_pixel(x: u32, y: u32, sample: u32, count: u32, seed: u64) -> Vec2 {
    if count == 1 {
        return Vec2::splat(0.5);
    }
    moved_hammersley(x, y, sample, count, seed)
}

/// [`sample_pixel`] for more than one sample; apart, so that the single one is not made to wait for the random vector.
#[inline(never)]
fn moved_hammersley(x: u32, y: u32, sample: u32, count: u32, seed: u64) -> Vec2 {
    let random = mix_bits(seed ^ mix_bits(u64::from(x) << 32 | u64::from(y)));
    let u = (u64::from(sample) << 32 | 1 << 31) / u64::from(count);
    let wrapped = (u as u32).wrapping_add(random as u32);
    let v = sample.reverse_bits().wrapping_add((random >> 32) as u32);
    Vec2::new(unit_float(wrapped), unit_float(v))
}

/// The upper 24 bits as a number in `[0, 1)`.
#[inline]
fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_the_centre() {
        assert_eq!(sample_pixel(7, 9, 0, 1, 3), Vec2::splat(0.5));
    }

    /// Each column of width 1/n holds exactly one of n samples: the set is stratified, wherever it was moved.
    #[test]
    fn samples_are_stratified() {
        for n in [2, 4, 16, 100] {
            for pixel in 0..20 {
                let mut places: Vec<f32> =
                    (0..n).map(|i| sample_pixel(pixel, 5, i, n, 1).x).collect();
                assert!(places.iter().all(|x| (0.0..1.0).contains(x)));
                places.sort_by(f32::total_cmp);
                for pair in places.windows(2) {
                    assert!(
                        (pair[1] - pair[0] - 1.0 / n as f32).abs() < 1e-5,
                        "{n}: {pair:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn seed_and_pixel_move_the_samples() {
        let at = |x, seed| sample_pixel(x, 0, 0, 4, seed);
        assert_ne!(at(0, 0), at(1, 0));
        assert_ne!(at(0, 0), at(0, 1));
        assert_eq!(at(3, 2), at(3, 2));
    }

    /// The mean of many pixels' samples is the middle: no side of the pixel is preferred.
    #[test]
    fn samples_have_no_bias() {
        let mean = (0..10_000)
            .map(|x| sample_pixel(x, x / 3, 0, 2, 0))
            .sum::<Vec2>()
            / 10_000.0;
        assert!((mean - 0.5).length() < 0.01, "{mean}");
    }
}
