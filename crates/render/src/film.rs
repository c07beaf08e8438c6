//! The film: what a render leaves behind.

use crate::Image;
use umbriel_kernels::glam::Vec3;

/// A rendered picture with what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The picture, linear.
    pub image: Image,
    /// Counters.
    pub stats: Stats,
    /// What a picture by passes of samples took; `None` for the others.
    pub sampling: Option<SamplingReport>,
}

/// How many samples a picture by passes took, and why no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingReport {
    /// Samples a pixel that were traced, those that only judged their neighbours included.
    pub traced: f64,
    /// Samples a pixel in the picture: their mean,
    pub mean: f64,
    /// least
    pub least: u32,
    /// and greatest number.
    pub most: u32,
    /// Root mean square, over the pixels, of the estimated standard error of the luminance, relative as in [`Settings::noise`](crate::Settings::noise).
    pub noise: f32,
    /// Why the picture ended; `None` while it goes on.
    pub reason: Option<StopReason>,
}

/// Which limit a picture reached first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The number of samples.
    Samples,
    /// The time.
    Time,
    /// The noise.
    Noise,
    /// [`Control::stop`](crate::Control::stop).
    Interrupt,
}

/// Whether a sample is light that can be summed: samples as bright as this are thrown away, so that no sum of them overflows.
#[inline(always)]
pub(crate) fn is_light(sample: Vec3) -> bool {
    const MOST: f32 = 1e30;
    sample.abs().element_sum() <= MOST
}

/// Counters of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Eye, mirrored and refracted rays; what is rasterised needs none.
    pub rays: u64,
    /// Shadow rays or lookups in shadow maps: questions whether a light is seen.
    pub shadow_rays: u64,
    /// Samples that were no finite numbers, or beyond 1e30 nit; they count as black.
    pub bad_samples: u64,
    /// Finished pixels; fewer than asked for when the render was stopped.
    pub pixels: u64,
}

impl Stats {
    /// What was counted after `before`.
    pub(crate) fn since(self, before: Self) -> Self {
        Self {
            rays: self.rays - before.rays,
            shadow_rays: self.shadow_rays - before.shadow_rays,
            bad_samples: self.bad_samples - before.bad_samples,
            pixels: self.pixels - before.pixels,
        }
    }
}

impl std::ops::Add for Stats {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            shadow_rays: self.shadow_rays + other.shadow_rays,
            bad_samples: self.bad_samples + other.bad_samples,
            pixels: self.pixels + other.pixels,
        }
    }
}
