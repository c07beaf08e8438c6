//! A pass of samples over a band.

use super::band::Band;
use crate::{CameraFrame, Stats, path::PathTracer, sample_light::SampleLight};
use std::ops::Range;

/// Paths in flight at once.
const PATHS: usize = 4096;

/// What the bands of a pass have in common.
pub(crate) struct Pass<'a> {
    pub(crate) frame: &'a CameraFrame,
    /// Numbers of the samples that each pixel has afterwards.
    pub(crate) samples: Range<u32>,
    /// Samples that a pixel can have at all.
    pub(crate) count: u32,
    /// Asked before each batch.
    pub(crate) stop: &'a (dyn Fn() -> bool + Sync),
    /// Told of the samples of each batch.
    pub(crate) progress: &'a (dyn Fn(u64) + Sync),
}

/// A tracer with the memory of its batches.
pub(crate) struct PassTracer<'a> {
    tracer: PathTracer<'a>,
    /// Pixel and number of each sample.
    samples: Vec<(u32, u32, u32)>,
    /// Index of its pixel in the band.
    indices: Vec<usize>,
    light: Vec<SampleLight>,
}

impl<'a> PassTracer<'a> {
    pub(crate) fn new(tracer: PathTracer<'a>) -> Self {
        Self {
            tracer,
            samples: Vec::with_capacity(PATHS),
            indices: Vec::with_capacity(PATHS),
            light: vec![SampleLight::default(); PATHS],
        }
    }

    /// Brings the pixels of a band to their target; false if that was stopped.
    pub(crate) fn run(&mut self, band: &mut Band, pass: &Pass) -> bool {
        for index in 0..band.pixels.len() {
            let place = band.place(index);
            if !band.goes_on(place) {
                continue;
            }
            let traced = band.batches[index].count;
            for sample in pass.samples.start + traced..pass.samples.end {
                self.samples.push((place[0], place[1], sample));
                self.indices.push(index);
                if self.samples.len() == PATHS && !self.flush(band, pass) {
                    return false;
                }
            }
        }
        self.flush(band, pass)
    }

    fn flush(&mut self, band: &mut Band, pass: &Pass) -> bool {
        let stopped = (pass.stop)();
        if !stopped && !self.samples.is_empty() {
            let light = &mut self.light[..self.samples.len()];
            self.tracer
                .trace(pass.frame, &self.samples, pass.count, light);
            for ((&index, &(x, y, _)), light) in self.indices.iter().zip(&self.samples).zip(&*light)
            {
                band.add(index, [x, y], light);
            }
            (pass.progress)(self.samples.len() as u64);
        }
        self.samples.clear();
        self.indices.clear();
        !stopped
    }

    /// What was counted since the tracer was made; pixels apart.
    pub(crate) fn stats(&self) -> Stats {
        Stats {
            rays: self.tracer.rays_traced,
            shadow_rays: self.tracer.shadow_rays_traced,
            bad_samples: self.tracer.bad_samples,
            pixels: 0,
        }
    }
}
