//! The first rays of many paths at once.

use super::state::{LENS_PAIR, PIXEL_PAIR, PathState};
use crate::{CameraFrame, PixelSampler, sobol::SamplePoint};
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
    /// Of the [`SamplePoint`].
    index: [u32; LANES],
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
            index: [0; LANES],
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
            let point = sampler.point(self.sample[i]);
            (self.index[i], self.key[i]) = (point.index, point.key);
        }
        if frame.is_pinhole() {
            self.see(
                #[inline(always)]
                |place, _| frame.ray(place),
            );
        } else {
            self.see(
                #[inline(always)]
                |place, point| frame.ray_through_lens(place, point.pair(LENS_PAIR)),
            );
        }
    }

    #[inline(always)]
    fn see(&mut self, ray: impl Fn(Vec2, SamplePoint) -> Ray) {
        for i in 0..whole_vectors(self.len) {
            let point = self.point(i);
            let corner = Vec2::new(self.pixel[0][i] as f32, self.pixel[1][i] as f32);
            let ray = ray(corner + point.pair(PIXEL_PAIR), point);
            self.origin.set(i, ray.origin);
            self.dir.set(i, ray.dir);
        }
    }

    #[inline(always)]
    fn point(&self, i: usize) -> SamplePoint {
        let (index, key) = (self.index[i], self.key[i]);
        SamplePoint { index, key }
    }

    /// The random numbers of the samples.
    pub(super) fn points(&self) -> impl Iterator<Item = SamplePoint> {
        (0..self.len.min(LANES)).map(|i| self.point(i))
    }

    /// The rays and what goes along with them; the first is number `slot` of the batch.
    pub(super) fn push(&self, slot: u32, rays: &mut Vec<Ray>, states: &mut Vec<PathState>) {
        for (i, slot) in (0..self.len.min(LANES)).zip(slot..) {
            let origin = self.origin.get(i);
            rays.push(Ray::new(origin, self.dir.get(i)));
            states.push(PathState {
                weight: Vec3::ONE,
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
