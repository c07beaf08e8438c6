//! The first rays of many paths at once.

use super::state::{LENS_PAIR, PIXEL_PAIR, PathState};
use crate::{CameraFrame, PixelSampler};
use umbriel_kernels::{
    LANES, Ray, Vec3Lanes,
    glam::{Vec2, Vec3},
    whole_vectors,
};

/// A sample of a pixel and its ray a lane.
#[derive(Debug)]
pub(super) struct StartLanes {
    len: usize,
    pixel: [[u32; LANES]; 2],
    sample: [u32; LANES],
    /// Of the [`PixelSampler`].
    first: [u32; LANES],
    key: [u32; LANES],
    origin: Vec3Lanes,
    dir: Vec3Lanes,
}

impl Default for StartLanes {
    fn default() -> Self {
        Self {
            len: 0,
            pixel: [[0; LANES]; 2],
            sample: [0; LANES],
            first: [0; LANES],
            key: [0; LANES],
            origin: Vec3Lanes::default(),
            dir: Vec3Lanes::default(),
        }
    }
}

impl StartLanes {
    /// Rays of at most [`LANES`] samples `(x, y, number)` of pixels with `count` samples each. To be called within
    /// [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        frame: &CameraFrame,
        samples: &[(u32, u32, u32)],
        count: u32,
        seed: u64,
    ) {
        self.len = samples.len().min(LANES);
        for (i, &(x, y, sample)) in samples.iter().enumerate().take(LANES) {
            (self.pixel[0][i], self.pixel[1][i], self.sample[i]) = (x, y, sample);
        }
        for i in 0..whole_vectors(self.len) {
            let (x, y) = (self.pixel[0][i], self.pixel[1][i]);
            let sampler = PixelSampler::new(x, y, count, seed);
            (self.first[i], self.key[i]) = (sampler.first, sampler.key);
        }
        if frame.is_pinhole() {
            self.see(
                #[inline(always)]
                |place, _, _| frame.ray(place),
            );
        } else {
            self.see(
                #[inline(always)]
                |place, sampler, sample| {
                    frame.ray_through_lens(place, sampler.pair(sample, LENS_PAIR))
                },
            );
        }
    }

    #[inline(always)]
    fn see(&mut self, ray: impl Fn(Vec2, &PixelSampler, u32) -> Ray) {
        for i in 0..whole_vectors(self.len) {
            let (first, key, sample) = (self.first[i], self.key[i], self.sample[i]);
            let sampler = PixelSampler { first, key };
            let corner = Vec2::new(self.pixel[0][i] as f32, self.pixel[1][i] as f32);
            let ray = ray(corner + sampler.pair(sample, PIXEL_PAIR), &sampler, sample);
            self.origin.set(i, ray.origin);
            self.dir.set(i, ray.dir);
        }
    }

    /// The rays and what goes along with them; their light is summed from `slot` on.
    pub(super) fn push(&self, slot: u32, rays: &mut Vec<Ray>, states: &mut Vec<PathState>) {
        for (i, slot) in (0..self.len.min(LANES)).zip(slot..) {
            let origin = self.origin.get(i);
            rays.push(Ray::new(origin, self.dir.get(i)));
            states.push(PathState {
                weight: Vec3::ONE,
                sampler: PixelSampler {
                    first: self.first[i],
                    key: self.key[i],
                },
                sample: self.sample[i],
                slot,
                depth: 0,
                passes: 0,
                medium: None,
                bent: false,
                pdf: f32::INFINITY,
                from: origin,
                from_normal: None,
            });
        }
    }
}
