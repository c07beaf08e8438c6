//! Well-spread random numbers: padded Owen-scrambled Sobol points, a pure function of (pixel, sample, dimension, seed).

use umbriel_kernels::glam::Vec2;

/// Pixels along one side of the square in which neighbours share their points.
const TILE_BITS: u32 = 10;

/// The samples of one pixel.
///
/// Each pair of dimensions is a two-dimensional Sobol sequence, with an order of its own ("padded"): the first `2^k` samples of a pixel
/// have one point in each of the `2^k` boxes of any elementary partition of the unit square, and so does every next such block.
/// Sobol's sequence runs through the pixels along a Z-shaped curve, so that the same is true of the `2^(k+2)` samples of each
/// 2x2 pixels, of each 4x4 and so on, where `count` is `2^k`: errors of neighbours then differ in sign, and the noise is blue.
///
/// Source: Burley, "Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4), 2020; Ahmed & Wonka,
/// "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", ACM Transactions on Graphics
/// 39(6), 2020.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampler {
    /// Place on the Z-shaped curve, times the samples a pixel has at most.
    first: u32,
    key: u32,
}

impl PixelSampler {
    /// Binary logarithm of the greatest number of samples of a pixel with which neighbours share a partition; with more, each pixel is on its own.
    const MOST_SHARED: u32 = 32 - 2 * TILE_BITS;

    /// The sampler of a pixel of which at most `count` samples are taken, at least 1. Fewer are well spread, too; more are those of a
    /// neighbour.
    #[inline(always)]
    pub fn new(x: u32, y: u32, count: u32, seed: u64) -> Self {
        let bits = ceil_log2(count);
        let tile = hash((x >> TILE_BITS) ^ hash((y >> TILE_BITS) ^ hash(fold(seed))));
        if bits > Self::MOST_SHARED {
            let place = z_order(x, y);
            return Self {
                first: 0,
                key: hash(tile ^ hash(place)),
            };
        }
        Self {
            first: z_order(x, y) << bits,
            key: tile,
        }
    }

    /// Two random numbers in `[0, 1)²`: dimensions `2 pair` and `2 pair + 1` of sample `sample`.
    #[inline(always)]
    pub fn pair(&self, sample: u32, pair: u32) -> Vec2 {
        self.point(sample).pair(pair)
    }

    /// All dimensions of sample `sample`.
    #[inline(always)]
    pub(crate) fn point(&self, sample: u32) -> SamplePoint {
        SamplePoint {
            index: self.first.wrapping_add(sample),
            key: self.key,
        }
    }
}

/// One sample of a [`PixelSampler`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SamplePoint {
    pub(crate) index: u32,
    pub(crate) key: u32,
}

impl SamplePoint {
    /// See [`PixelSampler::pair`].
    #[inline(always)]
    pub(crate) fn pair(self, pair: u32) -> Vec2 {
        let key = hash(self.key ^ hash(pair));
        // The order is Owen's, too: aligned blocks of samples stay blocks.
        let index = scramble(self.index, key);
        let u = scramble(sobol_0(index), key.wrapping_mul(0x9e37_79b9));
        let v = scramble(sobol_1(index), key.wrapping_mul(0x85eb_ca6b));
        Vec2::new(unit_float(u), unit_float(v))
    }
}

/// The first dimension of Sobol's sequence, van der Corput's: the bits of the index mirrored at the binary point.
#[inline(always)]
fn sobol_0(index: u32) -> u32 {
    index.reverse_bits()
}

/// The second dimension of Sobol's sequence: the index mirrored, and multiplied over GF(2) by Pascal's triangle, which is a product of
/// five matrices of one shift each.
///
/// Source: Sobol, USSR Computational Mathematics and Mathematical Physics 7(4), 1967; Faure, Acta Arithmetica 41, 1982 (the triangle).
#[inline(always)]
fn sobol_1(index: u32) -> u32 {
    let mut bits = index.reverse_bits();
    bits ^= (bits & 0x0000_ffff) << 16;
    bits ^= (bits & 0x00ff_00ff) << 8;
    bits ^= (bits & 0x0f0f_0f0f) << 4;
    bits ^= (bits & 0x3333_3333) << 2;
    bits ^ ((bits & 0x5555_5555) << 1)
}

/// Owen's nested uniform scrambling: each bit is flipped or not, as a hash of the key and of the bits above it says.
///
/// Source: Laine & Karras, "Stratified Sampling for Stochastic Transparency", Computer Graphics Forum 30(4), 2011; Burley 2020, with the
/// constants of Vegdahl, 2021.
#[inline(always)]
fn scramble(bits: u32, key: u32) -> u32 {
    // In mirrored bits, additions and multiplications by even numbers carry from the upper ones to the lower ones only.
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(key);
    x = x.wrapping_mul((key >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// The place of a pixel of a tile on Morton's Z-shaped curve: the bits of x and y in turns.
#[inline(always)]
fn z_order(x: u32, y: u32) -> u32 {
    spread(x) | spread(y) << 1
}

/// The low [`TILE_BITS`] bits with a zero between each two.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let mut x = x & ((1 << TILE_BITS) - 1);
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[inline(always)]
fn ceil_log2(count: u32) -> u32 {
    32 - count.saturating_sub(1).leading_zeros()
}

/// A bijection of 32 bits in which each input bit changes about half of the output's.
///
/// Source: Wellons, "Prospecting for Hash Functions", 2018 (`lowbias32`).
#[inline(always)]
fn hash(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[inline(always)]
fn fold(seed: u64) -> u32 {
    hash(seed as u32) ^ (seed >> 32) as u32
}

/// The upper 24 bits as a number in `[0, 1)`.
#[inline(always)]
fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// The direction numbers of the second dimension by their recurrence: m₁ = 1, m_k = 2 m_{k−1} ⊕ m_{k−1}.
    fn sobol_1_by_definition(index: u32) -> u32 {
        let mut direction = 1 << 31;
        let mut sum = 0;
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                sum ^= direction;
            }
            direction ^= direction >> 1;
        }
        sum
    }

    #[test]
    fn second_dimension_is_sobols() {
        for index in (0..5000)
            .chain((0..32).map(|bit| 1 << bit))
            .chain([u32::MAX, 0xdead_beef])
        {
            assert_eq!(sobol_1(index), sobol_1_by_definition(index), "{index}");
        }
    }

    /// Each of the boxes `2^-a x 2^-(k-a)` has one of the `2^k` points.
    fn is_net(points: &[Vec2]) -> bool {
        let bits = points.len().trailing_zeros();
        (0..=bits).all(|a| {
            let boxes: HashSet<(u32, u32)> = points
                .iter()
                .map(|p| {
                    let columns = (1_u32 << a) as f32;
                    let rows = (1_u32 << (bits - a)) as f32;
                    ((p.x * columns) as u32, (p.y * rows) as u32)
                })
                .collect();
            boxes.len() == points.len()
        })
    }

    #[test]
    fn first_samples_of_a_pixel_are_nets() {
        for (x, y, pair) in [(0, 0, 0), (5, 9, 1), (700, 1300, 7), (100_000, 3, 40)] {
            for count in [1, 16, 100, 4096, 1 << 20] {
                let sampler = PixelSampler::new(x, y, count, 3);
                for bits in 0..=ceil_log2(count).min(10) {
                    let block = |k: u32| -> Vec<Vec2> {
                        (k << bits..(k + 1) << bits)
                            .map(|i| sampler.pair(i, pair))
                            .collect()
                    };
                    assert!(is_net(&block(0)), "{x} {y} {pair} {count} {bits}");
                    assert!(
                        count < 2 << bits || is_net(&block(1)),
                        "{x} {y} {pair} {count} {bits}"
                    );
                }
            }
        }
    }

    /// Squares of pixels share a partition, where the number of samples is a power of two.
    #[test]
    fn squares_of_pixels_are_nets() {
        for (count, side) in [(1, 2), (1, 8), (4, 4), (16, 2)] {
            let mut points = Vec::new();
            for y in 0..side {
                for x in 0..side {
                    let sampler = PixelSampler::new(48 + x, 16 + y, count, 1);
                    points.extend((0..count).map(|i| sampler.pair(i, 2)));
                }
            }
            assert!(is_net(&points), "{count} {side}");
        }
    }

    /// Pixels, dimensions and seeds are as if independent: the correlation of their numbers vanishes.
    #[test]
    fn dimensions_and_seeds_are_uncorrelated() {
        let correlation = |a: &dyn Fn(u32) -> f32, b: &dyn Fn(u32) -> f32| {
            let n = 10_000;
            let sum: f64 = (0..n).map(|i| f64::from((a(i) - 0.5) * (b(i) - 0.5))).sum();
            12.0 * sum / f64::from(n)
        };
        let at = |x: u32, sample: u32, pair: u32, seed: u64| {
            PixelSampler::new(x, x / 7, 16, seed).pair(sample, pair)
        };
        let base = |x: u32| at(x, 3, 1, 5).x;
        // Six standard deviations of the mean of 10,000 products.
        let bound = 0.06;
        assert!(correlation(&base, &|x| at(x, 3, 1, 5).y).abs() < bound);
        assert!(correlation(&base, &|x| at(x, 3, 2, 5).x).abs() < bound);
        assert!(correlation(&base, &|x| at(x, 3, 1, 6).x).abs() < bound);
        assert!(correlation(&base, &|x| at(x + 1024, 3, 1, 5).x).abs() < bound);
        assert!(correlation(&base, &base) > 0.9);
    }

    /// Means over 4x4 pixels with one sample each have less variance than independent numbers would: the noise is blue.
    #[test]
    fn noise_of_neighbours_cancels() {
        let means: Vec<f64> = (0..1000)
            .map(|square| {
                let (x0, y0) = (4 * (square % 32), 4 * (square / 32));
                let sum: f32 = (0..16)
                    .map(|i| PixelSampler::new(x0 + i % 4, y0 + i / 4, 1, 2).pair(0, 3).x)
                    .sum();
                f64::from(sum / 16.0 - 0.5)
            })
            .collect();
        let variance = means.iter().map(|m| m * m).sum::<f64>() / means.len() as f64;
        let independent = 1.0 / 12.0 / 16.0;
        assert!(
            variance < 0.1 * independent,
            "{variance} against {independent}"
        );
    }
}
