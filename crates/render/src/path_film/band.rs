//! Some rows of a film: sums of samples, and which blocks need no more.

use super::batches::Batches;
use crate::{LUMINANCE, exact_sum::ExactSum, sample_light::SampleLight};
use umbriel_kernels::glam::Vec3;

/// Pixels along one side of a block, which stops as a whole; and rows of a band. With smaller ones the noise of rare bright paths is judged so
/// badly that pixels of the same noise get very different numbers of samples, which is worse than the same number for all.
pub(crate) const BLOCK: u32 = 16;
/// The share of white that dark pixels are compared with.
const DARK: f32 = 0.1;

/// What a pixel of the picture has gathered.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelSums {
    pub(crate) light: [ExactSum; 3],
    /// Samples in `light`.
    pub(crate) samples: u32,
}

/// Rows that belong to one thread at a time.
#[derive(Debug)]
pub(crate) struct Band {
    /// x0, y0 (included), x1, y1 (excluded).
    pub(crate) area: [u32; 4],
    /// Pixels row by row.
    pub(crate) pixels: Vec<PixelSums>,
    /// Direct light of the same samples; empty where nobody asks for it.
    pub(crate) direct: Vec<[ExactSum; 3]>,
    /// Of all samples that were traced, also those that serve only to tell when the neighbours stop.
    pub(crate) batches: Vec<Batches>,
    /// For each block, whether its pixels of even and of odd `x + y` have enough samples.
    pub(crate) stopped: Vec<[bool; 2]>,
}

impl Band {
    pub(crate) fn new(area: [u32; 4], with_direct: bool) -> Self {
        let [x0, y0, x1, y1] = area;
        let pixels = ((x1 - x0) * (y1 - y0)) as usize;
        let blocks = x1.div_ceil(BLOCK) - x0 / BLOCK;
        Self {
            area,
            pixels: vec![PixelSums::default(); pixels],
            direct: vec![Default::default(); if with_direct { pixels } else { 0 }],
            batches: vec![Batches::default(); pixels],
            stopped: vec![[false; 2]; blocks as usize],
        }
    }

    /// Bytes of memory for each pixel.
    pub(crate) fn pixel_bytes(with_direct: bool) -> u64 {
        let direct = if with_direct {
            size_of::<[ExactSum; 3]>()
        } else {
            0
        };
        (size_of::<PixelSums>() + size_of::<Batches>() + direct) as u64
    }

    /// Position, in the picture, of the pixel with an index.
    pub(crate) fn place(&self, index: usize) -> [u32; 2] {
        let [x0, y0, x1, _] = self.area;
        let (index, width) = (index as u32, x1 - x0);
        [x0 + index % width, y0 + index / width]
    }

    fn block(&self, [x, _]: [u32; 2]) -> usize {
        (x / BLOCK - self.area[0] / BLOCK) as usize
    }

    /// Whether samples of a pixel are still asked for, by itself or by its neighbours.
    pub(crate) fn goes_on(&self, place: [u32; 2]) -> bool {
        self.stopped[self.block(place)] != [true; 2]
    }

    /// Pixels of which samples are still asked for.
    pub(crate) fn noisy_pixels(&self) -> u64 {
        let goes_on = |index: &usize| self.goes_on(self.place(*index));
        (0..self.pixels.len()).filter(goes_on).count() as u64
    }

    /// Adds the samples of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            merge(&mut pixel.light, &other.light);
            pixel.samples += other.samples;
        }
        for (direct, other) in self.direct.iter_mut().zip(&other.direct) {
            merge(direct, other);
        }
        // One part's samples tell how far those of both scatter.
        for (batches, other) in self.batches.iter_mut().zip(&other.batches) {
            if other.count > batches.count {
                *batches = *other;
            }
        }
    }

    /// Adds the next sample of the pixel with this index, which is at `place` in the picture.
    #[inline(always)]
    pub(crate) fn add(&mut self, index: usize, place: [u32; 2], light: &SampleLight) {
        let sum = light.sum();
        self.batches[index].add(LUMINANCE.dot(sum));
        if self.stopped[self.block(place)][color(place)] {
            return;
        }
        add(&mut self.pixels[index].light, sum);
        self.pixels[index].samples += 1;
        if let Some(direct) = self.direct.get_mut(index) {
            add(direct, light.direct);
        }
    }

    /// The pixel's variance of the mean luminance.
    pub(crate) fn variance(&self, index: usize) -> f32 {
        self.batches[index].variance() / self.pixels[index].samples.max(1) as f32
    }

    /// The square of the pixel's relative standard error, should its mean be that of `samples`.
    ///
    /// ```text
    /// e² = Var(mean luminance) / (mean luminance² + (white/10)²)
    /// ```
    pub(crate) fn noise_square(&self, index: usize, samples: u32, white: f32) -> f32 {
        let (batches, dark) = (&self.batches[index], DARK * white);
        let scale = batches.mean() * batches.mean() + dark * dark;
        batches.variance() / samples.max(1) as f32 / scale.max(f32::MIN_POSITIVE)
    }

    /// Lets the pixels of one colour of each block stop where those of the other are less noisy than `most`.
    ///
    /// As on a chess board: what a pixel's own samples say does not decide how many it gets, so that their mean stays without bias. A
    /// colour that has stopped is traced further, as the judge of the other, until that stops, too; these samples are not in the picture.
    ///
    /// Source: Kirk & Arvo, "Unbiased Sampling Techniques for Image Synthesis", SIGGRAPH 1991 (the bias of asking the same samples).
    pub(crate) fn judge(&mut self, most: f32, white: f32) {
        let mut sums = vec![[(0.0_f32, 0_u32); 2]; self.stopped.len()];
        for index in 0..self.batches.len() {
            let place = self.place(index);
            let noise = self.noise_square(index, self.batches[index].count, white);
            let (sum, pixels) = &mut sums[self.block(place)][color(place)];
            *sum += noise;
            *pixels += 1;
        }
        for (stopped, sums) in self.stopped.iter_mut().zip(&sums) {
            // A crop may leave a single pixel of a block, which then has to judge itself.
            let other = |color: usize| {
                if sums[1 - color].1 > 0 {
                    1 - color
                } else {
                    color
                }
            };
            let quiet = [0, 1].map(|color| {
                let (sum, pixels) = sums[other(color)];
                sum <= most * most * pixels as f32
            });
            *stopped = [stopped[0] | quiet[0], stopped[1] | quiet[1]];
        }
    }
}

/// 0 or 1 as on a chess board.
#[inline(always)]
fn color([x, y]: [u32; 2]) -> usize {
    ((x + y) & 1) as usize
}

#[inline(always)]
fn add(sums: &mut [ExactSum; 3], light: Vec3) {
    for (sum, value) in sums.iter_mut().zip(light.to_array()) {
        sum.add(value);
    }
}

fn merge(sums: &mut [ExactSum; 3], others: &[ExactSum; 3]) {
    for (sum, other) in sums.iter_mut().zip(others) {
        sum.merge(*other);
    }
}
